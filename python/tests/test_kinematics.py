"""Inverse, forward and Jacobian over arrays: against the program, against single calls, and at
their edges."""

import unittest

import numpy as np
from pandas import DataFrame
from support import (
    FIVE_BAR,
    HEXAPOD,
    SCREW_DELTA,
    TestCase,
    as_printed,
    in_deg,
    pose_rows,
    pose_table,
    program,
)

import paracal as pc
from paracal import _paracal

ROBOTS = ("huang2016", "rotary_delta", "linear_delta", HEXAPOD, FIVE_BAR)


def some_poses(robot, count=40):
    """Within the workspace, home among them."""
    space, random = robot.workspace, np.random.default_rng(1)
    radius, azimuth = (
        space["radius_mm"] * np.sqrt(random.random(count)),
        random.random(count) * 2 * np.pi,
    )
    tilt = space.get("tilt_rad", 0.0)
    turns = [(-tilt, tilt)] * 3 if robot.commands_tilt else [space["rotation_rad"]]
    return np.stack(
        [
            radius * np.cos(azimuth),
            radius * np.sin(azimuth),
            space["top_z_mm"] - space["height_mm"] * random.random(count),
            *(low + (high - low) * random.random(count) for low, high in turns),
        ],
        axis=-1,
    )


def as_built(robot):
    return pc.Machine(robot, pc.draw_errors(robot, seed=3))


def known_exactly(robot):
    return pc.KnownMachine(_paracal.exactly_known(as_built(robot)._native))


class AgainstTheProgram(TestCase):
    def tables(self, robot):
        """A pose table, a joint table and errors in files, and what they say."""
        poses = self.file("poses.csv", pose_table(robot, some_poses(robot)))
        errors = self.file("errors.toml", pc.errors_toml(robot, pc.draw_errors(robot, seed=3)))
        return poses, errors

    def test_inverse_and_forward_are_the_same_to_the_bit(self):
        for name in ROBOTS:
            robot = pc.robot(name)
            poses, errors = self.tables(robot)
            machine = pc.Machine(robot, pc.read_errors(robot, errors))
            joints, status = pc.inverse(machine, pc.read_poses(poses, robot)[1])
            self.assertFalse(status.any())
            theirs = program("inverse", "--robot", name, "--errors", errors, "--poses", poses)
            unit = "joints_deg" if robot.joint_unit == "rad" else "joints_mm"
            self.same(in_deg(joints) if robot.joint_unit == "rad" else joints, theirs[unit])

            head = ",".join(f"q{k + 1}_{unit[7:]}" for k in range(robot.limb_count))
            table = self.file(
                "joints.csv",
                head + "\n" + "".join(",".join(map(repr, row)) + "\n" for row in theirs[unit]),
            )
            found = pc.forward(machine, pc.read_joints(table, robot)[1])
            plates = program("forward", "--robot", name, "--errors", errors, "--joints", table)[
                "poses"
            ]
            self.same(as_printed(found.poses)[:, :3], pose_rows(plates)[:, :3])
            if robot.commands_tilt:
                self.same(found.poses[:, 3:], found.tilt)
            else:
                self.same(as_printed(found.poses), pose_rows(plates))
            self.same(found.tilt, [[one[f"tilt_{axis}_rad"] for axis in "xyz"] for one in plates])
            self.same(found.residual, [one["residual_mm"] for one in plates])
            self.same(found.iterations, [one["iterations"] for one in plates])

    def test_the_derivatives_of_six_freedoms_are_the_programs(self):
        robot = pc.robot(HEXAPOD)
        pose = np.array([10.0, 20.0, 510.0, *np.radians([3.0, 4.0, 5.0])])
        theirs = program("error-model", "--robot", HEXAPOD, "--pose", "10,20,510,3,4,5")
        mine = pc.jacobian(robot, pc.inverse(robot, pose).joints).errors.reshape(6, -1)
        self.close(mine[:3], theirs["G_position"], 1e-9)
        axes = turning_axes(pose[3:])
        self.close(axes @ mine[3:], theirs["G_turn"], 1e-12)
        self.assertEqual(
            [one["name"] for one in theirs["parameters"]["position"]], list(robot.sources) * 6
        )


def turning_axes(tilt):
    """Axes about which tilt_x, tilt_y, tilt_z turn a plate with R = Rot(x) Rot(y) Rot(z), as
    columns, in the robot's frame."""
    (sa, sb, _), (ca, cb, _) = np.sin(tilt), np.cos(tilt)
    return np.array([[1.0, 0.0, sb], [0.0, ca, -sa * cb], [0.0, sa, ca * cb]])


