"""Measurements in and out: files, DataFrames and dicts; what is wrong with a table is said with its
line."""

import pickle
import unittest

import numpy as np
import pandas as pd
from support import DISTANCES, POSES, TestCase, program

import paracal as pc
from paracal import _tables

POINTS = {
    "pose": ["P0", "P1", "P2", "P3"],
    "x_cmd_mm": [0, 200, 0, -200],
    "y_cmd_mm": [0.0, 0.0, 200.0, 0.0],
    "z_cmd_mm": [-888.0] * 4,
    "phi_cmd_deg": [0.0, 10.0, 20.0, 1 / 3],
    "x_mm": [0.1, 200.2, 0.3, -199.9],
    "y_mm": [0.0, 0.1, 200.1, 0.2],
    "z_mm": [-888.1, -888.2, -887.9, -888.0],
    "phi_deg": [0.01, 10.02, None, 0.3],
}


class In(TestCase):
    def test_files_frames_and_dicts_are_the_same(self):
        frame, poses = pd.read_csv(DISTANCES, comment="#"), pd.read_csv(POSES, comment="#")
        robot = pc.robot("huang2016")
        ways = (
            pc.read_measurements(str(DISTANCES), poses=POSES),
            pc.read_measurements(frame, poses=poses),
            pc.read_measurements([frame.to_dict("list")], poses=[poses.to_dict("series")]),
        )
        values = [pc.calibrate(robot, one).values for one in ways]
        for one in values:
            self.same(one, values[0])
        self.assertEqual(ways[0].counts, {"distances": 6})
        self.assertEqual(ways[0].names, [f"P{k}" for k in range(7)])
        self.same(ways[0].poses[1], [0.0, -500.0, -888.0, 0.0])
        self.assertEqual(ways[0].robot.name, "huang2016")
        self.assertIsNone(ways[1].robot)

    def test_numbers_come_as_they_are(self):
        random = np.random.default_rng(1)
        points = {**POINTS, "x_mm": (POINTS["x_mm"] + random.random(4)).astype(object)}
        measured = pc.read_measurements(points)
        self.assertEqual(measured.counts, {"points": 4})
        again = measured.to_frame(robot=pc.robot("huang2016"))
        self.same(again["x_mm"], points["x_mm"].astype(float))
        self.same(measured.poses[:, 3], np.radians(POINTS["phi_cmd_deg"]))
        self.assertTrue(np.isnan(again["phi_deg"][2]))

    def test_names_are_no_formulas(self):
        names = ["=1+1", "'=x", "-cmd", "'a"]
        read = pc.read_measurements({**POINTS, "pose": names}, robot=pc.robot("huang2016"))
        self.assertEqual(read.names, names)
        self.assertIn("\n'=1+1,", "".join(read.to_csv().values()))
        self.assertEqual(read.to_frame()["pose"].tolist(), names)

    def test_a_path_ends_at_its_end(self):
        robot = pc.robot("huang2016")
        calls = (
            lambda: pc.read_measurements(f"{DISTANCES}\0x", poses=POSES),
            lambda: pc.read_calibration("c.json\0x"),
            lambda: pc.read_errors(robot, "errors.toml\0x"),
            lambda: _tables.write("saved.json\0x", "text"),
        )
        for call in calls:
            with self.assertRaises(ValueError):
                call()

    def test_what_is_blank_was_not_read(self):
        robot = pc.robot("huang2016")
        for blank in (None, np.nan, float("nan"), ""):
            points = {**POINTS, "phi_deg": [0.01, 10.02, blank, 0.3]}
            for table in (points, pd.DataFrame(points)):
                again = pc.read_measurements(table, robot=robot).to_frame()
                self.assertEqual(np.isnan(again["phi_deg"]).tolist(), [False, False, True, False])

    def test_several_tables_are_several_series(self):
        robot = pc.robot("huang2016")
        heights = {"pose": ["P0", "P1", "P2", "P3"], "height_mm": [10.0, 10.1, 10.2, 10.15]}
        both = pc.read_measurements([POINTS, heights], poses=POINTS_POSES, robot=robot)
        self.assertEqual(both.counts, {"points": 4, "heights": 4})
        self.assertEqual(
            pc.merge(
                [pc.read_measurements(POINTS), pc.read_measurements(heights, poses=POINTS_POSES)]
            ).counts,
            both.counts,
        )
        self.same(both.to_frame("heights")["height_mm"], heights["height_mm"])
        two = pc.read_measurements([POINTS, {**POINTS, "x_mm": [1.0, 2.0, 3.0, 4.0]}], robot=robot)
        self.assertEqual(sorted(set(two.to_frame("points")["series"])), ["table 1", "table 2"])
        self.assertEqual(len(two.to_frame()), 8)
        with self.assertRaisesRegex(
            pc.InvalidArgument, "kind: expected one of heights, points, poses, got lengths"
        ):
            both.to_frame("lengths")

    def test_exports_of_instruments(self):
        text = self.file(
            "export.txt",
            "// of a tracker\n1;P0;0;0;0\n2;P1;0.2;0;0\n3;P2;0;0.2;0\n4;P3;-0.2;0;0.001\n",
        )
        measured = pc.read_measurements(
            text,
            poses=POINTS_POSES,
            columns="name=2,x=3,y=4,z=5",
            unit="m",
            robot=pc.robot("huang2016"),
        )
        self.assertEqual(measured.counts, {"points": 4})
        self.same(measured.to_frame()["z_mm"], [0.0, 0.0, 0.0, 1.0])
        for columns, unit, what in (("name=2", "m", "columns"), ("name=2,x=3,y=4,z=5", None, "unit")):
            with self.assertRaisesRegex(pc.InvalidArgument, f"^{what}: expected"):
                pc.read_measurements(text, poses=POINTS_POSES, columns=columns, unit=unit)

    def test_exports_in_the_order_of_poses(self):
        text = self.file("export.txt", "7 0 0 0\n8 200 0 0\n9 0 200 0\n10 -200 0 1\n")
        said = {"poses": POINTS_POSES, "columns": "name=1,x=2,y=3,z=4", "unit": "mm"}
        measured = pc.read_measurements(text, match="order", robot=pc.robot("huang2016"), **said)
        self.assertEqual(list(measured.to_frame()["pose"]), POINTS["pose"])
        with self.assertRaises(pc.InputFileError):
            pc.read_measurements(text, **said)
        with self.assertRaisesRegex(pc.InvalidArgument, "match: expected name or order, got rank"):
            pc.read_measurements(text, match="rank", **said)

    def test_tables_as_spreadsheets_write_them(self):
        comma = self.file(
            "comma.csv",
            "pose;height_mm;who\nP0;10,125;Ann\nP1;10,250;Ann\nP2;10,500;Bob\nP3;11,000;Bob\n",
        )
        robot = pc.robot("huang2016")
        said = {"poses": POINTS_POSES, "robot": robot}
        with self.assertRaisesRegex(pc.InputFileError, "who"):
            pc.read_measurements(comma, decimal_comma=True, **said)
        with self.assertRaisesRegex(pc.InputFileError, "10.125 or 10125"):
            pc.read_measurements(comma, ignore_columns=["who"], **said)
        heights = pc.read_measurements(comma, decimal_comma=True, ignore_columns=["who"], **said)
        self.same(heights.to_frame()["height_mm"], [10.125, 10.25, 10.5, 11.0])
        # What is no file has no decimal comma, whatever the files beside it have.
        both = pc.read_measurements([comma, POINTS], decimal_comma=True, ignore_columns=["who"], **said)
        self.same(both.to_frame("points")["y_mm"], POINTS["y_mm"])
        joints = self.file("joints.csv", "pose;q1_deg;q2_deg;q3_deg;q4_deg;by\nA;1,5;2;3;4;Ann\n")
        poses = self.file("poses.csv", "pose;x_mm;y_mm;z_mm;phi_deg;by\nA;1,5;2;-900;0;Ann\n")
        style = {"decimal_comma": True, "ignore_columns": ["by"]}
        self.same(pc.read_joints(joints, robot, **style)[1][0, 0], np.radians(1.5))
        self.same(pc.read_poses(poses, robot, **style)[1][0, 0], 1.5)
        self.assertRaises(pc.InputFileError, pc.read_poses, poses, robot)

    def test_temperature(self):
        robot = pc.robot("huang2016")
        theirs = program(
            *("calibrate", "--measurements", DISTANCES, "--poses", POSES, "--temperature-c", "30"),
            *("--expansion-ppm", "23", "--instrument-expansion-ppm", "5"),
        )
        measured = pc.read_measurements(DISTANCES, poses=POSES)
        cold = measured.at_reference_temperature(30.0, 23.0, 5.0)
        values = pc.calibrate(robot, cold).values[:4] * (180.0 / np.pi)
        self.same(values, [one["value"] for one in theirs["parameters"][:4]])

    def test_several_measurements_keep_their_robot(self):
        robot = pc.robot("huang2016")
        parts = [pc.read_measurements(POINTS, robot=robot), pc.read_measurements(POINTS)]
        merged = pc.merge(parts[::-1])
        self.assertEqual(merged.robot.name, "huang2016")
        self.assertIn("once", merged.notes[0])


