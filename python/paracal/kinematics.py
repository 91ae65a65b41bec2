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
    of_result,
    shaped,
)
from .robots import MachineLike, native_machine


class InverseStatus(IntEnum):
    """Status of a pose."""

    reached = 0
    unreachable = 1  #: no solution: out of reach, or rotation of a rigid plate
    not_converged = 2  #: only with errors that tilt the plate: the pose is singular


class ForwardStatus(IntEnum):
    """Status of joint coordinates."""

    converged = 0
    strained = 1  #: converged, but a rod-length residual is above 1 mm
    singular = 2  #: the plate can move with fixed joints
    not_converged = 3
    other_mode = 4  #: outside of the workspace, and not reached by moving from its middle


class Inverse(NamedTuple):
    """Joint coordinates for poses: `joints, status = inverse(...)`."""

    joints: FloatArray  #: (..., limbs), rad (mm for rails and struts); NaN where not reached
    status: CodeArray  #: (...), codes of InverseStatus

    @property
    def ok(self) -> BoolArray:
        """(...) True: the pose is reached."""
        return of_result(np.asarray(self.status == InverseStatus.reached))


class Forward(NamedTuple):
    """Poses at given joint coordinates."""

    #: (..., 4): x, y, z in mm, phi in rad; with commanded tilt (..., 6): x, y, z, tilt_x, tilt_y,
    #: tilt_z. NaN where singular or not converged
    poses: FloatArray
    tilt: FloatArray  #: (..., 3): about x, y, z of the plate, rad; R = Rot(x) Rot(y) Rot(z)
    residual: FloatArray  #: (...): largest rod-length residual, mm
    iterations: IntArray  #: (...)
    status: CodeArray  #: (...), codes of ForwardStatus

    @property
    def ok(self) -> BoolArray:
        """(...) True: converged, with small residuals."""
        return of_result(np.asarray(self.status == ForwardStatus.converged))


class Driven(NamedTuple):
    """Actual poses of a machine; NaN where controller or machine cannot reach the pose."""

    poses: FloatArray  #: columns as the commanded poses, mm and rad
    tilt: FloatArray  #: (..., 3): about x, y, z of the plate, rad

    @property
    def ok(self) -> BoolArray:
        """(...) True: the pose is reached."""
        return of_result(np.asarray(np.isfinite(self.poses).all(axis=-1)))


class Jacobian(NamedTuple):
    """Derivatives of x, y, z (mm), phi, tilt_x, tilt_y, tilt_z (rad), in seven rows. With commanded
    tilt: six rows, without phi."""

    joints: FloatArray  #: (..., rows, limbs), per rad (mm for rails and struts) of the joints
    errors: FloatArray  #: (..., rows, limbs, sources), per unit of the errors, as Robot.sources
    status: CodeArray  #: (...), codes of ForwardStatus; NaN where neither converged nor strained

    @property
    def ok(self) -> BoolArray:
        """(...) True: the derivatives exist, with small residuals."""
        return of_result(np.asarray(self.status == ForwardStatus.converged))


def inverse(machine: MachineLike, poses: Numbers) -> Inverse:
    """Exact joint coordinates for poses, elbows outward  [huang2016, Eq. (1)].

    machine: a Robot (nominal) or a Machine; or a Calibration, for compensated joints.
    poses: (..., 4): x, y, z in mm in the robot's frame, phi in rad; with commanded tilt (..., 6):
        x, y, z in mm, tilt_x, tilt_y, tilt_z in rad; or (..., 3) with angles = 0. Or a DataFrame or
        dict with columns x_mm, y_mm, z_mm and phi_deg or phi_rad (tilt_x_deg, ...), or x_cmd_mm,
        ..., in any order; missing angles are 0.
    Raises InvalidArgument for a wrong shape or dtype, and for unknown or missing columns. Poses out
    of reach, or NaN, raise nothing: see status.
    """
    native = native_machine(machine)
    rows, lead = as_poses(poses, native.robot)
    joints, status = _paracal.inverse(native, rows)
    return Inverse(shaped(joints, lead), shaped(status, lead))


def forward(machine: MachineLike, joints: Numbers) -> Forward:
    """Exact pose of the plate: it minimises the sum of squared rod-length residuals.

    joints: (..., limbs) commanded joints, rad (mm for rails and struts); or a DataFrame or dict
        with columns q1_deg or q1_rad (q1_mm), ...
    Raises InvalidArgument for a wrong shape or dtype, and for unknown or missing columns. Joints
    without a solution raise nothing: see status.
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
    """Actual poses of a machine for commanded poses, if its controller uses the nominal robot:
    forward(machine, inverse(robot, poses).joints), in the branch near the commanded pose.

    poses: as in inverse(), mm and rad, or columns by name. Raises InvalidArgument as inverse().
    """
    native = native_machine(machine)
    rows, lead = as_poses(poses, native.robot)
    return Driven(*(shaped(one, lead) for one in _paracal.drive(native, rows)))


def jacobian(machine: MachineLike, joints: Numbers) -> Jacobian:
    """Derivative of forward() with respect to joints and geometric errors, from the stationarity of
    the closure:

        d plate / d p = -(J^T J)^-1 J^T J_p

    Exact for three and six limbs. For four limbs the curvature of residuals is neglected (below 1e-3
    of a row's largest entry with the tolerances of huang2016). The column of a joint equals that of
    its zero (theta_offset), times 1 + gain / 1000 on a strut: the actuator is at q + theta_offset,
    a strut lengthens by zero + (1 + gain / 1000) q.
    joints: (..., limbs), rad (mm for rails and struts), or columns by name.
    Raises InvalidArgument as forward().
    """
    native = native_machine(machine)
    rows, lead = as_joints(joints, native.robot)
    return Jacobian(*(shaped(one, lead) for one in _paracal.jacobian(native, rows)))
