"""From what users hold to what the compiled module takes: doubles."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

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


def as_poses(poses: npt.ArrayLike) -> tuple[FloatArray, tuple[int, ...]]:
    """(n, 4) of x, y, z in mm, phi in rad; phi is 0 where the last axis has three entries."""
    array = as_doubles("poses", poses)
    if array.ndim > 0 and array.shape[-1] == 3:
        array = np.concatenate([array, np.zeros(array.shape[:-1] + (1,))], axis=-1)
    if array.ndim == 0 or array.shape[-1] != 4:
        raise InvalidArgument(
            "poses: expected an array of shape (..., 4) of x, y, z in mm, phi in rad, or (..., 3), "
            f"got {array.shape}"
        )
    return array.reshape(-1, 4), array.shape[:-1]


def shaped(array: Any, lead: tuple[int, ...]) -> Any:
    """Rows in the shape that the rows of the argument had."""
    return array.reshape(lead + array.shape[1:])
