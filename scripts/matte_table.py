#!/usr/bin/python3
"""Measures the error of a refocused Cryptomatte, object by object: the table of docs/compositing.md.

    matte_table.py BUILD OUT [--spp N] [--views N...]

BUILD is a build folder (build/release). A scene is traced through a pinhole three times: with all objects, without the
objects in front of the plane in focus, and with only its walls and floor. bench/foreign_export.cpp writes the images as
another program would, each with a Cryptomatte and an overscan. The first image is focused with the pass `cryptomatte`,
once alone and once with the other two images behind it. The true matte of an object is rendered with distributed rays
through the lens. In this rendering, the object emits a radiance of 1 and everything else is black. It consists of two
independent halves of N samples per pixel each, whose noise is subtracted from the errors. The first table states the
median and the lowest PSNR of the mattes of each scene. The second table states the PSNR of each matte over the frame
and, in parentheses, over the pixels that show a part of the object. mattes.md with the tables, the scenes and the
images are written to OUT.
"""

import argparse
import math
import os
import re
import statistics
import subprocess
import sys
import tomllib

import numpy as np
import random_scene

HERE = os.path.dirname(os.path.abspath(__file__))
BARS = os.path.join(HERE, "..", "samples", "scenes", "bars.toml")
SIZE, OVERSCAN, FILM_MM, FILM_DISTANCE_MM = (480, 270), 24, 36, 50
# The random scenes of this table, given by their seeds for random_scene.py. In the first scene, one object is in focus,
# and others are nearer and farther. The second scene has nine near objects and one far object.
SEEDS = (28, 35)
NOTHING = "(nothing)"  # name for the matte of the area that no object covers
PICTURES = ("whole", "far", "ground")


class Scene:
    """A scene of named objects."""

    def __init__(self, name, text, f_number, focus_m):
        self.name, self.lens = name, {"f_number": f_number, "focus_m": focus_m}
        self.parts = re.split(r"(?m)^(?=\[)", text)
        number = 0
        for i, part in enumerate(self.parts):
            if not part.startswith("[[object]]"):
                continue
            number += 1
            if "name" not in tomllib.loads(part)["object"][0]:
                shape = tomllib.loads(part)["object"][0]["shape"]
                self.parts[i] = part.replace("[[object]]\n", f'[[object]]\nname = "{shape} {number}"\n', 1)

    def objects(self):
        return [tomllib.loads(p)["object"][0] for p in self.parts if p.startswith("[[object]]")]

    def names(self):
        return [o["name"] for o in self.objects()]

    def kept(self, picture):
        """Returns the names of the objects that one of the pictures shows."""
        def depth_m(o):
            at = next((o[k] for k in ("centre_m", "translate_m", "base_m", "corner_m") if k in o), None)
            return -(at or o["repeat"]["at_m"][0])[2]

        out = []
        for o in self.objects():
            is_ground = o["shape"] == "plane" or o["name"] == "wall"
            far = is_ground or depth_m(o) >= 0.98 * self.lens["focus_m"]
            if picture == "whole" or is_ground or (picture == "far" and far):
                out.append(o["name"])
        return out

    def with_objects(self, names):
        def is_kept(p):
            return not p.startswith("[[object]]") or tomllib.loads(p)["object"][0]["name"] in names

        return "".join(p for p in self.parts if is_kept(p))

    def mattes(self, names):
        """Returns the scene in which the i-th of up to three objects emits 1 in channel i, and all else is black."""
        colours = {n: [1.0 if c == i else 0.0 for c in range(3)] for i, n in enumerate(names)}
        out = [f"[scene]\nambient_light = 0\nbackground = {colours.get(NOTHING, [0, 0, 0])}\n"]
        out += [p for p in self.parts if p.startswith("[[camera]]")]
        for name, colour in {"": [0, 0, 0], **colours}.items():
            out += [f'[[material]]\nname = "to {name}"\nambient = 0\ndiffuse = 0\nemission = {colour}\n']
        for p in self.parts:
            if p.startswith("[[object]]"):
                name = tomllib.loads(p)["object"][0]["name"]
                material = f'material = "to {name if name in colours else ""}"'
                out.append(re.sub(r'(?m)^material = ".*"$', material, p))
        return "".join(out)


def matte_id(name):
    """Returns the Cryptomatte id of a name, its MurmurHash3 (x86, 32 bits, seed 0). If these bits are not those of a
    normal float, one bit is changed."""
    data, h, mask = name.encode(), 0, 0xFFFFFFFF

    def mixed(k):
        k = k * 0xCC9E2D51 & mask
        return ((k << 15 | k >> 17) & mask) * 0x1B873593 & mask

    whole = len(data) // 4 * 4
    for i in range(0, whole, 4):
        h ^= mixed(int.from_bytes(data[i:i + 4], "little"))
        h = ((h << 13 | h >> 19) * 5 + 0xE6546B64) & mask
    h ^= mixed(int.from_bytes(data[whole:], "little")) ^ len(data)
    h = (h ^ h >> 16) * 0x85EBCA6B & mask
    h = (h ^ h >> 13) * 0xC2B2AE35 & mask
    h ^= h >> 16
    return h ^ 1 << 23 if (h >> 23 & 255) in (0, 255) else h


def coverages(picture, ids):
    """Returns, for each name, the coverage of all its ids in each pixel of a refocused picture."""
    out = {name: 0 for name in ids}
    for channel, values in picture.passes.items():
        if not re.fullmatch(r"CryptoObject\d\d\.[RB]", channel):
            continue
        share = picture.passes[channel[:-1] + {"R": "G", "B": "A"}[channel[-1]]]
        for name, of_name in ids.items():
            out[name] = out[name] + np.where(np.isin(values.view(np.uint32), of_name), share, 0)
    return out


