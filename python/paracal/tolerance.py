"""Tolerance design: the effect of given tolerances, and the widest tolerances that keep limits.

Tolerances are half-widths, T = 3 sigma, one per geometric error, equal for all limbs; mm and rad.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Mapping

import numpy as np
import numpy.typing as npt

from . import _html, _paracal, _tables
from ._arrays import FloatArray
from .errors import InvalidArgument
from .plans import named_poses
from .robots import Robot, native_robot
from .tolerances import Tolerances, native_tolerances

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True)
class Analysis:
    """Effect of tolerances on the requirements; mm and rad."""

    robot: Robot
    machines: int  #: simulated machines
    converged: bool  #: every sigma has the accuracy sigma_error
    not_closed: int  #: machines that cannot reach every pose (exact model); they fail
    passed: int  #: machines that keep all limits
    confidence: float  #: confidence level of the intervals
    yield_: float  #: fraction of the machines that keep all limits
    yield_interval: tuple[float, float]
    dpmo: float  #: defects per million machines
    #: Failure rate, even if very low: status ("settled", "impossible" or
    #: "unsettled"), reason, linear, check and exact (or None): value, low, high, machines, effective;
    #: not_closed.
    failure: dict[str, Any]
    #: One entry per requirement: quantity, unit, limit, worst_case, rss_3sigma, monte_carlo_3sigma
    #: (and their poses: *_pose), monte_carlo_3sigma_interval, cpk, passed, largest_on_a_machine,
    #: contributors [(name, contribution to variance)].
    requirements: list[dict[str, Any]]
    assumed: list[str]

    def to_frame(self) -> pandas.DataFrame:
        """One row per requirement: limit, worst_case, rss_3sigma, monte_carlo_3sigma, cpk; mm or
        rad, see unit."""
        keys = ("unit", "limit", "worst_case", "rss_3sigma", "monte_carlo_3sigma", "cpk")
        return _tables.frame(
            {key: [one[key] for one in self.requirements] for key in keys},
            [one["quantity"] for one in self.requirements],
        )

    def _repr_html_(self) -> str:
        keys = (
            "quantity",
            "unit",
            "limit",
            "worst_case",
            "rss_3sigma",
            "monte_carlo_3sigma",
            "cpk",
        )
        low, high = self.yield_interval
        return "".join(
            [
                _html.heading(
                    f"tolerances of {self.robot.name}: {self.machines} machines, "
                    f"yield {100 * self.yield_:.7g} % [{100 * low:.7g}, {100 * high:.7g}]"
                ),
                _html.table(keys, ([one[key] for key in keys] for one in self.requirements)),
                _html.table(
                    ["contribution to the variance of the first", "fraction"], self.requirements[0]["contributors"]
                ),
                _html.items("assumed", self.assumed),
            ]
        )


@dataclass(frozen=True)
class Allocation:
    """The widest tolerances that keep every requirement; mm and rad."""

    status: str  #: "optimal", "feasible", "infeasible" or "not converged"
    ok: bool  #: every limit is kept
    reason: str  #: reason if not optimal
    tolerances: Tolerances
    cost: float
    #: One entry per requirement: quantity, criterion, limit, worst (and worst_pose), price: cost
    #: saved per mm or rad of a wider limit.
    requirements: list[dict[str, Any]]

    def _repr_html_(self) -> str:
        keys = ("quantity", "criterion", "limit", "worst", "price")
        return (
            _html.heading(f"allocation: {self.status}, cost {self.cost:.6g}")
            + _html.items("because", [self.reason] if self.reason else [])
            + _html.table(keys, ([one[key] for key in keys] for one in self.requirements))
            + self.tolerances._repr_html_()
        )


@dataclass(frozen=True)
class Sensitivity:
    """Effect of each geometric error (of all limbs) on a quantity, over the workspace."""

    quantity: str
    unit: str  #: unit of the quantity, "mm" or "rad"
    mean: dict[str, float]  #: mean over the workspace, unit per mm, rad or mm/m of the error
    error: dict[str, float]  #: error of the quadrature
    largest: dict[str, float]
    in_paper_units: dict[
        str, float
    ]  #: mean; rod and width differences divided by the parallelogram width  [huang2016]
    poses: int  #: number of poses of the quadrature
    worst_3sigma: float  #: largest 3 sigma with the tolerances
    worst_pose: FloatArray  #: its pose: (4), or (6) with commanded tilt; mm, rad
    contributors: list[tuple[str, float]]  #: contributions to the variance there, largest first

    def to_frame(self) -> pandas.DataFrame:
        """One row per geometric error: mean, error, largest."""
        columns = {"mean": self.mean, "error": self.error, "largest": self.largest}
        return _tables.frame(
            {key: list(of.values()) for key, of in columns.items()}, list(self.mean)
        )

    def _repr_html_(self) -> str:
        rows = [
            [name, self.mean[name], self.largest[name]]
            for name in self.mean
            if self.largest[name] != 0.0
        ]
        return (
            _html.heading(f"sensitivity of {self.quantity}, {self.unit} per unit of the error")
            + _html.table(["geometric error", "mean", "largest"], rows)
            + _html.table(["contribution to the variance", "fraction"], self.contributors)
        )


def analyze(
    robot: Robot,
    tolerances: Tolerances | None = None,
    requirements: Mapping[str, float] | None = None,
    *,
    problem: str | os.PathLike[str] | None = None,
    poses: npt.ArrayLike | None = None,
    model: str = "linear",
    seed: int = 1,
    sigma_error: float = 0.01,
    failure_error: float = 0.05,
    confidence: float = 0.95,
    max_machines: int = 1_000_000,
    threads: int = 0,
) -> Analysis:
    """Yield, worst case, root sum of squares, Monte Carlo, and contributions to the variance.

    tolerances: default: the robot's tolerances.
    requirements: limits (mm or rad) by quantity: "tilt", "twist", "position", "distance",
        "rotation"; on level plates each also with "-compensated" appended; default:
        {"tilt": 1e-3}.
    problem: a TOML file with the requirements, instead of requirements.
    poses: (n, 4), or (n, 6) with commanded tilt, in mm and rad: poses where the limits apply, in
        addition to the worst pose of each requirement; default: poses on the surface of the
        workspace where a limit may be exceeded, as in `paracal tolerance analyze`.
    model: model of the Monte Carlo simulation: "linear" or "exact".
    sigma_error: relative error of every sigma at `confidence`. max_machines limits the number of
        simulated machines. failure_error: relative error of the failure rate.
    threads: 0: all; the results do not depend on it.
    Raises InvalidArgument for invalid arguments.
    """
    native = native_tolerances(tolerances, robot)
    if requirements is not None and problem is not None:
        raise InvalidArgument("requirements, problem: expected one of them, got both")
    wanted = list((requirements if requirements is not None else {"tilt": 1e-3}).items())
    if problem is not None:
        wanted = _paracal.problem_requirements(
            native_robot(robot), native, _tables.path_of(problem)
        )
    at = None if poses is None else named_poses(poses, robot)[1]
    found = _paracal.analyze(
        native_robot(robot),
        native,
        [(name, float(limit)) for name, limit in wanted],
        at,
        {
            "model": model,
            "seed": seed,
            "sigma_error": sigma_error,
            "failure_error": failure_error,
            "confidence": confidence,
            "max_machines": max_machines,
            "threads": threads,
        },
    )
    return Analysis(robot=robot, assumed=native.assumed, **found)


def allocate(
    robot: Robot,
    *,
    max_tilt_rad: float = 1e-3,
    bound: str = "sum-of-maxima",
    least_rad: float | None = None,
    least_is: str = "tolerance",
    problem: str | os.PathLike[str] | None = None,
    rest: Tolerances | None = None,
) -> Allocation:
    """The widest tolerances that keep a limit on the plate's tilt  [huang2016, Eqs. (12), (13)], or
    any limits.

    max_tilt_rad: limit of 3 sigma of the tilt, rad. bound: "sum-of-maxima" reproduces Table 2;
        "true-maximum" gives tolerances about 10 % wider.
    least_rad: tightest tolerance that can be manufactured. least_is: whether least_rad limits
        "tolerance" (3 sigma) or "sigma".
    problem: a file with requirements, costs and bounds instead (TOML; docs/tolerance.md). Limbs
        with one rod need it.
    rest: tolerances of the other geometric errors; default: the robot's tolerances.
    Raises InvalidArgument, or InputFileError for the file.
    """
    native = native_tolerances(rest, robot, "rest")
    if problem is not None:
        found = _paracal.allocate(native_robot(robot), native, _tables.path_of(problem))
    else:
        found = _paracal.equal_influence(
            native_robot(robot),
            native,
            {
                "max_tilt_rad": max_tilt_rad,
                "bound": bound,
                "least_rad": least_rad,
                "least_is": least_is,
            },
        )
    found["tolerances"] = Tolerances(found["tolerances"], robot)
    return Allocation(**found)


def sensitivity(
    robot: Robot,
    quantity: str = "tilt",
    tolerances: Tolerances | None = None,
    all_rotations: bool = False,
    relative_error: float = 1e-3,
) -> Sensitivity:
    """Mean local sensitivities over the workspace  [huang2016, Eq. (11)], by quadrature to
    `relative_error`.

    quantity: as in analyze(). tolerances: for worst_3sigma and contributors; default: the robot's
        tolerances.
    all_rotations: True: mean also over phi; False: phi = 0, as in the paper.
    Raises InvalidArgument for an unknown quantity.
    """
    native = native_tolerances(tolerances, robot)
    found = _paracal.sensitivity(
        native_robot(robot), native, quantity, all_rotations, relative_error
    )
    units = found.pop("paper_units")
    in_paper_units = dict(zip(robot.sources, (found["mean"] * np.asarray(units)).tolist()))
    for key in ("mean", "error", "largest"):
        found[key] = dict(zip(robot.sources, found[key].tolist()))
    return Sensitivity(quantity=quantity, in_paper_units=in_paper_units, **found)
