"""Tables in files: traces of simulations and recordings of boards."""
from __future__ import annotations

import os
import zipfile
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _native

_REMEDY = "give a file written by tactree record"


def read_trace(path: str | os.PathLike[str]) -> npt.NDArray[Any]:
    """Reads a file of `tactree simulate --trace`: a structured array, as Simulation.run() returns it.

    `state` is an index of STATES. Raises FileError with the line, the cause and a hint.
    """
    return _native.read_trace(path)


def read_recording(path: str | os.PathLike[str]) -> npt.NDArray[Any]:
    """Reads a file of `tactree record`, CSV or npz: a structured array with the columns of the recording.

    `state` is an index of STATES. Columns that an older version did not record are NaN. Raises FileError with the place,
    the cause and a hint.
    """
    if not str(os.fspath(path)).endswith(".npz"):
        return _native.read_ticks(path)
    try:
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as arrays:
            return _assemble(os.fspath(path), {name: arrays[name] for name in arrays.files})
    except (OSError, ValueError, zipfile.BadZipFile) as error:
        raise _native.FileError(f"{os.fspath(path)}: cannot be read: {error} ({_REMEDY})") from error


def _assemble(file: str, arrays: dict[str, npt.NDArray[Any]]) -> npt.NDArray[Any]:
    dtype = _native.tick_dtype()
    for name in (*dtype.names, "state_names"):
        optional = name != "state_names" and dtype[name] == np.float32
        if name not in arrays and not optional:
            raise _native.FileError(f"{file}: has no array {name} ({_REMEDY})")
    if tuple(arrays["state_names"]) != _native.STATES:
        raise _native.FileError(f"{file}: state_names: other states than those of this version ({_REMEDY})")
    lengths = {len(arrays[name]) for name in dtype.names if name in arrays}
    if len(lengths) != 1:
        raise _native.FileError(f"{file}: the arrays differ in length ({_REMEDY})")
    table = np.empty(lengths.pop(), dtype)
    for name in dtype.names:
        table[name] = arrays.get(name, np.nan)
    return table


def vectors(table: npt.NDArray[Any], name: str) -> npt.NDArray[Any]:
    """Three columns of a table as an array (N, 3), a copy: "force" is force_x_N, force_y_N and force_z_N.

    "" is x, y and z. Raises Error if the table has no such columns.
    """
    def matches(column: str, axis: str) -> bool:
        prefix = f"{name}_{axis}" if name else axis
        return column == prefix or (bool(name) and column.startswith(prefix + "_"))

    names = table.dtype.names or ()
    columns = [next((column for column in names if matches(column, axis)), None) for axis in "xyz"]
    if None in columns:
        raise _native.Error(f"vectors: no columns {name}_x, {name}_y, {name}_z (the columns are {', '.join(names)})")
    return np.stack([table[column] for column in columns], axis=1)
