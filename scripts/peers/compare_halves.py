"""Compares the images that two renderers make of one scene, and separates their bias from the noise of both.

    blender -b --factory-startup -P compare_halves.py -- OUT.json --ours A B [A B ...] --theirs A B [A B ...]
        [--map PNG]

Runs inside Blender, to use its image reader and its numpy. Each renderer makes independent images, which are assigned
alternately to its first and second half. For one renderer, P1 and P2 are the means of the halves, and P is the mean of
all images. For the other renderer, these are C1, C2 and C. The results are averages over pixels and channels:

    mean squared difference   (P - C)^2
    noise floor               (P1 - P2)^2 / 4 and (C1 - C2)^2 / 4: the variances of P and C
    squared bias              P1 P2 + C1 C2 - 2 P C, which is the squared difference less both noise floors

The halves are independent, so the expectation of the squared bias is (E P - E C)^2, without noise. The estimate may be
negative. Its standard error is computed from the means of blocks of BLOCK_PX.

The results are computed in scene-linear colour, and again after every image is clamped to 0 to 1 and sRGB-encoded. The
encoding is nonlinear, so noise changes the mean of the encoded values. If one renderer is noisier than the other, the
comparison therefore shows a bias.
"""

import argparse
import json
import math
import sys

import bpy
import numpy

BLOCK_PX = 20  # wider than most circles of confusion, so that the errors of blocks are nearly independent


def load(path):
    """Reads an image as an array with three channels, top row first. The values are those of the file."""
    image = bpy.data.images.load(path)
    image.colorspace_settings.name, image.alpha_mode = "Non-Color", "NONE"
    width, height = image.size
    pixels = numpy.empty(width * height * 4, numpy.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)[::-1, :, :3].astype(float)


def halves(paths):
    return [sum(load(path) for path in paths[i::2]) / len(paths[i::2]) for i in (0, 1)]


def encode(linear):
    clamped = numpy.clip(linear, 0, 1)
    return numpy.where(clamped <= 0.0031308, 12.92 * clamped, 1.055 * clamped ** (1 / 2.4) - 0.055)


def db(mean_square):
    return -10 * math.log10(mean_square) if mean_square > 0 else math.inf


def mean_and_error(values):
    """Returns the mean over the image, and its standard error, which is computed from the means of blocks."""
    rows, columns = (n // BLOCK_PX for n in values.shape[:2])
    blocks = values[: rows * BLOCK_PX, : columns * BLOCK_PX].mean(2)
    blocks = blocks.reshape(rows, BLOCK_PX, columns, BLOCK_PX).mean((1, 3))
    return float(values.mean()), float(blocks.std(ddof=1) / math.sqrt(blocks.size))


def compare(ours, theirs):
    p, c = sum(ours) / 2, sum(theirs) / 2
    bias, error = mean_and_error(ours[0] * ours[1] + theirs[0] * theirs[1] - 2 * p * c)
    difference, difference_error = mean_and_error(p - c)
    mse = float(((p - c) ** 2).mean())
    floors = [float(((h[0] - h[1]) ** 2).mean()) / 4 for h in (ours, theirs)]
    return {
        "psnr_db": db(mse),
        "noise_psnr_db": db(sum(floors)),
        "ours_noise_psnr_db": db(floors[0]),
        "theirs_noise_psnr_db": db(floors[1]),
        "squared_bias": bias,
        "squared_bias_error": error,
        "bias_at_most_psnr_db": db(max(bias, 0) + 2 * error),
        "mean_difference": difference,
        "mean_difference_error": difference_error,
    }


def shift_px(ours, theirs):
    """Returns the displacement of the second image against the first, in px to the right and down. The displacement is
    a least-squares fit to the gradient of the mean."""
    a, b = (numpy.clip(sum(h) / 2, 0, 1).mean(2) for h in (ours, theirs))
    down, right = numpy.gradient((a + b) / 2)
    matrix = [[(right * right).sum(), (right * down).sum()], [(right * down).sum(), (down * down).sum()]]
    moved = numpy.linalg.solve(matrix, [(right * (a - b)).sum(), (down * (a - b)).sum()])
    return [float(x) for x in moved]


def write_map(path, ours, theirs):
    """Writes a map of eight times the difference between the encoded images. Grey means that they are equal."""
    shown = numpy.clip(0.5 + 8 * (encode(sum(ours) / 2) - encode(sum(theirs) / 2)), 0, 1)
    image = bpy.data.images.new("map", shown.shape[1], shown.shape[0], alpha=False)
    image.pixels.foreach_set(numpy.dstack([shown, numpy.ones(shown.shape[:2])])[::-1].astype(numpy.float32).ravel())
    image.filepath_raw, image.file_format = path, "PNG"
    image.save()


def main(words):
    parser = argparse.ArgumentParser(prog="compare_halves.py")
    parser.add_argument("out")
    parser.add_argument("--ours", nargs="+", required=True)
    parser.add_argument("--theirs", nargs="+", required=True)
    parser.add_argument("--map", metavar="PNG")
    arguments = parser.parse_args(words)
    for paths in (arguments.ours, arguments.theirs):
        if len(paths) % 2:
            sys.exit(f"compare_halves.py: pictures do not make two halves (got {len(paths)}; expected an even number)")
    ours, theirs = halves(arguments.ours), halves(arguments.theirs)
    if ours[0].shape != theirs[0].shape:
        sys.exit(f"compare_halves.py: sizes differ (got {ours[0].shape} and {theirs[0].shape})")
    result = {
        "linear": compare(ours, theirs),
        "encoded": compare([encode(x) for x in ours], [encode(x) for x in theirs]),
        "shift_px": shift_px(ours, theirs),
    }
    if arguments.map:
        write_map(arguments.map, ours, theirs)
    with open(arguments.out, "w", encoding="utf-8") as file:
        json.dump(result, file)


if __name__ == "__main__":
    main(sys.argv[sys.argv.index("--") + 1 :])
