#!/usr/bin/env python3
"""Compares reflections and refractions by every method with distributed rays: the table of docs/refocus.md.

    optics_table.py PROGRAM OUT [--size WxH] [--spp N] [--views M] [--methods NAME,...] [--threads N] [SCENE ...]

PROGRAM is the postlens program (build/release/apps/postlens). optics.md, refocus.png, the images and crops of the
images are written to OUT. The scenes are those of samples/scenes/optics at f/1.4. Each is focused once on the mirror or
the glass, and once on the objects seen in it. The reference has two independent halves of N / 2 samples per pixel each,
whose noise is subtracted from the errors. "inside" is the error in a window well inside the mirror or the glass. Files
that are already in OUT are used again, even by a run with fewer methods. Needs oiiotool (Debian: openimageio-tools).
"""

import argparse
import json
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(HERE, "..", "samples", "scenes", "optics")
# The test cases. For each scene: a list of focus distances in m, and the window in which images are compared (left,
# top, right and bottom edge, as fractions of the image). The window lies so far inside the mirror or glass that no
# point of the lens sees the background there.
CASES = {
    "flat_mirror": ([1.2, 5.4], (0.22, 0.22, 0.78, 0.78)),
    "convex_mirror": ([1.1, 1.33], (0.32, 0.18, 0.68, 0.82)),
    "concave_mirror": ([1.5, 13.5], (0.36, 0.25, 0.64, 0.75)),
    "glass_ball": ([1.2, 0.95], (0.36, 0.25, 0.64, 0.75)),
    "thick_slab": ([0.7, 3.7], (0.45, 0.15, 0.90, 0.85)),
    "mirror_in_mirror": ([1.2, 6.8], (0.38, 0.38, 0.62, 0.62)),
}
METHODS = {
    "first-hit": ["--method", "scatter", "--depth-model", "first-hit"],
    "path": ["--method", "scatter", "--depth-model", "path"],
    "scatter": ["--method", "scatter", "--depth-model", "W"],
    "layers": ["--method", "layers"],
    "lightfield": ["--method", "lightfield"],
}
HEADS = ["scatter, first hit", "scatter, path", "scatter, W", "layers, W", "light field, W"]


