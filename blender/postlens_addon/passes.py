"""Renders the images that postlens uses: a pinhole image with passes, and a second image without the near
objects."""

import contextlib
import math
import os

import bpy

from . import camera as cameras
from . import command

# Types of objects that a camera ray can hit.
SHAPES = {"MESH", "CURVE", "SURFACE", "META", "FONT", "CURVES", "POINTCLOUD", "VOLUME"}
# Largest margin that Blender renders around the image, as a fraction of the image's shorter side. The margin is needed
# because a lens blurs light from outside into the image. Light from beyond the margin is estimated from pixels within
# it.
WIDEST_MARGIN = 0.25
# Smallest radius, in px, of a circle of confusion that counts as blur. A second render shows the surfaces behind
# blurred objects, so it leaves out these objects: those in front of the focus distance whose circle of confusion has
# at least this radius.
VISIBLE_RADIUS_PX = 1.0


def curves_of(thing, name):
    """Returns the animation curves and drivers of properties with this name in the data block of `thing`."""
    animation = getattr(thing.id_data, "animation_data", None)  # collections, for example, have none
    if not animation:
        return []
    actions = {animation.action, *(strip.action for track in animation.nla_tracks for strip in track.strips)} - {None}
    curves = [*(curve for action in actions for curve in action.fcurves), *animation.drivers]
    return [c for c in curves if c.data_path.rpartition(".")[2] == name and not c.mute]


@contextlib.contextmanager
def kept(*places):
    """Restores properties after the body of the `with` statement. In the body, properties keep the values that are set
    there, even if they are animated. If a property cannot be restored, the others are restored nevertheless.

    `places` contains pairs of a Blender object and the names of its properties, in the order in which they must be set.
    For example, a file format comes before its colour depth, because the format determines which depths exist."""
    before = [(thing, name, getattr(thing, name)) for thing, names in places for name in names]
    # Mutes the animation of the changed properties. Otherwise, rendering would evaluate the animation and overwrite
    # their new values.
    muted = [(curve, "mute", False) for thing, name, _ in before for curve in curves_of(thing, name)]
    try:
        for curve, _, _ in muted:
            curve.mute = True
        yield
    finally:
        failure = None
        for thing, name, value in before + muted:
            try:
                setattr(thing, name, value)
            except ReferenceError:  # the object was removed in the body
                pass
            except (TypeError, ValueError, AttributeError) as error:
                failure = RuntimeError(f"cannot restore {name} (got {error}; expected {value})")
        if failure is not None:
            raise failure


def is_holdout(thing, layer):
    return thing.is_holdout or thing.holdout_get(view_layer=layer)


def depths(scene, camera, depsgraph):
    """Returns the nearest and the farthest distance of each object in front of the camera. Instances that the object
    makes, and instances of the object, are included, because hiding the object from camera rays hides them too. A
    holdout (object that leaves the image empty) must not be hidden, so it counts as infinitely far away."""
    pose, layer, out = cameras.pose_of(camera, depsgraph), layer_of(scene), {}
    for instance in depsgraph.object_instances:
        if instance.object.type in SHAPES and instance.show_self:
            near, far = cameras.depths_of(instance.object.bound_box, instance.matrix_world, pose)
            owners = {o.original for o in (instance.object, instance.parent) if o}
            if far > 0 and any(is_holdout(o, layer) for o in owners):
                far = math.inf
            for owner in owners:
                nearest, farthest = out.get(owner, (math.inf, -math.inf))
                out[owner] = min(near, nearest), max(far, farthest)
    return {owner: span for owner, span in out.items() if span[1] > 0}


def margin_px(camera, spans, lens, film):
    """Returns the number of pixels to render beyond the frame on each side. The lens spreads the light of these pixels
    into the frame. `spans` is the result of `depths`."""
    nearest_m = max(camera.data.clip_start, min((near for near, _ in spans.values()), default=math.inf))
    nearest, farthest = lens.coc_radius_px(nearest_m, film), lens.coc_radius_px(math.inf, film)
    widest = int(WIDEST_MARGIN * min(film.width_px, film.height_px))
    return min(widest, math.ceil(max(abs(nearest), abs(farthest))) + 1)


def hidden_before(spans, distance_m):
    """Returns the objects that are entirely nearer than `distance_m`. An object that extends beyond this distance, such
    as a floor, is not returned. `spans` is the result of `depths`."""
    return [o for o, (_, far) in spans.items() if far < distance_m and o.visible_camera]


def layer_of(scene):
    """Returns the view layer from which images are made. It is the first that is used for rendering."""
    return next((layer for layer in scene.view_layers if layer.use), scene.view_layers[0])


