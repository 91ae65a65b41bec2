"""What takes long lets other threads of Python run."""

import subprocess
import sys
import threading
import time
import unittest

import numpy as np
from support import DISTANCES, HEXAPOD, POSES, TestCase

import paracal as pc


class Daemons(TestCase):
    def test_the_interpreter_ends_while_they_compute(self):
        """Such a thread must not get the interpreter's lock any more: that would abort it."""
        code = (
            "import threading, time, numpy as np, paracal as pc\n"
            "robot = pc.robot('huang2016')\n"
            "poses = np.tile([200.0, -130.0, -930.0, 0.5], ({rows}, 1))\n"
            "def work():\n"
            "    while True:\n"
            "        pc.inverse(robot, poses)\n"
            "for _ in range(3):\n"
            "    threading.Thread(target=work, daemon=True).start()\n"
            "time.sleep(0.05)\n"
        )
        for rows in (1, 2000, 100000):
            for _ in range(4):
                done = subprocess.run(
                    [sys.executable, "-c", code.format(rows=rows)], capture_output=True, timeout=60
                )
                self.assertEqual((done.returncode, done.stderr), (0, b""), rows)


class Threads(TestCase):
    def beats_during(self, work):
        """How often another thread of Python runs while something is computed: three times or,
        after 5 s, less often.

        The interpreter takes no turns by itself meanwhile: the other thread runs where it is let.
        """
        stop, beats = threading.Event(), []

        def beat():
            while not stop.wait(0.001):
                beats.append(time.perf_counter())

        other = threading.Thread(target=beat)
        usual = sys.getswitchinterval()
        other.start()
        try:
            sys.setswitchinterval(100.0)
            beats.clear()
            begin = time.perf_counter()
            while len(beats) < 3 and time.perf_counter() < begin + 5.0:
                work()
            counted = len(beats)
        finally:
            sys.setswitchinterval(usual)
            stop.set()
            other.join()
        return counted

    def test_other_threads_run_meanwhile(self):
        robot = pc.robot("huang2016")
        measured = pc.read_measurements(DISTANCES, poses=POSES, robot=robot)
        poses = np.tile([200.0, -130.0, -930.0, 0.5], (20000, 1))
        machine = pc.Machine(robot, pc.draw_errors(robot))
        joints = pc.inverse(machine, poses).joints
        known = pc.calibrate(robot, measured).known
        hexapod = pc.Machine(pc.robot(HEXAPOD))
        tilted = np.tile([10.0, 20.0, 510.0, 0.05, -0.1, 0.15], (20000, 1))
        works = {
            "inverse": lambda: pc.inverse(machine, poses),
            "drive": lambda: pc.drive(machine, poses),
            "forward": lambda: pc.forward(machine, joints),
            "jacobian": lambda: pc.jacobian(machine, joints),
            "draw": lambda: pc.draw_errors(robot, 20000),
            "predict": lambda: known.predict(joints[:5000]),
            "compensate": lambda: pc.compensate(machine, poses),
            "compensate a tilted plate": lambda: pc.compensate(hexapod, tilted),
            "calibrate": lambda: pc.calibrate(robot, measured, stage="fine"),
            "validate": lambda: pc.validate(known, measured),
            "select": lambda: pc.select_poses(robot, 8, candidates=200),
            "identifiability": lambda: pc.identifiability(robot, pc.validation_poses(robot)),
            "analyze": lambda: pc.tolerance.analyze(robot),
            "sensitivity": lambda: pc.tolerance.sensitivity(robot),
        }
        for name, work in works.items():
            with self.subTest(name):
                self.assertGreaterEqual(self.beats_during(work), 3)


if __name__ == "__main__":
    unittest.main()
