"""Accuracy of parallel pick-and-place robots: error model, tolerances, calibration, compensation.

    import paracal as pc

    robot = pc.robot("huang2016")
    measured = pc.read_measurements("distances.csv", poses="poses.csv", robot=robot)
    calibration = pc.calibrate(robot, measured)   # verdict, values, U, covariance, notes
    joints, status = pc.inverse(calibration, [[200, -130, -930, 0.5]])

Arrays are in mm and rad. Files and tables are in mm and deg; column names state the unit.
Geometric errors are actual minus nominal. Frames and signs: docs/conventions.md.

Mistakes of the caller or in a file raise exceptions (Error, InvalidArgument, InputFileError,
Unreachable). A pose out of reach or a fit without convergence raises nothing; the result contains a
status. Long computations release the interpreter lock, so other threads can run; Ctrl-C stops
them. Results can be copied and pickled. They equal those of the program to the bit.
"""

from . import _paracal, tolerance
from .calibration import Calibration, calibrate
from .compensation import Compensation, CompensationStatus, compensate
from .errors import Error, InputFileError, InvalidArgument, Unreachable
from .kinematics import (
    Driven,
    Forward,
    ForwardStatus,
    Inverse,
    InverseStatus,
    Jacobian,
    drive,
    forward,
    inverse,
    jacobian,
)
from .known import KnownMachine, NullDirection, Prediction, read_calibration
from .measurements import Measurements, merge, read_joints, read_measurements, read_poses
from .plans import (
    Identifiability,
    Plan,
    identifiability,
    paper_plan,
    select_poses,
    simulate,
    validation_poses,
    workspace_poses,
)
from .robots import (
    SOURCES,
    Machine,
    Robot,
    catalogue,
    draw_errors,
    errors_frame,
    errors_toml,
    read_errors,
    robot,
    robot_of_toml,
    robot_template,
)
from .tolerances import Tolerances
from .validation import Validation, validate

__version__: str = _paracal.version
__build__: str = _paracal.build

__all__ = [
    "Calibration",
    "Compensation",
    "CompensationStatus",
    "Driven",
    "Error",
    "Forward",
    "ForwardStatus",
    "Identifiability",
    "InputFileError",
    "InvalidArgument",
    "Inverse",
    "InverseStatus",
    "Jacobian",
    "KnownMachine",
    "Machine",
    "Measurements",
    "NullDirection",
    "Plan",
    "Prediction",
    "Robot",
    "SOURCES",
    "Tolerances",
    "Unreachable",
    "Validation",
    "calibrate",
    "catalogue",
    "compensate",
    "draw_errors",
    "drive",
    "errors_frame",
    "errors_toml",
    "forward",
    "identifiability",
    "inverse",
    "jacobian",
    "merge",
    "paper_plan",
    "read_calibration",
    "read_errors",
    "read_joints",
    "read_measurements",
    "read_poses",
    "robot",
    "robot_of_toml",
    "robot_template",
    "select_poses",
    "simulate",
    "tolerance",
    "validate",
    "validation_poses",
    "workspace_poses",
]
