"""A calibrated machine: its geometric errors and their uncertainty."""

from __future__ import annotations

import os
from typing import NamedTuple

import numpy as np

from . import _paracal, _tables
from ._arrays import BoolArray, FloatArray, Numbers, as_joints, of_result, shaped
from .robots import Machine, Robot, native_robot, parameter_names


class NullDirection(NamedTuple):
    """A direction of the parameters that the readings do not determine."""

    text: str  #: the direction in words
    direction: FloatArray  #: (parameters), unit vector
    gauge: bool  #: a motion of the whole robot, or of the slide's zero


class Prediction(NamedTuple):
    """Predicted poses of a calibrated machine, with their uncertainty."""

    #: (..., 4): x, y, z in mm, phi in rad; with commanded tilt (..., 6): x, y, z, tilt_x, tilt_y,
    #: tilt_z; NaN without a solution
    poses: FloatArray
    covariance: FloatArray  #: (..., 4, 4) or (..., 6, 6): U = 2 sqrt(diagonal), about 95 %
    ok: BoolArray  #: (...) True: there is a solution

    @property
    def U(self) -> FloatArray:
        """Expanded uncertainty U of the poses, same shape, mm and rad, about 95 %."""
        return of_result(2.0 * np.sqrt(np.diagonal(self.covariance, axis1=-2, axis2=-1)))


class KnownMachine:
    """Geometric errors of a machine with their uncertainty, for validation, prediction and
    compensation. read_calibration() and Calibration.known return it."""

    def __init__(self, native: _paracal.KnownMachine) -> None:
        self._native = native
        self.robot = Robot(native.robot)

    @property
    def errors(self) -> FloatArray:
        """(limbs, sources) geometric errors, mm and rad; zero where not identified."""
        return of_result(self._native.errors)

    @property
    def names(self) -> list[str]:
        """Names of the parameters: "e_x.2" is e_x of limb 2."""
        return parameter_names(self._native.parameters)

    @property
    def covariance(self) -> FloatArray:
        """(n, n) covariance of the parameters, mm and rad; (0, 0) if not stated."""
        return of_result(self._native.covariance)

    @property
    def machine(self) -> Machine:
        """The machine with these errors."""
        return Machine(self.robot, self.errors)

    def predict(self, joints: Numbers) -> Prediction:
        """Predicted poses and their uncertainty at joint coordinates (..., limbs), rad (mm for
        rails and struts), as in forward().
        Raises InvalidArgument for a wrong shape or column."""
        rows, lead = as_joints(joints, self._native.robot)
        return Prediction(*(shaped(one, lead) for one in self._native.predict(rows)))

    def __repr__(self) -> str:
        count = len(self.covariance)
        return f"<paracal.KnownMachine {self.robot.name}: {count} parameters with a covariance>"


def read_calibration(path: str | os.PathLike[str], robot: Robot | None = None) -> KnownMachine:
    """Reads a calibration file (JSON).

    robot: the required robot; default: the robot in the file.
    Raises InputFileError for a file that is not a calibration of this robot, or was not accepted.
    """
    return KnownMachine(
        _paracal.read_calibration(
            _tables.path_of(path), None if robot is None else native_robot(robot)
        )
    )
