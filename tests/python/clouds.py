"""What the tests of the package share: the tool in a folder, and points of a ball."""
import contextlib
import os
import pathlib
import signal
import sys
import threading

import numpy as np
import tactree

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from served_board import BallFolder, ServedBoard, SharingProgram  # noqa: E402
from tool_folder import SharedFolder, ball  # noqa: E402

__all__ = ["ModelFolder", "ServedBoard", "SharedFolder", "SharingProgram", "ball", "ball_arrays", "probes", "runs_beside",
           "signal_during", "tool_error", "write_rows"]


class ModelFolder(BallFolder):
    """And with the model in that blob."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.model = tactree.load(cls.blob)


def ball_arrays(count=2000, radius=0.03):
    """Points and normals (N, 3)."""
    points, normals = zip(*ball(count, radius))
    return np.array(points), np.array(normals)


def probes(count=500, radius=0.035, seed=1):
    """Positions in and around a ball."""
    return np.random.default_rng(seed).uniform(-radius, radius, (count, 3))


def tool_error(run):
    """The error message that the tool prints."""
    return run.stderr.strip().removeprefix("tactree: error: ")


def write_rows(path, heading, rows):
    path.write_text(heading + "\n" + "".join(",".join(repr(float(v)) for v in row) + "\n" for row in rows))


@contextlib.contextmanager
def no_forced_switches():
    """A thread runs until it releases the interpreter's lock explicitly."""
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1000)
    try:
        yield
    finally:
        sys.setswitchinterval(interval)


def runs_beside(call):
    """True if this thread runs while another one is in `call`."""
    order = []

    def work():
        order.append("begin")
        call()
        order.append("end")
    with no_forced_switches():
        thread = threading.Thread(target=work)
        thread.start()  # waits for the lock, which `work` has until it releases it
        order.append("beside")
        thread.join()
    return order == ["begin", "beside", "end"]


@contextlib.contextmanager
def signal_during(name):
    """Interrupts a function of the package with Ctrl-C while it has released the interpreter's lock."""
    main = threading.main_thread().ident
    over = False

    def press():
        while not over:
            code = sys._current_frames()[main].f_code
            if code.co_name == name and pathlib.Path(code.co_filename).parent.name == "tactree":
                return signal.pthread_kill(main, signal.SIGINT)
            os.sched_yield()
    with no_forced_switches():
        thread = threading.Thread(target=press)
        thread.start()
        try:
            yield
        finally:
            over = True
            thread.join()
