#!/usr/bin/env python3
"""What --predict expects of pictures against what they are off by, as docs/planner.md has it.

    prediction_table.py BUILD OUT [--cases samples|atlas|all] [--size WxH] [--spp N]

BUILD is a built folder (build/release). The cases are those of planner_table.py, whose sample files and references in OUT are used
if they are there. OUT gets prediction.csv, a line per tile, pictures.csv and prediction.md, a line per picture and what they come to by method, and
prediction.svg/.png (gnuplot): expected against measured error of whole pictures.
"""

import argparse
import csv
import json
import os
import statistics
import subprocess

from planner_table import atlas_cases, db, pixels, references, run, sample_cases, tile_errors, trace

SETTINGS = [("scatter", 0), ("layers", 0), ("lightfield", 16), ("lightfield", 64), ("lightfield", 256), ("hybrid", 64)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build")
    parser.add_argument("out")
    parser.add_argument("--size", default="384x216")
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--cases", choices=("samples", "atlas", "all"), default="all", help="the atlas's have sizes of their own")
    parser.add_argument("--only", help="one case by name")
    o = parser.parse_args()
    os.makedirs(o.out, exist_ok=True)
    postlens = os.path.join(o.build, "apps", "postlens")
    common = ["--quiet", "--json"]
    cases = sample_cases(tuple(map(int, o.size.split("x")))) if o.cases != "atlas" else []
    cases += atlas_cases() if o.cases != "samples" else []
    tiles, pictures = [], []
    for case in cases:
        if o.only and o.only != case.name:
            continue
        at = os.path.join(o.out, case.file)
        if not os.path.exists(at + ".frame.exr"):
            trace(postlens, case, at)
        a, b = references(postlens, case, at, o.spp)
        for method, views in SETTINGS:
            if case.focus == "shoot" and method in ("scatter", "layers"):
                continue
            more = ["--views", str(views)] if views else []
            more += ["--scene", case.scene] if method == "hybrid" else []
            picture = f"{at}.predict.exr"
            result = json.loads(run(postlens, case.focus, at + ".frame.exr", "-o", picture, *case.picture, "--method", method, *more,
                                    "--predict", *common))
            errors, counts = tile_errors(pixels(picture, case.size), a, b)
            noise = sum(((x - y) / 2) ** 2 for x, y in zip(a[2], b[2])) / len(a[2])
            measured = db(sum(e * n for e, n in zip(errors, counts)) / sum(counts))
            name = f"{method} {views}" if views else method
            for tile, error in zip(result["prediction"]["tiles"], errors):
                parts = [tile["method_mse"], tile["floor_mse"], tile["hidden_mse"]]
                tiles.append([case.name, case.group, name, *parts, sum(parts), error])
            pictures.append([case.name, case.group, name, result["predicted_db"], measured, result["seconds"]])
            print(f"{case.name}, {name}: {result['predicted_db']:.1f} dB expected, {measured:.1f} measured (reference {db(noise):.1f}), "
                  f"{result['seconds']:.2f} s", flush=True)
    with open(os.path.join(o.out, "prediction.csv"), "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow("case set method of_method floor hidden expected measured".split())
        writer.writerows(tiles)
    with open(os.path.join(o.out, "pictures.csv"), "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow("case set method expected_db measured_db seconds".split())
        writer.writerows(pictures)
    lines = ["| method | pictures | expected less measured, dB: median | within 2 dB | within 4 dB | most above | most below | "
             "tiles within a factor of 2.5 |", "|" + "---|" * 8]
    for method, views in SETTINGS:
        name = f"{method} {views}" if views else method
        off = [p[3] - p[4] for p in pictures if p[2] == name]
        if not off:
            continue
        of = [t for t in tiles if t[2] == name and (t[6] > 1e-6 or t[7] > 1e-6)]
        near = sum(0.4 <= max(t[7], 1e-7) / max(t[6], 1e-7) <= 2.5 for t in of)
        lines.append(f"| {name} | {len(off)} | {statistics.median(off):+.1f} | {100 * sum(abs(d) <= 2 for d in off) / len(off):.0f} % | "
                     f"{100 * sum(abs(d) <= 4 for d in off) / len(off):.0f} % | {max(off):+.1f} | {min(off):+.1f} | "
                     f"{100 * near / max(1, len(of)):.0f} % of {len(of)} |")
    text = "\n".join(lines) + "\n"
    with open(os.path.join(o.out, "prediction.md"), "w", encoding="utf-8") as file:
        file.write("| scene | set | method | expected, dB | measured, dB |\n|" + "---|" * 5 + "\n")
        for p in pictures:
            file.write(f"| {p[0]} | {p[1]} | {p[2]} | {p[3]:.1f} | {p[4]:.1f} |\n")
        file.write("\n" + text)
    print(text)
    colours = ["#999999", "#e69f00", "#56b4e9", "#0072b2", "#000000", "#009e73"]
    of = os.path.join(o.out, "pictures.csv")
    plots = [f"'{of}' using (strcol(3) eq '{m + (f' {v}' if v else '')}' ? $4 : 1/0):5 skip 1 with points pointtype 7 pointsize 0.6 "
             f"linecolor rgb '{colour}' title '{m + (f', {v} views' if v else '')}'" for (m, v), colour in zip(SETTINGS, colours)]
    script = f"""
set datafile separator ','
set xlabel 'expected, dB'
set ylabel 'measured, dB'
set xrange [15:70]
set yrange [15:70]
set key top left
set grid
plot x with lines linecolor rgb '#999999' title 'as expected', x+2 with lines dashtype 2 linecolor rgb '#999999' title '2 dB off', \\
 x-2 with lines dashtype 2 linecolor rgb '#999999' notitle, {', '.join(plots)}
"""
    for terminal, ending in (("svg size 720,560 font 'sans,13' background rgb 'white'", "svg"), ("pngcairo size 720,560", "png")):
        subprocess.run(["gnuplot"], input=f"set terminal {terminal}\nset output '{os.path.join(o.out, 'prediction.' + ending)}'\n"
                       .encode() + script.encode(), check=True)


if __name__ == "__main__":
    main()
