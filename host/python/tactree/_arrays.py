"""Arguments that are arrays of numbers."""
from __future__ import annotations

import os

import numpy as np
import numpy.typing as npt

from . import _native


def numbers(name: str, values: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """The values as float64. Raises Error, which states the argument `name`, if they are no numbers or rows differ."""
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        is_name = isinstance(values, (str, bytes, os.PathLike))
        remedy = "read a file with build_file(), load() or NumPy" if is_name else "give as many numbers in each row"
        cause = f"{values!r} is not an array of numbers" if is_name else f"is not an array of numbers: {error}"
        raise _native.Error(f"{name}: {cause} ({remedy})") from error


def numbers_or_none(name: str, values: npt.ArrayLike | None) -> npt.NDArray[np.float64] | None:
    """As numbers(), and None for an argument that is not given."""
    return None if values is None else numbers(name, values)
