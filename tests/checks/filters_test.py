"""Every filter by which ./test, scripts/mutate and scripts/coverage select tests still selects one."""
import fnmatch
import importlib.machinery
import importlib.util
import pathlib
import re
import sys
import unittest

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))


def load(name):
    loader = importlib.machinery.SourceFileLoader(name, str(ROOT / "scripts" / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    sys.modules[name] = module
    loader.exec_module(module)
    return module


def names_of_tests():
    """Suite.Name of every test, and Prefix/Suite.Name of the parametrised ones."""
    names = set()
    for source in (ROOT / "tests").rglob("*.cpp"):
        text = source.read_text()
        prefixes = {}
        for prefix, suite in re.findall(r"\bINSTANTIATE_T\w+_P\(\s*(\w+),\s*(\w+)", text):
            prefixes.setdefault(suite, []).append(prefix)
        for suite, name in re.findall(r"^T\w*EST(?:_\w+)?\(\s*(\w+),\s*(\w+)\)", text, re.M):
            names |= {f"{suite}.{name}", *(f"{prefix}/{suite}.{name}/" for prefix in prefixes.get(suite, []))}
    return names


class Filters(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.names = names_of_tests()

    def selects(self, pattern):
        return any(fnmatch.fnmatchcase(name, pattern) for name in self.names)

    def test_finds_tests(self):
        self.assertGreater(len(self.names), 500)
        self.assertFalse(self.selects("*NoSuchTest*"))

    def test_filters_of_gtest(self):
        filters = [chosen for target in load("mutate").TARGETS for chosen in target[2]]
        patterns = {part.lstrip("-") for chosen in [*filters, load("coverage").LEFT_OUT] for part in chosen.split(":")}
        self.assertGreater(len(patterns), 15)
        self.assertEqual([p for p in sorted(patterns) if p and not self.selects(p)], [])

    def test_tests_that_sanitizers_leave_out(self):
        expression = re.search(r"--exclude-regex \\\n +'(.*)'", (ROOT / "test").read_text())[1]
        suites = re.findall(r"(\w+)\\\.(\((?:\w+\|?)+\)|\w+)", expression)
        patterns = [f"{suite}.{name}*" for suite, group in suites for name in group.strip("()").split("|")
                    if suite[0].isupper()]
        self.assertGreater(len(patterns), 4)
        self.assertEqual([p for p in patterns if not self.selects(p)], [])


if __name__ == "__main__":
    unittest.main(verbosity=2)
