"""tactree record with a simulated board: each tick, gaps, link loss, Ctrl-C, a killed program, a full disk.

usage: record_test.py TACTREE CLASS
  CLASS  Record, Session, Gaps in real time, or Hour: an hour at 1 kHz in real time, or RECORD_SECONDS of the environment
"""
import ast
import contextlib
import csv
import os
import pathlib
import pty
import re
import resource
import signal
import struct
import subprocess
import sys
import time
import unittest
import zipfile
import zlib

sys.dont_write_bytecode = True
from served_board import BallFolder, RealTimeBoard, ServedBoard  # noqa: E402

TACTREE = pathlib.Path(sys.argv.pop(1)).resolve()


def read_npz(path):
    """{array: values}, by the format that numpy documents."""
    arrays = {}
    with zipfile.ZipFile(path) as archive:
        assert archive.testzip() is None
        for name in archive.namelist():
            data = archive.read(name)
            begin = 10 + int.from_bytes(data[8:10], "little")
            header = ast.literal_eval(data[10:begin].decode())
            kind, = re.fullmatch("[<|]([a-zA-Z][0-9]+)", header["descr"]).groups()
            if kind[0] == "U":
                text, width = data[begin:].decode("utf-32-le"), int(kind[1:])
                values = [text[i:i + width].rstrip("\0") for i in range(0, len(text), width)]
            else:
                code = {"f8": "d", "f4": "f", "u4": "I", "i4": "i", "u1": "B"}[kind]
                values = list(struct.unpack(f"<{header['shape'][0]}{code}", data[begin:]))
            arrays[name.removesuffix(".npy")] = values
    return arrays


class Recorded(BallFolder):
    tool = TACTREE

    def record(self, port, name, *arguments, code=0, **options):
        run = self.run_tool("record", "--port", port, "-o", name, *arguments, **options)
        self.assertEqual(run.returncode, code, run.stderr)
        return run.stderr

    def start(self, port, name):
        """Returns once the program records."""
        program = subprocess.Popen([TACTREE, "record", "--port", port, "-o", name], cwd=self.path,
                                   stderr=subprocess.PIPE, text=True)
        self.addCleanup(program.stderr.close)
        self.assertIn("recording until Ctrl-C", program.stderr.readline())
        return program

    def rows(self, name):
        with (self.path / name).open() as file:
            rows = list(csv.DictReader(file))
        for row in rows:
            self.assertNotIn(None, [*row, *row.values()], "each row has all cells")
        return rows

    def expect_no_gap(self, rows):
        ticks = [int(row["tick"]) for row in rows]
        self.assertEqual(ticks, list(range(ticks[0], ticks[0] + len(ticks))))
        self.assertEqual({row["missing_ticks"] for row in rows}, {"0"})


