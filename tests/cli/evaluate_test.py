"""tactree evaluate: every target is met, reproducibly, and reported as table, JSON and page.

usage: evaluate_test.py TACTREE CLASS      CLASS: Report, Scan or Seeds
"""
import math
import pathlib
import re
import sys
import unittest

sys.dont_write_bytecode = True
from tool_folder import SharedFolder, ball, csv  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()
RATES = {"1000", "4000", "10000"}


class InAFolder(SharedFolder):
    tool = TACTREE

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.first = cls.evaluate("first", "--require-targets", "--html", "first.html")

    @classmethod
    def evaluate(cls, name, *options):
        return cls.run_tool("evaluate", "--quick", "--no-scans", "--json", f"{name}.json", "--report", f"{name}.md",
                            *options)


class Report(InAFolder):
    def test_misses_known_targets_only(self):
        """An error of a face moves the bottom of a groove of 20 degrees by six times as much."""
        report = self.read("first.json")
        missed = {target["name"] for target in report["targets"] if not target["met"]}
        known = {"creases.off_m"}
        self.assertEqual(missed, known, self.first.stdout[-3000:])
        self.assertEqual(self.first.returncode, 1)
        self.assertIn("Not all targets are met.", self.first.stdout)
        for name in missed:
            self.assertRegex(self.first.stdout, rf"{name} .*\*\*missed\*\*")

    def test_creases_stop_hand(self):
        report = self.read("first.json")
        creases = report["creases"] | report["stairs"] | report["corners"] | report["unions"]
        self.assertGreater(len(creases), 30)
        for name, crease in creases.items():
            self.assertEqual(crease["lost"], 0, name)
            self.assertGreater(crease["ticks"], 5000, name)

    def test_reports_paper_tables_and_closed_loop(self):
        report = self.read("first.json")
        self.assertEqual(len(report["tables"]["1"]), 6)
        self.assertIn("2", report["tables"])
        self.assertEqual(set(report["loop"]["stiffness_max_N_m"]), RATES)
        for limit in report["loop"]["limits"]:
            self.assertAlmostEqual(limit["measured_N_m"] / limit["formula_N_m"], 1.0, delta=0.1)

    def test_page_shows_plots(self):
        page = (self.path / "first.md").read_text()
        pictures = list((self.path / "first").glob("*.svg"))
        self.assertGreaterEqual(len(pictures), 4)
        for picture in pictures:
            self.assertIn(f"(first/{picture.name})", page)

    def test_html_page_is_self_contained(self):
        page = (self.path / "first.html").read_text()
        self.assertGreaterEqual(page.count("<svg"), 5)
        self.assertIn("damping of the wall", page)
        self.assertGreater(page.count("<tr>"), 30)
        self.assertNotRegex(page.replace("http://www.w3.org/2000/svg", ""), r"(src|href)=|https?://|@import")


