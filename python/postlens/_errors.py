"""What postlens raises, and what it warns with."""

from __future__ import annotations


class Error(Exception):
    """What went wrong, in one line. `exit_code` is what the command would have ended with."""

    exit_code: int = 3


class ArgumentError(Error, ValueError):
    """An argument out of range, unknown, missing, or one that does not go with another."""

    exit_code = 2


class InputError(Error, OSError, ValueError):
    """A file that is missing, damaged, or not what it should be. An OSError and a ValueError."""

    exit_code = 3


class OutputError(Error, OSError):
    """A file that cannot be written. Nothing of it is left."""

    exit_code = 4


class OutOfMemoryError(Error, MemoryError):
    """The work would need more memory than there is; mostly said before it begins."""

    exit_code = 5


class Cancelled(Error):
    """The work was stopped from outside."""

    exit_code = 130


class PostlensWarning(UserWarning):
    """What a picture lacks or what was assumed. `code` is one word, as in the command's JSON; `share` of the
    pixels is concerned, 0 where that is not known."""

    def __init__(self, text: str, code: str = "", share: float = 0.0) -> None:
        super().__init__(text)
        self.code = code
        self.share = share


_of_code: dict[int, type[Error]] = {
    kind.exit_code: kind for kind in (ArgumentError, InputError, OutputError, OutOfMemoryError, Cancelled)
}


def error_of(exit_code: int, text: str) -> Error:
    """Called by the extension: the exception for one of the command's exit codes."""
    error = _of_code.get(exit_code, Error)(text)
    error.exit_code = exit_code
    return error
