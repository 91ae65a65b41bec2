"""Identification of source errors, and what is known of a machine after it."""

from __future__ import annotations

import json
import os
import time as clock
from typing import TYPE_CHECKING, Any, Iterable

import numpy as np

from . import _html, _paracal, _tables
from ._arrays import BoolArray, FloatArray, Numbers, of_result
from ._keywords import keywords
from .errors import InvalidArgument
from .known import KnownMachine, NullDirection, Prediction
from .measurements import Measurements, native_measurements
from .robots import Machine, Robot, native_robot, parameter_names

if TYPE_CHECKING:
    import pandas

    from .tolerances import Tolerances


class Calibration:
    """The identified geometric errors of a machine, with their uncertainty. calibrate() returns it.

    Arrays are in mm and rad, with one row or entry per parameter (names, units). as_dict() and
    to_json() are in mm and deg, as in the calibration file.
    """

    def __init__(self, native: _paracal.Calibration) -> None:
        self._native = native
        self.robot = Robot(native.robot)

    @property
    def verdict(self) -> str:
        """ "accepted", "rejected", "not identifiable" or "not converged"."""
        return self._native.verdict

    @property
    def accepted(self) -> bool:
        """True: the calibration may be used."""
        return self.verdict == "accepted"

    @property
    def reasons(self) -> list[str]:
        """Why the calibration was not accepted; empty if it was."""
        return self._native.reasons

    @property
    def notes(self) -> list[str]:
        """Notes on the result."""
        return self._native.notes

    @property
    def assumed(self) -> list[str]:
        """Assumptions without support by files or readings."""
        return self._native.assumed

    @property
    def names(self) -> list[str]:
        """Names of the parameters: "e_x.2" is e_x of limb 2."""
        return parameter_names(self._native.parameters)

    @property
    def units(self) -> list[str]:
        """Units of the parameters: "mm", "rad" or "mm/m"."""
        return [unit for _, _, unit in self._native.parameters]

    @property
    def values(self) -> FloatArray:
        """(n) identified errors, actual minus nominal, mm or rad."""
        return of_result(self._native.values)

    @property
    def std(self) -> FloatArray:
        """(n) standard deviations, mm or rad; NaN where not determined."""
        return of_result(self._native.std)

    @property
    def U(self) -> FloatArray:
        """(n) expanded uncertainties U = k std, about 95 %, mm or rad."""
        return of_result(self._native.k * self._native.std)

    @property
    def data_share(self) -> FloatArray:
        """(n) fraction of the information from the readings: 1 - std^2 / prior_std^2."""
        return of_result(self._native.data_share)

    @property
    def identified(self) -> BoolArray:
        """(n) True: at least half of the information is from the readings."""
        return of_result(np.asarray(self._native.identified, dtype=np.bool_))

    @property
    def held(self) -> BoolArray:
        """(n) True: fixed at nominal; its tolerance contributes to every uncertainty."""
        return of_result(np.asarray(self._native.held, dtype=np.bool_))

    @property
    def covariance(self) -> FloatArray:
        """(n, n) covariance of the parameters, mm and rad; (0, 0) if no std is available."""
        return of_result(self._native.covariance)

    @property
    def rank(self) -> int:
        """Number of parameter combinations that the readings determine: of the position group,
        and of the tilt group if tilt was measured."""
        return self._native.rank

    @property
    def null_space(self) -> list[NullDirection]:
        """Parameter combinations that the readings do not determine."""
        return [
            NullDirection(text, of_result(direction), gauge)
            for text, direction, gauge in self._native.null_space
        ]

    @property
    def noise_mm(self) -> float:
        """Standard deviation of a coordinate, or of a distance if no points were measured; stated
        or estimated, mm."""
        return self._native.noise_mm

    @property
    def degrees_of_freedom(self) -> int:
        """Number of readings minus number of unknowns."""
        return self._native.degrees_of_freedom

    @property
    def errors(self) -> FloatArray:
        """(limbs, sources) geometric errors of all limbs, in the units of robot.units; zero where
        not identified."""
        return of_result(self._native.errors)

    @property
    def machine(self) -> Machine:
        """The calibrated machine: inverse(calibration.machine, poses) compensates."""
        return Machine(self.robot, self.errors)

    @property
    def known(self) -> KnownMachine:
        """The part of the result that validate() and compensate() use."""
        return KnownMachine(self._native.known)

    def predict(self, joints: Numbers) -> Prediction:
        """As KnownMachine.predict()."""
        return self.known.predict(joints)

    def correlations(self, threshold: float = 0.9) -> list[tuple[str, str, float]]:
        """Pairs of parameters that the readings hardly separate, strongest first: |correlation|
        of at least `threshold`."""
        names = self.names
        return [
            (names[one], names[other], value)
            for one, other, value in self._native.correlations(threshold)
        ]

    def to_json(self, time: int | None = None) -> str:
        """The text of the calibration file, as from `paracal calibrate --out`, in mm and deg.
        docs/json-keys.md lists the keys.

        time: date of the file in seconds since 1970; default: SOURCE_DATE_EPOCH of the
            environment, else now.
        """
        return self._native.json(
            int(os.environ.get("SOURCE_DATE_EPOCH", clock.time())) if time is None else time
        )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes to_json() to a file for read_calibration() and the program. Raises Error if this
        fails; an existing file then stays unchanged."""
        _tables.write(path, self.to_json())

    def as_dict(self) -> dict[str, Any]:
        """to_json() as a dict, in mm and deg, with units in the keys. It also contains residuals,
        frames, possible outliers, stages and options."""
        found: dict[str, Any] = json.loads(self.to_json())
        return found

    def to_frame(self) -> pandas.DataFrame:
        """The parameters as a DataFrame: value, std, U (mm or rad, see unit), data_share,
        identified."""
        native = self._native.parameters
        return _tables.frame(
            {
                "source": [name for name, _, _ in native],
                "limb": [limb for _, limb, _ in native],
                "unit": self.units,
                "value": self.values,
                "std": self.std,
                "U": self.U,
                "data_share": self.data_share,
                "identified": self.identified,
            },
            self.names,
        )

    def residuals(self) -> pandas.DataFrame:
        """Measured minus predicted, before (nominal) and after (calibrated), one row per reading.

        Columns as in the calibration file, in mm and deg; for points before_x_mm ...
        after_z_mm in the robot's frame.
        """
        rows = [_flat(row) for row in self.as_dict()["residuals"]]
        keys = list(dict.fromkeys(key for row in rows for key in row))
        return _tables.frame({key: [row.get(key) for row in rows] for key in keys})

    def __str__(self) -> str:
        return self._native.brief()

    def __repr__(self) -> str:
        count = len(self.names)
        return f"<paracal.Calibration of {self.robot.name}: {self.verdict}, {count} parameters>"

    def _repr_html_(self) -> str:
        shown = [self._shown(k) for k in np.flatnonzero(~self.held)]
        return "".join(
            [
                _html.heading(f"calibration of {self.robot.name}: {self.verdict}"),
                _html.items("because", self.reasons),
                _html.items("note", self.notes),
                _html.table(["limb", "error", "value", "U (95 %)", "unit", "from readings"], shown),
                _html.items("assumed", self.assumed),
            ]
        )

    def _shown(self, k: int) -> list[Any]:
        name, limb, unit = self._native.parameters[k]
        factor = 180.0 / np.pi if unit == "rad" else 1.0
        return [
            limb,
            name,
            float(factor * self.values[k]),
            float(factor * self.U[k]),
            "deg" if unit == "rad" else unit,
            f"{100.0 * self.data_share[k]:.0f} %",
        ]


def _flat(row: dict[str, Any]) -> dict[str, Any]:
    """Splits vectors (before_mm: [x, y, z]) into columns (before_x_mm, ...)."""
    flat: dict[str, Any] = {}
    for key, value in row.items():
        if isinstance(value, list):
            stem, unit = key.rsplit("_", 1)
            flat.update({f"{stem}_{axis}_{unit}": one for axis, one in zip("xyz", value)})
        else:
            flat[key] = value
    return flat


def calibrate(
    robot: Robot,
    measurements: Measurements,
    *,
    sigma_mm: float | None = None,
    height_sigma_mm: float | None = None,
    dial_angle_rad: float | None = None,
    sigma_rad: float | None = None,
    tracker_um: Iterable[float] | None = None,
    distance_bias_mm: float = 0,
    scale_ppm: float = 15,
    rotation: str = "relative",
    reflectors: str = "plate",
    frame: str = "unknown",
    body: str = "unknown",
    limit_mm: float | None = None,
    limit_aligned_mm: float | None = None,
    limit_rad: float | None = None,
    joint_sigma: float = 0,
    stage: str = "auto",
    method: str = "best",
    tolerances: Tolerances | None = None,
    fixed: Iterable[str] = (),
    free: Iterable[str] = (),
    sigma_known: bool = False,
    keep_outliers: bool = False,
    outlier_chance: float = 0.0001,
) -> Calibration:
    """Identifies the geometric errors of a machine from readings of one or several kinds. Releases
    the interpreter lock.

    The calibration is accepted only if U over the workspace is below the limits.

    Keywords:
        sigma_mm: standard deviation of coordinates, distances and lengths without a stated sigma
            (default: points 0.017, bodies 0.3, others 0.05).
        height_sigma_mm: standard deviation of heights and dial readings without a stated sigma
            (default: 0.05).
        dial_angle_rad: standard deviation of the direction of a dial gauge (default: 0.5 deg,
            assumed).
        sigma_rad: standard deviation of rotations and orientations without a stated sigma (default:
            0.3 deg).
        tracker_um: laser tracker at the origin of its frame, instead of a sigma of points: standard
            deviation transverse and radial, each constant and per m, such as 15,6,10,0.3.
        distance_bias_mm: standard deviation of an error that all distances or all ball bar lengths
            share, such as a zero error; 0: none.
        scale_ppm: standard deviation of the scale of the readings relative to the machine (1 K of
            steel: 11.5).
        rotation: "relative" or "absolute": zero of the measured rotations: unknown and fitted
            (relative), or the robot's (absolute).
        reflectors: "plate", "end-effector" or "end-effector-reversed": where the second reflector
            or the measured body is mounted; reversed: it turns by -phi.
        frame: "unknown" or "robot": frame of the measured points: the robot's, or unknown and
            fitted.
        body: "unknown" or "plate": mounting of the measured body: in the plate's frame, or unknown
            and fitted.
        limit_mm: largest allowed distance error.
        limit_aligned_mm: largest allowed position error after the best alignment of both frames.
        limit_rad: largest allowed rotation error.
        joint_sigma: standard deviation of each joint of the readings, in their unit, of a robot
            with more limbs than degrees of freedom: its joints are readings, too; 0: they only say
            where the plate is.
        stage: "rough", "fine" or "auto": rough: encoder offsets only; fine: all errors; auto: as
            much as the measurements support.
        method: "paper" or "best": best: exact model with priors and full covariance; paper: Eqs. 19
            and 21 of Huang et al. (2016).
        tolerances: tolerances used as priors (default: the robot's).
        fixed: errors fixed at zero, of one limb or of all, such as alpha0,e_x2.
        free: errors estimated without a prior.
        sigma_known: the standard deviations of readings are known: do not correct them by the
            residuals.
        keep_outliers: report outliers, but do not exclude them.
        outlier_chance: p-value below which the worst reading is an outlier; 0: none is.

    Raises InvalidArgument for invalid options or readings, Unreachable for a pose out of reach,
    and InputFileError for measurements of another robot. A doubtful fit raises nothing: see
    verdict.
    """
    given = {key: value for key, value in locals().items() if key not in ("robot", "measurements")}
    return Calibration(
        _paracal.calibrate(
            native_robot(robot), native_measurements(measurements), keywords(given, robot)
        )
    )
