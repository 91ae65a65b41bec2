"""Inverse, forward and Jacobian over arrays: against the program, against single calls, and at
their edges."""

import unittest

import numpy as np
from support import TestCase, as_printed, in_deg, pose_rows, program

import paracal as pc

ROBOTS = ("huang2016", "rotary_delta", "linear_delta")


def some_poses(robot, count=40):
    """Within the workspace, home among them."""
    space, random = robot.workspace, np.random.default_rng(1)
    radius, azimuth = (
        space["radius_mm"] * np.sqrt(random.random(count)),
        random.random(count) * 2 * np.pi,
    )
    low, high = space["rotation_rad"]
    return np.stack(
        [
            radius * np.cos(azimuth),
            radius * np.sin(azimuth),
            space["top_z_mm"] - space["height_mm"] * random.random(count),
            low + (high - low) * random.random(count),
        ],
        axis=-1,
    )


def as_built(robot):
    return pc.Machine(robot, pc.draw_errors(robot, seed=3))


class AgainstTheProgram(TestCase):
    def tables(self, robot):
        """A pose table, a joint table and errors in files, and what they say."""
        printed = as_printed(some_poses(robot))
        rows = "".join(",".join(map(repr, row)) + "\n" for row in printed.tolist())
        poses = self.file("poses.csv", "x_mm,y_mm,z_mm,phi_deg\n" + rows)
        errors = self.file("errors.toml", pc.errors_toml(robot, pc.draw_errors(robot, seed=3)))
        return poses, errors

    def test_inverse_and_forward_are_the_same_to_the_bit(self):
        for name in ROBOTS:
            robot = pc.robot(name)
            poses, errors = self.tables(robot)
            machine = pc.Machine(robot, pc.read_errors(robot, errors))
            joints, status = pc.inverse(machine, pc.read_poses(poses)[1])
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
            self.same(as_printed(found.poses), pose_rows(plates))
            self.same(found.tilt, [[one[f"tilt_{axis}_rad"] for axis in "xyz"] for one in plates])
            self.same(found.residual, [one["residual_mm"] for one in plates])
            self.same(found.iterations, [one["iterations"] for one in plates])


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

    def test_any_shape_is_as_single_calls(self):
        machine = as_built(pc.robot("huang2016"))
        poses = some_poses(machine.robot, 6).reshape(2, 3, 4)
        inverse = pc.inverse(machine, poses)
        forward, jacobian = pc.forward(machine, inverse.joints), pc.jacobian(
            machine, inverse.joints
        )
        self.assertEqual(inverse.joints.shape, (2, 3, 4))
        self.assertEqual(inverse.status.shape, (2, 3))
        self.assertEqual(forward.tilt.shape, (2, 3, 3))
        self.assertEqual(jacobian.errors.shape, (2, 3, 7, 4, 14))
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
                return np.concatenate([forward.poses, forward.tilt], axis=-1)

            for limb in range(robot.limb_count):
                step = np.zeros(robot.limb_count)
                step[limb] = 1e-5
                slope = (plate(machine, joints + step) - plate(machine, joints - step)) / 2e-5
                self.close(found.joints[..., limb], slope, 2e-3 * np.abs(slope).max())
                for source in range(14):
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
            self.assertEqual(np.abs(found.errors[:, 3]).max() > 0.0, robot.rotates)


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
        with self.assertRaisesRegex(pc.InvalidArgument, "errors: expected a row a limb"):
            _paracal.Machine(native.robot, np.zeros((3, 14)))

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


if __name__ == "__main__":
    unittest.main()
