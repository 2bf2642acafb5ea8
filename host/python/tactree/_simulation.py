"""The controller of the firmware with a simulated device and hand: `tactree simulate`."""
from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _native
from ._arrays import numbers
from ._model import Model


class Simulation:
    """A session of the controller, with the code of `tactree simulate`. The same inputs give bit-identical forces.

    The first tick powers up the controller and arms it with the hand at rest at its first position, outside the object.
    Positions are those of the model's frame, or with a pose those of the device. One thread at a time may use a simulation.
    """

    def __init__(self, model: Model, device: str = "premium", rate_hz: float = 1000.0, *, mode: str = "surface",
                 stiffness_N_m: float | None = None, damping_Ns_m: float | None = None,
                 static_friction: float | None = None, dynamic_friction: float | None = None,
                 texture_height_m: float | None = None, texture_wavelength_m: float | None = None,
                 use_materials: bool | None = None, passivity_Ns_m: float | None = None,
                 force_max_N: float | None = None, first_force: bool | None = None, origin_m: Sequence[float] | None = None,
                 latency_ticks: float | None = None, encoder_step_m: float | None = None,
                 device_mass_kg: float | None = None, device_friction_N: float | None = None,
                 hand_stiffness_N_m: float | None = None, hand_damping_Ns_m: float | None = None,
                 hand_mass_kg: float | None = None,
                 pose: str | os.PathLike[str] | npt.ArrayLike | None = None, scale: float | None = None,
                 faults: Sequence[str] = ()):
        """Checks the model and the configuration as the controller does; raises Error with the message of the tool.

        device     name of a preset, see device_names(), or a device file of `tactree simulate --dump-device`
        mode       surface, or paper
        origin_m   position of the model's origin in the device's frame; default: the model's centre is at the device's
                   origin
        pose       where the model is in the device's frame: a pose file, or a 4x4 matrix in metres
        scale      with a matrix: the size of the model, which is scaled about its origin first
        faults     faults to inject, such as "encoder1:stuck@2.5s", times in seconds after arming

        The other options are those of `tactree simulate`, with its defaults. encoder_step_m, device_mass_kg and
        device_friction_N have an effect on the device cartesian only.
        """
        if not isinstance(model, Model):
            raise _native.Error(f"Simulation: {model!r} is not a Model (load() reads a blob, build_file() a scan)")
        if pose is not None and origin_m is not None:
            raise _native.Error("Simulation: pose and origin_m both place the model (give one of them)")
        is_file = isinstance(pose, (str, os.PathLike))
        if scale is not None and (pose is None or is_file):
            raise _native.Error("Simulation: scale belongs to the matrix of a pose (a pose file has its own)")
        rows = None if pose is None or is_file else numbers("pose", pose).ravel().tolist()
        options = {
            "pose_file": os.fspath(pose) if is_file else None, "pose": rows, "scale": scale,
            "device": device, "rate_hz": rate_hz, "mode": mode, "stiffness_N_m": stiffness_N_m,
            "damping_Ns_m": damping_Ns_m, "static_friction": static_friction, "dynamic_friction": dynamic_friction,
            "texture_height_m": texture_height_m, "texture_wavelength_m": texture_wavelength_m,
            "use_materials": use_materials, "passivity_Ns_m": passivity_Ns_m, "force_max_N": force_max_N, "first_force": first_force,
            "origin_m": origin_m, "latency_ticks": latency_ticks, "encoder_step_m": encoder_step_m,
            "device_mass_kg": device_mass_kg, "device_friction_N": device_friction_N,
            "hand_stiffness_N_m": hand_stiffness_N_m, "hand_damping_Ns_m": hand_damping_Ns_m,
            "hand_mass_kg": hand_mass_kg}
        self._model = model
        self._session = _native.Session(
            model._native, {name: value for name, value in options.items() if value is not None}, list(faults))

    def step(self, hand_position: npt.ArrayLike | None = None, *, hand_velocity: npt.ArrayLike = (0.0, 0.0, 0.0),
             encoders: npt.ArrayLike | None = None) -> _native.Tick:
        """One tick, with either a position to which the hand draws the device, or counts of the three encoders.

        The hand is a spring and a damper between the device and `hand_position` (m), which moves at `hand_velocity`
        (m/s). With `encoders`, no mechanics are simulated: the controller reads these counts and moves nothing.
        """
        if (hand_position is None) == (encoders is None):
            raise _native.Error("step: needs either hand_position or encoders (give one of them)")
        if encoders is not None:
            return self._session.step_at(numbers("encoders", encoders))
        return self._session.step_to(numbers("hand_position", hand_position), numbers("hand_velocity", hand_velocity))

    def run(self, path: npt.ArrayLike | None = None, *, seconds: float | None = None,
            script: str = "rub") -> npt.NDArray[Any]:
        """Runs along a path of the hand and returns every tick.

        `path` has rows x, y, z, one for each tick, or rows t_s, x, y, z, between which the hand moves in straight lines;
        the last time is that of the end unless `seconds` is given. Without a path, the hand follows a script, see
        scripts(), for `seconds` (default: 10). Another run() continues where the hand is; reset() begins again.

        The structured array has the columns of `tactree simulate --trace`; `state` is an index of STATES. Other threads
        run meanwhile; Ctrl-C ends the run.
        """
        if path is not None:
            return self._session.run_path(numbers("path", path), seconds)
        return self._session.run_script(script, 10.0 if seconds is None else seconds)

    def reset(self) -> None:
        """Ends the run. The next tick powers up and arms the controller again."""
        self._session.reset()

    def stop(self) -> None:
        """Sends a stop to the controller in the next tick."""
        self._session.stop()

    def arm(self) -> None:
        """Sends a request to arm, after a stop, in the next tick."""
        self._session.arm()

    def clear_faults(self) -> None:
        """Clears latched faults in the next tick. Has no effect while their cause persists."""
        self._session.clear_faults()

    @property
    def model(self) -> Model:
        """The model that the hand touches."""
        return self._model

    @property
    def device(self) -> str:
        """Name or file of the device."""
        return self._session.device

    @property
    def rate_hz(self) -> float:
        """Ticks per second."""
        return self._session.rate_hz

    @property
    def time_s(self) -> float:
        """Time of the next tick; the first tick after arming is at 0."""
        return self._session.time_s

    @property
    def state(self) -> str:
        """State of the controller after the last tick."""
        return self._session.state

    @property
    def origin_m(self) -> npt.NDArray[np.float64]:
        """Position of the model's origin in the device's frame."""
        return self._session.origin_m

    @property
    def summary(self) -> dict[str, Any]:
        """Totals of all ticks since the start, by the names of `tactree simulate --json`."""
        return self._session.summary()
