"""A first calibration: six distances that a laser tracker measured on the robot of Huang et al.

Cells begin with "# %%" for Jupyter, Spyder and VS Code. Run it from the root of the repository, or
state the folder data/: PARACAL_DATA=... python3 01_calibrate.py
"""

# %% Read the robot and the measurements
import os
from pathlib import Path

import numpy as np

import paracal as pc

data = Path(os.environ.get("PARACAL_DATA", "data")) / "huang2016"
robot = pc.robot("huang2016")
measured = pc.read_measurements(data / "distances.csv", poses=data / "poses.csv", robot=robot)
print(measured)
# prints: <paracal.Measurements at 7 poses: 6 distances>

# %% Identify the errors, with their uncertainty
calibration = pc.calibrate(robot, measured)
print(calibration.verdict)
# prints: accepted
estimated = np.flatnonzero(~calibration.held)  # the others are fixed at nominal
for k in estimated:
    value, U = np.degrees(calibration.values[k]), np.degrees(calibration.U[k])
    print(f"{calibration.names[k]}  {value:6.3f} deg, U {U:.3f}")
# prints: theta_offset.1   0.206 deg, U 0.845
calibration  # in a notebook: verdict, table, notes, assumptions

# %% Correlations of the encoder offsets
covariance = calibration.covariance[np.ix_(estimated, estimated)]
correlation = covariance / np.outer(calibration.std[estimated], calibration.std[estimated])
print(f"smallest correlation {correlation.min():.2f}")

# %% Compute compensated joint angles, with the uncertainty of the pose
wanted = np.array([200.0, -130.0, -930.0, 0.5])  # mm, rad
told = pc.compensate(calibration, wanted)
print("joints", np.round(np.degrees(told.joints), 4), "deg")
# prints: joints [ -2.9513 -19.4426 -39.777  -26.5306] deg
print(f"U of x {told.U[0]:.1f} mm, of phi {np.degrees(told.U[3]):.1f} deg")

# %% Compute 50,000 poses at once
poses = np.random.default_rng(1).uniform([-300, -300, -950, -1], [300, 300, -850, 1], (50_000, 4))
joints, status = pc.inverse(calibration, poses)
print(f"{np.mean(status == pc.InverseStatus.reached):.0%} in reach")
# prints: 100% in reach
