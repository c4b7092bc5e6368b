#!/usr/bin/env python3
"""Compares postlens' distributed rays with Blender's Cycles, with the same lens and shutter: difference and speed.

    thin_lens_cycles.py BUILD [--spp N] [--rounds N] [--size WxH] [--only NAME] [--out DIR] [--self] ...

Each round renders every image once with both programs, with a new seed. The programs alternate in running first. The
odd rounds form one half of a program's samples, the even rounds the other half. compare_halves.py describes the
comparison. Blender comes from Debian: apt-get install --no-install-recommends blender python3-numpy
"""

import argparse
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
BARS = os.path.join(HERE, "..", "..", "samples", "scenes", "bars.toml")
MOTION = os.path.join(HERE, "..", "..", "samples", "scenes", "motion.toml")
PICTURES = {
    "lens": (BARS, ["--f-number", "1.4", "--focus", "5"]),
    "motion": (MOTION, ["--f-number", "inf", "--shutter", "0:1"]),
    "both": (MOTION, ["--f-number", "1.4", "--focus", "4", "--shutter", "0:1"]),
}
TIMEOUT_S = 3600


def fail(text):
    sys.exit(f"thin_lens_cycles.py: {text}")


def run(command, log, environment=None):
    """Runs a program to its end. Returns its wall time and its processor time, in seconds."""
    start = time.monotonic()
    with open(log, "w", encoding="utf-8") as file:
        process = subprocess.Popen(["timeout", str(TIMEOUT_S), *command], stdout=file, stderr=file, env=environment)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        with open(log, encoding="utf-8", errors="replace") as file:
            lines = [line.strip() for line in file if line.strip() and not line.startswith("Fra:")]
        told = [line for line in lines if line.startswith(("postlens:", "toml_to_blender.py:", "compare_halves.py:"))]
        fail(f"{os.path.basename(command[0])} failed: {(told or lines or ['it said nothing'])[-1]}")
    return time.monotonic() - start, used.ru_utime + used.ru_stime


def blender(script, words, log):
    # Blender's Python loads the standard library of the first python3 on the search path. It must be Debian's python3,
    # which has numpy.
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    environment["PATH"] = "/usr/bin:" + os.environ["PATH"]
    quiet = ["-b", "--factory-startup", "-noaudio", "--python-exit-code", "1"]
    return run(["blender", *quiet, "-P", os.path.join(HERE, script), "--", *words], log, environment)


def cycles_seconds(log, spp):
    """Returns the time from the first sample to the last, in seconds, read from the progress output of Cycles. The time
    does not include the preparation (copying the scene, building hierarchies) and the writing of the file."""
    clock = r"Time:(?:(\d+):)?(\d+):(\d+\.\d+)"
    with open(log, encoding="utf-8", errors="replace") as file:
        text = file.read()
    found = []
    for ending in (rf"Sample 0/{spp}$", "Finished$"):
        line = re.search(rf"^Fra:.*?{clock}.*\| {ending}", text, re.MULTILINE)
        if line is None:
            fail(f"{log}: Cycles told no time (expected a line that ends with {ending})")
        found.append(int(line[1] or 0) * 3600 + int(line[2]) * 60 + float(line[3]))
    return found[1] - found[0]


def render_cycles(stem, scene, words, spp):
    wall_s, processor_s = blender("toml_to_blender.py", [scene, stem + ".exr", *words], stem + ".log")
    with open(stem + ".log", encoding="utf-8", errors="replace") as file:
        said = re.search(r"^toml_to_blender: (\{.*)$", file.read(), re.MULTILINE)
    if said is None or not os.path.exists(stem + ".exr"):
        fail(f"{stem}.log: Blender wrote no picture")
    times = {"render_s": cycles_seconds(stem + ".log", spp), "process_s": wall_s, "processor_s": processor_s}
    return times | json.loads(said[1])


