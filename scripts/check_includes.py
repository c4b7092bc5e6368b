#!/usr/bin/env python3
"""Checks that the sources include only folders that their READMEs allow, and that the dependencies have no cycles.

    check_includes.py

Every folder of the libraries and programs has a README.md with a sentence "May include `core/`, `lens/`.", or "May
include nothing of postlens". A name stands for the folder and its subfolders; within such a folder, for the folder
itself alone. The check fails if a file includes a folder that its README does not allow, if a README allows a folder
that no file includes, or if two folders may include each other, directly or through other folders.
"""

import os
import re
import sys

HERE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
TOP = "core lens records reproject focus motionblur tracer planner compare sweep chart apps python".split()


def folders():
    for top in TOP:
        for folder, _, files in os.walk(os.path.join(HERE, top)):
            sources = [os.path.join(folder, name) for name in sorted(files) if name.endswith((".h", ".cpp"))]
            if sources:
                yield os.path.relpath(folder, HERE), sources


def allowed_by(folder):
    """The folders that a README allows, or None if it has no such sentence."""
    try:
        with open(os.path.join(HERE, folder, "README.md"), encoding="utf-8") as file:
            text = file.read()
    except OSError:
        return None
    sentence = re.search(r"^May include ([^.]*)\.", text, re.MULTILINE)
    return sentence and re.findall(r"`([a-z/]+)/`", sentence.group(1))


def covers(name, target, folder):
    """Whether a name in the README of `folder` stands for `target`."""
    return target == name or (target.startswith(name + "/") and not folder.startswith(name + "/"))


def main():
    problems, arrows = [], {}
    for folder, sources in folders():
        allowed = allowed_by(folder)
        if allowed is None:
            problems.append(f"{folder}/README.md: does not say what may be included (expected \"May include ...\")")
            continue
        arrows[folder] = allowed
        used = set()
        for path in sources:
            with open(path, encoding="utf-8") as file:
                included = re.findall(r'^#include "([^"]+)"', file.read(), re.MULTILINE)
            for target in {os.path.dirname(name) for name in included} - {folder}:
                names = [name for name in allowed if covers(name, target, folder)]
                used.update(names)
                if not names:
                    problems.append(f"{os.path.relpath(path, HERE)}: includes {target}/ (expected "
                                    f"{', '.join(name + '/' for name in allowed) or 'nothing'})")
        for name in sorted(set(allowed) - used):
            problems.append(f"{folder}/README.md: allows {name}/, which nothing in {folder}/ includes")

    def reaches(start, goal, seen):
        for name in arrows.get(start, []):
            if covers(name, goal, start) or name not in seen and reaches(name, goal, seen | {name}):
                return True
        return False

    for folder in arrows:
        if reaches(folder, folder, frozenset()):
            problems.append(f"{folder}/README.md: {folder}/ may include itself by way of others")
    for problem in problems:
        print(f"check_includes.py: {problem}", file=sys.stderr)
    if problems:
        sys.exit(1)
    print(f"includes: {len(arrows)} folders, as their READMEs say")


if __name__ == "__main__":
    main()
