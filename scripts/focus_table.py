#!/usr/bin/env python3
"""Compares time and error of every focus method with distributed rays for a scene: tables of docs/light_field.md.

    focus_table.py BUILD OUT SCENE --f-number N --focus M [--focal-length MM] [--size WxH] [--subdivide LEVELS]
                   [--reference-spp N] [--rays N,N,...] [--repeat K] [--metres-per-unit X]

BUILD is a build folder (build/release). The table focus.md, the images, and each image side by side with the reference
are written to OUT. The reference has two independent halves of N samples per pixel, whose noise is subtracted from the
errors. The time of a method includes reading the sample file and writing the image. Every method runs K times, in turn
with the other methods, and the table states the shortest time. A reference that is already in OUT is used again.
"""

import argparse
import json
import os
import subprocess
import sys

METHODS = [
    ("pinhole", ["--method", "pinhole"]),
    ("scatter", ["--method", "scatter"]),
    ("layers", ["--method", "layers"]),
    ("lightfield 64", ["--method", "lightfield", "--views", "64"]),
    ("lightfield 256", ["--method", "lightfield", "--views", "256"]),
    ("hybrid", ["--method", "hybrid", "--views", "128"]),
]


def run(*arguments):
    result = subprocess.run(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    if result.returncode != 0:
        sys.exit(f"focus_table.py: failed with {result.returncode}: {' '.join(arguments)}\n{result.stderr.decode()}")
    return json.loads(result.stdout)


def main():
    parser = argparse.ArgumentParser()
    for name in ("build", "out", "scene"):
        parser.add_argument(name)
    parser.add_argument("--f-number", required=True)
    parser.add_argument("--focus", required=True)
    parser.add_argument("--focal-length")
    parser.add_argument("--for-f-number", help="what the trace is told, where --focal-length makes the lens wider than its view's")
    parser.add_argument("--size", default="960x540")
    parser.add_argument("--subdivide")
    parser.add_argument("--reference-spp", type=int, default=1024)
    parser.add_argument("--rays", default="16,64,256")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--metres-per-unit", default="1")
    o = parser.parse_args()
    os.makedirs(o.out, exist_ok=True)
    postlens = os.path.join(o.build, "apps", "postlens")

    def out(name):
        return os.path.join(o.out, name)

    common = ["--quiet", "--json"]
    scene = ["--metres-per-unit", o.metres_per_unit, "--size", o.size]
    lens = ["--f-number", o.f_number, "--focus", o.focus]
    # The scene is traced with the film distance of its own camera. This distance determines how large objects appear in
    # the image. The option --focal-length does not change it. It changes only the diameter of the lens, which is focal
    # length / f-number.
    length = ["--focal-length", o.focal_length] if o.focal_length else []
    levels = ["--subdivide", o.subdivide] if o.subdivide else []
    trace = run(postlens, "trace", o.scene, "-o", out("frame.exr"), *scene, *levels, "--overscan", "auto", "--for-f-number",
                o.for_f_number or o.f_number, "--for-focus", o.focus, *common)
    print(f"traced: {trace['records']} records, {trace['bytes'] / 1e6:.0f} MB, {trace['seconds']:.2f} s")
    if not os.path.exists(out("reference.b.exr")):
        run(postlens, "render", o.scene, "-o", out("reference.exr"), *scene, *lens, *length, "--spp", str(2 * o.reference_spp),
            "--halves", "--seed", "1", *common)

    commands = []
    for name, method in METHODS:
        picture = out(name.replace(" ", "_") + ".exr")
        again = ["--scene", o.scene, "--metres-per-unit", o.metres_per_unit] if name == "hybrid" else []
        commands.append((name, picture, ["focus", out("frame.exr"), "-o", picture, *lens, *length, *method, *again]))
    for spp in o.rays.split(","):
        picture = out(f"rays_{spp}.exr")
        commands.append((f"rays {spp}", picture,
                         ["render", o.scene, "-o", picture, *scene, *lens, *length, "--spp", spp, "--seed", "2"]))
    results = {}
    for _ in range(o.repeat):
        for name, _, command in commands:
            result = run(postlens, *command, *common)
            if name not in results or result["seconds"] < results[name]["seconds"]:
                results[name] = result

    lines = ["| method | s | whole frame, dB | affected, dB | relMSE | traced again |", "|---|---|---|---|---|---|"]
    for name, picture, _ in commands:
        c = run(postlens, "compare", picture, out("reference.a.exr"), "--noise", out("reference.b.exr"), "--pinhole",
                out("pinhole.exr"), "--side-by-side", picture[:-4] + ".png", "--json")
        again = results[name].get("retraced_share", 0)
        bound = "at least " if c["psnr_above_noise_is_bound"] else ""
        lines.append(f"| {name} | {results[name]['seconds']:.2f} | {bound}{c['psnr_above_noise_db']:.1f} | "
                     f"{c['affected_psnr_above_noise_db']:.1f} | {c['relmse_above_noise']:.2g} | "
                     f"{f'{100 * again:.1f} %' if again else ''} |")
    lines.append("")
    lines.append(f"{100 * c['affected_share']:.0f} % of the pixels are affected. The noise of the reference is at "
                 f"{c['noise_psnr_db']:.1f} dB. Trace {trace['seconds']:.2f} s.")
    with open(out("focus.md"), "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
