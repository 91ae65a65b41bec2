"""Ctrl-C ends what takes long while the library computes."""

import subprocess
import sys
import unittest

from support import HEXAPOD, TestCase

#: Each would take minutes, far longer than the process may.
LONG = {
    "select_poses": "pc.select_poses(robot, 400, candidates=40000)",
    "select_poses of a body": "pc.select_poses(hexapod, 200, candidates=20000, measure='pose')",
    "calibrate": "pc.calibrate(hexapod, measured)",
    "analyze, rare failures": "pc.tolerance.analyze(robot, None, {'tilt': 3e-3}, "
    "failure_error=1e-4)",
    "analyze, exact": "pc.tolerance.analyze(hexapod, None, {'position': 1.0}, model='exact', "
    "sigma_error=1e-4, failure_error=1.0, max_machines=10**9)",
    "analyze, linear": "pc.tolerance.analyze(robot, None, {'tilt': 1e-9}, sigma_error=1e-4, "
    "failure_error=1.0, max_machines=10**12)",
    "allocate": "pc.tolerance.allocate(robot, problem=sys.argv[2])",
    "draw_errors": "pc.draw_errors(robot, 20_000_000)",
    "inverse": "pc.inverse(pc.Machine(hexapod), poses)",
    "forward": "pc.forward(pc.Machine(hexapod), np.zeros((10_000_000, 6)))",
    "compensate": "pc.compensate(pc.Machine(hexapod), poses)",
}

PROGRAM = """
import os, signal, sys, threading
import numpy as np
import paracal as pc

robot, hexapod = pc.robot("huang2016"), pc.robot(sys.argv[1])
call = sys.argv[3]
if "measured" in call:
    plan = pc.select_poses(hexapod, 30, candidates=300, measure="pose")
    machine = pc.Machine(hexapod, pc.draw_errors(hexapod, seed=3))
    measured = pc.simulate(machine, plan, measure="pose", noise_mm=0.02, repeats=10000)
if "poses" in call:
    poses = np.tile([0.0, 0.0, 500.0, 0.0, 0.0, 0.1], (10_000_000, 1))
threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    eval(call)
    print("ended by itself")
except KeyboardInterrupt:
    print("interrupted")
"""


#: Limits that one machine of ten thousand may break: it is drawn at many tolerances.
PROBLEM = "max_failures = 1e-4\n" + "".join(
    f'[[requirement]]\nquantity = "{quantity}"\ncriterion = "yield"\n{limit}\n'
    for quantity, limit in (("position", "limit_mm = 0.5"), ("tilt", "limit_deg = 0.05"))
)
PROBLEM += "".join(
    f'[cost.{key}]\nlaw = "reciprocal"\nB = 1.0\nlower = 0.0005\nupper = 1.0\n'
    for key in (
        *("arm_length_mm", "rod_mean_mm", "e_mm", "alpha0_deg", "beta0_deg", "theta_offset_deg"),
        *("rod_difference_mm", "alpha2_deg", "beta2_deg", "width_difference_mm"),
    )
)


class Interruptions(TestCase):
    def test_ctrl_c_ends_what_would_take_minutes(self):
        problem = self.file("problem.toml", PROBLEM)
        for name, call in LONG.items():
            with self.subTest(name):
                done = subprocess.run(
                    [sys.executable, "-c", PROGRAM, HEXAPOD, problem, call],
                    capture_output=True,
                    text=True,
                    timeout=60,
                )
                self.assertEqual((done.stdout, done.stderr), ("interrupted\n", ""))

    def test_other_threads_are_not_interrupted(self):
        """What another thread computes goes on: Ctrl-C is for the main thread."""
        code = (
            "import signal, threading\n"
            "import paracal as pc\n"
            "found = []\n"
            "robot = pc.robot('huang2016')\n"
            "other = threading.Thread(target=lambda: found.append(pc.select_poses(robot, 12)))\n"
            "signal.signal(signal.SIGINT, lambda *_: None)\n"
            "other.start()\n"
            "signal.raise_signal(signal.SIGINT)\n"
            "other.join()\n"
            "print(len(found[0]))\n"
        )
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        self.assertEqual((done.stdout, done.stderr), ("12\n", ""))


if __name__ == "__main__":
    unittest.main()
