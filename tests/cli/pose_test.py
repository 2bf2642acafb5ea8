"""Pose files: where a model is in the frame of a device, for build, simulate and scenes.

usage: pose_test.py TACTREE
"""
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
from tool_folder import SharedFolder, sheet  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()
# z of the model becomes x of the device, and x becomes -z.
ON_ITS_EDGE = [0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 0, 1]


def moved(pose, x, y, z):
    return [*pose[:3], x, *pose[4:7], y, *pose[8:11], z, *pose[12:]]


def flat(x, y, z):
    return moved([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], x, y, z)


class Poses(SharedFolder):
    tool = TACTREE

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.build_points("sheet", sheet(0.03, 0.001), "--spacing", 0.001)

    def press(self, name, start, end):
        """A path that rests at `end`, device frame."""
        rows = [(0, *start), (0.2, *end), (1, *end)]
        return self.write(name, "t_s,x,y,z\n" + "".join(",".join(map(str, row)) + "\n" for row in rows))

    def simulate(self, *arguments):
        done = self.run_tool("simulate", *arguments, "--seconds", 1, "--device", "cartesian",
                             "--device-friction", 0, "--json", "run.json", "--trace", "run.csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        heading, *_, last = (self.path / "run.csv").read_text().splitlines()
        row = dict(zip(heading.split(","), last.split(",")))
        return [float(row[f"force_{axis}_N"]) for axis in "xyz"], done.stderr

    def test_a_turned_and_moved_model_is_touched_where_it_is(self):
        self.write("edge.json", {"pose": moved(ON_ITS_EDGE, 0.1, 0, 0.02)})
        self.press("onto.csv", (0.11, 0, 0.02), (0.098, 0, 0.02))
        force, told = self.simulate("sheet.blob", "--pose", "edge.json", "--path", "onto.csv")
        self.assertGreater(force[0], 0.3)
        self.assertLess(max(abs(force[1]), abs(force[2])), 0.02)
        self.assertEqual(told, "")

    def test_the_identity_changes_nothing_to_be_felt(self):
        self.press("down.csv", (0, 0, 0.01), (0, 0, -0.002))
        plain, _ = self.simulate("sheet.blob", "--path", "down.csv", "--origin", 0, 0, 0)
        self.write("same.json", {"pose": flat(0, 0, 0), "scale": 1})
        posed, _ = self.simulate("sheet.blob", "--path", "down.csv", "--pose", "same.json")
        for a, b in zip(plain, posed, strict=True):
            self.assertAlmostEqual(a, b, places=6)

    def test_a_scale_makes_the_model_larger_about_its_origin(self):
        self.write("double.json", {"pose": flat(0, 0, 0), "scale": 2})
        self.press("beside.csv", (0.05, 0, 0.01), (0.05, 0, -0.002))  # beside the sheet at scale 1
        force, _ = self.simulate("sheet.blob", "--pose", "double.json", "--path", "beside.csv")
        self.assertGreater(force[2], 0.3)

    def test_a_script_touches_a_placed_model(self):
        self.write("edge.json", {"pose": moved(ON_ITS_EDGE, 0.05, 0, 0)})
        self.simulate("sheet.blob", "--pose", "edge.json", "--script", "press")
        self.assertGreater(self.read("run.json")["contact_ticks"], 100)

    def test_a_scene_takes_a_pose_file_for_each_body(self):
        self.write("edge.json", {"pose": moved(ON_ITS_EDGE, 0.1, 0, 0.02)})
        self.write("flat.json", {"pose": flat(0, 0, -0.05), "scale": 1.5})
        self.write("scene.json", {"bodies": [{"blob": 0, "pose": "edge.json"},
                                             {"blob": 0, "pose": "flat.json"}]})
        self.press("onto.csv", (0.11, 0, 0.02), (0.098, 0, 0.02))
        self.simulate("sheet.blob", "--scene", "scene.json", "--path", "onto.csv")
        first, second = self.read("run.json")["bodies"]
        self.assertGreater(first["contact_ticks"], 500)
        self.assertEqual(second["contact_ticks"], 0)
        self.press("down.csv", (0.04, 0, -0.03), (0.04, 0, -0.052))  # beside the sheet at scale 1
        self.simulate("sheet.blob", "--scene", "scene.json", "--path", "down.csv")
        self.assertGreater(self.read("run.json")["bodies"][1]["contact_ticks"], 500)

    def test_a_placed_session_is_recorded_and_replayed(self):
        self.write("edge.json", {"pose": moved(ON_ITS_EDGE, 0.05, 0, 0), "scale": 1.25})
        self.simulate("sheet.blob", "--pose", "edge.json", "--script", "press", "--record", "run.rec")
        done = self.run_tool("simulate", "sheet.blob", "--pose", "edge.json", "--replay", "run.rec")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("every tick is identical", done.stdout)
        done = self.run_tool("simulate", "sheet.blob", "--replay", "run.rec")
        self.assertEqual(done.returncode, 1)
        self.assertIn("is not one of the given blobs", done.stderr)

    def test_a_model_that_is_placed_beyond_reach_is_told(self):
        self.write("far.json", {"pose": flat(0, 0, 2)})
        done = self.run_tool("simulate", "sheet.blob", "--pose", "far.json", "--seconds", 1)
        warning = "warning: sheet.blob: premium does not reach all of the model where it is placed (move it"
        self.assertIn(warning, done.stderr)
        self.write("scene.json", {"bodies": [{"blob": "sheet.blob", "pose": "far.json"}]})
        done = self.run_tool("simulate", "--scene", "scene.json", "--seconds", 1)
        self.assertIn(warning, done.stderr)
        self.write("scene.json", {"bodies": [{"blob": "sheet.blob", "pose": flat(0, 0, 2)}]})
        done = self.run_tool("simulate", "--scene", "scene.json", "--seconds", 1)
        self.assertNotIn("warning", done.stderr)

    def test_a_built_pose_is_touched_in_the_frame_of_the_device(self):
        self.write("edge.json", {"pose": moved(ON_ITS_EDGE, 0.1, 0, 0.02), "scale": 2})
        self.press("onto.csv", (0.11, 0, 0.07), (0.098, 0, 0.07))  # above the sheet at scale 1
        done = self.run_tool("build", "sheet.csv", "-o", "placed.blob", "--spacing", 0.002, "--pose", "edge.json",
                             "--report", "report.json", "--progress", "off")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("--origin 0 0 0", done.stdout)
        report = self.read("report.json")
        self.assertEqual(report["pose_scale"], 2)
        for a, b in zip(report["pose"], moved(ON_ITS_EDGE, 0.1, 0, 0.02), strict=True):
            self.assertAlmostEqual(a, b, places=12)
        self.assertAlmostEqual(report["bounds_max_m"][0], 0.1, delta=1e-4)
        self.assertAlmostEqual(report["bounds_max_m"][2], 0.08, delta=1e-4)
        self.assertAlmostEqual(report["spacing_m"], 0.002)
        built, _ = self.simulate("placed.blob", "--origin", 0, 0, 0, "--path", "onto.csv")
        posed, _ = self.simulate("sheet.blob", "--pose", "edge.json", "--path", "onto.csv")
        self.assertGreater(built[0], 0.3)
        for a, b in zip(built, posed):
            self.assertAlmostEqual(a, b, delta=0.02)
        self.assertNotIn("pose", self.run_tool("build", "sheet.csv", "-o", "plain.blob").stdout)

    def refused(self, cause, *arguments, code=1):
        with self.subTest(cause):
            done = self.run_tool(*arguments)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(cause, done.stderr)
            if code == 1:
                self.assertRegex(done.stderr, r"\(.+\)\n?$")  # the remedy

    def test_refuses_invalid_files_with_place_cause_and_remedy(self):
        good = flat(0, 0, 0)
        for content, cause in (
                ("{", "p.json: is not JSON"),
                ([], "p.json: is not an object"),
                ({}, "p.json.pose: is missing"),
                ({"pos": good}, "p.json.pos: is an unknown key"),
                ({"pose": good[:12]}, "p.json.pose: is not a list of 16 numbers"),
                ({"pose": ["1", *good[1:]]}, "p.json.pose[0]: is not a number"),
                ({"pose": [2, *good[1:]]}, "p.json.pose: its upper left 3x3 part is not a rotation"),
                ({"pose": flat(0, 0, 11)}, "p.json.pose: its position is beyond +-10 m"),
                ({"pose": good, "scale": 0}, "p.json.scale: 0 is out of range"),
                ({"pose": good, "scale": "1"}, "p.json.scale: is not a number")):
            self.write("p.json", content)
            self.refused(cause, "simulate", "sheet.blob", "--pose", "p.json", "--seconds", 1)
        self.write("scaled.json", {"pose": good, "scale": 2})
        self.write("scene.json", {"bodies": [{"blob": 0, "keyframes": [{"t_s": 0, "pose": "scaled.json"}]}]})
        self.refused("bodies[0].keyframes[0].pose: its file has the scale 2", "simulate", "sheet.blob",
                     "--scene", "scene.json", "--seconds", 1)

    def test_refuses_what_a_pose_cannot_be_combined_with(self):
        self.write("p.json", {"pose": flat(0, 0, 0)})
        self.write("scene.json", {"bodies": [{"blob": 0}]})
        self.refused("--pose: it places one model, and 2 are given", "simulate", "sheet.blob", "sheet.blob",
                     "--pose", "p.json")
        self.refused("--pose: a board gets the pose of its model from its application", "simulate", "sheet.blob",
                     "--pose", "p.json", "--serve")
        self.refused("--panel: no application is connected that places or moves bodies", "simulate",
                     "sheet.blob", "--pose", "p.json", "--panel")
        self.refused("--pose", "simulate", "sheet.blob", "--pose", "p.json", "--origin", 0, 0, 0, code=2)
        self.refused("--pose", "simulate", "sheet.blob", "--pose", "p.json", "--scene", "scene.json", code=2)
        self.refused("none.json: there is no such file", "simulate", "sheet.blob", "--pose", "none.json")


if __name__ == "__main__":
    unittest.main(verbosity=2)
