"""Converts Blender's camera to options of postlens. This module does not depend on Blender's operators or panels."""

import math
from dataclasses import dataclass

from mathutils import Vector


class CameraError(Exception):
    """The camera has a property that postlens does not support."""


@dataclass(frozen=True)
class Film:
    """The size of an image in pixels, and the film width and film distance of its camera. Pixels are square."""

    width_px: int
    height_px: int
    width_mm: float
    distance_mm: float

    @property
    def pixels_per_radian(self):
        return self.distance_mm / self.width_mm * self.width_px

    def with_margin(self, margin_px):
        """Returns the film, enlarged by `margin_px` pixels on every side, for the same camera."""
        width = self.width_px + 2 * margin_px
        return Film(width, self.height_px + 2 * margin_px, self.width_mm * width / self.width_px, self.distance_mm)


@dataclass(frozen=True)
class Lens:
    """The lens of the camera. Distances are measured along the camera's axis, in metres. As in Cycles, one Blender unit
    is one metre."""

    focal_length_mm: float
    f_number: float
    focus_m: float
    blades: int
    rotation_rad: float
    ratio: float

    @property
    def aperture_radius_m(self):
        """Half of the larger side of the aperture. The aperture ratio divides the width and does not change the
        height."""
        return self.focal_length_mm * 1e-3 / (2 * self.f_number) * max(1, 1 / self.ratio)

    def coc_radius_px(self, distance_m, film):
        """Returns the radius, in px, of the circle of confusion at `distance_m`, which may be infinite. The radius is
        half of the larger side. It is positive behind the focus distance."""
        return self.aperture_radius_m * film.pixels_per_radian * (1 / self.focus_m - 1 / distance_m)

    def distance_in_front_m(self, radius_px, film):
        """Returns the distance in front of the plane in focus, in m, at which circles of confusion have the radius
        `radius_px`."""
        return 1 / (1 / self.focus_m + radius_px / (self.aperture_radius_m * film.pixels_per_radian))

    def options(self):
        impulse = "disc"
        if self.blades >= 3:
            # Converts the rotation of the aperture polygon from Blender's convention to that of postlens. Blender
            # states the angle of the middle of a side, counter-clockwise. postlens expects the angle of a corner,
            # clockwise. The two are 180 / blades degrees apart.
            impulse = f"polygon:{self.blades}:{-math.degrees(self.rotation_rad) - 180 / self.blades:.9g}"
        out = ["--f-number", f"{self.f_number:.9g}", "--focal-length", f"{self.focal_length_mm:.9g}"]
        out += ["--focus", f"{self.focus_m:.9g}", "--impulse", impulse]
        if self.ratio != 1:
            out += ["--squeeze", f"{self.ratio:.9g}"]
        return out


def film_of(scene, camera):
    """Returns the film of a camera. Raises CameraError unless the camera has a single perspective view with square
    pixels."""
    data = camera.data
    if data.type != "PERSP":
        raise CameraError(f"camera {camera.name}: is {data.type.lower()} (expected a perspective camera)")
    render = scene.render
    if render.pixel_aspect_x != render.pixel_aspect_y:
        raise CameraError(
            f"pixels are not square (got {render.pixel_aspect_x:g}:{render.pixel_aspect_y:g}; expected 1:1)"
        )
    if render.use_border:
        raise CameraError("a render region is set (expected none: Render Region off)")
    if render.use_multiview:
        raise CameraError("the scene has several views (expected one: Stereoscopy off)")
    width = max(1, int(render.resolution_x * render.resolution_percentage / 100))
    height = max(1, int(render.resolution_y * render.resolution_percentage / 100))
    if data.sensor_fit == "VERTICAL":
        sensor_mm, sensor_px = data.sensor_height, height
    else:
        sensor_mm, sensor_px = data.sensor_width, width if data.sensor_fit == "HORIZONTAL" else max(width, height)
    return Film(width, height, sensor_mm * width / sensor_px, data.lens)


def view_of(scene, camera):
    """Returns the properties of a camera that affect its passes, except its pose. The result maps names to texts."""
    data, film = camera.data, film_of(scene, camera)
    return {
        "camera": camera.name,
        "focal length": f"{film.distance_mm:.9g} mm",
        "film": f"{film.width_mm:.9g} mm, {film.width_px}x{film.height_px} px",
        "shift": f"{data.shift_x:.9g}, {data.shift_y:.9g}",
    }


def pose_of(camera, depsgraph):
    """Returns the camera's position and viewing direction. As in Cycles, the camera's scale has no effect."""
    matrix = camera.evaluated_get(depsgraph).matrix_world
    return matrix.translation, -matrix.col[2].xyz.normalized()


def lens_of(camera, depsgraph):
    """Returns the lens at the frame of `depsgraph`. Raises CameraError if the focus distance or the f-number is not
    above 0."""
    evaluated = camera.evaluated_get(depsgraph)
    dof = evaluated.data.dof
    focus_m = dof.focus_distance
    if dof.focus_object is not None:
        target = dof.focus_object.evaluated_get(depsgraph)
        bone = target.pose and target.pose.bones.get(dof.focus_subtarget)
        point = (target.matrix_world @ bone.matrix if bone else target.matrix_world).translation
        eye, axis = pose_of(camera, depsgraph)
        focus_m = abs((point - eye).dot(axis))
    if not focus_m > 0:
        raise CameraError(f"camera {camera.name}: focus distance {focus_m:g} m (expected more than 0)")
    if not dof.aperture_fstop > 0:
        raise CameraError(f"camera {camera.name}: f-number {dof.aperture_fstop:g} (expected more than 0)")
    return Lens(
        evaluated.data.lens, dof.aperture_fstop, focus_m, dof.aperture_blades, dof.aperture_rotation, dof.aperture_ratio
    )


def depths_of(corners, matrix, pose):
    """Returns the nearest and the farthest distance of a box (Object.bound_box), in Blender's units. Distances are
    measured along the axis of a camera with this pose."""
    eye, axis = pose
    low, high = Vector(corners[0]), Vector(corners[6])
    along = axis @ matrix.to_3x3()
    middle = (matrix @ ((low + high) / 2) - eye).dot(axis)
    half = sum(abs(a) * side / 2 for a, side in zip(along, high - low))
    return middle - half, middle + half
