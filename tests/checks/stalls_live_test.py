"""scripts/beside-stalls in real time: a process group that is stopped, and a command that does not end."""
import os
import pathlib
import signal
import subprocess
import time
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/beside-stalls"


class Stalls(unittest.TestCase):
    def start(self, script, *options):
        return subprocess.Popen([SCRIPT, *options, "sh", "-c", script], start_new_session=True, text=True,
                                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    def test_skips_failure_beside_long_stop(self):
        with self.start("echo ready; read line; exit 3") as process:
            self.assertEqual(process.stdout.readline(), "ready\n")
            os.killpg(process.pid, signal.SIGSTOP)
            time.sleep(1.0)
            os.killpg(process.pid, signal.SIGCONT)
            said, _ = process.communicate("go on\n")
        self.assertEqual(process.returncode, 77, said)
        stood_ms = int(said.rpartition("stalled for ")[2].split()[0])
        self.assertGreater(stood_ms, 900)

    def test_time_limit_ends_all_processes(self):
        # All of them have the output open; one ignores the request to end.
        with self.start("sleep 600 & sh -c 'trap \"\" TERM; while :; do sleep 600; done'; wait",
                        "--time-limit", "1") as process:
            said, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 124, said)
        self.assertIn("stopped after the time limit of 1 s", said)


if __name__ == "__main__":
    unittest.main(verbosity=2)
