"""Test of a calibration before measuring: choose poses, simulate a machine within the tolerances,
simulate the measurements of a laser tracker, calibrate, validate."""

# %% Choose poses and predict what they determine
import numpy as np

import paracal as pc

robot = pc.robot("huang2016")
plan = pc.select_poses(robot, 16, candidates=500)
prediction = pc.identifiability(robot, plan)
print(f"{prediction.rank} of {len(prediction.names)} parameters")
# prints: 27 of 32 parameters
for direction in prediction.null_space:
    print("not determined by these measurements:", direction.text)

# %% Simulate a machine and its measurements
truth = pc.Machine(robot, pc.draw_errors(robot, seed=7))
frame = np.eye(4)
frame[:3, 3] = [2500.0, -800.0, 300.0]  # mm: position of the tracker, unknown to the fit
measured = pc.simulate(truth, plan, noise_mm=0.017, repeats=3, frame=frame)

# %% Calibrate
calibration = pc.calibrate(robot, measured)
print(calibration.verdict)
# prints: accepted
print(f"noise {calibration.noise_mm:.3f} mm, stated 0.017")

# %% Validate at other poses
check = pc.simulate(truth, pc.validation_poses(robot), noise_mm=0.017, seed=2)
validation = pc.validate(calibration, check, limit_mm=0.2)
print("validation accepted:", validation.accepted)
# prints: validation accepted: True
before, after = validation.before["max_abs_distance_mm"], validation.after["max_abs_distance_mm"]
print(f"errors of distances to home: {before:.2f} mm before, {after:.2f} mm after")

# %% Compare predictions with the true poses
joints = pc.inverse(robot, pc.validation_poses(robot).poses).joints
predicted = calibration.predict(joints)
off = np.abs(predicted.poses - pc.forward(truth, joints).poses)
print(f"{np.mean(off <= predicted.U):.0%} of coordinates within U")
