"""Runs commands from Python. Keyword arguments are converted to the words of a command line."""

from __future__ import annotations

import json
import numbers
import os
import re
import sys
import warnings
from typing import Any, Callable, Mapping, Optional, Union

import numpy as np

from . import _postlens
from ._errors import ArgumentError, Error, PostlensWarning, error_of

Progress = Optional[Callable[[float, float], object]]
PathLike = Union[str, "os.PathLike[str]"]
#: The JSON report of a command (--json). Its warnings are also issued by warnings.warn.
Report = dict[str, Any]

_separators = {"size": "x", "shutter": ":", "for_shutter": ":"}
_repeated = {"behind", "holdout", "keep_sharp"}  #: options that may be given several times, with one value each
#: options without a value
_flags = {"breathing", "force", "for_rays", "halves", "plan", "predict", "salvage", "strict"}
_units = ("_m", "_mm", "_um", "_nm", "_px", "_s")


def option_name(keyword: str) -> str:
    """Returns the option for a keyword. Options have no units in their names, so `focus_m` becomes `--focus`."""
    for unit in _units:
        if keyword.endswith(unit):
            keyword = keyword[: -len(unit)]
            break
    return "--" + keyword.replace("_", "-")


def shown(value: object) -> str:
    """Returns a value as error messages show it: in one line of at most 80 characters."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 80 else text[:77] + "..."


def whole(what: str, text: str) -> str:
    """Returns the text unchanged. Raises ArgumentError if it contains a NUL, where the commands would end the text."""
    if "\0" in text:
        raise ArgumentError(f"{what}: contains a NUL (got {shown(text)}; expected none)")
    return text


def _text(keyword: str, value: object) -> str:
    if isinstance(value, str):
        return whole(keyword, value)
    if isinstance(value, os.PathLike):
        return whole(keyword, os.fsdecode(value))
    if isinstance(value, numbers.Real) and not isinstance(value, bool):
        try:
            number = float(value)
        except OverflowError:
            raise ArgumentError(f"{keyword}: too large (expected at most {sys.float_info.max:.2g})") from None
        return str(int(value)) if isinstance(value, numbers.Integral) else repr(number)
    if isinstance(value, np.ndarray) and value.ndim < 2:
        return _text(keyword, value.tolist())
    if isinstance(value, (tuple, list)):
        return _separators.get(keyword, ",").join(_text(keyword, v) for v in value)
    raise ArgumentError(
        f"{keyword}: wrong type (got {type(value).__name__}; expected a number, a text, a path or a tuple)"
    )


def words_of(options: Mapping[str, object]) -> list[str]:
    """Converts keyword arguments to words of the command line. None yields no word, and neither does a flag that is
    False."""
    words: list[str] = []
    for keyword, value in options.items():
        if value is None:
            continue
        name = option_name(keyword)
        if keyword in _flags:
            if not isinstance(value, (bool, np.bool_)):
                raise ArgumentError(f"{keyword}: wrong type (got {shown(value)}; expected True or False)")
            words += [name] if value else []
        elif isinstance(value, Mapping):
            words += [f"{name}={k}={_text(keyword, v)}" for k, v in value.items()]
        elif keyword in _repeated and isinstance(value, (list, tuple)):
            words += [f"{name}={_text(keyword, v)}" for v in value]
        else:
            text = _text(keyword, value)
            if not text:
                raise ArgumentError(f"{keyword}: empty (got {shown(value)}; expected a value, or None)")
            words.append(f"{name}={text}")
    return words


def path_text(what: str, path: object) -> str:
    if not isinstance(path, (str, os.PathLike)):
        raise ArgumentError(f"{what}: wrong type (got {type(path).__name__}; expected a path)")
    text = os.fspath(path)
    if not isinstance(text, str) or not text:
        raise ArgumentError(f"{what}: no path (got {shown(path)}; expected the name of a file)")
    whole(what, text)
    return os.path.join(".", text) if text.startswith("-") else text  # a leading '-' would look like an option


def _in_keywords(text: str, options: Mapping[str, object]) -> str:
    """Replaces the options in an error message by keywords. `--focus: ...` becomes `focus_m: ...`.

    `--help` is not replaced, because it exists only on the command line.
    """
    keywords = {option_name(keyword): keyword for keyword in options}

    def keyword(found: re.Match[str]) -> str:
        option = found.group(0)
        return keywords.get(option, option[2:].replace("-", "_"))

    return re.sub(r"(?<![\w-])--(?!help\b)[a-z]+(?:-[a-z]+)*", keyword, text)


_folder = os.path.dirname(__file__)


def _users_level() -> int:
    """Returns the stacklevel for warnings.warn. Warnings then report the line of the user's code that called us."""
    level, frame = 1, sys._getframe(1)
    while frame.f_back is not None and os.path.dirname(frame.f_code.co_filename) == _folder:
        level, frame = level + 1, frame.f_back
    return level


def run_words(
    words: list[str],
    options: Optional[Mapping[str, object]] = None,
    threads: int = 0,
    progress: Progress = None,
    kept: Optional["_postlens.KeptFrame"] = None,
    file_names: Mapping[str, str] = {},
    pictures_stay: bool = True,
) -> tuple[Report, list[tuple[Any, Optional[float], dict[str, Any]]]]:
    """Runs a command in this process. Returns its report and the pictures that it does not write to files.

    `words` are the words of the command line. `options` are keyword arguments, which are converted to further words. If
    there are `options`, errors and warnings name the keywords instead of the command-line options. `file_names` maps
    paths to the names that appear in texts instead. If `pictures_stay` is False, every picture must be written to a
    file.
    """
    if progress is not None and not callable(progress):
        raise ArgumentError(f"progress: cannot be called (got {type(progress).__name__}; expected a function)")
    if isinstance(threads, bool) or not isinstance(threads, numbers.Integral) or not 0 <= threads <= 4096:
        raise ArgumentError(f"threads: out of range (got {shown(threads)}; expected 0 to 4096)")
    if options is not None:
        words = words + words_of(options)

    def named(text: str) -> str:
        for path, name in file_names.items():
            text = text.replace(path, name)
        return text

    def say(text: str) -> str:
        text = named(text)
        return text if options is None else _in_keywords(text, options)

    try:
        # Names of files may contain bytes that are not UTF-8.
        outcome = _postlens.run([os.fsencode(word) for word in words], int(threads), progress, kept, pictures_stay)
    except Error as error:
        raise error_of(error.exit_code, say(str(error))) from None
    report: Report = json.loads(outcome.json)
    report["exit_code"] = outcome.exit_code
    report["text"] = named(outcome.text)
    report["warnings"] = [{"code": c, "text": say(t), "share": s} for c, t, s in outcome.warnings]
    for warning in report["warnings"]:
        warnings.warn(PostlensWarning(warning["text"], warning["code"], warning["share"]), stacklevel=_users_level())
    return report, outcome.pictures
