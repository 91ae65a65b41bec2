"""Plans, what they reveal, and virtual machines: against the program."""

import unittest

import numpy as np
from support import TestCase, as_printed, in_deg, pose_rows, program

import paracal as pc


class Plans(TestCase):
    def test_the_papers_plan_is_the_programs(self):
        for stage in ("rough", "fine"):
            theirs = program("poses", "--robot", "huang2016", "--stage", stage)
            plan = pc.paper_plan(pc.robot("huang2016"), stage)
            self.assertEqual(plan.details["n"], theirs["n"])
            self.assertEqual(plan.curve, [{**one} for one in theirs["curve"]])
            self.same(as_printed(plan.poses), pose_rows(theirs["poses"]))
            self.assertEqual(plan.names, [one["pose"] for one in theirs["poses"]])
        with self.assertRaisesRegex(pc.InvalidArgument, "stage: expected rough or fine, got auto"):
            pc.paper_plan(pc.robot("huang2016"), "auto")
        for keywords, complaint in (
            ({"threshold": 0.0}, "threshold: expected 1e-15 to 1, got 0"),
            ({"start_azimuth_rad": np.nan}, "start_azimuth_rad: expected -360 to 360, got nan"),
        ):
            with self.assertRaisesRegex(pc.InvalidArgument, complaint):
                pc.paper_plan(pc.robot("huang2016"), "fine", **keywords)

    def test_selected_poses_are_the_programs(self):
        for robot, keywords, options in (
            ("huang2016", {}, []),
            (
                "huang2016",
                {"criterion": "D", "read_rotation": True, "sigma_mm": 0.05},
                ["--criterion", "D", "--read-rotation", "--sigma-mm", "0.05"],
            ),
            (
                "linear_delta",
                {"measure": "height", "seed": 5},
                ["--measure", "height", "--seed", "5"],
            ),
        ):
            theirs = program(
                "poses", "--robot", robot, "--optimal", 8, "--candidates", 150, *options
            )
            plan = pc.select_poses(pc.robot(robot), 8, candidates=150, **keywords)
            self.same(as_printed(plan.poses), pose_rows(theirs["poses"]))
            self.same(plan.details["value"], theirs["value"])
            self.same(
                plan.details["workspace_std"]["max_aligned_mm"],
                theirs["workspace_std"]["max_aligned_mm"],
            )
            travel = theirs.get("travel_deg", theirs.get("travel_mm"))
            self.same(
                in_deg(plan.details["travel"])
                if robot != "linear_delta"
                else plan.details["travel"],
                travel,
            )
            self.same(
                [one["rms_distance_mm"] for one in plan.curve],
                [one["rms_distance_mm"] for one in theirs["curve"]],
            )
            self.assertEqual(len(plan), 8)
        for keywords, message in (
            ({"poses": 1}, "expected 2 to the 150 candidates, got 1"),
            ({"candidates": 10**9}, "candidates: expected 2 to 100000, got 1000000000"),
            ({"candidates": 5000, "poses": 2000}, "poses: expected 2 to 1000, got 2000"),
            ({"criterion": "E"}, "criterion: expected one of pose, D"),
            ({"measure": "weights"}, "measure: expected one of coordinates, pose, distance.*dial"),
            ({"measure": "distance"}, "distances"),
            ({"measure": "height", "read_rotation": True}, "without rotations"),
        ):
            with self.assertRaisesRegex(pc.InvalidArgument, message):
                pc.select_poses(
                    pc.robot("huang2016"), **{"poses": 8, "candidates": 150, **keywords}
                )

    def test_identifiability_is_the_programs(self):
        robot = pc.robot("huang2016")
        plan = pc.select_poses(robot, 12, candidates=150)
        path = self.folder / "plan.csv"
        plan.to_csv(path)
        for keywords, options in (
            ({}, []),
            ({"measure": "home-distance"}, ["--measure", "home-distance"]),
            (
                {"read_rotation": True, "rotation": "absolute", "frame": "robot"},
                ["--rotation", "absolute", "--frame", "robot"],
            ),
            ({"second": True}, ["--second"]),
            (
                {"measure": "pose", "reflectors": "end-effector", "sigma_mm": 0.1},
                ["--measure", "pose", "--reflectors", "end-effector", "--sigma-mm", "0.1"],
            ),
        ):
            theirs = program("identifiability", "--poses", path, *options)
            mine = pc.identifiability(robot, path, **keywords)
            self.assertEqual((mine.rank, mine.rows), (theirs["rank"], theirs["rows"]))
            self.same(mine.singular_values, theirs["singular_values"])
            self.assertEqual(mine.indices, {f"O{k}": theirs[f"O{k}"] for k in range(1, 6)})
            self.assertEqual(
                [one.text for one in mine.null_space], [one["text"] for one in theirs["null_space"]]
            )
            factor = np.array([180.0 / np.pi if unit == "rad" else 1.0 for unit in mine.units])
            self.same(mine.std * factor, [one["std"] for one in theirs["parameters"]])
            self.same(mine.prior_std * factor, [one["prior_std"] for one in theirs["parameters"]])
            self.same(
                mine.workspace_std["max_distance_mm"], theirs["workspace_std"]["max_distance_mm"]
            )
            self.assertEqual(
                mine.names, [f"{one['name']}.{one['limb']}" for one in theirs["parameters"]]
            )
        self.same(pc.identifiability(robot, plan).std, pc.identifiability(robot, plan.poses).std)
        with self.assertRaisesRegex(
            pc.InvalidArgument, "rotation: expected relative with distances"
        ):
            pc.identifiability(robot, plan, measure="distance", rotation="absolute")

    def test_poses_of_the_workspace(self):
        robot = pc.robot("huang2016")
        still, turned = pc.validation_poses(robot), pc.workspace_poses(robot)
        self.assertEqual((len(still), len(turned)), (121, 121))
        self.same(still.poses[:, :3], turned.poses[:, :3])
        self.assertEqual(
            sorted(set(turned.poses[:, 3])),
            [robot.workspace["rotation_rad"][0], 0.0, robot.workspace["rotation_rad"][1]],
        )
        self.assertFalse(still.poses[:, 3].any())

    def test_poses_out_of_reach_or_none(self):
        robot = pc.robot("huang2016")
        with self.assertRaisesRegex(pc.Unreachable, "P1"):
            pc.identifiability(robot, [[0, 0, -888, 0], [0, 0, -5000, 0]])
        with self.assertRaisesRegex(pc.InvalidArgument, "at least one pose"):
            pc.identifiability(robot, np.zeros((0, 4)))


