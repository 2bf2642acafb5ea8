"""Recording and replay end to end: simulate --record -> simulate --replay, and each cause of a refusal.

usage: replay_test.py TACTREE
"""
import csv
import os
import pathlib
import pty
import signal
import subprocess
import sys
import unittest

sys.dont_write_bytecode = True
from tool_folder import SharedFolder, sheet  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()
MOVING = {"bodies": [
    {"blob": 0},
    {"blob": 1, "from_s": 0.3, "until_s": 0.8, "linear_velocity_m_s": [0.004, 0, 0.002],
     "angular_velocity_rad_s": [0, 0, 0.3]}]}


class Replay(SharedFolder):
    tool = TACTREE

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        for name, height_m in (("low", 0.0), ("high", 0.001), ("other", 0.002)):
            cls.build_points(name, sheet(0.03, 0.001, height_m), "--spacing", 0.001)
        cls.write("press.csv", "t_s,x,y,z\n0,0,0,0.01\n0.2,0,0,-0.002\n1,0.01,0,-0.002\n")
        cls.write("moving.json", MOVING)

    def record(self, *arguments, codes=(0,)):
        """The checksum of a recorded session's trace; the recording is session.rec."""
        done = self.run_tool("simulate", "low.blob", "high.blob", "--scene", "moving.json", "--path",
                             "press.csv", "--device", "cartesian", "--seconds", 1, "--json", "run.json",
                             "--record", "session.rec", *arguments)
        self.assertIn(done.returncode, codes, done.stderr)
        run = self.read("run.json")
        self.assertGreater(run["contact_ticks"], 50)
        return run["trace_crc32"]

    def replay(self, *blobs, name="session.rec"):
        (self.path / "replay.json").unlink(missing_ok=True)
        return self.run_tool("simulate", *blobs, "--replay", name, "--json", "replay.json")

    def refuses(self, words, *blobs, name="session.rec"):
        done = self.replay(*blobs, name=name)
        self.assertEqual(done.returncode, 1, done.stdout)
        for word in (name, *words):
            self.assertIn(word, done.stderr)
        self.assertFalse((self.path / "replay.json").exists())

    def expect_same(self, checksum, *blobs):
        done = self.replay(*blobs)
        self.assertEqual(done.returncode, 0, done.stderr + done.stdout)
        self.assertEqual(self.read("replay.json")["trace_crc32"], checksum)

    def test_replays_moving_bodies_identically(self):
        self.expect_same(self.record(), "low.blob", "high.blob")

    def test_accepts_blobs_in_any_order(self):
        self.expect_same(self.record(), "high.blob", "low.blob")

    def test_replays_fault_identically(self):
        self.expect_same(self.record("--inject", "encoder1:disconnected@0.5s", codes=(1,)),
                         "low.blob", "high.blob")

    def test_replays_paper_mode_at_4_khz(self):
        self.expect_same(self.record("--rate", 4000, "--mode", "paper"), "low.blob", "high.blob")

    def test_refuses_replay_without_all_blobs(self):
        self.record()
        self.refuses(["not one of the given blobs"], "low.blob", "other.blob")

    def test_refuses_damaged_recording(self):
        self.record()
        data = bytearray((self.path / "session.rec").read_bytes())
        data[len(data) // 2] ^= 4
        (self.path / "damaged.rec").write_bytes(data)
        self.refuses(["checksum"], "low.blob", "high.blob", name="damaged.rec")

    def test_refuses_truncated_or_foreign_recording(self):
        self.record()
        data = (self.path / "session.rec").read_bytes()
        for size in (0, 3, 40, len(data) // 2, len(data) - 1):
            (self.path / "cut.rec").write_bytes(data[:size])
            self.refuses([], "low.blob", "high.blob", name="cut.rec")
        self.refuses([], "low.blob", "high.blob", name="low.blob")

    def test_refuses_huge_file_by_header(self):
        self.record()
        header = (self.path / "session.rec").read_bytes()[:20]
        for begin, words in ((b"", "not a recording"), (header, "truncated or bytes were appended")):
            with open(self.path / "huge.rec", "wb") as huge:
                huge.write(begin)
                huge.truncate(1 << 40)
            self.refuses([words], "low.blob", "high.blob", name="huge.rec")

    def test_emulated_board_refuses_recording(self):
        done = self.run_tool("simulate", "low.blob", "--board", "mps2-an386", "--record", "board.rec")
        self.assertEqual(done.returncode, 1)
        self.assertIn("omit --board", done.stderr)
        self.assertFalse((self.path / "board.rec").exists())

    def test_path_refuses_recording(self):
        self.record()
        done = self.run_tool("simulate", "low.blob", "--path", "session.rec")
        self.assertEqual(done.returncode, 1)
        self.assertIn("session.rec: has the inputs of a controller, but no path of a hand (replay it with --replay",
                      done.stderr)

    def test_interrupted_run_keeps_its_ticks(self):
        reader, terminal = pty.openpty()
        said = b""
        with subprocess.Popen([TACTREE, "simulate", "low.blob", "--seconds", "1000", "--trace", "part.csv", "--record",
                               "part.rec"], cwd=self.path, stdout=subprocess.DEVNULL, stderr=terminal) as run:
            os.close(terminal)
            while b"simulating" not in said:  # the progress
                said += os.read(reader, 4096)
            run.send_signal(signal.SIGINT)
            try:
                while more := os.read(reader, 4096):
                    said += more
            except OSError:  # the program has ended
                os.close(reader)
        self.assertEqual(run.returncode, 1)
        self.assertRegex(said.decode(), r"warning: interrupted after [0-9.]+ s of 1000 s; the results are those of")
        with open(self.path / "part.csv", newline="") as file:
            ticks = len(list(csv.reader(file))) - 1
        self.assertLess(ticks, 1000000)
        self.assertIn(f"interrupted after {ticks / 1000:.3f} s", said.decode())
        done = self.replay("low.blob", name="part.rec")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_record_excludes_replay(self):
        self.record()
        done = self.run_tool("simulate", "low.blob", "--record", "x.rec", "--replay", "session.rec")
        self.assertEqual(done.returncode, 2)


if __name__ == "__main__":
    unittest.main(verbosity=2)
