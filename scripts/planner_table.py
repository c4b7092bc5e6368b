#!/usr/bin/env python3
"""What the planner expects against what comes of it, as docs/planner.md has it.

    planner_table.py BUILD OUT [--cases samples|atlas|all] [--size WxH] [--spp N]

BUILD is a built folder (build/release). For every sample scene below and every case of the atlas that has a lens, and every
target, OUT gets planner.csv, one line per tile, planner.md, a line per picture and what they come to, and expected.svg/.png
(gnuplot): expected against measured error. Each case is traced for its lens, focused by `--method auto` for each target, and held
tile by tile against rays of 2 x N samples a pixel, whose noise is taken off. The cheapest fixed setting is searched for among
scatter, layers, lightfield with 16 to 2048 views and hybrid, in turns with the planner, three rounds: the cheapest whose whole
picture meets the target, and the cheapest that does so on nine tiles in ten as well, which is what the planner aims at.
"""

import argparse
import array
import csv
import glob
import json
import math
import os
import statistics
import struct
import subprocess
import sys
import tomllib

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(HERE, "..", "samples", "scenes")
TILE = 64

# name, scene, lens, set: the exponent and the constants were fitted on "calibrate" alone.
CASES = [
    ("bars", "bars.toml", ["--f-number", "1.4", "--focus", "5"], "calibrate"),
    ("bars far", "bars.toml", ["--f-number", "2.8", "--focus", "20"], "check"),
    ("bars near", "bars.toml", ["--f-number", "2", "--focus", "1.6"], "calibrate"),
    ("still life", "still_life.toml", ["--f-number", "1.8", "--focus", "0.8"], "calibrate"),
    ("still life far", "still_life.toml", ["--f-number", "1.8", "--focus", "2.5"], "check"),
    ("flat mirror", "optics/flat_mirror.toml", ["--f-number", "1.4", "--focus", "4"], "calibrate"),
    ("convex mirror", "optics/convex_mirror.toml", ["--f-number", "1.4", "--focus", "2"], "check"),
    ("concave mirror", "optics/concave_mirror.toml", ["--f-number", "1.4", "--focus", "2"], "calibrate"),
    ("mirror in mirror", "optics/mirror_in_mirror.toml", ["--f-number", "1.4", "--focus", "4"], "check"),
    ("motion", "motion.toml", ["--f-number", "1.4", "--focus", "4"], "check"),
    ("night", "night.toml", ["--f-number", "1.4", "--focus", "3"], "calibrate"),
    ("ruler", "ruler.toml", ["--f-number", "1.4", "--focus", "1"], "check"),
]
# Lamps that few rays of a pixel meet: their references take eight times as many. Noise is taken off, but not that the encoded
# values of a noisy picture are darker on the mean.
LAMPS = {"still life", "still life far", "night", "atlas: sparse bright lights", "atlas: lights behind bars"}
ATLAS = os.path.join(HERE, "..", "tests", "stability")
VIEWS = (16, 32, 64, 128, 256, 512, 1024, 2048)
FIXED = [("scatter", 0), ("layers", 0)] + [("lightfield", m) for m in VIEWS] + [("hybrid", m) for m in (32, 128, 512)]


class Case:
    """A scene with a lens, perhaps a shutter, in one of the sets."""

    def __init__(self, name, scene, lens, group, size, shutter=None):
        self.name, self.scene, self.group, self.size = name, scene, group, size
        self.picture = list(lens)  # of focus, shoot and render
        numbers = dict(zip(lens[::2], lens[1::2]))
        with open(scene, "rb") as file:
            scene_lens_mm = tomllib.load(file).get("camera", [{}])[0].get("focal_length_mm", 50)
        # Of the lens's diameter, which is what a trace is made for.
        f_number = float(numbers["--f-number"]) * scene_lens_mm / float(numbers.get("--focal-length", scene_lens_mm))
        self.trace = ["--for-f-number", repr(f_number), "--for-focus", numbers["--focus"], "--overscan", "auto"]
        self.focus = "focus"
        if shutter:
            self.focus = "shoot"
            span = f"{shutter[0]}:{shutter[1]}"
            self.picture += ["--shutter", span]
            self.trace += ["--for-shutter", span, "--keys", "auto"]

    @property
    def file(self):
        return self.name.replace(" ", "_").replace(":", "")