@contextlib.contextmanager
def pinhole(scene, camera, film, vectors):
    """Within the body of the `with` statement, the scene has a pinhole without a shutter, the given film, a single view
    layer, and the passes that postlens needs."""
    render, data, layer = scene.render, camera.data, layer_of(scene)
    linear = render.image_settings.linear_colorspace_settings
    image = ("file_format", "color_mode", "color_depth", "exr_codec", "color_management")
    with kept(
        (render, ("resolution_x", "resolution_y", "resolution_percentage", "use_motion_blur", "filepath", "use_stamp",
                  "use_file_extension", "use_overwrite", "use_compositing", "use_sequencer", "use_single_layer")),
        (render.image_settings, image),
        # `linear` contains the colour space in which the image file is written. Blender changes it whenever the file
        # format changes. Therefore, it must be restored after the render, like the settings that are changed below.
        (linear, ("name",) if render.image_settings.color_management == "OVERRIDE" and linear.name else ()),
        (data, ("sensor_fit", "sensor_width", "sensor_height", "shift_x", "shift_y")),
        (data.dof, ("use_dof",)),
        (scene, ("camera",)),
        (layer, ("use_pass_z", "use_pass_vector", "use_pass_cryptomatte_object", "pass_cryptomatte_depth")),
        *((other, ("use",)) for other in scene.view_layers),
    ):  # fmt: skip
        scene.camera = camera
        # The camera's shift is a fraction of one side of the image, usually the longer. `larger` is this side in px,
        # without the margin that is added for light that the lens blurs into the image.
        larger = max(render.resolution_x, render.resolution_y) * render.resolution_percentage / 100
        if data.sensor_fit != "AUTO":
            larger = render.resolution_x if data.sensor_fit == "HORIZONTAL" else render.resolution_y
            larger *= render.resolution_percentage / 100
        # Because sensor_fit becomes HORIZONTAL, the shift must now be a fraction of `film.width_px`, the width of the
        # image with the margin.
        data.shift_x, data.shift_y = data.shift_x * larger / film.width_px, data.shift_y * larger / film.width_px
        data.sensor_fit, data.sensor_width = "HORIZONTAL", film.width_mm
        data.dof.use_dof = False
        render.resolution_x, render.resolution_y, render.resolution_percentage = film.width_px, film.height_px, 100
        render.use_motion_blur = render.use_compositing = render.use_sequencer = render.use_stamp = False
        render.use_file_extension, render.use_overwrite = False, True
        settings = render.image_settings
        settings.file_format, settings.color_mode = "OPEN_EXR_MULTILAYER", "RGBA"
        settings.color_depth, settings.exr_codec = "32", "ZIP"
        # The output settings of the scene may state another colour space.
        settings.color_management = "FOLLOW_SCENE"
        # Only the view layer `layer` is rendered. If `use_single_layer` were True, Blender would instead render the
        # one that its window shows.
        render.use_single_layer = False
        for other in scene.view_layers:
            other.use = other == layer
        layer.use_pass_z = layer.use_pass_cryptomatte_object = True
        layer.use_pass_vector = vectors
        layer.pass_cryptomatte_depth = 6
        yield


@contextlib.contextmanager
def without_render_window():
    """Keeps Blender from opening its render view if a render begins in the body of the `with` statement."""
    preferences = bpy.context.preferences
    with kept((preferences.view, ("render_display_type",)), (preferences, ("is_dirty",))):
        preferences.view.render_display_type = "NONE"
        yield


def render_job(scene):
    """Renders in a thread of Blender, as the Render menu does. Yields while the render runs. Raises Cancelled if the
    render is stopped."""
    stopped = []

    def stop(*_):
        stopped.append(True)

    cancels = bpy.app.handlers.render_cancel
    cancels.append(stop)
    try:
        with without_render_window():
            bpy.ops.render.render("INVOKE_DEFAULT", write_still=True, scene=scene.name)
        while bpy.app.is_job_running("RENDER"):
            yield
    finally:
        cancels.remove(stop)
    if stopped:
        raise command.Cancelled()


def render_to(scene, path, in_window=False):
    """Renders a still image and writes it to `path`. With `in_window`, this generator yields while the render runs.

    Raises RuntimeError with Blender's message, and Cancelled. If it raises, the file at `path` is not changed.
    """
    os.makedirs(os.path.dirname(path), exist_ok=True)
    part = path + ".part"
    with contextlib.suppress(FileNotFoundError):
        os.remove(part)
    scene.render.filepath = part
    try:
        if in_window:
            yield from render_job(scene)
        else:
            bpy.ops.render.render(write_still=True, scene=scene.name)
        if not os.path.exists(part):
            raise RuntimeError(f"Blender has not written its render (to {path})")
        os.replace(part, path)
    finally:
        with contextlib.suppress(FileNotFoundError):
            os.remove(part)


@contextlib.contextmanager
def without(objects):
    """Within the body of the `with` statement, camera rays do not see these objects. Light, shadows and reflections
    still include them."""
    with kept(*((o, ("visible_camera",)) for o in objects)):
        for o in objects:
            o.visible_camera = False
        yield
