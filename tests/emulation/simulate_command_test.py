"""`tactree simulate --board NAME` from the command line: options, report, exit codes, no process left behind.

usage: simulate_command_test.py TACTREE BLOB
"""
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

TACTREE, BLOB = sys.argv[1:3]
BOARD = "mps2-an500"


def tactree(*arguments, **options):
    return subprocess.run([TACTREE, "simulate", *map(str, arguments)], capture_output=True, text=True,
                          check=False, **options)


def emulators_of(parent):
    """Process ids of the children of a process."""
    return pathlib.Path(f"/proc/{parent}/task/{parent}/children").read_text().split()


def runs(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


class SimulateOnABoard(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def report(self, *arguments):
        file = self.folder / "report.json"
        done = tactree(BLOB, "--seconds", 1, "--json", file, *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(file.read_text()), done.stdout

    def test_report_and_trace_equal_host(self):
        for mode in ("surface", "paper"):
            common = ("--mode", mode, "--rate", 2000, "--stiffness", 345.6, "--static-friction", 0.5)
            host, _ = self.report(*common, "--trace", self.folder / "host.csv")
            board, printed = self.report(*common, "--trace", self.folder / "board.csv", "--board", BOARD,
                                      "--plot", self.folder / "board.svg")
            self.assertEqual((self.folder / "host.csv").read_text(),
                             (self.folder / "board.csv").read_text())
            self.assertIn("<svg", (self.folder / "board.svg").read_text())
            counts = board.pop("instructions")
            self.assertIsNone(host.pop("instructions")["max"])
            self.assertEqual(board.pop("board"), BOARD)
            self.assertEqual(host.pop("board"), "host")
            self.assertEqual(host, board)
            self.assertGreaterEqual(counts["bound"], counts["max"])
            self.assertGreater(counts["max"], counts["mean"])
            self.assertGreater(counts["mean"], 500)
            self.assertIn(f"{counts['max']} at most", printed)
            self.assertIn("tactree::core::", counts["functions"][0]["name"])

    def test_moving_body_equals_host(self):
        scene = self.folder / "scene.json"
        scene.write_text(json.dumps({"bodies": [
            {"blob": 0, "angular_velocity_rad_s": [0.2, 0.1, 1.5], "linear_velocity_m_s": [0, 0, 0.004],
             "until_s": 0.9}]}))
        at_rest, _ = self.report()
        host, _ = self.report("--scene", scene)
        board, printed = self.report("--scene", scene, "--board", BOARD)
        self.assertGreater(host["contact_ticks"], 100)
        self.assertNotEqual(host["trace_crc32"], at_rest["trace_crc32"])
        self.assertEqual(board["trace_crc32"], host["trace_crc32"])
        self.assertEqual(board["bodies"], host["bodies"])
        self.assertIn("body 0", printed)
        self.assertGreater(board["instructions"]["mean"], 500)

    def test_panel_operation_equals_host(self):
        common = ("--panel", "--press", "0.1s..1.2s", "--press", "2.5s..3.6s", "--press", "5s..5.1s",
                  "--seconds", 6, "--inject", "estop:pressed@5.3s")
        reports = []
        for board in ("host", BOARD):
            file, trace = self.folder / "panel.json", self.folder / f"{board}.csv"
            done = tactree(BLOB, *common, "--board", board, "--json", file, "--trace", trace)
            self.assertEqual(done.returncode, 1, done.stderr)  # of the fault
            reports.append(json.loads(file.read_text()))
            self.assertIn("s: idle, not homed", done.stdout)
        self.assertEqual([event["state"] for event in reports[1]["panel"]],
                         ["idle", "idle", "armed", "active", "idle", "fault"])
        self.assertEqual(reports[1]["panel"], reports[0]["panel"])
        self.assertEqual(reports[1]["trace_crc32"], reports[0]["trace_crc32"])
        self.assertGreater(reports[1]["contact_ticks"], 100)
        traces = [(self.folder / f"{board}.csv").read_text() for board in ("host", BOARD)]
        self.assertEqual(traces[0], traces[1])
        self.assertTrue(traces[0].splitlines()[0].endswith(",button,lamp"))

    def test_refuses_several_bodies(self):
        done = tactree(BLOB, BLOB, "--board", BOARD)
        self.assertEqual(done.returncode, 1)
        self.assertIn(f"--board {BOARD}: a board has one blob in its flash, the scene has 2 bodies "
                      "(use --board host", done.stderr)

    def test_reports_missing_image(self):
        done = tactree(BLOB, "--board", BOARD, "--firmware", self.folder)
        self.assertEqual(done.returncode, 1)
        self.assertIn("cmake --build --preset cortex-m7", done.stderr)
        done = tactree(BLOB, "--board", BOARD,
                       env={**os.environ, "TACTREE_FIRMWARE": str(self.folder)})
        self.assertEqual(done.returncode, 1)
        self.assertIn(str(self.folder), done.stderr)

    def test_reports_missing_emulator(self):
        done = tactree(BLOB, "--board", BOARD, env={**os.environ, "PATH": str(self.folder)})
        self.assertEqual(done.returncode, 1)
        self.assertIn("apt-get install qemu-system-arm", done.stderr)

    def test_unknown_board_fails_as_usage(self):
        done = tactree(BLOB, "--board", "abacus")
        self.assertEqual(done.returncode, 2)
        self.assertIn(BOARD, done.stderr)

    def test_refuses_same_configurations_as_host(self):
        arguments = (BLOB, "--seconds", 1, "--stiffness", 50000)
        host = tactree(*arguments)
        board = tactree(*arguments, "--board", BOARD)
        self.assertEqual(board.returncode, 1)
        self.assertIn("stability limit", board.stderr)
        self.assertEqual(board.stderr, host.stderr)

    def test_emulator_ends_with_killed_program(self):
        with subprocess.Popen([TACTREE, "simulate", BLOB, "--seconds", "3000", "--board", BOARD],
                              stdout=subprocess.DEVNULL) as process:
            children = []
            for _ in range(200):
                children = emulators_of(process.pid)
                if children:
                    break
                time.sleep(0.05)
            self.assertEqual(len(children), 1)
            process.send_signal(signal.SIGKILL)
        for _ in range(200):
            if not runs(children[0]):
                return
            time.sleep(0.05)
        self.fail("the emulator goes on")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