def render_postlens(program, stem, scene, words):
    wall_s, processor_s = run([program, "render", scene, "-o", stem + ".exr", "--json", *words], stem + ".log")
    with open(stem + ".log", encoding="utf-8") as file:
        said = json.load(file)
    return {"render_s": said["seconds_render"], "process_s": wall_s, "processor_s": processor_s}


def speed(runs, samples):
    """Returns the least, median and greatest number of samples per second of rendering, in millions. Also returns the
    medians of the other times."""
    rates = sorted(samples / r["render_s"] / 1e6 for r in runs)
    middle = {key: statistics.median(r[key] for r in runs) for key in ("render_s", "process_s", "processor_s")}
    return middle | {
        "msamples_per_s": statistics.median(rates),
        "msamples_per_s_range": [rates[0], rates[-1]],
        "msamples_per_processor_s": samples / middle["processor_s"] / 1e6,
    }


def compare_picture(name, arguments, folder):
    scene, camera = PICTURES[name]
    width_px, height_px = (int(x) for x in arguments.size.split("x"))
    common = ["--spp", str(arguments.spp), "--size", arguments.size, "--threads", str(arguments.threads), *camera]
    ours, theirs, stems = [], [], {"ours": [], "theirs": []}
    for number in range(1, arguments.rounds + 1):
        stem = os.path.join(folder, f"{name}.%s.{number}")
        # The two renderers take turns in running first. Otherwise, the clock rate and caches left by the first would
        # always affect the second.
        for whose in ("ours", "theirs") if number % 2 else ("theirs", "ours"):
            seed = ["--seed", str(number)]
            if whose == "theirs":
                theirs.append(render_cycles(stem % whose, scene, common + seed + arguments.cycles, arguments.spp))
            elif arguments.self:
                seed = ["--seed", str(number + arguments.rounds)]
                ours.append(render_cycles(stem % whose, scene, common + seed + arguments.cycles, arguments.spp))
            else:
                ours.append(render_postlens(arguments.program, stem % whose, scene, common + seed + arguments.postlens))
            stems[whose].append(stem % whose + ".exr")
    out, words = os.path.join(folder, f"{name}.json"), []
    for whose in ("ours", "theirs"):
        words += ["--" + whose, *stems[whose]]
    blender("compare_halves.py", [out, *words, "--map", os.path.join(folder, f"{name}.map.png")], out + ".log")
    if not os.path.exists(out):
        fail(f"{out}.log: nothing was compared")
    with open(out, encoding="utf-8") as file:
        result = json.load(file)
    samples = width_px * height_px * arguments.spp
    return result | {
        "picture": name,
        "scene": os.path.basename(scene),
        "options": camera,
        "spp_of_each_program": arguments.spp * arguments.rounds,
        "ours": speed(ours, samples),
        "theirs": speed(theirs, samples),
        "outline_px": theirs[0]["outline_px"],
        "motion_px": theirs[0]["motion_px"],
    }


