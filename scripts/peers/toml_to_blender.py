"""Renders a postlens scene with Cycles, as the same integral: thin lens, box shutter, box pixel, emission only.

    blender -b --factory-startup -P toml_to_blender.py -- SCENE.toml OUT.exr --spp N [OPTION...]

Runs inside Blender 3.4. Of the scene format (docs/scene_format.md), this program supports: perspective cameras without
keys; materials that only emit; "checker" textures; rectangles, boxes, spheres and cylinders, repeated or not, with keys
of translation and rotation. Any other content causes an error of one line; nothing is omitted silently.

Balls and cylinders become meshes whose outlines have an error of at most OUTLINE_PX. The exposure is mapped to the part
of one frame that Cycles' shutter covers (SHUTTER_COVERED). Between the poses of a moving object, Blender interpolates
translations linearly and rotations by slerp. The object has so many poses that the error of the interpolation is below
MOTION_PX. Blender's evaluation of each pose is checked against the formula of the scene.
"""

import argparse
import bisect
import json
import math
import os
import sys
import tomllib

import bmesh
import bpy
from mathutils import Euler, Matrix, Quaternion, Vector

OUTLINE_PX = 0.01  # a hundredth of the width of the box filter: the error is at most 1 % of an edge's contrast
MOTION_PX = 0.01
POSES_LOG2 = 7  # Cycles' limit: 2^7 intervals in the frame
# Fraction of a frame during which the shutter is really open in Cycles 3.4, if its shutter time is one frame. Cycles
# stores the shutter curve in 256 entries, but the shutter is open only for 254 of them.
SHUTTER_COVERED = 254 / 256
LARGEST_ICOSPHERE = 8  # 330,000 triangles

SCENE_KEYS = {"name", "background", "ambient_light", "time_s"}
CAMERA_KEYS = {
    "name", "projection", "position_m", "look_at_m", "look_along", "up", "film_width_mm", "focal_length_mm",
    "width_px", "height_px", "f_number", "focus_m", "exposure_s",
}  # fmt: skip
MATERIAL_ZEROS = {"diffuse": 0.8, "diffuse_transmission": 0, "specular": 0, "reflection": 0, "transmission": 0}
MATERIAL_KEYS = {"name", "colour", "ambient", "shininess", "ior", "emission", "emission_texture"} | set(MATERIAL_ZEROS)
TEXTURE_KEYS = {"name", "kind", "size_m", "offset_m", "even", "odd"}
PLACE_KEYS = {"translate_m", "rotate_degrees", "rotate_axis", "quaternion"}
OBJECT_KEYS = {"name", "shape", "material", "hidden", "casts_shadows", "scale", "keys", "repeat"} | PLACE_KEYS
SHAPE_KEYS = {
    "rectangle": {"corner_m", "edge_u_m", "edge_v_m"},
    "box": {"size_m", "centre_m", "min_m", "max_m"},
    "sphere": {"centre_m", "radius_m"},
    "cylinder": {"base_m", "apex_m", "radius_m", "capped"},
}


class SceneError(Exception):
    """The scene has content that this program cannot read or convert."""


def check_keys(what, table, known):
    for key in table:
        if key not in known:
            expected = ", ".join(sorted(known))
            raise SceneError(f"{what}: cannot be expressed here (got the key {key}; expected {expected})")


def needed(what, table, key):
    if key not in table:
        raise SceneError(f"{what}: a key is missing (expected {key})")
    return table[key]


def triple(value):
    """Returns three numbers, from a list of three or from a single number that is used three times."""
    return [float(x) for x in value] if isinstance(value, list) else [float(value)] * 3


def rotation(table):
    """The rotation of an object or a key."""
    if "quaternion" in table:
        return Quaternion(table["quaternion"]).normalized()
    degrees = table.get("rotate_degrees", 0)
    if isinstance(degrees, list):
        return Euler([math.radians(x) for x in degrees], "XYZ").to_quaternion()
    if degrees == 0:
        return Quaternion()
    return Quaternion(Vector(table["rotate_axis"]), math.radians(degrees))


