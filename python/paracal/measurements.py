"""Measurements, poses and joints: from files, DataFrames and dicts of columns, and back."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Iterable, Sequence

from . import _html, _paracal, _tables
from ._arrays import FloatArray
from ._tables import Table
from .errors import InvalidArgument
from .robots import Robot, native_robot

if TYPE_CHECKING:
    import pandas


class Measurements:
    """What was read of a machine: points, distances, heights, ball bar lengths, dial readings, any
    mix. Made by read_measurements() and simulate()."""

    def __init__(self, native: _paracal.Measurements, robot: Robot | None = None) -> None:
        self._native = native
        self._robot = robot

    @property
    def poses(self) -> FloatArray:
        """(n, 4) commanded poses of the stations: x, y, z in mm, phi in rad; (n, 6) of x, y, z,
        tilt_x, tilt_y, tilt_z of a robot with six freedoms, and where tilts are commanded of one
        that nobody said. The first is home."""
        return self._stations[1]

    @property
    def names(self) -> list[str]:
        """Names of the stations."""
        return self._stations[0]

    @property
    def _stations(self) -> tuple[list[str], FloatArray]:
        return self._native.stations(None if self._robot is None else self._robot._native)

    @property
    def counts(self) -> dict[str, int]:
        """How many readings there are of each kind that was read."""
        return self._native.counts

    @property
    def notes(self) -> list[str]:
        """What had to be passed over: blank, missing or doubled readings."""
        return self._native.notes

    @property
    def robot(self) -> Robot | None:
        """The robot that the tables say they are of ("# robot: NAME"), or that they were read
        for."""
        return Robot(self._native.robot) if self._native.robot else self._robot

    def to_csv(self, robot: Robot | None = None) -> dict[str, str]:
        """The tables as files hold them (mm and deg), by their names; each is read again as it was.
        A name that comes again gets a number: "points", "points 2".

        robot: needed where neither the tables nor read_measurements() said which.
        Raises InvalidArgument for a robot that nobody said, or names that would not be read back.
        """
        tables: dict[str, str] = {}
        for _, name, text in self._tables(robot):
            numbered = (f"{name} {k}" for k in itertools.count(2))
            tables[next(one for one in itertools.chain([name], numbered) if one not in tables)] = text
        return tables

    def to_frame(self, kind: str | None = None, robot: Robot | None = None) -> pandas.DataFrame:
        """Readings of a kind ("points", "distances", "heights", "ball bar lengths", ... as in
        counts) or "poses" as a DataFrame, with columns as files have them (mm and deg), and
        `series` where there are several.

        kind: default: what was read first. read_measurements() takes the DataFrame again.
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
        """The lengths that instrument and machine would have shown at 20 deg C  [iso1].

        temperature_c: of the machine while it was measured, deg C.
        expansion_ppm: of the machine per K: steel 11.5, aluminium 23, carbon 0.
        instrument_expansion_ppm: of the instrument per K; 0: it corrects itself.
        """
        expansion = 1e-6 * (expansion_ppm - instrument_expansion_ppm) * (temperature_c - 20.0)
        return Measurements(self._native.at_reference_temperature(expansion), self._robot)

    def _tables(self, robot: Robot | None) -> list[tuple[str, str, str]]:
        of = robot or self.robot
        if of is None:
            raise InvalidArgument(
                "robot: expected one, for the tables do not say which robot they are of"
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
    """What the library takes; says what came where those are none."""
    if isinstance(of, Measurements):
        return of._native
    raise InvalidArgument(
        "measurements: expected Measurements, as read_measurements() gives them, "
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

    Each is what its columns say: points (pose, x_cmd_mm, ..., x_mm, y_mm, z_mm; of a body with qw,
    qx, qy, qz), distances (from, to, distance_mm), heights (pose, height_mm), ball bars (pose, ball_bar_mm), dials (pose,
    dial_mm, direction_x, ...); docs/files.md has all columns. Units are in the columns' names, so
    angles are in deg. Blank cells, None and NaN are what was not read. Several tables enter one
    fit, each in its own frame.

    poses: the table that distances, lengths and exports name poses of; one for all, or one for
        each.
    robot: what they are of; a line "# robot: NAME" of a file that says another is refused.
    columns, unit: read an instrument's text export, where its header row does not say enough:
        numbers or headings, columns="name=3,x=4,y=5,z=6" or "name=Target,x=Measured X,...", or
        "spatialanalyzer"; unit="mm", "m", "um" or "inch".
    match: how points of an export find their poses: by "name", or in their "order".
    decimal_comma: 1,5 is a number; without it a table must show that it has decimal commas.
    ignore_columns: headings of columns that are passed over; any other that nobody knows is
        refused.
    Raises InputFileError (with file and line) for a table that cannot be read, InvalidArgument for
    an export that is not as stated, or poses that are missing.
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
        _paracal.ExportStatement(columns or "", unit or "", match == "order"),
        _paracal.TableStyle(decimal_comma, list(ignore_columns)),
        None if robot is None else native_robot(robot),
    )
    return Measurements(native, robot)


def merge(parts: Iterable[Measurements]) -> Measurements:
    """Several measurements as one, each series in its own frame; the first home stays first.

    Readings that stand in an earlier series too, number by number, are counted once, with a note.
    Raises InvalidArgument for none.
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
    """Names and (n, 4) poses of a pose table (x_mm, y_mm, z_mm, phi_deg; or commanded ones), in mm
    and rad; (n, 6) with tilt_x_deg, tilt_y_deg, tilt_z_deg of a robot with six freedoms.

    robot: what they are of; default: what a line "# robot: NAME" says, else one with six freedoms
        where some pose is tilted.
    decimal_comma, ignore_columns: as of read_measurements().
    Raises InputFileError, InvalidArgument for a pose that such a robot does not take.
    """
    return _paracal.read_poses(
        _tables.native(table, "poses"),
        _paracal.TableStyle(decimal_comma, list(ignore_columns)),
        None if robot is None else native_robot(robot),
    )


def read_joints(
    table: Table,
    robot: Robot,
    decimal_comma: bool = False,
    ignore_columns: Sequence[str] = (),
) -> tuple[list[str], FloatArray]:
    """Names and (n, limbs) joint coordinates of a joint table (q1_deg, ...; q1_mm of rails and
    struts), in rad or mm.

    decimal_comma, ignore_columns: as of read_measurements().
    Raises InputFileError."""
    style = _paracal.TableStyle(decimal_comma, list(ignore_columns))
    return _paracal.read_joints(_tables.native(table, "joints"), style, native_robot(robot))
