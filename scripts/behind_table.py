#!/usr/bin/python3
"""Measures how much images behind an image reduce the error: the table of docs/compositing.md.

    behind_table.py BUILD OUT [--spp N]

BUILD is a build folder (build/release). A scene of bars is traced through a pinhole three times: complete, without the
near objects, and with only the wall. bench/foreign_export.cpp writes the images as another program would, with an
overscan, and with or without a Cryptomatte. The image of the complete scene is focused, with or without the other
images behind it, and compared to a reference of distributed rays through the lens. The reference has two independent
halves of N samples per pixel each, whose noise is subtracted from the errors. The table behind.md, the scenes and the
images are written to OUT.
"""

import argparse
import os
import re
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
BARS = os.path.join(HERE, "..", "samples", "scenes", "bars.toml")
NEAR = ["upright bar", "leaning bar", "level bar", "near ball", "near bead", "light at 1.2 m"]
MIDDLE = ["light at 3 m", "board", "ball", "light at 5 m", "light at 9 m"]
WIDTH, HEIGHT, OVERSCAN, FILM_MM = 640, 360, 24, 36
LENS = {"f_number": 1.4, "focus_m": 5}
METHODS = [("layers", {"method": "layers"})]
METHODS += [(f"light field, {n} views", {"method": "lightfield", "views": n}) for n in (64, 256, 1024)]
ROWS = [("cryptomatte", 1), ("cryptomatte", 2), ("cryptomatte", 3), ("none", 1), ("none", 2), ("none", 3)]


def without(scene, names):
    """Returns the text of the scene without the named objects."""
    parts = re.split(r"(?m)^(?=\[\[)", scene)
    kept = [p for p in parts if not (p.startswith("[[object]]") and re.search(r'name = "(.*)"', p)[1] in names)]
    return "".join(kept)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build")
    parser.add_argument("out")
    parser.add_argument("--spp", type=int, default=256, help="of each half of the reference")
    o = parser.parse_args()
    os.makedirs(o.out, exist_ok=True)
    sys.path.insert(0, os.path.join(o.build, "python"))
    import postlens

    with open(BARS, encoding="utf-8") as f:
        text = f.read()
    wide = (WIDTH + 2 * OVERSCAN, HEIGHT + 2 * OVERSCAN)
    for name, left_out in (("whole", []), ("middle", NEAR), ("wall", NEAR + MIDDLE)):
        scene = os.path.join(o.out, name + ".toml")
        with open(scene, "w", encoding="utf-8") as f:
            f.write(without(text, left_out))
        frame = postlens.trace(scene, output=os.path.join(o.out, name + ".records.exr"), size=wide,
                               film_width_mm=FILM_MM * wide[0] / WIDTH, film_distance_mm=50, subdivide=3)  # fmt: skip
        for ids in ("cryptomatte", "none"):
            subprocess.run([os.path.join(o.build, "bench", "foreign_export"), frame.path,
                            os.path.join(o.out, f"{name}.{ids}.exr"), "most", ids], check=True)  # fmt: skip
    reference, noise = postlens.render(BARS, size=(WIDTH, HEIGHT), **LENS, spp=2 * o.spp, halves=True, seed=1).halves
    lines = [f"| ids, pictures | {' | '.join(name for name, _ in METHODS)} |", "|---" * (1 + len(METHODS)) + "|"]
    for ids, count in ROWS:
        files = [os.path.join(o.out, f"{name}.{ids}.exr") for name in ("whole", "middle", "wall")][:count]
        cells = []
        for _, method in METHODS:
            picture = postlens.open(files[0]).focus(**LENS, **method, behind=files[1:] or None, overscan_px=OVERSCAN,
                                                    film_width_mm=FILM_MM, film_distance_mm=50)  # fmt: skip
            c = postlens.compare(picture, reference, noise=noise)
            cells.append(f"{c['psnr_above_noise_db']:.1f} dB, {picture.report['seconds']:.1f} s")
        lines.append(f"| {ids}, {count} | {' | '.join(cells)} |")
    with open(os.path.join(o.out, "behind.md"), "w", encoding="utf-8") as f:
        f.write("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