class Record(Recorded):
    def test_records_each_armed_tick(self):
        with ServedBoard(TACTREE, self.blob) as port:
            said = self.record(port, "armed.csv", "--seconds", "1.5", "--arm", "--json", "armed.json")
            self.assertRegex(self.run_tool("monitor", "--once", "--port", port).stdout, "^state +idle")
        self.assertIn("armed.csv: 1500 ticks in 1.499 s, none missing", said)
        self.assertEqual(self.read("armed.json"), {
            "output": "armed.csv", "ticks": 1500, "seconds": 1.499, "every_ticks": 1, "missing_ticks": 0, "gaps": 0,
            "omitted_by_board": 0, "problem": None})
        rows = self.rows("armed.csv")
        self.assertEqual(len(rows), 1500)
        self.expect_no_gap(rows)
        states = [row["state"] for row in rows]
        self.assertEqual(states[0], "idle", "no tick of the armed board is missing")
        armed = next(i for i, state in enumerate(states) if state != "idle")
        self.assertLess(armed, 200)
        self.assertEqual(set(states[armed:]) - {"armed"}, {"active"})
        self.assertEqual(float(rows[-1]["t_s"]), 1.499)
        self.assertGreater(max(abs(float(row["force_z_N"])) for row in rows), 0.1)

    def test_formats_have_same_columns(self):
        with ServedBoard(TACTREE, self.blob) as port:
            for name in ("same.csv", "same.npz"):
                self.record(port, name, "--seconds", "0.2")
        arrays, rows = read_npz(self.path / "same.npz"), self.rows("same.csv")
        self.assertEqual([*arrays], [*rows[0]][:4] + ["state_names"] + [*rows[0]][4:])
        self.assertEqual({arrays["state_names"][i] for i in arrays["state"]}, {"idle"})
        self.assertEqual(len(arrays["tick"]), 200)
        self.assertEqual(arrays["t_s"], [float(row["t_s"]) for row in rows])

    def test_one_tick_of_many(self):
        with ServedBoard(TACTREE, self.blob) as port:
            said = self.record(port, "tenth.csv", "--seconds", "1", "--every", "10")
        self.assertIn("100 ticks in 0.990 s, none missing", said)

    def test_lost_board_loses_no_row(self):
        counts = {}
        for name in ("lost.csv", "lost.npz"):
            with ServedBoard(TACTREE, self.blob, "--seconds", "1") as port:
                said = self.record(port, name, "--seconds", "60", "--json", "lost.json", code=1)
            self.assertIn(f"{port}: the recording ended early: the board is disconnected", said)
            self.assertIn("the board is disconnected", self.read("lost.json")["problem"])
            counts[name] = int(re.search(rf"{name}: (\d+) ticks", said)[1])
        # The board ran 1000 ticks, of which some passed before the subscription.
        rows = self.rows("lost.csv")
        self.expect_no_gap(rows)
        self.assertEqual([len(rows), int(rows[-1]["tick"])], [counts["lost.csv"], 1000])
        ticks = read_npz(self.path / "lost.npz")["tick"]
        self.assertEqual([len(ticks), ticks[-1]], [counts["lost.npz"], 1000])

    def test_ctrl_c_completes_file(self):
        for name in ("ended.csv", "ended.npz"):
            with ServedBoard(TACTREE, self.blob) as port:
                program = self.start(port, name)
                program.send_signal(signal.SIGINT)
                said = program.communicate()[1]
            self.assertEqual(program.returncode, 0, said)
            rows = self.rows(name) if name.endswith("csv") else read_npz(self.path / name)["tick"]
            self.assertIn(f"{name}: {len(rows)} ticks", said)
        self.assertEqual(list(self.path.glob("ended*.*.*")), [])

    def test_pipe_gets_rows_until_ctrl_c(self):
        os.mkfifo(self.path / "pipe")
        with ServedBoard(TACTREE, self.blob) as port:
            program = subprocess.Popen([TACTREE, "record", "--port", port, "-o", "pipe"], cwd=self.path,
                                       stderr=subprocess.DEVNULL)
            with (self.path / "pipe").open() as pipe:
                lines = [pipe.readline() for _ in range(100)]
                program.send_signal(signal.SIGINT)
                lines += pipe.readlines()
            self.assertEqual(program.wait(), 0)
        self.assertEqual({line.count(",") for line in lines}, {lines[0].count(",")})
        self.assertTrue(lines[-1].endswith("\n"))

    def test_kill_leaves_file_marked_incomplete(self):
        with ServedBoard(TACTREE, self.blob) as port:
            program = self.start(port, "killed.csv")
            part = self.path / "killed.csv.incomplete"
            while not part.exists() or part.stat().st_size < 20000:
                self.assertIsNone(program.poll())
                os.sched_yield()
            program.kill()
            program.wait()
            self.assertFalse((self.path / "killed.csv").exists())
            size = part.stat().st_size
            self.assertIn("killed.csv.incomplete: exists", self.record(port, "killed.csv", code=1))
            self.assertEqual(part.stat().st_size, size)
            program = self.start(port, "killed.npz")
            program.kill()
            program.wait()
            self.assertFalse((self.path / "killed.npz").exists())

    def test_full_disk_keeps_rows(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (100000, 100000))
        with ServedBoard(TACTREE, self.blob) as port:
            said = self.record(port, "full.csv", "--seconds", "5", code=1, preexec_fn=limit)
        self.assertIn("the recording ended early: full.csv: cannot be written: File too large", said)
        rows = self.rows("full.csv")
        self.assertGreater(len(rows), 100)
        self.assertIn(f"full.csv: {len(rows)} ticks", said)
        self.expect_no_gap(rows)

    def test_refuses_outputs_and_ports(self):
        for name, words in (("a.txt", "neither .csv nor .npz"), ("a.rec", "simulate --record writes a .rec"),
                            ("no/a.csv", "No such file")):
            self.assertIn(words, self.record("/dev/no-such-port", name, code=1))
        self.assertIn("/dev/no-such-port", self.record("/dev/no-such-port", "a.csv", code=1))
        for result in ("--trace", "--plot", "--json"):
            done = self.run_tool("simulate", self.blob, "--serve", result, "a.out")
            self.assertEqual(done.returncode, 1)
            self.assertIn(f"{result}: not written with --serve (record the board with tactree record", done.stderr)
        self.assertEqual(list(self.path.glob("a.*")), [])