class Scan(SharedFolder):
    """A report about scans only, in seconds."""
    tool = TACTREE

    def test_reports_named_scan(self):
        points = list(ball(20000, 0.03))
        stray = [((0.0, 0.0, 0.045), (0.0, 0.0, 1.0))]
        self.write("cut.csv", csv([p for p in points if p[0][2] < 0.03 * math.cos(0.5)] + stray))
        done = self.run_tool("evaluate", "--quick", "--scan", "cut.csv", "--json", "cut.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        for part in ("## cut.csv", "kept; dropped: 1 ", "holes: 1, open boundaries: 0", "contact lost in 0;"):
            self.assertIn(part, done.stdout)
        report = self.read("cut.json")
        self.assertEqual(list(report), ["quick", "seed", "scans"])
        scan = report["scans"]["cut.csv"]
        self.assertEqual(scan["input_points"] - scan["kept_points"], 1)
        self.assertEqual(len(scan["openings"]), 1)
        self.assertGreater(scan["orientation"]["confidence"], 0.9)
        slides = scan["slides"]
        self.assertGreater(slides["ticks"], 1000)
        self.assertLess(slides["force_error_rms_N"], 0.05 * slides["expected_N"])
        self.assertLess(slides["force_step_N"], 0.2 * slides["expected_N"])

    def test_html_page_maps_holes(self):
        points = list(ball(20000, 0.03))
        self.write("ball.csv", csv(points))
        # A cap of 0.5 rad of the ball of 30 mm: a hole of about 29 mm.
        self.write("cut.csv", csv(point for point in points if point[0][2] < 0.03 * math.cos(0.5)))
        self.run_tool("evaluate", "--quick", "--scan", "ball.csv", "--scan", "cut.csv", "--html", "holes.html",
                      check=True)
        whole, holed = (self.path / "holes.html").read_text().split(">Openings of ball.csv</h")[1].split(
            ">Openings of cut.csv</h")
        self.assertNotIn("<circle", whole)
        self.assertEqual(holed.count("<circle"), 3)  # from three sides
        width = float(re.search(r"<td>hole</td>\s*<td>([\d.]+)</td>", holed)[1])
        self.assertAlmostEqual(width, 2 * 30 * math.sin(0.5), delta=1.5)
        # To scale: the ball of 60 mm fills the square of 290.
        for radius in re.findall(r'<circle [^>]* r="([\d.]+)"', holed):
            self.assertAlmostEqual(2 * float(radius), width / 60 * 290, delta=3)

    def test_reports_as_build_does(self):
        """A ball beside the origin, open at its lowest y, in unusual columns."""
        rows = [(0.1 + p[0], 0.05 + p[1], 0.02 + p[2], *n) for p, n in ball(20000, 0.03) if p[1] > -0.03 * math.cos(0.7)]
        self.write("odd.txt", "".join(f"{i} {z} {y} {x} {nx} {ny} {nz}\n" for i, (x, y, z, nx, ny, nz)
                                      in enumerate(rows)))
        columns = ("--columns", "z=2,y=3,x=4,nx=5,ny=6,nz=7", "--format", "txt")
        self.run_tool("build", "odd.txt", "-o", "odd.blob", "--report", "built.json", *columns, check=True)
        done = self.run_tool("evaluate", "--quick", "--scan", "odd.txt", "--json", "odd.json", *columns)
        self.assertEqual(done.returncode, 0, done.stderr)
        built, scan = self.read("built.json"), self.read("odd.json")["scans"]["odd.txt"]
        for shown, expected in zip(scan["openings"][0]["centre_m"], built["openings"][0]["centre_m"], strict=True):
            self.assertAlmostEqual(shown, expected, delta=2e-3)
        (lying,) = (note for note in built["notes"] if "on its side" in note)
        self.assertIn("Note: " + lying, done.stdout)
        self.assertIn(lying, scan["notes"])

    def test_slides_show_roughness(self):
        even = list(ball(20000, 0.03))
        self.write("even.csv", csv(even))
        self.write("rough.csv", csv([([c * (1 + 0.005 * (i % 2)) for c in p], n) for i, (p, n) in enumerate(even)]))
        done = self.run_tool("evaluate", "--quick", "--scan", "even.csv", "--scan", "rough.csv", "--json", "r.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        even, rough = (self.read("r.json")["scans"][name]["slides"] for name in ("even.csv", "rough.csv"))
        self.assertLess(even["force_error_rms_N"], 1e-3)
        self.assertGreater(rough["force_error_rms_N"], 5 * even["force_error_rms_N"])

    def test_refuses_other_files(self):
        self.write("note.txt", "Dear reader, this is a letter.\n")
        self.write("ball.csv", csv(ball(2000, 0.03)))
        (self.path / "folder").mkdir()
        for name in ("note.txt", "folder", "absent.ply"):
            done = self.run_tool("evaluate", "--quick", "--scan", "ball.csv", "--scan", name, "--json", "n.json")
            self.assertEqual(done.returncode, 1, name)
            self.assertRegex(done.stderr, f"error: {name}: .+")
            self.assertFalse((self.path / "n.json").exists())


class Seeds(InAFolder):
    def test_reproduces_results(self):
        self.assertEqual(self.evaluate("second").returncode, 0)
        self.assertEqual(self.read("second.json"), self.read("first.json"))

    def test_another_seed_gives_other_probes(self):
        self.evaluate("other", "--seed", "2")
        self.assertNotEqual(self.read("other.json"), self.read("first.json"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
