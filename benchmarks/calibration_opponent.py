#!/usr/bin/env python3
"""The fine fits of paracal-calibration-benchmark by SciPy: calibration_opponent.py TASKS.json, started by it.

Each line of standard input is a method of least_squares(). The program solves all fits by it and prints the largest
relative error of a cost. Readings, priors and start are the same. One Newton iteration in vectorised NumPy closes the
loops of all stations, from the commanded poses. Derivatives are differences, the default of least_squares().
"""

import json
import sys

import numpy as np
import scipy
from scipy.optimize import least_squares

FRAME, SOURCES = 6, 14
(THETA, E_X, E_Y, E_Z, ARM, ALPHA0, BETA0, ROD_MEAN, ROD_DIFFERENCE, WIDTH_DIFFERENCE, ALPHA03, BETA03, ALPHA2,
 BETA2) = range(SOURCES)
SIDES = np.array([1.0, -1.0])  # of rod 1 and rod 2 on the short side of a parallelogram


def rotation(axis, angle):
    """Rot(axis, angle) for every entry of `angle`: matrices in the last two dimensions."""
    i, j, k = axis, (axis + 1) % 3, (axis + 2) % 3
    matrix = np.zeros(np.shape(angle) + (3, 3))
    matrix[..., i, i] = 1.0
    matrix[..., j, j] = matrix[..., k, k] = np.cos(angle)
    matrix[..., k, j] = np.sin(angle)
    matrix[..., j, k] = -matrix[..., k, j]
    return matrix


def turn(w):
    """exp([w])."""
    angle = np.linalg.norm(w)
    if angle == 0.0:
        return np.eye(3)
    x, y, z = w / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


class Robot:
    """Nominal dimensions, limbs stacked."""

    def __init__(self, robot):
        azimuth = np.array(robot["limb_azimuth"])
        self.frame = rotation(2, azimuth) @ rotation(0, np.pi / 2)
        self.radial = self.frame[:, :, 0]
        self.base = robot["base_radius"] * self.radial
        self.plate = robot["plate_radius"] * self.radial
        self.arm, self.rod, self.width = robot["arm"], robot["rod"], robot["parallelogram_width"]
        self.slide = np.outer(robot["slide_sign"], robot["slide_axis"])  # motion of the plate joints per unit of slide

    def elbows(self, errors, joints):
        """Joints of the rods at the elbows: stations x limbs x 2 x 3, mm."""
        frame = self.frame @ rotation(0, errors[:, ALPHA0]) @ rotation(1, errors[:, BETA0])
        arm = frame @ rotation(2, joints + errors[:, THETA])
        side = arm @ (rotation(0, errors[:, ALPHA2]) @ rotation(1, errors[:, BETA2]))[:, :, 2:]
        half = 0.5 * (self.width + errors[:, WIDTH_DIFFERENCE])[:, None] * side[..., 0]
        base = self.base + errors[:, E_X:E_Z + 1]
        centre = base + (self.arm + errors[:, ARM])[:, None] * arm[..., 0]
        return centre[:, :, None, :] + SIDES[:, None] * half[:, :, None, :]

    def hinges(self, errors):
        """Joints of the rods on the plate, with the slide at zero: limbs x 2 x 3, mm."""
        frame = (self.frame @ rotation(0, errors[:, ALPHA0] - errors[:, ALPHA03])
                 @ rotation(1, errors[:, BETA0] - errors[:, BETA03]))
        return self.plate[:, None, :] + SIDES[:, None] * 0.5 * self.width * frame[:, None, :, 2]

    def plates(self, errors, joints, start):
        """Position, slide and tilt at every station: arg min of the rods' squared strains, by Gauss and Newton."""
        elbows, hinges = self.elbows(errors, joints), self.hinges(errors)
        lengths = self.rod + errors[:, ROD_MEAN, None] + 0.5 * SIDES * errors[:, ROD_DIFFERENCE, None]
        plates = start.copy()
        for _ in range(20):
            residual, jacobian = self.closure(plates, elbows, hinges, lengths)
            transposed = jacobian.swapaxes(1, 2)
            step = np.linalg.solve(transposed @ jacobian, transposed @ residual[:, :, None])[:, :, 0]
            plates -= step
            if np.abs(step).max() < 1e-8:
                break
        return plates

    def closure(self, plates, elbows, hinges, lengths):
        """Strains of the rods, stations x 8, and their derivatives by the plate, stations x 8 x 7."""
        about_x, about_y, about_z = (rotation(axis, plates[:, 4 + axis]) for axis in range(3))
        turned = (about_x @ about_y @ about_z)[:, None, None]
        slid = hinges + plates[:, 3, None, None, None] * self.slide[:, None, :]
        lever = (turned @ slid[..., None])[..., 0]
        rod = plates[:, None, None, :3] + lever - elbows
        length = np.linalg.norm(rod, axis=-1)
        direction = rod / length[..., None]
        along_slide = np.sum(direction * (turned @ self.slide[:, None, :, None])[..., 0], axis=-1)
        axes = np.stack([np.broadcast_to([1.0, 0.0, 0.0], (len(plates), 3)), about_x[:, :, 1],
                         (about_x @ about_y)[:, :, 2]], axis=2)
        tilt = np.cross(lever, direction) @ axes[:, None]
        jacobian = np.concatenate([direction, along_slide[..., None], tilt], axis=-1)
        return (length - lengths).reshape(len(plates), 8), jacobian.reshape(len(plates), 8, 7)


class Fit:
    """Residuals over scaled unknowns: the turn of the frame, its shift, source errors.

    The units are 100 priors (100 mrad and 100 mm of the frame): differences over 1.5e-8 of them stand well above
    rounding, without which neither method gets to the optimum.
    """

    def __init__(self, tasks, fit):
        self.robot, self.sigma = Robot(tasks["robot"]), tasks["sigma"]
        self.prior_std = np.array(tasks["prior_std"])
        self.unit = 100.0 * np.concatenate([np.full(3, 1e-3), np.ones(3), self.prior_std])
        self.points, self.joints, self.rotation = (np.array(fit[key]) for key in ("points", "joints", "rotation"))
        commanded = np.array(fit["commanded"])  # x, y, z, slide
        self.plates = np.hstack([commanded, np.zeros((len(commanded), 3))])
        self.start = np.concatenate([np.zeros(3), fit["translation"], fit["start"]]) / self.unit
        self.expected = fit["squared_residuals"]

    def __call__(self, scaled):
        unknowns = scaled * self.unit
        errors = unknowns[FRAME:]
        plates = self.robot.plates(errors.reshape(-1, SOURCES), self.joints, self.plates)
        frame = turn(unknowns[:3]) @ self.rotation
        points = plates[:, :3] @ frame.T + unknowns[3:FRAME]
        return np.concatenate([((points - self.points) / self.sigma).ravel(), errors / self.prior_std])

    def solve(self, method):
        # MINPACK takes differences over shares of each unknown, however small that is: its own default is too fine.
        difference = 1e-4 if method == "lm" else None
        return least_squares(self, self.start, method=method, diff_step=difference, ftol=1e-9, xtol=1e-9, gtol=1e-9)


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        tasks = json.load(file)
    fits = [Fit(tasks, fit) for fit in tasks["fits"]]
    print(f"SciPy {scipy.__version__}, NumPy {np.__version__}", flush=True)
    for line in sys.stdin:
        costs = [2.0 * fit.solve(line.strip()).cost for fit in fits]
        print(max(abs(cost / fit.expected - 1.0) for cost, fit in zip(costs, fits)), flush=True)


if __name__ == "__main__":
    main()