class Session(Recorded):
    def test_shows_progress_on_terminals_only(self):
        with ServedBoard(TACTREE, self.blob) as port:
            self.assertNotIn("\r", self.record(port, "quiet.csv", "--seconds", "2.5"))
            terminal, end = pty.openpty()
            program = subprocess.Popen([TACTREE, "record", "--port", port, "-o", "shown.csv", "--seconds", "2.5"],
                                       cwd=self.path, stderr=end)
            os.close(end)
            said = b""
            with contextlib.suppress(OSError):  # the other end was closed
                while chunk := os.read(terminal, 4096):
                    said += chunk
            os.close(terminal)
            self.assertEqual(program.wait(), 0)
        self.assertRegex(said.decode(), r"\r\x1b\[2K\d+ ticks in \d\.\d{3} s, none missing\r")

    def test_records_forces_of_session(self):
        """The checksum of every force is that of a replay of what reached the controller."""
        with ServedBoard(TACTREE, self.blob, "--seconds", "3", "--inject", "estop:pressed@2", "--record",
                         self.path / "session.rec") as port:
            said = self.record(port, "session.csv", "--arm", code=1)
        self.assertIn("none missing", said)
        rows = self.rows("session.csv")
        self.expect_no_gap(rows)
        self.assertEqual({row["state"] for row in rows[-500:]}, {"fault"})
        done = self.run_tool("simulate", self.blob, "--replay", "session.rec", "--json", "replay.json")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        replay = self.read("replay.json")
        forces = [struct.pack("<3f", *(float(row[f"force_{axis}_N"]) for axis in "xyz")) for row in rows]
        no_force = struct.pack("<3f", 0, 0, 0)
        self.assertGreater(sum(force != no_force for force in forces), 500)
        # Before the recording the board is idle, after it stopped.
        before = int(rows[0]["tick"]) - 1
        after = replay["ticks"] - before - len(rows)
        self.assertLess(after, 5)
        self.assertEqual(zlib.crc32(no_force * before + b"".join(forces) + no_force * after), replay["trace_crc32"])

    def record_taps(self, name, seconds):
        """The columns, of the active ticks, of a hand that touches the ball twice in a second."""
        taps = "".join(f"{i / 4},{0.004 * (i % 8) / 8},0,{0.026 if i % 2 else 0.034}\n" for i in range(40))
        self.write("taps.csv", "t_s,x,y,z\n" + taps)
        with ServedBoard(TACTREE, self.blob, "--path", self.path / "taps.csv") as port:
            self.record(port, name, "--seconds", str(seconds), "--arm")
        rows = [] if name.endswith("npz") else self.rows(name)
        table = {column: [row[column] for row in rows] for column in rows[0]} if rows else read_npz(self.path / name)
        states = table.get("state_names")
        begin = table["state"].index(states.index("active") if states else "active")
        return {column: values[begin:] for column, values in table.items() if column != "state_names"}

    def test_motion_is_repeated(self):
        """A hand follows the recorded probe, and feels nearly the recorded forces."""
        for name in ("moved.csv", "moved.npz"):
            recorded = self.record_taps(name, 1.5)
            done = self.run_tool("simulate", self.blob, "--path", name, "--trace", "repeated.csv")
            self.assertEqual(done.returncode, 0, done.stderr)
            repeated = self.rows("repeated.csv")
            self.assertEqual(len(repeated), len(recorded["tick"]))
            difference = square = 0.0
            for axis in "xyz":
                probes, forces = (map(float, recorded[f"{quantity}_{axis}_{unit}"])
                                  for quantity, unit in (("probe", "m"), ("force", "N")))
                # At its start, the recorded hand moved; the one that repeats it was at rest.
                for row, probe, force in [*zip(repeated, probes, forces)][50:]:
                    self.assertAlmostEqual(float(row[f"probe_{axis}_m"]), probe, delta=0.0002)
                    difference += (float(row[f"force_{axis}_N"]) - force)**2
                    square += force**2
            self.assertGreater((square / len(repeated))**0.5, 0.2, "N")
            self.assertLess((difference / square)**0.5, 0.2)

    def test_repeated_motion_obeys_options(self):
        ticks = len(self.record_taps("short.csv", 1.2)["tick"])
        for options, expected in (((), ticks), (("--seconds", "0.25"), 250), (("--rate", "2000"), 2 * ticks - 1)):
            done = self.run_tool("simulate", self.blob, "--path", "short.csv", "--json", "short.json",
                                 "--allow-no-contact", *options)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(self.read("short.json")["ticks"], expected)

    def test_watches_without_arming(self):
        with ServedBoard(TACTREE, self.blob) as port:
            for name in ("watched.csv", "watched.npz"):
                self.record(port, name, "--seconds", "0.3")
        self.assertEqual({row["state"] for row in self.rows("watched.csv")}, {"idle"})
        for name in ("watched.csv", "watched.npz"):
            done = self.run_tool("simulate", self.blob, "--replay", name)
            self.assertEqual(done.returncode, 1)
            self.assertIn(f"{name}: a trace, or the recording of a board, cannot be replayed", done.stderr)
            self.assertIn(f"tactree view BLOB --trace {name} shows it", done.stderr)
            self.assertIn(f"simulate BLOB --path {name} repeats its motion", done.stderr)
            done = self.run_tool("simulate", self.blob, "--path", name)
            self.assertEqual(done.returncode, 1)
            self.assertIn(f"{name}: no tick is in the state active", done.stderr)


