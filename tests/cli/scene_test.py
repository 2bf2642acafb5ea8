"""Scenes end to end: two scans -> build -> simulate --scene, and each cause of a refusal.

usage: scene_test.py TACTREE
"""
import math
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
from tool_folder import SharedFolder, ball, sheet  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()
IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]


def at(x, y, z):
    pose = list(IDENTITY)
    pose[3], pose[7], pose[11] = x, y, z
    return pose


class Scenes(SharedFolder):
    tool = TACTREE

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.build_points("sheet", sheet(0.03, 0.001), "--spacing", 0.001)
        cls.build_points("ball", ball(5000, 0.02), "--spacing", 0.001)
        # Rests 2 mm below z = 0.
        cls.write("press.csv", "t_s,x,y,z\n0,0,0,0.01\n0.2,0,0,-0.002\n1,0,0,-0.002\n")
        cls.write("still.csv", "t_s,x,y,z\n0,0,0,0.002\n1,0,0,0.002\n")

    def run_scene(self, bodies, *arguments, path="press.csv", blobs=("sheet.blob", "ball.blob")):
        scene = self.write("scene.json", bodies if isinstance(bodies, str) else {"bodies": bodies})
        (self.path / "run.json").unlink(missing_ok=True)
        return self.run_tool("simulate", *blobs, "--scene", scene, "--path", path, "--seconds", 1,
                             "--device", "cartesian", "--device-friction", 0, "--json", "run.json",
                             *arguments)

    def report(self, *arguments, **options):
        done = self.run_scene(*arguments, **options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return self.read("run.json"), done.stdout

    def test_reports_each_body(self):
        # Down onto the sheet, and along it into the ball, which is sunk in it by a half.
        self.write("corner.csv", "t_s,x,y,z\n0,0,0,0.01\n0.2,0,0,-0.002\n0.4,0.004,0,-0.002\n1,0.004,0,-0.002\n")
        run, text = self.report([{"blob": 0}, {"blob": 1, "pose": at(0.022, 0, 0)},
                                 {"blob": 0, "pose": at(0, 0, -1)}], path="corner.csv")
        self.assertEqual([b["blob"] for b in run["bodies"]], ["sheet.blob", "ball.blob", "sheet.blob"])
        sheet_body, ball_body, far = run["bodies"]
        self.assertGreater(sheet_body["contact_ticks"], 500)
        self.assertGreater(ball_body["contact_ticks"], 500)
        self.assertEqual(far, {"blob": "sheet.blob", "contact_ticks": 0, "force_max_N": 0,
                               "torque_max_Nm": 0})
        # One spring, whose force is the sum of those on the bodies.
        both = math.hypot(sheet_body["force_max_N"], ball_body["force_max_N"])
        self.assertGreater(ball_body["force_max_N"], 0.3)
        self.assertAlmostEqual(both, run["force_max_N"], delta=0.2 * both)
        self.assertEqual(run["crowded_ticks"], 0)
        self.assertIn("body 1             ball.blob: in contact", text)

    def test_places_blobs_at_origin_without_scene(self):
        done = self.run_tool("simulate", "sheet.blob", "sheet.blob", "--path", "press.csv",
                             "--seconds", 1, "--json", "run.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        run = self.read("run.json")
        self.assertEqual(len(run["bodies"]), 2)
        self.assertGreater(run["force_max_N"], 0.1)
        # In the same place they are one: as stiff as one of them.
        self.assertAlmostEqual(max(body["force_max_N"] for body in run["bodies"]),
                               run["force_max_N"], delta=0.01)

    def test_identifies_repeated_blob_by_index(self):
        run, _ = self.report([{"blob": 2, "pose": at(0, 0, -0.02)}, {"blob": 1}], blobs=("sheet.blob", "sheet.blob", "ball.blob"))
        self.assertEqual([b["blob"] for b in run["bodies"]], ["ball.blob", "sheet.blob"])

    def test_resting_body_equals_plain_model(self):
        in_a_scene, _ = self.report([{"blob": "sheet.blob"}], blobs=())
        done = self.run_tool("simulate", "sheet.blob", "--path", "press.csv", "--seconds", 1,
                             "--device", "cartesian", "--device-friction", 0, "--json", "plain.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        plain = self.read("plain.json")
        self.assertEqual(in_a_scene["trace_crc32"], plain["trace_crc32"])
        self.assertEqual(in_a_scene["contact_ticks"], plain["contact_ticks"])

    def test_moving_bodies_push_resting_hand(self):
        keyframes = [{"t_s": 0, "pose": at(0, 0, -0.01)}, {"t_s": 0.5, "pose": at(0, 0, 0.005)}]
        for body in ({"blob": 0, "pose": at(0, 0, -0.01), "linear_velocity_m_s": [0, 0, 0.015]},
                     {"blob": 0, "keyframes": keyframes},
                     {"blob": 1, "keyframes": [{"t_s": t["t_s"], "pose": at(0, 0, t["pose"][11] - 0.02)}
                                               for t in keyframes],
                      "from_s": -1, "until_s": 0.9}):
            run, _ = self.report([body], path="still.csv")
            self.assertGreater(run["force_max_N"], 0.5)
            still, _ = self.report([{**body, "until_s": 0.1}], "--allow-no-contact", path="still.csv")
            self.assertEqual(still["force_max_N"], 0)

    def test_rotating_ball_drags_hand(self):
        turning = {"blob": 1, "pose": at(0, 0, -0.02), "angular_velocity_rad_s": [2, 0, 0]}
        self.report([turning], "--trace", "trace.csv")
        heading, *_, last = (self.path / "trace.csv").read_text().splitlines()
        row = dict(zip(heading.split(","), last.split(",")))
        force_y = next(float(row[k]) for k in row if k.startswith("force") and k.rstrip("_N").endswith("y"))
        self.assertLess(force_y, -0.05)

    def test_reports_too_many_reachable_bodies(self):
        run, text = self.report([{"blob": 0}] * 3)
        self.assertGreater(run["crowded_ticks"], 100)
        self.assertEqual(run["bodies"][2]["contact_ticks"], 0)
        self.assertIn("more than 2 bodies within reach", text)

    def refused(self, bodies, cause, *arguments, code=1, **options):
        with self.subTest(cause):
            done = self.run_scene(bodies, *arguments, **options)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(cause, done.stderr)
            self.assertRegex(done.stderr, r"\(.+\)\n?$")  # the remedy
            self.assertFalse((self.path / "run.json").exists())

    def test_refuses_invalid_scenes_with_hint(self):
        mirrored = [-1, *IDENTITY[1:]]
        scaled = [2, *IDENTITY[1:]]
        column = [*IDENTITY[:12], 0.1, 0, 0, 1]
        one, two = {"t_s": 0, "pose": IDENTITY}, {"t_s": 1, "pose": at(0, 0, 0.1)}
        for text, cause in (
                ("{", "scene.json: is not JSON"),
                ('{"bodies": [{"blob": 0, "from_s": NaN}]}', "scene.json: is not JSON"),
                ("[]", "scene.json: is not an object"),
                ('{"bodys": []}', "scene.json.bodys: is an unknown key"),
                ("{}", "scene.json: bodies: is not a list"),
                ('{"bodies": 3}', "scene.json: bodies: is not a list"),
                ('{"bodies": [3]}', "bodies[0]: is not an object")):
            self.refused(text, cause)
        for body, cause in (
                ({}, "bodies[0].blob: is neither a file nor the index of one of the 2 blobs"),
                ({"blob": 2}, "bodies[0].blob: is neither"),
                ({"blob": -1}, "bodies[0].blob: is neither"),
                ({"blob": 0.5}, "bodies[0].blob: is neither"),
                ({"blob": "no.blob"}, "no.blob: "),
                ({"blob": 0, "color": 1}, "bodies[0].color: is an unknown key"),
                ({"blob": 0, "pose": IDENTITY[:12]}, "bodies[0].pose: is not a list of 16 numbers"),
                ({"blob": 0, "pose": ["1", *IDENTITY[1:]]}, "bodies[0].pose[0]: is not a number"),
                ({"blob": 0, "pose": mirrored}, "bodies[0].pose: its upper left 3x3 part"),
                ({"blob": 0, "pose": scaled}, "bodies[0].pose: its upper left 3x3 part"),
                ({"blob": 0, "pose": column}, "bodies[0].pose: its last row"),
                ({"blob": 0, "pose": at(11, 0, 0)}, "bodies[0]: a pose is not a rotation, or beyond +-10 m"),
                ({"blob": 0, "linear_velocity_m_s": [0, 0]}, "linear_velocity_m_s: is not a list of 3"),
                ({"blob": 0, "linear_velocity_m_s": [0, 0, 11]}, "bodies[0]: a body moves faster"),
                ({"blob": 0, "angular_velocity_rad_s": [0, 0, 101]}, "bodies[0]: a body moves faster"),
                ({"blob": 0, "from_s": "1"}, "bodies[0].from_s: is not a number"),
                ({"blob": 0, "from_s": 2, "until_s": 1}, "bodies[0]: ends (until_s) before it begins (from_s)"),
                ({"blob": 0, "until_s": [1]}, "bodies[0].until_s: is not a number"),
                ({"blob": 0, "keyframes": 1}, "bodies[0].keyframes: is not a list"),
                ({"blob": 0, "keyframes": [one], "pose": IDENTITY}, "or combined with a pose"),
                ({"blob": 0, "keyframes": []}, "bodies[0]: there is no keyframe"),
                ({"blob": 0, "keyframes": [1]}, "keyframes[0]: is not an object"),
                ({"blob": 0, "keyframes": [{"pose": IDENTITY}]}, "keyframes[0].t_s: is not a number"),
                ({"blob": 0, "keyframes": [{"t_s": 0, "pos": IDENTITY}]}, "keyframes[0].pos: is an unknown key"),
                ({"blob": 0, "keyframes": [one, {"t_s": 1, "pose": scaled}]}, "keyframes[1].pose: its upper"),
                ({"blob": 0, "keyframes": [two, one]}, "the times of the keyframes do not ascend"),
                ({"blob": 0, "keyframes": [one, {**two, "t_s": 0.001}]}, "a body moves faster")):
            self.refused([body], cause)
            self.refused([{"blob": 1}, body], cause.replace("bodies[0]", "bodies[1]"))
        self.refused([], "scene.json: bodies: 0 bodies are outside 1 .. 8")
        self.refused([{"blob": 0}] * 9, "scene.json: bodies: 9 bodies are outside 1 .. 8")

    def test_names_body_that_cannot_be_rendered(self):
        done = self.run_tool("build", "ball.csv", "-o", "paper.blob", "--profile", "paper",
                             "--progress", "off")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.refused([{"blob": 0}, {"blob": "paper.blob"}], "paper.blob: the blob was built without")
        (self.path / "broken.blob").write_bytes((self.path / "ball.blob").read_bytes()[:-8])
        self.refused([{"blob": 0}, {"blob": "broken.blob"}], "broken.blob: ")

    def test_refuses_missing_files_and_boards_with_several_bodies(self):
        done = self.run_tool("simulate", "--scene", "none.json")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("none.json: there is no such file", done.stderr)
        self.refused([{"blob": 0}, {"blob": 1}], "--board mps2-an386: a board has one blob in its flash, "
                     "the scene has 2 bodies", "--board", "mps2-an386")


if __name__ == "__main__":
    unittest.main(verbosity=2)
