"""What is raised, always for what the caller or a file got wrong. What the numbers say (a pose out
of reach, a fit that does not settle) is a status in the result."""

from __future__ import annotations


class Error(Exception):
    """Root of everything that paracal raises by itself."""


class InvalidArgument(Error, ValueError):
    """An argument that cannot be meant: a negative sigma, an array of another shape. The message
    names it, what was expected and what came."""


class Unreachable(Error, ValueError):
    """A station of a plan or of measurements that the robot does not reach. The message names
    it."""


class InputFileError(Error):
    """A table or file that cannot be used. The message reads `file:line: expected ..., got ...`.

    file: its name; of a DataFrame or a dict "table".
    line: from 1, the header's first; 0 where the file as a whole is at fault.
    """

    def __init__(self, message: str, file: str = "", line: int = 0) -> None:
        super().__init__(message)
        self.file = file
        self.line = line

    def __reduce__(self) -> tuple[type[InputFileError], tuple[str, str, int]]:
        return InputFileError, (str(self), self.file, self.line)
