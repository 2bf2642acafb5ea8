"""Models, simulations and boards of Tactree from Python.

    model = tactree.load("statue.blob")
    answers = model.query(positions)
    trace = tactree.Simulation(model).run(script="rub", seconds=2)

Lengths are in metres, times in seconds and forces in newtons, unless a name has the suffix of another unit.
docs/PYTHON.md has an example of each part.
"""
from ._board import Board, Telemetry, ports
from ._build import BuildWarning, build, build_file
from ._model import Model, load
from ._native import (FAULTS, STATES, BoardError, BuildError, Error, FileError, Tick, __version__, device_names,
                      fault_names, limit_names, scripts)
from ._simulation import Simulation
from ._tables import read_recording, read_trace, vectors

__all__ = [
    "Board", "BoardError", "BuildError", "BuildWarning", "Error", "FAULTS", "FileError", "Model", "STATES",
    "Simulation", "Telemetry", "Tick", "__version__", "build", "build_file", "device_names", "fault_names",
    "limit_names", "load", "ports", "read_recording", "read_trace", "scripts", "vectors",
]
