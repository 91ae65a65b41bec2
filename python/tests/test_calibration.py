"""Calibrate, validate and compensate: against the program to the bit, against the truth, and in
threads."""

import inspect
import json
import math
import resource
import unittest
from unittest import mock

import numpy as np
from support import (
    DISTANCES,
    POSES,
    TestCase,
    VirtualMachine,
    as_printed,
    in_deg,
    pose_rows,
    program,
)

import paracal as pc

TIME = 1475668800


def published():
    robot = pc.robot("huang2016")
    return robot, pc.read_measurements(DISTANCES, poses=POSES, robot=robot)


class Published(TestCase):
    def test_the_file_is_what_the_program_writes(self):
        robot, measured = published()
        theirs = program("calibrate", "--measurements", DISTANCES, "--poses", POSES)
        calibration = pc.calibrate(robot, measured)
        self.assertEqual(json.loads(calibration.to_json(TIME)), theirs)
        self.assertEqual(
            calibration.names, [f"{one['name']}.{one['limb']}" for one in theirs["parameters"]]
        )
        in_rad = np.array(calibration.units) == "rad"
        for mine, key in ((calibration.values, "value"), (calibration.U, "U")):
            in_file = np.where(in_rad, in_deg(mine), mine)
            self.same(in_file, [one[key] for one in theirs["parameters"]])
        self.assertEqual(np.flatnonzero(~calibration.held).tolist(), [0, 1, 2, 3])
        self.assertEqual(calibration.names[:4], [f"theta_offset.{k}" for k in range(1, 5)])
        self.assertEqual(
            calibration.identified.tolist(),
            [one["status"] == "identified" for one in theirs["parameters"]],
        )
        self.assertEqual(
            (calibration.verdict, calibration.accepted, calibration.reasons), ("accepted", True, [])
        )
        self.assertEqual(
            (calibration.notes, calibration.assumed), (theirs["notes"], theirs["assumed"])
        )
        self.assertEqual(str(calibration).splitlines()[0], "calibration of huang2016: accepted")

    def test_keywords_are_the_options_of_the_program(self):
        robot, measured = published()
        for keywords, options in (
            ({"stage": "fine"}, ["--stage", "fine"]),
            ({"method": "paper", "stage": "rough"}, ["--method", "paper", "--stage", "rough"]),
            ({"sigma_mm": 0.02, "sigma_known": True}, ["--sigma-mm", "0.02", "--sigma-known"]),
            (
                {"fixed": ["theta_offset.2"], "free": ["theta_offset1"]},
                ["--fix", "theta_offset2", "--free", "theta_offset1"],
            ),
            (
                {"distance_bias_mm": 0.1, "scale_ppm": 40.0},
                ["--distance-bias-mm", "0.1", "--scale-ppm", "40"],
            ),
        ):
            theirs = program("calibrate", "--measurements", DISTANCES, "--poses", POSES, *options)
            self.assertEqual(
                json.loads(pc.calibrate(robot, measured, **keywords).to_json(TIME)),
                theirs,
                keywords,
            )

    def test_the_dot_tells_limbs_from_names(self):
        robot, measured = published()

        def fixed(*names):
            found = pc.calibrate(robot, measured, stage="fine", fixed=names).as_dict()["parameters"]
            return [(one["name"], one["limb"]) for one in found if one["status"] == "fixed"]

        self.assertEqual(fixed("alpha0.3"), [("alpha0", 3)])
        self.assertEqual(fixed("alpha03"), [("alpha03", k) for k in (1, 2, 3, 4)])
        self.assertEqual(fixed("e_x2", "e_x.3"), [("e_x", 2), ("e_x", 3)])
        for wrong in ("e_x.5", "e_x.", ".2", "", "e_x..2"):
            with self.assertRaisesRegex(pc.InvalidArgument, "expected a source error such as e_x"):
                fixed(wrong)

    def test_a_limit_that_is_not_kept_is_a_verdict(self):
        robot, measured = published()
        rejected = pc.calibrate(robot, measured, limit_mm=0.01)
        self.assertEqual((rejected.verdict, rejected.accepted), ("rejected", False))
        self.assertTrue(rejected.reasons)

    def test_default_time_is_that_of_the_environment(self):
        calibration = pc.calibrate(*published())
        with mock.patch.dict("os.environ", {"SOURCE_DATE_EPOCH": str(TIME)}):
            self.assertEqual(calibration.to_json(), calibration.to_json(TIME))
        self.assertGreater(calibration.as_dict()["date"], "2020")

    def test_a_file_that_cannot_be_written_leaves_the_earlier_one(self):
        calibration = pc.calibrate(*published())
        plan = pc.paper_plan(calibration.robot)
        for save in (calibration.save, plan.to_csv):
            with self.assertRaisesRegex(pc.Error, "cannot be written"):
                save(self.folder)
            path = self.file("earlier", "what stood there\n")
            for limit in (0, 100):  # bytes that files may have, as on a full disk
                unlimited = resource.getrlimit(resource.RLIMIT_FSIZE)
                resource.setrlimit(resource.RLIMIT_FSIZE, (limit, unlimited[1]))
                try:
                    with self.assertRaisesRegex(pc.Error, "earlier: cannot be written"):
                        save(path)
                finally:
                    resource.setrlimit(resource.RLIMIT_FSIZE, unlimited)
                self.assertEqual(path.read_text(), "what stood there\n")
            self.assertEqual([one.name for one in self.folder.iterdir()], ["earlier"])
            save(path)
            self.assertGreater(path.stat().st_size, 100)

    def test_wrong_keywords(self):
        robot, measured = published()
        for keywords, message in (
            ({"stage": "coarse"}, 'stage: expected one of rough, fine, auto, got "coarse"'),
            ({"sigma_mm": -1.0}, "sigma_mm: expected 1e-05 to 1e.06, got -1"),
            ({"sigma_mm": float("nan")}, "sigma_mm: expected .* got nan"),
            ({"tracker_um": (1.0, -1.0, 1.0, 1.0)}, "tracker_um: expected four numbers"),
            ({"fixed": ["rods"]}, 'expected a source error such as e_x .* got "rods"'),
            ({"fixed": "e_x"}, 'fixed: expected names in a list, got the text "e_x"'),
            ({"fixed": ["e_x"], "free": ["e_x2"]}, "fixed or free, got e_x of limb 2 as both"),
            ({"stage": "rough", "fixed": ["theta_offset"]}, "expected at least one error to estimate"),
            ({"limit_mm": 0.0}, "limit_mm: expected"),
        ):
            with self.assertRaisesRegex(pc.InvalidArgument, message):
                pc.calibrate(robot, measured, **keywords)
        with self.assertRaises(TypeError):
            pc.calibrate(robot, measured, sigma=0.1)

    def test_every_keyword_is_checked(self):
        robot, measured = published()
        machine = pc.calibrate(robot, measured, stage="rough", fixed=["e_x"]).known
        names = set()
        for call, first in ((pc.calibrate, (robot, measured)), (pc.validate, (machine, measured))):
            for name, one in inspect.signature(call).parameters.items():
                if "float" in one.annotation and "Iterable" not in one.annotation:
                    wrong = {"thin": TypeError, -1.0: pc.InvalidArgument, math.nan: pc.InvalidArgument}
                elif one.annotation == "str":
                    wrong = {"nonsense": pc.InvalidArgument, 1.0: TypeError}
                elif one.annotation == "bool":
                    wrong = {"no": TypeError}
                else:
                    continue
                names.add(name)
                for value, refusal in wrong.items():
                    with self.subTest(name=name, value=value), self.assertRaisesRegex(refusal, name):
                        call(*first, **{name: value})
        self.assertGreater(len(names), 15)


