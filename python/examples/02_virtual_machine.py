"""A calibration tried on a virtual machine before anyone measures: choose poses, draw a machine
from the tolerances, measure it with a tracker that stands anywhere, calibrate, validate."""

# %% Which poses, and what they will reveal
import numpy as np

import paracal as pc

robot = pc.robot("huang2016")
plan = pc.select_poses(robot, 16, candidates=500)
promised = pc.identifiability(robot, plan)
print(f"{promised.rank} of {len(promised.names)} parameters")
# prints: 27 of 32 parameters
for direction in promised.null_space:
    print("not seen:", direction.text)

# %% A machine, and what the tracker reads of it
truth = pc.Machine(robot, pc.draw_errors(robot, seed=7))
frame = np.eye(4)
frame[:3, 3] = [2500.0, -800.0, 300.0]  # mm: where the tracker stands; the fit is not told
measured = pc.simulate(truth, plan, noise_mm=0.017, repeats=3, frame=frame)

# %% Calibrate
calibration = pc.calibrate(robot, measured)
print(calibration.verdict)
# prints: accepted
print(f"noise {calibration.noise_mm:.3f} mm, stated 0.017")

# %% On poses that it has not seen
check = pc.simulate(truth, pc.validation_poses(robot), noise_mm=0.017, seed=2)
validation = pc.validate(calibration, check, limit_mm=0.2)
print("validation accepted:", validation.accepted)
# prints: validation accepted: True
before, after = validation.before["max_abs_distance_mm"], validation.after["max_abs_distance_mm"]
print(f"distances to home off by {before:.2f} mm before, {after:.2f} mm after")

# %% Where its predictions lie, pose by pose
joints = pc.inverse(robot, pc.validation_poses(robot).poses).joints
predicted = calibration.predict(joints)
off = np.abs(predicted.poses - pc.forward(truth, joints).poses)
print(f"{np.mean(off <= predicted.U):.0%} of coordinates within U")
