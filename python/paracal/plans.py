"""Before measuring: choose poses, predict what they determine, simulate measurements."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Iterable, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _html, _paracal, _tables
from ._arrays import FloatArray, as_doubles, as_poses, column_names
from ._keywords import keywords
from ._tables import Table
from .errors import InvalidArgument
from .known import NullDirection
from .measurements import Measurements, read_poses
from .robots import Machine, Robot, native_robot, parameter_names

if TYPE_CHECKING:
    import os

    import pandas

    from .tolerances import Tolerances

#: 270 deg: the azimuth of the first point on each circle that reproduces [huang2016, Table 3].
START_AZIMUTH_RAD = 270.0 * (np.pi / 180.0)


@dataclass(frozen=True)
class Plan:
    """Poses to measure."""

    robot: Robot
    names: list[str]  #: names of the poses
    poses: FloatArray  #: (n, 4) or (n, 6), mm and rad, columns as robot.pose_axes; home first
    curve: list[dict[str, Any]]  #: results for other numbers of poses
    details: dict[str, Any]  #: details of the search

    def __len__(self) -> int:
        return len(self.names)

    def to_frame(self) -> pandas.DataFrame:
        """The poses as a table of commanded poses, with columns as in files (mm and deg)."""
        return _tables.frame(self._columns())

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes the poses to a file for read_poses() and the program. Raises Error if this fails;
        an existing file then stays unchanged."""
        of = f"# robot: {self.robot.name}\n" if self.robot.name in _paracal.catalogue() else ""
        _tables.write(path, of + _tables.text_of(self._columns()))

    def _columns(self) -> dict[str, Any]:
        return {"pose": self.names, **{f"{axis}_cmd_{unit}": of for axis, unit, of in self._axes()}}

    def _axes(self) -> list[tuple[str, str, FloatArray]]:
        """Name, unit in files, and values of each pose coordinate."""
        places = [(axis, "mm", self.poses[:, k]) for k, axis in enumerate("xyz")]
        angles = enumerate(self.robot.pose_axes[3:], start=3)
        return places + [(axis, "deg", self.poses[:, k] * (180.0 / np.pi)) for k, axis in angles]

    def _repr_html_(self) -> str:
        axes = self._axes()
        rows = zip(self.names, *(map(float, of) for _, _, of in axes))
        return _html.heading(f"{len(self)} poses for {self.robot.name}") + _html.table(
            ["pose", *(f"{axis}, {unit}" for axis, unit, _ in axes)], rows
        )


@dataclass(frozen=True)
class Identifiability:
    """Which geometric errors the readings of a plan determine, and how accurately."""

    names: list[str]  #: names of the parameters: "e_x.2" is e_x of limb 2
    units: list[str]  #: "mm", "rad" or "mm/m"
    rank: int  #: number of parameter combinations that the readings determine
    rows: int  #: number of readings
    prior_std: FloatArray  #: (n) standard deviations before measuring, from the tolerances, mm or rad
    std: FloatArray  #: (n) standard deviations after measuring, mm or rad
    null_space: list[NullDirection]  #: combinations that the readings do not determine
    singular_values: FloatArray  #: of the Jacobian, columns scaled to mm  [huang2016, Eq. (4)]
    indices: dict[str, float]  #: observability O1 ... O5  [sun-hollerbach2008]
    workspace_std: dict[str, float]  #: standard deviations over the workspace, units as in the keys

    def to_frame(self) -> pandas.DataFrame:
        """One row per parameter: prior_std and std, mm or rad."""
        return _tables.frame(
            {"unit": self.units, "prior_std": self.prior_std, "std": self.std}, self.names
        )

    def _repr_html_(self) -> str:
        text = f"{self.rank} of {len(self.names)} parameters are determined by {self.rows} readings"
        rows = zip(self.names, map(float, self.prior_std), map(float, self.std), self.units)
        return "".join(
            [
                _html.heading(text),
                _html.items("not determined by these measurements", [one.text for one in self.null_space]),
                _html.table(["parameter", "std before", "std after", "unit"], rows),
                _html.pairs(self.workspace_std),
            ]
        )


