"""Scenes and images for the tests of the add-on. Runs inside Blender."""

import json
import os
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, "..", "..")
sys.path[:0] = [os.path.join(ROOT, "blender"), os.path.join(ROOT, "scripts", "peers")]

import bmesh  # noqa: E402
import bpy  # noqa: E402
from mathutils import Matrix  # noqa: E402
import toml_to_blender  # noqa: E402

BARS = os.path.join(ROOT, "samples", "scenes", "bars.toml")


def words():
    """The words that follow -- on Blender's command line."""
    return sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []


def bars(size, spp, f_number=1.4, focus_m=5, seed=0):
    """Builds a Cycles scene of thin bars in front of a wall, seen through a wide lens, and registers the add-on."""
    import postlens_addon

    if hasattr(bpy.types.Scene, "postlens"):
        postlens_addon.unregister()
    asked = [BARS, "unused.exr", "--size", size, "--spp", str(spp), "--seed", str(seed)]
    asked += ["--f-number", str(f_number), "--focus", str(focus_m)]
    scene, _ = toml_to_blender.prepare(toml_to_blender.parse(asked))
    postlens_addon.register()
    return scene


def glowing(name, colour):
    """A material that only emits, for Cycles and for glTF alike."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    inputs = material.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value, inputs["Emission"].default_value = (0, 0, 0, 1), (*colour, 1)
    inputs["Specular"].default_value, inputs["Roughness"].default_value = 0, 1
    return material


def box(scene, name, location, size, colour):
    """Adds a glowing box."""
    mesh = bpy.data.meshes.new(name)
    made = bmesh.new()
    bmesh.ops.create_cube(made, size=1, matrix=Matrix.Diagonal((*size, 1)))
    made.to_mesh(mesh)
    made.free()
    mesh.materials.append(glowing(name, colour))
    out = bpy.data.objects.new(name, mesh)
    out.location = location
    scene.collection.objects.link(out)
    return out


def boxes(size, spp, f_number=1):
    """Builds a scene of posts at 1.5 m, a box in focus at 5 m and a wall, with modifiable objects."""
    scene = bars(size, spp, f_number)
    for thing in [o for o in scene.objects if o.type == "MESH"]:
        bpy.data.objects.remove(thing)
    scene.camera.matrix_world = Matrix()
    for i in range(5):
        box(scene, f"post {i}", (-0.8 + 0.4 * i, 0, -1.5), (0.08, 2, 0.05), (1 - 0.2 * i, 0.2 * i, 0.5))
    box(scene, "box", (0.3, -0.2, -5), (0.8, 0.8, 0.3), (0.9, 0.1, 0.1))
    box(scene, "wall", (0, 0, -15), (60, 60, 0.1), (0.2, 0.4, 0.6))
    return scene


def by_cycles(scene, path, spp, seed):
    """Renders the reference: the same camera with Cycles' own depth of field."""
    scene.cycles.samples, scene.cycles.seed = spp, seed
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
    return path


class Program:
    """Runs the postlens program."""

    def __init__(self, path):
        self.path = os.path.abspath(path)

    def __call__(self, *arguments):
        done = subprocess.run([self.path, *arguments, "--json"], capture_output=True, text=True)
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        return json.loads(done.stdout)

    def psnr_db(self, picture, halves):
        """PSNR of an image without the noise of the reference, which is measured from its two independent halves."""
        said = self("compare", picture, halves[0], "--noise", halves[1])
        return said["psnr_above_noise_db"], said["noise_psnr_db"]


def folder():
    return tempfile.TemporaryDirectory(prefix="postlens_blender_")
