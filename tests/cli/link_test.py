#!/usr/bin/env python3
"""The commands that use a board, with a simulated one: exit codes, JSON, refusals; keys and signatures.

usage: link_test.py TACTREE [BOARD]      BOARD: where the controller runs, default host
"""
import os
import pathlib
import re
import sys
import unittest

sys.dont_write_bytecode = True
from served_board import BallFolder, ServedBoard, build_ball  # noqa: E402

NOT_HOMED = 1 << 7
BOARD = sys.argv.pop(2) if len(sys.argv) > 2 else "host"
TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()


class Link(BallFolder):
    tool = TACTREE

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        if BOARD != "host":
            run = cls.run_tool("simulate", cls.blob, "--board", BOARD, "--seconds", "0.01")
            if run.returncode != 0 and "image" in run.stderr:
                raise unittest.SkipTest(run.stderr)
        cls.coarse = build_ball(TACTREE, cls.path, "coarse", "--spacing", "0.003")

    def run_verb(self, *arguments, code=0):
        run = self.run_tool(*arguments)
        self.assertEqual(run.returncode, code, (arguments, run.stdout, run.stderr))
        return run.stdout + run.stderr

    def read_json(self, *arguments, code=0):
        (self.path / "result.json").unlink(missing_ok=True)
        self.run_verb(*arguments, "--json", "result.json", code=code)
        return self.read("result.json")

    def test_runs_session_from_shell(self):
        with ServedBoard(TACTREE, self.blob, "--board", BOARD) as port:
            devices = self.read_json("devices", "--port", port)["devices"]
            self.assertEqual(devices[0]["board"], BOARD)
            seen = self.read_json("monitor", "--once", "--port", port)
            self.assertEqual((seen["state"], seen["faults"]), ("idle", 0))
            self.assertIn("active", self.run_verb("arm", "--port", port, "--seconds", "1"))
            self.assertIn("stopped", self.run_verb("stop", "--port", port))
            trace = self.run_verb("trace", "--port", port).splitlines()
            self.assertTrue(any(line.startswith("tick,state,contact") for line in trace))
            ticks = [int(line.split(",")[0]) for line in trace if line[:1].isdigit()]
            self.assertEqual(ticks, list(range(ticks[0], ticks[0] + len(ticks))), "none is missing")
            self.assertGreater(len(ticks), 32)

    @unittest.skipIf(BOARD != "host", "the images of emulated boards are homed")
    def test_first_power_on(self):
        with ServedBoard(TACTREE, self.blob, "--unhomed", "--first-force") as port:
            seen = self.read_json("monitor", "--once", "--port", port)
            self.assertEqual((seen["state"], seen["limits"]), ("idle", NOT_HOMED))
            self.assertIn("not homed", self.run_verb("arm", "--port", port, code=1))
            self.assertIn("active", self.run_verb("arm", "--home", "--port", port, "--seconds", "2"))
            trace = self.run_verb("trace", "--port", port)
            self.assertIn(",active,", trace)
            seen = self.read_json("monitor", "--once", "--port", port)
            self.assertEqual((seen["state"], seen["limits"]), ("idle", 0))
            self.assertEqual(seen["motor_force_N"], [0.0, 0.0, 0.0])
            self.assertRegex(self.run_verb("monitor", "--once", "--port", port), "motors +0.000 N .*gravity")

    def test_writes_and_rolls_back_model(self):
        with ServedBoard(TACTREE, self.blob, "--board", BOARD) as port:
            points = self.info(self.coarse)["points"]
            for _ in range(2):
                slots = self.read_json("flash", self.coarse, "--port", port)["slots"]
            self.assertEqual([s["state"] for s in slots], ["ready", "in use"])
            self.assertEqual([s["points"] for s in slots], [points, points])
            slots = self.read_json("flash", "--roll-back", "--port", port)["slots"]
            self.assertEqual([s["state"] for s in slots], ["in use", "ready"])
            self.assertIn("in use", self.run_verb("flash", "--erase", 0, "--port", port, code=1))
            slots = self.read_json("flash", "--erase", 1, "--port", port)["slots"]
            self.assertEqual(slots[1]["state"], "empty")
            self.run_verb("flash", "--port", port, code=2)

    def info(self, blob):
        self.run_verb("info", blob, "--json", "info.json")
        return self.read("info.json")

    def test_parameters(self):
        with ServedBoard(TACTREE, self.blob, "--board", BOARD) as port:
            all_of_them = self.read_json("params", "delay_s=0.0005", "--port", port)
            self.assertAlmostEqual(all_of_them["delay_s"]["value"], 0.0005, places=6)
            self.assertIn("no parameter 'nonsense'", self.run_verb("params", "nonsense=1", "--port", port, code=1))
            self.assertIn("NAME=NUMBER", self.run_verb("params", "delay_s=x", "--port", port, code=1))
            self.run_verb("params", "delay_s=7", "--port", port, code=1)

    def test_lists_simulated_board(self):
        runtime = self.path / "runtime"
        runtime.mkdir()
        mine = {**os.environ, "XDG_RUNTIME_DIR": str(runtime)}
        with ServedBoard(TACTREE, self.blob, "--board", BOARD, env=mine) as port:
            done = self.run_tool("devices", env=mine)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(f"{port}: simulated board {BOARD}, model {self.blob}", done.stdout)
        self.assertNotIn(port, self.run_tool("devices", env=mine).stdout)

    def test_ends_at_once(self):
        for _ in range(5):
            with ServedBoard(TACTREE, self.blob, "--board", BOARD):
                pass

    @unittest.skipIf(BOARD != "host", "the messages do not depend on the board")
    def test_names_fault_and_hint(self):
        with ServedBoard(TACTREE, self.blob, "--board", BOARD, "--inject", "estop:pressed@0.02..0.05") as port:
            # Of the board's time: when it ends, the switch is released.
            self.run_verb("record", "--port", port, "--seconds", "1", "-o", "passed.csv")
            refused = self.run_verb("arm", "--port", port, "--seconds", "0.1", code=1)
            self.assertIn("fault emergency-stop", refused)
            self.assertIn("tactree arm --clear", refused)
            self.run_verb("arm", "--port", port, "--seconds", "0.1", "--clear")

    @unittest.skipIf(BOARD != "host", "the pose does not depend on the board")
    def test_sends_pose_that_stays_on_board(self):
        def flat(z):
            return [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, z, 0, 0, 0, 1]

        def touched(port, *options):
            self.run_verb("record", "--arm", "--port", port, "--seconds", "2", "-o", "touch.csv", *options)
            heading, *rows = (self.path / "touch.csv").read_text().splitlines()
            column = heading.split(",").index("in_contact")
            return sum(row.split(",")[column] == "1" for row in rows)

        self.write("below.json", {"pose": flat(-0.05)})
        self.write("here.json", {"pose": flat(0)})
        self.write("large.json", {"pose": flat(0), "scale": 2})
        with ServedBoard(TACTREE, self.blob) as port:
            self.assertGreater(touched(port), 100)
            self.assertEqual(touched(port, "--pose", "below.json"), 0)
            self.assertEqual(touched(port), 0)
            self.assertIn("active", self.run_verb("arm", "--port", port, "--seconds", "0.1", "--pose", "here.json"))
            self.assertGreater(touched(port), 100)
            self.assertIn("large.json.scale: 2: a board cannot change the size of its model (build the model with",
                          self.run_verb("arm", "--port", port, "--pose", "large.json", code=1))
            self.run_verb("record", "--port", port, "-o", "x.csv", "--pose", "here.json", code=2)

    def test_reports_missing_board(self):
        for verb in (["monitor", "--once"], ["stop"], ["trace"], ["params"], ["flash", "--list"], ["arm"]):
            self.assertIn("/dev/no-such-port", self.run_verb(*verb, "--port", "/dev/no-such-port", code=1))
        self.run_verb("devices", "--port", "/dev/no-such-port", code=1)

    @unittest.skipIf(BOARD != "host", "the images of emulated boards have no key")
    def test_board_with_key_refuses_unsigned_models(self):
        key, other = self.path / "key", self.path / "other"
        for name in (key, other):
            self.run_verb("keygen", name)
        self.assertEqual(key.stat().st_mode & 0o77, 0)
        self.assertIn("File exists", self.run_verb("keygen", key, code=1))
        bytes_of_header = re.findall(r"0x([0-9a-f]{2}),", pathlib.Path(f"{key}.hpp").read_text())
        self.assertEqual("".join(bytes_of_header), pathlib.Path(f"{key}.pub").read_text().split()[-1])
        (self.path / "third.hpp").touch()
        self.assertIn("third.hpp: File exists", self.run_verb("keygen", self.path / "third", code=1))
        self.assertFalse((self.path / "third").exists())
        self.run_verb("check", self.coarse, "--key", f"{key}.pub", code=1)
        with ServedBoard(TACTREE, self.blob, "--require-key", f"{key}.pub") as port:
            self.assertIn("not signed by the key", self.run_verb("flash", self.coarse, "--port", port, code=1))
            self.run_verb("sign", self.coarse, "--key", other, "--counter", 5)
            self.assertIn("not signed by the key", self.run_verb("flash", self.coarse, "--port", port, code=1))
            self.run_verb("sign", self.coarse, "--key", key, "--counter", 5, "--board", "elsewhere")
            self.assertIn("another board", self.run_verb("flash", self.coarse, "--port", port, code=1))
            self.run_verb("sign", self.coarse, "--key", key, "--counter", 5, "--board", "host")
            slots = self.read_json("flash", self.coarse, "--port", port)["slots"]
            self.assertTrue(slots[0]["signed"])
            self.run_verb("sign", self.coarse, "--key", key, "--counter", 6)
            slots = self.read_json("flash", self.coarse, "--port", port)["slots"]
            self.assertEqual([s["state"] for s in slots], ["barred by its counter", "in use"])
            self.run_verb("sign", self.coarse, "--key", key, "--counter", 4)
            self.assertIn("older", self.run_verb("flash", self.coarse, "--port", port, code=1))
        self.assertIn("valid", self.run_verb("check", self.coarse, "--key", f"{key}.pub"))
        self.assertTrue(self.info(self.coarse)["signature"]["valid"])
        self.run_verb("check", self.coarse, "--key", f"{other}.pub", code=1)
        signature = pathlib.Path(f"{self.coarse}.sig")
        text = signature.read_text()
        signature.write_text(text.replace('"counter": 4', '"counter": 5'))
        self.assertIn("not a valid signature of this blob", self.run_verb("check", self.coarse, code=1))
        self.assertFalse(self.info(self.coarse)["signature"]["valid"])
        signature.write_text("{}")
        self.assertIn("not a signature of a model", self.run_verb("check", self.coarse, code=1))
        signature.unlink()


if __name__ == "__main__":
    unittest.main(verbosity=2)