def paper_plan(
    robot: Robot,
    stage: str = "fine",
    start_azimuth_rad: float = START_AZIMUTH_RAD,
    threshold: float = 0.01,
) -> Plan:
    """The pose scheme of [huang2016, section 4.2]. Its number of points per circle is the first at
    which O2 converges.

    stage: "rough": a circle in the middle layer, for the encoder offsets; "fine": circles in the
        top and bottom layers.
    threshold: O2 has converged if its relative change is below this.
    details: {"n": points per circle; 0: no convergence}; curve: n, O1 ... O5, change.
    Raises InvalidArgument for robots whose plate can tilt.
    """
    if stage not in ("rough", "fine"):
        raise InvalidArgument(f"stage: expected rough or fine, got {stage}")
    found = _paracal.paper_plan(native_robot(robot), stage, start_azimuth_rad, threshold)
    names, poses = found["poses"]
    return Plan(robot, names, poses, found["curve"], {"n": found["n"]})


def select_poses(
    robot: Robot,
    poses: int = 20,
    *,
    criterion: str = "pose",
    candidates: int = 10000,
    seed: int = 1,
    measure: str = "coordinates",
    at: Sequence[float] | None = None,
    read_rotation: bool = False,
    second: bool = False,
    reflectors: str = "plate",
    sigma_mm: float | None = None,
    height_sigma_mm: float | None = None,
    sigma_rad: float | None = None,
    tracker_um: Iterable[float] | None = None,
    tolerances: Tolerances | None = None,
) -> Plan:
    """The best poses, including home, chosen by exchange (Fedorov 1972) and ordered along a short
    path.

    criterion: quantity to minimise: "pose" (mean variance of position and rotation over the
        workspace), "D" or "O1" (volume), "A" (mean variance of the errors), "O3" (worst direction).
    measure: "coordinates", "pose" (of a body: motion capture), "home-distance", "height",
        "ball-bar" or "dial". at: x, y, z in mm of the known point of its setup.
    read_rotation, second: phi, or a second reflector, is also measured. reflectors: what carries
        the reflector or the body, as in calibrate().
    Keywords for noise are as in calibrate(). Raises InvalidArgument for options that exclude each
    other.
    details: value of the criterion, sweeps, exchanges, travel (rad; mm for rails and struts),
        workspace_std. curve: results with 2, 3, ... poses.
    The result equals that of `paracal poses --optimal`.
    """
    if not 2 <= poses <= candidates:
        raise InvalidArgument(f"poses: expected 2 to the {candidates} candidates, got {poses}")
    given = {
        key: value
        for key, value in locals().items()
        if key not in ("robot", "poses", "candidates", "seed")
    }
    found = _paracal.select_poses(
        native_robot(robot), poses, candidates, seed, keywords(given, robot)
    )
    names, chosen = found.pop("poses")
    return Plan(robot, names, chosen, found.pop("curve"), found)


def identifiability(
    robot: Robot,
    poses: Union[Plan, Table, npt.ArrayLike],
    *,
    measure: str = "coordinates",
    at: Sequence[float] | None = None,
    read_rotation: bool = False,
    second: bool = False,
    reflectors: str = "plate",
    frame: str = "unknown",
    body: str = "unknown",
    rotation: str = "relative",
    sigma_mm: float | None = None,
    height_sigma_mm: float | None = None,
    sigma_rad: float | None = None,
    tracker_um: Iterable[float] | None = None,
    tolerances: Tolerances | None = None,
) -> Identifiability:
    """Predicts which geometric errors readings at these poses determine.

    poses: a Plan, a pose table, or an array (n, 4), with commanded tilt (n, 6), in mm and rad; the
        first is home.
    measure: "coordinates", "pose", "distance" (all pairs), "home-distance", "height", "ball-bar",
        "dial". frame, body and rotation are known if "robot", "plate" and "absolute". Other
        keywords are as in select_poses() and calibrate().
    Raises InvalidArgument for options that exclude each other, Unreachable for a pose out of reach.
    """
    if rotation == "absolute" and measure in ("distance", "home-distance"):
        raise InvalidArgument(
            "rotation: expected relative with distances, got absolute"
        )
    names, rows = named_poses(poses, robot)
    given = {
        key: value
        for key, value in locals().items()
        if key not in ("robot", "poses", "names", "rows")
    }
    found = _paracal.identifiability(native_robot(robot), names, rows, keywords(given, robot))
    parameters = found["parameters"]
    return Identifiability(
        names=parameter_names([one[:3] for one in parameters]),
        units=[one[2] for one in parameters],
        rank=found["rank"],
        rows=found["rows"],
        prior_std=np.array([one[3] for one in parameters]),
        std=np.array([one[4] for one in parameters]),
        null_space=[NullDirection(*one) for one in found["null_space"]],
        singular_values=found["singular_values"],
        indices=found["indices"],
        workspace_std=found["workspace_std"],
    )


