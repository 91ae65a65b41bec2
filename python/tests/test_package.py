"""What a user meets: notebooks, docstrings, types, no pandas, examples, an installation."""

import inspect
import os
import re
import subprocess
import sys
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
from support import DISTANCES, POSES, SOURCE, TestCase, text_shown

import paracal as pc
from paracal import _html


class Notebooks(TestCase):
    def test_results_show_themselves(self):
        robot = pc.robot("huang2016")
        measured = pc.read_measurements(DISTANCES, poses=POSES)
        calibration = pc.calibrate(robot, measured)
        text = text_shown(calibration)
        for part in (
            "huang2016: accepted",
            "theta_offset",
            "0.206",
            "0.8447",
            "deg",
            "note:",
            "assumed:",
        ):
            self.assertIn(part, text)
        rejected = text_shown(pc.calibrate(robot, measured, limit_mm=0.01))
        self.assertIn("rejected", rejected)
        self.assertIn("because:", rejected)
        self.assertIn("distances 6", text_shown(measured))
        self.assertIn("rod_mm 950", text_shown(robot))
        plan = pc.paper_plan(robot, "rough")
        self.assertIn("-888", text_shown(plan))
        self.assertIn("are determined by", text_shown(pc.identifiability(robot, plan)))
        self.assertIn("theta_offset 0.02618 rad", text_shown(pc.Tolerances.of(robot)))
        self.assertIn("yield", text_shown(pc.tolerance.analyze(robot, sigma_error=0.2, failure_error=0.5)))
        self.assertIn("optimal", text_shown(pc.tolerance.allocate(robot)))
        self.assertIn(
            "rod_difference", text_shown(pc.tolerance.sensitivity(robot, relative_error=0.1))
        )
        validation = text_shown(pc.validate(calibration, measured, limit_mm=1.0))
        self.assertIn("not accepted", validation)
        self.assertIn("cannot confirm it", validation)

    def test_names_cannot_be_markup(self):
        text = pc.robot("huang2016").to_toml().replace("huang2016", "<script>alert(1)</script>")
        self.assertNotIn("<script>", pc.robot_of_toml(text)._repr_html_())

    def test_cells_and_notes_cannot_be_markup(self):
        plan = pc.Plan(pc.robot("huang2016"), ["<b>P0</b>"], np.zeros((1, 4)), [], {})
        self.assertNotIn("<b>P0", plan._repr_html_())
        self.assertIn("&lt;b&gt;P0", plan._repr_html_())
        self.assertEqual(_html.items("note", ["<i>"]), "<ul><li>note: &lt;i&gt;</li></ul>")

    def test_short_forms_say_what_they_are(self):
        robot = pc.robot("linear_delta")
        self.assertEqual(repr(robot), "<paracal.Robot linear_delta: 3 limbs, joints in mm>")
        self.assertEqual(
            repr(pc.Machine(robot, robot.errors(rod_mean=0.1))),
            "<paracal.Machine linear_delta with 3 geometric errors>",
        )


class Frames(TestCase):
    def test_results_become_frames(self):
        robot = pc.robot("huang2016")
        measured = pc.read_measurements(DISTANCES, poses=POSES)
        calibration = pc.calibrate(robot, measured)
        frame = calibration.to_frame()
        self.assertEqual(list(frame.index), calibration.names)
        self.same(frame["U"], calibration.U)
        residuals = calibration.residuals()
        self.assertEqual(len(residuals), 6)
        self.same(residuals["distance_mm"], measured.to_frame()["distance_mm"])
        errors = pc.errors_frame(robot, calibration.errors)
        self.same(errors["theta_offset_rad"], calibration.values[~calibration.held])
        self.assertEqual(list(errors)[:2], ["theta_offset_rad", "e_x_mm"])
        self.assertEqual(len(pc.validate(calibration, measured).to_frame()), 6)
        plan = pc.paper_plan(robot, "rough")
        turned = pc.paper_plan(robot, "fine")
        self.close(pc.read_poses(turned.to_frame())[1], turned.poses, 1e-12)
        self.assertGreater(np.ptp(turned.poses[:, 3]), 1.0)
        self.same(
            pc.tolerance.sensitivity(robot, relative_error=0.1).to_frame()["mean"],
            list(pc.tolerance.sensitivity(robot, relative_error=0.1).mean.values()),
        )
        self.assertEqual(pc.tolerance.analyze(robot, sigma_error=0.2, failure_error=0.5).to_frame().index[0], "tilt")
        self.assertEqual(pc.identifiability(robot, plan).to_frame().shape[1], 3)
        self.assertEqual(pc.Tolerances.of(robot).to_frame().shape, (14, 3))

    def test_without_pandas_everything_else_works(self):
        with mock.patch.dict(sys.modules, {"pandas": None}):
            robot = pc.robot("huang2016")
            measured = pc.read_measurements(DISTANCES, poses=POSES)
            self.assertTrue(pc.calibrate(robot, measured).accepted)
            with self.assertRaisesRegex(ImportError, "python3-pandas"):
                measured.to_frame()
        code = (
            "import sys; sys.modules['pandas'] = None; import paracal; print(paracal.__version__)"
        )
        self.assertEqual(run("-c", code).strip(), pc.__version__)


