"""Robots, source errors and machines as built."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _html, _paracal, _tables
from ._arrays import FloatArray, as_doubles, as_rows
from .errors import InvalidArgument

if TYPE_CHECKING:
    import pandas

    from .calibration import Calibration
    from .known import KnownMachine
    from .tolerances import Tolerances

#: What every kinematic function takes: a robot stands for its nominal machine, a calibration for
#: the machine that it found.
MachineLike = Union["Robot", "Machine", "Calibration", "KnownMachine"]

#: The 14 source errors of a limb, in the order of the columns of every array of errors.
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
        """4 with an articulated plate, 3 with a rigid one."""
        return self._native.limb_count

    @property
    def joint_unit(self) -> str:
        """Unit of joint coordinates: "rad" of revolute actuators, "mm" of linear ones."""
        return self._native.joint_unit

    @property
    def rotates(self) -> bool:
        """Whether the end-effector turns; phi of a rigid plate is 0."""
        return self._native.rotates

    @property
    def geometry(self) -> dict[str, Any]:
        """Dimensions that all limbs share; mm and rad, as the keys say."""
        return self._native.geometry

    @property
    def workspace(self) -> dict[str, Any]:
        """The cylinder in which it works; mm and rad, as the keys say. z runs from top_z_mm
        down."""
        return self._native.workspace

    @property
    def units(self) -> dict[str, str]:
        """Unit of each source error in arrays, "mm" or "rad"."""
        return {name: unit for name, _, unit in self._native.sources}

    @property
    def intended(self) -> FloatArray:
        """(limbs, 14) by which limbs differ on purpose; mm and rad. Source errors count from
        here."""
        return self._native.intended

    def errors(self, **by_name: npt.ArrayLike) -> FloatArray:
        """(limbs, 14) source errors, actual minus nominal, mm or rad; zero where not named.

        robot.errors(theta_offset=np.radians([0.2, 0.8, 0.9, 0.3]), e_x=0.1): one number is meant
        for all limbs, else one a limb.
        Raises InvalidArgument for another name or count.
        """
        errors = np.zeros((self.limb_count, len(SOURCES)))
        for name, values in by_name.items():
            if name not in SOURCES:
                raise InvalidArgument(f"errors: expected names of {', '.join(SOURCES)}, got {name}")
            column = as_doubles(name, values)
            if column.shape not in ((), (1,), (self.limb_count,)) and column.size != 1:
                raise InvalidArgument(
                    f"{name}: expected one number, or one for each of {self.limb_count} limbs, "
                    f"got shape {column.shape}"
                )
            errors[:, SOURCES.index(name)] = column
        return errors

    def to_toml(self) -> str:
        """The robot as a file that robot() reads, mm and deg."""
        return self._native.toml()

    def __repr__(self) -> str:
        return f"<paracal.Robot {self.name}: {self.limb_count} limbs, joints in {self.joint_unit}>"

    def _repr_html_(self) -> str:
        shown = {
            key: str(value) if isinstance(value, np.ndarray) else value
            for key, value in {**self.geometry, **self.workspace}.items()
        }
        return _html.heading(f"robot {self.name}") + _html.pairs(shown)


class Machine:
    """A robot as built: with the source errors that it has.

    errors: (limbs, 14), actual minus nominal, mm and rad, columns as SOURCES; default: none.
    Raises InvalidArgument for another shape, numbers that are not finite, and machines that cannot
    be.
    """

    def __init__(self, robot: Robot, errors: npt.ArrayLike | None = None) -> None:
        given = np.zeros((robot.limb_count, len(SOURCES))) if errors is None else errors
        rows, lead = as_rows("errors", given, len(SOURCES))
        if lead != (robot.limb_count,):
            raise InvalidArgument(
                f"errors: expected shape ({robot.limb_count}, {len(SOURCES)}), "
                f"got {np.shape(given)}"
            )
        if not np.all(np.isfinite(rows)):
            raise InvalidArgument("errors: expected finite numbers, got NaN or infinity")
        self._native = _paracal.Machine(robot._native, rows)
        self.robot = robot

    @property
    def errors(self) -> FloatArray:
        """(limbs, 14), mm and rad."""
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


def catalogue() -> list[str]:
    """Names that robot() knows."""
    return _paracal.catalogue()


def read_errors(robot: Robot, path: str | os.PathLike[str]) -> FloatArray:
    """(limbs, 14) source errors of a file (TOML, mm and deg), in mm and rad. Raises
    InputFileError."""
    return _paracal.read_errors(robot._native, _tables.path_of(path))


def errors_toml(robot: Robot, errors: npt.ArrayLike) -> str:
    """Source errors (limbs, 14), mm and rad, as a file that read_errors() and the program read."""
    return _paracal.errors_toml(robot._native, Machine(robot, errors).errors)


def errors_frame(robot: Robot, errors: npt.ArrayLike) -> pandas.DataFrame:
    """Source errors (limbs, 14) as a DataFrame: a row a limb, columns with their units (e_x_mm,
    alpha0_rad)."""
    rows = Machine(robot, errors).errors
    columns = {f"{name}_{unit}": rows[:, k] for k, (name, unit) in enumerate(robot.units.items())}
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
    machines: how many, for (machines, limbs, 14); None: one, for (limbs, 14). mm and rad.
    tolerances: default: the robot's own, or generous ones where it states none.
    first: number of the first machine.
    """
    if machines is not None and machines < 0:
        raise InvalidArgument(f"machines: expected at least 0, got {machines}")
    from .tolerances import Tolerances as Default

    native = (tolerances or Default.of(robot))._native
    drawn = _paracal.draw_errors(
        robot._native, native, seed, first, 1 if machines is None else machines
    )
    return drawn if machines is not None else np.asarray(drawn[0])


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
