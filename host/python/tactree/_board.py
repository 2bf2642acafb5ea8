"""Boards with a haptic device, over any port that the tool opens."""
from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from types import TracebackType
from typing import Any

import numpy.typing as npt

from . import _native
from ._model import Model


def _settled(reading: Future[Any]) -> Future[None]:
    """Done with `reading`. To cancel a wait for it does not cancel the reading."""
    settled: Future[None] = Future()
    settled.set_running_or_notify_cancel()
    reading.add_done_callback(lambda _: settled.set_result(None))
    return settled


class Telemetry:
    """The telemetry of a board in blocks, for `for` and `async for`; Board.telemetry() returns it.

    A block is a structured array with the columns of `tactree record`; `state` is an index of STATES. Leaving the loop
    does not end the subscription: stop() does.
    """

    def __init__(self, board: Board, every_ticks: int, timeout_s: float):
        self._native = board._native
        self._timeout_s = timeout_s
        self._number = self._native.subscribe(every_ticks)
        self._thread: ThreadPoolExecutor | None = None
        self._pending: Future[npt.NDArray[Any]] | None = None

    def _take(self) -> npt.NDArray[Any]:
        block = self._native.take(self._number, self._timeout_s)
        if len(block) == 0:
            raise _native.BoardError(f"{self._native.name()}: no telemetry for {self._timeout_s:g} s (is the board still "
                                     "running?)")
        return block

    def read(self) -> npt.NDArray[Any]:
        """The rows since the last call. Waits for at least one; raises BoardError if none arrives in time."""
        pending, self._pending = self._pending, None
        return self._take() if pending is None else pending.result()

    async def read_async(self) -> npt.NDArray[Any]:
        """As read(), without blocking the event loop. If it is cancelled, the next call returns the rows."""
        while True:
            if self._pending is None:
                self._thread = self._thread or ThreadPoolExecutor(1, "tactree-telemetry")
                self._pending = self._thread.submit(self._take)
            pending = self._pending
            await asyncio.wrap_future(_settled(pending))
            if self._pending is pending:  # otherwise another call returns it
                self._pending = None
                return pending.result()

    @property
    def dropped(self) -> int:
        """Messages that were dropped on the board, or here because they were not read in time."""
        return self._native.dropped()

    def stop(self) -> None:
        """Ends the subscription."""
        self._native.subscribe(0)

    def __iter__(self) -> Iterator[npt.NDArray[Any]]:
        return self

    def __next__(self) -> npt.NDArray[Any]:
        return self.read()

    def __aiter__(self) -> AsyncIterator[npt.NDArray[Any]]:
        return self

    async def __anext__(self) -> npt.NDArray[Any]:
        return await self.read_async()


