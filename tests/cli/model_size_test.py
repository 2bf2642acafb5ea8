"""Models that a device cannot reach, and sessions without contact.

usage: model_size_test.py TACTREE
"""
import pathlib
import re
import sys
import unittest

sys.dont_write_bytecode = True
from tool_folder import SharedFolder, ball, sheet  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()


class ModelSize(SharedFolder):
    tool = TACTREE

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.build_points("small", sheet(0.03, 0.0015), "--unit", "m")
        cls.build_points("large", sheet(0.6, 0.03), "--unit", "m")
        cls.write("above.csv", "t_s,x,y,z\n0,0,0,0.02\n1,0.01,0,0.02\n")

    def test_accepts_fitting_model_silently(self):
        done = self.run_tool("simulate", "small.blob", "--seconds", 1)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_hint_scales_model_into_reach(self):
        done = self.run_tool("simulate", "large.blob", "--device", "falcon", "--seconds", 1)
        self.assertIn("warning: large.blob: the model is 1.2 x 1.2 x 0", done.stderr)
        self.assertIn(" m, more than falcon reaches", done.stderr)
        remedy = re.search(r"--fit (\S+)\)", done.stderr)
        self.run_tool("build", "large.csv", "-o", "large.blob", "--unit", "m", "--fit", remedy[1])
        done = self.run_tool("simulate", "large.blob", "--device", "falcon", "--seconds", 1)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_hint_scales_model_to_devices_of_fewer_axes(self):
        self.build_points("huge", ball(3000, 0.5), "--unit", "m")
        for device, path in (("pantograph", "in the plane"), ("hapkit", "on the arc")):
            with self.subTest(device=device):
                for verb in ("info", "simulate"):
                    done = self.run_tool(verb, "huge.blob", "--device", device)
                    self.assertRegex(done.stderr, f"warning: huge.blob: the model is .* mm, more than {device} reaches "
                                                  f"{path} of its probe; it fits with a longest edge of up to .* mm")
                remedy = re.search(r"--fit (\S+)\)", done.stderr)
                self.run_tool("build", "huge.csv", "-o", "scaled.blob", "--unit", "m", "--fit", remedy[1])
                done = self.run_tool("simulate", "scaled.blob", "--device", device, "--script", "press", "--seconds", 2)
                self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_paper_names_its_method_if_there_is_no_contact(self):
        done = self.run_tool("simulate", "small.blob", "--path", "above.csv", "--seconds", 1, "--mode", "paper")
        self.assertEqual(done.returncode, 1)
        self.assertIn("the method of the paper finds a contact only within 0.73 mm of a point", done.stderr)
        self.assertIn("use --mode surface", done.stderr)

    def test_reports_unreachable_start(self):
        self.build_points("ball", ball(3000, 0.5), "--unit", "m")
        done = self.run_tool("simulate", "ball.blob", "--seconds", 1)
        self.assertEqual(done.returncode, 1)
        self.assertIn("premium does not reach the start of the hand, and the probe is in the object (scale the "
                      "model with build --fit device:premium", done.stderr)

    def test_refuses_impossible_fit(self):
        for fit, code, words in (("far", 2, "'far' is neither a length in metres nor device:NAME"),
                                 ("-1", 2, "neither a length"), ("device:none", 1, "none")):
            done = self.run_tool("build", "large.csv", "-o", "fit.blob", "--fit", fit)
            self.assertEqual(done.returncode, code, fit)
            self.assertIn(words, done.stderr)
            self.assertFalse((self.path / "fit.blob").exists())

    def test_fails_without_contact_unless_allowed(self):
        session = ("simulate", "small.blob", "--path", "above.csv", "--seconds", 1)
        done = self.run_tool(*session)
        self.assertEqual(done.returncode, 1)
        self.assertIn("in contact         0 (0.0 %)", done.stdout)
        self.assertIn("small.blob: the probe never touched the model (choose a --script", done.stderr)
        done = self.run_tool(*session, "--allow-no-contact")
        self.assertEqual((done.returncode, done.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main(verbosity=2)
