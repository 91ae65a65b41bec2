"""Check of a calibration at poses that it has not used."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Iterable, Union

from . import _html, _paracal, _tables
from ._keywords import keywords
from .calibration import Calibration
from .errors import InvalidArgument
from .known import KnownMachine
from .measurements import Measurements, native_measurements

if TYPE_CHECKING:
    import pandas


class Validation:
    """Errors before and after calibration, as from `paracal validate --json`: mm and deg, units in
    the keys. validate() returns it."""

    def __init__(self, text: str) -> None:
        self._found: dict[str, Any] = json.loads(text)

    @property
    def accepted(self) -> bool | None:
        """True: all limits are kept, also with the uncertainty. None: no limit is set."""
        accepted: bool | None = self._found["accepted"]
        return accepted

    @property
    def reasons(self) -> list[str]:
        """Why the validation was not accepted. Without a limit: what speaks against the calibration."""
        return list(self._found["reasons"])

    @property
    def notes(self) -> list[str]:
        """Notes on the result."""
        return list(self._found["notes"])

    @property
    def before(self) -> dict[str, Any]:
        """Largest errors of the nominal machine: max_abs_distance_mm, max_volumetric_aligned_mm,
        ..."""
        return dict(self._found["before"])

    @property
    def after(self) -> dict[str, Any]:
        """Largest errors of the calibrated machine, same keys."""
        return dict(self._found["after"])

    @property
    def checks(self) -> list[dict[str, Any]]:
        """Each limit: quantity, error, U, at_least, limit, conformity  [iso14253-1]."""
        return list(self._found["checks"])

    @property
    def iso9283(self) -> dict[str, Any]:
        """AP, RP, AD, RD of poses measured at least twice, and the largest of each, mm."""
        return dict(self._found["iso9283"])

    @property
    def agreement(self) -> dict[str, Any] | None:
        """Whether the readings agree with the uncertainty of the calibration; None if this cannot
        be tested."""
        found: dict[str, Any] | None = self._found["agreement"]
        return found

    def as_dict(self) -> dict[str, Any]:
        """The result as a dict; docs/json-keys.md lists the keys."""
        copy: dict[str, Any] = json.loads(json.dumps(self._found))
        return copy

    def to_frame(self) -> pandas.DataFrame:
        """Errors, one row per pose (mm and deg): before_d_rho_mm, after_d_rho_mm, ...; for distances
        and lengths one row per reading."""
        rows = [self._flat(row) for row in self._found["poses"] or self._found["readings"]]
        return _tables.frame(
            {key: [row.get(key) for row in rows] for key in (rows[0] if rows else [])}
        )

    @staticmethod
    def _flat(row: dict[str, Any]) -> dict[str, Any]:
        flat: dict[str, Any] = {}
        for key, value in row.items():
            if isinstance(value, dict):
                flat.update({f"{key}_{name}": one for name, one in value.items()})
            else:
                flat[key] = value
        return flat

    def __repr__(self) -> str:
        return f"<paracal.Validation: {self._verdict()}>"

    def _verdict(self) -> str:
        if self.accepted is None:
            return "no limit is set"
        return "accepted" if self.accepted else "not accepted"

    def _repr_html_(self) -> str:
        rows = [[key, value, self.after.get(key)] for key, value in self.before.items()]
        checks = [
            [one[key] for key in ("quantity", "error", "U", "at_least", "limit", "conformity")]
            for one in self.checks
        ]
        return "".join(
            [
                _html.heading(f"validation: {self._verdict()}"),
                _html.items("against it" if self.accepted is None else "because", self.reasons),
                _html.items("note", self.notes),
                _html.table(["largest error", "before", "after"], rows),
                _html.table(["quantity", "error", "U", "at least", "limit", ""], checks)
                if checks
                else "",
            ]
        )


def validate(
    machine: Union[Calibration, KnownMachine],
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
    sigma_known: bool = False,
) -> Validation:
    """Checks a calibration with measurements that it has not used.

    "Before" compares measured with commanded poses, "after" with the poses that the calibrated
    machine predicts from the joints; both relative to home.
    machine: a Calibration, or the result of read_calibration().

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
        sigma_known: the given standard deviations are known, as the program takes them if they are
            given.

    Raises InvalidArgument for invalid or too few measurements, Unreachable as calibrate(). Without
    a limit there is no verdict. Measurements that the calibration has used stand in `reasons`.
    """
    given = {
        key: value for key, value in locals().items() if key not in ("machine", "measurements")
    }
    native = native_known(machine)
    return Validation(
        _paracal.validate(
            native, native_measurements(measurements), keywords(given, machine.robot)
        )
    )


def native_known(machine: Union[Calibration, KnownMachine]) -> _paracal.KnownMachine:
    """The compiled object for validation and compensation."""
    if isinstance(machine, Calibration):
        return machine.known._native
    if isinstance(machine, KnownMachine):
        return machine._native
    raise InvalidArgument(
        f"machine: expected a Calibration or KnownMachine, got {type(machine).__name__}"
    )
