"""What public functions return can be copied and pickled, and is then the same to the bit."""

import copy
import enum
import hashlib
import inspect
import pickle
import subprocess
import sys
import unittest
from functools import lru_cache
from unittest import mock

import numpy as np
from support import DISTANCES, FIVE_BAR, HEXAPOD, POSES, TestCase

import paracal as pc

WAYS = {
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    **{
        f"pickle {protocol}": lambda one, protocol=protocol: pickle.loads(
            pickle.dumps(one, protocol)
        )
        for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1)
    },
}


@lru_cache(maxsize=None)
def results():
    """Of every kind of robot one of every kind of result that it has."""
    published = pc.robot("huang2016")
    distances = pc.read_measurements(DISTANCES, poses=POSES)
    all_results = [
        distances,
        pc.calibrate(published, distances, fixed=["theta_offset.2"]),
        pc.merge([distances]).at_reference_temperature(30.0),
        pc.paper_plan(published),
        pc.tolerance.allocate(published),
        pc.Tolerances.stated(published, {"rod_mean": 0.1}, distribution="uniform"),
    ]
    for name, measure in (
        ("huang2016", "coordinates"),
        ("linear_delta", "height"),
        (HEXAPOD, "pose"),
        (FIVE_BAR, "coordinates"),
    ):
        robot = pc.robot(name)
        machine = pc.Machine(robot, pc.draw_errors(robot, seed=3))
        plan = pc.select_poses(robot, 16, candidates=60, measure=measure)
        measured = pc.simulate(machine, plan, measure=measure, noise_mm=0.02)
        calibration = pc.calibrate(robot, measured, tolerances=pc.Tolerances.of(robot))
        joints = pc.inverse(robot, plan.poses).joints
        seen = pc.identifiability(robot, plan, measure=measure)
        all_results += [
            *(robot, machine, plan, measured, calibration, calibration.known, seen),
            *seen.null_space[:1],
            pc.inverse(machine, plan.poses),
            pc.forward(machine, joints),
            pc.drive(machine, plan.poses),
            pc.jacobian(machine, joints),
            calibration.predict(joints),
            pc.compensate(calibration, plan.poses),
            pc.validate(calibration, measured, limit_mm=0.1),
            pc.Tolerances.of(robot),
            pc.tolerance.analyze(
                robot, None, {"position": 1.0}, sigma_error=0.2, failure_error=0.5
            ),
            pc.tolerance.sensitivity(robot, "position", relative_error=0.1),
        ]
    return all_results


def public_classes():
    for module in (pc, pc.tolerance):
        for name in getattr(module, "__all__", None) or vars(module):
            one = getattr(module, name)
            own = getattr(one, "__module__", "").startswith("paracal") and not name.startswith("_")
            if inspect.isclass(one) and own and not issubclass(one, (Exception, enum.Enum)):
                yield one


