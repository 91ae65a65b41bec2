"""Commands and targets that bring a calibrated machine to where it is wanted."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple, Union

import numpy as np

from . import _paracal
from ._arrays import BoolArray, CodeArray, FloatArray, Numbers, as_poses, shaped
from .calibration import Calibration
from .known import KnownMachine
from .robots import Machine
from .validation import native_known


class CompensationStatus(IntEnum):
    """What became of a wanted pose."""

    ok = 0
    unreachable = 1  #: an arm and its rods do not meet there, or a rigid plate is asked to turn
    not_finite = 2  #: the pose holds NaN or infinity
    singular = (
        3  #: the machine does not hold the plate there, or no nominal target has these joints
    )


class Compensation(NamedTuple):
    """What to tell a controller; all NaN where the status is not ok."""

    joints: FloatArray  #: (..., limbs) to command, rad (mm of rails and struts)
    #: As the poses, for a controller that computes with the nominal robot: mm, rad
    targets: FloatArray
    remaining_tilt: FloatArray  #: (..., 2) about x and y, rad: what no joint removes
    U: FloatArray  #: of the numbers of a pose, mm and rad, about 95 %; NaN without covariance
    status: CodeArray  #: (...), codes of CompensationStatus

    @property
    def ok(self) -> BoolArray:
        """(...): there is an answer."""
        return np.asarray(self.status == CompensationStatus.ok)


def compensate(
    machine: Union[Calibration, KnownMachine, Machine], poses: Numbers, way: str = "exact"
) -> Compensation:
    """Corrected joint coordinates and targets for wanted poses.

    machine: a Calibration, what read_calibration() knows, or a Machine (then without uncertainty).
    poses: where the plate is wanted: (..., 4) of x, y, z in mm, phi in rad; of a plate with six
        freedoms (..., 6) of x, y, z in mm, tilt_x, tilt_y, tilt_z in rad; or (..., 3) with
        angles = 0; or a DataFrame or dict of columns as inverse() takes it.
    way: "exact", or as in the paper, where the plate stays level: "linear" [huang2016, Eqs. (22),
        (23)], "tilt-aware" [Eq. (8)].
    Raises InvalidArgument for another shape, dtype, column or way; poses out of reach, or NaN, have
    a status.
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
