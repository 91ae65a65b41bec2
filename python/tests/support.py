"""What the tests share: the program beside the module, published data, a virtual machine."""

import json
import math
import os
import subprocess
import tempfile
import unittest
from html.parser import HTMLParser
from pathlib import Path

import numpy as np

import paracal as pc

SOURCE = Path(__file__).resolve().parents[2]
PUBLISHED = SOURCE / "data" / "huang2016"
DISTANCES, POSES = PUBLISHED / "distances.csv", PUBLISHED / "poses.csv"
#: A plate with six freedoms: pc.robot() and the program take the file.
HEXAPOD = SOURCE / "data" / "robots" / "hexapod.toml"
FIVE_BAR = SOURCE / "data" / "robots" / "five-bar.toml"
SCREW_DELTA = SOURCE / "tests" / "corpus" / "files" / "screw_delta.toml"


def program(*arguments):
    """What the program prints with --json, whatever its verdict."""
    done = subprocess.run(
        [os.environ["PARACAL"], *map(str, arguments), "--json"],
        capture_output=True,
        env={**os.environ, "SOURCE_DATE_EPOCH": "1475668800"},
    )
    if done.returncode not in (0, 1):
        raise AssertionError(f"{arguments}: exit code {done.returncode}: {done.stderr.decode()}")
    return json.loads(done.stdout)


def in_deg(numbers):
    """As the program turns rad into deg."""
    return np.asarray(numbers) * (180.0 / math.pi)


LEVEL = ("x", "y", "z", "phi")


def keys_of(axes):
    """What files call them: x_mm ... phi_deg."""
    return [f"{axis}_{'mm' if axis in 'xyz' else 'deg'}" for axis in axes]


def pose_rows(poses, axes=LEVEL):
    """(n, 4) or (n, 6) of a list of JSON poses, in mm and deg as they stand there; tilts that are
    left out are 0."""

    def number(pose, key):
        stem, unit = key.rsplit("_", 1)
        unsaid = 0.0 if key.startswith("tilt") else None
        return pose.get(key, pose.get(f"{stem}_cmd_{unit}", unsaid))

    return np.array([[number(pose, key) for key in keys_of(axes)] for pose in poses], dtype=float)


def as_printed(poses):
    """Poses in mm and rad as the program prints them: mm and deg."""
    rows = np.array(poses)
    rows[..., 3:] = in_deg(rows[..., 3:])
    return rows


def pose_table(robot, poses):
    """Poses in mm and rad as the file that the program and read_poses() take."""
    rows = "".join(",".join(map(repr, row)) + "\n" for row in as_printed(poses).tolist())
    return ",".join(keys_of(robot.pose_axes)) + "\n" + rows


class Page(HTMLParser):
    """Tags that are open, and the text."""

    def __init__(self, text):
        super().__init__()
        self.open, self.text = [], ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, tag

    def handle_data(self, data):
        self.text += data + " "


def text_shown(result):
    """What a notebook shows of a result, without its tags."""
    page = Page(result._repr_html_())
    assert not page.open, page.open
    return page.text


class TestCase(unittest.TestCase):
    """With a folder of its own, and arrays that are the same to the bit or close."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def file(self, name, text):
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path

    def same(self, one, other):
        np.testing.assert_array_equal(np.asarray(one, dtype=float), np.asarray(other, dtype=float))

    def close(self, one, other, tolerance):
        np.testing.assert_allclose(one, other, rtol=0.0, atol=tolerance)


class VirtualMachine:
    """A machine out of a batch, measured at well chosen poses by an instrument that stands
    anywhere."""

    def __init__(self, robot="huang2016", poses=14, repeats=2, measure="coordinates"):
        self.robot = pc.robot(robot)
        self.plan = pc.select_poses(self.robot, poses, candidates=200, measure=measure)
        self.truth = pc.draw_errors(self.robot, seed=7)
        frame = [
            [0.0, -1.0, 0.0, 2500.0],
            [1.0, 0.0, 0.0, -800.0],
            [0.0, 0.0, 1.0, 300.0],
            [0.0, 0.0, 0.0, 1.0],
        ]
        self.measured = pc.simulate(
            pc.Machine(self.robot, self.truth),
            self.plan,
            measure=measure,
            noise_mm=0.017,
            repeats=repeats,
            read_rotation=self.robot.rotates,
            rotation_noise_rad=1e-4,
            frame=frame,
        )
