"""Sizes of models: how they are printed, and which get a warning; files that are no blob.

usage: advice_test.py TACTREE
"""
import json
import math
import pathlib
import resource
import subprocess
import sys
import tempfile
import unittest

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()


def sphere(count, radius):
    """Evenly spread points, one text line each."""
    golden = math.pi * (3 - math.sqrt(5))
    lines = []
    for i in range(count):
        z = 1 - (2 * i + 1) / count
        ring = math.sqrt(1 - z * z)
        lines.append(f"{radius * ring * math.cos(golden * i)} "
                     f"{radius * ring * math.sin(golden * i)} {radius * z}")
    return "\n".join(lines) + "\n"


def little_memory():
    resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)
        (self.path / "s.xyz").write_text(sphere(700, 0.05))

    def run_tool(self, *arguments, **options):
        options = {"capture_output": True, "text": True, "timeout": 60, **options}
        return subprocess.run([TACTREE, *arguments], cwd=self.path, check=False, **options)

    def build(self, *arguments):
        done = self.run_tool("build", "s.xyz", "-o", "s.blob", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done


class Sizes(Folder):
    def test_a_size_has_a_unit_that_fits(self):
        self.assertRegex(self.build("--scale", "4e6").stdout,
                         r"model     [\d.]+ x [\d.]+ x [\d.]+ km, ")
        self.assertRegex(self.run_tool("info", "s.blob").stdout,
                         r"(?s)size          [\d.]+ x [\d.]+ x [\d.]+ km\n.*\.\.\. [\d.]+ km\n")
        self.assertRegex(self.build("--scale", "0.1").stdout,
                         r"model     [\d.]+ x [\d.]+ x [\d.]+ mm, ")

    def test_info_warns_of_a_size_that_no_hand_can_feel(self):
        for scale, words in (("30", "but a haptic device reaches"), ("0.01", "too small to feel")):
            self.build("--scale", scale)
            done = self.run_tool("info", "s.blob", "--json", "i.json")
            self.assertEqual(done.returncode, 0)
            self.assertIn("tactree: warning: s.blob: the model is", done.stderr)
            self.assertIn(words, done.stderr)
            self.assertIn(words, json.loads((self.path / "i.json").read_text())["warnings"][0])
        self.build("--scale", "5")
        self.assertEqual(self.run_tool("info", "s.blob").stderr, "")
        done = self.run_tool("info", "s.blob", "--device", "falcon")
        self.assertIn("larger than falcon reaches", done.stderr)

    def test_a_huge_file_that_is_no_blob_is_refused_by_its_header(self):
        with open(self.path / "large.ply", "wb") as file:
            file.write(b"ply\nformat ascii 1.0\n")
            file.truncate(3 << 30)
        for verb in (("info",), ("check",), ("query", "--points", "s.xyz")):
            done = self.run_tool(verb[0], "large.ply", *verb[1:], preexec_fn=little_memory)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn("large.ply: refused: not a Tactree blob", done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