class Arrays(TestCase):
    def test_forward_undoes_inverse(self):
        for name in ROBOTS:
            machine = as_built(pc.robot(name))
            poses = some_poses(machine.robot)
            inverse = pc.inverse(machine, poses)
            self.assertTrue(inverse.ok.all())
            forward = pc.forward(machine, inverse.joints)
            self.assertTrue(forward.ok.all())
            self.close(forward.poses, poses, 1e-8)

    def test_a_controller_knows_the_nominal_robot(self):
        for name in ROBOTS:
            robot = pc.robot(name)
            machine, poses = as_built(robot), some_poses(robot).reshape(2, 20, -1)
            driven = pc.drive(machine, poses)
            joints = pc.inverse(robot, poses).joints
            found = pc.forward(machine, joints)
            self.close(driven.poses, found.poses, 1e-8)
            self.close(driven.tilt, found.tilt, 1e-10)
            self.assertTrue(driven.ok.all() and driven.ok.shape == (2, 20))
            self.assertGreater(np.abs(driven.poses - poses).max(), 1e-2)
            self.close(pc.drive(robot, poses).poses, poses, 1e-8)
            lost = pc.drive(machine, poses * np.nan)
            self.assertTrue(np.isnan(lost.poses).all() and np.isnan(lost.tilt).all())
            self.assertFalse(lost.ok.any())

    def test_of_two_ways_to_stand_the_commanded_is_meant(self):
        robot = pc.robot(HEXAPOD)
        pose = [40.0, -30.0, 480.0, np.radians(-70.0), 0.0, 0.0]
        elsewhere = pc.forward(robot, pc.inverse(robot, pose).joints)
        self.assertTrue(elsewhere.ok)
        self.assertGreater(np.abs(elsewhere.poses - pose).max(), 1.0)
        self.close(pc.drive(robot, pose).poses, pose, 1e-8)

    def test_any_shape_is_as_single_calls(self):
        self.shapes_of(pc.robot("huang2016"), 7, 14)
        self.shapes_of(pc.robot(HEXAPOD), 6, 8)

    def shapes_of(self, robot, rows, sources):
        machine = as_built(robot)
        limbs, width = robot.limb_count, len(robot.pose_axes)
        poses = some_poses(robot, 6).reshape(2, 3, width)
        inverse = pc.inverse(machine, poses)
        forward, jacobian = pc.forward(machine, inverse.joints), pc.jacobian(
            machine, inverse.joints
        )
        self.assertEqual(inverse.joints.shape, (2, 3, limbs))
        self.assertEqual(inverse.status.shape, (2, 3))
        self.assertEqual(forward.poses.shape, (2, 3, width))
        self.assertEqual(forward.tilt.shape, (2, 3, 3))
        self.assertEqual(jacobian.joints.shape, (2, 3, rows, limbs))
        self.assertEqual(jacobian.errors.shape, (2, 3, rows, limbs, sources))
        for place in np.ndindex(2, 3):
            joints, status = pc.inverse(machine, poses[place])
            self.assertEqual(status.shape, ())
            self.same(joints, inverse.joints[place])
            for one, all_of in zip(pc.forward(machine, joints), forward):
                self.same(one, all_of[place])
            self.same(pc.jacobian(machine, joints).errors, jacobian.errors[place])

    def test_neither_order_nor_kind_of_numbers_matters(self):
        robot = pc.robot("huang2016")
        poses = np.round(some_poses(robot, 8))
        joints = pc.inverse(robot, poses).joints
        for other in (
            np.asfortranarray(poses),
            np.repeat(poses, 2, axis=0)[::2],
            poses.tolist(),
            poses.astype(np.float32),
            poses.astype(np.int64),
            poses.astype(">f8"),
        ):
            self.same(pc.inverse(robot, other).joints, joints)
        self.same(
            pc.inverse(robot, poses[:, :3]).joints, pc.inverse(robot, poses * [1, 1, 1, 0]).joints
        )
        hexapod = pc.robot(HEXAPOD)
        level = some_poses(hexapod, 8) * [1, 1, 1, 0, 0, 0]
        self.same(pc.inverse(hexapod, level[:, :3]).joints, pc.inverse(hexapod, level).joints)

    def test_a_robot_stands_for_its_nominal_machine(self):
        robot = pc.robot("rotary_delta")
        poses = some_poses(robot, 5)
        self.same(pc.inverse(robot, poses).joints, pc.inverse(pc.Machine(robot), poses).joints)
        with self.assertRaisesRegex(
            pc.InvalidArgument, "expected a Robot, Machine, Calibration.*got str"
        ):
            pc.inverse("rotary_delta", poses)

    def test_nothing_in_is_nothing_out(self):
        robot = pc.robot("huang2016")
        self.assertEqual(pc.inverse(robot, np.zeros((0, 4))).joints.shape, (0, 4))
        self.assertEqual(pc.forward(robot, np.zeros((0, 4))).poses.shape, (0, 4))
        self.assertEqual(pc.jacobian(robot, np.zeros((0, 4))).errors.shape, (0, 7, 4, 14))