class Gaps(Recorded):
    def test_counts_ticks_omitted_by_board(self):
        with RealTimeBoard(TACTREE, self.blob) as port:
            program = self.start(port, "gaps.csv")
            time.sleep(0.5)
            program.send_signal(signal.SIGSTOP)
            time.sleep(5)  # more than the terminal holds
            program.send_signal(signal.SIGCONT)
            time.sleep(0.5)
            program.send_signal(signal.SIGINT)
            said = program.communicate()[1]
        self.assertEqual(program.returncode, 0, said)
        counts = re.search(r": (\d+) ticks in .*, (\d+) missing in (\d+) gaps, (\d+) of them omitted", said)
        ticks, missing, gaps, omitted = map(int, counts.groups())
        rows = self.rows("gaps.csv")
        self.assertEqual(len(rows), ticks)
        lost = [int(row["missing_ticks"]) for row in rows]
        self.assertEqual((sum(lost), sum(count > 0 for count in lost)), (missing, gaps))
        numbers = [int(row["tick"]) for row in rows]
        self.assertEqual([b - a - 1 for a, b in zip(numbers, numbers[1:])], lost[1:])
        self.assertGreater(missing, 100)
        self.assertGreater(omitted, 0.9 * missing)
        self.assertIn("the port was too slow", said)

    def test_keeps_every_tick_in_real_time(self):
        with RealTimeBoard(TACTREE, self.blob) as port:
            said = self.record(port, "live.npz", "--seconds", "5", "--arm")
        self.assertIn("live.npz: 5000 ticks in 4.999 s, none missing", said)


class Hour(Recorded):
    def test_hour_at_1_khz_has_no_gap(self):
        seconds = int(os.environ.get("RECORD_SECONDS", 3600))
        with RealTimeBoard(TACTREE, self.blob) as port, (self.path / "said").open("w") as said:
            begin = time.monotonic()
            command = [TACTREE, "record", "--port", port, "-o", "hour.npz", "--seconds", str(seconds), "--arm"]
            program = subprocess.Popen(command, cwd=self.path, stderr=said)
            _, status, usage = os.wait4(program.pid, 0)
            program.returncode = os.waitstatus_to_exitcode(status)
            self.assertGreater(time.monotonic() - begin, seconds - 1)
        said = (self.path / "said").read_text()
        self.assertEqual(program.returncode, 0, said)
        count = 1000 * seconds
        self.assertIn(f"hour.npz: {count} ticks in {seconds - 1}.999 s, none missing", said)
        self.assertLess(usage.ru_maxrss, 100_000, "KiB: memory does not grow with the duration")
        with zipfile.ZipFile(self.path / "hour.npz") as archive:
            data = archive.read("tick.npy")
        ticks = memoryview(data)[10 + int.from_bytes(data[8:10], "little"):].cast("I")
        self.assertEqual(len(ticks), count)
        self.assertTrue(all(tick == ticks[0] + i for i, tick in enumerate(ticks)))


if __name__ == "__main__":
    unittest.main(verbosity=2)
