"""Every file that a document names exists, and every link leads to one."""
import pathlib
import re
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = "bench|cmake|core|docs|examples|firmware|hal|host|scripts|tests|toolchains|tools"
GENERATED = {"firmware/bare"}  # by the build
INCLUDE_FOLDERS = sorted(path.parent for path in ROOT.glob("*/**/include/tactree")
                         if not path.is_relative_to(ROOT / "build"))


def exists(name, root):
    """A path below the root, or, as in an #include, below one of the include folders."""
    pattern = re.sub(r"<\w+>|NAME", "*", name)
    return any(next(folder.glob(pattern), None) for folder in (root, *(i / "tactree" for i in INCLUDE_FOLDERS)))


def missing(page, root=ROOT):
    text = page.read_text()
    for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", text):
        if "://" not in target and not (page.parent / target).exists():
            yield target
    for name in re.findall(rf"`((?:{FOLDERS})/[\w./*<>-]*)`", text):
        if name.rstrip("/") not in GENERATED and not exists(name.rstrip("/"), root):
            yield name


class References(unittest.TestCase):
    def test_every_page(self):
        pages = [ROOT / "README.md", *ROOT.glob("docs/**/*.md"), *ROOT.glob("firmware/**/*.md"),
                 *ROOT.glob("examples/**/*.md")]
        self.assertGreater(len(pages), 30)
        found = [f"{page.relative_to(ROOT)}: {name}" for page in pages for name in missing(page)]
        self.assertEqual(found, [])

    def test_introduction_fits_on_screen(self):
        text = (ROOT / "README.md").read_text()
        self.assertLessEqual(len(text.splitlines()), 60)
        introduction = text.split("\n## ")[0]
        self.assertLess(len(introduction.splitlines()), 40)
        for part in ("./demo", "./test", "Debian 12", "docs/images/"):
            self.assertIn(part, introduction)

    def test_contributor_page_names_existing_paths(self):
        text = (ROOT / "docs/CONTRIBUTING.md").read_text()
        paths = re.findall(r"\n\*\*From .*\*\*\n\n((?:\d+\. .*\n(?:   .*\n)*)+)", text)
        self.assertEqual(len(paths), 3)
        for path in paths:
            steps = re.findall(r"(?m)^\d+\. `([^`]+)`: ", path)
            self.assertEqual(len(steps), len(re.findall(r"(?m)^\d+\. ", path)))
            self.assertLessEqual(len(steps), 10)
            for name in steps:
                self.assertTrue((ROOT / name).is_file(), name)

    def test_describes_every_product_folder(self):
        table = (ROOT / "docs/CONTRIBUTING.md").read_text().split("## Source tree")[1].split("**From")[0]
        layers = (ROOT / "scripts/check-layers").read_text().split('"""')[3]
        folders = re.findall(r"(?m)^((?:core|hal|host|tools|firmware)[\w/]*) ", layers)
        self.assertGreater(len(folders), 12)
        for name in [part for folder in folders for part in folder.split("/")]:
            self.assertRegex(table, rf"\b{name}\b")

    def test_finds_missing_paths(self):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder, "page.md")
            page.write_text("[a](no.md) [b](page.md#top) `core/src/no.cpp` `core/src` `scripts/check-*` `core/link/wire/frame.hpp`")
            self.assertEqual(list(missing(page)), ["no.md", "core/src/no.cpp"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
