#!/usr/bin/env python3
"""Compares `--method hybrid` with as many rays per pixel as it has views: a table of docs/light_field.md.

    hybrid_table.py BUILD OUT [--size 480x270] [--views 256] [--reference-spp 512]

BUILD is a build folder (build/release). Each sample scene is traced with `--for-rays`; `focus` or `shoot` makes an image
by `hybrid`, `render` another of as many rays. Both are compared with a render of 2 x REFERENCE-SPP rays a pixel, whose
noise is subtracted. Seconds are of whole processes, each run once. Nothing else should run on the machine. OUT receives
hybrid.md.
"""

import argparse
import os
import time

import certify

ROWS = [  # file, f-number, focus distance in m, with a shutter open from 0 to 1 s
    ("bars.toml", "1.4", "5", False),
    ("bars.toml", "5.6", "5", False),
    ("bars_lit.toml", "1.4", "5", False),
    ("bars_lit.toml", "5.6", "5", False),
    ("night.toml", "1.4", "4", False),
    ("still_life.toml", "1.8", "0.8", False),
    ("blender_still.glb", "2", "5", False),
    ("motion.toml", "1.4", "4", True),
]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("out")
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--views", default="256")
    parser.add_argument("--reference-spp", default="512")
    o = parser.parse_args()
    os.makedirs(o.out, exist_ok=True)
    bench = certify.Bench(o.build, o.out)
    at = bench.path

    def run(*words):
        """Seconds of a command and its report."""
        start = time.monotonic()
        report = bench.run(*words)
        return time.monotonic() - start, report

    def error_db(image):
        return bench.run("compare", at(image), at("truth.a.exr"), "--noise", at("truth.b.exr"))["psnr_above_noise_db"]

    lines = [f"| {o.size} | trace, s | `hybrid`, s | dB | stated | rays, of all view samples | {o.views} rays: s | dB |",
             "|---|---|---|---|---|---|---|---|"]  # fmt: skip
    for name, f_number, focus_m, shutter in ROWS:
        scene, lens = os.path.join(certify.SCENES, name), ["--f-number", f_number, "--focus", focus_m]
        open_s = ["--shutter", "0:1"] if shutter else []
        traced_for = ["--for-f-number", f_number, "--for-focus", focus_m] + (["--for-shutter", "0:1"] if shutter else [])
        run("render", scene, "-o", at("truth.exr"), "--size", o.size, "--spp", str(2 * int(o.reference_spp)), "--halves",
            *lens, *open_s)  # fmt: skip
        trace_s, _ = run("trace", scene, "-o", at("traced.exr"), "--size", o.size, "--for-rays", "--overscan", "auto", *traced_for)
        hybrid_s, report = run("shoot" if shutter else "focus", at("traced.exr"), "-o", at("hybrid.exr"), "--method", "hybrid",
                               "--views", o.views, "--scene", scene, *lens, *open_s)  # fmt: skip
        rays_s, _ = run("render", scene, "-o", at("rays.exr"), "--size", o.size, "--spp", o.views, "--seed", "7", *lens, *open_s)
        hybrid_db, rays_db = error_db("hybrid.exr"), error_db("rays.exr")
        named = f"{name.split('.')[0]} f/{f_number} at {focus_m} m" + (", shutter" if shutter else "")
        lines.append(f"| {named} | {trace_s:.2f} | {hybrid_s:.2f} | {hybrid_db:.1f} | "
                     f"{report['stated_db']:.1f} ({report['stated_low_db']:.1f} to {report['stated_high_db']:.1f}) | "
                     f"{100 * report['ray_share']:.1f} % | {rays_s:.1f} | {rays_db:.1f} |")  # fmt: skip
        print(lines[-1], flush=True)
    with open(at("hybrid.md"), "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
