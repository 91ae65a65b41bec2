"""Tolerance design: sensitivities, the widest tolerances that keep a limit, and the yield of
machines with these tolerances."""

# %% Contributions to the variance of the tilt
import paracal as pc
from paracal import tolerance

robot = pc.robot("huang2016")
tilt = tolerance.sensitivity(robot, "tilt")
print(
    "contributions to the variance of the tilt:",
    ", ".join(f"{name} {share:.0%}" for name, share in tilt.contributors[:3]),
)

# %% The widest tolerances that keep 1 mrad (Table 2 of the paper)
chosen = tolerance.allocate(robot, max_tilt_rad=1e-3)
print(chosen.status)
# prints: optimal
half_widths, width = chosen.tolerances.half_widths, robot.geometry["parallelogram_width_mm"]
print(f"rod_difference / c {1e3 * half_widths['rod_difference'] / width:.3f} mrad")
# prints: rod_difference / c 0.223 mrad

# %% Yield with these tolerances
analysis = tolerance.analyze(robot, chosen.tolerances, {"tilt": 1e-3}, sigma_error=0.02)
worst = analysis.requirements[0]
print(
    f"worst case {1e3 * worst['worst_case']:.2f} mrad, 3 sigma {1e3 * worst['rss_3sigma']:.2f} mrad"
)
print(f"yield {analysis.yield_:.2%} of {analysis.machines} machines")

# %% Effect of one tolerance
for factor in (0.5, 1.0, 2.0):
    wider = {**half_widths, "rod_difference": factor * half_widths["rod_difference"]}
    again = pc.Tolerances.stated(robot, wider)
    spread = tolerance.analyze(robot, again, {"tilt": 1e-3}, sigma_error=0.05).requirements[0]
    print(f"rod_difference times {factor}: 3 sigma {1e3 * spread['rss_3sigma']:.3f} mrad")