class VirtualMachines(TestCase):
    def test_draws_are_the_programs(self):
        robot = pc.robot("huang2016")
        poses = self.file("poses.csv", "pose,x_mm,y_mm,z_mm\nP0,0,0,-888\nP1,200,100,-900\n")
        all_drawn = pc.draw_errors(robot, machines=3, seed=9)
        self.assertEqual(all_drawn.shape, (3, 4, 14))
        for machine in range(3):
            truth = self.folder / f"{machine}.toml"
            theirs = program(
                "simulate",
                "--robot",
                robot.name,
                "--poses",
                poses,
                "--seed",
                9,
                "--machine",
                machine,
                "--truth",
                truth,
            )
            self.close(pc.read_errors(robot, truth), all_drawn[machine], 1e-12)
            self.same(pc.draw_errors(robot, seed=9, first=machine), all_drawn[machine])
            mine = pc.simulate(pc.Machine(robot, all_drawn[machine]), poses).to_frame()
            self.same(
                mine[["x_mm", "y_mm", "z_mm"]],
                [[one[f"{a}_mm"] for a in "xyz"] for one in theirs["points"]],
            )

    def test_how_many_machines(self):
        robot = pc.robot("rotary_delta")
        self.assertEqual(pc.draw_errors(robot, 0).shape, (0, 3, 14))
        with self.assertRaisesRegex(pc.InvalidArgument, "machines: expected at least 0, got -1"):
            pc.draw_errors(robot, -1)
        tight = pc.Tolerances.stated(robot, {"rod_mean": 0.3})
        drawn = pc.draw_errors(robot, 2000, tolerances=tight)
        self.assertTrue(0.095 < drawn[..., pc.SOURCES.index("rod_mean")].std() < 0.105)
        self.assertEqual(np.flatnonzero(np.abs(drawn).max(axis=(0, 1))).tolist(), [7])

    def test_noise_frame_and_repeats(self):
        robot = pc.robot("huang2016")
        plan = pc.validation_poses(robot)
        turned = np.array([[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]], dtype=float)
        exact = pc.simulate(robot, plan).to_frame()[["x_mm", "y_mm", "z_mm"]].to_numpy()
        self.close(exact, plan.poses[:, :3], 1e-8)
        moved = (
            pc.simulate(robot, plan, frame=turned).to_frame()[["x_mm", "y_mm", "z_mm"]].to_numpy()
        )
        self.close(moved, exact @ turned[:3, :3].T + turned[:3, 3], 1e-9)
        noisy = pc.simulate(robot, plan, noise_mm=0.1, repeats=5, seed=4)
        self.assertEqual(noisy.counts, {"points": 605})
        spread = noisy.to_frame()[["x_mm", "y_mm", "z_mm"]].to_numpy() - np.repeat(exact, 5, axis=0)
        self.assertTrue(0.095 < spread.std() < 0.105, spread.std())
        self.same(
            noisy.to_frame()["x_mm"],
            pc.simulate(robot, plan, noise_mm=0.1, repeats=5, seed=4).to_frame()["x_mm"],
        )
        loose = pc.simulate(robot, plan, repeatability_mm=0.1, repeats=5, seed=4).to_frame()
        spread = loose[["x_mm", "y_mm", "z_mm"]].to_numpy() - np.repeat(exact, 5, axis=0)
        self.assertTrue(0.095 < spread.std() < 0.105, spread.std())
        turning = pc.simulate(robot, plan, read_rotation=True, rotation_noise_rad=0.01, repeats=5)
        self.assertTrue(0.009 < np.radians(turning.to_frame()["phi_deg"]).std() < 0.011)
        body = np.array([[1.0, 0, 0, 3], [0, 0, -1, 4], [0, 1, 0, 12], [0, 0, 0, 1]])
        shown = pc.simulate(robot, plan, measure="pose", body=body).to_frame()
        self.close(shown["x_mm"] - shown["x_cmd_mm"], 3.0, 1e-6)
        self.close(shown["qw"], np.sqrt(0.5), 1e-9)
        self.close(shown["qx"], np.sqrt(0.5), 1e-9)
        with self.assertRaisesRegex(pc.InvalidArgument, "body: expected a rotation"):
            pc.simulate(robot, plan, measure="pose", body=2.0 * body)
        second = pc.simulate(robot, plan, second_mm=[10.0, 0.0, 5.0]).to_frame()
        self.close(second["x2_mm"] - second["x_mm"], 10.0, 1e-8)
        self.close(second["z2_mm"] - second["z_mm"], 5.0, 1e-8)
        for keywords, message in (
            ({"frame": 2 * turned}, "expected a rotation"),
            ({"frame": np.eye(3)}, "frame"),
            ({"repeats": 0}, "repeats: expected 1 to 10000, got 0"),
            ({"repeats": 10**9}, "repeats: expected 1 to 10000, got 1000000000"),
            ({"repeats": 2, "measure": "distance"}, "expected 1 with distances"),
            ({"noise_mm": -1.0}, "noise_mm: expected 0"),
        ):
            with self.assertRaisesRegex(pc.InvalidArgument, message):
                pc.simulate(robot, plan, **keywords)


if __name__ == "__main__":
    unittest.main()
