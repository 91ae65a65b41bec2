"""Converts arrays and tables to arrays of doubles for the compiled module."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Mapping, TypeVar, Union

import numpy as np
import numpy.typing as npt

from . import _paracal
from .errors import InvalidArgument

if TYPE_CHECKING:
    import pandas

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
CodeArray = npt.NDArray[np.uint8]
BoolArray = npt.NDArray[np.bool_]

Array = TypeVar("Array", bound="npt.NDArray[Any]")

#: Numbers by position in mm and rad, or a DataFrame or dict of columns by name and unit.
Numbers = Union[npt.ArrayLike, "pandas.DataFrame", Mapping[str, npt.ArrayLike]]

#: Units of columns, by that of arrays, and what their numbers are multiplied by; degrees as the
#: library's reader of tables does it, to the bit.
_COLUMN_UNITS = {
    "mm": {"mm": 1.0},
    "rad": {"deg": np.pi / 180.0, "rad": 1.0},
    "mm/m": {"mm_per_m": 1.0},
}


def of_result(array: Array) -> Array:
    """The array of a result, which belongs to nobody else: to change it would change nothing."""
    array.flags.writeable = False
    return array


def as_doubles(what: str, numbers: npt.ArrayLike) -> FloatArray:
    """An array of doubles. Accepts integers, but no text, complex or boolean values."""
    array = np.asarray(numbers)
    if array.dtype.kind not in "iuf":
        raise InvalidArgument(f"{what}: expected an array of numbers, got dtype {array.dtype}")
    return np.asarray(array, dtype=np.float64)


def column_names(table: Any) -> list[Any] | None:
    """Column names of a dict or a DataFrame (pandas, polars, pyarrow); None for other objects."""
    for attribute in ("keys", "column_names", "columns"):
        names = getattr(table, attribute, None)
        if names is not None:
            return list(names() if callable(names) else names)
    return None


def by_name(
    what: str, table: Any, wanted: Mapping[str, str], unsaid: Mapping[str, float]
) -> FloatArray:
    """Array (..., columns) from a DataFrame or a dict of columns, which may have a column "pose".

    wanted: units of the array by column names without units, in the order of the array. unsaid:
        default values of optional columns; all others are required.
    """
    spelt = {
        stem: {f"{stem}_{suffix}": factor for suffix, factor in _COLUMN_UNITS[unit].items()}
        for stem, unit in wanted.items()
    }
    stems = {name: stem for stem, names in spelt.items() for name in names}
    columns: dict[str, FloatArray] = {}
    unknown = []
    for name in column_names(table) or ():
        stem = stems.get(name)
        if stem is not None and stem not in columns:
            numbers = as_doubles(f"{what}: column {name}", table[name])
            columns[stem] = spelt[stem][name] * numbers
        elif name != "pose":
            unknown.append(str(name))
    missing = [next(iter(spelt[one])) for one in wanted if one not in {*columns, *unsaid}]
    if unknown or missing:
        expected = ", ".join(" or ".join(names) for names in spelt.values())
        got = [f"unknown: {', '.join(unknown)}"] if unknown else []
        got += [f"missing: {', '.join(missing)}"] if missing else []
        raise InvalidArgument(f"{what}: expected columns {expected}; {'; '.join(got)}")
    shapes = {column.shape for column in columns.values()}
    if len(shapes) != 1:
        raise InvalidArgument(f"{what}: expected columns of one length, got shapes {shapes}")
    (shape,) = shapes
    rows = [columns[one] if one in columns else np.full(shape, unsaid[one]) for one in wanted]
    return np.stack(rows, axis=-1)


def as_rows(what: str, numbers: npt.ArrayLike, columns: int) -> tuple[FloatArray, tuple[int, ...]]:
    """Rows (n, columns), and the leading shape (...) of the argument (..., columns)."""
    array = as_doubles(what, numbers)
    if array.ndim == 0 or array.shape[-1] != columns:
        raise InvalidArgument(
            f"{what}: expected an array of shape (..., {columns}), got {array.shape}"
        )
    return array.reshape(-1, columns), array.shape[:-1]


def pose_axes(robot: _paracal.Robot) -> tuple[str, ...]:
    """Names of the coordinates of a pose: positions in mm, then angles in rad."""
    angles = ("tilt_x", "tilt_y", "tilt_z") if robot.commands_tilt else ("phi",)
    return ("x", "y", "z", *angles)


def as_poses(poses: Numbers, robot: _paracal.Robot) -> tuple[FloatArray, tuple[int, ...]]:
    """(n, 4): x, y, z in mm, phi in rad. With commanded tilt (n, 6): x, y, z in mm, tilt_x, tilt_y,
    tilt_z in rad. Missing angles are 0. Columns are named as in files: x_mm or x_cmd_mm, ..."""
    angles = pose_axes(robot)[3:]
    numbers: Any = poses
    names = column_names(poses)
    if names is not None:
        commanded = "_cmd" if "x_cmd_mm" in names else ""
        unsaid = {f"{angle}{commanded}": 0.0 for angle in angles}
        if robot.guided_z is not None:
            unsaid[f"z{commanded}"] = robot.guided_z
        units = {f"{axis}{commanded}": "mm" for axis in "xyz"}
        units.update({f"{angle}{commanded}": "rad" for angle in angles})
        numbers = by_name("poses", poses, units, unsaid)
    array = as_doubles("poses", numbers)
    if array.ndim > 0 and array.shape[-1] == 3:
        array = np.concatenate([array, np.zeros(array.shape[:-1] + (len(angles),))], axis=-1)
    width = 3 + len(angles)
    if array.ndim == 0 or array.shape[-1] != width:
        raise InvalidArgument(
            f"poses: expected an array of shape (..., {width}) of x, y, z in mm, "
            f"{', '.join(angles)} in rad for {robot.name}, or (..., 3), got {array.shape}"
        )
    return array.reshape(-1, width), array.shape[:-1]


def as_joints(joints: Numbers, robot: _paracal.Robot) -> tuple[FloatArray, tuple[int, ...]]:
    """(n, limbs), rad or mm; columns are named as in files: q1_deg, or q1_mm for rails and
    struts."""
    numbers: Any = joints
    if column_names(joints) is not None:
        units = {f"q{k + 1}": robot.joint_unit for k in range(robot.limb_count)}
        numbers = by_name("joints", joints, units, {})
    return as_rows("joints", numbers, robot.limb_count)


def shaped(array: Any, lead: tuple[int, ...]) -> Any:
    """Rows in the leading shape of the argument."""
    return array.reshape(lead + array.shape[1:])
