"""What is known of a calibrated machine: its source errors and how sure they are."""

from __future__ import annotations

import os
from typing import NamedTuple

import numpy as np

from . import _paracal, _tables
from ._arrays import BoolArray, FloatArray, Numbers, as_joints, shaped
from .robots import Machine, Robot, native_robot, parameter_names


class NullDirection(NamedTuple):
    """A direction of the parameters that the readings do not see."""

    text: str  #: what it is, in words
    direction: FloatArray  #: (parameters), unit vector
    gauge: bool  #: a motion of the whole robot, or of the slide's zero: no reading sees it


class Prediction(NamedTuple):
    """Poses that a calibrated machine takes, with their uncertainty."""

    #: (..., 4): x, y, z in mm, phi in rad; of a plate with six freedoms (..., 6): x, y, z, tilt_x,
    #: tilt_y, tilt_z; NaN where it does not close
    poses: FloatArray
    covariance: FloatArray  #: (..., 4, 4) or (..., 6, 6) of them: U = 2 sqrt(diagonal), about 95 %
    ok: BoolArray  #: (...): the machine closes there

    @property
    def U(self) -> FloatArray:
        """As the poses: their expanded uncertainty, mm and rad, about 95 %."""
        return np.asarray(2.0 * np.sqrt(np.diagonal(self.covariance, axis1=-2, axis2=-1)))


class KnownMachine:
    """What validation, prediction and compensation know of a machine: its source errors and how
    sure they are. Made by read_calibration(), and by a Calibration (`known`)."""

    def __init__(self, native: _paracal.KnownMachine) -> None:
        self._native = native
        self.robot = Robot(native.robot)

    @property
    def errors(self) -> FloatArray:
        """(limbs, sources) source errors, mm and rad; those not identified are zero."""
        return self._native.errors

    @property
    def names(self) -> list[str]:
        """Of the parameters: "e_x.2" is e_x of limb 2."""
        return parameter_names(self._native.parameters)

    @property
    def covariance(self) -> FloatArray:
        """(n, n) of the parameters, mm and rad; (0, 0) where none was stated."""
        return self._native.covariance

    @property
    def machine(self) -> Machine:
        """The machine with these errors."""
        return Machine(self.robot, self.errors)

    def predict(self, joints: Numbers) -> Prediction:
        """Where the machine goes at joint coordinates (..., limbs), rad (mm of rails and struts),
        and how sure that is; joints as forward() takes them.
        Raises InvalidArgument for another shape or column."""
        rows, lead = as_joints(joints, self._native.robot)
        return Prediction(*(shaped(one, lead) for one in self._native.predict(rows)))

    def __repr__(self) -> str:
        count = len(self.covariance)
        return f"<paracal.KnownMachine {self.robot.name}: {count} parameters with a covariance>"


def read_calibration(path: str | os.PathLike[str], robot: Robot | None = None) -> KnownMachine:
    """What a calibration file (JSON) says of the machine.

    robot: that it must be of; default: the one that the file carries.
    Raises InputFileError for a file that is no calibration of the robot, or one that was not
    accepted.
    """
    return KnownMachine(
        _paracal.read_calibration(
            _tables.path_of(path), None if robot is None else native_robot(robot)
        )
    )
