"""Inverse, forward and Jacobian, exact, over arrays of poses and joints."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from . import _paracal
from ._arrays import (
    BoolArray,
    CodeArray,
    FloatArray,
    IntArray,
    Numbers,
    as_joints,
    as_poses,
    shaped,
)
from .robots import MachineLike, native_machine


class InverseStatus(IntEnum):
    """What became of a pose."""

    reached = 0
    unreachable = 1  #: arm and rod of a limb do not meet, or a rigid plate is asked to turn
    not_converged = 2  #: only with tilt errors: the pose is at a singularity


class ForwardStatus(IntEnum):
    """What became of joint coordinates."""

    converged = 0
    strained = 1  #: converged, but some rod would have to stretch by more than 1 mm
    singular = 2  #: the joints do not hold the plate
    not_converged = 3


class Inverse(NamedTuple):
    """Joint coordinates for poses; `joints, status = inverse(...)` takes it apart."""

    joints: FloatArray  #: (..., limbs), rad (mm of rails and struts); NaN where not reached
    status: CodeArray  #: (...), codes of InverseStatus

    @property
    def ok(self) -> BoolArray:
        """(...): the pose is reached."""
        return np.asarray(self.status == InverseStatus.reached)


class Forward(NamedTuple):
    """Poses that joint coordinates lead to."""

    #: (..., 4): x, y, z in mm, phi in rad; of a plate with six freedoms (..., 6): x, y, z, tilt_x,
    #: tilt_y, tilt_z. NaN where singular or not converged
    poses: FloatArray
    tilt: FloatArray  #: (..., 3): about x, y, z of the plate, rad; R = Rot(x) Rot(y) Rot(z)
    residual: FloatArray  #: (...): largest rod-length residual, mm
    iterations: IntArray  #: (...)
    status: CodeArray  #: (...), codes of ForwardStatus

    @property
    def ok(self) -> BoolArray:
        """(...): converged, and the rods meet."""
        return np.asarray(self.status == ForwardStatus.converged)


class Driven(NamedTuple):
    """Where a machine went; NaN where the controller does not reach the pose, or the machine does
    not close there."""

    poses: FloatArray  #: as those that were commanded, mm and rad
    tilt: FloatArray  #: (..., 3): about x, y, z of the plate, rad

    @property
    def ok(self) -> BoolArray:
        """(...): the plate stands there."""
        return np.asarray(np.isfinite(self.poses).all(axis=-1))


class Jacobian(NamedTuple):
    """Derivatives of x, y, z (mm), phi, tilt_x, tilt_y, tilt_z (rad): seven rows; six, without phi,
    where the plate has six freedoms: those of its pose."""

    joints: FloatArray  #: (..., rows, limbs), per rad (mm of rails and struts) of the joints
    errors: FloatArray  #: (..., rows, limbs, sources), per unit of the errors, as Robot.sources
    status: CodeArray  #: (...), codes of ForwardStatus; NaN where neither converged nor strained

    @property
    def ok(self) -> BoolArray:
        """(...): the derivatives exist, and the rods meet."""
        return np.asarray(self.status == ForwardStatus.converged)


def inverse(machine: MachineLike, poses: Numbers) -> Inverse:
    """Joint coordinates that bring the plate to poses, elbows outward  [huang2016, Eq. (1)], exact.

    machine: a Robot (nominal), a Machine, or a Calibration: the joints then compensate.
    poses: (..., 4) of x, y, z in mm in the robot's frame, phi in rad; of a plate with six freedoms
        (..., 6) of x, y, z in mm, tilt_x, tilt_y, tilt_z in rad; or (..., 3) with angles = 0. Of a
        DataFrame or dict columns count by name and unit: x_mm, y_mm, z_mm and phi_deg or phi_rad
        (tilt_x_deg, ...), or x_cmd_mm, ..., in any order; an angle that is not there is 0.
    Raises InvalidArgument for another shape or dtype, and for columns that are unknown or missing;
    poses out of reach, or NaN, have a status.
    """
    native = native_machine(machine)
    rows, lead = as_poses(poses, native.robot)
    joints, status = _paracal.inverse(native, rows)
    return Inverse(shaped(joints, lead), shaped(status, lead))


def forward(machine: MachineLike, joints: Numbers) -> Forward:
    """Where a machine puts its plate: min over the pose of the sum of squared rod-length residuals,
    exact.

    joints: (..., limbs) as the controller believes them, rad (mm of rails and struts). Of a
        DataFrame or dict columns count by name and unit: q1_deg or q1_rad (q1_mm), ...
    Raises InvalidArgument for another shape or dtype, and for columns that are unknown or missing;
    joints that hold no plate have a status.
    """
    native = native_machine(machine)
    rows, lead = as_joints(joints, native.robot)
    poses, tilt, residual, iterations, status = _paracal.forward(native, rows)
    return Forward(
        shaped(poses, lead),
        shaped(tilt, lead),
        shaped(residual, lead),
        shaped(iterations, lead),
        shaped(status, lead),
    )


def drive(machine: MachineLike, poses: Numbers) -> Driven:
    """Where a machine puts its plate when its controller, which computes with the nominal robot, is
    sent to poses: forward(machine, inverse(robot, poses).joints), near what was commanded.

    poses: as of inverse(), mm and rad, or columns by name. Raises InvalidArgument as inverse().
    """
    native = native_machine(machine)
    rows, lead = as_poses(poses, native.robot)
    return Driven(*(shaped(one, lead) for one in _paracal.drive(native, rows)))


def jacobian(machine: MachineLike, joints: Numbers) -> Jacobian:
    """Derivative of forward() with respect to joints and source errors, from stationarity of the
    closure:

        d plate / d p = -(J^T J)^-1 J^T J_p

    Exact for three and six limbs; for four the curvature of residuals is neglected (below 1e-3 of a
    row's largest entry with the tolerances of huang2016). A joint's column is that of its zero
    (theta_offset), times 1 + gain / 1000 on a strut: the actuator stands at q + theta_offset, the
    strut grows by zero + (1 + gain / 1000) q.
    joints: (..., limbs), rad (mm of rails and struts), or columns by name.
    Raises InvalidArgument as forward().
    """
    native = native_machine(machine)
    rows, lead = as_joints(joints, native.robot)
    return Jacobian(*(shaped(one, lead) for one in _paracal.jacobian(native, rows)))
