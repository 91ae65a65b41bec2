"""Tolerances: half-widths of all geometric errors."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Mapping

from . import _html, _paracal, _tables
from ._arrays import FloatArray
from .errors import InvalidArgument
from .robots import Robot, native_robot

if TYPE_CHECKING:
    import pandas


class Tolerances:
    """Half-widths of all geometric errors of a robot. Tolerances.of(), .stated() and .read() return
    it."""

    def __init__(self, native: _paracal.Tolerances, robot: Robot) -> None:
        self._native = native
        self._robot = robot

    @classmethod
    def of(cls, robot: Robot) -> Tolerances:
        """The robot's tolerances, or default tolerances if it states none."""
        return cls(_paracal.tolerances_of(native_robot(robot)), robot)

    @classmethod
    def stated(
        cls,
        robot: Robot,
        half_widths: Mapping[str, float],
        others: str = "exact",
        distribution: str = "normal",
    ) -> Tolerances:
        """Half-widths by name, in the units of robot.units. `others`: "exact" (zero) or `generous`
        (default tolerances) for the rest.

        distribution: "normal", "uniform" or "truncated_normal".
        Raises InvalidArgument for an unknown name or a half-width below zero.
        """
        given = {name: float(value) for name, value in half_widths.items()}
        native = _paracal.stated_tolerances(native_robot(robot), given, others, distribution)
        return cls(native, robot)

    @classmethod
    def read(cls, path: str | os.PathLike[str], robot: Robot) -> Tolerances:
        """Tolerances from a file (TOML, mm and deg), or from the table [tolerances] of a robot file.
        Raises InputFileError."""
        return cls(_paracal.read_tolerances(native_robot(robot), _tables.path_of(path)), robot)

    @property
    def half_widths(self) -> dict[str, float]:
        """Half-width T of every geometric error, in its unit (robot.units)."""
        return self._by_name(self._native.half_widths(self._robot._native))

    @property
    def std(self) -> dict[str, float]:
        """Standard deviation of every geometric error, in its unit."""
        return self._by_name(self._native.std(self._robot._native))

    def _by_name(self, numbers: FloatArray) -> dict[str, float]:
        return dict(zip(self._robot.sources, numbers.tolist()))

    @property
    def assumed(self) -> list[str]:
        """Assumptions, with their values."""
        return self._native.assumed

    def to_toml(self) -> str:
        """Text of a tolerance file for read() and the program, mm and deg."""
        return self._native.toml(self._robot._native)

    def to_frame(self) -> pandas.DataFrame:
        """One row per geometric error: half_width and std, see unit."""
        return _tables.frame(
            {
                "unit": list(self._robot.units.values()),
                "half_width": list(self.half_widths.values()),
                "std": list(self.std.values()),
            },
            list(self._robot.sources),
        )

    def __repr__(self) -> str:
        return f"<paracal.Tolerances of {self._robot.name}>"

    def _repr_html_(self) -> str:
        units = self._robot.units
        rows = [[name, value, units[name]] for name, value in self.half_widths.items()]
        return (
            _html.heading(f"tolerances of {self._robot.name} (half-widths, 3 sigma)")
            + _html.table(["geometric error", "half-width", "unit"], rows)
            + _html.items("assumed", self.assumed)
        )


def native_tolerances(
    given: Tolerances | None, robot: Robot, what: str = "tolerances"
) -> _paracal.Tolerances:
    """The compiled object; the robot's tolerances if none are given. Raises InvalidArgument for
    tolerances of a robot with other geometric errors."""
    native = native_robot(robot)
    if given is None:
        return _paracal.tolerances_of(native)
    if not isinstance(given, Tolerances):
        raise InvalidArgument(f"{what}: expected Tolerances, got {type(given).__name__}")
    if robot.units == given._robot.units:
        return given._native
    raise InvalidArgument(
        f"{what}: expected tolerances of {robot.name}, got those of {given._robot.name}, "
        "which has other geometric errors"
    )
