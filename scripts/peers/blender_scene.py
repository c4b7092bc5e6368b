"""Builds a scene as a user of Blender would, exports it as glTF and renders it with Cycles.

    blender -b --factory-startup -P blender_scene.py -- [--scene still|glass] [--export OUT.glb] [--render OUT.exr ...]

Runs inside Blender 3.4. Materials, lights and the exporter keep Blender's default settings except where a table below
names a value.

still   `samples/scenes/blender_still.glb`: rough plastics, a metal, a glass ball with a volume, a sun, a point light, a
        cube that turns during 24 frames, and depths from 1.6 m to 14 m
glass   a glass ball of index 1.5 with a volume, in front of plastic objects

glTF contains neither the light of the world nor the size of a light source. Therefore --render makes the world black
and all light sources points. --world and --soft-lights keep the world's light and the sizes. --render computes direct
light, and up to --bounces reflections and refractions by mirrors and glass. It computes no light between diffuse
surfaces.
"""

import argparse
import math
import os
import sys

import bpy
from mathutils import Vector

FRAMES = 24
PLASTICS = {
    "Plastic": (0.8, 0.8, 0.8),
    "Red": (0.8, 0.07, 0.04),
    "Blue": (0.05, 0.18, 0.8),
    "Green": (0.09, 0.5, 0.1),
    "Yellow": (0.8, 0.5, 0.05),
}


def principled(name, base_colour, **inputs):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    node = material.node_tree.nodes["Principled BSDF"]
    node.inputs["Base Color"].default_value = (*base_colour, 1)
    for key, value in inputs.items():
        node.inputs[key].default_value = value
    return material


def glass(thickness_m):
    """Returns clear glass of index 1.5. The exporter reads the thickness of KHR_materials_volume from a node group
    named "glTF Material Output", which has no effect in Cycles."""
    material = principled("Glass", (1, 1, 1), Transmission=1, Roughness=0, IOR=1.5)
    group = bpy.data.node_groups.new("glTF Material Output", "ShaderNodeTree")
    group.inputs.new("NodeSocketFloat", "Thickness")
    node = material.node_tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    node.inputs["Thickness"].default_value = thickness_m
    return material


def place(name, material, smooth=True):
    """Names the object that an operator of bpy.ops.mesh has just added, and assigns a material to it."""
    added = bpy.context.object
    added.name = added.data.name = name
    added.data.materials.append(material)
    if smooth:
        bpy.ops.object.shade_smooth()
    return added


def duplicate(original, location):
    """Makes a second object that shares the mesh, as Alt+D does in Blender."""
    copy = original.copy()
    copy.location = location
    bpy.context.collection.objects.link(copy)


def light(kind, name, energy, location, rotation_degrees=(0, 0, 0)):
    """Adds a light. Its energy is in W for a point or spot light, and in W/m^2 for a sun."""
    rotation = [math.radians(x) for x in rotation_degrees]
    bpy.ops.object.light_add(type=kind, location=location, rotation=rotation)
    added = bpy.context.object
    added.name = added.data.name = name
    added.data.energy = energy
    return added


def camera(location, target, focal_length_mm=50):
    bpy.ops.object.camera_add(location=location)
    added = bpy.context.object
    added.data.lens = focal_length_mm
    direction = Vector(target) - Vector(location)
    added.rotation_euler = direction.to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.camera = added
    return added


def plastics():
    return {name: principled(name, colour) for name, colour in PLASTICS.items()}


def build_still():
    """Builds the scene. Returns the distance of Suzanne's eyes along the camera's axis, in m, for the focus."""
    plastic, mesh = plastics(), bpy.ops.mesh
    mesh.primitive_plane_add(size=60, location=(0, 10, 0))
    place("Floor", plastic["Plastic"], smooth=False)

    mesh.primitive_monkey_add(size=0.75, location=(0.1, 3.05, 0.36), rotation=(math.radians(-14), 0, math.radians(12)))
    place("Suzanne", plastic["Yellow"])
    bpy.context.object.modifiers.new("Subdivision", "SUBSURF")  # one level, Blender's default
    mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.3, location=(-0.62, 2.75, 0.3))
    place("Glass ball", glass(0.6))
    metal = principled("Metal", (0.9, 0.62, 0.35), Metallic=1, Roughness=0.25)
    mesh.primitive_torus_add(major_radius=0.26, minor_radius=0.1, location=(0.82, 3.5, 0.36), rotation=(1.35, 0.1, -0.5))
    place("Metal ring", metal)

    mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=0.17, location=(0.45, 1.85, 0.17))
    duplicate(place("Near ball", plastic["Blue"]), (-0.19, 1.6, 0.17))

    mesh.primitive_cube_add(size=0.75, location=(-1.45, 6, 0.72))
    cube = place("Turning cube", plastic["Red"])
    bevel = cube.modifiers.new("Bevel", "BEVEL")
    bevel.width, bevel.segments = 0.1, 3
    for frame, turn_degrees in ((1, 0), (FRAMES, 90)):
        cube.rotation_euler = (0.5, 0.3, math.radians(turn_degrees))
        cube.keyframe_insert("rotation_euler", frame=frame)
    mesh.primitive_cone_add(vertices=48, radius1=0.55, depth=1.35, location=(1.3, 7.5, 0.675))
    place("Cone", plastic["Green"]).data.use_auto_smooth = True
    mesh.primitive_cylinder_add(vertices=48, radius=0.45, depth=1.6, location=(-0.2, 9.5, 0.8))
    place("Column", plastic["Blue"]).data.use_auto_smooth = True
    mesh.primitive_uv_sphere_add(segments=32, ring_count=16, location=(-3.3, 12.5, 1))
    duplicate(place("Far ball", plastic["Green"]), (3.3, 14, 1))

    light("SUN", "Sun", 1.5, (3, -2, 6), (50, 10, 35))
    light("POINT", "Point", 1000, (-2.5, 4, 5)).data.shadow_soft_size = 0.1
    camera((0, 0, 0.75), (0, 3.05, 0.45))
    return axial_distance_m(bpy.data.objects["Suzanne"].location + Vector((0, -0.22, 0.05)))


