"""Models: blobs, checked as the controller checks them."""
from __future__ import annotations

import json
import os
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _native
from ._arrays import numbers


class Model:
    """A model that load(), build() or build_file() returned. It never changes."""

    def __init__(self, native: _native.Model):
        self._native = native

    @classmethod
    def from_bytes(cls, data: bytes, name: str = "blob") -> Model:
        """Checks and copies the bytes of a blob. Messages state `name`."""
        return cls(_native.from_bytes(data, name))

    @property
    def info(self) -> dict[str, Any]:
        """The values of `tactree info --json`, without the signature, which is in a separate file."""
        return self._native.info()

    @property
    def report(self) -> dict[str, Any] | None:
        """The report of `tactree build --report`; None for a loaded model."""
        text = self._native.report()
        return json.loads(text) if text else None

    @property
    def file(self) -> str:
        """The name that messages state: the file of the model, if it has one."""
        return self._native.file()

    @property
    def name(self) -> str:
        """The name that is stored in the model."""
        return self.info["name"]

    @property
    def bounds_m(self) -> npt.NDArray[np.float64]:
        """Lower and upper corner of the bounding box, (2, 3)."""
        return self._native.bounds()

    @property
    def points(self) -> npt.NDArray[np.float32]:
        """Positions of the points, (N, 3), read-only.

        A blob stores them as offsets from octree leaves. The first use of `points` or `normals` decodes both into a
        copy, of 24 bytes per point, which the model keeps. The arrays of later uses share it.
        """
        return self._native.points()

    @property
    def normals(self) -> npt.NDArray[np.float32]:
        """Unit normals of the points, (N, 3), read-only. A copy, like `points`."""
        return self._native.normals()

    @property
    def data(self) -> npt.NDArray[np.uint8]:
        """The bytes of the blob, read-only and without a copy."""
        return self._native.data()

    @property
    def point_materials(self) -> npt.NDArray[np.uint8] | None:
        """Index in info["material_list"] of the material of each point, read-only and without a copy.

        None if the model has at most one material.
        """
        return self._native.point_materials()

    def query(self, positions: npt.ArrayLike, radius_m: float | None = None) -> npt.NDArray[Any]:
        """What `tactree query` prints, one row for each of the positions (N, 3), m.

        The structured array has the columns of the tool: x, y, z, contact_paper, contact, nearest, distance_m,
        surface_x, ..., normal_x, ..., signed_distance_m, inside. Where the tool prints nothing, `nearest` is -1, lengths
        and directions are NaN, and `inside` is -1 (the model does not state it; else 1 in the material, 0 outside).
        vectors(answers, "normal") is the array (N, 3) of three such columns.

        `radius_m` limits the search of the nearest point; default: the support radius of the model. Positions are
        rounded to float32, as in the controller. Cost: some microseconds per position; other threads run meanwhile.
        """
        return self._native.query(numbers("positions", positions), radius_m)

    def nearest(self, positions: npt.ArrayLike,
                radius_m: float | None = None) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.float64]]:
        """Index of the nearest point and distance from it, m, for each of the positions (N, 3).

        -1 and NaN where no point is within `radius_m`, see query().
        """
        answers = self._native.query(numbers("positions", positions), radius_m)
        return np.ascontiguousarray(answers["nearest"]), np.ascontiguousarray(answers["distance_m"])

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the blob completely or not at all. Raises FileError."""
        self._native.save(path)

    def __len__(self) -> int:
        """The number of points."""
        return self.info["points"]

    def __repr__(self) -> str:
        facts = self.info
        return f"<tactree.Model {facts['name']!r}: {facts['points']} points, spacing {facts['spacing_m']:.6g} m>"


def load(path: str | os.PathLike[str]) -> Model:
    """Reads a blob and checks it as the controller does. Raises FileError with the message of the tool."""
    return Model(_native.load(path))
