"""examples/python: plot_session.py with a picture, without matplotlib, and with wrong usage; the scan of ripple.py.

usage: example_test.py FOLDER
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

EXAMPLES = pathlib.Path(sys.argv.pop(1)).resolve()
PLOT_SESSION = EXAMPLES / "plot_session.py"
HIDE_MATPLOTLIB = "import sys, runpy; sys.modules['matplotlib'] = None; sys.argv = sys.argv[1:]; runpy.run_path(sys.argv[0], run_name='__main__')"


class PlotSession(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)
        tactree.build(*ball_arrays()).save(self.path / "ball.blob")

    def run_example(self, *arguments, hide=False):
        start = ["-c", HIDE_MATPLOTLIB, PLOT_SESSION] if hide else [PLOT_SESSION]
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


class Ripple(unittest.TestCase):
    def test_is_a_closed_ring_with_its_normals_outside(self):
        with tempfile.TemporaryDirectory() as folder:
            scan = pathlib.Path(folder) / "ripple.ply"
            with scan.open("w", encoding="utf-8") as file:
                subprocess.run([sys.executable, EXAMPLES / "ripple.py"], stdout=file, check=True)
            model = tactree.build_file(scan)
        self.assertEqual(model.report["warnings"], [])
        self.assertGreater(len(model), 50_000)
        # Within the tube, in the hole of the ring, and 0.5 mm above the crest of a wave.
        crest = 0.008 + 0.0006
        answers = model.query([[0.022, 0, 0.005], [0.0, 0, 0], [0.022, 0, crest + 0.0005]])
        self.assertEqual(list(answers["inside"]), [1, 0, 0])
        self.assertAlmostEqual(float(answers["signed_distance_m"][2]), 0.0005, places=5)
        np.testing.assert_allclose(tactree.vectors(answers[2:], "normal"), [[0, 0, 1]], atol=0.02)


if __name__ == "__main__":
    unittest.main(verbosity=2)
