"""Sizes of models: how they are printed, and which get a warning; files that are no blob.

usage: advice_test.py TACTREE
"""
import pathlib
import resource
import sys
import unittest

sys.dont_write_bytecode = True
from tool_folder import ToolFolder  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()


class Folder(ToolFolder):
    tool = TACTREE
    points = 700


class Sizes(Folder):
    def test_size_has_fitting_unit(self):
        self.assertRegex(self.build("--scale", "4e6").stdout,
                         r"model     [\d.]+ x [\d.]+ x [\d.]+ km, ")
        self.assertRegex(self.run_tool("info", "s.blob").stdout,
                         r"(?s)size          [\d.]+ x [\d.]+ x [\d.]+ km\n.*\.\.\. [\d.]+ km\n")
        self.assertRegex(self.build("--scale", "0.1").stdout,
                         r"model     [\d.]+ x [\d.]+ x [\d.]+ mm, ")

    def test_info_warns_of_implausible_size(self):
        for scale, words in (("30", "but a haptic device reaches"), ("0.01", "too small to feel")):
            self.build("--scale", scale)
            done = self.run_tool("info", "s.blob", "--json", "i.json")
            self.assertEqual(done.returncode, 0)
            self.assertIn("tactree: warning: s.blob: the model is", done.stderr)
            self.assertIn(words, done.stderr)
            self.assertIn(words, self.read("i.json")["warnings"][0])
        self.build("--scale", "5")
        self.assertEqual(self.run_tool("info", "s.blob").stderr, "")
        done = self.run_tool("info", "s.blob", "--device", "falcon")
        self.assertIn("more than falcon reaches", done.stderr)

    def test_refuses_huge_foreign_file_by_header(self):
        with open(self.path / "large.ply", "wb") as file:
            file.write(b"ply\nformat ascii 1.0\n")
            file.truncate(3 << 30)
        for verb in (("info",), ("check",), ("query", "--points", "s.xyz")):
            done = self.run_tool(verb[0], "large.ply", *verb[1:])
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn("large.ply: refused: not a Tactree blob", done.stderr)
        # Not by a limit of the address space, which the sanitizers need.
        resident_KiB = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        self.assertLess(resident_KiB, 1 << 20)


if __name__ == "__main__":
    unittest.main(verbosity=2)