class Virtual(TestCase):
    @classmethod
    def setUpClass(cls):
        cls.virtual = VirtualMachine()
        cls.calibration = pc.calibrate(cls.virtual.robot, cls.virtual.measured)
        check = pc.simulate(
            pc.Machine(cls.virtual.robot, cls.virtual.truth),
            pc.validation_poses(cls.virtual.robot),
            noise_mm=0.017,
            read_rotation=True,
            rotation_noise_rad=1e-4,
            seed=2,
        )
        cls.check = check

    def test_the_truth_lies_within_U(self):
        found = self.calibration
        self.assertTrue(found.accepted)
        self.assertEqual(len(found.names), 56)
        of = [(pc.SOURCES.index(name), limb - 1) for name, limb, _ in found._native.parameters]
        truth = np.array([self.virtual.truth[limb, source] for source, limb in of])
        told = found.identified
        self.assertGreater(told.sum(), 15)
        self.assertGreater(np.mean(np.abs(found.values - truth)[told] <= found.U[told]), 0.85)
        self.same(np.array([found.errors[limb, source] for source, limb in of]), found.values)

    def test_evidence_is_that_of_the_file(self):
        found, file = self.calibration, self.calibration.as_dict()
        in_file = np.array([180.0 / np.pi if unit == "rad" else 1.0 for unit in found.units])
        self.close(found.covariance * np.outer(in_file, in_file), file["covariance"], 1e-12)
        self.close(np.sqrt(np.diag(found.covariance)), found.std, 1e-12)
        self.close(found.U * in_file, [one["U"] for one in file["parameters"]], 1e-12)
        self.assertGreater(np.max(found.U / found.std), 2.0001)  # k of Student, not 2
        self.assertEqual(found.rank, file["rank"])
        self.assertEqual(
            [one.text for one in found.null_space], [one["text"] for one in file["null_space"]]
        )
        for one in found.null_space:
            self.assertEqual(one.direction.shape, (len(found.names),))
            self.close(np.linalg.norm(one.direction), 1.0, 1e-9)
        self.same(found.data_share, [one["data_share"] for one in file["parameters"]])
        self.assertEqual(found.degrees_of_freedom, file["degrees_of_freedom"])
        residuals = found.residuals()
        self.assertEqual(len(residuals), 28)
        of = [[one["after_mm"][k] for k in range(3)] for one in file["residuals"]]
        self.same(residuals[[f"after_{axis}_mm" for axis in "xyz"]], of)
        pairs = found.correlations(0.5)
        self.assertTrue(pairs and all(abs(value) >= 0.5 for _, _, value in pairs))
        one, other, value = pairs[0]
        i, j = found.names.index(one), found.names.index(other)
        self.close(found.covariance[i, j] / (found.std[i] * found.std[j]), value, 1e-12)

    def test_tables_give_what_the_program_gives(self):
        files = [
            self.file(f"{k}.csv", text)
            for k, text in enumerate(self.virtual.measured.to_csv().values())
        ]
        robot = self.virtual.robot
        theirs = program(
            "calibrate",
            "--robot",
            robot.name,
            "--measurements",
            files[0],
            "--tolerances",
            self.file("tolerances.toml", pc.Tolerances.of(robot).to_toml()),
        )
        mine = pc.calibrate(
            robot,
            pc.read_measurements(files[0], robot=robot),
            tolerances=pc.Tolerances.read(self.folder / "tolerances.toml", robot),
        )
        self.assertEqual(json.loads(mine.to_json(TIME)), theirs)

    def test_validate_and_compensate_are_the_program(self):
        robot = self.virtual.robot
        path = self.folder / "calibration.json"
        self.calibration.save(path)
        known = pc.read_calibration(path)
        check = self.file("check.csv", next(iter(self.check.to_csv().values())))
        theirs = program(
            "validate",
            "--calibration",
            path,
            "--measurements",
            check,
            "--limit-mm",
            "0.3",
            "--limit-deg",
            "2",
        )
        measured = pc.read_measurements(check, robot=robot)
        mine = pc.validate(known, measured, limit_mm=0.3, limit_rad=np.radians(2.0))
        self.assertEqual(mine.as_dict(), theirs)
        self.assertTrue(mine.accepted, mine.reasons)
        self.assertLess(mine.after["max_abs_distance_mm"], mine.before["max_abs_distance_mm"] / 5)
        self.assertEqual([one["conformity"] for one in mine.checks][:1], ["conforming"])
        frame = mine.to_frame()
        self.same(frame["before_d_v_mm"], [one["before"]["d_v_mm"] for one in theirs["poses"]])
        self.same(frame["after_d_v_mm"], [one["after"]["d_v_mm"] for one in theirs["poses"]])
        with self.assertRaisesRegex(pc.InputFileError, "calibration.json.*rotary_delta"):
            pc.read_calibration(path, pc.robot("rotary_delta"))
        direct = pc.validate(self.calibration, measured, limit_mm=0.3)
        self.close(direct.after["max_abs_distance_mm"], mine.after["max_abs_distance_mm"], 1e-9)

        wanted = np.array(
            [[200.0, -130.0, -930.0, 0.5], [0.0, 0.0, -888.0, 0.0], [-300.0, 100.0, -850.0, -1.0]]
        )
        rows = "".join(",".join(map(repr, row)) + "\n" for row in as_printed(wanted).tolist())
        poses = self.file("wanted.csv", "x_mm,y_mm,z_mm,phi_deg\n" + rows)
        for way in ("exact", "tilt-aware", "linear"):
            theirs = program("compensate", "--calibration", path, "--poses", poses, "--way", way)
            mine = pc.compensate(known, pc.read_poses(poses)[1], way)
            self.assertTrue(mine.ok.all())
            self.same(in_deg(mine.joints), theirs["joints_deg"])
            self.same(as_printed(mine.targets), pose_rows(theirs["targets"]))
            self.same(
                mine.remaining_tilt,
                [[one["tilt_x_rad"], one["tilt_y_rad"]] for one in theirs["remaining_tilt"]],
            )
            self.same(
                as_printed(mine.U), [[*one["U_mm"], one["U_deg"]] for one in theirs["uncertainty"]]
            )

    def test_what_it_was_made_from_confirms_nothing(self):
        table = self.file("made_from.csv", next(iter(self.virtual.measured.to_csv().values())))
        measured = pc.read_measurements(table, robot=self.virtual.robot)
        calibration = pc.calibrate(self.virtual.robot, measured)
        validation = pc.validate(calibration, measured)
        self.assertIsNone(validation.accepted)
        self.assertIn("cannot confirm it", validation.reasons[-1])
        self.assertIs(pc.validate(calibration, measured, limit_mm=50.0).accepted, False)

    def test_predictions_hold_the_truth(self):
        robot = self.virtual.robot
        joints = pc.inverse(robot, pc.validation_poses(robot).poses).joints
        predicted = self.calibration.predict(joints)
        actual = pc.forward(pc.Machine(robot, self.virtual.truth), joints)
        self.assertTrue(predicted.ok.all())
        self.assertGreater(np.mean(np.abs(predicted.poses - actual.poses) <= predicted.U), 0.85)
        self.assertEqual(predicted.covariance.shape, (121, 4, 4))
        nothing = self.calibration.predict(joints[0] * np.nan)
        self.assertTrue(
            np.isnan(nothing.poses).all() and np.isnan(nothing.U).all() and not nothing.ok
        )

    def test_compensation_brings_the_machine_there(self):
        robot, wanted = self.virtual.robot, np.array([200.0, -130.0, -930.0, 0.5])
        machine = pc.Machine(robot, self.virtual.truth)
        found = pc.compensate(machine, wanted)
        self.close(pc.forward(machine, found.joints).poses, wanted, 1e-8)
        self.close(pc.inverse(machine, wanted).joints, found.joints, 1e-12)
        self.close(pc.inverse(robot, found.targets).joints, found.joints, 1e-9)
        self.assertTrue(np.isnan(found.U).all())
        bad = pc.compensate(machine, [[0, 0, -5000, 0], [np.nan, 0, -888, 0]])
        self.assertEqual(
            bad.status.tolist(),
            [pc.CompensationStatus.unreachable, pc.CompensationStatus.not_finite],
        )
        self.assertTrue(all(np.isnan(one).all() for one in bad[:4]))
        with self.assertRaisesRegex(
            pc.InvalidArgument, 'way: expected one of exact, tilt-aware, linear, got "best"'
        ):
            pc.compensate(machine, wanted, "best")
        with self.assertRaisesRegex(
            pc.InvalidArgument, "expected a Calibration or KnownMachine, got Robot"
        ):
            pc.compensate(robot, wanted)


if __name__ == "__main__":
    unittest.main()
