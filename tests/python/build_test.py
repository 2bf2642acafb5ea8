"""tactree.build and tactree.build_file: the blob, the report and the warnings of tactree build.

usage: build_test.py TACTREE
"""
import pathlib
import sys
import unittest
import warnings

import numpy as np
import tactree

from clouds import SharedFolder, ball_arrays, runs_beside, signal_during, tool_error

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()
# Of the report: what differs between two runs.
MEASURED = ("stages", "seconds", "points_per_second", "peak_rss_bytes")
# A tetrahedron of 40 mm.
CORNERS = np.array([(0, 0, 0), (40, 0, 0), (0, 40, 0), (0, 0, 40)])
FACES = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])


def without_times(report):
    return {key: value for key, value in report.items() if key not in MEASURED}


class Folder(SharedFolder):
    tool = TACTREE

    def tool_build(self, scan, *options):
        """The bytes of the blob, the report, and what the tool says."""
        done = self.run_tool("build", scan, "-o", "tool.blob", "--report", "report.json", *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return (self.path / "tool.blob").read_bytes(), without_times(self.read("report.json")), done.stderr


class Files(Folder):
    def build_both(self, scan, options, **values):
        blob, report, said = self.tool_build(self.path / scan, *options)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            model = tactree.build_file(self.path / scan, **values)
        self.assertEqual(model.data.tobytes(), blob)
        self.assertEqual(without_times(model.report), report)
        self.assertEqual([str(warning.message) for warning in caught], report["warnings"])
        self.assertEqual({warning.category for warning in caught}, {tactree.BuildWarning} if caught else set())
        for warning in report["warnings"]:
            self.assertIn(warning, said)
        return model

    def test_same_blob_report_and_warnings(self):
        points, normals = ball_arrays()
        np.savetxt(self.path / "s.xyz", points)
        self.assertGreater(len(self.build_both("s.xyz", []).report["notes"]), 0)
        self.build_both("s.xyz", ["--unit", "mm"], unit="mm")
        np.savetxt(self.path / "inward.xyz", np.hstack([points, -normals]))
        model = self.build_both("inward.xyz", [])
        self.assertIn("reversed", " ".join(model.report["warnings"]))

    def test_options_have_effect_of_tool(self):
        points, _ = ball_arrays(800)
        np.savetxt(self.path / "o.xyz", points)
        pose = self.path / "pose.json"
        pose.write_text('{"pose": [0,0,1,0.1, 1,0,0,0, 0,1,0,0, 0,0,0,1], "scale": 2}')
        for options, values in (
                (["--scale", "2"], {"scale": 2}), (["--fit", "0.05"], {"fit_m": 0.05}),
                (["--fit", "device:falcon"], {"fit_device": "falcon"}), (["--centre"], {"centre": True}),
                (["--axis", "x"], {"axis": "x"}), (["--turn", "-30"], {"turn_deg": -30}),
                (["--pose", pose], {"pose": pose}),
                (["--spacing", "0.003"], {"spacing_m": 0.003}),
                (["--crop", "-1,-1,-0.01,1,1,1"], {"crop": [-1, -1, -0.01, 1, 1, 1]}),
                (["--flash-budget", "30000"], {"flash_budget": 30000}), (["--no-resample"], {"resample": False}),
                (["--profile", "paper"], {"profile": "paper"}),
                (["--material", "stiffness=500,static=0.2"], {"material": "stiffness=500,static=0.2"}),
                (["--outliers", "off"], {"outliers": "off"}), (["--outliers", "2"], {"outliers": 2}),
                (["--keep-largest"], {"keep_largest": True}), (["--min-piece", "9"], {"min_piece": 9}),
                (["--orient", "up"], {"orient": "up"}), (["--flip-normals"], {"flip_normals": True}),
                (["--viewpoint", "0,0,1", "--viewpoint", "0,0,-1"], {"viewpoints": [[0, 0, 1], [0, 0, -1]]}),
                (["--name", "n", "--threads", "1"], {"name": "n", "threads": 1}),
                (["--columns", "x=3,y=2,z=1"], {"columns": "x=3,y=2,z=1"}), (["--format", "xyz"], {"format": "xyz"})):
            with self.subTest(options=options):
                self.build_both("o.xyz", options, **values)
        points, _ = ball_arrays(40_000)
        np.savetxt(self.path / "large.xyz", points)
        limited = self.build_both("large.xyz", ["--memory-limit", "32M"], memory_limit=32 << 20)
        self.assertGreater(limited.report["dropped"]["beyond_memory_limit"], 10_000)

    def test_refusals_equal_tool(self):
        self.write("bad.xyz", "1 2\n")
        self.write("empty.xyz", "")
        for name in ("bad.xyz", "empty.xyz", "missing.xyz"):
            file = self.path / name
            run = self.run_tool("build", file, "-o", "x.blob")
            with self.assertRaises(tactree.FileError) as refused:
                tactree.build_file(file)
            self.assertEqual(str(refused.exception), tool_error(run))
        self.write("two.xyz", "0 0 0\n0 0 0\n")
        run = self.run_tool("build", self.path / "two.xyz", "--crop", "1,1,1,2,2,2", "-o", "x.blob")
        with self.assertRaises(tactree.BuildError) as refused:
            tactree.build_file(self.path / "two.xyz", crop=[1, 1, 1, 2, 2, 2])
        self.assertEqual(str(refused.exception), tool_error(run))


class Arrays(Folder):
    def test_arrays_equal_file(self):
        points, normals = ball_arrays()
        for given in (None, normals):
            np.savetxt(self.path / "s.xyz", points if given is None else np.hstack([points, given]), fmt="%.17g")
            _, report, _ = self.tool_build("s.xyz")
            model = tactree.build(points, given, name="s")
            self.tool_build("s.xyz")
            wanted = tactree.load(self.path / "tool.blob")
            np.testing.assert_array_equal(model.points, wanted.points)
            if given is None:
                np.testing.assert_array_equal(model.normals, wanted.normals)
            self.assertEqual(model.report["output_points"], report["output_points"])
            self.assertEqual(model.name, "s")

    def test_colours_select_materials(self):
        points, normals = ball_arrays(4000)
        colours = np.where(points[:, :1] > 0, [250, 10, 5], [120, 120, 120])
        self.write("materials.json", {"default": {"stiffness_N_m": 800}, "colours": [
            {"name": "felt", "rgb": [255, 0, 0], "tolerance": 30, "stiffness_N_m": 200}]})
        model = tactree.build(points, normals, colours, material=str(self.path / "materials.json"))
        self.assertEqual([material["stiffness_N_m"] for material in model.info["material_list"]], [800, 200])
        felt = model.point_materials == 1
        self.assertGreater(felt.sum(), 1000)
        self.assertTrue((model.points[felt, 0] > -0.002).all())
        self.assertTrue((model.points[~felt, 0] < 0.002).all())

    def test_samples_mesh(self):
        model = tactree.build(CORNERS, triangles=FACES, unit="mm")
        np.testing.assert_allclose(model.bounds_m, [[0, 0, 0], [0.04, 0.04, 0.04]], atol=1e-3)
        self.assertGreater(len(model), 1000)
        self.assertGreater(model.report["backed_share"], 0.9)
        self.assertEqual(model.query([[0.005, 0.005, 0.0005]])["inside"][0], 1)

    def test_drops_and_counts_non_finite_points(self):
        points, normals = ball_arrays()
        spoiled = np.vstack([[[np.nan, 0, 0], [np.inf, 0, 0]], points])
        model = tactree.build(spoiled, np.vstack([normals[:2], normals]))
        self.assertEqual(model.report["dropped"]["non_finite"], 2)
        np.testing.assert_array_equal(model.points, tactree.build(points, normals).points)

    def test_refuses_arrays_and_options(self):
        points, normals = ball_arrays(50)
        for arguments, options, words in (
                ((points[:, :2],), {}, "points: the shape (50, 2) is not (N, 3)"),
                (([[1, 2, 3], [1, 2]],), {}, "points: is not an array of numbers: "),
                (("scan.ply",), {}, "points: 'scan.ply' is not an array of numbers (read a file with build_file()"),
                ((points, "up"), {}, "normals: 'up' is not an array of numbers"),
                ((points, None, "red"), {}, "colors: 'red' is not an array of numbers"),
                ((points, None, None, [[0, 1], [0]]), {}, "triangles: is not an array of numbers"),
                ((points,), {"crop": "small"}, "crop: 'small' is not an array of numbers"),
                ((points,), {"viewpoints": [[0, 0], [0]]}, "viewpoints: is not an array of numbers"),
                ((np.empty((0, 3)),), {}, "points: there are none"),
                ((points, normals[1:]), {}, "normals: 49 rows for 50 points"),
                ((points, None, np.full((50, 3), 256)), {}, "colors[0]: 256 is not a whole number from 0 to 255"),
                ((points, None, np.full((50, 3), 0.5)), {}, "those of 0 .. 1 times 255"),
                ((CORNERS, None, None, FACES + 1), {}, ": 4 is not a whole number from 0 to 3"),
                ((CORNERS, None, None, FACES + 0.5), {}, "triangles[0]: 0.5 is not a whole number"),
                ((points,), {"fit_m": 1, "scale": 2}, "fit_m: excludes scale"),
                ((points,), {"fit_m": 1, "fit_device": "falcon"}, "fit_m: excludes fit_device"),
                ((points,), {"fit_device": "falcon", "scale": 2}, "fit_device: excludes scale"),
                ((points,), {"keep_largest": True, "min_piece": 5}, "keep_largest: excludes min_piece"),
                ((points,), {"unit": "mile"}, "unit: 'mile' is unknown (one of: cm, ft, in, m, mm, um)"),
                ((points,), {"scale": -1}, "scale: must be positive"),
                ((points,), {"turn_deg": float("nan")}, "turn: nan degrees is outside -360 .. 360"),
                ((points,), {"scale": "big"}, "scale: 'big' cannot be used"),
                ((points,), {"outliers": 0.5}, "outliers: '0.5' is neither off nor a number of at least 1"),
                ((points,), {"crop": [1, 1, 1, 0, 0, 0]}, "crop: requires"),
                ((points,), {"flash_budget": 9, "spacing_m": 1}, "flash_budget: cannot be combined"),
                ((points,), {"material": "stiffness=x"}, "stiffness")):
            with self.subTest(words=words), self.assertRaises(tactree.Error) as refused:
                tactree.build(*arguments, **options)
            self.assertIn(words, str(refused.exception))

    def test_reports_progress_and_its_exceptions(self):
        steps = []
        tactree.build(*ball_arrays(), progress=lambda step, fraction: steps.append((step, fraction)))
        self.assertIn("resampling", {step for step, _ in steps})
        self.assertTrue(all(0 <= fraction <= 1 for _, fraction in steps))

        def fail(step, fraction):
            raise RuntimeError(step)
        with self.assertRaisesRegex(RuntimeError, "cleaning"):
            tactree.build(*ball_arrays(), progress=fail)

    def test_ctrl_c_ends_build(self):
        points, normals = ball_arrays(5000)
        steps = {}  # whose method runs no Python code, in which a signal would be handled
        with self.assertRaises(KeyboardInterrupt), signal_during("build"):
            tactree.build(points, normals, progress=steps.setdefault)
        self.assertNotIn("finding gaps", steps)
        tactree.build(points, normals, progress=steps.setdefault)
        self.assertIn("finding gaps", steps)

    def test_other_threads_run_meanwhile(self):
        points, normals = ball_arrays(3000)
        self.assertTrue(runs_beside(lambda: tactree.build(points, normals)))


if __name__ == "__main__":
    unittest.main(verbosity=2)
