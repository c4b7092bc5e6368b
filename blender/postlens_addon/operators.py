"""The operators behind the panel's buttons: one image or a range of frames, rendered by Blender or by postlens."""

import contextlib
import time

import bpy
from bpy.props import BoolProperty

from . import camera as cameras
from . import command, pictures

IMAGE = "postlens"
FAILURES = (cameras.CameraError, command.CommandError, RuntimeError, OSError)
# Interval, in seconds, of the timer events at which Blender lets a running operator do the next part of its work.
TICK_S = 0.05
# Events that only move the view in Blender's window. They are passed to Blender while an operator computes images.
# Most others are blocked, because the operator temporarily changes the scene.
LOOKING = {"MOUSEMOVE", "INBETWEEN_MOUSEMOVE", "MIDDLEMOUSE", "WHEELUPMOUSE", "WHEELDOWNMOUSE", "TRACKPADPAN",
           "TRACKPADZOOM", "MOUSEROTATE", "MOUSESMARTZOOM", "WINDOW_DEACTIVATE"}  # fmt: skip
# Height of Blender's status bar, in px, at a resolution scale of 1.
STATUS_BAR_PX = 21


def folder_of(scene):
    """Returns the folder for the files. Raises CommandError if the folder is relative to a Blender file that was never
    saved."""
    folder = scene.postlens.folder
    if not folder:
        raise command.CommandError("no folder is set (expected where passes and pictures are written)")
    if folder.startswith("//") and not bpy.data.filepath:
        raise command.CommandError(
            f"folder {folder} is relative to the .blend file, which is not saved (save it, or choose another folder)"
        )
    return bpy.path.abspath(folder)


def job_of(scene, animation):
    s = scene.postlens
    frames = range(scene.frame_start, scene.frame_end + 1, scene.frame_step) if animation else [scene.frame_current]
    return pictures.Job(
        scene=scene,
        folder=folder_of(scene),
        program=command.find(bpy.path.abspath(s.program) if s.program else ""),
        frames=list(frames),
        subframe=0 if animation else scene.frame_subframe,
        method=s.method,
        views=s.views,
        behind=s.behind,
        behind_distance_m=s.behind_distance_m,
        only_lens_changes=animation and s.only_lens_changes,
    )


def is_harmless(context, event):
    """Returns whether an event leaves the scene unchanged. Such events move the view, or press the stop button of a
    render in the status bar."""
    if event.ctrl or event.alt or event.shift or event.oskey:
        return False
    height = STATUS_BAR_PX * context.preferences.system.ui_scale if context.screen.show_statusbar else 0
    return event.type in LOOKING or event.type == "LEFTMOUSE" and event.mouse_y < height


def areas(kind):
    return [a for w in bpy.context.window_manager.windows for a in w.screen.areas if a.type == kind]


def show(path, can_open=False):
    """Loads an image file and shows it in all image editors. Returns Blender's image.

    If no image editor is open and `can_open` is true, opens the view that Blender's preferences choose for renders.
    """
    # The property IMAGE marks the add-on's image, because a user's image may have the same name.
    image = next((i for i in bpy.data.images if i.get(IMAGE)), None)
    if image is None:
        image = bpy.data.images.load(path)
        image.name, image[IMAGE] = IMAGE, True
        image.use_view_as_render = True
    else:
        image.filepath = path
        image.reload()
    if can_open and not areas("IMAGE_EDITOR"):
        bpy.ops.render.view_show("INVOKE_DEFAULT")
    for area in areas("IMAGE_EDITOR"):
        area.spaces.active.image = image
    return image


def line_of(error):
    """The message of a failure, as one line."""
    if isinstance(error, OSError) and error.strerror:
        return ": ".join(str(part) for part in (error.filename, error.strerror) if part is not None)
    # The error message of a Blender operator ends with a location in Blender's code, which is omitted.
    lines = [line.strip().removeprefix("Error: ") for line in str(error).splitlines()]
    return next((s for s in reversed(lines) if s and not s.startswith("Location: ")), type(error).__name__)


