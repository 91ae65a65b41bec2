"""Tolerance design against the program to the bit."""

import unittest

import numpy as np
from support import SOURCE, TestCase, as_printed, pose_rows, program

import paracal as pc
from paracal import tolerance

PROBLEM = """
[[requirement]]
quantity = "tilt"
limit_rad = 0.001

[[requirement]]
quantity = "position-compensated"
limit_mm = 0.2
"""


class Analysis(TestCase):
    def same_requirement(self, mine, theirs):
        self.assertEqual((mine["quantity"], mine["unit"]), (theirs["quantity"], theirs["unit"]))
        for key in (
            "limit",
            "worst_case",
            "rss_3sigma",
            "monte_carlo_3sigma",
            "monte_carlo_3sigma_interval",
            "cpk",
            "passed",
        ):
            self.same(mine[key], theirs[key])
        for key in ("worst_case_pose", "rss_pose", "monte_carlo_pose"):
            self.same(as_printed(mine[key]), pose_rows([theirs[key]])[0])
        self.assertEqual(
            mine["contributors"], [(one["name"], one["share"]) for one in theirs["contributors"]]
        )
        self.assertEqual(
            {
                key: list(value) if isinstance(value, tuple) else value
                for key, value in mine["largest_on_a_machine"].items()
            },
            theirs["largest_on_a_machine"],
        )

    def test_it_is_the_programs(self):
        problem = self.file("problem.toml", PROBLEM)
        robot = pc.robot("huang2016")
        for keywords, options in (
            ({}, []),
            (
                {"requirements": {"tilt": 2e-3}, "seed": 3, "sigma_error": 0.03, "failure_error": 0.2},
                ["--max-tilt", "0.002", "--seed", 3, "--sigma-error", "0.03", "--failure-error", "0.2"],
            ),
            (
                {"problem": problem, "sigma_error": 0.05, "failure_error": 0.5, "confidence": 0.9},
                ["--problem", problem, "--sigma-error", "0.05", "--failure-error", "0.5", "--confidence", "0.9"],
            ),
            (
                {"model": "exact", "max_machines": 100, "sigma_error": 0.2, "failure_error": 0.5},
                ["--model", "exact", "--max-machines", "100", "--sigma-error", "0.2", "--failure-error", "0.5"],
            ),
        ):
            theirs = program("tolerance", "analyze", "--robot", robot.name, *options)
            mine = tolerance.analyze(robot, **keywords)
            self.assertEqual(
                (mine.machines, mine.converged, mine.not_closed, mine.confidence),
                tuple(theirs[key] for key in ("machines", "converged", "not_closed", "confidence")),
            )
            self.assertEqual(
                {
                    "value": mine.yield_,
                    "low": mine.yield_interval[0],
                    "high": mine.yield_interval[1],
                },
                theirs["yield"],
            )
            self.assertEqual(mine.dpmo, theirs["dpmo"]["value"])
            self.assertEqual(mine.failure, theirs["failure"])
            self.assertEqual(mine.assumed, theirs["assumed"])
            self.assertEqual(len(mine.requirements), len(theirs["requirements"]))
            for one, other in zip(mine.requirements, theirs["requirements"]):
                self.same_requirement(one, other)

    def test_what_makes_no_sense(self):
        robot = pc.robot("rotary_delta")
        for keywords, message in (
            (
                {"requirements": {"weight": 1.0}},
                'quantity: expected one of tilt, twist.*got "weight"',
            ),
            ({"requirements": {"tilt": 0.0}}, "limit of tilt: expected 1e-09 to 3.14159, got 0"),
            ({"requirements": {}}, "expected at least one"),
            ({"model": "cubic"}, "model: expected one of"),
            ({"max_machines": 2}, "max_machines: expected 16 to 1000000000000, got 2"),
            ({"sigma_error": 0.0}, "sigma_error: expected 0.0001 to 1, got 0"),
            ({"requirements": {"rotation": 0.1}}, "rotation"),
            (
                {"requirements": {"tilt": 1.0}, "problem": "x.toml"},
                "expected one of them, got both",
            ),
        ):
            with self.assertRaisesRegex(pc.InvalidArgument, message):
                tolerance.analyze(robot, **keywords)

    def test_poses_may_be_chosen(self):
        robot = pc.robot("huang2016")
        here = tolerance.analyze(robot, poses=[[0, 0, -888, 0]], sigma_error=0.2, failure_error=0.5)
        everywhere = tolerance.analyze(robot, sigma_error=0.2, failure_error=0.5)
        # The worst pose counts in both, the rim of the workspace in one alone.
        self.assertLessEqual(
            here.requirements[0]["largest_on_a_machine"]["p99"],
            everywhere.requirements[0]["largest_on_a_machine"]["p99"],
        )
        self.assertNotEqual(
            here.requirements[0]["largest_on_a_machine"],
            everywhere.requirements[0]["largest_on_a_machine"],
        )


