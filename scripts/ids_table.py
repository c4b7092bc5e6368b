#!/usr/bin/python3
"""Measures how much ids in another program's image reduce the error: the table of docs/inputs.md.

    ids_table.py BUILD OUT [--spp N]

BUILD is a build folder (build/release). Each scene is traced through a pinhole, and bench/foreign_export.cpp writes it
as another program would. The depth of a pixel is either the mean over the pixel, or the depth of the surface that fills
most of the pixel. The image has no ids, one id per pixel, or a Cryptomatte. Each image is focused by the methods
`layers` and `scatter` and compared to a reference of distributed rays through the lens. The reference has two
independent halves of N samples per pixel each, whose noise is subtracted from the errors. The table ids.md and the flat
images are written to OUT.
"""

import argparse
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(HERE, "..", "samples", "scenes")
# Each case has a scene, a size in px, an f-number, a focus distance in m, and a name in the table.
CASES = [
    ("bars", (480, 270), 1.4, 5, "bars, 480x270, f/1.4 at 5 m"),
    ("still_life", (480, 300), 1.8, 0.8, "still life, 480x300, f/1.8 at 0.8 m"),
    ("still_life", (480, 300), 1.8, 1.5, "the same at 1.5 m"),
]
DEPTHS = ("most", "mean")
IDS = ("none", "id", "cryptomatte")
METHODS = ("layers", "scatter")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build")
    parser.add_argument("out")
    parser.add_argument("--spp", type=int, default=256, help="of each half of the reference")
    o = parser.parse_args()
    os.makedirs(o.out, exist_ok=True)
    sys.path.insert(0, os.path.join(o.build, "python"))
    import postlens

    export = os.path.join(o.build, "bench", "foreign_export")
    if not os.access(export, os.X_OK):
        sys.exit(f"ids_table.py: {export} is missing; build the target foreign_export")

    lines = ["| scene | method | no ids | one id a pixel | Cryptomatte | mean depth: no ids | one id | Cryptomatte |",
             "|---|---|---|---|---|---|---|---|"]
    least_noise_db = float("inf")
    for scene, size, f_number, focus_m, name in CASES:
        def out(suffix, at=f"{scene}.{focus_m}m."):
            return os.path.join(o.out, at + suffix)

        file = os.path.join(SCENES, scene + ".toml")
        lens = {"f_number": f_number, "focus_m": focus_m}
        frame = postlens.trace(file, output=out("frame.exr"), size=size)
        reference, noise = postlens.render(file, size=size, **lens, spp=2 * o.spp, halves=True, seed=1).halves
        for method in METHODS:
            cells = []
            for depth in DEPTHS:
                for ids in IDS:
                    flat = out(f"{depth}.{ids}.exr")
                    subprocess.run([export, frame.path, flat, depth, ids], check=True)
                    picture = postlens.open(flat).focus(**lens, method=method)
                    c = postlens.compare(picture, reference, noise=noise)
                    least_noise_db = min(least_noise_db, c["noise_psnr_db"])
                    cells.append(f"{c['psnr_above_noise_db']:.1f}")
            lines.append(f"| {name if method == METHODS[0] else ''} | {method} | {' | '.join(cells)} |")
    lines += ["", f"The references are good to {least_noise_db:.1f} dB or better."]
    with open(os.path.join(o.out, "ids.md"), "w", encoding="utf-8") as f:
        f.write("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
