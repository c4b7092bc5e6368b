#!/usr/bin/env python3
"""Checks that the sources include only folders that their READMEs allow, and that the dependencies have no cycles.

    check_includes.py

Every top-level folder has a README.md with a sentence such as "May include `core/`, `lens/`." or "May include nothing
of postlens". A subfolder with its own README.md has its own sentence. A subfolder without one is a part of the folder
around it and has the same rights. A name in the sentence allows that folder and its subfolders. Within the named folder
itself, it allows only the folder and its parts.

The check fails in four cases:
- A file includes a folder that its README does not allow.
- A README allows a folder that no file includes.
- Two folders may include each other, directly or through other folders.
- Parts of a folder include each other in a cycle. This does not concern the files at the top of the folder, which may
  include its parts and be included by them.
"""

import os
import re
import sys

HERE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
TOP = ("core lens pictures records reproject focus motionblur scene tracer planner compare sweep chart apps postlens python"
       .split())


def folders():
    for top in TOP:
        for folder, _, files in os.walk(os.path.join(HERE, top)):
            sources = [os.path.join(folder, name) for name in sorted(files) if name.endswith((".h", ".cpp"))]
            if sources:
                yield os.path.relpath(folder, HERE), sources


def owner(folder):
    """Returns the folder whose README applies to `folder`: `folder` itself, or the nearest parent with a README."""
    while "/" in folder and not os.path.exists(os.path.join(HERE, folder, "README.md")):
        folder = os.path.dirname(folder)
    return folder


def allowed_by(folder):
    """Returns the folders that a README allows, or None if it has no "May include" sentence."""
    try:
        with open(os.path.join(HERE, folder, "README.md"), encoding="utf-8") as file:
            text = file.read()
    except OSError:
        return None
    sentence = re.search(r"^May include ([^.]*)\.", text, re.MULTILINE)
    return sentence and re.findall(r"`([a-z_/]+)/`", sentence.group(1))


def covers(name, target, folder):
    """Returns whether a name in the README of `folder` allows the folder `target`."""
    return target == name or (target.startswith(name + "/") and not folder.startswith(name + "/"))


def cycle(arrows):
    """Returns a cycle as a list of folders that begins and ends with the same folder, or None if there is no cycle."""
    def search(path):
        for target in sorted(arrows.get(path[-1], ())):
            if target == path[0]:
                return path + [target]
            if target not in seen:
                seen.add(target)
                found = search(path + [target])
                if found:
                    return found
        return None

    for start in sorted(arrows):
        seen = set()
        found = search([start])
        if found:
            return found
    return None


def main():
    problems, arrows, used, parts = [], {}, {}, {}
    for folder, sources in folders():
        reader = owner(folder)
        if reader not in arrows:
            allowed = allowed_by(reader)
            if allowed is None:
                problems.append(f"{reader}/README.md: does not say what may be included (expected \"May include ...\")")
            arrows[reader], used[reader] = allowed or [], set()
        for path in sources:
            with open(path, encoding="utf-8") as file:
                included = re.findall(r'^#include "([^"]+)"', file.read(), re.MULTILINE)
            for part in {os.path.dirname(name) for name in included} - {folder}:
                target = owner(part)
                if target == reader:
                    if reader not in (folder, part):
                        parts.setdefault(reader, {}).setdefault(folder, set()).add(part)
                    continue
                names = [name for name in arrows[reader] if covers(name, target, reader)]
                used[reader].update(names)
                if not names:
                    problems.append(f"{os.path.relpath(path, HERE)}: includes {part}/ (expected "
                                    f"{', '.join(name + '/' for name in arrows[reader]) or 'nothing'})")
    for folder, allowed in arrows.items():
        for name in sorted(set(allowed) - used[folder]):
            problems.append(f"{folder}/README.md: allows {name}/, which nothing in {folder}/ includes")

    def reaches(start, goal, seen):
        for name in arrows.get(start, []):
            if covers(name, goal, start) or name not in seen and reaches(name, goal, seen | {name}):
                return True
        return False

    for folder in arrows:
        if reaches(folder, folder, frozenset()):
            problems.append(f"{folder}/README.md: {folder}/ may include itself by way of others")
    for folder, between in parts.items():
        found = cycle(between)
        if found:
            problems.append(f"{folder}/: its parts include each other in a circle: {' -> '.join(found)}")
    for problem in problems:
        print(f"check_includes.py: {problem}", file=sys.stderr)
    if problems:
        sys.exit(1)
    print(f"includes: {len(arrows)} folders, as their READMEs say")


if __name__ == "__main__":
    main()
