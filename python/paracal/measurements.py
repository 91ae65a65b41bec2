"""Measurements, poses and joints: read from and write to files, DataFrames and dicts of columns."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Iterable, Sequence

from . import _html, _paracal, _tables
from ._arrays import FloatArray, of_result
from ._tables import Table
from .errors import InvalidArgument
from .robots import Robot, native_robot

if TYPE_CHECKING:
    import pandas


class Measurements:
    """Readings of a machine, of one or several kinds: points, distances, heights, ball-bar lengths,
    dial readings. read_measurements() and simulate() return it."""

    def __init__(self, native: _paracal.Measurements, robot: Robot | None = None) -> None:
        self._native = native
        self._robot = robot

    @property
    def poses(self) -> FloatArray:
        """(n, 4) commanded poses: x, y, z in mm, phi in rad; or with commanded tilt (n, 6): x, y, z,
        tilt_x, tilt_y, tilt_z. The first is home."""
        return of_result(self._stations[1])

    @property
    def names(self) -> list[str]:
        """Names of the poses."""
        return self._stations[0]

    @property
    def _stations(self) -> tuple[list[str], FloatArray]:
        return self._native.stations(None if self._robot is None else self._robot._native)

    @property
    def counts(self) -> dict[str, int]:
        """Number of readings of each kind."""
        return self._native.counts

    @property
    def notes(self) -> list[str]:
        """Readings that were ignored: blank, missing or duplicate."""
        return self._native.notes

    @property
    def robot(self) -> Robot | None:
        """The robot stated in the tables ("# robot: NAME") or given to read_measurements()."""
        return Robot(self._native.robot) if self._native.robot else self._robot

    def to_csv(self, robot: Robot | None = None) -> dict[str, str]:
        """The text of the tables (mm and deg) by name. read_measurements() returns equal readings.
        A repeated name gets a number: "points", "points 2".

        robot: required if the tables state no robot and read_measurements() got none.
        Raises InvalidArgument for a missing robot, or pose names that cannot be read back.
        """
        tables: dict[str, str] = {}
        for _, name, text in self._tables(robot):
            numbered = (f"{name} {k}" for k in itertools.count(2))
            tables[next(one for one in itertools.chain([name], numbered) if one not in tables)] = text
        return tables

    def to_frame(self, kind: str | None = None, robot: Robot | None = None) -> pandas.DataFrame:
        """Readings of one kind ("points", "distances", "heights", "ball bar lengths", ... as in
        counts) or "poses" as a DataFrame with the columns of files (mm and deg). Several series
        add the column `series`.

        kind: default: the kind that was read first. read_measurements() accepts the DataFrame.
        """
        tables = self._tables(robot)
        wanted = kind if kind is not None else tables[0][0]
        parts = [(name, _tables.rows_of(text)) for of, name, text in tables if of == wanted]
        if not parts:
            known = ", ".join(sorted({of for of, _, _ in tables}))
            raise InvalidArgument(f"kind: expected one of {known}, got {wanted}")
        if len(parts) == 1:
            return _tables.frame(parts[0][1])
        names = list(dict.fromkeys(key for _, part in parts for key in part))
        columns: dict[str, list[object]] = {"series": [], **{key: [] for key in names}}
        for name, part in parts:
            count = len(next(iter(part.values())))
            columns["series"] += [name] * count
            for key in names:
                columns[key] += part.get(key, [float("nan")] * count)
        return _tables.frame(columns)

    def at_reference_temperature(
        self,
        temperature_c: float,
        expansion_ppm: float = 11.5,
        instrument_expansion_ppm: float = 0.0,
    ) -> Measurements:
        """The measurements, corrected to 20 deg C  [iso1].

        temperature_c: temperature of the machine during the measurement, deg C.
        expansion_ppm: expansion of the machine per K: steel 11.5, aluminium 23, carbon 0.
        instrument_expansion_ppm: expansion of the instrument per K; 0: it corrects itself.
        """
        expansion = 1e-6 * (expansion_ppm - instrument_expansion_ppm) * (temperature_c - 20.0)
        return Measurements(self._native.at_reference_temperature(expansion), self._robot)

    def _tables(self, robot: Robot | None) -> list[tuple[str, str, str]]:
        of = robot or self.robot
        if of is None:
            raise InvalidArgument(
                "robot: expected a robot, because the tables state none"
            )
        return self._native.tables(of._native)

    def __repr__(self) -> str:
        read = ", ".join(f"{count} {kind}" for kind, count in self.counts.items())
        return f"<paracal.Measurements at {len(self.names)} poses: {read}>"

    def _repr_html_(self) -> str:
        return (
            _html.heading(f"measurements at {len(self.names)} poses")
            + _html.table(["kind", "readings"], self.counts.items())
            + _html.items("note", self.notes)
        )


def native_measurements(of: Measurements) -> _paracal.Measurements:
    """The compiled measurements. Raises InvalidArgument for another type."""
    if isinstance(of, Measurements):
        return of._native
    raise InvalidArgument(
        "measurements: expected Measurements from read_measurements(), "
        f"got {type(of).__name__}"
    )


def _list(tables: Table | Sequence[Table] | None) -> list[Table]:
    if tables is None:
        return []
    return list(tables) if isinstance(tables, (list, tuple)) else [tables]


def read_measurements(
    tables: Table | Sequence[Table],
    poses: Table | Sequence[Table] | None = None,
    robot: Robot | None = None,
    columns: str | None = None,
    unit: str | None = None,
    match: str = "name",
    decimal_comma: bool = False,
    ignore_columns: Sequence[str] = (),
) -> Measurements:
    """Measurements from tables: files (CSV), DataFrames or dicts of columns, one or several.

    The columns determine the kind: points (pose, x_cmd_mm, ..., x_mm, y_mm, z_mm; for a body also
    qw, qx, qy, qz), distances (from, to, distance_mm), heights (pose, height_mm), ball bars (pose,
    ball_bar_mm), dials (pose, dial_mm, direction_x, ...). docs/files.md lists all columns. Column
    names state the units; angles are in deg. Blank cells, None and NaN mean no reading. Several
    tables are fitted together, each in its own frame.

    poses: the table of the poses that distances, lengths and exports name; one for all tables, or
        one for each.
    robot: the measured robot; a file with another "# robot: NAME" is refused.
    columns, unit: format of an instrument's text export if its header is not sufficient: numbers
        or headings, columns="name=3,x=4,y=5,z=6" or "name=Target,x=Measured X,...", or
        "spatialanalyzer"; unit="mm", "m", "um" or "inch".
    match: assign points of an export to poses by "name" or by "order".
    decimal_comma: True: 1,5 is a number. Without it, decimal commas must be evident.
    ignore_columns: headings of columns to ignore; other unknown columns are refused.
    Raises InputFileError (with file and line) for a table that cannot be read, InvalidArgument for
    an export in another format, or missing poses.
    """
    given = _list(tables)
    if not given:
        raise InvalidArgument("tables: expected at least one, got none")
    if match not in ("name", "order"):
        raise InvalidArgument(f"match: expected name or order, got {match}")
    several = len(given) > 1
    native = _paracal.read_measurements(
        [
            _tables.native(one, f"table {k + 1}" if several else "table")
            for k, one in enumerate(given)
        ],
        [_tables.native(one, "poses") for one in _list(poses)],
        _paracal.export_statement(columns or "", unit or "", match == "order"),
        _paracal.table_style(decimal_comma, list(ignore_columns)),
        None if robot is None else native_robot(robot),
    )
    return Measurements(native, robot)


def merge(parts: Iterable[Measurements]) -> Measurements:
    """Joins several measurements, each series in its own frame. The first home stays first.

    Readings that repeat an earlier series exactly are used once, with a note. Raises
    InvalidArgument if there are none.
    """
    all_parts = list(parts)
    native = _paracal.merge([native_measurements(part) for part in all_parts])
    robots = [part._robot for part in all_parts if part._robot is not None]
    return Measurements(native, robots[0] if robots else None)


def read_poses(
    table: Table,
    robot: Robot | None = None,
    decimal_comma: bool = False,
    ignore_columns: Sequence[str] = (),
) -> tuple[list[str], FloatArray]:
    """Names and poses (n, 4) of a pose table (x_mm, y_mm, z_mm, phi_deg; or commanded poses), in mm
    and rad. With commanded tilt (tilt_x_deg, tilt_y_deg, tilt_z_deg): (n, 6).

    robot: robot of the poses; default: that of a line "# robot: NAME". Without both, a tilted pose
        means six degrees of freedom.
    decimal_comma, ignore_columns: as in read_measurements().
    Raises InputFileError, or InvalidArgument for a pose that does not suit the robot.
    """
    return _paracal.read_poses(
        _tables.native(table, "poses"),
        _paracal.table_style(decimal_comma, list(ignore_columns)),
        None if robot is None else native_robot(robot),
    )


def read_joints(
    table: Table,
    robot: Robot,
    decimal_comma: bool = False,
    ignore_columns: Sequence[str] = (),
) -> tuple[list[str], FloatArray]:
    """Names and joint coordinates (n, limbs) of a joint table (q1_deg, ...; q1_mm for rails and
    struts), in rad or mm.

    decimal_comma, ignore_columns: as in read_measurements().
    Raises InputFileError."""
    style = _paracal.table_style(decimal_comma, list(ignore_columns))
    return _paracal.read_joints(_tables.native(table, "joints"), style, native_robot(robot))