def db(square):
    return -10 * math.log10(max(square, 1e-12))


class Error:
    """PSNR of a matte, in dB, against two independent halves of the true matte. It is computed over the frame, and over
    the pixels that show a part of the object."""

    def __init__(self, matte, halves):
        truth, noise = (halves[0] + halves[1]) / 2, (halves[0] - halves[1]) ** 2 / 4
        own = (truth > 0.001) | (matte > 0.001)
        square = (matte - truth) ** 2
        self.noise_db = db(np.mean(noise))
        self.db = db(np.mean(square) - np.mean(noise))
        self.own_db = db(np.mean(square[own]) - np.mean(noise[own])) if own.any() else math.inf


def traced(postlens, o, scene):
    """Writes the pictures as another program would. Returns the ids of each name."""
    export = os.path.join(o.build, "bench", "foreign_export")
    wide = tuple(n + 2 * OVERSCAN for n in SIZE)
    ids = {}
    for picture in PICTURES:
        def out(suffix, at=f"{scene.name}.{picture}."):
            return os.path.join(o.out, at + suffix)

        with open(out("toml"), "w", encoding="utf-8") as f:
            f.write(scene.with_objects(scene.kept(picture)))
        frame = postlens.trace(out("toml"), output=out("records.exr"), size=wide, subdivide=3,
                               film_width_mm=FILM_MM * wide[0] / SIZE[0], film_distance_mm=FILM_DISTANCE_MM)
        subprocess.run([export, frame.path, out("exr"), "most", "cryptomatte"], check=True)
        if picture == "whole":
            for name in scene.names():
                of_name = [n for n in frame.info["ids"].values() if n == name or n.startswith(name + "[")]
                ids[name] = [matte_id(n) for n in of_name]
    return {**ids, NOTHING: [0]}


def true_mattes(postlens, o, scene, names):
    """Returns, for each name, two independent halves of its matte."""
    out = {}
    for i in range(0, len(names), 3):
        three = names[i:i + 3]
        file = os.path.join(o.out, f"{scene.name}.mattes{i // 3}.toml")
        with open(file, "w", encoding="utf-8") as f:
            f.write(scene.mattes(three))
        halves = postlens.render(file, size=SIZE, **scene.lens, spp=2 * o.spp, halves=True, seed=1).halves
        for c, name in enumerate(three):
            out[name] = [np.asarray(h)[:, :, c] for h in halves]
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build")
    parser.add_argument("out")
    parser.add_argument("--spp", type=int, default=128, help="of each half of the true mattes")
    parser.add_argument("--views", type=int, nargs="+", default=[64, 256], help="views of the pass")
    o = parser.parse_args()
    os.makedirs(o.out, exist_ok=True)
    sys.path.insert(0, os.path.join(o.build, "python"))
    import postlens

    with open(BARS, encoding="utf-8") as f:
        scenes = [Scene("bars", f.read(), 1.4, 5)]
    for seed in SEEDS:
        made = random_scene.write(seed, ("plain",))
        scenes.append(Scene(f"random{seed}", made.text, made.f_number, made.focus_m))
    columns = [(count, views) for count in range(1, len(PICTURES) + 1) for views in o.views]
    behind = ("alone", "one behind", "two behind")
    heads = " | ".join(f"{behind[count - 1]}, {views} views" for count, views in columns)
    summary = [f"| scene | noise, highest | {heads} |", "|---" * (2 + len(columns)) + "|"]
    lines = ["", f"| scene | matte of | noise | {heads} |", "|---" * (3 + len(columns)) + "|"]
    for scene in scenes:
        ids = traced(postlens, o, scene)
        truth = true_mattes(postlens, o, scene, list(ids))
        errors = {name: [] for name in ids}
        for count, views in columns:
            files = [os.path.join(o.out, f"{scene.name}.{p}.exr") for p in PICTURES[:count]]
            picture = postlens.open(files[0]).focus(**scene.lens, method="layers", views=views, behind=files[1:] or None,
                                                    overscan_px=OVERSCAN, film_width_mm=FILM_MM, metres_per_unit=1,
                                                    film_distance_mm=FILM_DISTANCE_MM, z="axial", passes="cryptomatte")  # fmt: skip
            picture.save(os.path.join(o.out, f"{scene.name}.{count}.{views}.exr"))
            for name, matte in coverages(picture, ids).items():
                errors[name].append(Error(matte, truth[name]))
        if max(np.max(h) for h in truth[NOTHING]) == 0:
            del errors[NOTHING]
        for name, row in errors.items():
            cells = " | ".join(f"{e.db:.1f} ({e.own_db:.1f})" for e in row)
            lines.append(f"| {scene.name} | {name} | {row[0].noise_db:.1f} | {cells} |")
        cells = []
        for i in range(len(columns)):
            lowest = min(errors, key=lambda name, column=i: errors[name][column].db)
            cells.append(f"{statistics.median(row[i].db for row in errors.values()):.1f}; "
                         f"{errors[lowest][i].db:.1f} ({lowest})")
        noise_db = min(row[0].noise_db for row in errors.values())
        summary.append(f"| {scene.name} | {noise_db:.1f} | {' | '.join(cells)} |")
    lines = summary + lines
    with open(os.path.join(o.out, "mattes.md"), "w", encoding="utf-8") as f:
        f.write("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