def run(*arguments):
    result = subprocess.run(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    if result.returncode != 0:
        sys.exit(f"optics_table.py: failed with {result.returncode}: {' '.join(arguments)}\n{result.stderr.decode()}")
    return json.loads(result.stdout) if "--json" in arguments else None


class Case:
    """One scene at one focus distance."""

    def __init__(self, options, scene, focus_m):
        self.options, self.scene, self.focus_m = options, scene, focus_m
        self.file = os.path.join(SCENES, scene + ".toml")
        width, height = (int(n) for n in options.size.split("x"))
        left, top, right, bottom = CASES[scene][1]
        x, y = round(left * width), round(top * height)
        self.window = f"{round(right * width) - x}x{round(bottom * height) - y}+{x}+{y}"

    def out(self, suffix):
        return os.path.join(self.options.out, f"{self.scene}.{self.focus_m}m{suffix}")

    def postlens(self, *arguments):
        return run(self.options.program, *arguments, "--threads", str(self.options.threads), "--json")

    def cut(self, suffix):
        run("oiiotool", self.out(suffix + ".exr"), "--cut", self.window, "-o", self.out(suffix + ".inside.exr"))

    def prepare(self):
        if not os.path.exists(self.out(".rays.b.exr")):
            self.postlens("render", self.file, "-o", self.out(".rays.exr"), "--size", self.options.size, "--spp",
                          str(self.options.spp), "--halves", "--f-number", "1.4", "--focus", str(self.focus_m), "--seed", "1")
        for half in [".rays.a", ".rays.b"]:
            self.cut(half)
        if not os.path.exists(self.out(".frame.exr")):
            self.postlens("trace", self.file, "-o", self.out(".frame.exr"), "--size", self.options.size, "--overscan", "auto",
                          "--for-f-number", "1.4", "--for-focus", str(self.focus_m), "--subdivide", "4")

    def focus(self, name):
        """Makes the image of a method and returns its warnings. Returns None if the method is not selected and there is
        no image from an earlier run."""
        told = self.out(f".{name}.json")
        if not os.path.exists(told):
            if name not in self.options.methods:
                return None
            views = ["--views", str(self.options.views)] if name == "lightfield" else []
            result = self.postlens("focus", self.out(".frame.exr"), "-o", self.out(f".{name}.exr"), "--f-number", "1.4", "--focus",
                                   str(self.focus_m), *METHODS[name], *views)
            with open(told, "w", encoding="utf-8") as f:
                json.dump(result, f)
        with open(told, encoding="utf-8") as f:
            return json.load(f)["warnings"]

    def decibels(self, name, ending):
        """Returns the PSNR of an image, in dB, after the noise of the reference is subtracted."""
        c = self.postlens("compare", self.out(f".{name}{ending}"), self.out(f".rays.a{ending}"), "--noise",
                          self.out(f".rays.b{ending}"))
        self.noise[ending] = c["noise_psnr_db"]
        return ("≥ " if c["psnr_above_noise_is_bound"] else "") + f"{c['psnr_above_noise_db']:.1f}"

    def row(self):
        self.prepare()
        cells, nonlinear, self.noise = [], 0, {}
        for name in METHODS:
            warnings = self.focus(name)
            if warnings is None:
                cells.append("–")
                continue
            nonlinear = max([nonlinear] + [w["share"] for w in warnings if w["code"] == "nonlinear"])
            self.cut("." + name)
            cells.append(f"{self.decibels(name, '.inside.exr')} / {self.decibels(name, '.exr')}")
        noise = f"{self.noise['.inside.exr']:.1f} / {self.noise['.exr']:.1f}"
        return f"| {self.scene} | {self.focus_m} | {' | '.join(cells)} | {noise} | {100 * nonlinear:.1f} |"


def picture(options):
    """Writes OUT/refocus.png: a mirror and a glass ball by four methods, with the focus on the objects seen in them."""
    height = int(options.size.split("x")[1])
    side, parts = height * 3 // 4, []
    for scene, focus_m, left in [("flat_mirror", 5.4, height * 17 // 20), ("glass_ball", 0.95, height // 2)]:
        for name in ["first-hit", "path", "lightfield", "rays"]:
            parts.append(os.path.join(options.out, f"{scene}.{focus_m}m.{name}.exr"))
            if not os.path.exists(parts[-1]):
                return
            parts += ["--cut", f"{side}x{side}+{left}+{height // 8}", "--colorconvert", "linear", "sRGB"]
    run("oiiotool", *parts, "--mosaic:pad=4", "4x2", "-d", "uint8", "-o", os.path.join(options.out, "refocus.png"))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("out")
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--size", default="480x270", help="px")
    parser.add_argument("--spp", type=int, default=256, help="of both halves of the reference together")
    parser.add_argument("--views", type=int, default=256)
    parser.add_argument("--methods", type=lambda text: text.split(","), default=list(METHODS), help=",".join(METHODS))
    parser.add_argument("--threads", type=int, default=0, help="0: all the machine has")
    options = parser.parse_intermixed_args()
    for name in options.methods:
        if name not in METHODS:
            sys.exit(f"optics_table.py: no such method (got {name}; expected one of {', '.join(METHODS)})")
    options.program = os.path.abspath(options.program)
    os.makedirs(options.out, exist_ok=True)
    lines = [f"| scene | focus, m | {' | '.join(HEADS)} | halves of the rays | W.bend > 0.5 px, % |",
             "|---|---|" + "---|" * (len(HEADS) + 2)]
    print("\n".join(lines), flush=True)
    for scene in options.scenes or CASES:
        if scene not in CASES:
            sys.exit(f"optics_table.py: no such scene (got {scene}; expected one of {', '.join(CASES)})")
        for focus_m in CASES[scene][0]:
            lines.append(Case(options, scene, focus_m).row())
            print(lines[-1], flush=True)
    with open(os.path.join(options.out, "optics.md"), "w", encoding="utf-8") as f:
        f.write("\n".join(lines) + "\n")
    picture(options)


if __name__ == "__main__":
    main()
