#!/usr/bin/env python3
"""Compares a Cycles image that postlens focuses with Cycles' own image through the same lens: PSNR of every method.

    foreign_focus_cycles.py BUILD [--scene SCENE.toml] [--f-number N] [--focus M] [--size WxH] [--spp N] [--out DIR] ...

Blender renders the scene through a pinhole into a multi-layer OpenEXR file with the pass Depth. It also renders the
scene through the lens, twice with different seeds. `postlens focus` reads the pinhole image; otherwise it knows only
the camera. `postlens compare` compares the result to the images through the lens. Blender comes from Debian: apt-get
install --no-install-recommends blender python3-numpy
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import tomllib

HERE = os.path.dirname(os.path.abspath(__file__))
BARS = os.path.join(HERE, "..", "..", "samples", "scenes", "bars.toml")
METHODS = ("pinhole", "scatter", "layers")
TIMEOUT_S = 3600


def fail(text):
    sys.exit(f"foreign_focus_cycles.py: {text}")


def run(command, log=None, environment=None):
    done = subprocess.run(["timeout", str(TIMEOUT_S), *command], capture_output=True, text=True, env=environment)
    if log is not None:
        with open(log, "w", encoding="utf-8") as file:
            file.write(done.stdout + done.stderr)
    if done.returncode != 0:
        fail(f"{os.path.basename(command[0])} failed: {(done.stderr.splitlines() or ['it said nothing'])[-1]}")
    return done.stdout


def blender(out, arguments, words):
    if arguments.keep and os.path.exists(out):
        return
    # Blender contains its own Python interpreter, which loads the standard library of the first python3 in PATH. Only
    # Debian's python3, in /usr/bin, has the module numpy. Therefore, Blender is started with /usr/bin as the first
    # folder in PATH.
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    environment["PATH"] = "/usr/bin:" + os.environ["PATH"]
    quiet = ["-b", "--factory-startup", "-noaudio", "--python-exit-code", "1"]
    script = ["-P", os.path.join(HERE, "toml_to_blender.py"), "--"]
    common = ["--size", arguments.size, "--threads", str(arguments.threads)]
    run(["blender", *quiet, *script, arguments.scene, out, *common, *words], out + ".log", environment)


def film_mm(scene):
    """Returns the film width and film distance of the scene's first camera. A file of another program does not contain
    them."""
    with open(scene, "rb") as file:
        camera = tomllib.load(file)["camera"][0]
    return camera.get("film_width_mm", 36), camera.get("focal_length_mm", 50)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", metavar="BUILD", help="build folder with apps/postlens, a release build")
    parser.add_argument("--scene", default=BARS, help="a scene that toml_to_blender.py takes (default: bars.toml)")
    parser.add_argument("--f-number", default="1.4", metavar="N")
    parser.add_argument("--focus", default="5", metavar="M")
    parser.add_argument("--size", default="960x540", metavar="WxH")
    parser.add_argument("--pinhole-spp", default="64", metavar="N", help="samples of the pinhole picture")
    parser.add_argument("--spp", default="256", metavar="N", help="samples of each half of the reference")
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--out", metavar="DIR", help="keep the pictures here")
    parser.add_argument("--keep", action="store_true", help="do not render again what DIR has")
    arguments = parser.parse_args()
    program = os.path.join(arguments.build, "apps", "postlens")
    if not os.access(program, os.X_OK):
        fail(f"{program} is missing; build the target postlens")
    if shutil.which("blender") is None:
        fail("blender is missing; install it with: apt-get install --no-install-recommends blender python3-numpy")
    with tempfile.TemporaryDirectory() as scratch:
        folder = os.path.abspath(arguments.out or scratch)
        os.makedirs(folder, exist_ok=True)
        pinhole, halves = os.path.join(folder, "pinhole.exr"), [os.path.join(folder, f"lens.{i}.exr") for i in (1, 2)]
        blender(pinhole, arguments, ["--f-number", "inf", "--spp", arguments.pinhole_spp, "--passes"])
        for seed, half in enumerate(halves, 1):
            lens = ["--f-number", arguments.f_number, "--focus", arguments.focus]
            blender(half, arguments, [*lens, "--spp", arguments.spp, "--seed", str(seed)])
        width, distance = film_mm(arguments.scene)
        camera = ["--film-width", str(width), "--focal-length", str(distance), "--metres-per-unit", "1", "--z", "axial"]
        lens = ["--f-number", arguments.f_number, "--focus", arguments.focus]
        flat = os.path.join(folder, "flat.exr")
        run([program, "image", pinhole, "-o", flat, "--quiet"])
        print(f"{'method':8} {'PSNR':>7} {'affected':>9} {'noise':>7} {'FLIP':>7} {'seconds':>8}")
        results = {}
        for method in METHODS:
            out = os.path.join(folder, f"{method}.exr")
            said = json.loads(run([program, "focus", pinhole, "-o", out, "--method", method, "--json", *camera, *lens]))
            compared = json.loads(run([program, "compare", out, halves[0], "--noise", halves[1], "--pinhole", flat, "--json"]))
            results[method] = compared | {"seconds_focus": said["seconds"], "warnings_focus": said["warnings"]}
            print(f"{method:8} {compared['psnr_db']:7.2f} {compared['affected_psnr_db']:9.2f}"
                  f" {compared['noise_psnr_db']:7.2f} {compared['flip']:7.4f} {said['seconds']:8.2f}")
        with open(os.path.join(folder, "results.json"), "w", encoding="utf-8") as file:
            json.dump(results, file, indent=2)


if __name__ == "__main__":
    main()
