"""From what users hold to what the compiled module takes: doubles."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _paracal
from .errors import InvalidArgument

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
CodeArray = npt.NDArray[np.uint8]
BoolArray = npt.NDArray[np.bool_]


def as_doubles(what: str, numbers: npt.ArrayLike) -> FloatArray:
    """An array of doubles; whole numbers become such, text, complex and truth values do
    not."""
    array = np.asarray(numbers)
    if array.dtype.kind not in "iuf":
        raise InvalidArgument(f"{what}: expected an array of numbers, got dtype {array.dtype}")
    return np.asarray(array, dtype=np.float64)


def as_rows(what: str, numbers: npt.ArrayLike, columns: int) -> tuple[FloatArray, tuple[int, ...]]:
    """(n, columns), and the shape (...) of (..., columns) that they came in."""
    array = as_doubles(what, numbers)
    if array.ndim == 0 or array.shape[-1] != columns:
        raise InvalidArgument(
            f"{what}: expected an array of shape (..., {columns}), got {array.shape}"
        )
    return array.reshape(-1, columns), array.shape[:-1]


def pose_axes(robot: _paracal.Robot) -> tuple[str, ...]:
    """What the numbers of a pose are: places in mm, then angles in rad."""
    angles = ("tilt_x", "tilt_y", "tilt_z") if robot.commands_tilt else ("phi",)
    return ("x", "y", "z", *angles)


def as_poses(poses: npt.ArrayLike, robot: _paracal.Robot) -> tuple[FloatArray, tuple[int, ...]]:
    """(n, 4) of x, y, z in mm, phi in rad, or (n, 6) of x, y, z in mm, tilt_x, tilt_y, tilt_z in
    rad where the tilt of the plate is commanded; angles are 0 where the last axis has three entries."""
    array = as_doubles("poses", poses)
    angles = pose_axes(robot)[3:]
    if array.ndim > 0 and array.shape[-1] == 3:
        array = np.concatenate([array, np.zeros(array.shape[:-1] + (len(angles),))], axis=-1)
    width = 3 + len(angles)
    if array.ndim == 0 or array.shape[-1] != width:
        raise InvalidArgument(
            f"poses: expected an array of shape (..., {width}) of x, y, z in mm, "
            f"{', '.join(angles)} in rad for {robot.name}, or (..., 3), got {array.shape}"
        )
    return array.reshape(-1, width), array.shape[:-1]


def shaped(array: Any, lead: tuple[int, ...]) -> Any:
    """Rows in the shape that the rows of the argument had."""
    return array.reshape(lead + array.shape[1:])
