"""What the tests share: the program beside the module, published data, a virtual machine."""

import json
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

import paracal as pc

SOURCE = Path(__file__).resolve().parents[2]
PUBLISHED = SOURCE / "data" / "huang2016"
DISTANCES, POSES = PUBLISHED / "distances.csv", PUBLISHED / "poses.csv"


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


def pose_rows(poses):
    """(n, 4) of a list of JSON poses, in mm and deg as they stand there."""
    keys = ("x_mm", "y_mm", "z_mm", "phi_deg")
    return np.array(
        [[pose.get(key, pose.get(key.replace("_", "_cmd_"))) for key in keys] for pose in poses]
    )


def as_printed(poses):
    """(n, 4) in mm and rad as the program prints them: mm and deg."""
    rows = np.array(poses)
    rows[..., 3] = in_deg(rows[..., 3])
    return rows


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
    """A machine out of a batch, measured at well chosen poses by a tracker that stands anywhere."""

    def __init__(self, robot="huang2016", poses=14, repeats=2):
        self.robot = pc.robot(robot)
        self.plan = pc.select_poses(self.robot, poses, candidates=200)
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
            noise_mm=0.017,
            repeats=repeats,
            read_rotation=self.robot.rotates,
            rotation_noise_rad=1e-4,
            frame=frame,
        )
