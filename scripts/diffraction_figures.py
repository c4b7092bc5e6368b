#!/usr/bin/env python3
"""Draws the figures of docs/diffraction.md: impulse responses, and the f-number from which diffraction dominates.

    diffraction_figures.py BUILD OUT

BUILD is a build folder (build/release). diffraction_responses.png and diffraction_crossover.svg and .png are written to
OUT. The impulse responses are those of a lens of 50 mm f/4 at 550 nm, focused at 1 m. The values of each impulse
response are divided by its largest value, and their square root is drawn. Needs oiiotool (Debian: openimageio-tools)
and gnuplot (gnuplot-nox).
"""

import argparse
import json
import math
import os
import subprocess
import sys

FOCAL_MM, STOP, FOCUS_M, WAVE_NM, SIZE = 50.0, 4.0, 1.0, 550.0, 241
# Values of the defocus u (docs/diffraction.md) at which the impulse response is drawn. The intensity on the axis is 0
# at u = 4 pi, 8 pi, and so on. It has maxima near 6 pi, 10 pi, and so on.
US = [0.0, 2 * math.pi, 4 * math.pi, 6 * math.pi, 8 * math.pi, 50.0, 100.0, 400.0]

PLOT = """
set terminal {terminal}
set output '{output}'
set datafile separator ','
set logscale xy
set xrange [0.7:64]
set yrange [0.5:2000]
set xtics (1,1.4,2,2.8,4,5.6,8,11,16,22,32,45,64)
set xlabel 'f-number'
set ylabel 'diameter on the film, um'
set key top right
set grid xtics ytics linecolor rgb '#dddddd'
plot '{near}' using 1:3 skip 1 with lines linewidth 2 linecolor rgb '#56b4e9' title 'circle of confusion, depth 1.05 m', \\
     '{far}' using 1:3 skip 1 with lines linewidth 2 linecolor rgb '#0072b2' title 'circle of confusion, depth 2 m', \\
     '{near}' using 1:2 skip 1 with lines linewidth 3 linecolor rgb '#e69f00' title 'Airy disc to its first zero, 550 nm', \\
     '{near}' using 1:4 skip 1 with lines dashtype 2 linecolor rgb 'black' title 'pixel of 5 um'
"""


def run(*arguments):
    result = subprocess.run([str(a) for a in arguments], stdout=subprocess.PIPE, check=False)
    if result.returncode != 0:
        sys.exit(f"diffraction_figures.py: failed with {result.returncode}: {' '.join(map(str, arguments))}")
    return result.stdout


def response(postlens, out, u):
    """Draws the impulse response for a defocus of u as a grey PNG."""
    diameter_m = FOCAL_MM / STOP / 1000
    wave_m = WAVE_NM * 1e-9
    film_mm = FOCAL_MM / (1 - FOCAL_MM / 1000 / FOCUS_M)
    depth_m = 1 / (1 / FOCUS_M - u / (math.pi * diameter_m ** 2 / (2 * wave_m)))
    half_v = 1.3 * max(u, 14)
    pitch_um = half_v / (SIZE / 2) * wave_m * film_mm * 1e3 / (math.pi * diameter_m)
    exr = os.path.join(out, f"u{u:.1f}.exr")
    told = json.loads(run(postlens, "lens", "psf", exr, "--focal-length", FOCAL_MM, "--f-number", STOP, "--focus", FOCUS_M,
                          "--depth", f"{depth_m:.12g}", "--wavelength", WAVE_NM, "--pixel-pitch", f"{pitch_um:.9g}",
                          "--size", SIZE, "--impulse", "diffraction", "--json"))
    if abs(told["u"] - u) > 1e-6:
        sys.exit(f"diffraction_figures.py: asked for u = {u}, got {told['u']}")
    png = exr[:-4] + ".png"
    run("oiiotool", exr, "--mulc", 1 / told["peak"], "--powc", 0.5, "--ch", "Y,Y,Y", "--chnames", "R,G,B", "--clamp:min=0:max=1",
        "--attrib", "oiio:ColorSpace", "sRGB", "-d", "uint8", "-o", png)
    os.remove(exr)
    return png


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build")
    parser.add_argument("out")
    options = parser.parse_args()
    postlens = os.path.join(options.build, "apps", "postlens")
    os.makedirs(options.out, exist_ok=True)

    panels = [response(postlens, options.out, u) for u in US]
    run("oiiotool", *panels, "--mosaic:pad=6", f"{len(US) // 2}x2", "-o", os.path.join(options.out, "diffraction_responses.png"))
    tables = {}
    for name, depth_m in [("near", 1.05), ("far", 2)]:
        tables[name] = os.path.join(options.out, f"crossover_{name}.csv")
        print(run(postlens, "lens", "psf", "--crossover", "--focal-length", FOCAL_MM, "--focus", FOCUS_M, "--depth", depth_m,
                  "--wavelength", WAVE_NM, "--pixel-pitch", 5, "--profile", tables[name]).decode(), end="")
    for terminal, ending in [("svg size 760,480 font 'sans,13'", "svg"), ("pngcairo size 760,480 font 'sans,11'", "png")]:
        output = os.path.join(options.out, f"diffraction_crossover.{ending}")
        subprocess.run(["gnuplot"], input=PLOT.format(terminal=terminal, output=output, **tables).encode(), check=True)
    for path in [*panels, *tables.values()]:
        os.remove(path)


if __name__ == "__main__":
    main()
