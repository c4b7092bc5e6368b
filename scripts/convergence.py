#!/usr/bin/python3
"""Measures the noise of `postlens render` by number of samples and sampler: the table and plot of docs/accuracy.md.

    convergence.py BUILD OUT [--size WxH] [--reference-spp N] [--seeds N]

BUILD is a build folder (build/release). convergence.csv, .md, .svg and .png are written to OUT. The scene is
samples/scenes/motion.toml through a lens of 50 mm at f/1.4, focused at 4 m, with the shutter open from 0 s to 1 s. The
reference has two independent halves, whose noise is subtracted from the errors. The plot needs gnuplot (Debian:
gnuplot-nox).
"""

import argparse
import math
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
SCENE = os.path.join(HERE, "..", "samples", "scenes", "motion.toml")
LENS = {"focal_length_mm": 50, "f_number": 1.4, "focus_m": 4, "shutter": (0, 1)}
SAMPLERS = ["random", "grid", "jittered", "poisson", "sobol"]
SPP = [4, 16, 64, 256]

PLOT = """
set terminal {terminal}
set output '{output}'
set datafile separator ','
set logscale xy
set xrange [3:360]
set xtics ({tics})
set xlabel 'samples per pixel'
set ylabel 'RMSE, scene-linear'
set key bottom left
set grid xtics ytics mytics linecolor rgb '#dddddd'
set style line 1 linecolor rgb '#999999' linewidth 2 pointtype 7
set style line 2 linecolor rgb '#e69f00' linewidth 2 pointtype 5
set style line 3 linecolor rgb '#56b4e9' linewidth 2 pointtype 9
set style line 4 linecolor rgb '#009e73' linewidth 2 pointtype 11
set style line 5 linecolor rgb '#0072b2' linewidth 3 pointtype 13
plot {curves}, {level}*sqrt(4.0/x) with lines dashtype 2 linecolor rgb 'black' title 'n^{{-1/2}}'
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build")
    parser.add_argument("out")
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--reference-spp", type=int, default=8192)
    parser.add_argument("--seeds", type=int, default=2, help="renders whose squared errors are averaged")
    options = parser.parse_args()
    sys.path.insert(0, os.path.join(options.build, "python"))
    import postlens

    size = tuple(int(px) for px in options.size.split("x"))
    os.makedirs(options.out, exist_ok=True)

    def at(name):
        return os.path.join(options.out, name)

    reference = postlens.render(SCENE, size=size, **LENS, spp=options.reference_spp, halves=True, seed=1000)
    pinhole = postlens.render(SCENE, size=size, f_number=math.inf, spp=256)
    rows = []
    for sampler in SAMPLERS:
        for spp in SPP:
            total = {"rmse": 0.0, "mse": 0.0, "affected": 0.0, "relmse": 0.0, "flip": 0.0, "seconds": 0.0}
            for seed in range(1, options.seeds + 1):
                made = postlens.render(SCENE, size=size, **LENS, spp=spp, sampler=sampler, seed=seed)
                c = postlens.compare(made, reference.halves[0], noise=reference.halves[1], pinhole=pinhole)
                total["rmse"] += c["rmse_above_noise"] ** 2
                total["mse"] += 10 ** (-c["psnr_above_noise_db"] / 10)
                total["affected"] += 10 ** (-c["affected_psnr_above_noise_db"] / 10)
                total["relmse"] += c["relmse_above_noise"]
                total["flip"] += c["flip"]
                total["seconds"] += made.report["seconds_render"]
            n = options.seeds
            rows.append({"sampler": sampler, "spp": spp, "rmse": math.sqrt(total["rmse"] / n),
                         "psnr_db": -10 * math.log10(total["mse"] / n),
                         "affected_psnr_db": -10 * math.log10(total["affected"] / n),
                         "relmse": total["relmse"] / n, "flip": total["flip"] / n, "seconds": total["seconds"] / n})
    floor = postlens.compare(*reference.halves, pinhole=pinhole)

    keys = list(rows[0])
    with open(at("convergence.csv"), "w", encoding="utf-8") as file:
        file.write(",".join(keys) + "\n")
        for row in rows:
            file.write(",".join(str(row[k]) for k in keys) + "\n")

    with open(at("convergence.md"), "w", encoding="utf-8") as file:
        def cell(row):
            return f"{row['psnr_db']:.1f} / {row['affected_psnr_db']:.1f} / {row['relmse']:.2g}"

        file.write("| sampler | " + " | ".join(f"{s} spp" for s in SPP) + " | RMSE falls as |\n")
        file.write("|---" * (len(SPP) + 2) + "|\n")
        for sampler in SAMPLERS:
            mine = [r for r in rows if r["sampler"] == sampler]
            slope = math.log(mine[-1]["rmse"] / mine[0]["rmse"]) / math.log(SPP[-1] / SPP[0])
            file.write(f"| {sampler} | " + " | ".join(cell(r) for r in mine) + f" | n^{slope:.2f} |\n")
        # The two halves of the reference were rendered independently, and the reference is their mean. If each half has
        # the noise n, their difference has n sqrt(2), and their mean n / sqrt(2). So the noise of the reference is half
        # of the difference between the halves.
        file.write(f"\nThe halves of the reference are {floor['psnr_db']:.1f} dB apart; affected pixels: "
                   f"{100 * floor['affected_share']:.0f} %.\n")

    curves = ", ".join(
        f"'{at('convergence.csv')}' using (strcol(1) eq '{s}' ? $2 : 1/0):3 with linespoints linestyle {i + 1} title '{s}'"
        for i, s in enumerate(SAMPLERS))
    tics = ", ".join(f"'{s}' {s}" for s in SPP)
    for terminal, ending in [("svg size 720,480 font 'sans,13' background rgb 'white'", "svg"),
                             ("pngcairo size 720,480 font 'sans,11'", "png")]:
        script = PLOT.format(terminal=terminal, output=at("convergence." + ending), tics=tics, curves=curves,
                             level=rows[0]["rmse"])
        subprocess.run(["gnuplot"], input=script, text=True, check=True)
    with open(at("convergence.md"), encoding="utf-8") as file:
        print(file.read())


if __name__ == "__main__":
    main()
