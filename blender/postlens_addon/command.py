"""Runs the installed program `postlens` as a child process."""

import json
import os
import shutil
import subprocess
import threading


class CommandError(Exception):
    """The command has failed. The text of the exception is its error message."""


class Cancelled(Exception):
    """The user has cancelled the work."""


def find(path):
    """Path of the program: `path` if it is given, else `postlens` on the search path. Raises CommandError if there is
    no program."""
    program = path or shutil.which("postlens") or ""
    if not program or not os.access(program, os.X_OK) or os.path.isdir(program):
        raise CommandError(
            f"postlens is not installed (looked for {path or 'postlens on the search path'}; set its path in the add-on's panel)"
        )
    return program


def run(program, words, cancelled=lambda: False):
    """Runs a command and returns its JSON report (--json). Raises CommandError and Cancelled."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
    child = subprocess.Popen(
        [program, *words, "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    )
    said = []
    reader = threading.Thread(target=lambda: said.extend(child.communicate()), daemon=True)
    reader.start()
    while reader.is_alive():
        reader.join(0.05)
        if reader.is_alive() and cancelled():
            child.terminate()
            reader.join()
            raise Cancelled()
    out, err = said
    if child.returncode not in (0, 6):
        line = (err.strip().splitlines() or [f"postlens ended with code {child.returncode}"])[-1]
        raise CommandError(line)
    return json.loads(out)