class Motion:
    """The motion of one copy of an object: world(t) = key(t) * placement."""

    def __init__(self, what, table, shift):
        self.offset = Vector(table.get("translate_m", [0, 0, 0])) + shift
        self.turn = rotation(table)
        self.scale = Vector(triple(table.get("scale", 1)))
        self.times_s, self.keys = [], []
        for key in table.get("keys", []):
            check_keys(f"{what}, keys", key, PLACE_KEYS | {"time_s"})
            self.times_s.append(needed(f"{what}, keys", key, "time_s"))
            self.keys.append((Vector(key.get("translate_m", [0, 0, 0])), rotation(key)))

    def pose(self, time_s):
        """Returns the location and rotation at an instant. The scale never changes."""
        if not self.keys:
            return self.offset.copy(), self.turn.copy()
        after = bisect.bisect_right(self.times_s, time_s)
        if after in (0, len(self.keys)):
            move, turn = self.keys[min(after, len(self.keys) - 1)]
        else:
            share = (time_s - self.times_s[after - 1]) / (self.times_s[after] - self.times_s[after - 1])
            (move0, turn0), (move1, turn1) = self.keys[after - 1], self.keys[after]
            move, turn = move0.lerp(move1, share), turn0.slerp(turn1, share)
        return move + turn @ self.offset, turn @ self.turn

    def pose_beyond(self, time_s, close_s):
        """Returns the pose at an instant. After close_s, the motion before close_s is extrapolated."""
        if time_s <= close_s:
            return self.pose(time_s)
        (move0, turn0), (move1, turn1) = self.pose(2 * close_s - time_s), self.pose(close_s)
        return 2 * move1 - move0, turn1 @ turn0.inverted() @ turn1

    def matrix(self, pose):
        return Matrix.LocRotScale(*pose, self.scale)


class View:
    """The pinhole camera: its projection, and its Blender object."""

    def __init__(self, what, table, size_px):
        check_keys(what, table, CAMERA_KEYS)
        if table.get("projection", "perspective") != "perspective":
            raise SceneError(f"{what}: cannot be expressed here (got {table['projection']}; expected perspective)")
        self.focal_length_mm = float(table.get("focal_length_mm", 50))
        self.film_width_mm = float(table.get("film_width_mm", 36))
        self.size_px = size_px or (table.get("width_px", 960), table.get("height_px", 540))
        position = Vector(table.get("position_m", [0, 0, 0]))
        along = Vector(table.get("look_along", [0, 0, -1]))
        if "look_at_m" in table:
            along = Vector(table["look_at_m"]) - position
        along.normalize()
        right = along.cross(Vector(table.get("up", [0, 1, 0]))).normalized()
        self.world_from_camera = Matrix((right, right.cross(along), -along)).transposed().to_4x4()
        self.world_from_camera.translation = position
        self.camera_from_world = self.world_from_camera.inverted()
        self.px_per_tangent = self.size_px[0] * self.focal_length_mm / self.film_width_mm

    def raster(self, point):
        """Returns the image position of a world point, in px from the centre of the image, or None if the point is not
        in front of the camera."""
        x, y, z = self.camera_from_world @ point
        return None if z > -1e-6 else Vector((x, y)) * (self.px_per_tangent / -z)

    def px_per_m(self, point, margin_m):
        """Returns the largest magnification, in px per m, within margin_m of a point."""
        depth_m = -(self.camera_from_world @ point).z - margin_m
        return self.px_per_tangent / max(depth_m, 1e-3)

    def build(self, scene, f_number, focus_m):
        camera = bpy.data.cameras.new("camera")
        camera.sensor_fit, camera.sensor_width, camera.lens = "HORIZONTAL", self.film_width_mm, self.focal_length_mm
        camera.clip_start, camera.clip_end = 1e-3, 1e6
        # In Blender as in postlens, the radius of the aperture is focal length / (2 f-number). With 0 blades, the
        # aperture is a disc.
        camera.dof.use_dof = math.isfinite(f_number)
        if camera.dof.use_dof:
            camera.dof.aperture_fstop, camera.dof.focus_distance = f_number, focus_m
            camera.dof.aperture_blades, camera.dof.aperture_ratio = 0, 1
        scene.camera = bpy.data.objects.new("camera", camera)
        scene.camera.matrix_world = self.world_from_camera
        scene.collection.objects.link(scene.camera)
        scene.render.resolution_x, scene.render.resolution_y = self.size_px
        scene.render.resolution_percentage = 100


