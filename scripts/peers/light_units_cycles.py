#!/usr/bin/env python3
"""Tests the light units of Blender's glTF exporter: Cycles and postlens render a floor under each kind of light.

    light_units_cycles.py BUILD [--lumens-per-watt X] [--out DIR]

Blender builds the floor, exports it in the exporter's default lighting mode and renders it with Cycles. Cycles computes
only direct light, from light sources without extent. postlens traces the exported file. Both images contain the
radiance of the floor. The script reports the ratio of the radiance in postlens to that in Cycles, over all pixels; for
the spot, over the pixels inside its inner cone.

In glTF a spot has the same radiant intensity in all directions of its inner cone. In Cycles 3.4 the intensity is also
proportional to the cosine of the angle to the spot's axis. Before the comparison, the image of Cycles is divided by
this cosine. Blender comes from Debian: apt-get install --no-install-recommends blender python3-numpy
"""

import argparse
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ALBEDO = 0.8
HEIGHT_M = 3  # height of the point light and the spot above the floor
FIELD_M = 4  # side of the square of floor that the image shows
FILM_MM = 36
SIZE_PX = 64
# The lights that are compared. For each kind of light, the first number is its power, in W, or in W/m^2 for the sun.
# The second number is its rotation about the x axis, in degrees. Oblique light tests the cosine of the angle of
# incidence.
LIGHTS = {"SUN": (2, 30), "POINT": (1000, 0), "SPOT": (1000, 20)}
LIMIT = 0.01  # greatest deviation of a ratio from 1
TIMEOUT_S = 600


def fail(text):
    sys.exit(f"light_units_cycles.py: {text}")


# --- inside Blender


def build(kind):
    """Builds a floor, a light and a camera. The camera is 2 FIELD_M high and sees FIELD_M x FIELD_M of the floor."""
    import blender_scene
    import bpy

    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    bpy.ops.mesh.primitive_plane_add(size=2 * FIELD_M)
    # The floor reflects only diffusely, because only diffuse reflection is compared.
    blender_scene.place("Floor", blender_scene.principled("Floor", [ALBEDO] * 3, Specular=0, Roughness=1), smooth=False)
    energy, turn_degrees = LIGHTS[kind]
    source = blender_scene.light(kind, "Light", energy, (0.3, -0.4, HEIGHT_M), (turn_degrees, 0, 0))
    blender_scene.camera((0, 0, 2 * FIELD_M), (0, 0, 0), focal_length_mm=2 * FILM_MM)
    return source


def cycles_cosines(source):
    """Returns, for each pixel in rows from the top, the factor by which the intensity in Cycles differs from glTF. The
    factor is 0 for pixels that are excluded. These lie outside the spot's inner cone (as the exporter writes it) or
    within two pixels of its edge.
    """
    from mathutils import Vector

    if source.data.type != "SPOT":
        return [1] * (SIZE_PX * SIZE_PX)
    pixel_m = FIELD_M / SIZE_PX
    inner = source.data.spot_size / 2 * (1 - source.data.spot_blend) - 2 * pixel_m / HEIGHT_M
    axis = source.matrix_world.to_3x3() @ Vector((0, 0, -1))
    edges_m = [(i + 0.5) * pixel_m - FIELD_M / 2 for i in range(SIZE_PX)]
    points = [Vector((x, y, 0)) for y in reversed(edges_m) for x in edges_m]
    angles = [(point - source.matrix_world.translation).angle(axis) for point in points]
    return [math.cos(angle) if angle < inner else 0 for angle in angles]


def inside(folder):
    sys.path.insert(0, HERE)
    import blender_scene
    import bpy

    cosines = {}
    for kind in LIGHTS:
        source = build(kind)
        arguments = blender_scene.parse(["--spp", "64", "--bounces", "0", "--size", f"{SIZE_PX}x{SIZE_PX}"])
        bpy.context.scene.render.resolution_x = bpy.context.scene.render.resolution_y = SIZE_PX
        bpy.context.view_layer.update()
        blender_scene.export(os.path.join(folder, kind + ".glb"))
        cosines[kind] = cycles_cosines(source)
        # Under oblique light, Blender's Principled BSDF deviates from Lambert's law, but its Diffuse BSDF does not.
        floor = bpy.data.objects["Floor"].active_material.node_tree
        diffuse = floor.nodes.new("ShaderNodeBsdfDiffuse")
        diffuse.inputs["Color"].default_value = (ALBEDO, ALBEDO, ALBEDO, 1)
        floor.links.new(diffuse.outputs[0], floor.nodes["Material Output"].inputs["Surface"])
        blender_scene.render(os.path.join(folder, kind + ".cycles.exr"), arguments, 1)
    with open(os.path.join(folder, "cosines.json"), "w", encoding="utf-8") as file:
        json.dump(cosines, file)


