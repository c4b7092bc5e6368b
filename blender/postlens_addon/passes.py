"""Renders what postlens reads: a pinhole picture with passes, and what stands behind its near objects."""

import contextlib
import math
import os

import bpy

from . import camera as cameras

# Objects that a ray of the camera can meet.
SHAPES = {"MESH", "CURVE", "SURFACE", "META", "FONT", "CURVES", "POINTCLOUD", "VOLUME"}
# No margin is wider than this share of the frame: what is more blurred at its border is guessed from inside.
WIDEST_MARGIN = 0.25
# From this radius of its circles on, what a blurred edge lets through can be seen.
VISIBLE_RADIUS_PX = 1.0


@contextlib.contextmanager
def kept(*places):
    """Puts back what the body changes: pairs of a thing of Blender's and the names of its properties."""
    before = [(thing, name, getattr(thing, name)) for thing, names in places for name in names]
    try:
        yield
    finally:
        for thing, name, value in reversed(before):
            with contextlib.suppress(ReferenceError):  # removed meanwhile
                setattr(thing, name, value)


def shapes(scene):
    return [o for o in scene.objects if o.type in SHAPES and not o.hide_render]


def nearest_depth(scene, camera, depsgraph):
    depths = [cameras.depths_of(o, camera, depsgraph)[0] for o in shapes(scene)]
    return max(camera.data.clip_start, min(depths, default=math.inf))


def margin_px(scene, camera, depsgraph, lens, film):
    """How far beyond the frame the lens reaches: pixels that have to be rendered there."""
    nearest = lens.coc_radius_px(nearest_depth(scene, camera, depsgraph), film)
    farthest = lens.coc_radius_px(math.inf, film)
    widest = int(WIDEST_MARGIN * min(film.width_px, film.height_px))
    return min(widest, math.ceil(max(abs(nearest), abs(farthest))) + 1)


def hidden_before(scene, camera, depsgraph, distance_m):
    """Objects that end nearer than a distance; what reaches beyond it, such as a floor, is not among them."""
    return [o for o in shapes(scene) if o.visible_camera and cameras.depths_of(o, camera, depsgraph)[1] < distance_m]


@contextlib.contextmanager
def pinhole(scene, camera, film, vectors):
    """The scene as it has to be rendered: no lens, no shutter, the wider film, and the passes."""
    render, data = scene.render, camera.data
    layers = [(layer, ("use_pass_z", "use_pass_vector", "use_pass_cryptomatte_object", "pass_cryptomatte_depth"))
              for layer in scene.view_layers]  # fmt: skip
    image = ("file_format", "color_mode", "color_depth", "exr_codec")
    with kept(
        (render, ("resolution_x", "resolution_y", "resolution_percentage", "use_motion_blur", "filepath",
                  "use_file_extension", "use_overwrite", "use_compositing", "use_sequencer")),
        (render.image_settings, image),
        (data, ("sensor_fit", "sensor_width", "sensor_height", "shift_x", "shift_y")),
        (data.dof, ("use_dof",)),
        (scene, ("camera",)),
        *layers,
    ):  # fmt: skip
        scene.camera = camera
        # A shift is counted in the larger side of the frame, which the margin changes.
        larger = max(render.resolution_x, render.resolution_y) * render.resolution_percentage / 100
        if data.sensor_fit != "AUTO":
            larger = render.resolution_x if data.sensor_fit == "HORIZONTAL" else render.resolution_y
            larger *= render.resolution_percentage / 100
        data.shift_x, data.shift_y = data.shift_x * larger / film.width_px, data.shift_y * larger / film.width_px
        data.sensor_fit, data.sensor_width = "HORIZONTAL", film.width_mm
        data.dof.use_dof = False
        render.resolution_x, render.resolution_y, render.resolution_percentage = film.width_px, film.height_px, 100
        render.use_motion_blur = render.use_compositing = render.use_sequencer = False
        render.use_file_extension, render.use_overwrite = False, True
        settings = render.image_settings
        settings.file_format, settings.color_mode = "OPEN_EXR_MULTILAYER", "RGBA"
        settings.color_depth, settings.exr_codec = "32", "ZIP"
        for layer in scene.view_layers:
            layer.use_pass_z = layer.use_pass_cryptomatte_object = True
            layer.use_pass_vector = vectors
            layer.pass_cryptomatte_depth = 6
        yield


def render_to(scene, path):
    """Renders a still picture; returns when it is written. Raises RuntimeError with Blender's words."""
    os.makedirs(os.path.dirname(path), exist_ok=True)
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True, scene=scene.name)


@contextlib.contextmanager
def without(objects):
    """The camera's rays pass these objects; light, shadows and mirrors still meet them."""
    with kept(*((o, ("visible_camera",)) for o in objects)):
        for o in objects:
            o.visible_camera = False
        yield
