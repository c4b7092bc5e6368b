"""Makes focused images of a Blender scene. For each frame, renders the passes and runs the postlens commands."""

import contextlib
import math
import os
import time
from dataclasses import dataclass, field

import bpy

from . import camera as cameras
from . import command, export, passes
from .rendered import rendered

# Fraction of a frame's progress bar that one render takes. A frame is rendered as a whole and, if it has near objects,
# again without them, to show what is behind them.
RENDER_SHARE = 0.4
# Longest time, in seconds, for which the function `survey` works without a pause. It visits all frames before they are
# rendered, for example to find the margin that their lenses need. Meanwhile, Blender's window cannot respond. In the
# pauses, it can.
SURVEY_S = 0.1


@dataclass
class Job:
    """The frames of which images are made, and the settings of these images."""

    scene: object
    folder: str
    program: str
    frames: list
    subframe: float = 0  # of a single frame
    method: str = "layers"
    views: int = 256
    behind: bool = True
    behind_distance_m: float = 0  # 0: the distance at which blur becomes visible
    only_lens_changes: bool = False
    cancelled: object = lambda: False
    # True if Blender renders in a separate thread, so that its window stays responsive.
    in_window: bool = False
    progress: object = lambda share, text: None
    # For each warning, its text and the first frame in which it occurred. Instead of the frame, None is stored if the
    # warning concerns the whole scene.
    warnings: dict = field(default_factory=dict)

    def path(self, name, frame, ending=".exr"):
        return os.path.join(self.folder, f"{name}.{frame:04d}{ending}")

    def tell(self, frame, share, text):
        """Reports the completed share of a frame, and the current step."""
        i, count = self.frames.index(frame), len(self.frames)
        self.progress((i + share) / count, f"frame {frame} ({i + 1} of {count}): {text}")

    def run(self, frame, words):
        """Runs a command and keeps its warnings. This generator yields while the command runs."""
        # Runs postlens inside the folder of the output files, so that this folder's path can be removed from the file
        # names. Otherwise, postlens would interpret # and % in the path as placeholders for frame numbers.
        folder = os.path.join(self.folder, "")
        names = [word.removeprefix(folder) for word in words]
        said = yield from command.run(self.program, names, self.folder, self.cancelled)
        for warning in said.get("warnings", []):
            self.warn(warning["text"], frame)

    def warn(self, text, frame=None):
        self.warnings.setdefault(text, frame)

    def warning_lines(self):
        return [text if frame is None else f"frame {frame}: {text}" for text, frame in self.warnings.items()]

    def pause(self):
        """Lets Blender's window respond between two short steps. Raises Cancelled."""
        yield
        if self.cancelled():
            raise command.Cancelled()


@dataclass
class Passes:
    """The files that were rendered for a frame."""

    film: object
    margin_px: int
    front: str
    behind: str = ""


def exposure_of(scene):
    """Returns the middle of the exposure, relative to the time of the frame, and the duration of the exposure. Both are
    in frames. The duration is 0 without motion blur.

    Only Cycles writes motion vectors. Other engines apply motion blur to the image themselves."""
    if scene.render.engine != "CYCLES" or not scene.render.use_motion_blur:
        return 0.0, 0.0
    duration = scene.render.motion_blur_shutter
    return {"START": duration / 2, "CENTER": 0.0, "END": -duration / 2}[scene.cycles.motion_blur_position], duration


def at_frame(job, frame):
    """Sets the scene to the middle of a frame's exposure, because the depths at this instant are closest to those of
    the exposed image. Returns the camera, lens and film."""
    time_frames = frame + job.subframe + exposure_of(job.scene)[0]
    job.scene.frame_set(math.floor(time_frames), subframe=time_frames % 1)
    camera = job.scene.camera
    if camera is None:
        raise cameras.CameraError(f"scene {job.scene.name} has no camera")
    if camera.type != "CAMERA":
        raise cameras.CameraError(f"the scene's camera {camera.name} is a {camera.type.lower()} (expected a camera)")
    with bpy.context.temp_override(view_layer=passes.layer_of(job.scene)):
        depsgraph = bpy.context.evaluated_depsgraph_get()
    return camera, cameras.lens_of(camera, depsgraph), cameras.film_of(job.scene, camera)


def depths_now(job, camera):
    """Returns the depths of the objects that a render of the scene's current frame shows (passes.depths)."""
    return rendered(job.scene, lambda depsgraph: passes.depths(job.scene, camera, depsgraph))


def survey(job):
    """Returns the margin, in px, that suffices for the lenses of all frames, and the distance, in m, at which the scene
    is split.

    Objects nearer than that distance are left out of the second image. The distance is the largest over all frames.
    """
    margin, split, paused = 0, 0, time.monotonic()
    first = spans = None
    for frame in job.frames:
        camera, lens, film = at_frame(job, frame)
        view = cameras.view_of(job.scene, camera)
        first = first or view
        if job.only_lens_changes and view != first:
            name = next(name for name in view if view[name] != first[name])
            raise cameras.CameraError(
                f"frame {frame}: more than the lens changes (got {name} {view[name]}; expected {first[name]} as in the "
                "first frame)"
            )
        if spans is None or not job.only_lens_changes:
            spans = depths_now(job, camera)
        margin = max(margin, passes.margin_px(camera, spans, lens, film))
        split = max(split, lens.distance_in_front_m(passes.VISIBLE_RADIUS_PX, film))
        if time.monotonic() - paused > SURVEY_S:
            yield from job.pause()
            paused = time.monotonic()
    return margin, job.behind_distance_m or split


