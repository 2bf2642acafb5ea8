"""Models from points, meshes and files: `tactree build`."""
from __future__ import annotations

import os
import pathlib
import warnings
from collections.abc import Callable, Iterable
from typing import Any

import numpy.typing as npt

from . import _native
from ._arrays import numbers, numbers_or_none
from ._model import Model

Progress = Callable[[str, float], object]


class BuildWarning(UserWarning):
    """A warning of a build, with the text of `tactree build`."""


def _finish(native: _native.Model) -> Model:
    model = Model(native)
    report = model.report
    for warning in report["warnings"] if report else ():
        warnings.warn(warning, BuildWarning, stacklevel=3)
    return model


def _given(options: dict[str, Any]) -> dict[str, Any]:
    """The options without those that have no value; "off" is 0 for the builder."""
    given = {name: value for name, value in options.items() if value is not None}
    if given.get("outliers") == "off":
        given["outliers"] = 0.0
    for name in ("crop", "viewpoints"):
        if name in given:
            given[name] = numbers(name, given[name])
    return given


def _path(file: str | os.PathLike[str] | None) -> str | None:
    return None if file is None else os.fspath(file)


def build(points: npt.ArrayLike, normals: npt.ArrayLike | None = None, colors: npt.ArrayLike | None = None,
          triangles: npt.ArrayLike | None = None, *, unit: str | None = "m", scale: float | None = None,
          fit_m: float | None = None, fit_device: str | None = None, centre: bool | None = None,
          axis: str | None = None, turn_deg: float | None = None, pose: str | os.PathLike[str] | None = None,
          crop: npt.ArrayLike | None = None, spacing_m: float | None = None, flash_budget: int | None = None,
          resample: bool | None = None,
          profile: str | None = None, material: str | None = None, outliers: float | str | None = None,
          keep_largest: bool | None = None, min_piece: int | None = None, orient: str | None = None,
          viewpoints: npt.ArrayLike | None = None, two_sided_m: float | None = None, flip_normals: bool | None = None,
          name: str = "array", threads: int | None = None, progress: Progress | None = None) -> Model:
    """Builds a model from points (N, 3), or from a mesh over them.

    normals    (N, 3), of any length; NaN or zero: unknown
    colors     (N, 3), 0 .. 255: red, green, blue; select materials
    triangles  (M, 3), indices of points: the points are the vertices of a mesh
    progress   is called with the name of the step and its fraction, 0 to 1

    The options are those of `tactree build`, with the defaults of the tool:

    unit         of the coordinates: m, cm, mm, um, in, ft
    scale        additional factor
    fit_m        length of the longest edge; fit_device: scales to the reach of that device
    centre       True: the centre of the bounding box becomes the origin
    axis         x, y or z: the axis that points up and becomes z; the next ones in cyclic order become x and y
    turn_deg     then turns the model about z, counterclockwise seen from above
    pose         pose file, applied last: the coordinates are then those of the device's frame
    crop         xmin, ymin, zmin, xmax, ymax, zmax in the unit of the points
    spacing_m    distance of the points; resample=False keeps all points
    flash_budget largest size of the blob, bytes: chooses the finest spacing
    profile      surface, or paper
    material     "stiffness=800,static=0.3", or a JSON file
    outliers     multiple of the noise; "off" keeps all points
    keep_largest True: only the largest connected component; min_piece: only those with as many points
    orient       auto, outward, viewpoint, up or given
    viewpoints   (K, 3), positions of the scanner in the unit of the points
    two_sided_m  thickness of the body that is built from a sheet
    flip_normals True: finally reverses all normals
    name         that is stored in the model

    The options --board and --rate, which need the images of boards, are those of the command line only.

    Points with a coordinate that is not finite are dropped and counted. Model.report has the report of the tool; each of
    its warnings is issued as a BuildWarning. Raises BuildError if no model can be built, and Error for an option or
    array that is refused. Ctrl-C ends the build between two steps of its progress.
    """
    options = _given({
        "unit": unit, "scale": scale, "fit_m": fit_m, "fit_device": fit_device, "centre": centre, "axis": axis,
        "turn_deg": turn_deg, "pose": _path(pose), "crop": crop, "spacing_m": spacing_m,
        "flash_budget": flash_budget, "resample": resample,
        "profile": profile, "material": material, "outliers": outliers, "keep_largest": keep_largest,
        "min_piece": min_piece, "orient": orient, "viewpoints": viewpoints, "two_sided_m": two_sided_m,
        "flip_normals": flip_normals, "name": name, "threads": threads})
    return _finish(_native.build_arrays(
        numbers("points", points), numbers_or_none("normals", normals), numbers_or_none("colors", colors),
        numbers_or_none("triangles", triangles), options, progress))


def build_file(path: str | os.PathLike[str] | Iterable[str | os.PathLike[str]], *, unit: str | None = None,
               scale: float | None = None, fit_m: float | None = None, fit_device: str | None = None,
               centre: bool | None = None, axis: str | None = None, turn_deg: float | None = None,
               pose: str | os.PathLike[str] | None = None, crop: npt.ArrayLike | None = None,
               spacing_m: float | None = None, flash_budget: int | None = None,
               resample: bool | None = None, profile: str | None = None, material: str | None = None,
               outliers: float | str | None = None, keep_largest: bool | None = None, min_piece: int | None = None,
               orient: str | None = None, viewpoints: npt.ArrayLike | None = None, two_sided_m: float | None = None,
               flip_normals: bool | None = None, name: str | None = None, threads: int | None = None,
               columns: str | None = None, format: str | None = None, memory_limit: int | None = None,
               progress: Progress | None = None) -> Model:
    """Builds a model from a file, or from several, in any format that `tactree build` reads.

    The options are those of build(), and:

    unit     default: as the file states, else metres
    columns  of text files, from 1: "x=2,y=3,z=4"
    format   of the files, if their content does not identify it: "xyz", "ply", ...
    memory_limit  bytes that the build may take, default: half of that of the computer; larger clouds are thinned
                  evenly while they are read

    Raises FileError if a file is refused, BuildError and Error as build().
    """
    paths = [path] if isinstance(path, (str, os.PathLike)) else list(path)
    options = _given({
        "unit": unit, "scale": scale, "fit_m": fit_m, "fit_device": fit_device, "centre": centre, "axis": axis,
        "turn_deg": turn_deg, "pose": _path(pose), "crop": crop, "spacing_m": spacing_m,
        "flash_budget": flash_budget, "resample": resample,
        "profile": profile, "material": material, "outliers": outliers, "keep_largest": keep_largest,
        "min_piece": min_piece, "orient": orient, "viewpoints": viewpoints, "two_sided_m": two_sided_m,
        "flip_normals": flip_normals, "name": name, "threads": threads, "columns": columns, "format": format,
        "memory_limit": memory_limit})
    _find_import_program()
    return _finish(_native.build_files([os.fspath(p) for p in paths], options, progress))


def _find_import_program() -> None:
    """Names the installed program that reads meshes by assimp, which the builder searches beside its own program."""
    for folder in pathlib.Path(__file__).resolve().parents:
        program = folder / "libexec" / "tactree" / "tactree-import-mesh"
        if program.exists():
            os.environ.setdefault("TACTREE_IMPORT_MESH", str(program))
            return
