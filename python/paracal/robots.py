"""Robots, geometric errors and machines as built."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _html, _paracal, _tables
from ._arrays import (
    FloatArray,
    Numbers,
    as_doubles,
    as_rows,
    by_name,
    column_names,
    of_result,
    pose_axes,
)
from .errors import InvalidArgument

if TYPE_CHECKING:
    import pandas

    from .calibration import Calibration
    from .known import KnownMachine
    from .tolerances import Tolerances

#: Argument of every kinematic function: a robot stands for its nominal machine, a calibration for
#: the calibrated machine.
MachineLike = Union["Robot", "Machine", "Calibration", "KnownMachine"]

#: The 14 geometric errors of a limb with an arm, in the column order of every array of errors. A
#: carriage has `gain` instead of `arm_length`. Robot.sources lists those of any robot.
SOURCES = (
    "theta_offset",
    "e_x",
    "e_y",
    "e_z",
    "arm_length",
    "alpha0",
    "beta0",
    "rod_mean",
    "rod_difference",
    "width_difference",
    "alpha03",
    "beta03",
    "alpha2",
    "beta2",
)


class Robot:
    """A nominal robot, as its controller assumes it. robot() returns it."""

    def __init__(self, native: _paracal.Robot) -> None:
        self._native = native

    @property
    def name(self) -> str:
        """Name from the catalogue or the robot file."""
        return self._native.name

    @property
    def limb_count(self) -> int:
        """Number of limbs, equal to that of `freedoms`: 3 with a rigid plate, 4 with an articulated
        plate, 6 on a hexapod."""
        return self._native.limb_count

    @property
    def joint_unit(self) -> str:
        """Unit of joint coordinates: "rad" for revolute actuators, "mm" for rails and struts."""
        return self._native.joint_unit

    @property
    def freedoms(self) -> tuple[str, ...]:
        """Degrees of freedom: x, y, z, and phi of an end-effector. With limbs of one rod: those of
        x, y, z, tilt_x, tilt_y, tilt_z that the guides leave."""
        return self._native.freedoms

    @property
    def has_six_freedoms(self) -> bool:
        """Whether the plate has six degrees of freedom, as on six struts."""
        return len(self.freedoms) == 6

    @property
    def commands_tilt(self) -> bool:
        """Whether a tilt of the plate is commanded; if not, the plate stays level."""
        return self._native.commands_tilt

    @property
    def pose_axes(self) -> tuple[str, ...]:
        """Columns of a pose in an array: x, y, z in mm, then angles in rad: phi, or with commanded
        tilt tilt_x, tilt_y, tilt_z with R = Rot(x) Rot(y) Rot(z)."""
        return pose_axes(self._native)

    @property
    def rotates(self) -> bool:
        """Whether an end-effector rotates on the plate; if not, phi is 0."""
        return self._native.rotates

    @property
    def geometry(self) -> dict[str, Any]:
        """Dimensions that all limbs share. With limbs of one rod: `limb`, with one dict per limb as
        in robot files. The keys state the units."""
        described = json.loads(self._native.json())
        if "geometry" not in described:
            return {"limb": described["limb"]}
        shared = self._native.geometry
        of_result(shared["limb_azimuth_rad"])
        return shared

    @property
    def workspace(self) -> dict[str, Any]:
        """The workspace with the keys of its shape in robot files, which state the units: a
        cylinder from top_z_mm downwards, a box, or heights and radii. rotation_rad: smallest and
        largest phi. tilt_rad: largest absolute value of each commanded tilt."""
        stated = json.loads(self._native.json())["workspace"]
        shape = {key: value for key, value in stated.items() if key.endswith("_mm")}
        return {**shape, **self._native.workspace_angles}

    @property
    def sources(self) -> tuple[str, ...]:
        """The geometric errors of a limb, in the column order of every array of errors."""
        return tuple(self.units)

    @property
    def units(self) -> dict[str, str]:
        """Unit of each geometric error in arrays: "mm", "rad" or "mm/m"."""
        return {name: unit for name, _, unit in self._native.sources}

    @property
    def intended(self) -> FloatArray:
        """(limbs, sources) intended differences between limbs, mm and rad. Geometric errors are
        relative to these."""
        return of_result(self._native.intended)

    def errors(self, **by_name: npt.ArrayLike) -> FloatArray:
        """(limbs, sources) geometric errors, actual minus nominal, in their units; zero where not
        named.

        robot.errors(theta_offset=np.radians([0.2, 0.8, 0.9, 0.3]), e_x=0.1): one number for all
        limbs, or one per limb.
        Raises InvalidArgument for an unknown name or a wrong number of values.
        """
        sources = self.sources
        errors = np.zeros((self.limb_count, len(sources)))
        for name, values in by_name.items():
            if name not in sources:
                raise InvalidArgument(f"errors: expected names of {', '.join(sources)}, got {name}")
            column = as_doubles(name, values)
            if column.shape not in ((), (1,), (self.limb_count,)) and column.size != 1:
                raise InvalidArgument(
                    f"{name}: expected one number, or one for each of {self.limb_count} limbs, "
                    f"got shape {column.shape}"
                )
            errors[:, sources.index(name)] = column
        return errors

    def to_toml(self) -> str:
        """Text of a robot file for robot(), mm and deg."""
        return self._native.toml()

    def __repr__(self) -> str:
        return f"<paracal.Robot {self.name}: {self.limb_count} limbs, joints in {self.joint_unit}>"

    def _repr_html_(self) -> str:
        geometry = self.geometry
        limbs = geometry.pop("limb", [])
        shown = {
            key: str(value) if isinstance(value, np.ndarray) else value
            for key, value in {**geometry, **self.workspace}.items()
        }
        rows = [[k, *limb.values()] for k, limb in enumerate(limbs, start=1)]
        return (
            _html.heading(f"robot {self.name}")
            + (_html.table(["limb", *limbs[0]], rows) if limbs else "")
            + _html.pairs(shown)
        )


class Machine:
    """A robot as built, with its geometric errors.

    errors: (limbs, sources), actual minus nominal, columns as robot.sources in the units of
        robot.units; or a DataFrame or dict with columns as from errors_frame(); default: none.
    Raises InvalidArgument for a wrong shape or column, numbers that are not finite, and impossible
    machines.
    """

    def __init__(self, robot: Robot, errors: Numbers | None = None) -> None:
        native = native_robot(robot)
        columns = len(robot.sources)
        given: Any = np.zeros((robot.limb_count, columns)) if errors is None else errors
        if column_names(given) is not None:
            given = by_name("errors", given, robot.units, {})
        rows, lead = as_rows("errors", given, columns)
        if lead != (robot.limb_count,):
            raise InvalidArgument(
                f"errors: expected shape ({robot.limb_count}, {columns}), "
                f"got {np.shape(given)}"
            )
        if not np.all(np.isfinite(rows)):
            raise InvalidArgument("errors: expected finite numbers, got NaN or infinity")
        self._native = _paracal.machine(native, rows)
        self.robot = robot

    @property
    def errors(self) -> FloatArray:
        """(limbs, sources) geometric errors, mm, rad and mm/m."""
        return of_result(self._native.errors)

    def __repr__(self) -> str:
        count = np.count_nonzero(self.errors)
        return f"<paracal.Machine {self.robot.name} with {count} geometric errors>"


def robot(name: str | os.PathLike[str]) -> Robot:
    """A robot of the catalogue (see catalogue()) or of a robot file (.toml).

    Raises InvalidArgument for an unknown name, InputFileError for an invalid robot file.
    """
    return Robot(_paracal.named_robot(_tables.path_of(name)))


def robot_of_toml(text: str, name: str = "robot.toml") -> Robot:
    """A robot from the text of a robot file. `name` is its name in messages. Raises
    InputFileError."""
    return Robot(_paracal.robot_of_toml(name.encode(), text))


def robot_template(kind: str) -> str:
    """Text of a commented robot file, to enter the dimensions of a machine: "hexapod", as from
    `paracal robot --template`. robot_of_toml() reads it. Raises InvalidArgument for an unknown
    kind."""
    return _paracal.robot_template(kind)


def catalogue() -> list[str]:
    """Names of the catalogue, for robot()."""
    return _paracal.catalogue()


def read_errors(robot: Robot, path: str | os.PathLike[str]) -> FloatArray:
    """(limbs, sources) geometric errors from a file (TOML, mm and deg), in mm, rad and mm/m. Raises
    InputFileError."""
    return _paracal.read_errors(native_robot(robot), _tables.path_of(path))


def errors_toml(robot: Robot, errors: Numbers) -> str:
    """Text of a file for read_errors() and the program, from geometric errors (limbs, sources) in mm,
    rad and mm/m."""
    return _paracal.errors_toml(native_robot(robot), Machine(robot, errors).errors)


def errors_frame(robot: Robot, errors: Numbers) -> pandas.DataFrame:
    """Geometric errors (limbs, sources) as a DataFrame: one row per limb, columns with their units
    (e_x_mm, alpha0_rad, gain_mm_per_m)."""
    rows = Machine(robot, errors).errors
    columns = {
        f"{name}_{unit.replace('/', '_per_')}": rows[:, k]
        for k, (name, unit) in enumerate(robot.units.items())
    }
    return _tables.frame(columns, [f"limb {k + 1}" for k in range(robot.limb_count)])


def draw_errors(
    robot: Robot,
    machines: int | None = None,
    tolerances: Tolerances | None = None,
    seed: int = 1,
    first: int = 0,
) -> FloatArray:
    """Random geometric errors of simulated machines, independent, within the tolerances.

    Machine m uses stream m of the seed, as `paracal simulate --seed SEED --machine m`.
    machines: number of machines; the result is (machines, limbs, sources), or (limbs, sources) for
        None, in mm and rad.
    tolerances: default: the robot's tolerances, or default tolerances if it states none.
    first: number of the first machine.
    """
    if machines is not None and machines < 0:
        raise InvalidArgument(f"machines: expected at least 0, got {machines}")
    from .tolerances import native_tolerances

    native = native_tolerances(tolerances, robot)
    drawn = _paracal.draw_errors(
        native_robot(robot), native, seed, first, 1 if machines is None else machines
    )
    return drawn if machines is not None else np.asarray(drawn[0])


def native_robot(of: Robot) -> _paracal.Robot:
    """The compiled robot. Raises InvalidArgument for another type."""
    if isinstance(of, Robot):
        return of._native
    raise InvalidArgument(f"robot: expected a Robot from robot(), got {type(of).__name__}")


def native_machine(of: MachineLike) -> _paracal.Machine:
    """The compiled machine of a robot, a machine or a calibration."""
    if isinstance(of, Robot):
        return Machine(of)._native
    if isinstance(of, Machine):
        return of._native
    machine = getattr(of, "machine", None)
    if isinstance(machine, Machine):
        return machine._native
    raise InvalidArgument(
        f"machine: expected a Robot, Machine, Calibration or KnownMachine, got {type(of).__name__}"
    )


def parameter_names(parameters: Sequence[tuple[str, int, str]]) -> list[str]:
    """ "e_x.2": e_x of limb 2, as in `fixed` and `free` of calibrate()."""
    return [f"{name}.{limb}" for name, limb, _ in parameters]
