#!/usr/bin/env python3
"""Compares the errors of `--method auto` with the errors that it states: the tables of docs/planner.md.

    certify.py BUILD OUT [--seeds 1-200] [--targets 35,40,45] [--size 240x136] [--spp 1024] [--samples] [--kinds plain,...]

BUILD is a build folder (build/release). Each random scene (random_scene.py) is traced for its lens; with --samples,
each of the sample scenes below. For each target error, `focus` or `shoot --method auto` makes an image with rays in the
scene. The image is compared to distributed rays of 2 x SPP samples per pixel, whose noise is subtracted from the error.
certify.csv, with a line for each image, and certify.md, with the table, are written to OUT. Both are also printed
during the run. "within 1 dB" counts images whose measured error is within 1 dB of the stated one. Images are not
counted if their PSNR is higher than that of the reference's noise minus 1 dB.
"""

import argparse
import csv
import json
import math
import os
import subprocess
import sys
import time

import random_scene

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(HERE, "..", "samples", "scenes")
SAMPLES = [  # file, f-number, focus distance in m, whether the shutter is open from 0 to 1 s
    ("bars.toml", 1.4, 5, False),
    ("bars.toml", 5.6, 5, False),
    ("bars_lit.toml", 1.4, 5, False),
    ("bars_lit.toml", 5.6, 5, False),
    ("still_life.toml", 1.8, 0.8, False),
    ("still_life.toml", 5.6, 1.2, False),
    ("night.toml", 1.4, 4, False),
    ("night.toml", 5.6, 4, False),
    ("ruler.toml", 1.4, 1, False),
    ("optics/flat_mirror.toml", 1.4, 4, False),
    ("optics/convex_mirror.toml", 1.4, 2, False),
    ("optics/concave_mirror.toml", 1.4, 2, False),
    ("optics/mirror_in_mirror.toml", 1.4, 4, False),
    ("motion.toml", 1.4, 4, True),
    ("motion/crossing.toml", 1.4, 3, True),
    ("motion/sphere.toml", 1.4, 4, True),
]
COLUMNS = ["scene", "kind", "f_number", "target_db", "measured_db", "reference_db", "stated_db", "low_db", "high_db", "views",
           "ray_share", "left_to_rays", "seconds"]


class Bench:
    def __init__(self, build, out):
        self.postlens, self.out = os.path.join(build, "apps", "postlens"), out

    def path(self, name):
        return os.path.join(self.out, name)

    def run(self, *arguments):
        result = subprocess.run([self.postlens, *arguments, "--quiet", "--json"], capture_output=True, check=False, text=True)
        if result.returncode not in (0, 6):
            sys.exit(f"{os.path.basename(sys.argv[0])}: failed with {result.returncode}: {' '.join(arguments)}\n{result.stderr}")
        return json.loads(result.stdout)

    def timed(self, *arguments):
        """Seconds of a command and its report."""
        begin = time.monotonic()
        report = self.run(*arguments)
        return time.monotonic() - begin, report

    def above_noise_db(self, image):
        """Returns the PSNR against the mean of both halves of the reference, after its noise is subtracted. Also
        returns the PSNR of this noise."""
        against = self.run("compare", image, self.path("truth.exr"))["psnr_db"]
        halves = self.run("compare", self.path("truth.a.exr"), self.path("truth.b.exr"))["psnr_db"]
        noise = 10 ** (-halves / 10) / 4
        return -10 * math.log10(max(10 ** (-against / 10) - noise, 1e-9)), -10 * math.log10(noise)

    def pictures(self, name, scene, kind, made, size, spp, targets):
        traced, picture = self.path("traced.exr"), self.path("picture.exr")
        self.run("trace", scene, "-o", traced, "--size", size, "--for-rays", *made.traced_for())
        self.run("render", scene, "-o", self.path("truth.exr"), "--size", size, "--spp", spp, "--halves", *made.rendered_for())
        command = "shoot" if made.shutter else "focus"
        for target in targets:
            seconds, j = self.timed(command, traced, "-o", picture, "--method", "auto", "--target-db", target, "--scene", scene, *made.rendered_for())
            measured, reference = self.above_noise_db(picture)
            yield {"scene": name, "kind": kind, "f_number": made.f_number, "target_db": float(target), "measured_db": measured,
                   "reference_db": reference, "stated_db": j["stated_db"], "low_db": j["stated_low_db"], "high_db": j["stated_high_db"],
                   "views": j["plan"]["mean_views"], "ray_share": j["ray_share"],
                   "left_to_rays": sum(t["left_to_rays"] for t in j["plan"]["tiles"]) / len(j["plan"]["tiles"]), "seconds": seconds}


