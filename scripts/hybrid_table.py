#!/usr/bin/env python3
"""Compares `--method hybrid` with as many rays per pixel as hybrid has views: a table of docs/light_field.md.

    hybrid_table.py BUILD OUT [--size 480x270] [--views 64,256] [--reference-spp 512] [--spd DIR] [--trees SEEDS]

BUILD is a build folder (build/release). Each sample scene is traced with `--for-rays`; `focus` or `shoot` makes an
image by `hybrid`. `render --halves` makes another image from as many rays per pixel, in two independent halves. Both
are compared with a render of 2 x REFERENCE-SPP rays per pixel, whose noise is subtracted from the errors. Seconds are
those of whole processes, each run once. Nothing else should run on the machine. DIR holds `balls.nff` and `mount.nff`
of the Standard Procedural Databases at their default sizes; without it, these two rows are left out. With --trees (such
as 1001-1012), random scenes with trees (random_scene.py) take the place of all these. OUT receives hybrid.md.
"""

import argparse
import os

import certify

ROWS = [  # file, f-number, focus distance in m, whether the shutter is open from 0 to 1 s
    ("bars.toml", "1.4", "5", False),
    ("bars.toml", "5.6", "5", False),
    ("bars_lit.toml", "1.4", "5", False),
    ("bars_lit.toml", "5.6", "5", False),
    ("night.toml", "1.4", "4", False),
    ("still_life.toml", "1.8", "0.8", False),
    ("blender_still.glb", "2", "5", False),
    ("blender_still.glb", "5.6", "5", False),
    ("motion.toml", "1.4", "4", True),
]
SPD_ROWS = [("balls.nff", "1.4", "2", False), ("mount.nff", "1.4", "2", False)]
# Options for the SPD scenes (Standard Procedural Databases). Their images are made with a lens of 200 mm and f/1.4,
# whose diameter is 143 mm. `trace` computes the diameter as 43.3 mm, the film distance, divided by the f-number. So it
# needs the f-number 0.3.
SPD_SIZE, SPD_FOCAL_LENGTH_MM, SPD_FOR_F_NUMBER = "240x240", "200", "0.3"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("out")
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--views", default="64,256")
    parser.add_argument("--reference-spp", default="512")
    parser.add_argument("--spd")
    parser.add_argument("--trees")
    o = parser.parse_args()
    os.makedirs(o.out, exist_ok=True)
    bench = certify.Bench(o.build, o.out)
    at = bench.path

    def error_db(image):
        return bench.run("compare", at(image), at("truth.a.exr"), "--noise", at("truth.b.exr"))["psnr_above_noise_db"]

    lines = ["| | views | trace, s | `hybrid`, s | dB | stated | rays, of all view samples | as many rays: s | dB |",
             "|---|---|---|---|---|---|---|---|---|"]  # fmt: skip
    rows = [(os.path.join(certify.SCENES, row[0]), *row) for row in ROWS]
    rows += [(os.path.join(o.spd, row[0]), *row) for row in SPD_ROWS if o.spd]
    if o.trees:  # the generator makes each file when its row is reached
        rows = ((path, seed, f"{made.f_number:g}", f"{made.focus_m:.6g}", made.shutter)
                for seed, path, _, made in certify.random_scenes(bench, o.trees, ("leaves",)))  # fmt: skip
    for scene, name, f_number, focus_m, shutter in rows:
        lens = ["--f-number", f_number, "--focus", focus_m]
        size, of_spd = o.size, name in (row[0] for row in SPD_ROWS)
        if of_spd:
            size = SPD_SIZE
            lens += ["--focal-length", SPD_FOCAL_LENGTH_MM]
        open_s = ["--shutter", "0:1"] if shutter else []
        traced_for = ["--for-f-number", SPD_FOR_F_NUMBER if of_spd else f_number, "--for-focus", focus_m]
        if shutter:
            traced_for += ["--for-shutter", "0:1", "--keys", "auto"]
        bench.run("render", scene, "-o", at("truth.exr"), "--size", size, "--spp", str(2 * int(o.reference_spp)), "--halves",
                  *lens, *open_s)  # fmt: skip
        trace_s, _ = bench.timed("trace", scene, "-o", at("traced.exr"), "--size", size, "--for-rays", "--overscan", "auto", *traced_for)
        for views in o.views.split(","):
            hybrid_s, report = bench.timed("shoot" if shutter else "focus", at("traced.exr"), "-o", at("hybrid.exr"), "--method",
                                           "hybrid", "--views", views, "--scene", scene, *lens, *open_s)  # fmt: skip
            rays_s, _ = bench.timed("render", scene, "-o", at("rays.exr"), "--size", size, "--spp", views, "--halves", "--seed", "7",
                                     *lens, *open_s)  # fmt: skip
            hybrid_db, rays_db = error_db("hybrid.exr"), error_db("rays.exr")
            named = f"{name.split('.')[0]} f/{f_number} at {focus_m} m" + (", shutter" if shutter else "")
            lines.append(f"| {named} | {views} | {trace_s:.2f} | {hybrid_s:.2f} | {hybrid_db:.1f} | "
                         f"{report['stated_db']:.1f} ({report['stated_low_db']:.1f} to {report['stated_high_db']:.1f}) | "
                         f"{100 * report['ray_share']:.1f} % | {rays_s:.2f} | {rays_db:.1f} |")  # fmt: skip
            print(lines[-1], flush=True)
    with open(at("hybrid.md"), "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
