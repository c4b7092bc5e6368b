#!/usr/bin/env python3
"""What ids are worth in another program's picture: the table of docs/inputs.md.

    ids_table.py BUILD OUT [--spp N]

BUILD is a built folder (build/release). Each scene is traced through a pinhole and written as another program would have it
(bench/foreign_export.cpp): a flat picture with the depth of what fills most of a pixel or the mean of all, without ids, with
one id a pixel, or with a Cryptomatte. Each is focused by `layers` and `scatter` and held against rays through the lens, two
independent halves of N samples a pixel each; errors are those above their noise. OUT gets the table as ids.md and all
pictures; references that it already has are used again.
"""

import argparse
import json
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(HERE, "..", "samples", "scenes")
# Scene, size, f-number, focus distance in m, name in the table.
CASES = [
    ("bars", "480x270", "1.4", "5", "bars, 480x270, f/1.4 at 5 m"),
    ("still_life", "480x300", "1.8", "0.8", "still life, 480x300, f/1.8 at 0.8 m"),
    ("still_life", "480x300", "1.8", "1.5", "the same at 1.5 m"),
]
DEPTHS = ("most", "mean")
IDS = ("none", "id", "cryptomatte")
METHODS = ("layers", "scatter")


def run(*arguments):
    result = subprocess.run(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    if result.returncode != 0:
        sys.exit(f"ids_table.py: failed with {result.returncode}: {' '.join(arguments)}\n{result.stderr.decode()}")
    return json.loads(result.stdout) if "--json" in arguments else None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build")
    parser.add_argument("out")
    parser.add_argument("--spp", type=int, default=256, help="of each half of the reference")
    o = parser.parse_args()
    os.makedirs(o.out, exist_ok=True)
    postlens = os.path.join(o.build, "apps", "postlens")
    export = os.path.join(o.build, "bench", "foreign_export")
    for program in (postlens, export):
        if not os.access(program, os.X_OK):
            sys.exit(f"ids_table.py: {program} is missing; build the targets postlens and foreign_export")

    lines = ["| scene | method | no ids | one id a pixel | Cryptomatte | mean depth: no ids | one id | Cryptomatte |",
             "|---|---|---|---|---|---|---|---|"]
    least_noise_db = float("inf")
    for scene, size, f_number, focus_m, name in CASES:
        def out(suffix, at=f"{scene}.{focus_m}m."):
            return os.path.join(o.out, at + suffix)

        file = os.path.join(SCENES, scene + ".toml")
        lens = ["--f-number", f_number, "--focus", focus_m]
        run(postlens, "trace", file, "-o", out("frame.exr"), "--size", size, "--quiet")
        if not os.path.exists(out("reference.b.exr")):
            run(postlens, "render", file, "-o", out("reference.exr"), "--size", size, *lens, "--spp", str(2 * o.spp), "--halves",
                "--seed", "1", "--quiet")
        for method in METHODS:
            cells = []
            for depth in DEPTHS:
                for ids in IDS:
                    flat, picture = out(f"{depth}.{ids}.exr"), out(f"{depth}.{ids}.{method}.exr")
                    run(export, out("frame.exr"), flat, depth, ids)
                    run(postlens, "focus", flat, "-o", picture, *lens, "--method", method, "--quiet")
                    c = run(postlens, "compare", picture, out("reference.a.exr"), "--noise", out("reference.b.exr"), "--json")
                    least_noise_db = min(least_noise_db, c["noise_psnr_db"])
                    cells.append(f"{c['psnr_above_noise_db']:.1f}")
            lines.append(f"| {name if method == METHODS[0] else ''} | {method} | {' | '.join(cells)} |")
    lines += ["", f"The references are good to {least_noise_db:.1f} dB or better."]
    with open(os.path.join(o.out, "ids.md"), "w", encoding="utf-8") as f:
        f.write("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