def simulate(
    machine: Union[Robot, Machine],
    poses: Union[Plan, Table, npt.ArrayLike],
    *,
    measure: str = "coordinates",
    at: Sequence[float] | None = None,
    noise_mm: float = 0.0,
    repeatability_mm: float = 0.0,
    repeats: int = 1,
    read_rotation: bool = False,
    rotation_noise_rad: float = 0.0,
    second_mm: Sequence[float] | None = None,
    frame: npt.ArrayLike | None = None,
    body: npt.ArrayLike | None = None,
    reflectors: str = "plate",
    seed: int = 1,
    stream: int = 0,
) -> Measurements:
    """Simulated measurements of a machine whose controller uses the nominal robot.

    poses: as in identifiability(). measure, at: as in select_poses().
    noise_mm: standard deviation of a coordinate, distance or length. repeatability_mm: of the
        machine.
    repeats: visits per pose. read_rotation: an encoder reads phi with rotation_noise_rad.
    second_mm: x, y, z of a second reflector relative to the first. frame: (4, 4) homogeneous
        matrix, mm: instrument = frame @ robot; default: the robot's frame. body: likewise,
        plate = body @ body, if measure is "pose"; default: at the plate's centre. reflectors: what
        carries it, as in calibrate().
    seed, stream: of the random noise; the same values give the same numbers.
    Raises Unreachable if the machine cannot reach a pose, InvalidArgument for options that exclude
    each other.
    """
    built = machine if isinstance(machine, Machine) else Machine(machine)
    names, rows = named_poses(poses, built.robot)
    given = {
        "measure": measure,
        "at": at,
        "noise_mm": noise_mm,
        "repeatability_mm": repeatability_mm,
        "read_rotation": read_rotation,
        "rotation_noise_rad": rotation_noise_rad,
        "second_mm": second_mm,
        "frame": None if frame is None else as_doubles("frame", frame),
        "body": None if body is None else as_doubles("body", body),
        "reflectors": reflectors,
    }
    native = _paracal.simulate(
        built._native, names, rows, repeats, seed, stream, keywords(given, built.robot)
    )
    return Measurements(native, built.robot)


def validation_poses(robot: Robot) -> Plan:
    """Home and 120 poses on circles in three layers, at phi = 0  [huang2016, section 5.2.2]."""
    names, poses = _paracal.validation_poses(native_robot(robot))
    return Plan(robot, names, poses, [], {})


def workspace_poses(robot: Robot) -> Plan:
    """The positions of validation_poses() with, in turn, the smallest, zero and largest rotation.
    Plates with six degrees of freedom: level, and with all tilts."""
    names, poses = _paracal.workspace_poses(native_robot(robot))
    return Plan(robot, names, poses, [], {})


def named_poses(poses: Any, robot: Robot) -> tuple[list[str], FloatArray]:
    """Names and array (n, 4) or (n, 6) of a plan, a pose table or an array; poses of an array are
    named P0, P1, ..."""
    if isinstance(poses, Plan):
        return poses.names, np.ascontiguousarray(poses.poses)
    is_file = isinstance(poses, str) or hasattr(poses, "__fspath__")
    if is_file or column_names(poses) is not None:
        return read_poses(poses, robot)
    rows, lead = as_poses(poses, native_robot(robot))
    if len(lead) != 1 or lead[0] == 0:
        raise InvalidArgument(
            f"poses: expected an array of shape (n, {rows.shape[1]}), at least one pose, "
            f"got {np.shape(poses)}"
        )
    return [f"P{k}" for k in range(len(rows))], rows