def sample_cases(size):
    return [Case(name, os.path.join(SCENES, scene), lens, group, size) for name, scene, lens, group in CASES]


def atlas_cases():
    """What the atlas looks at with a lens, each view once."""
    out, seen = [], set()
    for path in sorted(glob.glob(os.path.join(ATLAS, "*.toml"))):
        with open(path, "rb") as file:
            case = tomllib.load(file)
        view = case["view"]
        if "f_number" not in view:
            continue
        lens = ["--f-number", str(view["f_number"]), "--focus", str(view["focus_m"])]
        if "focal_length_mm" in view:
            lens += ["--focal-length", str(view["focal_length_mm"])]
        scene = os.path.normpath(os.path.join(ATLAS, view["scene"]))
        key = (scene, tuple(lens), tuple(view.get("shutter_s", ())))
        if key not in seen:
            seen.add(key)
            out.append(Case("atlas: " + os.path.basename(path)[:-5].replace("_", " "), scene, lens, case["set"], tuple(view["size_px"]), view.get("shutter_s")))
    return out


def run(*arguments, codes=(0,)):
    result = subprocess.run(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    if result.returncode not in codes:
        sys.exit(f"planner_table.py: failed with {result.returncode}: {' '.join(arguments)}\n{result.stderr.decode()}")
    return result.stdout


def encoded(value):
    if not value > 0:
        return 0.0
    if value >= 1:
        return 1.0
    return 12.92 * value if value <= 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055


def pixels(path, size):
    """Width, height and the encoded values of an EXR, by way of oiiotool's uncompressed TIFF, whose pixels come last."""
    width, height = size
    tif = path + ".tif"
    run("oiiotool", path, "--ch", "0,1,2", "-d", "float", "--compression", "none", "-o", tif)
    with open(tif, "rb") as file:
        bytes_of_file = file.read()
    os.remove(tif)
    wanted = 12 * width * height
    order, _, first = struct.unpack("<2sHI", bytes_of_file[:8])
    if order != b"II" or first != 8 or len(bytes_of_file) < wanted:
        sys.exit(f"planner_table.py: {tif}: not what was expected of oiiotool")
    values = array.array("f", bytes_of_file[-wanted:])
    return width, height, [encoded(v) for v in values]


def tile_errors(image, a, b):
    """Mean of (image - a)(image - b) by tile: the squared error without the references' noise."""
    width, height, i = image
    columns, rows = (width + TILE - 1) // TILE, (height + TILE - 1) // TILE
    sums, counts = [0.0] * (columns * rows), [0] * (columns * rows)
    p, q = a[2], b[2]
    for y in range(height):
        for column in range(columns):
            first, last = 3 * (y * width + column * TILE), 3 * (y * width + min(width, (column + 1) * TILE))
            t = y // TILE * columns + column
            sums[t] += sum((i[k] - p[k]) * (i[k] - q[k]) for k in range(first, last))
            counts[t] += last - first
    return [s / n for s, n in zip(sums, counts)], counts


def db(mse):
    return -10 * math.log10(max(mse, 1e-9))


def trace(postlens, case, at):
    run(postlens, "trace", case.scene, "-o", at + ".frame.exr", "--size", f"{case.size[0]}x{case.size[1]}", *case.trace, "--quiet")


def references(postlens, case, at, spp):
    """Two independent ones, made if they are not there."""
    if not os.path.exists(at + ".ref.b.exr"):
        run(postlens, "render", case.scene, "-o", at + ".ref.exr", "--size", f"{case.size[0]}x{case.size[1]}", *case.picture, "--spp",
            str(2 * spp * (8 if case.name in LAMPS else 1)), "--halves", "--seed", "1", "--quiet")
    return pixels(at + ".ref.a.exr", case.size), pixels(at + ".ref.b.exr", case.size)


def share_at(errors, target):
    return sum(db(e) >= target for e in errors) / len(errors)


def setting(found):
    """A fixed setting and its time."""
    return f"{found[1][0]}{f' {found[1][1]}' if found[1][1] else ''}, {found[0]:.2f} s" if found else "none"


def ratio(picture, of):
    return f"{picture['seconds'] / picture[of][0]:.2f}" if picture[of] else ""


def summary(pictures, tiles, targets):
    """What the pictures come to, by set and target."""
    out = ["| set | target, dB | pictures | said so | of the others: at the target within 1 dB | tiles expected at the target | there | "
           "time over the cheapest fixed, whole picture: median, most | the same, on nine tiles in ten too | seconds of all those over theirs |",
           "|" + "---|" * 10]
    for group in ("calibrate", "check"):
        for target in targets:
            of = [p for p in pictures if p["set"] == group and p["target"] == target]
            if not of:
                continue
            kept = [p for p in of if not p["warned"]]
            names = {p["case"] for p in kept}
            promised = [t for t in tiles if t[0] in names and t[2] == target]
            times = []
            for kind in ("whole", "by_tiles"):
                found = sorted(p["seconds"] / p[kind][0] for p in of if p[kind])
                times.append(f"{statistics.median(found):.2f}, {found[-1]:.2f} ({len(found)})" if found else "")
            both = [p for p in of if p["by_tiles"]]
            total = sum(p["seconds"] for p in both) / sum(p["by_tiles"][0] for p in both) if both else 0
            out.append(f"| {group} | {target} | {len(of)} | {len(of) - len(kept)} | "
                       f"{sum(p['measured'] >= target - 1 for p in kept)} of {len(kept)} | "
                       f"{100 * sum(t[11] for t in promised) / max(1, len(promised)):.1f} % of {len(promised)} | "
                       f"{100 * sum(db(t[10]) >= target for t in promised) / max(1, len(promised)):.1f} % | {times[0]} | {times[1]} | {total:.2f} |")
    return "\n".join(out) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build")
    parser.add_argument("out")
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--spp", type=int, default=1024)
    parser.add_argument("--cases", choices=("samples", "atlas", "all"), default="all", help="the atlas's have sizes of their own")
    parser.add_argument("--only", help="one case by name")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--targets", default="30,35,40,45")
    parser.add_argument("--most-views", type=int, default=2048, help="of the fixed settings")
    parser.add_argument("--no-fixed", action="store_true", help="do not look for the cheapest fixed setting")
    o = parser.parse_args()
    os.makedirs(o.out, exist_ok=True)
    postlens = os.path.join(o.build, "apps", "postlens")
    targets = [int(t) for t in o.targets.split(",")]
    common = ["--quiet", "--json"]
    cases = sample_cases(tuple(map(int, o.size.split("x")))) if o.cases != "atlas" else []
    cases += atlas_cases() if o.cases != "samples" else []
    tiles, pictures = [], []
    for case in cases:
        if o.only and o.only != case.name:
            continue
        name, group, size = case.name, case.group, case.size
        at = os.path.join(o.out, case.file)
        trace(postlens, case, at)
        a, b = references(postlens, case, at, o.spp)
        commands = {}
        for target in targets:
            commands[("auto", target)] = ["--method", "auto", "--target-db", str(target), "--scene", case.scene]
        if not o.no_fixed:
            for method, views in FIXED:
                if views > o.most_views or (case.focus == "shoot" and views == 0):
                    continue
                commands[(method, views)] = ["--method", method] + (["--views", str(views)] if views else [])
                commands[(method, views)] += ["--scene", case.scene] if method == "hybrid" else []
        seconds, found = {}, {}
        for _ in range(o.rounds):
            for key, more in commands.items():
                picture = f"{at}.{key[0]}{key[1]}.exr"
                result = json.loads(run(postlens, case.focus, at + ".frame.exr", "-o", picture, *case.picture, *more, *common,
                                        codes=(0, 6)))
                seconds.setdefault(key, []).append(result["seconds"])
                found[key] = (result, picture)
        measured = {}
        for key, (result, picture) in found.items():
            errors, counts = tile_errors(pixels(picture, size), a, b)
            measured[key] = (errors, sum(e * n for e, n in zip(errors, counts)) / sum(counts))
        for target in targets:
            result = found[("auto", target)][0]
            errors, whole = measured[("auto", target)]
            plan = result["plan"]
            for t, (tile, error) in enumerate(zip(plan["tiles"], errors)):
                expected = tile["noise_mse"] + tile["floor_mse"] + tile["hidden_mse"]
                tiles.append([name, group, target, t, tile["views"], tile["noise_mse"], tile["floor_mse"], tile["hidden_mse"],
                              tile["retraced_share"], expected, error, tile["met_chance"]])
            middle = sorted(seconds[("auto", target)])[o.rounds // 2]
            fixed = {k: (sorted(seconds[k])[o.rounds // 2], *m) for k, m in measured.items() if k[0] != "auto"}
            by_whole = min(((s, k) for k, (s, _, w) in fixed.items() if db(w) >= target), default=None)
            by_tiles = min(((s, k) for k, (s, e, w) in fixed.items() if db(w) >= target and share_at(e, target) >= 0.9),
                           default=None)
            pictures.append({"case": name, "set": group, "target": target, "expected": result["predicted_db"],
                             "measured": db(whole), "tiles": share_at(errors, target), "promised": plan["met_share"],
                             "again": result["retraced_share"], "seconds": middle, "whole": by_whole, "by_tiles": by_tiles,
                             "warned": any(w["code"] == "target" for w in result["warnings"])})
            p = pictures[-1]
            print(f"{name} {target}: expected {p['expected']:.1f}, measured {p['measured']:.1f} dB, tiles {100 * p['tiles']:.0f} % "
                  f"(said {100 * p['promised']:.0f}), again {100 * p['again']:.1f} %, {p['seconds']:.2f} s; whole: {setting(by_whole)}; "
                  f"tiles too: {setting(by_tiles)}{'; warned' if p['warned'] else ''}", flush=True)

    with open(os.path.join(o.out, "planner.csv"), "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow("case set target tile views noise floor hidden retraced expected measured chance".split())
        writer.writerows(tiles)
    with open(os.path.join(o.out, "planner.md"), "w", encoding="utf-8") as file:
        file.write("| scene | set | target, dB | expected | measured | tiles at the target | traced again | s | cheapest fixed, whole "
                   "picture | ratio | on nine tiles in ten too | ratio |\n|" + "---|" * 12 + "\n")
        for p in pictures:
            file.write(f"| {p['case']} | {p['set']} | {p['target']} | {p['expected']:.1f}"
                       f"{' (said so)' if p['warned'] else ''} | {p['measured']:.1f} | {100 * p['tiles']:.0f} % | "
                       f"{100 * p['again']:.1f} % | {p['seconds']:.2f} | {setting(p['whole'])} | {ratio(p, 'whole')} | "
                       f"{setting(p['by_tiles'])} | {ratio(p, 'by_tiles')} |\n")
        file.write("\n" + summary(pictures, tiles, targets))
    print(summary(pictures, tiles, targets))
    script = f"""
set datafile separator ','
set logscale xy
set xlabel 'expected mean squared error of a tile'
set ylabel 'measured'
set xrange [1e-7:0.1]
set yrange [1e-7:0.1]
set format '10^{{%L}}'
set key top left
set grid
plot x with lines linecolor rgb '#999999' title 'as expected', 2*x with lines dashtype 2 linecolor rgb '#999999' notitle, \\
 x/2 with lines dashtype 2 linecolor rgb '#999999' title 'twice, half', \\
 '{os.path.join(o.out, "planner.csv")}' using (strcol(2) eq 'calibrate' ? $10 : 1/0):11 skip 1 with points pointtype 7 pointsize 0.4 linecolor rgb '#e69f00' title 'calibrated on', \\
 '' using (strcol(2) eq 'check' ? $10 : 1/0):11 skip 1 with points pointtype 7 pointsize 0.4 linecolor rgb '#0072b2' title 'checked on'
"""
    for terminal, ending in (("svg size 720,560 font 'sans,13' background rgb 'white'", "svg"), ("pngcairo size 720,560", "png")):
        subprocess.run(["gnuplot"], input=f"set terminal {terminal}\nset output '{os.path.join(o.out, 'expected.' + ending)}'\n"
                       .encode() + script.encode(), check=True)


if __name__ == "__main__":
    main()