POINTS_POSES = {
    key: POINTS[key] for key in ("pose", "x_cmd_mm", "y_cmd_mm", "z_cmd_mm", "phi_cmd_deg")
}


class Out(TestCase):
    def test_readings_come_back_as_they_were(self):
        robot = pc.robot("huang2016")
        measured = pc.simulate(
            robot, pc.validation_poses(robot), noise_mm=0.1, read_rotation=True, repeats=2
        )
        for way in (measured.to_frame(), next(iter(measured.to_csv().items()))):
            table = way if isinstance(way, pd.DataFrame) else self.file("again.csv", way[1])
            again = pc.read_measurements(table, robot=robot)
            pd.testing.assert_frame_equal(again.to_frame(), measured.to_frame(), check_exact=True)
        self.assertEqual(
            list(measured.to_frame("poses")),
            ["pose", "x_cmd_mm", "y_cmd_mm", "z_cmd_mm", "phi_cmd_deg"],
        )

    def test_tables_of_one_name_are_all_there(self):
        robot = pc.robot("huang2016")
        measured = pc.simulate(robot, pc.validation_poses(robot), measure="pose", noise_mm=0.1)
        tables = measured.to_csv()
        self.assertEqual(list(tables), ["poses", "poses 2"])
        self.assertIn("qw", tables["poses"])
        self.assertEqual(tables["poses 2"].splitlines()[0].count(","), 4)

    def test_residuals_of_orientations_have_a_column_an_axis(self):
        robot = pc.robot("huang2016")
        plan = pc.select_poses(robot, 14, candidates=100, measure="pose")
        measured = pc.simulate(robot, plan, measure="pose", noise_mm=0.1, rotation_noise_rad=1e-3)
        calibration = pc.calibrate(robot, measured)
        residuals, file = calibration.residuals(), calibration.as_dict()["residuals"]
        for key in ("orientation_before", "orientation_after"):
            for axis, column in enumerate("xyz"):
                of = [one[f"{key}_deg"][axis] for one in file]
                self.same(residuals[f"{key}_{column}_deg"], of)

    def test_distances_come_back_too(self):
        measured = pc.read_measurements(DISTANCES, poses=POSES)
        frame = measured.to_frame()
        self.assertEqual(list(frame)[:3], ["from", "to", "distance_mm"])
        again = pc.read_measurements(frame, poses=measured.to_frame("poses"))
        robot = pc.robot("huang2016")
        self.same(pc.calibrate(robot, again).values, pc.calibrate(robot, measured).values)
        with self.assertRaisesRegex(pc.InvalidArgument, "because the tables state none"):
            again.to_frame()