def run(*arguments, **keywords):
    done = subprocess.run(
        [sys.executable, "-W", "error", *map(str, arguments)],
        capture_output=True,
        text=True,
        **keywords,
    )
    if done.returncode != 0:
        raise AssertionError(f"{arguments}\n{done.stdout}\n{done.stderr}")
    return done.stdout


class Docstrings(TestCase):
    def public(self):
        for name in pc.__all__:
            one = getattr(pc, name)
            if inspect.ismodule(one):
                yield from (
                    (f"{name}.{key}", value)
                    for key, value in vars(one).items()
                    if getattr(value, "__module__", "") == one.__name__ and not key.startswith("_")
                )
            elif callable(one):
                yield name, one
                for key, value in vars(one).items() if inspect.isclass(one) else ():
                    if not key.startswith("_") and (
                        inspect.isfunction(value) or isinstance(value, property)
                    ):
                        yield f"{name}.{key}", value

    def test_everything_public_has_one(self):
        for name, one in self.public():
            self.assertTrue(inspect.getdoc(one), name)

    def test_lengths_and_angles_name_their_units(self):
        """Arguments end in a unit, or the docstring names it."""
        for name, one in self.public():
            if not inspect.isfunction(one) or name.split(".")[0][0].isupper():
                continue
            arguments = set(inspect.signature(one).parameters)
            if arguments & {"poses", "joints", "errors"} and name != "read_measurements":
                self.assertRegex(
                    inspect.getdoc(one),
                    r"(?=[\s\S]*\bmm\b)(?=[\s\S]*\brad\b)|_mm|as in|as forward|Plan",
                    name,
                )
            for argument in arguments & {"noise", "sigma", "limit", "threshold_mm", "max_tilt"}:
                self.fail(f"{name}: {argument} has no unit")

    def test_every_name_is_there(self):
        self.assertEqual(sorted(set(pc.__all__)), sorted(pc.__all__))
        for name in ("calibrate", "inverse", "read_measurements", "compensate"):
            self.assertIn(name, pc.__all__)


class WrongNames(TestCase):
    def test_messages_name_what_is_public(self):
        robot = pc.robot("huang2016")
        calibration = pc.calibrate(robot, pc.read_measurements(DISTANCES, poses=POSES))
        for of, wrong, message in (
            (calibration, "idntified", "'Calibration' object has no attribute 'idntified'"),
            (robot, "limbs", "'Robot' object has no attribute 'limbs'"),
            (pc, "calibrat", "module 'paracal' has no attribute 'calibrat'"),
        ):
            with self.assertRaises(AttributeError) as caught:
                getattr(of, wrong)
            self.assertEqual(str(caught.exception), message)
            self.assertEqual((caught.exception.obj, caught.exception.name), (of, wrong))

    def test_what_is_no_robot_is_said_to_be_none(self):
        """And none of the attributes that it lacks, which nobody knows."""
        robot = pc.robot("huang2016")
        joints = np.zeros(4)
        for call in (
            lambda no: pc.Machine(no),
            lambda no: pc.Tolerances.of(no),
            lambda no: pc.Tolerances.stated(no, {}),
            lambda no: pc.Tolerances.read("none.toml", no),
            lambda no: pc.calibrate(no, pc.read_measurements(DISTANCES, poses=POSES)),
            lambda no: pc.draw_errors(no),
            lambda no: pc.errors_frame(no, joints),
            lambda no: pc.errors_toml(no, joints),
            lambda no: pc.identifiability(no, [[0, 0, -888]]),
            lambda no: pc.paper_plan(no),
            lambda no: pc.read_calibration("none.json", no),
            lambda no: pc.read_errors(no, "none.toml"),
            lambda no: pc.read_joints({"q1_deg": [0]}, no),
            lambda no: pc.read_measurements(DISTANCES, poses=POSES, robot=no),
            lambda no: pc.read_poses(POSES, no),
            lambda no: pc.select_poses(no),
            lambda no: pc.simulate(no, [[0, 0, -888]]),
            lambda no: pc.tolerance.allocate(no),
            lambda no: pc.tolerance.analyze(no),
            lambda no: pc.tolerance.sensitivity(no),
            lambda no: pc.validation_poses(no),
            lambda no: pc.workspace_poses(no),
        ):
            with self.assertRaisesRegex(pc.InvalidArgument, "robot: expected a Robot.* got str"):
                call("huang2016")
        measured = pc.read_measurements(DISTANCES, poses=POSES)
        for call in (
            lambda no: pc.calibrate(robot, no),
            lambda no: pc.validate(pc.calibrate(robot, measured), no),
            lambda no: pc.merge([measured, no]),
        ):
            with self.assertRaisesRegex(pc.InvalidArgument, "measurements: expected .* got dict"):
                call({})
        for call in (
            lambda no: pc.calibrate(robot, measured, tolerances=no),
            lambda no: pc.draw_errors(robot, tolerances=no),
            lambda no: pc.tolerance.analyze(robot, no),
            lambda no: pc.tolerance.sensitivity(robot, tolerances=no),
            lambda no: pc.select_poses(robot, tolerances=no),
        ):
            with self.assertRaisesRegex(pc.InvalidArgument, "tolerances: expected .* got dict"):
                call({})