class Pictures:
    """Base of both operators. In a window, a timer calls it to continue the work, so that the window stays
    responsive."""

    animation: BoolProperty(name="All frames", default=False, description="Every frame of the scene's range")

    running = None  # the operator that works in a window
    said = ""  # what that operator does at present

    @classmethod
    def poll(cls, context):
        if Pictures.running:
            cls.poll_message_set("postlens is at work already (Esc stops it)")
            return False
        if bpy.app.is_job_running("RENDER"):
            cls.poll_message_set("Blender is rendering (Esc stops it)")
            return False
        return True

    def begin(self, context, in_window):
        self.cancel_asked = False
        self.job, self.count = job_of(context.scene, self.animation), 0
        self.job.in_window = in_window
        self.job.cancelled = lambda: self.cancel_asked
        self.job.progress = self.tell
        self.made = self.make(self.job)
        context.window_manager.progress_begin(0, 100)

    def tell(self, share, text):
        text = "stopping" if self.cancel_asked else text
        said = f"postlens {100 * share:.0f} %: {text}"
        if not self.job.in_window or said == Pictures.said:
            return
        Pictures.said = said
        bpy.context.window_manager.progress_update(int(100 * share))
        self.workspace.status_text_set(f"{said}   (Esc stops)")
        for area in areas("PROPERTIES"):
            area.tag_redraw()

    def step(self):
        """Continues the work. Returns whether any work remains."""
        try:
            found = next(self.made)
        except StopIteration:
            return False
        if found:
            self.count += 1
            # Shows the finished image. Only the last image may open in a window of its own, because this window takes
            # the keyboard focus. After an earlier image, the user must still be able to stop the work with Esc.
            is_last = self.count == len(self.job.frames)
            show(found[1], can_open=self.job.in_window and is_last)
        return True

    def result(self):
        count = f"{self.count} of {len(self.job.frames)} pictures in {self.job.folder}"
        last = f", the last of frame {self.job.frames[self.count - 1]}" if self.count else ""
        return count + last

    def report_result(self, stopped):
        for text in self.job.warning_lines():
            self.report({"WARNING"}, text)
        self.report({"INFO"}, f"postlens{' was stopped' if stopped else ''}: {self.result()}")

    def execute(self, context):
        try:
            self.begin(context, in_window=False)
            while self.step():
                time.sleep(0.005)
        except FAILURES as error:
            self.report({"ERROR"}, line_of(error))
            return {"CANCELLED"}
        finally:
            context.window_manager.progress_end()
        self.report_result(stopped=False)
        return {"FINISHED"}

    def invoke(self, context, event):
        if bpy.app.background:
            return self.execute(context)
        try:
            self.begin(context, in_window=True)
        except FAILURES as error:
            self.report({"ERROR"}, line_of(error))
            return {"CANCELLED"}
        Pictures.running = self
        self.workspace, self.manager = context.workspace, context.window_manager
        self.timer = self.manager.event_timer_add(TICK_S, window=context.window)
        self.manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS":
            self.cancel_asked = True
        elif event.type != "TIMER":
            return {"PASS_THROUGH" if is_harmless(context, event) else "RUNNING_MODAL"}
        more = False
        try:
            more = self.step()
            if not more:
                self.report_result(stopped=False)
        except command.Cancelled:
            self.report_result(stopped=True)
            return {"CANCELLED"}
        except FAILURES as error:
            self.report({"ERROR"}, line_of(error))
            return {"CANCELLED"}
        finally:
            if not more:
                self.finish()
        # While work remains, Blender's timer event is passed on, because it may be meant for another operator.
        return {"PASS_THROUGH" if more else "FINISHED"}

    def finish(self):
        """Ends the work, and restores the window and the scene."""
        self.made.close()
        Pictures.running, Pictures.said = None, ""
        # If the user has closed the window, Blender has already removed the timer and the status text. Accessing them
        # then raises a ReferenceError, which is ignored.
        with contextlib.suppress(ReferenceError):
            self.manager.event_timer_remove(self.timer)
            self.manager.progress_end()
            self.workspace.status_text_set(None)
        for area in areas("PROPERTIES"):
            area.tag_redraw()

    def cancel(self, context):
        """Blender calls this when the window closes or another file is opened."""
        self.finish()


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
    if Pictures.running:
        Pictures.running.finish()
    for c in reversed(CLASSES):
        bpy.utils.unregister_class(c)
