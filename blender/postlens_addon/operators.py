"""The operators behind the panel's buttons: one image or a range of frames, rendered by Blender or by postlens."""

import bpy
from bpy.props import BoolProperty

from . import camera as cameras
from . import command, pictures

IMAGE = "postlens"
FAILURES = (cameras.CameraError, command.CommandError, RuntimeError, OSError)


def job_of(scene, animation):
    s = scene.postlens
    frames = range(scene.frame_start, scene.frame_end + 1, scene.frame_step) if animation else [scene.frame_current]
    return pictures.Job(
        scene=scene,
        folder=bpy.path.abspath(s.folder),
        program=command.find(bpy.path.abspath(s.program) if s.program else ""),
        frames=list(frames),
        method=s.method,
        views=s.views,
        behind=s.behind,
        behind_distance_m=s.behind_distance_m,
        only_lens_changes=animation and s.only_lens_changes,
    )


def show(path):
    """Loads an image file and shows it in all image editors. Returns Blender's image."""
    image = bpy.data.images.get(IMAGE)
    if image is None:
        image = bpy.data.images.load(path)
        image.name = IMAGE
    else:
        image.filepath = path
        image.reload()
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "IMAGE_EDITOR":
                area.spaces.active.image = image
    return image


class Pictures:
    """Base class of both operators. Makes one image at a time, so that Blender stays responsive between images."""

    animation: BoolProperty(name="All frames", default=False, description="Every frame of the scene's range")

    def begin(self, context):
        self.cancel = False
        job = job_of(context.scene, self.animation)
        job.cancelled = lambda: self.cancel
        job.progress = lambda share, text: context.window_manager.progress_update(int(100 * share))
        self.job, self.made, self.count = job, self.make(job), 0

    def step(self):
        """Makes the next image. Returns true if more images follow."""
        try:
            _, path = next(self.made)
        except StopIteration:
            return False
        self.count += 1
        show(path)
        return True

    def end(self, context):
        context.window_manager.progress_end()
        for text in self.job.warnings:
            self.report({"WARNING"}, text)
        last = self.job.frames[self.count - 1] if self.count else None
        self.report({"INFO"}, f"postlens: {self.count} of {len(self.job.frames)} pictures in {self.job.folder}" +
                    (f", the last of frame {last}" if last is not None else ""))  # fmt: skip

    def execute(self, context):
        try:
            self.begin(context)
            context.window_manager.progress_begin(0, 100)
            while self.step():
                pass
        except FAILURES as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.end(context)
        return {"FINISHED"}

    def invoke(self, context, event):
        try:
            self.begin(context)
        except FAILURES as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        manager = context.window_manager
        manager.progress_begin(0, 100)
        self.timer = manager.event_timer_add(0.05, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self.cancel = True
        elif event.type != "TIMER":
            return {"PASS_THROUGH"}
        try:
            more = not self.cancel and self.step()
        except command.Cancelled:
            more = False
        except FAILURES as error:
            self.report({"ERROR"}, str(error))
            more = False
        if more:
            return {"RUNNING_MODAL"}
        context.window_manager.event_timer_remove(self.timer)
        self.made.close()  # restores the scene's current frame
        self.end(context)
        return {"CANCELLED" if self.cancel else "FINISHED"}


class POSTLENS_OT_focus(Pictures, bpy.types.Operator):
    """Render through a pinhole, then apply the camera's lens and shutter"""

    bl_idname = "postlens.focus"
    bl_label = "Render and focus"

    @staticmethod
    def make(job):
        return pictures.focus_frames(job)


class POSTLENS_OT_trace(Pictures, bpy.types.Operator):
    """Export the scene as glTF, and let postlens trace and focus it"""

    bl_idname = "postlens.trace"
    bl_label = "Export, trace and focus"

    @staticmethod
    def make(job):
        return pictures.trace_frames(job)


CLASSES = (POSTLENS_OT_focus, POSTLENS_OT_trace)


def register():
    for c in CLASSES:
        bpy.utils.register_class(c)


def unregister():
    for c in reversed(CLASSES):
        bpy.utils.unregister_class(c)
