"""A hexapod (six struts): plan, measurement by motion capture, calibration and compensation.

Poses are x, y, z in mm and tilt_x, tilt_y, tilt_z in rad with R = Rot(x) Rot(y) Rot(z). Joints are
the extensions of the struts in mm.
"""

# %% Start from a template of the robot file
import numpy as np

import paracal as pc

robot = pc.robot_of_toml(pc.robot_template("hexapod"))
print(robot, ", ".join(robot.pose_axes))
# prints: <paracal.Robot hexapod: 6 limbs, joints in mm> x, y, z, tilt_x, tilt_y, tilt_z
print(robot.units)
# prints: 'gain': 'mm/m'

# %% Choose poses; some directions are not determined with an unknown frame
plan = pc.select_poses(robot, 30, candidates=500, measure="pose")
seen = pc.identifiability(robot, plan, measure="pose")
print(f"{seen.rank} of {len(seen.names)} are determined; not determined:", seen.null_space[0].text)
# prints: 36 of 48 are determined

# %% Simulate the measurements of a machine
machine = pc.Machine(robot, pc.draw_errors(robot, seed=3))
measured = pc.simulate(machine, plan, measure="pose", noise_mm=0.02, rotation_noise_rad=2e-4)

# %% Identify the errors, with their uncertainty
calibration = pc.calibrate(robot, measured)
print(calibration.verdict)
# prints: accepted
calibration  # in a notebook: verdict, table, notes, assumptions

# %% Compute compensated joints for a tilted pose
wanted = np.array([20.0, -30.0, 510.0, *np.radians([5.0, -4.0, 8.0])])
told = pc.compensate(calibration, wanted)
nominal = pc.forward(machine, pc.inverse(robot, wanted).joints).poses
reached = pc.forward(machine, told.joints).poses
print(f"error {np.linalg.norm((nominal - wanted)[:3]):.2f} mm, compensated ", end="")
print(f"{np.linalg.norm((reached - wanted)[:3]):.2f} mm in the frame of the base")
print("U of x, y, z, mm", np.round(told.U[:3], 2), "of tilts, mrad", np.round(1e3 * told.U[3:], 2))

# %% Contributions to the variance, before it is built
sensitivity = pc.tolerance.sensitivity(robot, "position", relative_error=0.01)
print("zeros contribute", f"{dict(sensitivity.contributors)['zero']:.0%}", "of the variance")
# prints: zeros contribute