class Statuses(TestCase):
    def test_poses_out_of_reach_are_nan_with_a_status(self):
        robot = pc.robot("huang2016")
        far, nan, good = [0, 0, -5000, 0], [np.nan, 0, -888, 0], [0, 0, -888, 0]
        found = pc.inverse(robot, [far, good, nan])
        self.assertEqual(
            found.status.tolist(),
            [pc.InverseStatus.unreachable, pc.InverseStatus.reached, pc.InverseStatus.unreachable],
        )
        self.assertEqual(found.ok.tolist(), [False, True, False])
        self.assertEqual(np.isnan(found.joints).all(axis=1).tolist(), [True, False, True])
        self.assertFalse(np.isnan(found.joints[1]).any())

    def test_a_rigid_plate_does_not_turn(self):
        found = pc.inverse(pc.robot("rotary_delta"), [0, 0, -900, 0.1])
        self.assertEqual(found.status, pc.InverseStatus.unreachable)
        self.assertTrue(np.isnan(found.joints).all())

    def test_joints_that_hold_no_plate_are_nan_with_a_status(self):
        robot = pc.robot("huang2016")
        good = pc.inverse(robot, [0, 0, -888, 0]).joints
        found = pc.forward(robot, [good, good * np.nan, good + [1.0, 0, 0, 0]])
        self.assertEqual(found.status[0], pc.ForwardStatus.converged)
        self.assertEqual(found.status[1], pc.ForwardStatus.not_converged)
        self.assertEqual(found.ok.tolist()[:2], [True, False])
        self.assertTrue(np.isnan(found.poses[1]).all() and np.isnan(found.tilt[1]).all())
        jacobian = pc.jacobian(robot, [good, good * np.nan])
        self.assertEqual(jacobian.ok.tolist(), [True, False])
        self.assertTrue(
            np.isnan(jacobian.errors[1]).all() and not np.isnan(jacobian.errors[0]).any()
        )

    def test_struts_that_hold_no_plate_are_nan_with_a_status(self):
        robot = pc.robot(HEXAPOD)
        apart = [300.0, -300.0, 300.0, -300.0, 300.0, -300.0]
        joints = [apart, [0.0] * 6]
        found, jacobian = pc.forward(robot, joints), pc.jacobian(robot, joints)
        self.assertEqual(found.status.tolist(), [pc.ForwardStatus.not_converged, 0])
        self.same(jacobian.status, found.status)
        for one in (found.poses, found.tilt, jacobian.joints, jacobian.errors):
            self.assertTrue(np.isnan(one[0]).all() and not np.isnan(one[1]).any())

    def test_strained_plates_are_told_and_kept(self):
        robot = pc.robot("huang2016")
        errors = robot.errors(rod_difference=[30.0, -30.0, 30.0, 30.0])
        machine = pc.Machine(robot, errors)
        found = pc.forward(machine, pc.inverse(robot, [100, 50, -888, 0.2]).joints)
        self.assertEqual(found.status, pc.ForwardStatus.strained)
        self.assertGreater(found.residual, 1.0)
        self.assertFalse(np.isnan(found.poses).any() or found.ok)


