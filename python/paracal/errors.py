"""Exceptions: only for mistakes of the caller or in a file. A pose out of reach or a fit without
convergence raises nothing; the result contains a status."""

from __future__ import annotations


class Error(Exception):
    """Base class of the exceptions of paracal."""


class InvalidArgument(Error, ValueError):
    """An invalid argument: a negative sigma, an array of another shape. The message states the
    argument, what was expected, and what was found."""


class Unreachable(Error, ValueError):
    """A pose of a plan or of measurements that the robot cannot reach. The message names the
    pose."""


class InputFileError(Error):
    """A table or file that cannot be used. The message reads `file:line: expected ..., got ...`.

    file: its name; "table" for a DataFrame or a dict.
    line: counted from 1, including the header; 0: the whole file.
    """

    def __init__(self, message: str, file: str = "", line: int = 0) -> None:
        super().__init__(message)
        self.file = file
        self.line = line

    def __reduce__(self) -> tuple[type[InputFileError], tuple[str, str, int]]:
        return InputFileError, (str(self), self.file, self.line)