def ratios(folder):
    """Returns the image of postlens divided by that of Cycles, for the pixels that are not excluded."""
    sys.path.insert(0, HERE)
    import compare_halves
    import numpy

    with open(os.path.join(folder, "cosines.json"), encoding="utf-8") as file:
        cosines = json.load(file)
    result = {}
    for kind in LIGHTS:
        cosine = numpy.array(cosines[kind]).reshape(SIZE_PX, SIZE_PX)
        counted = cosine > 0
        theirs = compare_halves.load(os.path.join(folder, kind + ".cycles.exr")).mean(2)[counted] / cosine[counted]
        ours = compare_halves.load(os.path.join(folder, kind + ".postlens.exr")).mean(2)[counted]
        ratio = ours / theirs
        result[kind] = {
            "ratio": float(ours.sum() / theirs.sum()),
            "least": float(ratio.min()),
            "most": float(ratio.max()),
            "pixels": int(counted.sum()),
            "cycles": [float(theirs.min()), float(theirs.max())],
        }
    with open(os.path.join(folder, "ratios.json"), "w", encoding="utf-8") as file:
        json.dump(result, file, indent=2)


# --- outside


def run(command, environment=None):
    done = subprocess.run(["timeout", str(TIMEOUT_S), *command], capture_output=True, text=True, env=environment)
    if done.returncode != 0:
        fail(f"{os.path.basename(command[0])} failed: {(done.stderr.splitlines() or ['it said nothing'])[-1]}")


def blender(step, folder):
    # Blender's Python loads its standard library from the first python3 in PATH. Only Debian's python3, in /usr/bin,
    # has the module numpy, which is needed here. Therefore, /usr/bin is put first in PATH.
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    environment["PATH"] = "/usr/bin:" + os.environ["PATH"]
    quiet = ["-b", "--factory-startup", "-noaudio", "--python-exit-code", "1"]
    run(["blender", *quiet, "-P", os.path.abspath(__file__), "--", step, folder], environment)


def exported(path):
    """Returns the first light of a .glb file, as a JSON object."""
    with open(path, "rb") as file:
        data = file.read()
    length = int.from_bytes(data[12:16], "little")
    return json.loads(data[20 : 20 + length])["extensions"]["KHR_lights_punctual"]["lights"][0]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", metavar="BUILD", help="build folder with apps/postlens, a release build")
    parser.add_argument("--lumens-per-watt", metavar="X", help="for postlens (default: its own)")
    parser.add_argument("--out", metavar="DIR", help="keep scenes, images and ratios.json here")
    arguments = parser.parse_args()
    program = os.path.join(arguments.build, "apps", "postlens")
    if not os.access(program, os.X_OK):
        fail(f"{program} is missing; build the target postlens")
    if shutil.which("blender") is None:
        fail("blender is missing; install it with: apt-get install --no-install-recommends blender python3-numpy")
    units = ["--lumens-per-watt", arguments.lumens_per_watt] if arguments.lumens_per_watt else []
    with tempfile.TemporaryDirectory() as scratch:
        folder = os.path.abspath(arguments.out or scratch)
        os.makedirs(folder, exist_ok=True)
        blender("--inside", folder)
        stems = {kind: os.path.join(folder, kind) for kind in LIGHTS}
        for stem in stems.values():
            run([program, "trace", stem + ".glb", "-o", stem + ".samples.exr", "--size", f"{SIZE_PX}x{SIZE_PX}", *units])
            run([program, "image", stem + ".samples.exr", "-o", stem + ".postlens.exr"])
        blender("--ratios", folder)
        with open(os.path.join(folder, "ratios.json"), encoding="utf-8") as file:
            results = json.load(file)
        print(f"{'light':6} {'strength':>9} {'in the file':>12} {'Cycles':>15} {'pixels':>7} {'ratio':>10} {'least':>10} {'most':>10}")
        for kind, found in results.items():
            strength, intensity = LIGHTS[kind][0], exported(stems[kind] + ".glb")["intensity"]
            radiance = "{:.4f}-{:.4f}".format(*found["cycles"])
            print(f"{kind:6} {strength:9g} {intensity:12.4f} {radiance:>15} {found['pixels']:7}"
                  f" {found['ratio']:10.5f} {found['least']:10.5f} {found['most']:10.5f}")
    wrong = [kind for kind, r in results.items() if not max(abs(r["least"] - 1), abs(r["most"] - 1)) <= LIMIT]
    if wrong:
        fail(f"postlens deviates from Cycles by more than {LIMIT:.0%}: {', '.join(wrong)}")


if __name__ == "__main__":
    if "--" in sys.argv and "bpy" in sys.modules:
        step, where = sys.argv[sys.argv.index("--") + 1 :]
        {"--inside": inside, "--ratios": ratios}[step](where)
    else:
        main()