class Derivatives(TestCase):
    def test_jacobian_is_the_difference_quotient(self):
        for name in ROBOTS:
            robot = pc.robot(name)
            machine = pc.Machine(robot, 0.1 * pc.draw_errors(robot, seed=3))
            joints = pc.inverse(machine, some_poses(robot, 3)).joints
            found = pc.jacobian(machine, joints)

            def plate(of, q):
                forward = pc.forward(of, q)
                tilt = [] if robot.commands_tilt else [forward.tilt]
                return np.concatenate([forward.poses, *tilt], axis=-1)

            for limb in range(robot.limb_count):
                step = np.zeros(robot.limb_count)
                step[limb] = 1e-5
                slope = (plate(machine, joints + step) - plate(machine, joints - step)) / 2e-5
                self.close(found.joints[..., limb], slope, 2e-3 * np.abs(slope).max())
                for source in range(len(robot.sources)):
                    change = np.zeros_like(machine.errors)
                    change[limb, source] = 1e-5
                    more, less = (
                        pc.Machine(robot, machine.errors + sign * change) for sign in (1, -1)
                    )
                    slope = (plate(more, joints) - plate(less, joints)) / 2e-5
                    self.close(
                        found.errors[:, :, limb, source],
                        slope,
                        2e-3 * max(1.0, np.abs(slope).max()),
                    )
            if not robot.commands_tilt:
                self.assertEqual(np.abs(found.errors[:, 3]).max() > 0.0, robot.rotates)

    def test_a_drive_that_moves_too_far_moves_the_plate_farther(self):
        robot = pc.robot(HEXAPOD)
        machine = pc.Machine(robot, robot.errors(gain=[30.0, -20.0, 10.0, 40.0, -30.0, 20.0]))
        joints = pc.inverse(machine, some_poses(robot, 3)).joints
        found = pc.jacobian(machine, joints)
        for limb in range(6):
            step = np.zeros(6)
            step[limb] = 0.01
            more, less = (pc.forward(machine, joints + sign * step).poses for sign in (1, -1))
            slope = (more - less) / 0.02
            self.close(found.joints[..., limb], slope, 1e-5 * np.abs(slope).max())

    def test_a_screw_that_wobbles_moves_the_plate_unevenly(self):
        robot = pc.robot(SCREW_DELTA)
        machine = pc.Machine(robot, robot.errors(turn_sine=[0.2, -0.1, 0.15], turn_cosine=0.1))
        joints = pc.inverse(machine, some_poses(robot, 3)).joints
        found = pc.jacobian(machine, joints)
        for limb in range(3):
            step = np.zeros(3)
            step[limb] = 0.001
            more, less = (pc.forward(machine, joints + sign * step) for sign in (1, -1))
            slope = (more.poses - less.poses) / 0.002
            self.close(found.joints[:, :4, limb], slope, 1e-5 * np.abs(slope).max())


class WrongInput(TestCase):
    def test_shapes_and_kinds_are_refused_with_what_came(self):
        robot = pc.robot("huang2016")
        for poses, message in (
            (np.zeros((2, 5)), r"poses: expected an array of shape \(\.\.\., 4\).*got \(2, 5\)"),
            (0.0, r"poses: .*got \(\)"),
            (np.zeros((3, 0)), r"got \(3, 0\)"),
            (["a"], "poses: expected an array of numbers, got dtype <U1"),
            (np.zeros((1, 4), dtype=complex), "got dtype complex128"),
            (np.zeros((1, 4), dtype=bool), "got dtype bool"),
            ([None] * 4, "got dtype object"),
        ):
            with self.assertRaisesRegex(pc.InvalidArgument, message):
                pc.inverse(robot, poses)
        with self.assertRaisesRegex(
            pc.InvalidArgument,
            r"shape \(\.\.\., 6\) of x, y, z in mm, tilt_x, tilt_y, tilt_z in rad for hexapod.*"
            r"got \(2, 4\)",
        ):
            pc.inverse(pc.robot(HEXAPOD), np.zeros((2, 4)))
        with self.assertRaisesRegex(pc.InvalidArgument, r"phi in rad for huang2016.*got \(6,\)"):
            pc.inverse(robot, np.zeros(6))
        with self.assertRaisesRegex(
            ValueError, r"joints: expected an array of shape \(\.\.\., 4\), got \(3,\)"
        ):
            pc.forward(robot, np.zeros(3))
        with self.assertRaisesRegex(pc.InvalidArgument, r"joints: .* got \(2, 3\)"):
            pc.jacobian(robot, np.zeros((2, 3)))

    def test_the_compiled_module_checks_shapes_itself(self):
        native = pc.Machine(pc.robot("huang2016"))._native
        from paracal import _paracal

        for call, shape in (
            (_paracal.inverse, (2, 3)),
            (_paracal.forward, (4,)),
            (_paracal.jacobian, (2, 5)),
        ):
            with self.assertRaisesRegex(pc.InvalidArgument, r"expected an array of shape \(n, 4\)"):
                call(native, np.zeros(shape))
        with self.assertRaisesRegex(pc.InvalidArgument, "errors: expected one row per limb"):
            _paracal.machine(native.robot, np.zeros((3, 14)))
        native = pc.Machine(pc.robot(HEXAPOD))._native
        with self.assertRaisesRegex(pc.InvalidArgument, r"poses: .*\(n, 6\), got \(2, 4\)"):
            _paracal.inverse(native, np.zeros((2, 4)))
        with self.assertRaisesRegex(pc.InvalidArgument, r"errors: .*\(n, 8\), got \(6, 14\)"):
            _paracal.machine(native.robot, np.zeros((6, 14)))

    def test_errors_that_cannot_be(self):
        robot = pc.robot("huang2016")
        for errors, message in (
            (np.zeros((3, 14)), r"expected shape \(4, 14\), got \(3, 14\)"),
            (np.full((4, 14), np.nan), "expected finite numbers"),
            (robot.errors(arm_length=-2000.0), "arm"),
        ):
            with self.assertRaisesRegex(pc.InvalidArgument, message):
                pc.Machine(robot, errors)
        with self.assertRaisesRegex(
            pc.InvalidArgument, "expected names of theta_offset.*, got rods"
        ):
            robot.errors(rods=1.0)
        with self.assertRaisesRegex(
            pc.InvalidArgument, r"e_x: expected one number, or one for each of 4 limbs.*\(3,\)"
        ):
            robot.errors(e_x=[1.0, 2.0, 3.0])


