"""scripts/beside-stalls with planted stalls: what is measured, what counts as inconclusive, what is passed on.

usage: stalls_test.py                                   the tests
       stalls_test.py --planted MS BESIDE_STALLS_ARGUMENT...    as the script, with a stall of this length
"""
import importlib.machinery
import importlib.util
import os
import pathlib
import pty
import signal
import subprocess
import sys
import unittest

sys.dont_write_bytecode = True
SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/beside-stalls"


def load():
    loader = importlib.machinery.SourceFileLoader("beside_stalls", str(SCRIPT))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("beside_stalls", loader))
    loader.exec_module(module)
    return module


stalls = load()


class PlantedWatch:
    def __init__(self, stall_ms):
        self.stall_ms = stall_ms

    def start(self):
        pass

    def stop(self):
        return self.stall_ms


class PlantedTime:
    """A clock, and a sleep that takes as long as the next of `sleeps`."""

    def __init__(self, *sleeps_s):
        self.now_s = 100.0
        self.sleeps_s = list(sleeps_s)
        self.asked_s = []

    def clock(self):
        return self.now_s

    def sleep(self, seconds):
        self.asked_s.append(seconds)
        self.now_s += self.sleeps_s.pop(0)


class Measurement(unittest.TestCase):
    def watch(self, *sleeps_s):
        planted = PlantedTime(*sleeps_s)
        return planted, stalls.Watch(planted.clock, planted.sleep)

    def test_keeps_largest_overshoot(self):
        planted, watch = self.watch(0.010, 0.260, 0.015)
        for expected_s in (0.0, 0.25, 0.25):
            watch.look()
            self.assertAlmostEqual(watch.largest_s, expected_s)
        self.assertEqual(planted.asked_s, [0.010] * 3)

    def test_counts_stall_between_sleeps(self):
        planted, watch = self.watch(0.010, 0.010)
        watch.look()
        planted.now_s += 0.7
        watch.look()
        self.assertAlmostEqual(watch.largest_s, 0.7)

    def test_counts_stall_before_first_sleep(self):
        planted, watch = self.watch(0.010)
        planted.now_s += 0.4
        watch.look()
        self.assertAlmostEqual(watch.largest_s, 0.4)

    def test_counts_stall_until_end(self):
        planted = PlantedTime()

        def sleep(_):
            watch.ended.wait()
            planted.now_s += 0.51

        watch = stalls.Watch(planted.clock, sleep)
        watch.start()
        self.assertAlmostEqual(watch.stop(), 500.0)


class Verdict(unittest.TestCase):
    def test_failure_beside_longer_stall_is_inconclusive(self):
        for code, stall_ms, expected in ((0, 1000, 0), (77, 1000, 77), (1, 200, 1), (1, 201, 77), (139, 201, 77),
                                         (124, 201, 77), (124, 3, 124), (3, 0, 3)):
            self.assertEqual(stalls.verdict(code, stall_ms, 200)[0], expected, (code, stall_ms))


class Program(unittest.TestCase):
    """The script as a program; only its measurement is planted."""

    def start(self, stall_ms, *arguments):
        return subprocess.Popen([sys.executable, __file__, "--planted", str(stall_ms), *arguments],
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def run_beside(self, stall_ms, *arguments):
        with self.start(stall_ms, *arguments) as process:
            said = process.stdout.read()
        return process.returncode, said

    def shell(self, stall_ms, script, *options):
        return self.run_beside(stall_ms, *options, "sh", "-c", script)

    def test_skips_failure_beside_stall(self):
        code, said = self.shell(1000, "printf 'no end of line'; exit 3")
        self.assertEqual(code, 77)
        self.assertEqual(said, "no end of line\n"
                         "skipped: inconclusive: the machine stalled for 1000 ms while it ran\n")

    def test_fails_without_stall(self):
        code, said = self.shell(12, "exit 3")
        self.assertEqual(code, 3)
        self.assertIn("the largest stall while it ran was 12 ms", said)
        self.assertNotIn("skipped", said)
        self.assertEqual(self.shell(12, "kill -SEGV $$")[0], 128 + signal.SIGSEGV)

    def test_keeps_passes_and_skips(self):
        self.assertEqual(self.shell(1000, "echo fine"), (0, "fine\n"))
        self.assertEqual(self.shell(1000, "echo skipped: no board; exit 77"), (77, "skipped: no board\n"))

    def test_takes_limit_from_option(self):
        self.assertEqual(self.shell(1000, "exit 3", "--limit", "1000")[0], 3)
        self.assertEqual(self.shell(1000, "exit 3", "--limit", "999")[0], 77)

    def test_fails_if_command_does_not_start(self):
        code, said = self.run_beside(1000, "/no/such/command")
        self.assertEqual(code, 127)
        self.assertIn("/no/such/command: No such file", said)
        self.assertEqual(self.run_beside(1000)[0], 2)

    def test_command_inherits_signals_and_group(self):
        code, said = self.run_beside(0, sys.executable, "-c", "import os, signal\n"
                                     "print(signal.pthread_sigmask(signal.SIG_BLOCK, ()), os.getpgrp())")
        self.assertEqual((code, said), (0, f"set() {os.getpgrp()}\n"))

    def test_signal_reaches_command(self):
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGUSR1):
            with self.start(1000, sys.executable, "-c", f"import signal, sys\nall = {{{int(number)}}}\n"
                            "signal.pthread_sigmask(signal.SIG_BLOCK, all)\nprint('ready', flush=True)\n"
                            "sys.exit(100 + signal.sigwait(all))") as process:
                self.assertEqual(process.stdout.readline(), "ready\n")
                process.send_signal(number)
                said = process.stdout.read()
            self.assertEqual(process.returncode, 100 + number, said)

    def test_terminal_signal_reaches_command_once(self):
        # Of two pending signals the lower number is taken first: a second SIGINT would come before SIGUSR1.
        script = ("import signal\nall = {signal.SIGINT, signal.SIGUSR1}\nsignal.pthread_sigmask(signal.SIG_BLOCK, all)\n"
                  "for _ in range(2):\n    print('?', flush=True)\n    print(signal.sigwait(all).name, flush=True)\n")
        process, terminal = pty.fork()
        if process == 0:
            os.execv(sys.executable, [sys.executable, __file__, "--planted", "0", sys.executable, "-c", script])
        said = b""

        def until(ending):
            nonlocal said
            while not said.endswith(ending):
                said += os.read(terminal, 1)

        until(b"?\r\n")
        os.kill(process, signal.SIGSTOP)  # so that the command has taken the signal before the script sees it
        os.waitpid(process, os.WUNTRACED)
        os.write(terminal, b"\x03")
        until(b"SIGINT\r\n?\r\n")
        os.kill(process, signal.SIGCONT)
        os.kill(process, signal.SIGUSR1)
        until(b"SIGUSR1\r\n")  # or the read fails, at the end of the command
        _, status = os.waitpid(process, 0)
        os.close(terminal)
        self.assertEqual(os.waitstatus_to_exitcode(status), 0)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--planted"]:
        sys.exit(stalls.main(sys.argv[3:], PlantedWatch(float(sys.argv[2]))))
    unittest.main(verbosity=2)
