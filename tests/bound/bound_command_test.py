#!/usr/bin/env python3
"""`tactree bound`, and the timing of boards in info and build. Skipped without the board's image.

usage: bound_command_test.py TACTREE BLOB SOURCES
"""
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

TACTREE, BLOB, SOURCES = sys.argv[1:4]
BOARD = "netduinoplus2"
IMAGE = pathlib.Path(SOURCES, "build/cortex-m4f/firmware", BOARD + ".elf")


def tactree(*arguments):
    return subprocess.run([TACTREE, *map(str, arguments)], capture_output=True, text=True)


@unittest.skipUnless(IMAGE.exists(), f"no image for {BOARD}")
class BoundCommand(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.folder = pathlib.Path(self.temporary.name)

    def bound(self, *arguments):
        report = self.folder / "bound.json"
        run = tactree("bound", IMAGE, "--blob", BLOB, "--json", report, *arguments)
        self.assertEqual(run.returncode, 0, run.stderr)
        return json.loads(report.read_text())

    def test_report(self):
        report = self.bound()
        self.assertIsNone(report["cycles"])
        self.assertAlmostEqual(sum(f["instructions"] for f in report["functions"]),
                               report["instructions"], delta=1)
        self.assertTrue(all(loop["bound"] and loop["line"] for loop in report["loops"]))
        self.assertGreater(self.bound("--bodies", 2)["instructions"], report["instructions"])
        self.assertLess(self.bound("--mode", "paper")["instructions"], report["instructions"])

    def test_rate(self):
        report = self.bound("--board", BOARD)
        self.assertGreater(report["cycles"], report["instructions"])
        highest = report["rate_max_hz"]
        base = ["bound", IMAGE, "--blob", BLOB, "--board", BOARD, "--rate"]
        self.assertEqual(tactree(*base, highest).returncode, 0)
        refused = tactree(*base, highest + 1)
        self.assertEqual(refused.returncode, 1)
        self.assertIn(f"at up to {highest:.0f} Hz", refused.stderr)

    def test_board_admits_sustainable_rate(self):
        run = ["simulate", BLOB, "--board", BOARD, "--seconds", 0.02, "--allow-no-contact", "--rate"]
        self.assertEqual(tactree(*run, 1000).returncode, 0)
        refused = tactree(*run, 10000)
        self.assertEqual(refused.returncode, 1)
        highest = re.search(r"use --rate (\d+) or less", refused.stderr)
        self.assertIsNotNone(highest, refused.stderr)
        self.assertIn(f"cycles on {BOARD}", refused.stderr)
        self.assertEqual(tactree(*run, highest[1]).returncode, 0)
        self.assertEqual(tactree(*run, int(highest[1]) + 1).returncode, 1)
        bare = tactree(*run, 10000, "--firmware", IMAGE.parent / "bare")
        self.assertEqual(bare.returncode, 0, bare.stderr)

    def test_info(self):
        run = tactree("info", BLOB, "--board", BOARD)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("costs stored in the image", run.stdout)
        shown = re.findall(r"at most (\d+) cycles per tick at 168 MHz\n +=(.*)\n", run.stdout)
        self.assertEqual(len(shown), 2)
        limits = self.limits_of(BLOB)
        for cycles, terms in shown:
            self.assertEqual(eval(terms, {"__builtins__": {}}, limits), int(cycles), terms)
        self.assertIn("(points_per_leaf_max - 32)", shown[1][1])

    def limits_of(self, blob):
        """The limits that determine the cycles of a tick; the model has one material."""
        file = self.folder / "facts.json"
        self.assertEqual(tactree("info", blob, "--json", file).returncode, 0)
        facts = json.loads(file.read_text())
        return {**{name: facts[name] for name in facts if name.startswith("points_per")}, "depth": facts["depth"]}

    def test_build(self):
        points = self.folder / "plane.xyz"
        points.write_text("".join(f"{x} {y} 0\n" for x in range(40) for y in range(40)))
        blob = self.folder / "plane.blob"
        base = ["build", points, "--unit", "mm", "--spacing", "0.001", "--board", BOARD, "-o", blob,
                "--rate"]
        refused = tactree(*base, 20000)
        self.assertEqual(refused.returncode, 1)
        self.assertIn(f"{BOARD} renders this model at up to", refused.stderr)
        self.assertFalse(blob.exists())
        built = tactree(*base, 50)
        self.assertEqual(built.returncode, 0, built.stderr)
        self.assertTrue(blob.exists())

    def rates_of(self, blob, board=BOARD):
        run = tactree("info", blob, "--board", board)
        self.assertEqual(run.returncode, 0, run.stderr)
        return [int(rate) for rate in re.findall(r"up to (\d+) Hz", run.stdout)]

    def test_knows_board_with_real_parts(self):
        points = self.folder / "plane.xyz"
        points.write_text("".join(f"{x} {y} 0\n" for x in range(40) for y in range(40)))
        blob = self.folder / "plane.blob"
        built = tactree("build", points, "--unit", "mm", "--board", "stm32f405", "--rate", 4000, "-o", blob)
        self.assertEqual(built.returncode, 0, built.stderr)
        self.assertLessEqual(blob.stat().st_size, 384 << 10)
        self.assertGreaterEqual(self.rates_of(blob, "stm32f405")[0], 4000)
        refused = tactree("simulate", blob, "--board", "stm32f405")
        self.assertNotEqual(refused.returncode, 0)
        self.assertIn("netduinoplus2", refused.stderr)

    def test_slow_board_gets_coarser_model(self):
        # One half is eight times as dense as the other: at a fine spacing, more points in a ball there.
        places = [(0.25 * i, 0.5 * j) for i in range(240) for j in range(240)]
        places += [(60 + 2 * i, 2 * j) for i in range(30) for j in range(60)]
        points = self.folder / "hill.xyz"
        points.write_text("".join(f"{x} {y} {20 * math.exp(-((x - 60) ** 2 + (y - 60) ** 2) / 400):.4f}\n"
                                  for x, y in places))
        fine, coarse, between = (self.folder / name for name in ("fine.blob", "coarse.blob", "between.blob"))
        base = ["build", points, "--unit", "mm", "--board", BOARD, "-o"]
        for blob, more in ((fine, []), (coarse, ["--spacing", "0.004"])):
            built = tactree(*base, blob, *more)
            self.assertEqual(built.returncode, 0, built.stderr)
        slow, fast = self.rates_of(fine)[0], self.rates_of(coarse)[0]
        self.assertGreater(fast, slow + 400)
        built = tactree(*base, between, "--rate", slow + 400)
        self.assertEqual(built.returncode, 0, built.stderr)
        self.assertIn("renders only a coarser model", built.stdout)
        self.assertGreaterEqual(self.rates_of(between)[0], slow + 400)
        self.assertLess(between.stat().st_size, fine.stat().st_size)
        self.assertGreater(between.stat().st_size, coarse.stat().st_size)

    def test_sustained_rate_implies_lower_rates(self):
        highest = self.bound("--board", BOARD)["rate_max_hz"]
        base = ["bound", IMAGE, "--blob", BLOB, "--board", BOARD, "--rate"]
        for share in (0.1, 0.3, 0.5, 0.7, 0.9, 0.99):
            run = tactree(*base, share * highest)
            self.assertEqual(run.returncode, 0, run.stderr)

    def test_refused(self):
        self.assertIn("cannot be read", tactree("bound", self.folder / "none.elf").stderr)
        self.assertIn("the timing of toaster is unknown", tactree("bound", IMAGE, "--board", "toaster").stderr)
        other = tactree("bound", IMAGE, "--sources", self.folder)
        self.assertEqual(other.returncode, 1)
        self.assertIn("a loop that matches no loop in the source", other.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
