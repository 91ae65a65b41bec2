"""A plate with six freedoms on six struts: planned, measured by motion capture, calibrated and
compensated.

Poses are x, y, z in mm and tilt_x, tilt_y, tilt_z in rad with R = Rot(x) Rot(y) Rot(z); joints are
how far each strut has grown, in mm.
"""

# %% The robot: a template to put a machine's numbers into
import numpy as np

import paracal as pc

robot = pc.robot_of_toml(pc.robot_template("hexapod"))
print(robot, ", ".join(robot.pose_axes))
# prints: <paracal.Robot hexapod: 6 limbs, joints in mm> x, y, z, tilt_x, tilt_y, tilt_z
print(robot.units)
# prints: 'gain': 'mm/m'

# %% Poses that show the most, and what they cannot show in a frame that nobody knows
plan = pc.select_poses(robot, 30, candidates=500, measure="pose")
seen = pc.identifiability(robot, plan, measure="pose")
print(f"{seen.rank} of {len(seen.names)} are seen; not seen:", seen.null_space[0].text)
# prints: 36 of 48 are seen

# %% A machine as motion capture would read it
machine = pc.Machine(robot, pc.draw_errors(robot, seed=3))
measured = pc.simulate(machine, plan, measure="pose", noise_mm=0.02, rotation_noise_rad=2e-4)

# %% Which errors it has, and how sure that is
calibration = pc.calibrate(robot, measured)
print(calibration.verdict)
# prints: accepted
calibration  # in a notebook: verdict, table, notes, assumptions

# %% Joints that bring it to a tilted pose
wanted = np.array([20.0, -30.0, 510.0, *np.radians([5.0, -4.0, 8.0])])
told = pc.compensate(calibration, wanted)
nominal = pc.forward(machine, pc.inverse(robot, wanted).joints).poses
reached = pc.forward(machine, told.joints).poses
print(f"off by {np.linalg.norm((nominal - wanted)[:3]):.2f} mm, compensated ", end="")
print(f"{np.linalg.norm((reached - wanted)[:3]):.2f} mm in the frame of the base")
print("U of x, y, z, mm", np.round(told.U[:3], 2), "of tilts, mrad", np.round(1e3 * told.U[3:], 2))

# %% Which errors matter most, before it is built
sensitivity = pc.tolerance.sensitivity(robot, "position", relative_error=0.01)
print("zeros make", f"{dict(sensitivity.contributors)['zero']:.0%}", "of the variance")
# prints: zeros make
