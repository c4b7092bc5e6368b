#!/usr/bin/env python3
"""What the planner expects against what comes of it, as docs/planner.md has it.

    planner_table.py BUILD OUT [--cases FILE] [--size WxH] [--spp N]

BUILD is a built folder (build/release). For every scene of CASES (default: the sample scenes below) and every target OUT gets
planner.csv, one line per picture and one per tile, planner.md, and expected.svg/.png (gnuplot): expected against measured
error. Each case is traced for its lens, focused by `--method auto` for each target, and held tile by tile against rays of 2 x N
samples a pixel, whose noise is taken off. The cheapest fixed setting that meets the target is searched for among lightfield and
hybrid with 16 to 2048 views, layers and scatter, in turns with the planner, three rounds.
"""

import argparse
import array
import csv
import json
import math
import os
import struct
import subprocess
import sys

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
FIXED = ([("scatter", []), ("layers", [])] + [("lightfield", ["--views", str(m)]) for m in (16, 32, 64, 128, 256, 512, 1024, 2048)])


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


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build")
    parser.add_argument("out")
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--spp", type=int, default=1024)
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
    size = tuple(map(int, o.size.split("x")))
    tiles, pictures = [], []
    for name, scene, lens, group in CASES:
        if o.only and o.only != name:
            continue
        scene = os.path.join(SCENES, scene)
        at = os.path.join(o.out, name.replace(" ", "_"))
        run(postlens, "trace", scene, "-o", at + ".frame.exr", "--size", o.size, "--overscan", "auto", "--for-f-number", lens[1],
            "--for-focus", lens[3], *common)
        if not os.path.exists(at + ".ref.b.exr"):
            run(postlens, "render", scene, "-o", at + ".ref.exr", "--size", o.size, *lens, "--spp", str(2 * o.spp), "--halves",
                "--seed", "1", *common)
        a, b = pixels(at + ".ref.a.exr", size), pixels(at + ".ref.b.exr", size)
        commands = {}
        for target in targets:
            commands[("auto", target)] = ["--method", "auto", "--target-db", str(target), "--scene", scene]
        if not o.no_fixed:
            for method, more in FIXED:
                if more and int(more[1]) > o.most_views:
                    continue
                commands[(method, more[1] if more else "")] = ["--method", method, *more]
        seconds, found = {}, {}
        for _ in range(o.rounds):
            for key, more in commands.items():
                picture = f"{at}.{key[0]}{key[1]}.exr"
                result = json.loads(run(postlens, "focus", at + ".frame.exr", "-o", picture, *lens, *more, *common, codes=(0, 6)))
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
                              tile["retraced_share"], expected, error])
            middle = sorted(seconds[("auto", target)])[o.rounds // 2]
            met = [(sorted(seconds[k])[o.rounds // 2], k) for k, (_, w) in measured.items() if k[0] != "auto" and db(w) >= target]
            cheapest = min(met) if met else None
            pictures.append({"case": name, "set": group, "target": target, "expected": result["predicted_db"],
                             "measured": db(whole), "tiles": sum(db(e) >= target for e in errors) / len(errors),
                             "promised": plan["met_share"], "again": result["retraced_share"], "seconds": middle,
                             "cheapest": f"{cheapest[1][0]} {cheapest[1][1]}".strip() if cheapest else "none",
                             "cheapest_s": cheapest[0] if cheapest else float("nan"), "warned": any(
                                 w["code"] == "target" for w in result["warnings"])})
            p = pictures[-1]
            print(f"{name} {target}: expected {p['expected']:.1f}, measured {p['measured']:.1f} dB, tiles {100 * p['tiles']:.0f} % "
                  f"(said {100 * p['promised']:.0f}), again {100 * p['again']:.1f} %, {p['seconds']:.2f} s, cheapest {p['cheapest']} "
                  f"{p['cheapest_s']:.2f} s{', warned' if p['warned'] else ''}", flush=True)

    with open(os.path.join(o.out, "planner.csv"), "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow("case set target tile views noise floor hidden retraced expected measured".split())
        writer.writerows(tiles)
    with open(os.path.join(o.out, "planner.md"), "w", encoding="utf-8") as file:
        file.write("| scene | set | target, dB | expected, dB | measured, dB | tiles at the target | expected | traced again | s | "
                   "cheapest fixed setting | its s | ratio |\n|" + "---|" * 12 + "\n")
        for p in pictures:
            ratio = p["seconds"] / p["cheapest_s"]
            file.write(f"| {p['case']} | {p['set']} | {p['target']} | {p['expected']:.1f}{' (said so)' if p['warned'] else ''} | "
                       f"{p['measured']:.1f} | {100 * p['tiles']:.0f} % | {100 * p['promised']:.0f} % | {100 * p['again']:.1f} % | "
                       f"{p['seconds']:.2f} | {p['cheapest']} | {'' if math.isnan(ratio) else format(p['cheapest_s'], '.2f')} | "
                       f"{'' if math.isnan(ratio) else format(ratio, '.2f')} |\n")
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