class Wrong(TestCase):
    def refused(self, *arguments, **keywords):
        with self.assertRaises(pc.InputFileError) as caught:
            pc.read_measurements(*arguments, **keywords)
        return caught.exception

    def test_a_broken_line_is_named(self):
        path = self.file(
            "broken.csv", "# robot: huang2016\nfrom,to,distance_mm\nP0,P1,498\nP0,P2,wide\n"
        )
        error = self.refused(path, poses=POSES)
        self.assertEqual((error.file, error.line), (str(path), 4))
        self.assertRegex(str(error), r"broken.csv:4: .*expected.*wide")
        self.assertEqual(pickle.loads(pickle.dumps(error)).line, 4)
        error = self.refused({**POINTS, "x_mm": [1.0, 2.0, "far", 4.0]})
        self.assertEqual((error.file, error.line), ("table", 4))

    def test_columns_that_nobody_knows(self):
        error = self.refused({**POINTS, "colour": ["red"] * 4})
        self.assertIn("colour", str(error))
        self.assertIn("nothing.csv", str(self.refused(self.folder / "nothing.csv")))
        self.assertEqual(self.refused(self.folder / "nothing.csv").line, 0)

    def test_tables_that_are_none(self):
        for given, message in (
            (3, "expected a file, a DataFrame or a dict of columns, got int"),
            ([], "at least one"),
            ({"pose": ["P0"], "x_mm": []}, "expected columns of one length"),
            ({"pose": "P0"}, "expected columns with one value per row"),
        ):
            with self.assertRaisesRegex(pc.InvalidArgument, message):
                pc.read_measurements(given)

    def test_poses_that_are_missing_or_too_many(self):
        distances = {"from": ["P0"], "to": ["P1"], "distance_mm": [200.0]}
        with self.assertRaisesRegex(
            pc.InvalidArgument, "poses: expected a table for table, got none"
        ):
            pc.read_measurements(distances)
        with self.assertRaisesRegex(
            pc.InvalidArgument, "poses: expected one table for each of 1 .* got 2"
        ):
            pc.read_measurements(distances, poses=[POINTS_POSES, POINTS_POSES])

    def test_another_robot(self):
        other = pc.robot("rotary_delta")
        self.assertIn("rotary_delta", str(self.refused(DISTANCES, poses=POSES, robot=other)))
        measured = pc.read_measurements(DISTANCES, poses=POSES)
        with self.assertRaisesRegex(pc.InputFileError, "distances.csv:2: .*huang2016"):
            pc.calibrate(other, measured)

    def test_robots_and_other_files(self):
        with self.assertRaisesRegex(pc.InvalidArgument, "huang2016"):
            pc.robot("huang2017")
        for text, message in (("name = 3\n", "name"), ("[geometry\n", "robot.toml:1")):
            with self.assertRaisesRegex(pc.InputFileError, message):
                pc.robot(self.file("robot.toml", text))
        robot = pc.robot("huang2016")
        self.assertEqual(pc.robot_of_toml(robot.to_toml()).to_toml(), robot.to_toml())
        self.assertEqual(pc.robot(self.file("mine.toml", robot.to_toml())).name, "huang2016")
        with self.assertRaisesRegex(pc.InputFileError, "calibration.json"):
            pc.read_calibration(self.file("calibration.json", "{}"))
        with self.assertRaisesRegex(pc.InputFileError, "errors.toml"):
            pc.read_errors(robot, self.file("errors.toml", "[[limb]]\ne_mm = 3\n"))
        unreadable = self.folder / "gel\udce4scht.csv"
        self.assertIn("gel\udce4scht.csv", str(self.refused(unreadable)))


if __name__ == "__main__":
    unittest.main()