def report(results, arguments):
    whose = "Cycles, other seeds" if arguments.self else "postlens"
    print(f"{whose} (ours) and Cycles (theirs), {arguments.size}, {arguments.rounds} rounds of {arguments.spp} samples"
          f" per pixel, {arguments.threads} threads")
    print("\nAgreement of the means of all rounds; PSNR in dB for a peak of 1")
    print("  noise: what the noise of both would leave (ours, theirs: of each); bias^2: squared bias beyond that, with")
    print("  its standard error; above: the bias alone has at least this PSNR (two standard errors); mean: difference")
    print("  of the pictures' means; shift: how far theirs lies to the right and below, px")
    print(f"{'picture':8} {'colour':8} {'PSNR':>6} {'noise':>6} {'ours':>6} {'theirs':>6} {'bias^2':>10} {'error':>9}"
          f" {'above':>6} {'mean':>10} {'error':>9} {'shift':>16}")
    for r in results:
        for colour in ("linear", "encoded"):
            c = r[colour]
            shift = f"{r['shift_px'][0]:.4f}, {r['shift_px'][1]:.4f}" if colour == "linear" else ""
            print(f"{r['picture']:8} {colour:8} {c['psnr_db']:6.2f} {c['noise_psnr_db']:6.2f}"
                  f" {c['ours_noise_psnr_db']:6.2f} {c['theirs_noise_psnr_db']:6.2f} {c['squared_bias']:10.2e}"
                  f" {c['squared_bias_error']:9.1e} {c['bias_at_most_psnr_db']:6.1f} {c['mean_difference']:10.2e}"
                  f" {c['mean_difference_error']:9.1e} {shift:>16}")
    outline_px, motion_px = (max(r[key] for r in results) for key in ("outline_px", "motion_px"))
    print(f"  In Cycles' scenes outlines are off by {outline_px:.4f} px at most, paths by {motion_px:.4f} px")
    print("\nSpeed, medians of the rounds: million samples per second of rendering alone (least to most), the same per")
    print("  second of the process's processor time; seconds of rendering, of the process, of processor time")
    print(f"{'picture':8} {'whose':8} {'Ms/s':>19} {'Ms/proc.s':>9} {'rendering':>9} {'process':>9} {'processor':>9}")
    for r in results:
        for side in ("ours", "theirs"):
            s = r[side]
            least, most = s["msamples_per_s_range"]
            rate = f"{s['msamples_per_s']:.2f} ({least:.2f}-{most:.2f})"
            print(f"{r['picture']:8} {side:8} {rate:>19} {s['msamples_per_processor_s']:9.2f} {s['render_s']:9.2f}"
                  f" {s['process_s']:9.2f} {s['processor_s']:9.2f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", metavar="BUILD", help="build folder with apps/postlens, a release build")
    # With fewer samples per pixel than the default, Cycles' images have a bias that does not depend on the seed.
    # Comparing Cycles with itself (--self) would not reveal this bias.
    parser.add_argument("--spp", type=int, default=256, help="samples per pixel of a round (default: 256)")
    parser.add_argument("--rounds", type=int, default=2, help="an even number (default: 2)")
    parser.add_argument("--size", default="960x540", metavar="WxH", help="raster (default: 960x540)")
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)), help="of both (default: all)")
    parser.add_argument("--only", action="append", choices=PICTURES, help="a picture; may be given again")
    parser.add_argument("--out", metavar="DIR", help="keep pictures, maps of the difference and results.json here")
    parser.add_argument("--self", action="store_true", help="Cycles in postlens' place: what no difference looks like")
    for name, what in (("--cycles", "toml_to_blender.py"), ("--postlens", "postlens render")):
        words = f"more for {what}, as in {name}=--sampler=sobol"
        parser.add_argument(name, default=[], type=str.split, metavar="OPTIONS", help=words)
    arguments = parser.parse_args()
    if arguments.rounds < 2 or arguments.rounds % 2 or arguments.spp < 1 or arguments.threads < 1:
        parser.error("--rounds is an even number, --spp and --threads at least 1")
    if not re.fullmatch(r"[1-9]\d*x[1-9]\d*", arguments.size):
        parser.error(f"--size is not WxH (got {arguments.size})")
    arguments.program = os.path.join(arguments.build, "apps", "postlens")
    if not arguments.self and not os.access(arguments.program, os.X_OK):
        fail(f"{arguments.program} is missing; build the target postlens")
    if shutil.which("blender") is None:
        fail("blender is missing; install it with: apt-get install --no-install-recommends blender python3-numpy")
    with tempfile.TemporaryDirectory() as scratch:
        folder = os.path.abspath(arguments.out or scratch)
        os.makedirs(folder, exist_ok=True)
        results = [compare_picture(name, arguments, folder) for name in arguments.only or PICTURES]
        with open(os.path.join(folder, "results.json"), "w", encoding="utf-8") as file:
            json.dump(results, file, indent=2)
    report(results, arguments)


if __name__ == "__main__":
    main()