def render_passes(job, frame, margin_px, split_m):
    camera, _, film = at_frame(job, frame)
    wide = film.with_margin(margin_px)
    made = Passes(film, margin_px, job.path("front", frame))
    near = passes.hidden_before(depths_now(job, camera), split_m) if job.behind else []
    if near and job.scene.render.engine != "CYCLES":
        job.warn("what is behind is not rendered: only Cycles can hide objects from the camera alone")
        near = []

    def render(path, share, text):
        job.tell(frame, share, text)
        yield from passes.render_to(job.scene, path, job.in_window)
        yield from job.pause()

    _, exposure = exposure_of(job.scene)
    with passes.pinhole(job.scene, camera, wide, vectors=exposure > 0):
        yield from render(made.front, 0, "rendering")
        if near:
            made.behind = job.path("behind", frame)
            with passes.without(near):
                yield from render(made.behind, RENDER_SHARE, "rendering what is behind")
    return made


def focus_words(job, made, lens, output, moved=""):
    """Returns the arguments of the focus command. `moved` is the front image after motion blur, which has a single
    layer and neither depths nor ids."""
    film, margin = made.film, made.margin_px
    words = ["focus", moved or made.front, "-o", output, *lens.options(), "--film-width", f"{film.width_mm:.9g}"]
    words += ["--film-distance", f"{film.distance_mm:.9g}", "--metres-per-unit", "1", "--z", "axial"]
    words += ["--overscan", str(margin), "--method", job.method]
    if job.method == "lightfield":
        words += ["--views", str(job.views)]
    if made.behind:
        words += ["--behind", made.behind]
    if moved:
        words += ["--depth-file", made.front, "--ids-file", made.front]
    return words


def blur_motion(job, made, frame):
    """Applies motion blur to the front image by its motion vectors. This is done before the lens is applied. Returns
    the path of the result."""
    _, exposure = exposure_of(job.scene)
    smeared = job.path("moved", frame)
    words = ["motionblur", made.front, "-o", smeared, f"--shutter={-exposure / 2:.9g}:{exposure / 2:.9g}"]
    yield from job.run(frame, words)
    return smeared


@contextlib.contextmanager
def frame_kept(scene):
    """Restores the scene's current frame after the body."""
    start, subframe = scene.frame_current, scene.frame_subframe
    try:
        yield
    finally:
        with contextlib.suppress(ReferenceError):  # the scene was removed, as when another file is opened
            scene.frame_set(start, subframe=subframe)


def focus_frames(job):
    """Makes the images. This generator yields (frame, path) for each image, and None while a render or a command runs.

    Raises CameraError, CommandError, Cancelled, OSError and RuntimeError. If the generator is closed, the scene is
    restored.
    """
    with frame_kept(job.scene):
        margin, split = yield from survey(job)
        made = None
        for frame in job.frames:
            if made is None or not job.only_lens_changes:
                made = yield from render_passes(job, frame, margin, split)
            job.tell(frame, 2 * RENDER_SHARE, "applying the lens")
            _, lens, _ = at_frame(job, frame)
            output = job.path("focused", frame)
            moved = ""
            if exposure_of(job.scene)[1] > 0:
                moved = yield from blur_motion(job, made, frame)
            yield from job.run(frame, focus_words(job, made, lens, output, moved))
            yield frame, output
        job.progress(1, "")


def trace_frames(job):
    """Exports each frame as glTF, and traces and focuses it with postlens. This is a generator like focus_frames."""
    with frame_kept(job.scene):
        for frame in job.frames:
            job.tell(frame, 0, "exporting")
            yield from job.pause()
            camera, lens, film = at_frame(job, frame)
            shift = camera.data.shift_x, camera.data.shift_y
            if shift != (0, 0):
                raise cameras.CameraError(
                    f"camera {camera.name}: the lens is shifted, which glTF cannot state "
                    f"(got {shift[0]:g}, {shift[1]:g}; expected 0)"
                )
            if exposure_of(job.scene)[1] > 0:
                job.warn("motion blur is on, but a traced picture is of one instant")
            scene, records = job.path("scene", frame, ".glb"), job.path("records", frame)
            os.makedirs(job.folder, exist_ok=True)
            for text in export.export(job.scene, camera, scene):
                job.warn(text, frame)
            job.tell(frame, 0.1, "tracing")
            view = ["--size", f"{film.width_px}x{film.height_px}", "--film-width", f"{film.width_mm:.9g}"]
            view += ["--film-distance", f"{film.distance_mm:.9g}"]
            options = lens.options()
            words = ["trace", scene, "-o", records, *view, "--overscan", "auto"]
            words += ["--for-f-number", f"{lens.f_number:.9g}", "--for-focus", f"{lens.focus_m:.9g}", "--for-rays"]
            yield from job.run(frame, words)
            job.tell(frame, 0.5, "applying the lens")
            output = job.path("traced", frame)
            method = ["--method", "hybrid", "--scene", scene]
            yield from job.run(frame, ["focus", records, "-o", output, *options, *method])
            yield frame, output
        job.progress(1, "")
