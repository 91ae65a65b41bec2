"""A calibration on poses that it has not seen."""

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
    """Errors before and after calibration; what `paracal validate --json` says, mm and deg, units
    in the keys. Made by validate()."""

    def __init__(self, text: str) -> None:
        self._found: dict[str, Any] = json.loads(text)

    @property
    def accepted(self) -> bool:
        """All limits kept for certain; without limits: smaller errors, by more than their
        uncertainty."""
        return bool(self._found["accepted"])

    @property
    def reasons(self) -> list[str]:
        """Why it was not accepted."""
        return list(self._found["reasons"])

    @property
    def notes(self) -> list[str]:
        """What a careful reader should know."""
        return list(self._found["notes"])

    @property
    def before(self) -> dict[str, Any]:
        """Largest errors of the nominal machine: max_abs_distance_mm, max_volumetric_aligned_mm,
        ..."""
        return dict(self._found["before"])

    @property
    def after(self) -> dict[str, Any]:
        """The same of the calibrated machine."""
        return dict(self._found["after"])

    @property
    def checks(self) -> list[dict[str, Any]]:
        """Each limit: quantity, error, U, at_least, limit, conformity  [iso14253-1]."""
        return list(self._found["checks"])

    @property
    def iso9283(self) -> dict[str, Any]:
        """AP, RP, AD, RD of poses that were read at least twice, and the largest of each, mm."""
        return dict(self._found["iso9283"])

    @property
    def agreement(self) -> dict[str, Any] | None:
        """Whether the readings lie where the calibration's own uncertainty says; None where nobody
        can tell."""
        found: dict[str, Any] | None = self._found["agreement"]
        return found

    def as_dict(self) -> dict[str, Any]:
        """All of it, keys in docs/json-keys.md."""
        copy: dict[str, Any] = json.loads(json.dumps(self._found))
        return copy

    def to_frame(self) -> pandas.DataFrame:
        """Errors pose by pose (mm and deg): before_d_rho_mm, after_d_rho_mm, ...; of distances and
        lengths a row a reading."""
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
    """Measures a calibration on poses that it has not seen, by whatever was read there.

    "Before" compares measured with commanded poses, "after" with those that the calibrated machine
    predicts from the joints, both relative to home.
    machine: a Calibration, or what read_calibration() knows.
    sigma_known: the sigmas that are given are facts, as the program takes them where it is given
        some.
    limit_mm, limit_aligned_mm, limit_rad: of distances to home, of positions after alignment, of
        rotations.
    The other keywords are those of calibrate().
    Raises InvalidArgument for measurements that make no sense or are too few, Unreachable as
    calibrate(). Tables that the calibration was made from confirm nothing: the validation is then
    not accepted.
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
    """What validation and compensation take."""
    if isinstance(machine, Calibration):
        return machine.known._native
    if isinstance(machine, KnownMachine):
        return machine._native
    raise InvalidArgument(
        f"machine: expected a Calibration or KnownMachine, got {type(machine).__name__}"
    )
