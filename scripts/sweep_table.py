#!/usr/bin/env python3
"""Compares the time of a sweep with that of rays of equal error, image by image: the table of docs/sweep.md.

    sweep_table.py BUILD OUT SCENE --size WxH --trace "OPTIONS" --sweep "OPTIONS" [--every K] [--reference-spp N]
                   [--rays N,N,...] [--repeat K] [--metres-per-unit X]

BUILD is a build folder (build/release). The sample file, the sweep and the table sweep.md are written to OUT. Every
K-th image of the sweep, from image K / 2 on, is compared to a reference of N samples per pixel. Rays are rendered with
every number of samples of --rays. The number of samples at which rays have the same PSNR as the sweep, and the time
that they take, are interpolated between two of these renders. Seconds are wall times of whole commands, including
start-up and file access. They are medians over the rounds of --repeat. In each round, all commands run once.
"""

import argparse
import json
import math
import os
import shlex
import shutil
import statistics
import subprocess
import sys
import time


def run(*arguments):
    """Runs a command. Returns its wall time, in seconds, and its JSON report."""
    start = time.perf_counter()
    result = subprocess.run(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    seconds = time.perf_counter() - start
    if result.returncode != 0:
        sys.exit(f"sweep_table.py: failed with {result.returncode}: {' '.join(arguments)}\n{result.stderr.decode()}")
    return seconds, json.loads(result.stdout)


def between(rays, db):
    """Returns the samples per pixel and the seconds for which rays have a PSNR of `db`. They are interpolated in
    `rays`, which is {spp: (dB, seconds)}."""
    ladder = sorted(rays)
    low, high = ladder[0], ladder[1]
    for at in ladder[1:]:
        low, high = (low, high) if rays[high][0] >= db else (high, at)
    (db_low, s_low), (db_high, s_high) = rays[low], rays[high]
    share = (db - db_low) / (db_high - db_low)
    spp = max(1.0, 2 ** (math.log2(low) + share * math.log2(high / low)))
    return spp, s_low + (spp - low) / (high - low) * (s_high - s_low)


def main():
    parser = argparse.ArgumentParser()
    for name in ("build", "out", "scene"):
        parser.add_argument(name)
    parser.add_argument("--size", default="960x540")
    parser.add_argument("--trace", default="")
    parser.add_argument("--sweep", required=True)
    parser.add_argument("--every", type=int, default=8)
    parser.add_argument("--reference-spp", type=int, default=256)
    parser.add_argument("--rays", default="2,4,8,16")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--metres-per-unit", default="1")
    o = parser.parse_args()
    os.makedirs(o.out, exist_ok=True)
    postlens = os.path.join(o.build, "apps", "postlens")
    frame, folder = os.path.join(o.out, "frame.exr"), os.path.join(o.out, "sweep")
    common = ["--quiet", "--json"]
    scene = [o.scene, "--metres-per-unit", o.metres_per_unit, "--size", o.size]

    def sweep():
        shutil.rmtree(folder, ignore_errors=True)
        return run(postlens, "sweep", frame, "-o", folder, *shlex.split(o.sweep), *common)

    def render(lens, spp, seed, path):
        return run(postlens, "render", *scene, "-o", path, "--focal-length", str(lens["focal_length_mm"]), "--f-number",
                   str(lens["f_number"]), "--focus", str(lens["focus_m"]), "--spp", str(spp), "--seed", str(seed), *common)[0]

    def psnr_db(picture, reference):
        return run(postlens, "compare", picture, reference, "--json")[1]["psnr_db"]

    trace = [postlens, "trace", *scene, "-o", frame, *shlex.split(o.trace), *common]
    run(*trace)
    sweep()
    pictures = json.load(open(os.path.join(folder, "sweep.json"), encoding="utf-8"))["pictures"]
    chosen = pictures[o.every // 2 :: o.every]
    ladder = [int(spp) for spp in o.rays.split(",")]
    of_rays = os.path.join(o.out, "rays.exr")
    db_of_rays, db_of_sweep = [], []
    for i, lens in enumerate(chosen):
        reference = os.path.join(o.out, f"reference.{i}.exr")
        render(lens, o.reference_spp, 1, reference)
        db_of_sweep.append(psnr_db(os.path.join(folder, lens["file"]), reference))
        db_of_rays.append({})
        for spp in ladder:
            render(lens, spp, 2, of_rays)
            db_of_rays[i][spp] = psnr_db(of_rays, reference)
    seconds = {"trace": [], "sweep": []}
    for _ in range(o.repeat):
        seconds["trace"].append(run(*trace)[0])
        seconds["sweep"].append(sweep()[0])
        for i, lens in enumerate(chosen):
            for spp in ladder:
                seconds.setdefault((i, spp), []).append(render(lens, spp, 2, of_rays))
    median = {what: statistics.median(all_of) for what, all_of in seconds.items()}

    lines = ["| picture | dB | rays of that error, a pixel | s |", "|---|---|---|---|"]
    by_rays = 0
    for i, lens in enumerate(chosen):
        spp, s = between({n: (db_of_rays[i][n], median[i, n]) for n in ladder}, db_of_sweep[i])
        by_rays += s / len(chosen) * len(pictures)
        lines.append(f"| {lens['file']} | {db_of_sweep[i]:.1f} | {spp:.1f} | {s:.2f} |")
    whole = median["trace"] + median["sweep"]
    lines.append("")
    lines.append(f"{len(pictures)} pictures: trace {median['trace']:.2f} s, sweep {median['sweep']:.2f} s "
                 f"({min(seconds['sweep']):.2f} to {max(seconds['sweep']):.2f}), {whole / len(pictures) * 1e3:.0f} ms each; "
                 f"rays of equal error {by_rays:.1f} s: {by_rays / whole:.1f} times as long.")
    with open(os.path.join(o.out, "sweep.md"), "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
