"""Runs the installed program `postlens` as a child process."""

import json
import os
import shutil
import subprocess
import threading


# Time, in seconds, in which a stopped command can remove its unfinished output before it is killed.
ENDING_S = 5.0


class CommandError(Exception):
    """The command has failed. The text of the exception is the command's error message."""


class Cancelled(Exception):
    """The user has cancelled the work."""


def find(path):
    """Returns the path of the program: `path` if it is given, and otherwise `postlens` on the search path. Raises
    CommandError if there is no program."""
    program = path or shutil.which("postlens") or ""
    if not program or not os.access(program, os.X_OK) or os.path.isdir(program):
        raise CommandError(
            f"postlens is not installed (looked for {path or 'postlens on the search path'}; set its path in the add-on's panel)"
        )
    return os.path.abspath(program)


def end(child):
    """Stops a command that still runs. The command gets time to remove its unfinished output."""
    if child.poll() is not None:
        return
    child.terminate()
    try:
        child.wait(ENDING_S)
    except subprocess.TimeoutExpired:
        child.kill()
        child.wait()


def run(program, words, folder, cancelled=lambda: False):
    """Runs a command in a folder. This generator yields while the command runs, and returns its JSON report (--json).

    Raises CommandError and Cancelled. If the generator is closed, the command is stopped.
    """
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
    child = subprocess.Popen(
        [program, *words, "--json"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment, cwd=folder,
        # A message may contain a file name that is not valid UTF-8.
        encoding="utf-8", errors="replace",
    )  # fmt: skip
    said = []
    reader = threading.Thread(target=lambda: said.extend(child.communicate()), daemon=True)
    reader.start()
    try:
        while reader.is_alive():
            if cancelled():
                raise Cancelled()
            yield
    finally:
        end(child)
        reader.join()
    out, err = said
    if child.returncode not in (0, 6):
        line = (err.strip().splitlines() or [f"postlens ended with code {child.returncode}"])[-1]
        raise CommandError(line)
    try:
        return json.loads(out)
    except ValueError as error:
        raise CommandError(f"{program} is not postlens (expected a report in JSON)") from error
