"""examples/python/plot_session.py: with a picture, without matplotlib, and with wrong usage.

usage: example_test.py EXAMPLE
"""
import importlib.util
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import tactree

from clouds import ball_arrays

EXAMPLE = pathlib.Path(sys.argv.pop(1)).resolve()
HIDE_MATPLOTLIB = "import sys, runpy; sys.modules['matplotlib'] = None; sys.argv = sys.argv[1:]; runpy.run_path(sys.argv[0], run_name='__main__')"


class Example(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)
        tactree.build(*ball_arrays()).save(self.path / "ball.blob")

    def run_example(self, *arguments, hide=False):
        start = ["-c", HIDE_MATPLOTLIB, EXAMPLE] if hide else [EXAMPLE]
        return subprocess.run([sys.executable, *start, *map(str, arguments)], cwd=self.path, capture_output=True, text=True,
                              check=False)

    def test_names_missing_matplotlib(self):
        done = self.run_example("ball.blob", "--seconds", "0.5", "--plot", "ball.png", hide=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"(?m)^in contact for \d+ of 500 ms, largest force \d+\.\d+ N$")
        self.assertIn("no plot: matplotlib is missing (apt-get install python3-matplotlib)", done.stderr)
        self.assertFalse((self.path / "ball.png").exists())

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "python3-matplotlib is not installed")
    def test_plots(self):
        done = self.run_example("ball.blob", "--seconds", "0.5", "--plot", "ball.png", "--trace", "ball.npy")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((self.path / "ball.png").read_bytes()[:4], b"\x89PNG")
        trace = np.load(self.path / "ball.npy")
        self.assertEqual(len(trace), 500)
        self.assertTrue(trace["in_contact"].any())

    def test_refusals(self):
        done = self.run_example("missing.blob")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^plot_session: missing\.blob: .*\n$")


if __name__ == "__main__":
    unittest.main(verbosity=2)
