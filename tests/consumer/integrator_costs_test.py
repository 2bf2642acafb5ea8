"""The commands of docs/PORTING.md on the image of examples/integrator, built with the cycles of its ticks.

usage: integrator_costs_test.py TACTREE SOURCES BUILD PREFIX
"""
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

TACTREE, SOURCES, BUILD, PREFIX = sys.argv[1:5]
EXAMPLE = pathlib.Path(SOURCES, "examples/integrator")
IMAGE = pathlib.Path(BUILD, "hc3-main.elf")


def tactree(*arguments):
    return subprocess.run([TACTREE, *map(str, arguments)], capture_output=True, text=True, check=False)


class Documented(unittest.TestCase):
    def test_command_yields_a_bound(self):
        text = pathlib.Path(SOURCES, "docs/PORTING.md").read_text()
        command = re.search(r"^ +tactree (bound firmware\.elf --entry .*?)--embed$", text, re.M | re.S)[1]
        said = {"firmware.elf": IMAGE, "hc3.json": EXAMPLE / "hc3.json", "/path/to/tactree": SOURCES,
                "PREFIX/include": f"{PREFIX}/include", ".": EXAMPLE}
        words = shlex.split(command.replace("\\\n", " "))
        run = tactree(*(said.get(word, word) for word in words))
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertGreater(int(re.search(r"^cycles +(\d+) at most", run.stdout, re.M)[1]), 10000)

    def test_image_contains_its_costs(self):
        with tempfile.TemporaryDirectory() as folder:
            points = pathlib.Path(folder, "plane.xyz")
            points.write_text("".join(f"{x} {y} 0\n" for x in range(60) for y in range(60)))
            build = ["build", points, "--unit", "mm", "--for", IMAGE, "-o", pathlib.Path(folder, "plane.blob"),
                     "--progress", "off", "--rate"]
            self.assertEqual(tactree(*build, 1000).returncode, 0)
            fast = tactree(*build, 20000)
            self.assertEqual(fast.returncode, 1)
            self.assertIn("hc3 renders this model at up to", fast.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