def checker(nodes, links, table, emission):
    """Makes shader nodes for the emission times the colour `even` or `odd`. The colour of a point depends on the cell
    that contains the point in object space."""
    what = f"texture '{table.get('name')}'"
    check_keys(what, table, TEXTURE_KEYS)

    def node(kind, source, value=None, operation=None):
        made = nodes.new(kind)
        made.operation = operation
        links.new(source, made.inputs[0])
        if value is not None:
            made.inputs[1].default_value = value
        return made

    # The checkerboard is computed by arithmetic nodes, because Blender's Checker Texture would shift the borders of the
    # cells. The nodes multiply the position by 1 / x, where x is the size of a cell. If x is infinite, the pattern is
    # constant along this axis.
    shares = [1 / x for x in triple(needed(what, table, "size_m"))]
    at = nodes.new("ShaderNodeTexCoord").outputs["Object"]
    at = node("ShaderNodeVectorMath", at, triple(table.get("offset_m", 0)), "SUBTRACT").outputs["Vector"]
    at = node("ShaderNodeVectorMath", at, shares, "MULTIPLY").outputs["Vector"]
    at = node("ShaderNodeVectorMath", at, None, "FLOOR").outputs["Vector"]
    total = node("ShaderNodeVectorMath", at, [1, 1, 1], "DOT_PRODUCT").outputs["Value"]
    total = node("ShaderNodeMath", total, None, "ABSOLUTE").outputs["Value"]
    is_odd = node("ShaderNodeMath", total, 2.0, "MODULO").outputs["Value"]
    mix = nodes.new("ShaderNodeMixRGB")
    links.new(is_odd, mix.inputs["Fac"])
    for key, socket in (("even", "Color1"), ("odd", "Color2")):
        mix.inputs[socket].default_value = [x * e for x, e in zip(triple(table.get(key, 1)), emission)] + [1]
    return mix.outputs["Color"]


