"""Makes focused images of a Blender scene: renders the passes and runs the postlens commands, frame by frame."""

import os
from dataclasses import dataclass, field

import bpy

from . import camera as cameras
from . import command, passes


@dataclass
class Job:
    """The frames of which images are made, and the settings of these images."""

    scene: object
    folder: str
    program: str
    frames: list
    method: str = "layers"
    views: int = 256
    behind: bool = True
    behind_distance_m: float = 0  # 0: the distance at which blur becomes visible
    only_lens_changes: bool = False
    cancelled: object = lambda: False
    progress: object = lambda share, text: None
    warnings: list = field(default_factory=list)

    def path(self, name, frame, ending=".exr"):
        return os.path.join(self.folder, f"{name}.{frame:04d}{ending}")


@dataclass
class Passes:
    """The files that were rendered for a frame."""

    film: object
    margin_px: int
    front: str
    behind: str = ""


def at_frame(job, frame):
    """Sets the scene to a frame. Returns its camera, dependency graph, lens and film."""
    job.scene.frame_set(frame)
    camera = job.scene.camera
    if camera is None:
        raise cameras.CameraError(f"scene {job.scene.name} has no camera")
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return camera, depsgraph, cameras.lens_of(camera, depsgraph), cameras.film_of(job.scene, camera)


def widest_margin(job):
    """The margin, px, that suffices for the lenses of all frames."""
    widest = 0
    for frame in job.frames:
        camera, depsgraph, lens, film = at_frame(job, frame)
        widest = max(widest, passes.margin_px(job.scene, camera, depsgraph, lens, film))
    return widest


def farthest_split(job):
    """The distance, m, before which objects are omitted from the second image: the farthest such distance of all
    frames."""
    if job.behind_distance_m > 0:
        return job.behind_distance_m
    farthest = 0
    for frame in job.frames:
        _, _, lens, film = at_frame(job, frame)
        farthest = max(farthest, lens.distance_in_front_m(passes.VISIBLE_RADIUS_PX, film))
    return farthest


def render_passes(job, frame, margin_px, split_m):
    camera, depsgraph, _, film = at_frame(job, frame)
    wide = film.with_margin(margin_px)
    made = Passes(film, margin_px, job.path("front", frame))
    near = passes.hidden_before(job.scene, camera, depsgraph, split_m) if job.behind else []
    with passes.pinhole(job.scene, camera, wide, vectors=job.scene.render.use_motion_blur):
        passes.render_to(job.scene, made.front)
        if near and not job.cancelled():
            made.behind = job.path("behind", frame)
            with passes.without(near):
                passes.render_to(job.scene, made.behind)
    if job.cancelled():
        raise command.Cancelled()
    return made


def layer_words(scene):
    """Command-line words that select the first view layer in a file with several view layers."""
    return ["--layer", scene.view_layers[0].name] if len(scene.view_layers) > 1 else []


def focus_words(job, made, lens, output, moved=""):
    """Words of the focus command. `moved`: the front image after motion blur, which has a single layer and no depths or
    ids."""
    film, margin, layer = made.film, made.margin_px, layer_words(job.scene)
    words = ["focus", moved or made.front, "-o", output, *lens.options(), "--film-width", f"{film.width_mm:.9g}"]
    words += ["--film-distance", f"{film.distance_mm:.9g}", "--metres-per-unit", "1", "--z", "axial"]
    words += ["--overscan", str(margin), "--method", job.method]
    if job.method == "lightfield":
        words += ["--views", str(job.views)]
    if made.behind:
        words += ["--behind", made.behind]
    if not moved:
        return words + layer
    if made.behind and layer:
        words += ["--behind-layer", layer[1]]
    return words + ["--depth-file", made.front, "--ids-file", made.front]


def blur_motion(job, made, frame):
    """Applies motion blur to the front image by its motion vectors, before the lens is applied. Returns the path of the
    result."""
    shutter = job.scene.render.motion_blur_shutter
    # Blender's shutter interval is centred on the frame by default.
    begin = {"START": 0.0, "CENTER": -shutter / 2, "END": -shutter}[
        getattr(job.scene.cycles, "motion_blur_position", "CENTER") if hasattr(job.scene, "cycles") else "CENTER"
    ]
    smeared = job.path("moved", frame)
    words = ["motionblur", made.front, "-o", smeared, f"--shutter={begin:.9g}:{begin + shutter:.9g}"]
    said = command.run(job.program, words + layer_words(job.scene), job.cancelled)
    take_warnings(job, frame, said)
    return smeared


def take_warnings(job, frame, said):
    for warning in said.get("warnings", []):
        text = f"frame {frame}: {warning['text']}"
        if text not in job.warnings:
            job.warnings.append(text)


def focus_frames(job):
    """Makes the images and yields (frame, path) for each. Raises CameraError, CommandError, Cancelled, RuntimeError."""
    start = job.scene.frame_current
    try:
        margin, split = widest_margin(job), farthest_split(job)
        made = None
        for i, frame in enumerate(job.frames):
            job.progress(i / len(job.frames), f"frame {frame}")
            if made is None or not job.only_lens_changes:
                made = render_passes(job, frame, margin, split)
            _, _, lens, _ = at_frame(job, frame)
            output = job.path("focused", frame)
            moved = blur_motion(job, made, frame) if job.scene.render.use_motion_blur else ""
            said = command.run(job.program, focus_words(job, made, lens, output, moved), job.cancelled)
            take_warnings(job, frame, said)
            yield frame, output
        job.progress(1, "")
    finally:
        job.scene.frame_set(start)


def trace_frames(job):
    """Exports each frame as glTF, traces and focuses it with postlens, and yields (frame, path)."""
    start = job.scene.frame_current
    try:
        for i, frame in enumerate(job.frames):
            job.progress(i / len(job.frames), f"frame {frame}")
            _, _, lens, film = at_frame(job, frame)
            scene, records = job.path("scene", frame, ".glb"), job.path("records", frame)
            os.makedirs(job.folder, exist_ok=True)
            bpy.ops.export_scene.gltf(
                filepath=scene, export_cameras=True, export_lights=True, export_current_frame=True,
                export_animations=False, use_active_scene=True,
            )  # fmt: skip
            view = ["--size", f"{film.width_px}x{film.height_px}", "--film-width", f"{film.width_mm:.9g}"]
            view += ["--film-distance", f"{film.distance_mm:.9g}", "--camera", job.scene.camera.name]
            options = lens.options()
            words = ["trace", scene, "-o", records, *view, "--overscan", "auto"]
            words += ["--for-f-number", f"{lens.f_number:.9g}", "--for-focus", f"{lens.focus_m:.9g}"]
            take_warnings(job, frame, command.run(job.program, words, job.cancelled))
            output = job.path("traced", frame)
            method = ["--method", "hybrid", "--scene", scene]
            take_warnings(
                job, frame, command.run(job.program, ["focus", records, "-o", output, *options, *method], job.cancelled)
            )
            yield frame, output
        job.progress(1, "")
    finally:
        job.scene.frame_set(start)
