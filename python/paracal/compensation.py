"""Compensation: corrected joints and targets for a calibrated machine."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple, Union

import numpy as np

from . import _paracal
from ._arrays import BoolArray, CodeArray, FloatArray, Numbers, as_poses, of_result, shaped
from .calibration import Calibration
from .known import KnownMachine
from .robots import Machine
from .validation import native_known


class CompensationStatus(IntEnum):
    """Status of a pose."""

    ok = 0
    unreachable = 1  #: no solution: out of reach, or rotation of a rigid plate
    not_finite = 2  #: the pose contains NaN or infinity
    singular = (
        3  #: the machine is singular there, or no nominal target has these joints
    )


class Compensation(NamedTuple):
    """Corrected joints and targets for a controller; NaN where the status is not ok."""

    joints: FloatArray  #: (..., limbs) corrected joints, rad (mm for rails and struts)
    #: Corrected poses for a controller that uses the nominal robot: mm, rad
    targets: FloatArray
    remaining_tilt: FloatArray  #: (..., 2) about x and y, rad: tilt that joints cannot correct
    U: FloatArray  #: expanded uncertainty of the pose, mm and rad, about 95 %; NaN: no covariance
    status: CodeArray  #: (...), codes of CompensationStatus

    @property
    def ok(self) -> BoolArray:
        """(...) True: there is a solution."""
        return of_result(np.asarray(self.status == CompensationStatus.ok))


def compensate(
    machine: Union[Calibration, KnownMachine, Machine], poses: Numbers, way: str = "exact"
) -> Compensation:
    """Corrected joint coordinates and targets for poses.

    machine: a Calibration, the result of read_calibration(), or a Machine (without uncertainty).
    poses: the required poses: (..., 4) of x, y, z in mm, phi in rad; with commanded tilt (..., 6)
        of x, y, z in mm, tilt_x, tilt_y, tilt_z in rad; or (..., 3) with angles = 0; or a DataFrame
        or dict as in inverse().
    way: method: "exact", or for level plates as in the paper: "linear" [huang2016, Eqs. (22),
        (23)], "tilt-aware" [Eq. (8)].
    Raises InvalidArgument for a wrong shape, dtype, column or method. Poses out of reach, or NaN,
    raise nothing: see status.
    """
    native = (
        _paracal.exactly_known(machine._native)
        if isinstance(machine, Machine)
        else native_known(machine)
    )
    rows, lead = as_poses(poses, native.robot)
    return Compensation(
        *(shaped(one, lead) for one in _paracal.compensate(native, rows, {"way": way}))
    )
