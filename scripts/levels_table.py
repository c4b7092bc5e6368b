#!/usr/bin/env python3
"""Measures how finely a trace must subdivide pixels if images are made with rays: a table of docs/planner.md.

    levels_table.py BUILD OUT [--seeds 301-316] [--size 480x270] [--targets 40,48]

BUILD is a build folder (build/release). Each random scene (random_scene.py) and two sample scenes are traced for their
lens with `--subdivide` 0 to 3. `focus` or `shoot --method auto --scene` makes an image for each target. Seconds are
those of whole processes: the trace plus the image. Nothing else should run on the machine. OUT receives levels.md.
"""

import argparse
import os

import certify
import random_scene

LEVELS = ["0", "1", "2", "3"]
SAMPLES = [("bars_lit.toml", 1.4, 5), ("still_life.toml", 1.8, 0.8)]


def scenes(bench, seeds):
    """Yields the name, file and lens of each scene. All random scenes have the same name."""
    for _, path, _, made in certify.random_scenes(bench, seeds, random_scene.KINDS):
        yield f"random scenes {seeds}", path, made
    for name, f_number, focus_m in SAMPLES:
        path = os.path.join(certify.SCENES, name)
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
    bench = certify.Bench(o.build, o.out)
    traced, picture = bench.path("traced.exr"), bench.path("picture.exr")

    seconds, met, pictures = {}, {}, {}
    for name, scene, made in scenes(bench, o.seeds):
        command = "shoot" if made.shutter else "focus"
        for level in LEVELS:
            of_trace, _ = bench.timed("trace", scene, "-o", traced, "--size", o.size, "--subdivide", level, *made.traced_for())
            for target in o.targets.split(","):
                of_image, report = bench.timed(command, traced, "-o", picture, "--method", "auto", "--target-db", target,
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
    with open(bench.path("levels.md"), "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