def emitter(table, textures, ambient_light):
    """Returns a Blender material with the emission of the scene's material."""
    what = f"material '{table.get('name')}'"
    check_keys(what, table, MATERIAL_KEYS)
    for key, default in MATERIAL_ZEROS.items():
        if any(triple(table.get(key, default))):
            raise SceneError(f"{what}: only emission can be expressed here (got {key} above 0; expected 0)")
    if any(a * b for a, b in zip(triple(table.get("ambient", 0.1)), ambient_light)):
        raise SceneError(f"{what}: only emission can be expressed here (got ambient light; expected none)")
    made = bpy.data.materials.new(table["name"])
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.clear()
    shine = nodes.new("ShaderNodeEmission")
    emission = triple(table.get("emission", 0))
    shine.inputs["Color"].default_value = emission + [1]
    shine.inputs["Strength"].default_value = 1
    if "emission_texture" in table:
        texture = textures.get(table["emission_texture"])
        if texture is None or texture.get("kind") != "checker":
            raise SceneError(f"{what}: cannot be expressed here (got {table['emission_texture']}; expected a checker)")
        links.new(checker(nodes, links, texture, emission), shine.inputs["Color"])
    links.new(shine.outputs["Emission"], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    made.cycles.sample_as_light = False  # nothing is illuminated, so lights need not be sampled
    return made


def ball(made, centre, radius_m, px_per_m):
    """Makes a sphere of triangles that lie at most OUTLINE_PX below the exact surface. Returns their greatest depth
    below the surface, in px."""
    for level in range(2, LARGEST_ICOSPHERE + 1):
        made.clear()
        bmesh.ops.create_icosphere(made, subdivisions=level, radius=radius_m)
        made.normal_update()
        error_px = px_per_m * (radius_m - min(abs(face.normal.dot(face.verts[0].co)) for face in made.faces))
        if error_px < OUTLINE_PX:
            break
    bmesh.ops.translate(made, verts=made.verts, vec=centre)
    return error_px


def tube(made, base, apex, radius_m, px_per_m, capped):
    """Makes a cylinder of rectangles. The tolerance and the result are those of `ball`."""
    axis = apex - base
    count = max(8, math.ceil(math.pi / math.acos(1 - min(OUTLINE_PX / (px_per_m * radius_m), 0.5))))
    side = axis.orthogonal().normalized() * radius_m
    sides = [Quaternion(axis, 2 * math.pi * i / count) @ side for i in range(count)]
    low = [made.verts.new(base + s) for s in sides]
    high = [made.verts.new(apex + s) for s in sides]
    for i in range(count):
        j = (i + 1) % count
        made.faces.new((low[i], low[j], high[j], high[i]))
    if capped:
        made.faces.new(low)
        made.faces.new(high)
    return px_per_m * radius_m * (1 - math.cos(math.pi / count))


def shape(what, table, magnification):
    """Returns the mesh of an object in object space, and the error of its outline, in px. `magnification(point,
    margin)` returns the px per metre of object space within the distance `margin` of a point."""
    kind = needed(what, table, "shape")
    if kind not in SHAPE_KEYS:
        raise SceneError(f"{what}: cannot be expressed here (got {kind}; expected {', '.join(sorted(SHAPE_KEYS))})")
    check_keys(what, table, OBJECT_KEYS | SHAPE_KEYS[kind])
    made, error_px = bmesh.new(), 0.0
    if kind == "rectangle":
        corner, u, v = (Vector(needed(what, table, k)) for k in ("corner_m", "edge_u_m", "edge_v_m"))
        made.faces.new([made.verts.new(p) for p in (corner, corner + u, corner + u + v, corner + v)])
    elif kind == "box":
        if "size_m" in table:
            middle, half = Vector(table.get("centre_m", [0, 0, 0])), Vector(triple(table["size_m"])) / 2
            low, high = middle - half, middle + half
        else:
            low, high = Vector(needed(what, table, "min_m")), Vector(needed(what, table, "max_m"))
        placed = Matrix.LocRotScale((low + high) / 2, None, high - low)
        bmesh.ops.create_cube(made, size=1, matrix=placed)
    elif kind == "sphere":
        centre, radius_m = Vector(table.get("centre_m", [0, 0, 0])), float(needed(what, table, "radius_m"))
        error_px = ball(made, centre, radius_m, magnification(centre, radius_m))
    else:
        base, apex = Vector(needed(what, table, "base_m")), Vector(needed(what, table, "apex_m"))
        radius_m = float(needed(what, table, "radius_m"))
        px_per_m = max(magnification(base, radius_m), magnification(apex, radius_m))
        error_px = tube(made, base, apex, radius_m, px_per_m, table.get("capped", True))
    mesh = bpy.data.meshes.new(table.get("name", kind))
    made.to_mesh(mesh)
    made.free()
    return mesh, error_px


def shifts(what, table):
    """The translations of the copies of an object."""
    repeat = table.get("repeat")
    if repeat is None:
        return [Vector((0, 0, 0))]
    check_keys(f"{what}, repeat", repeat, {"count", "step_m", "at_m"})
    if "at_m" in repeat:
        return [Vector(at) for at in repeat["at_m"]]
    step = Vector(needed(f"{what}, repeat", repeat, "step_m"))
    count = needed(f"{what}, repeat", repeat, "count")
    if not isinstance(count, list):
        return [step * i for i in range(count)]
    cells = ((x, y, z) for x in range(count[0]) for y in range(count[1]) for z in range(count[2]))
    return [Vector((x * step.x, y * step.y, z * step.z)) for x, y, z in cells]


class Exposure:
    """The shutter interval and the poses for Cycles. The exposure lasts from frame 0 to frame `covered`."""

    def __init__(self, shutter_s, covered):
        self.open_s, self.close_s = shutter_s
        self.covered = covered

    def time_s(self, frame):
        return self.open_s + (self.close_s - self.open_s) * frame / self.covered

    def poses(self, motion, log2):
        """Frames, times and poses of a moving object."""
        frames = [i / 2**log2 for i in range(2**log2 + 1)]
        return [(f, self.time_s(f), motion.pose_beyond(self.time_s(f), self.close_s)) for f in frames]


def corners(mesh):
    low = Vector([min(v.co[k] for v in mesh.vertices) for k in range(3)])
    high = Vector([max(v.co[k] for v in mesh.vertices) for k in range(3)])
    return [Vector((x, y, z)) for x in (low.x, high.x) for y in (low.y, high.y) for z in (low.z, high.z)]


def animate(made, motion, exposure, view):
    """Adds enough poses to an object. Returns the greatest error of its motion between poses, in px."""

    def off_px(log2):
        worst, steps, box = 0.0, exposure.poses(motion, log2), corners(made.data)
        for (_, time0, (move0, turn0)), (_, time1, (move1, turn1)) in zip(steps, steps[1:]):
            for share in (0.25, 0.5, 0.75):
                time_s = time0 + (time1 - time0) * share
                if time_s > exposure.close_s:
                    continue
                between = motion.matrix((move0.lerp(move1, share), turn0.slerp(turn1, share)))
                true = motion.matrix(motion.pose(time_s))
                for corner in box:
                    a, b = view.raster(between @ corner), view.raster(true @ corner)
                    if a is not None and b is not None:
                        worst = max(worst, (a - b).length)
        return worst

    log2 = next((n for n in range(1, POSES_LOG2) if off_px(n) < MOTION_PX), POSES_LOG2)
    made.cycles.use_motion_blur, made.cycles.use_deform_motion, made.cycles.motion_steps = True, False, log2
    last = None
    for frame, _, (made.location, turn) in exposure.poses(motion, log2):
        if last is not None and turn.dot(last) < 0:
            turn.negate()  # Blender interpolates the four numbers, so their sign must not change
        made.rotation_quaternion = last = turn
        made.keyframe_insert("location", frame=frame)
        made.keyframe_insert("rotation_quaternion", frame=frame)
    for curve in made.animation_data.action.fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    return off_px(log2)


def check_poses(scene, moving, exposure, view):
    """Returns the greatest difference, in px, between Blender's evaluation of the motion at the poses and the formula
    of the scene."""
    worst = 0.0
    for made, motion in moving:
        for frame, _, pose in exposure.poses(motion, made.cycles.motion_steps):
            scene.frame_set(int(frame), subframe=frame % 1)
            true = motion.matrix(pose)
            for corner in corners(made.data):
                a, b = view.raster(made.matrix_world @ corner), view.raster(true @ corner)
                if a is not None and b is not None:
                    worst = max(worst, (a - b).length)
    scene.frame_set(0)
    return worst


def build(scene, tables, view, exposure):
    """Builds all objects. Returns the greatest errors of outlines and motion, in px, and the number of moving ones."""
    world = tables.get("scene", {})
    check_keys("[scene]", world, SCENE_KEYS)
    for key in tables:
        if key not in ("scene", "camera", "material", "texture", "object") and tables[key]:
            raise SceneError(f"cannot be expressed here (got [[{key}]]; expected emission only)")
    textures = {t["name"]: t for t in tables.get("texture", [])}
    ambient_light = triple(world.get("ambient_light", 1))
    materials = {t["name"]: emitter(t, textures, ambient_light) for t in tables.get("material", [])}
    scene.world = bpy.data.worlds.new("background")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = triple(world.get("background", 0)) + [1]
    scene.world.cycles.sampling_method = "NONE"

    outline_px, motion_px, moving = 0.0, 0.0, []
    for number, table in enumerate(tables.get("object", []), 1):
        what = f"object '{table.get('name', number)}'"
        if table.get("hidden", False):
            continue
        if table.get("material") not in materials:
            raise SceneError(f"{what}: a material is missing (got {table.get('material')}; expected one that emits)")
        motions = [Motion(what, table, shift) for shift in shifts(what, table)]
        times_s = [exposure.open_s + (exposure.close_s - exposure.open_s) * i / 16 for i in range(17)]

        def magnification(point, margin_m):
            largest = max(motions[0].scale)
            places = [m.matrix(m.pose(t)) @ point for m in motions for t in (times_s if m.keys else times_s[:1])]
            return max(view.px_per_m(p, margin_m * largest) for p in places) * largest

        mesh, error_px = shape(what, table, magnification)
        mesh.materials.append(materials[table["material"]])
        outline_px = max(outline_px, error_px)
        for motion in motions:
            made = bpy.data.objects.new(mesh.name, mesh)
            made.rotation_mode = "QUATERNION"
            made.location, made.rotation_quaternion = motion.pose(exposure.open_s)
            made.scale = motion.scale
            scene.collection.objects.link(made)
            if motion.keys and exposure.close_s > exposure.open_s:
                motion_px = max(motion_px, animate(made, motion, exposure, view))
                moving.append((made, motion))
    return outline_px, motion_px + check_poses(scene, moving, exposure, view), len(moving)


def settings(scene, arguments, moves):
    """Sets up Cycles for the integral that postlens computes. It has box filters over pixel, lens and time."""
    cycles, render = scene.cycles, scene.render
    cycles.device, cycles.samples, cycles.seed, cycles.use_animated_seed = "CPU", arguments.spp, arguments.seed, False
    cycles.sampling_pattern = {"pmj": "PROGRESSIVE_MULTI_JITTER", "sobol": "SOBOL"}[arguments.sampler]
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 0
    cycles.volume_bounces = cycles.transparent_max_bounces = 0
    cycles.film_exposure = 1
    render.film_transparent = render.use_compositing = render.use_sequencer = False
    render.use_motion_blur, render.motion_blur_shutter, cycles.motion_blur_position = moves, 1.0, "START"
    for point in render.motion_blur_shutter_curve.curves[0].points:
        point.location = (point.location[0], 1.0)
    render.motion_blur_shutter_curve.update()
    render.threads_mode, render.threads = ("FIXED", arguments.threads) if arguments.threads else ("AUTO", 1)
    scene.view_settings.view_transform, scene.view_settings.look = "Raw", "None"
    scene.view_settings.exposure, scene.view_settings.gamma, render.dither_intensity = 0, 1, 0
    image = render.image_settings
    image.file_format = "OPEN_EXR_MULTILAYER" if arguments.passes else "OPEN_EXR"
    image.color_mode, image.color_depth, image.exr_codec = "RGBA" if arguments.passes else "RGB", "32", "ZIP"
    scene.view_layers[0].use_pass_z = arguments.passes
    render.filepath = os.path.abspath(arguments.out)


def pair(separator, kind):
    def parse(text):
        first, second = text.split(separator)
        return kind(first), kind(second)

    return parse


def parse(words):
    parser = argparse.ArgumentParser(prog="toml_to_blender.py")
    parser.add_argument("scene")
    parser.add_argument("out")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--size", type=pair("x", int), metavar="WxH")
    parser.add_argument("--camera", metavar="NAME")
    parser.add_argument("--f-number", type=float, metavar="N|inf")
    parser.add_argument("--focus", type=float, metavar="M")
    parser.add_argument("--shutter", type=pair(":", float), metavar="OPEN:CLOSE")
    parser.add_argument("--whole-frame", action="store_true", help="do not make up for SHUTTER_COVERED")
    # With few samples per pixel, the image has a larger systematic error (bias) with Cycles' default sampler (pmj)
    # than with Sobol points.
    parser.add_argument("--sampler", choices=["sobol", "pmj"], default="sobol")
    parser.add_argument("--passes", action="store_true", help="a multi-layer file, with the pass Depth")
    parser.add_argument("--threads", type=int, default=0)
    return parser.parse_args(words)


def prepare(arguments):
    """Builds Blender's scene for a render. Returns the scene, and the report that main() prints."""
    with open(arguments.scene, "rb") as file:
        tables = tomllib.load(file)
    cameras = tables.get("camera", [])
    chosen = next((c for c in cameras if arguments.camera in (None, c.get("name"))), None)
    if chosen is None:
        raise SceneError(f"no such camera (got {arguments.camera}; expected one of the scene's)")
    view = View(f"camera '{chosen.get('name', 1)}'", chosen, arguments.size)
    f_number = arguments.f_number if arguments.f_number is not None else chosen.get("f_number", math.inf)
    focus_m = arguments.focus if arguments.focus is not None else chosen.get("focus_m", math.inf)
    if math.isfinite(f_number) and not math.isfinite(focus_m):
        raise SceneError("a focus at infinity cannot be expressed here (expected --focus M)")
    time_s = tables.get("scene", {}).get("time_s", 0)
    exposure = Exposure(arguments.shutter or (time_s, time_s), 1 if arguments.whole_frame else SHUTTER_COVERED)

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.frame_start, scene.frame_end = 0, 1
    outline_px, motion_px, moving = build(scene, tables, view, exposure)
    view.build(scene, f_number, focus_m)
    settings(scene, arguments, moving > 0)
    scene.frame_set(0)
    return scene, {"outline_px": outline_px, "motion_px": motion_px, "moving": moving}


def main(arguments):
    _, said = prepare(arguments)
    bpy.ops.render.render(write_still=True)
    print("toml_to_blender: " + json.dumps(said))


if __name__ == "__main__":
    try:
        main(parse(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else ["--help"]))
    except (SceneError, tomllib.TOMLDecodeError) as error:
        print(f"toml_to_blender.py: {error}", file=sys.stderr)
        sys.exit(1)
    except OSError as error:
        print(f"toml_to_blender.py: {error.filename}: {error.strerror}", file=sys.stderr)
        sys.exit(1)