class Columns(TestCase):
    def columns_of(self, robot, poses, infix=""):
        """Poses as files name and print them, the columns turned round, with a name each."""
        named = {
            f"{axis}{infix}_{'mm' if axis in 'xyz' else 'deg'}": column
            for axis, column in zip(robot.pose_axes, as_printed(poses).T)
        }
        return {**dict(reversed(named.items())), "pose": [f"A{k}" for k in range(len(poses))]}

    def test_poses_and_joints_are_told_by_name_and_unit(self):
        for name in ROBOTS:
            robot = pc.robot(name)
            machine = as_built(robot)
            for infix in ("", "_cmd"):
                columns = self.columns_of(robot, some_poses(robot), infix)
                poses = pc.read_poses(columns, robot)[1]  # as the library reads the same table
                wanted = pc.inverse(machine, poses).joints
                unit = "deg" if robot.joint_unit == "rad" else "mm"
                shown = in_deg(wanted) if unit == "deg" else wanted
                joints = {f"q{k + 1}_{unit}": one for k, one in enumerate(shown.T)}
                joints = {"pose": columns["pose"], **dict(reversed(joints.items()))}
                believed = pc.read_joints(joints, robot)[1]
                known = known_exactly(robot)
                for given, taken in ((columns, joints), (DataFrame(columns), DataFrame(joints))):
                    self.same(pc.inverse(machine, given).joints, wanted)
                    self.same(pc.drive(machine, given).poses, pc.drive(machine, poses).poses)
                    self.same(pc.compensate(machine, given).U, pc.compensate(machine, poses).U)
                    self.same(
                        pc.compensate(machine, given).joints, pc.compensate(machine, poses).joints
                    )
                    self.same(pc.forward(machine, taken).poses, pc.forward(machine, believed).poses)
                    self.same(
                        pc.jacobian(machine, taken).joints, pc.jacobian(machine, believed).joints
                    )
                    self.same(known.predict(taken).poses, known.predict(believed).poses)
                    self.same(
                        pc.simulate(machine, given).to_frame()["x_mm"],
                        pc.simulate(machine, poses).to_frame()["x_mm"],
                    )

    def test_degrees_are_those_of_files_to_the_bit(self):
        robot = pc.robot("huang2016")
        place = {"x_mm": [5], "y_mm": [10.0], "z_mm": [-900]}
        for deg in (30.0, 30, 0.1, -57.3):
            joints = pc.inverse(robot, [[5.0, 10.0, -900.0, deg * (np.pi / 180.0)]]).joints
            self.same(pc.inverse(robot, {**place, "phi_deg": [deg]}).joints, joints)
            self.same(
                pc.inverse(robot, {**place, "phi_rad": [deg * (np.pi / 180.0)]}).joints, joints
            )
        self.same(
            pc.inverse(robot, place).joints, pc.inverse(robot, [[5.0, 10.0, -900.0, 0.0]]).joints
        )

    def test_tables_of_other_libraries_go_by_name_too(self):
        """As polars and pyarrow call their columns; read by position, 30 deg were 30 rad."""

        class Frame:
            def __init__(self, names, data):
                setattr(self, names, list(data))
                self.data = data

            def __getitem__(self, name):
                return self.data[name]

            def __array__(self, dtype=None):
                return np.array(list(self.data.values()), dtype).T

        robot = pc.robot("huang2016")
        columns = {"x_mm": [5.0], "y_mm": [10.0], "z_mm": [-900.0], "phi_deg": [30.0]}
        expected = pc.inverse(robot, columns).joints
        for names in ("columns", "column_names"):
            self.same(pc.inverse(robot, Frame(names, columns)).joints, expected)
            joints = {f"q{k + 1}_deg": [0.1 * k] for k in range(4)}
            self.same(
                pc.forward(robot, Frame(names, joints)).poses, pc.forward(robot, joints).poses
            )
            plan = pc.identifiability(robot, Frame(names, columns), measure="coordinates")
            self.assertEqual(plan.rows, 3)

    def test_one_pose_and_other_shapes(self):
        robot = pc.robot("huang2016")
        single = pc.inverse(robot, {"x_mm": 5.0, "y_mm": 10.0, "z_mm": -900.0, "phi_deg": 0.0})
        self.assertEqual(single.joints.shape, (4,))
        nowhere = {"x_mm": [np.nan], "y_mm": [0.0], "z_mm": [-900.0]}
        self.assertFalse(pc.inverse(robot, nowhere).ok.any())

    def test_where_guides_hold_z_it_need_not_be_stated(self):
        robot = pc.robot(FIVE_BAR)
        x, y, z = some_poses(robot)[:, :3].T
        self.same(
            pc.inverse(robot, {"x_mm": x, "y_mm": y}).joints,
            pc.inverse(robot, {"x_mm": x, "y_mm": y, "z_mm": z}).joints,
        )

    def test_other_columns_are_refused_by_name(self):
        robot, hexapod = pc.robot("huang2016"), pc.robot(HEXAPOD)
        poses = self.columns_of(robot, some_poses(robot))
        without = {name: one for name, one in poses.items() if name != "y_mm"}
        for given, message in (
            (without, "expected columns x_mm, y_mm, z_mm, phi_deg or phi_rad; missing: y_mm"),
            ({**poses, "noise": poses["x_mm"]}, "unknown: noise"),
            ({**poses, "phi_rad": poses["x_mm"]}, "unknown: phi_(deg|rad)$"),
            ({**poses, "tilt_x_deg": poses["x_mm"]}, "unknown: tilt_x_deg"),
            ({**poses, "x_cmd_mm": poses["x_mm"]}, "unknown: .*x_mm.*missing: y_cmd_mm"),
            (DataFrame(some_poses(robot)), "unknown: 0, 1, 2, 3; missing: x_mm, y_mm, z_mm"),
            ({**poses, "x_mm": [1.0]}, "expected columns of one length"),
            ({**poses, "x_mm": ["far"] * 40}, "column x_mm: expected an array of numbers"),
            ({}, "missing: x_mm"),
        ):
            for call in (pc.inverse, pc.drive, lambda r, p: pc.compensate(pc.Machine(r), p)):
                with self.assertRaisesRegex(pc.InvalidArgument, message):
                    call(robot, given)
        joints = {f"q{k}_deg": [0.0] for k in (1, 2, 3)}
        for call in (pc.forward, pc.jacobian, lambda r, q: known_exactly(r).predict(q)):
            with self.assertRaisesRegex(pc.InvalidArgument, "joints: .*missing: q4_deg"):
                call(robot, joints)
            with self.assertRaisesRegex(pc.InvalidArgument, "unknown: q1_deg.*missing: q1_mm"):
                call(hexapod, joints)

    def test_errors_are_told_by_name(self):
        for name in ("huang2016", "linear_delta", HEXAPOD):
            robot = pc.robot(name)
            errors = pc.draw_errors(robot, seed=3)
            frame = pc.errors_frame(robot, errors)
            self.same(pc.Machine(robot, frame[reversed(list(frame))]).errors, errors)
            first = list(frame)[0].replace("rad", "deg")
            with self.assertRaisesRegex(pc.InvalidArgument, f"errors: .*missing: {first}"):
                pc.Machine(robot, frame.drop(columns=list(frame)[0]))


if __name__ == "__main__":
    unittest.main()
