"""The exceptions that postlens raises, and its warning."""

from __future__ import annotations


class Error(Exception):
    """An error, described in one line. `exit_code` is the exit code that the command would return."""

    exit_code: int = 3


class ArgumentError(Error, ValueError):
    """An argument is out of range, unknown or missing, or it cannot be combined with another argument."""

    exit_code = 2


class InputError(Error, OSError, ValueError):
    """A file is missing, damaged or of the wrong kind. This error is also an OSError and a ValueError."""

    exit_code = 3


class OutputError(Error, OSError):
    """A file cannot be written. No incomplete file remains."""

    exit_code = 4


class OutOfMemoryError(Error, MemoryError):
    """The work needs more memory than is available. In most cases, the error is raised before the work begins."""

    exit_code = 5


class Cancelled(Error):
    """The work was cancelled."""

    exit_code = 130


class PostlensWarning(UserWarning):
    """A warning of a command, for example about an assumption that it makes.

    `code` is one word that identifies the kind of warning, as in the command's JSON report. `share` is the fraction of
    the pixels that the warning concerns, or 0 if it is not known.
    """

    def __init__(self, text: str, code: str = "", share: float = 0.0) -> None:
        super().__init__(text)
        self.code = code
        self.share = share


_of_code: dict[int, type[Error]] = {
    kind.exit_code: kind for kind in (ArgumentError, InputError, OutputError, OutOfMemoryError, Cancelled)
}


def error_of(exit_code: int, text: str) -> Error:
    """Returns the exception for an exit code of the command. Called by the extension module."""
    error = _of_code.get(exit_code, Error)(text)
    error.exit_code = exit_code
    return error
