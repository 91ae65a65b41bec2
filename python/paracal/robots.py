"""Robots, source errors and machines as built."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _html, _paracal, _tables
from ._arrays import FloatArray, Numbers, as_doubles, as_rows, by_name, column_names, pose_axes
from .errors import InvalidArgument

if TYPE_CHECKING:
    import pandas

    from .calibration import Calibration
    from .known import KnownMachine
    from .tolerances import Tolerances

#: What every kinematic function takes: a robot stands for its nominal machine, a calibration for
#: the machine that it found.
MachineLike = Union["Robot", "Machine", "Calibration", "KnownMachine"]

#: The 14 source errors of a limb with an arm, in the order of the columns of every array of errors;
#: of a carriage `gain` stands in the place of `arm_length`. Robot.sources has those of any robot.
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
    """A nominal robot: what its controller believes. Made by robot()."""

    def __init__(self, native: _paracal.Robot) -> None:
        self._native = native

    @property
    def name(self) -> str:
        """Of the catalogue or the robot file."""
        return self._native.name

    @property
    def limb_count(self) -> int:
        """As many as `freedoms`: 4 with an articulated plate, 3 with a rigid one, 6 of a hexapod."""
        return self._native.limb_count

    @property
    def joint_unit(self) -> str:
        """Unit of joint coordinates: "rad" of revolute actuators, "mm" of rails and struts."""
        return self._native.joint_unit

    @property
    def freedoms(self) -> tuple[str, ...]:
        """What a controller commands: x, y and z, phi of an end-effector; on limbs with one rod
        what guides leave free of x, y, z, tilt_x, tilt_y, tilt_z."""
        return self._native.freedoms

    @property
    def has_six_freedoms(self) -> bool:
        """Whether the plate moves and tilts every way, as on six struts."""
        return len(self.freedoms) == 6

    @property
    def commands_tilt(self) -> bool:
        """Whether some tilt of the plate is commanded; else the plate stays level."""
        return self._native.commands_tilt

    @property
    def pose_axes(self) -> tuple[str, ...]:
        """What a pose in an array is made of: x, y, z in mm, then angles in rad: phi, or of a plate
        whose tilt is commanded tilt_x, tilt_y, tilt_z with R = Rot(x) Rot(y) Rot(z)."""
        return pose_axes(self._native)

    @property
    def rotates(self) -> bool:
        """Whether an end-effector turns on the plate; phi of any other is 0."""
        return self._native.rotates

    @property
    def geometry(self) -> dict[str, Any]:
        """Dimensions that all limbs share; of limbs with one rod `limb`, a dict a limb as in robot
        files. The keys say the unit."""
        described = json.loads(self._native.json())
        return self._native.geometry if "geometry" in described else {"limb": described["limb"]}

    @property
    def workspace(self) -> dict[str, Any]:
        """The cylinder in which it works; mm and rad, as the keys say. z runs from top_z_mm
        down; rotation_rad is the smallest and the largest phi, tilt_rad of a plate
        whose tilt is commanded how far each tilt goes either way."""
        return self._native.workspace

    @property
    def sources(self) -> tuple[str, ...]:
        """The source errors of a limb, in the order of the columns of every array of errors."""
        return tuple(self.units)

    @property
    def units(self) -> dict[str, str]:
        """Unit of each source error in arrays: "mm", "rad" or "mm/m"."""
        return {name: unit for name, _, unit in self._native.sources}

    @property
    def intended(self) -> FloatArray:
        """(limbs, sources) by which limbs differ on purpose; mm and rad. Source errors
        count from here."""
        return self._native.intended

    def errors(self, **by_name: npt.ArrayLike) -> FloatArray:
        """(limbs, sources) source errors, actual minus nominal, in their units; zero where not
        named.

        robot.errors(theta_offset=np.radians([0.2, 0.8, 0.9, 0.3]), e_x=0.1): one number is meant
        for all limbs, else one a limb.
        Raises InvalidArgument for another name or count.
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
        """The robot as a file that robot() reads, mm and deg."""
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
    """A robot as built: with the source errors that it has.

    errors: (limbs, sources), actual minus nominal, columns as robot.sources in the units of
        robot.units; or a DataFrame or dict of columns as errors_frame() names them; default: none.
    Raises InvalidArgument for another shape or column, numbers that are not finite, and machines
    that cannot be.
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
        self._native = _paracal.Machine(native, rows)
        self.robot = robot

    @property
    def errors(self) -> FloatArray:
        """(limbs, sources), mm, rad and mm/m."""
        return self._native.errors

    def __repr__(self) -> str:
        count = np.count_nonzero(self.errors)
        return f"<paracal.Machine {self.robot.name} with {count} source errors>"


def robot(name: str | os.PathLike[str]) -> Robot:
    """A robot of the catalogue (see catalogue()) or of a robot file (.toml).

    Raises InvalidArgument for an unknown name, InputFileError for a file that is no robot.
    """
    return Robot(_paracal.named_robot(_tables.path_of(name)))


def robot_of_toml(text: str, name: str = "robot.toml") -> Robot:
    """A robot from the text of a robot file; `name` is what messages call it. Raises
    InputFileError."""
    return Robot(_paracal.robot_of_toml(name.encode(), text))


def robot_template(kind: str) -> str:
    """The text of a commented robot file to put a machine's numbers into: "hexapod"; for
    robot_of_toml(), as `paracal robot --template` prints it. Raises InvalidArgument for another
    kind."""
    return _paracal.robot_template(kind)


def catalogue() -> list[str]:
    """Names that robot() knows."""
    return _paracal.catalogue()


def read_errors(robot: Robot, path: str | os.PathLike[str]) -> FloatArray:
    """(limbs, sources) source errors of a file (TOML, mm and deg), in mm, rad and mm/m. Raises
    InputFileError."""
    return _paracal.read_errors(native_robot(robot), _tables.path_of(path))


def errors_toml(robot: Robot, errors: Numbers) -> str:
    """Source errors (limbs, sources), mm, rad and mm/m, as a file that read_errors() and the
    program read."""
    return _paracal.errors_toml(native_robot(robot), Machine(robot, errors).errors)


def errors_frame(robot: Robot, errors: Numbers) -> pandas.DataFrame:
    """Source errors (limbs, sources) as a DataFrame: a row a limb, columns with their units
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
    """Source errors of machines out of a batch, each error independent within its tolerance.

    Machine m is stream m of the seed, the same as `paracal simulate --seed SEED --machine m`.
    machines: how many, for (machines, limbs, sources); None: one, for (limbs, sources). mm and rad.
    tolerances: default: the robot's own, or generous ones where it states none.
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
    """What the library takes; says what came where that is no robot."""
    if isinstance(of, Robot):
        return of._native
    raise InvalidArgument(f"robot: expected a Robot, as robot() gives it, got {type(of).__name__}")


def native_machine(of: MachineLike) -> _paracal.Machine:
    """The machine that a robot, a machine or a calibration stands for."""
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
    """ "e_x.2": e_x of limb 2, as `fixed` and `free` of calibrate() take it."""
    return [f"{name}.{limb}" for name, limb, _ in parameters]