class Allocation(TestCase):
    def test_it_is_the_programs(self):
        robot = pc.robot("huang2016")
        for keywords, options in (
            ({}, []),
            (
                {"max_tilt_rad": 2e-3, "bound": "true-maximum"},
                ["--max-tilt", "0.002", "--bound", "true-maximum"],
            ),
            ({"least_rad": 0.0002}, ["--least", "0.0002"]),
            (
                {"least_rad": 0.0002, "least_is": "sigma"},
                ["--least", "0.0002", "--least-is", "sigma"],
            ),
        ):
            mine = tolerance.allocate(robot, **keywords)
            theirs = program("tolerance", "allocate", "--robot", robot.name, *options)
            self.same_allocation(robot, mine, theirs)

    def same_allocation(self, robot, mine, theirs):
        self.assertEqual(
            (mine.status, mine.reason, mine.cost),
            (theirs["status"], theirs["reason"], theirs["cost"]),
        )
        width = robot.geometry["parallelogram_width_mm"]
        half = mine.tolerances.half_widths
        tilt = {
            f"{name}_over_c"
            if name.endswith("difference")
            else name: half[name] / width
            if name.endswith("difference")
            else half[name]
            for name in pc.SOURCES[8:]
        }
        self.assertEqual(tilt, theirs["tolerances"])
        for one, other in zip(mine.requirements, theirs["requirements"]):
            self.assertEqual(
                (one["quantity"], one["criterion"]), (other["quantity"], other["criterion"])
            )
            self.same(one["worst"], other["worst_rad"])
            self.same(one["price"], other["price"])
            self.same(as_printed(one["worst_pose"]), pose_rows([other["worst_pose"]])[0])
        self.assertEqual(mine.tolerances.assumed, theirs["assumed"])

    def test_the_rest_stays_as_it_is(self):
        robot = pc.robot("huang2016")
        rest = pc.Tolerances.stated(robot, {"rod_mean": 0.123})
        half_widths = tolerance.allocate(robot, rest=rest).tolerances.half_widths
        self.assertEqual((half_widths["rod_mean"], half_widths["e_x"]), (0.123, 0.0))

    def test_a_file_of_costs_is_a_problem(self):
        robot = pc.robot("huang2016")
        cost = 'law = "reciprocal"\nB = 1.0\nlower = {}\nupper = {}\n'
        text = PROBLEM + "".join(
            f"\n[cost.{key}]\n" + cost.format(low, high)
            for key, low, high in (("rod_difference_mm", 0.001, 0.5), ("alpha2_deg", 0.001, 0.5))
        )
        path = self.file("problem.toml", text)
        mine = tolerance.allocate(robot, problem=path)
        theirs = program("tolerance", "allocate", "--robot", robot.name, "--problem", path)
        self.assertEqual((mine.status, mine.cost), (theirs["status"], theirs["cost"]))
        self.assertEqual(len(mine.requirements), 2)

    def test_wrong_choices(self):
        robot = pc.robot("huang2016")
        with self.assertRaisesRegex(pc.InvalidArgument, "max_tilt_rad: expected"):
            tolerance.allocate(robot, max_tilt_rad=0.0)
        with self.assertRaisesRegex(
            pc.InputFileError, r"expected costs \(\[cost.NAME\]\), got none"
        ):
            tolerance.allocate(robot, problem=self.file("problem.toml", PROBLEM))


