#!/usr/bin/env python3
"""Measures how far a trace must subdivide pixels if images are made with rays: a table of docs/planner.md.

    levels_table.py BUILD OUT [--seeds 301-316] [--size 480x270] [--targets 40,48]

BUILD is a build folder (build/release). Each random scene (random_scene.py) and two sample scenes are traced for their
lens with `--subdivide` 0 to 3. `focus` or `shoot --method auto --scene` makes an image for each target. Seconds are of
whole processes, trace and image together. Nothing else should run on the machine. OUT receives levels.md.
"""

import argparse
import json
import os
import subprocess
import sys
import time

import random_scene

HERE = os.path.dirname(os.path.abspath(__file__))
LEVELS = ["0", "1", "2", "3"]
SAMPLES = [("bars_lit.toml", 1.4, 5), ("still_life.toml", 1.8, 0.8)]


def scenes(out, seeds):
    """Name, file and lens of each scene; the name of all random scenes is the same."""
    first, _, last = seeds.partition("-")
    for seed in range(int(first), int(last or first) + 1):
        made = random_scene.write(seed, random_scene.KINDS)
        path = os.path.join(out, "scene.toml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(made.text)
        yield f"random scenes {seeds}", path, made
    for name, f_number, focus_m in SAMPLES:
        path = os.path.join(HERE, "..", "samples", "scenes", name)
        yield name.partition(".")[0], path, random_scene.RandomScene("sample", f_number, focus_m, "", False)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("out")
    parser.add_argument("--seeds", default="301-316")
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--targets", default="40,48")
    o = parser.parse_args()
    os.makedirs(o.out, exist_ok=True)
    program = os.path.join(o.build, "apps", "postlens")
    traced, picture = os.path.join(o.out, "traced.exr"), os.path.join(o.out, "picture.exr")

    def run(*words):
        """Seconds of a command and its report."""
        start = time.monotonic()
        process = subprocess.run([program, *words, "--quiet", "--json"], capture_output=True, check=False, text=True)
        if process.returncode not in (0, 6):  # 6: the target is not met
            sys.exit(f"levels_table.py: {' '.join(words)} failed\n{process.stderr}")
        return time.monotonic() - start, json.loads(process.stdout)

    seconds, met, pictures = {}, {}, {}
    for name, scene, made in scenes(o.out, o.seeds):
        command = "shoot" if made.shutter else "focus"
        for level in LEVELS:
            of_trace, _ = run("trace", scene, "-o", traced, "--size", o.size, "--subdivide", level, *made.traced_for())
            for target in o.targets.split(","):
                of_image, report = run(command, traced, "-o", picture, "--method", "auto", "--target-db", target,
                                       "--scene", scene, *made.rendered_for())  # fmt: skip
                cell = (name, target, level)
                seconds[cell] = seconds.get(cell, 0) + of_trace + of_image
                met[cell] = met.get(cell, 0) + (report["stated_db"] is None or report["stated_db"] >= float(target))
                pictures[cell] = pictures.get(cell, 0) + 1
    lines = ["| seconds, trace and image | target, dB | " + " | ".join(f"`--subdivide {level}`" for level in LEVELS) + " |",
             "|---|---|" + "---|" * len(LEVELS)]  # fmt: skip
    for name, target in dict.fromkeys((name, target) for name, target, _ in seconds):
        cells = []
        for level in LEVELS:
            cell = (name, target, level)
            missed = pictures[cell] - met[cell]
            cells.append(f"{seconds[cell]:.1f}" + (f" ({missed} of {pictures[cell]} missed the target)" if missed else ""))
        lines.append(f"| {name} | {target} | {' | '.join(cells)} |")
    with open(os.path.join(o.out, "levels.md"), "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