class Types(TestCase):
    def test_stubs_are_the_module(self):
        # What pybind11 makes of every class, and mypy cannot know.
        allowed = self.file("allowed.txt", r"paracal\._paracal\.[A-Z]\w+(\.__init__)?")
        run(
            "-m",
            "mypy.stubtest",
            "paracal._paracal",
            "--ignore-missing-stub",
            "--allowlist",
            allowed,
        )

    def check(self, *what):
        """By mypy, in the folder where it finds the package."""
        strict = ("--strict", "--ignore-missing-imports", "--python-version", "3.11")
        package = Path(pc.__file__).parent
        run("-m", "mypy", *strict, *what, cwd=package.parent, env={**os.environ, "PYTHONPATH": ""})

    def test_the_package_is_typed(self):
        self.assertTrue((Path(pc.__file__).parent / "py.typed").exists())
        self.check("-p", "paracal")

    def test_the_examples_are_what_types_allow(self):
        for script in sorted((SOURCE / "python" / "examples").glob("*.py")):
            with self.subTest(script.name):
                self.check(script)


class Installed(TestCase):
    def test_what_is_installed_is_found(self):
        build = Path(os.environ["PARACAL"]).parents[1]
        command = ["cmake", "--install", build, "--prefix", self.folder, "--component", "python"]
        subprocess.run([str(one) for one in command], check=True, capture_output=True)
        (package,) = self.folder.glob("lib/python3*/dist-packages/paracal")
        files = {path.name for path in package.iterdir()}
        self.assertLessEqual({"py.typed", "_paracal.pyi", "__init__.py"}, files)
        self.assertNotIn("__pycache__", files)
        code = "import paracal; print(paracal.__file__)"
        printed = run("-c", code, env={**os.environ, "PYTHONPATH": str(package.parent)})
        self.assertEqual(printed.strip(), str(package / "__init__.py"))


class Examples(TestCase):
    def test_they_run(self):
        scripts = sorted((SOURCE / "python" / "examples").glob("*.py"))
        self.assertGreaterEqual(len(scripts), 3)
        for script in scripts:
            with self.subTest(script.name):
                text = script.read_text(encoding="utf-8")
                self.assertIn("# %%", text)
                printed = run(
                    script,
                    cwd=self.folder,
                    env={**os.environ, "PARACAL_DATA": str(SOURCE / "data")},
                )
                expected = re.findall(r"^# prints: (.*)$", text, re.MULTILINE)
                self.assertTrue(expected, script.name)
                for line in expected:
                    self.assertIn(line, printed, script.name)

    def test_the_page_shows_what_comes_out(self):
        page = (SOURCE / "docs" / "python.md").read_text(encoding="utf-8")
        program, output = re.search(
            r"```python\n(.*?)```\n\n```\n(.*?)```", page, re.DOTALL
        ).groups()
        self.assertEqual(run("-c", program, cwd=SOURCE), output)

    def test_calls_of_the_page_exist(self):
        page = (SOURCE / "docs" / "python.md").read_text(encoding="utf-8")
        calls = set(re.findall(r"\bpc\.([a-z_]+(?:\.[a-z_]+)?)\(", page))
        self.assertGreater(len(calls), 15)
        for call in calls:
            of = pc
            for part in call.split("."):
                of = getattr(of, part)


if __name__ == "__main__":
    unittest.main()
