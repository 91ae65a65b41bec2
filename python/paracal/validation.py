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
    def accepted(self) -> bool:
        """True: all limits are kept, also with the uncertainty. Without limits: the errors are
        smaller than before by more than their uncertainty."""
        return bool(self._found["accepted"])

    @property
    def reasons(self) -> list[str]:
        """Why the validation was not accepted."""
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
        return f"<paracal.Validation: {'accepted' if self.accepted else 'not accepted'}>"

    def _repr_html_(self) -> str:
        verdict = "accepted" if self.accepted else "not accepted"
        rows = [[key, value, self.after.get(key)] for key, value in self.before.items()]
        checks = [
            [one[key] for key in ("quantity", "error", "U", "at_least", "limit", "conformity")]
            for one in self.checks
        ]
        return "".join(
            [
                _html.heading(f"validation: {verdict}"),
                _html.items("because", self.reasons),
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
    sigma_rad: float | None = None,
    sigma_known: bool = False,
    tracker_um: Iterable[float] | None = None,
    scale_ppm: float = 15.0,
    frame: str = "unknown",
    body: str = "unknown",
    rotation: str = "relative",
    reflectors: str = "plate",
    limit_mm: float | None = None,
    limit_aligned_mm: float | None = None,
    limit_rad: float | None = None,
) -> Validation:
    """Checks a calibration with measurements that it has not used.

    "Before" compares measured with commanded poses, "after" with the poses that the calibrated
    machine predicts from the joints; both relative to home.
    machine: a Calibration, or the result of read_calibration().
    sigma_known: True: use the given sigmas as they are, as the program does with given sigmas.
    limit_mm, limit_aligned_mm, limit_rad: limits of distances to home, positions after alignment,
        and rotations.
    The other keywords are as in calibrate().
    Raises InvalidArgument for invalid or too few measurements, Unreachable as calibrate(). With
    measurements that the calibration has used, the validation is not accepted.
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
