"""A board that stands alone (simulate --panel): operated by its button, watched by programs.

usage: panel_test.py TACTREE [BOARD [TEST...]]        BOARD: an emulated board
"""
import csv
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
from served_board import BallFolder, ServedBoard  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()
BOARD = sys.argv.pop(1) if len(sys.argv) > 1 else "host"
HOME_AND_ARM = ("--press", "0.2s..1.4s", "--press", "3s..4.2s")


class Panel(BallFolder):
    tool = TACTREE

    def simulate(self, *arguments, code=0):
        done = self.run_tool("simulate", self.blob, "--panel", *arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stdout + done.stderr

    def test_runs_from_power_up_to_stop(self):
        printed = self.simulate(*HOME_AND_ARM, "--press", "6..6.1", "--seconds", 7, "--trace", "run.csv",
                                "--json", "run.json", "--record", "run.rec")
        events = self.read("run.json")["panel"]
        self.assertEqual([(event["state"], event["homed"]) for event in events],
                         [("idle", False), ("idle", True), ("armed", True), ("active", True), ("idle", True)])
        self.assertAlmostEqual(events[1]["t_s"], 1.2, delta=0.01)
        self.assertAlmostEqual(events[2]["t_s"], 4.0, delta=0.01)
        self.assertAlmostEqual(events[4]["t_s"], 6.02, delta=0.01)
        self.assertIn("panel              0.000 s: idle, not homed\n", printed)
        self.assertRegex(printed, r"\n {19}6\.0\d\d s: idle\n")
        with open(self.path / "run.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual({row["lamp"] for row in rows if row["state"] == "active"}, {"1"})
        self.assertEqual({row["lamp"] for row in rows if row["state"] == "idle"}, {"0", "1"})
        pressed = [float(row["t_s"]) for row in rows if row["button"] == "1"]
        self.assertAlmostEqual(pressed[0], 0.2, delta=0.001)
        self.assertAlmostEqual(pressed[-1], 6.1, delta=0.002)
        self.assertTrue(any(float(row["force_x_N"]) for row in rows))
        self.assertIn("identical", self.run_tool("simulate", self.blob, "--replay", "run.rec").stdout)

    def test_shows_and_clears_fault(self):
        self.simulate("--inject", "estop:pressed@0.5..1", "--press", "2..3.1", "--seconds", 4, "--allow-no-contact",
                      "--json", "run.json", code=1)
        run = self.read("run.json")
        self.assertEqual([event["state"] for event in run["panel"]], ["idle", "fault", "idle"])
        self.assertAlmostEqual(run["injected"]["detected_s"], 0, delta=0.01)

    def test_refusals(self):
        refused = self.simulate("--seconds", 1, code=1)
        self.assertIn("never touched the model (home and arm the board by its button, e.g. --press", refused)
        self.assertIn("--panel: no application is connected that places or moves bodies",
                      self.simulate(self.blob, code=1))
        self.assertIn("--panel: no application is connected whose link",
                      self.simulate("--inject", "link:arm@1", code=1))
        self.assertIn("'3..1': the end is not after the start (FROM..TO in seconds",
                      self.simulate("--press", "3..1", code=2))
        self.assertIn("--usb", self.simulate("--serve", "--usb", code=2))
        done = self.run_tool("simulate", self.blob, "--press", "1..2")
        self.assertEqual(done.returncode, 2)
        self.assertIn("--panel", done.stderr)

    def verb(self, *arguments, code=0):
        done = self.run_tool(*arguments)
        self.assertEqual(done.returncode, code, (arguments, done.stdout, done.stderr))
        return done.stdout + done.stderr

    def test_program_may_only_watch(self):
        with ServedBoard(TACTREE, self.blob, "--panel", *HOME_AND_ARM) as port:
            said = "operated by its button"
            self.assertIn("  a program may only watch and stop it: it is operated by its button\n",
                          self.verb("devices", "--port", port, "--json", "devices.json"))
            self.assertTrue(self.read("devices.json")["devices"][0]["watch_only"])
            self.assertRegex(self.verb("monitor", "--once", "--port", port), f"state +idle .*{said}")
            for options in ((), ("--home",), ("--clear",)):
                self.assertIn("arm: the board is operated by its button; an application may watch and stop only "
                              "(hold its button for 1 s", self.verb("arm", *options, "--port", port, code=1))
            self.assertIn("hold its button for 1 s", self.verb("params", "delay_s=0.0005", "--port", port, code=1))
            self.verb("record", "--port", port, "--seconds", 6, "-o", "watched.csv")
            with open(self.path / "watched.csv", newline="") as file:
                states = [row["state"] for row in csv.DictReader(file)]
            self.assertEqual(list(dict.fromkeys(states)), ["idle", "armed", "active"])
            self.assertEqual(states[-1], "active")
            self.assertIn("active", self.verb("monitor", "--once", "--port", port, "--json", "view.json"))
            view = self.read("view.json")
            self.assertEqual((view["state"], view["watch_only"]), ("active", True))
            self.assertIn("stopped", self.verb("stop", "--port", port))
            self.verb("monitor", "--once", "--port", port, "--json", "view.json")
            self.assertEqual(self.read("view.json")["state"], "idle")
        with ServedBoard(TACTREE, self.blob) as port:
            self.assertNotIn(said, self.verb("devices", "--port", port))
            self.assertNotIn(said, self.verb("monitor", "--once", "--port", port))


    def states_and_forces(self, port, seconds):
        """What a program sees that connects, watches, and goes: the states in their order, the ticks with force."""
        self.verb("record", "--port", port, "--seconds", seconds, "-o", "seen.csv")
        with open(self.path / "seen.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        forces = [any(float(row[f"force_{axis}_N"]) for axis in "xyz") for row in rows]
        for row, force in zip(rows, forces):
            self.assertTrue(not force or row["state"] == "active", row)
        return list(dict.fromkeys(row["state"] for row in rows)), forces

    def test_links_come_and_go_until_the_emergency_stop(self):
        with ServedBoard(TACTREE, self.blob, "--panel", "--board", BOARD, *HOME_AND_ARM, "--inject",
                         "estop:pressed@11..12") as port:
            states, _ = self.states_and_forces(port, 6)
            self.assertEqual(states, ["idle", "armed", "active"])
            for _ in range(2):  # each program opens a session and closes it; the force stays
                states, forces = self.states_and_forces(port, 2)
                self.assertEqual(states, ["active"])
                self.assertGreater(sum(forces), 100)
            states, forces = self.states_and_forces(port, 3)
            self.assertEqual(states, ["active", "fault"])
            self.assertFalse(any(forces[-100:]))


if __name__ == "__main__":
    unittest.main(verbosity=2)
