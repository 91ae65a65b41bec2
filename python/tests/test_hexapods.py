"""Plates with six freedoms: everything that the program does with them, with its numbers to the
bit; what is of plates that stay level says so."""

import json
import unittest

import numpy as np
from support import (
    HEXAPOD,
    SOURCE,
    TestCase,
    VirtualMachine,
    as_printed,
    in_deg,
    pose_rows,
    pose_table,
    program,
    text_shown,
)

import paracal as pc
from paracal import tolerance

TIME = 1475668800
SOURCES = ("zero", "base_x", "base_y", "base_z", "gain", "plate_x", "plate_y", "plate_z")
PROBLEM = SOURCE / "samples" / "strut_problem.toml"


class Robots(TestCase):
    def test_it_says_what_it_is(self):
        robot = pc.robot(HEXAPOD)
        self.assertTrue(robot.has_six_freedoms)
        self.assertFalse(pc.robot("huang2016").has_six_freedoms)
        self.assertEqual(robot.pose_axes, ("x", "y", "z", "tilt_x", "tilt_y", "tilt_z"))
        self.assertEqual(pc.robot("huang2016").pose_axes, ("x", "y", "z", "phi"))
        self.assertEqual((robot.limb_count, robot.joint_unit, robot.rotates), (6, "mm", False))
        self.assertEqual(robot.sources, SOURCES)
        rails = tuple("gain" if one == "arm_length" else one for one in pc.SOURCES)
        self.assertEqual(pc.robot("rotary_delta").sources, pc.SOURCES)
        self.assertEqual(pc.robot("linear_delta").sources, rails)
        self.assertEqual(pc.robot("linear_delta").units["gain"], "mm/m")
        self.assertEqual(robot.units, {**dict.fromkeys(SOURCES, "mm"), "gain": "mm/m"})
        self.assertEqual(
            list(robot.workspace.items()),
            [("radius_mm", 80.0), ("height_mm", 100.0), ("top_z_mm", 550.0)]
            + [("tilt_rad", np.radians(10.0))],
        )
        (limbs,) = robot.geometry.values()
        self.assertEqual([limb["length_at_zero_mm"] for limb in limbs], [500.0] * 6)
        self.same(limbs[0]["base_joint_mm"], [281.908, -102.606, 0.0])
        self.assertEqual(repr(robot), "<paracal.Robot hexapod: 6 limbs, joints in mm>")
        self.assertEqual(pc.robot_of_toml(robot.to_toml()).to_toml(), robot.to_toml())

    def test_it_says_what_it_commands(self):
        self.assertEqual(pc.robot("huang2016").freedoms, ("x", "y", "z", "phi"))
        self.assertEqual(pc.robot("rotary_delta").freedoms, ("x", "y", "z"))
        self.assertEqual(pc.robot(HEXAPOD).freedoms, pc.robot(HEXAPOD).pose_axes)
        five_bar = pc.robot_of_toml(pc.robot_template("five-bar"))
        self.assertEqual((five_bar.freedoms, five_bar.limb_count), (("x", "y"), 2))
        self.assertFalse(five_bar.has_six_freedoms or five_bar.commands_tilt)
        turning = pc.robot_of_toml(pc.robot_template("3-rrr"))
        self.assertEqual(turning.freedoms, ("x", "y", "tilt_z"))
        self.assertTrue(turning.commands_tilt and not turning.has_six_freedoms)
        self.assertEqual(turning.pose_axes, pc.robot(HEXAPOD).pose_axes)

    def test_a_template_is_a_robot(self):
        text = pc.robot_template("hexapod")
        self.assertEqual(text, HEXAPOD.read_text(encoding="utf-8"))
        self.assertEqual(pc.robot_of_toml(text).to_toml(), pc.robot(HEXAPOD).to_toml())
        with self.assertRaisesRegex(pc.InvalidArgument, "hexapod.*got.*octopod"):
            pc.robot_template("octopod")

    def test_errors_have_the_names_of_the_robot(self):
        robot = pc.robot(HEXAPOD)
        errors = robot.errors(zero=0.1, gain=[1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
        self.assertEqual(errors.shape, (6, 8))
        self.same(errors[:, 0], [0.1] * 6)
        self.same(errors[:, 4], [1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
        self.same(pc.Machine(robot, errors).errors, errors)
        self.assertEqual(
            list(pc.errors_frame(robot, errors))[3:6], ["base_z_mm", "gain_mm_per_m", "plate_x_mm"]
        )
        path = self.file("errors.toml", pc.errors_toml(robot, errors))
        self.assertIn("gain_mm_per_m = 6", path.read_text(encoding="utf-8"))
        self.same(pc.read_errors(robot, path), errors)
        with self.assertRaisesRegex(
            pc.InvalidArgument, "names of zero, base_x.*plate_z, got theta_offset"
        ):
            robot.errors(theta_offset=0.1)
        with self.assertRaisesRegex(pc.InvalidArgument, r"errors: .* of shape \(\.\.\., 8\)"):
            pc.Machine(robot, np.zeros((6, 14)))
        self.assertEqual(pc.draw_errors(robot, 3).shape, (3, 6, 8))

    def test_tolerances_are_its_own(self):
        robot = pc.robot(HEXAPOD)
        mine = pc.Tolerances.of(robot)
        self.assertEqual(mine.half_widths["gain"], 1.5)
        self.assertEqual(list(mine.half_widths), list(SOURCES))
        self.close(mine.std["plate_z"], 1.0 / 3.0, 1e-15)
        self.assertEqual(mine.to_frame()["half_width"]["gain"], 1.5)
        self.assertEqual(mine.to_frame()["unit"].to_dict(), robot.units)
        again = pc.Tolerances.read(self.file("tolerances.toml", mine.to_toml()), robot)
        self.assertEqual(again.half_widths, mine.half_widths)
        stated = pc.Tolerances.stated(robot, {"gain": 0.5})
        self.assertEqual({k: v for k, v in stated.half_widths.items() if v}, {"gain": 0.5})
        of_another = pc.Tolerances.of(pc.robot("huang2016"))
        for call in (
            lambda: pc.draw_errors(robot, tolerances=of_another),
            lambda: pc.select_poses(robot, 8, candidates=50, tolerances=of_another),
            lambda: tolerance.analyze(robot, of_another),
            lambda: tolerance.allocate(robot, problem=PROBLEM, rest=of_another),
            lambda: tolerance.sensitivity(robot, tolerances=of_another),
        ):
            with self.assertRaisesRegex(
                pc.InvalidArgument, "expected tolerances of hexapod, got those of huang2016"
            ):
                call()


class Tables(TestCase):
    def test_poses_are_as_wide_as_the_robot_takes(self):
        robot, level = pc.robot(HEXAPOD), pc.robot("huang2016")
        poses = np.array([[1.0, 2.0, 500.0, 0.1, 0.2, 0.3], [0.0, 0.0, 510.0, 0.0, 0.0, 0.0]])
        tilted = self.file("tilted.csv", pose_table(robot, poses))
        self.close(pc.read_poses(tilted, robot)[1], poses, 1e-15)
        self.close(pc.read_poses(tilted)[1], poses, 1e-15)  # that nobody says, but it tilts
        plain = self.file("plain.csv", "x_mm,y_mm,z_mm\n1,2,500\n")
        self.same(pc.read_poses(plain, robot)[1], [[1.0, 2.0, 500.0, 0.0, 0.0, 0.0]])
        self.same(pc.read_poses(plain)[1], [[1.0, 2.0, 500.0, 0.0]])
        with self.assertRaisesRegex(pc.InvalidArgument, "pose 1: expected no tilt, because the plate stays level"):
            pc.read_poses(tilted, level)
        turned = self.file("turned.csv", "pose,x_mm,y_mm,z_mm,phi_deg\nA,1,2,500,3\n")
        with self.assertRaisesRegex(pc.InvalidArgument, "pose A: expected phi = 0, because tilt_z rotates the plate"):
            pc.read_poses(turned, robot)
        self.same(pc.simulate(robot, plain).poses, [[1.0, 2.0, 500.0, 0.0, 0.0, 0.0]])
        named = self.file("named.csv", f"# robot: {HEXAPOD}\nx_mm,y_mm,z_mm\n1,2,500\n")
        self.same(pc.read_poses(named)[1], [[1.0, 2.0, 500.0, 0.0, 0.0, 0.0]])
        with self.assertRaisesRegex(pc.InputFileError, "named.csv:1: .*hexapod"):
            pc.read_poses(named, level)

    def test_what_forward_prints_is_read_again(self):
        robot = pc.robot(HEXAPOD)
        printed = self.file(
            "printed.csv", "x_mm,y_mm,z_mm,tilt_x_rad,tilt_y_rad,tilt_z_rad\n1,2,500,0.1,0.2,0.3\n"
        )
        self.same(pc.read_poses(printed, robot)[1], [[1.0, 2.0, 500.0, 0.1, 0.2, 0.3]])

    def test_plans_and_measurements_become_tables(self):
        robot = pc.robot(HEXAPOD)
        plan = pc.select_poses(robot, 8, candidates=50, measure="pose")
        columns = [f"{axis}_cmd_mm" for axis in "xyz"] + [f"tilt_{axis}_cmd_deg" for axis in "xyz"]
        self.assertEqual(list(plan.to_frame()), ["pose", *columns])
        plan.to_csv(self.folder / "plan.csv")
        for table in (plan.to_frame(), self.folder / "plan.csv"):
            self.close(pc.read_poses(table, robot)[1], plan.poses, 1e-15)
        measured = pc.simulate(robot, plan, measure="pose", noise_mm=0.1)
        self.assertEqual(measured.counts, {"points": 8})
        self.same(measured.poses, plan.poses)
        frame = measured.to_frame()
        again = pc.read_measurements(frame, robot=robot)
        self.same(again.to_frame()["qw"], frame["qw"])
        self.same(again.poses, measured.poses)
        self.same(pc.read_measurements(frame).poses, measured.poses)
        self.assertEqual(list(measured.to_csv()), ["poses", "poses 2"])  # readings, then stations
        both = pc.merge([measured, pc.simulate(robot, plan, noise_mm=0.1, seed=2)])
        self.assertEqual(both.counts, {"points": 16})
        self.same(both.poses, plan.poses)


class Plans(TestCase):
    def test_selected_poses_are_the_programs(self):
        robot = pc.robot(HEXAPOD)
        for measure in ("pose", "coordinates", "home-distance"):
            theirs = program(
                *("poses", "--robot", HEXAPOD, "--optimal", 8, "--candidates", 60),
                *("--measure", measure),
            )
            plan = pc.select_poses(robot, 8, candidates=60, measure=measure)
            self.same(as_printed(plan.poses), pose_rows(theirs["poses"], robot.pose_axes))
            self.assertEqual(plan.names, [one["pose"] for one in theirs["poses"]])
            self.same(plan.details["value"], theirs["value"])
            self.same(plan.details["travel"], theirs["travel_mm"])
            mine = plan.details["workspace_std"]
            self.same(mine["max_aligned_mm"], theirs["workspace_std"]["max_aligned_mm"])
            self.same(
                in_deg(mine["max_rotation_rad"]), theirs["workspace_std"]["max_rotation_deg"]
            )
            self.assertGreater(np.abs(plan.poses[:, 3:]).max(), 0.1)

    def test_identifiability_is_the_programs(self):
        robot = pc.robot(HEXAPOD)
        plan = pc.select_poses(robot, 14, candidates=60, measure="pose")
        path = self.folder / "plan.csv"
        plan.to_csv(path)
        for keywords, options in (
            ({"measure": "pose"}, ["--measure", "pose"]),
            (
                {"measure": "pose", "frame": "robot", "body": "plate"},
                ["--measure", "pose", "--frame", "robot", "--body", "plate"],
            ),
            ({}, []),
        ):
            theirs = program("identifiability", "--robot", HEXAPOD, "--poses", path, *options)
            mine = pc.identifiability(robot, path, **keywords)
            self.assertEqual((mine.rank, mine.rows), (theirs["rank"], theirs["rows"]))
            self.same(mine.singular_values, theirs["singular_values"])
            self.assertEqual(
                [one.text for one in mine.null_space], [one["text"] for one in theirs["null_space"]]
            )
            self.assertEqual(mine.units, [one["unit"] for one in theirs["parameters"]])
            self.same(mine.std, [one["std"] for one in theirs["parameters"]])
            self.same(mine.prior_std, [one["prior_std"] for one in theirs["parameters"]])
            self.assertEqual(mine.names[:5], [f"{name}.1" for name in SOURCES[:5]])
        self.same(
            pc.identifiability(robot, plan, measure="pose").rank,
            pc.identifiability(robot, plan.poses, measure="pose").rank,
        )

    def test_the_workspace_is_tilted_all_ways(self):
        robot = pc.robot(HEXAPOD)
        still, turned = pc.validation_poses(robot), pc.workspace_poses(robot)
        self.same(still.poses[:, :3], turned.poses[:, :3])
        self.assertFalse(still.poses[:, 3:].any())
        for axis in (3, 4, 5):
            self.assertEqual(
                sorted(set(turned.poses[:, axis])),
                [-robot.workspace["tilt_rad"], 0.0, robot.workspace["tilt_rad"]],
            )


class Calibrated(TestCase):
    """A virtual machine as motion capture reads it: in Python, and by the program from the same
    tables."""

    @classmethod
    def setUpClass(cls):
        cls.virtual = VirtualMachine(HEXAPOD, poses=20, measure="pose")
        cls.robot = cls.virtual.robot
        cls.calibration = pc.calibrate(cls.robot, cls.virtual.measured)
        cls.check = pc.simulate(
            pc.Machine(cls.robot, cls.virtual.truth),
            pc.workspace_poses(cls.robot).poses[:30],
            measure="pose",
            noise_mm=0.017,
            rotation_noise_rad=1e-4,
            repeats=2,
            seed=2,
        )

    def table(self, name, measured):
        return self.file(name, next(iter(measured.to_csv(self.robot).values())))

    def test_readings_are_the_programs(self):
        errors = self.file("truth.toml", pc.errors_toml(self.robot, self.virtual.truth))
        path = self.folder / "plan.csv"
        self.virtual.plan.to_csv(path)
        theirs = program(
            *("simulate", "--robot", HEXAPOD, "--errors", errors, "--poses", path, "--seed", 3),
            *("--measure", "pose", "--noise-mm", "0.02", "--repeats", 2),
        )["points"]
        machine = pc.Machine(self.robot, pc.read_errors(self.robot, errors))
        mine = pc.simulate(machine, path, measure="pose", noise_mm=0.02, repeats=2, seed=3)
        for column in ("x_mm", "y_mm", "z_mm", "qw", "qx", "qy", "qz"):
            self.same(mine.to_frame()[column], [one[column] for one in theirs])

    def test_the_file_is_what_the_program_writes(self):
        table = self.table("measured.csv", self.virtual.measured)
        for keywords, options in (
            ({}, []),
            ({"frame": "robot", "sigma_mm": 0.05}, ["--frame", "robot", "--sigma-mm", "0.05"]),
            (
                {"fixed": ["gain.2"], "free": ["zero.1"], "limit_mm": 0.5, "limit_rad": 0.01},
                ["--fix", "gain2", "--free", "zero1", "--limit-mm", "0.5"]
                + ["--limit-deg", repr(float(np.degrees(0.01)))],
            ),
        ):
            theirs = program("calibrate", "--robot", HEXAPOD, "--measurements", table, *options)
            mine = pc.calibrate(
                self.robot, pc.read_measurements(table, robot=self.robot), **keywords
            )
            self.assertEqual(json.loads(mine.to_json(TIME)), theirs)
            parameters = [one for one in theirs["parameters"] if one["status"] != "fixed"]
            self.assertEqual(mine.units, [one["unit"] for one in parameters])
            self.same(mine.values, [one["value"] for one in parameters])
            self.same(mine.U, [one["U"] for one in parameters])

    def test_the_truth_lies_within_U(self):
        found = self.calibration
        self.assertTrue(found.accepted, found.reasons)
        self.assertEqual(len(found.names), 48)
        self.assertEqual(found.errors.shape, (6, 8))
        self.same(found.errors.ravel(), found.values)
        share = np.mean(np.abs(found.values - self.virtual.truth.ravel()) <= found.U)
        self.assertGreater(share, 0.85)
        self.assertEqual(found.to_frame()["unit"]["gain.3"], "mm/m")
        self.assertEqual(sum(one.gauge for one in found.null_space), 12)

    def test_validations_and_predictions_are_the_programs(self):
        path, table = self.folder / "calibration.json", self.table("check.csv", self.check)
        self.calibration.save(path)
        known, measured = pc.read_calibration(path), pc.read_measurements(table, robot=self.robot)
        theirs = program(
            *("validate", "--calibration", path, "--measurements", table),
            *("--limit-mm", "1", "--limit-deg", "2"),
        )
        mine = pc.validate(known, measured, limit_mm=1.0, limit_rad=np.radians(2.0))
        self.assertEqual(mine.as_dict(), theirs)
        self.assertTrue(mine.accepted, mine.reasons)
        self.assertEqual(len(mine.to_frame()), 30)
        U = known.predict(pc.inverse(self.robot, self.check.poses).joints).U
        rounding = 1e-12  # validate() starts to look for the plate at the commanded pose
        self.close(U[:, :3], [one["predicted_U_mm"] for one in theirs["poses"]], rounding)
        self.close(in_deg(U[:, 3:]), [one["predicted_U_tilt_deg"] for one in theirs["poses"]], rounding)
        self.assertFalse(any("predicted_U_deg" in one for one in theirs["poses"]))

    def test_compensation_is_the_programs(self):
        path = self.folder / "calibration.json"
        self.calibration.save(path)
        known = pc.read_calibration(path)
        poses = self.file("wanted.csv", pose_table(self.robot, self.check.poses))
        theirs = program("compensate", "--calibration", path, "--poses", poses)
        mine = pc.compensate(known, pc.read_poses(poses, self.robot)[1])
        self.assertTrue(mine.ok.all())
        self.same(mine.joints, theirs["joints_mm"])
        self.same(as_printed(mine.targets), pose_rows(theirs["targets"], self.robot.pose_axes))
        self.same(
            as_printed(mine.U),
            [[*one["U_mm"], *one["U_tilt_deg"]] for one in theirs["uncertainty"]],
        )
        self.assertFalse(mine.remaining_tilt.any())

    def test_results_show_themselves(self):
        robot, plan = self.robot, self.virtual.plan
        shown = " ".join(text_shown(robot).split())
        self.assertIn("limb kind base_joint_mm plate_joint_mm length_at_zero_mm 1 strut", shown)
        self.assertIn("tilt_rad 0.1745", text_shown(robot))
        self.assertIn("z, mm tilt_x, deg tilt_y, deg", text_shown(plan))
        seen = pc.identifiability(robot, plan, measure="pose")
        self.assertIn("the plate's joints rotate about x", text_shown(seen))
        self.assertIn("gain.6", text_shown(seen))
        calibration = text_shown(self.calibration)
        for part in ("hexapod: accepted", "gain", "mm/m", "plate_z"):
            self.assertIn(part, calibration)
        self.assertIn("gain 1.5 mm/m", text_shown(pc.Tolerances.of(robot)))
        self.assertIn("plate_z", text_shown(tolerance.sensitivity(robot, relative_error=0.1)))
        self.assertIn("optimal", text_shown(tolerance.allocate(robot, problem=PROBLEM)))
        self.assertIn("base_z", text_shown(tolerance.analyze(robot, sigma_error=0.2, failure_error=0.5)))
        self.assertIn("points 40", text_shown(self.virtual.measured))

    def test_predictions_hold_the_truth(self):
        joints = pc.inverse(self.robot, pc.workspace_poses(self.robot).poses).joints
        predicted = self.calibration.predict(joints)
        actual = pc.forward(pc.Machine(self.robot, self.virtual.truth), joints)
        self.assertTrue(predicted.ok.all())
        self.assertEqual(predicted.covariance.shape, (121, 6, 6))
        self.close(predicted.covariance, np.swapaxes(predicted.covariance, -1, -2), 1e-12)
        off = np.abs(predicted.poses - actual.poses)
        # Of one machine, whose numbers go together.
        self.assertGreater(np.mean(off <= predicted.U), 0.75)
        # By the exact Jacobian, from the covariance of the errors.
        known = self.calibration.known
        jacobian = pc.jacobian(self.calibration, joints[5]).errors.reshape(6, -1)
        spread = np.sqrt(np.diag(jacobian @ known.covariance @ jacobian.T))
        self.assertTrue((predicted.U[5] >= 2.0 * spread * (1 - 1e-9)).all())
        self.assertTrue((predicted.U[5] <= 6.0 * spread).all())  # drives that may be uneven, and visits
        nothing = self.calibration.predict(joints[0] * np.nan)
        self.assertTrue(np.isnan(nothing.poses).all() and not nothing.ok)

    def test_compensation_brings_the_machine_there(self):
        machine = pc.Machine(self.robot, self.virtual.truth)
        wanted = np.array([10.0, 20.0, 510.0, 0.05, -0.1, 0.15])
        found = pc.compensate(machine, wanted)
        self.close(pc.forward(machine, found.joints).poses, wanted, 1e-8)
        self.close(pc.inverse(self.robot, found.targets).joints, found.joints, 1e-8)
        self.assertTrue(np.isnan(found.U).all())
        bad = pc.compensate(machine, [wanted * np.nan, wanted + [0, 0, 0, 0, np.inf, 0], wanted])
        self.assertEqual(bad.status.tolist(), [pc.CompensationStatus.not_finite] * 2 + [0])
        self.assertTrue(all(np.isnan(one[:2]).all() for one in bad[:4]))
        self.same(bad.joints[2], found.joints)
        # The machine gets there, but its joints are none of the nominal robot's.
        far_off = pc.Machine(self.robot, self.robot.errors(zero=[450.0, 0, 0, 0, 0, 0]))
        self.assertTrue(pc.inverse(far_off, wanted).ok)
        untold = pc.compensate(far_off, wanted)
        self.assertEqual(untold.status, pc.CompensationStatus.singular)
        self.assertTrue(np.isnan(untold.joints).all())


class Tolerances(TestCase):
    def test_an_analysis_is_the_programs(self):
        robot = pc.robot(HEXAPOD)
        for keywords, options in (
            ({"requirements": {"tilt": 0.01}}, ["--max-tilt", "0.01"]),
            ({"problem": PROBLEM}, ["--problem", PROBLEM]),
            (
                {"requirements": {"tilt": 0.01}, "model": "exact", "max_machines": 64},
                ["--max-tilt", "0.01", "--model", "exact", "--max-machines", "64"],
            ),
        ):
            theirs = program(
                "tolerance", "analyze", "--robot", HEXAPOD, *("--sigma-error", "0.1", "--failure-error", "0.5"), *options
            )
            mine = tolerance.analyze(robot, sigma_error=0.1, failure_error=0.5, **keywords)
            self.assertEqual(mine.machines, theirs["machines"])
            self.assertEqual(mine.yield_, theirs["yield"]["value"])
            self.assertEqual(len(mine.requirements), len(theirs["requirements"]))
            for one, other in zip(mine.requirements, theirs["requirements"]):
                for key in ("limit", "worst_case", "rss_3sigma", "monte_carlo_3sigma", "cpk"):
                    self.same(one[key], other[key])
                for key in ("worst_case_pose", "rss_pose", "monte_carlo_pose"):
                    self.same(as_printed(one[key]), pose_rows([other[key]], robot.pose_axes)[0])
                self.assertEqual(
                    one["contributors"],
                    [(part["name"], part["share"]) for part in other["contributors"]],
                )

    def test_an_allocation_is_the_programs(self):
        robot = pc.robot(HEXAPOD)
        theirs = program("tolerance", "allocate", "--robot", HEXAPOD, "--problem", PROBLEM)
        mine = tolerance.allocate(robot, problem=PROBLEM)
        self.assertEqual((mine.status, mine.cost), (theirs["status"], theirs["cost"]))
        half = mine.tolerances.half_widths
        for key, name in (("zero_mm", "zero"), ("gain_mm_per_m", "gain"), ("plate_mm", "plate_y")):
            self.close(half[name], theirs["half_widths"][key], 1e-12)
        for one, other in zip(mine.requirements, theirs["requirements"]):
            unit = "mm" if one["quantity"] == "position" else "rad"
            self.same(one["worst"], other[f"worst_{unit}"])
            self.same(
                as_printed(one["worst_pose"]), pose_rows([other["worst_pose"]], robot.pose_axes)[0]
            )

    def test_sensitivities_are_the_programs(self):
        robot = pc.robot(HEXAPOD)
        for quantity, unit in (("tilt", "rad"), ("position", "mm")):
            theirs = program(
                *("sensitivity", "--robot", HEXAPOD, "--quantity", quantity, "--error", "0.1")
            )
            mine = tolerance.sensitivity(robot, quantity, relative_error=0.1)
            self.assertEqual(
                (mine.mean, mine.error, mine.largest),
                (theirs["global"], theirs["global_error"], theirs["largest"]),
            )
            self.assertEqual(mine.in_paper_units, mine.mean)
            self.assertEqual(mine.worst_3sigma, theirs["worst"][f"three_sigma_{quantity}_{unit}"])
            self.same(
                as_printed(mine.worst_pose), pose_rows([theirs["worst"]], robot.pose_axes)[0]
            )
            self.assertEqual(
                mine.contributors, [(one["name"], one["share"]) for one in theirs["contributors"]]
            )
            self.assertEqual(list(mine.to_frame().index), list(SOURCES))


class EveryTemplate(TestCase):
    """Robots on limbs with one rod, which are a file alone, whatever these hang on."""

    def each(self):
        for path in sorted(HEXAPOD.parent.glob("*.toml")):
            robot = pc.robot(path)
            if "limb" not in robot.geometry:
                continue
            with self.subTest(path.stem):
                yield path, robot

    def test_kinematics_are_the_programs(self):
        for path, robot in self.each():
            poses = pc.workspace_poses(robot).poses[:40]
            errors = pc.draw_errors(robot, 1)[0]
            self.assertEqual(errors.shape, (robot.limb_count, len(robot.sources)))
            stated = self.file("errors.toml", pc.errors_toml(robot, errors))
            machine = pc.Machine(robot, pc.read_errors(robot, stated))
            table = self.file("poses.csv", pose_table(robot, poses))
            theirs = program("inverse", "--robot", path, "--errors", stated, "--poses", table)
            mine = pc.inverse(machine, pc.read_poses(table, robot)[1]).joints
            in_mm = robot.joint_unit == "mm"
            printed = theirs["joints_mm" if in_mm else "joints_deg"]
            self.same(mine if in_mm else in_deg(mine), printed)
            self.close(pc.forward(machine, mine).poses, poses, 1e-8)

    def test_calibrations_are_the_programs(self):
        for path, robot in self.each():
            virtual = VirtualMachine(path, poses=20, measure="pose")
            table = self.file("m.csv", next(iter(virtual.measured.to_csv(robot).values())))
            theirs = program("calibrate", "--robot", path, "--measurements", table)
            found = pc.calibrate(robot, pc.read_measurements(table, robot=robot))
            self.assertEqual(json.loads(found.to_json(TIME)), theirs)
            limbs = robot.limb_count
            self.assertEqual(found.errors.shape, (limbs, len(robot.sources)))
            self.assertEqual(found.units, [robot.units[one] for one in robot.sources] * limbs)
            share = np.mean(np.abs(found.values - virtual.truth.ravel()) <= found.U)
            self.assertGreater(share, 0.85)


class Level(TestCase):
    """What is of plates that stay level."""

    def test_it_says_so(self):
        robot = pc.robot(HEXAPOD)
        machine, home = pc.Machine(robot), [[0, 0, 500, 0, 0, 0]]
        for call, message in (
            (lambda: pc.paper_plan(robot), "poses by stage: .*keep level, got hexapod"),
            (lambda: tolerance.allocate(robot), "equal influence: .*keep level, got hexapod"),
            (lambda: pc.compensate(machine, home, "linear"), "way: expected exact"),
            (lambda: pc.compensate(machine, home, "tilt-aware"), "way: expected exact"),
            (
                lambda: tolerance.sensitivity(robot, "position-compensated"),
                "position-compensated: expected a robot whose plate",
            ),
            (
                lambda: tolerance.analyze(robot, requirements={"tilt-compensated": 1e-3}),
                "tilt-compensated: expected a robot whose plate",
            ),
            (lambda: tolerance.sensitivity(robot, "rotation"), "expected a robot with a slide"),
        ):
            with self.assertRaisesRegex(pc.InvalidArgument, message):
                call()

    def test_poses_of_other_robots_are_refused(self):
        robot, level = pc.robot(HEXAPOD), pc.robot("huang2016")
        other = pc.validation_poses(level)
        for call in (
            lambda: pc.identifiability(robot, other),
            lambda: pc.simulate(robot, other),
            lambda: pc.simulate(robot, other.poses),
            lambda: tolerance.analyze(robot, poses=other.poses),
            lambda: pc.compensate(pc.Machine(robot), other.poses),
        ):
            with self.assertRaisesRegex(pc.InvalidArgument, r", 6\).*got \(121, 4\)"):
                call()
        with self.assertRaisesRegex(pc.InvalidArgument, r", 4\).*got \(121, 6\)"):
            pc.simulate(level, pc.validation_poses(robot))


if __name__ == "__main__":
    unittest.main()