class Copies(TestCase):
    def test_every_kind_of_result_is_tried(self):
        untried = set(public_classes()) - {type(one) for one in results()}
        self.assertEqual(untried, set())
        self.assertIn(pc.tolerance.Analysis, public_classes())

    def same_as(self, one, other, where):
        """Recursively, whatever a user can see of both."""
        self.assertIs(type(one), type(other), where)
        if isinstance(one, np.ndarray):
            self.assertEqual((one.dtype, one.shape), (other.dtype, other.shape), where)
            self.assertEqual(one.tobytes(), other.tobytes(), where)
        elif isinstance(one, dict):
            self.assertEqual(list(one), list(other), where)
            for key in one:
                self.same_as(one[key], other[key], f"{where}[{key}]")
        elif isinstance(one, (list, tuple)):
            self.assertEqual(len(one), len(other), where)
            for k, (mine, theirs) in enumerate(zip(one, other)):
                self.same_as(mine, theirs, f"{where}[{k}]")
        elif type(one).__module__.startswith("paracal"):
            for name, value in {**vars(one), **self.properties(one)}.items():
                if not name.startswith("_"):
                    self.same_as(value, getattr(other, name), f"{where}.{name}")
            for text in ("to_json", "to_toml", "to_csv", "__repr__", "__str__"):
                if hasattr(one, text) and not isinstance(one, pc.Plan):
                    self.assertEqual(getattr(one, text)(), getattr(other, text)(), where)
        else:
            self.assertTrue(one == other or (one != one and other != other), where)

    @staticmethod
    def properties(one):
        own = inspect.getmembers(type(one), lambda member: isinstance(member, property))
        return {name: getattr(one, name) for name, _ in own}

    def test_copies_are_the_same_to_the_bit(self):
        with mock.patch.dict("os.environ", {"SOURCE_DATE_EPOCH": "1475668800"}):
            for one in results():
                for name, way in WAYS.items():
                    with self.subTest(f"{type(one).__name__} by {name}"):
                        other = way(one)
                        self.same_as(one, other, type(one).__name__)
                        if hasattr(one, "_native"):  # all that the library holds, seen or not
                            self.assertEqual(
                                pickle.dumps(one._native), pickle.dumps(other._native)
                            )

    def test_copies_do_the_same(self):
        for one in results():
            if not isinstance(one, pc.Calibration) or not one.known.covariance.size:
                continue
            other = pickle.loads(pickle.dumps(one))
            poses = pc.validation_poses(one.robot).poses
            joints = pc.inverse(one.robot, poses).joints
            self.same_as(one.predict(joints), other.predict(joints), "predict")
            self.same_as(pc.inverse(one, poses), pc.inverse(other, poses), "inverse")
            self.same_as(pc.compensate(one, poses), pc.compensate(other.known, poses), "compensate")
        measured = next(one for one in results() if isinstance(one, pc.Measurements))
        robot = pc.robot("huang2016")
        again = pc.calibrate(pickle.loads(pickle.dumps(robot)), copy.deepcopy(measured))
        self.assertEqual(again.to_json(0), pc.calibrate(robot, measured).to_json(0))
        confirmed = pc.validate(again, pickle.loads(pickle.dumps(measured)))
        self.assertIn("cannot confirm it", str(confirmed.reasons))  # it knows its files

    def test_another_process_takes_them(self):
        calibration = next(one for one in results() if isinstance(one, pc.Calibration))
        code = "import pickle, sys; sys.stdout.write(pickle.load(sys.stdin.buffer).to_json(0))"
        done = subprocess.run(
            [sys.executable, "-c", code], input=pickle.dumps(calibration), capture_output=True
        )
        self.assertEqual(done.stdout.decode(), calibration.to_json(0), done.stderr)

    def test_what_is_of_another_version_or_changed_is_refused(self):
        native = pc.robot("huang2016")._native
        made_by, (restored, version, state, sha256) = native.__reduce__()

        def made(*arguments):
            return made_by(restored, *arguments)

        self.assertEqual(made(version, state, sha256).toml(), native.toml())
        with self.assertRaisesRegex(pc.Error, "expected an object of paracal .*, got one of 0.0"):
            made("0.0", state, sha256)
        changed = [state[:end] for end in (0, 10, len(state) - 1)] + [state + b"x"]
        changed += [state[:k] + bytes([state[k] ^ 0x80]) + state[k + 1 :] for k in (0, 7, 60, 300)]
        for one in changed:
            with self.assertRaisesRegex(pc.Error, "with their hash, got changed ones"):
                made(version, one, sha256)
            if len(one) != len(state):  # by somebody who has made the hash anew, too
                with self.assertRaisesRegex(pc.Error, "expected (more|fewer|other) bytes"):
                    made(version, one, hashlib.sha256(one).hexdigest())

    def test_nothing_is_made_of_nothing(self):
        for one in results():
            native = getattr(one, "_native", None)
            if native is not None:
                with self.assertRaisesRegex(TypeError, "expected a call of a function of paracal"):
                    type(native).__new__(type(native))

    def arrays(self, value):
        """Arrays in a value of a property, also within what it lists."""
        if isinstance(value, np.ndarray):
            yield value
        elif isinstance(value, dict):
            for one in value.values():
                yield from self.arrays(one)
        elif isinstance(value, (list, tuple)):
            for one in value:
                yield from self.arrays(one)

    def test_arrays_of_results_cannot_be_changed(self):
        seen = 0
        for one in results():
            for name, value in self.properties(one).items():
                for array in () if name.startswith("_") else self.arrays(value):
                    seen += 1
                    with self.subTest(f"{type(one).__name__}.{name}"):
                        self.assertFalse(array.flags.writeable)
        self.assertGreater(seen, 10)


if __name__ == "__main__":
    unittest.main()