def build_glass():
    plastic, mesh = plastics(), bpy.ops.mesh
    mesh.primitive_plane_add(size=60, location=(0, 10, 0))
    place("Floor", plastic["Plastic"], smooth=False)
    mesh.primitive_ico_sphere_add(subdivisions=6, radius=0.5, location=(0, 3, 0.5))
    place("Glass ball", glass(1))
    names = list(PLASTICS)
    for row in range(3):
        for column in range(5):
            location = (-1.4 + 0.7 * column, 3.9 + 1.1 * row, 0.25)
            mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=0.25, location=location)
            place("Ball", plastic[names[(2 * row + column) % len(names)]])
    light("SUN", "Sun", 2, (3, -2, 6), (50, 10, 35))
    light("POINT", "Point", 1000, (-2.5, 4.5, 4.5)).data.shadow_soft_size = 0.1
    camera((0, 0, 1), (0, 3, 0.5))
    return axial_distance_m(Vector((0, 3, 0.5)))


def axial_distance_m(point):
    bpy.context.view_layer.update()
    return -(bpy.context.scene.camera.matrix_world.inverted() @ point).z


def export(path):
    """Exports with default settings, and with cameras, punctual lights and applied modifiers."""
    path = os.path.abspath(path)
    bpy.ops.export_scene.gltf(filepath=path, export_cameras=True, export_lights=True, export_apply=True)


def cycles_settings(scene, arguments):
    """Sets a box pixel filter and scene-linear output, and turns off effects such as denoising."""
    cycles, render = scene.cycles, scene.render
    render.engine = "CYCLES"
    cycles.device, cycles.samples, cycles.seed = "CPU", arguments.spp, arguments.seed
    cycles.sampling_pattern = "SOBOL"
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
    cycles.max_bounces = cycles.glossy_bounces = cycles.transmission_bounces = arguments.bounces
    cycles.diffuse_bounces = cycles.volume_bounces = 0
    cycles.film_exposure = 1
    render.use_compositing = render.use_sequencer = False
    render.threads_mode, render.threads = ("FIXED", arguments.threads) if arguments.threads else ("AUTO", 1)
    render.resolution_x, render.resolution_y = arguments.size
    image = render.image_settings
    image.file_format, image.color_mode, image.color_depth, image.exr_codec = "OPEN_EXR", "RGB", "32", "ZIP"


def render(path, arguments, focus_m):
    scene = bpy.context.scene
    cycles_settings(scene, arguments)
    if not arguments.world:
        scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0
    for source in () if arguments.soft_lights else bpy.data.lights:
        if source.type == "SUN":
            source.angle = 0
        else:
            source.shadow_soft_size = 0
    lens = scene.camera.data.dof
    lens.use_dof = math.isfinite(arguments.f_number)
    if lens.use_dof:
        lens.aperture_fstop, lens.focus_distance = arguments.f_number, arguments.focus or focus_m
    scene.frame_set(arguments.frame)
    scene.render.filepath = os.path.abspath(path)
    bpy.ops.render.render(write_still=True)


def size(text):
    width, height = text.split("x")
    return int(width), int(height)


def parse(words):
    parser = argparse.ArgumentParser(prog="blender_scene.py")
    parser.add_argument("--scene", choices=("still", "glass"), default="still")
    parser.add_argument("--export", metavar="OUT.glb")
    parser.add_argument("--render", metavar="OUT.exr")
    parser.add_argument("--f-number", type=float, default=math.inf, metavar="N|inf")
    parser.add_argument("--focus", type=float, metavar="M", help="default: the object that the scene is about")
    parser.add_argument("--frame", type=int, default=1, help=f"1 to {FRAMES} (default: 1)")
    parser.add_argument("--size", type=size, default=(960, 540), metavar="WxH")
    parser.add_argument("--spp", type=int, default=512)
    parser.add_argument("--bounces", type=int, default=4, help="as postlens' --max-depth less 1 (default: 4)")
    parser.add_argument("--world", action="store_true", help="keep the world's light")
    parser.add_argument("--soft-lights", action="store_true", help="keep the sizes of light sources")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, default=0)
    return parser.parse_args(words)


def main(arguments):
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, FRAMES
    scene.render.resolution_x, scene.render.resolution_y = arguments.size
    focus_m = {"still": build_still, "glass": build_glass}[arguments.scene]()
    print(f"blender_scene: focus {focus_m:.4f} m")
    if arguments.export:
        export(arguments.export)
    if arguments.render:
        render(arguments.render, arguments, focus_m)


if __name__ == "__main__":
    main(parse(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []))