def told(row):
    """Returns whether the noise of the reference is low enough to measure the error of the image."""
    return row["measured_db"] < row["reference_db"] - 1


def table(rows):
    lines = ["| | target, dB | pictures | within 1 dB of what is stated | inside the interval | target met | width of the interval, dB: median |",
             "|---|---|---|---|---|---|---|"]

    def line(name, target, some):
        known = [r for r in some if told(r)]
        if not known:
            return
        share = lambda test: f"{100 * sum(map(test, known)) / len(known):.0f} %"
        widths = sorted(r["high_db"] - r["low_db"] for r in known)
        lines.append(f"| {name} | {target} | {len(known)} | " + share(lambda r: abs(r["measured_db"] - r["stated_db"]) <= 1) + " | "
                     + share(lambda r: r["low_db"] <= r["measured_db"] <= r["high_db"]) + " | "
                     + share(lambda r: r["measured_db"] >= r["target_db"]) + f" | {widths[len(widths) // 2]:.1f} |")

    for kind in sorted({r["kind"] for r in rows}):
        line(kind, "all", [r for r in rows if r["kind"] == kind])
    for target in sorted({r["target_db"] for r in rows}):
        line("all", f"{target:g}", [r for r in rows if r["target_db"] == target])
    line("all", "all", rows)
    return "\n".join(lines) + "\n"


def sample_scenes():
    for file, f_number, focus_m, shutter in SAMPLES:
        yield f"{file} f/{f_number:g}", os.path.join(SCENES, file), "sample", random_scene.RandomScene("sample", f_number, focus_m, "", shutter)


def random_scenes(bench, seeds, kinds):
    first, _, last = seeds.partition("-")
    for seed in range(int(first), int(last or first) + 1):
        made = random_scene.write(seed, kinds)
        path = bench.path("scene.toml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(made.text)
        yield str(seed), path, made.kind, made


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("out")
    parser.add_argument("--seeds", default="1-200")
    parser.add_argument("--targets", default="35,40,45")
    parser.add_argument("--size", default="240x136")
    parser.add_argument("--spp", default="1024")
    parser.add_argument("--samples", action="store_true")
    parser.add_argument("--kinds", default=",".join(random_scene.KINDS))
    options = parser.parse_args()
    os.makedirs(options.out, exist_ok=True)
    bench = Bench(options.build, options.out)
    scenes = sample_scenes() if options.samples else random_scenes(bench, options.seeds, options.kinds.split(","))
    rows = []
    with open(bench.path("certify.csv"), "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        for scene in scenes:
            for row in bench.pictures(*scene, options.size, options.spp, options.targets.split(",")):
                rows.append(row)
                writer.writerow({k: f"{v:.4g}" if isinstance(v, float) else v for k, v in row.items()})
                file.flush()
                mark = "" if not told(row) or row["low_db"] <= row["measured_db"] <= row["high_db"] else " OUTSIDE"
                print(f"{row['scene']} {row['kind']} f/{row['f_number']:g} target {row['target_db']:g}: measured {row['measured_db']:.1f}, "
                      f"stated {row['stated_db']:.1f} ({row['low_db']:.1f} to {row['high_db']:.1f}), {row['views']:.0f} views, "
                      f"{100 * row['ray_share']:.0f} % rays, {row['seconds']:.2f} s{mark}", flush=True)
    with open(bench.path("certify.md"), "w", encoding="utf-8") as file:
        file.write(table(rows))
    print(table(rows), end="")


if __name__ == "__main__":
    main()