class Board:
    """A session with a board, which stops when the session ends, at the latest at the end of a `with` block.

        with tactree.Board("/dev/ttyACM0") as board:
            board.arm()
            for block in board.telemetry():
                ...

    A method waits for the reply of the board, at most for one second unless stated otherwise, and raises BoardError with
    the message of the tool if the board refuses, does not reply or is lost. Other threads run meanwhile, and Ctrl-C ends
    long waits. Only post_stop() and close() may be called while another thread uses the board; close() ends its waits.
    """

    def __init__(self, port: str, *, baud: int = _native.USUAL_BAUD, link_timeout_ms: int = 50,
                 stream_capacity: int = 65536):
        """Opens a port (see ports()) and a session.

        port             a serial port, "usb:SERIAL", "unix:PATH", or the port that `tactree simulate --serve` prints
        baud             of a serial port
        link_timeout_ms  5 .. 100: the force ends if this program does not run for that long; 0: the force continues
        stream_capacity  telemetry messages that are kept until they are read
        """
        self._native = _native.NativeBoard(port, baud, link_timeout_ms, stream_capacity)

    def __enter__(self) -> Board:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Stops the board and closes the session. Further calls of methods raise BoardError."""
        if self._native.is_open:
            self._native.post_stop()
        self._native.close()

    @property
    def is_open(self) -> bool:
        """False once the session has ended: closed, board reset or unplugged, taken over by another program."""
        return self._native.is_open

    def arm(self, patience_s: float = 30.0) -> None:
        """Arms the board and waits until it is active, at most for `patience_s`.

        If the board has a dead-man control, the user must hold it. After a refusal or Ctrl-C, the board is stopped.
        """
        self._native.arm(patience_s)

    def stop(self) -> None:
        """Stops the board and waits for its reply."""
        self._native.stop()

    def post_stop(self) -> None:
        """Sends a stop and does not wait. May be called from any thread and from a signal handler.

        It may be lost with the link, so it does not replace the emergency stop of the device, which is a switch.
        """
        self._native.post_stop()

    def clear_faults(self) -> None:
        """Clears the faults; also stops the board, which makes it ready again."""
        self._native.clear_faults()

    def home(self) -> None:
        """Tells the board that the device is in its home pose now."""
        self._native.home()

    def wait(self, seconds: float) -> None:
        """Waits for a time on the clock of the board. In lock-step, this clock advances only during such waits."""
        self._native.wait(seconds)

    def reconnect(self) -> None:
        """Opens the port and a session again after the link was lost. The board is not armed."""
        self._native.reconnect()

    @property
    def identity(self) -> dict[str, Any]:
        """Name, version of the firmware, serial number."""
        return self._native.identify()

    @property
    def capabilities(self) -> dict[str, Any]:
        """Rate, limits and features."""
        return self._native.capabilities()

    @property
    def status(self) -> dict[str, Any]:
        """State, faults, limits, position of the probe and force."""
        return self._native.status()

    @property
    def first_fault(self) -> dict[str, Any] | None:
        """Conditions when the first fault was latched; None without a fault."""
        return self._native.first_fault()

    @property
    def parameters(self) -> dict[str, dict[str, float]]:
        """The calibration, as `tactree params`: name to value, min and max."""
        return self._native.parameters()

    def set_parameter(self, name: str, value: float) -> None:
        """Changes the calibration until the next reset of the board."""
        self._native.set_parameter(name, value)

    def save_parameters(self) -> None:
        """Stores the calibration permanently in the board."""
        self._native.save_parameters()

    def set_limits(self, force_max_N: float, slew_N_s: float, ramp_s: float) -> None:
        """Sets the maximum force, its maximum change per second, and the duration of its ramp after arming."""
        self._native.set_limits(force_max_N, slew_N_s, ramp_s)

    def set_material(self, stiffness_N_m: float, damping_Ns_m: float = 0.0, static_friction: float = 0.0,
                     dynamic_friction: float = 0.0, use_materials: bool = False) -> None:
        """Sets the contact parameters; with `use_materials`, those of the model take precedence."""
        self._native.set_material(stiffness_N_m, damping_Ns_m, static_friction, dynamic_friction, use_materials)

    def set_texture(self, height_m: float, wavelength_m: float = 0.002) -> None:
        """Sets the bumps that are cut into the surface, where no material of the model applies; a height of 0: smooth."""
        self._native.set_texture(height_m, wavelength_m)

    def flash(self, model: Model, progress: Callable[[float], object] | None = None) -> None:
        """Writes a model to the board, which checks and activates it. Waits until the flash is written.

        The preceding model is kept, see roll_back(). Signed models are written by `tactree flash`.
        """
        self._native.flash(model._native, progress)

    def roll_back(self) -> None:
        """Activates the preceding model."""
        self._native.roll_back()

    def telemetry(self, every_ticks: int = 10, timeout_s: float = 2.0) -> Telemetry:
        """Subscribes to one tick in `every_ticks`. The blocks end with a BoardError if none arrives for `timeout_s`."""
        return Telemetry(self, every_ticks, timeout_s)


def ports() -> list[str]:
    """Ports to which a board may be connected. Opens none of them."""
    return _native.ports()