class Sensitivities(TestCase):
    def test_they_are_the_programs(self):
        robot = pc.robot("huang2016")
        theirs = program("sensitivity", "--robot", robot.name)
        mine = tolerance.sensitivity(robot)
        keys = {
            f"{name}_over_c" if name.endswith("difference") else name: mine.in_paper_units[name]
            for name in pc.SOURCES[8:]
        }
        self.assertEqual(keys, theirs["global"])
        self.same(as_printed(mine.worst_pose), pose_rows([theirs["worst"]])[0])
        self.assertEqual(mine.worst_3sigma, theirs["worst"]["three_sigma_tilt_rad"])
        self.assertEqual(
            mine.contributors, [(one["name"], one["share"]) for one in theirs["contributors"]]
        )
        self.assertEqual(mine.poses, theirs["poses"])
        theirs = program(
            "sensitivity",
            "--robot",
            robot.name,
            "--quantity",
            "position",
            "--error",
            "0.01",
            "--all-rotations",
        )
        mine = tolerance.sensitivity(robot, "position", relative_error=0.01, all_rotations=True)
        self.assertEqual(
            (mine.mean, mine.error, mine.largest, mine.unit),
            (theirs["global"], theirs["global_error"], theirs["largest"], "mm"),
        )

    def test_what_makes_no_sense(self):
        robot = pc.robot("huang2016")
        for keywords, message in (
            ({"relative_error": 0.0}, "relative_error: expected 1e-09 to 1e.06, got 0"),
            ({"quantity": "weight"}, "quantity: expected one of tilt"),
        ):
            with self.assertRaisesRegex(pc.InvalidArgument, message):
                tolerance.sensitivity(robot, **keywords)


class Stated(TestCase):
    def test_half_widths_by_name(self):
        robot = pc.robot("huang2016")
        exact = pc.Tolerances.stated(robot, {"rod_mean": 0.1, "alpha0": 1e-3})
        self.assertEqual(
            {name: value for name, value in exact.half_widths.items() if value != 0.0},
            {"rod_mean": 0.1, "alpha0": 1e-3},
        )
        self.close(exact.std["rod_mean"], 0.1 / 3, 1e-15)
        uniform = pc.Tolerances.stated(robot, {"rod_mean": 0.1}, distribution="uniform")
        self.close(uniform.std["rod_mean"], 0.1 / np.sqrt(3), 1e-15)
        self.assertIn("set to zero", exact.assumed[0])
        self.assertNotIn("rod_mean", exact.assumed[0])
        generous = pc.Tolerances.stated(robot, {"rod_mean": 0.1}, others="generous")
        self.assertEqual(generous.half_widths["rod_mean"], 0.1)
        self.assertGreater(generous.half_widths["e_x"], 0.0)
        self.assertIn("default tolerances", generous.assumed[0])
        self.assertFalse(any("rod_mean" in one for one in generous.assumed))

    def test_files_hold_the_same(self):
        robot = pc.robot("huang2016")
        mine = pc.Tolerances.stated(robot, {"rod_mean": 0.1, "alpha0": 1e-3}, others="generous")
        path = self.file("tolerances.toml", mine.to_toml())
        again = pc.Tolerances.read(path, robot)
        for name, value in mine.half_widths.items():
            self.close(again.half_widths[name], value, 1e-12)
        self.assertEqual(again.assumed, mine.assumed)
        theirs = program(
            "tolerance",
            "analyze",
            "--robot",
            robot.name,
            "--tolerances",
            path,
            *("--sigma-error", "0.1", "--failure-error", "0.5"),
        )
        self.assertEqual(
            tolerance.analyze(robot, again, sigma_error=0.1, failure_error=0.5).requirements[0]["rss_3sigma"],
            theirs["rss_3sigma"],
        )

    def test_wrong_ones(self):
        robot = pc.robot("huang2016")
        for given, keywords, message in (
            ({"rods": 1.0}, {}, 'expected names of geometric errors, got "rods"'),
            ({"rod_mean": -1.0}, {}, "expected at least 0 for rod_mean, got -1"),
            ({}, {"others": "any"}, 'others: expected "exact" or "generous", got "any"'),
            ({}, {"distribution": "flat"}, "distribution: expected one of normal, uniform"),
        ):
            with self.assertRaisesRegex(pc.InvalidArgument, message):
                pc.Tolerances.stated(robot, given, **keywords)
        with self.assertRaises(pc.InputFileError) as caught:
            pc.Tolerances.read(self.file("wrong.toml", "[tolerances]\nrods_mm = 1\n"), robot)
        self.assertIn("rods_mm", str(caught.exception))


if __name__ == "__main__":
    unittest.main()
