#!/usr/bin/env python3
"""Compares every method of motion blur with distributed rays: the table and the images of docs/motion.md.

    motion_table.py BUILD OUT [--reference-spp N] [--rays N,N,...] [--subdivide LEVELS] [SCENE ...]

BUILD is a build folder (build/release). motion.csv, motion.md, the blurred images, and each image side by side with the
reference are written to OUT. The scenes are those of samples/scenes/motion, and the shutter is open from 0 s to 1 s.
The reference has two independent halves of N samples per pixel each, whose noise is subtracted from the errors. Methods
and rays are timed in succession, scene by scene, so only times of the same scene are comparable. A reference that is
already in OUT is used again.
"""

import argparse
import csv
import json
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(HERE, "..", "samples", "scenes", "motion")
FIELDS = ["scene", "method", "seconds", "views", "psnr_db", "affected_psnr_db", "relmse", "affected_relmse", "bound"]


def run(*arguments):
    result = subprocess.run(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    if result.returncode != 0:
        sys.exit(f"motion_table.py: failed with {result.returncode}: {' '.join(arguments)}\n{result.stderr.decode()}")
    return json.loads(result.stdout)


class Scene:
    def __init__(self, options, name):
        self.name = name
        self.postlens = os.path.join(options.build, "apps", "postlens")
        self.file = os.path.join(SCENES, name + ".toml")
        self.options = options
        self.rows = []

    def out(self, suffix):
        return os.path.join(self.options.out, f"{self.name}{suffix}")

    def reference(self):
        if os.path.exists(self.out(".reference.b.exr")):
            return
        run(self.postlens, "render", self.file, "-o", self.out(".reference.exr"), "--spp",
            str(2 * self.options.reference_spp), "--halves", "--shutter", "0:1", "--seed", "1", "--quiet", "--json")

    def compare(self, picture, method, seconds, views):
        c = run(self.postlens, "compare", picture, self.out(".reference.a.exr"), "--noise", self.out(".reference.b.exr"),
                "--pinhole", self.out(".pinhole.exr"), "--side-by-side", picture[:-4] + ".png", "--json")
        self.affected = c["affected_share"]
        self.noise = c["affected_noise_psnr_db"]
        self.rows.append({
            "scene": self.name, "method": method, "seconds": f"{seconds:.2f}", "views": views or "",
            "psnr_db": f"{c['psnr_above_noise_db']:.1f}",
            "affected_psnr_db": f"{c['affected_psnr_above_noise_db']:.1f}",
            "relmse": f"{c['relmse_above_noise']:.2g}",
            "affected_relmse": f"{c['affected_relmse_above_noise']:.2g}",
            "bound": "" if not c["affected_psnr_above_noise_is_bound"] else "at least"})

    def measure(self):
        self.reference()
        trace = run(self.postlens, "trace", self.file, "-o", self.out(".frame.exr"), "--for-shutter", "0:1", "--overscan",
                    "auto", "--keys", "auto", "--subdivide", str(self.options.subdivide), "--json")
        image = run(self.postlens, "image", self.out(".frame.exr"), "-o", self.out(".pinhole.exr"), "--json")
        self.trace_seconds, self.keys = trace["seconds"], trace["keys"]
        self.compare(self.out(".pinhole.exr"), "pinhole", image["seconds"], None)
        for method in ["convolve", "lightfield", "auto"]:
            r = run(self.postlens, "motionblur", self.out(".frame.exr"), "-o", self.out(f".{method}.exr"), "--shutter", "0:1",
                    "--method", method, "--json")
            self.compare(self.out(f".{method}.exr"), method, r["seconds"], r["views"])
        for spp in self.options.rays:
            r = run(self.postlens, "render", self.file, "-o", self.out(f".rays{spp}.exr"), "--spp", str(spp), "--shutter",
                    "0:1", "--seed", "2", "--quiet", "--json")
            self.compare(self.out(f".rays{spp}.exr"), f"rays, {spp} spp", r["seconds"], None)


def table(scenes):
    lines = ["| scene | method | s | PSNR, dB | affected, dB | relMSE, affected |", "|---|---|---|---|---|---|"]
    for s in scenes:
        for i, r in enumerate(s.rows):
            about = f"**{s.name}** ({100 * s.affected:.0f} % affected, {s.keys} key{'s' if s.keys > 1 else ''}, trace " \
                    f"{s.trace_seconds:.1f} s)" if i == 0 else ""
            bound = "≥ " if r["bound"] else ""
            lines.append(f"| {about} | {r['method']} | {r['seconds']} | {r['psnr_db']} | {bound}{r['affected_psnr_db']} | "
                         f"{r['affected_relmse']} |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build")
    parser.add_argument("out")
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--reference-spp", type=int, default=1024, help="of each half")
    parser.add_argument("--rays", type=lambda text: [int(n) for n in text.split(",")], default=[4, 16, 64, 256, 1024])
    parser.add_argument("--subdivide", type=int, default=4)
    options = parser.parse_intermixed_args()
    os.makedirs(options.out, exist_ok=True)
    known = sorted(name[:-5] for name in os.listdir(SCENES) if name.endswith(".toml"))
    scenes = []
    for name in options.scenes or known:
        if name not in known:
            sys.exit(f"motion_table.py: no such scene (got {name}; expected one of {', '.join(known)})")
        scenes.append(Scene(options, name))
        scenes[-1].measure()
        print(table(scenes[-1:]), flush=True)
    with open(os.path.join(options.out, "motion.md"), "w", encoding="utf-8") as f:
        f.write(table(scenes))
    with open(os.path.join(options.out, "motion.csv"), "w", encoding="utf-8", newline="") as f:
        writer = csv.DictWriter(f, FIELDS)
        writer.writeheader()
        for s in scenes:
            writer.writerows(s.rows)


if __name__ == "__main__":
    main()
