"""One test of the add-on in Blender's window: the panel, progress, Esc, a second start, failures, an image editor.

    xvfb-run -a blender --factory-startup -noaudio -P window_test.py -- POSTLENS LOG PICTURES TEST

Blender's event loop must go on during a test, so a test is a generator: it yields conditions, and goes on when they
hold. Keys come from xdotool, because a simulated event of Blender does not stop its renders. LOG is the file that
Blender writes its output to. Screenshots go to the folder PICTURES; they are left out if it is empty.
"""

import contextlib
import os
import re
import signal
import subprocess
import sys
import time
import traceback
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from addon_test import all_settings  # noqa: E402
from blender_bench import Program, bars, boxes, bpy, folder, glowing, words  # noqa: E402

TICK_S = 0.02
# Samples of a render, and views of a light field, that take minutes.
ENDLESS_SPP, ENDLESS_VIEWS = 1000000, 4096
# Longest waits on a busy machine, in seconds: for a condition that a test needs, and for one that must be met soon.
PATIENCE_S, SOON_S = 300, 30


def children():
    """The running commands that Blender has started: their process numbers."""
    out = []
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat") as file:
                state, parent = file.read().rsplit(")", 1)[1].split()[:2]
        except OSError:
            continue
        if int(parent) == os.getpid() and state != "Z":
            with open(f"/proc/{name}/comm") as file:
                if file.read().startswith("postlens"):
                    out.append(int(name))
    return out


def rendering():
    return bpy.app.is_job_running("RENDER")


def window():
    return bpy.context.window_manager.windows[0]


def areas(kind):
    return [a for w in bpy.context.window_manager.windows for a in w.screen.areas if a.type == kind]


def without_render(test):
    """Marks a test in which Blender does not render, so that timers of bpy.app may drive it."""
    test.without_render = True
    return test


class Window(unittest.TestCase):
    program = None
    pictures = ""
    log = ""

    def setUp(self):
        self.scratch = folder()
        self.folder = self.scratch.name
        self.ticks = {"wait": 0, "render": 0, "command": 0}
        self.seen = []  # what the running operator said, in order

    def tearDown(self):
        self.scratch.cleanup()

    def tick(self):
        """Is called while a test waits."""
        running = self.operators.Pictures
        if running.running and running.said and running.said not in self.seen[-1:]:
            self.seen.append(running.said)
        self.ticks["wait"] += 1
        self.ticks["render"] += rendering()
        self.ticks["command"] += bool(children())

    def scene(self, size="240x135", spp=1, frames=1, make=bars):
        scene = make(size, spp)
        from postlens_addon import operators

        self.operators = operators
        scene.postlens.program, scene.postlens.folder = self.program.path, self.folder
        scene.frame_start, scene.frame_end = 1, frames
        self.area("PROPERTIES").spaces.active.context = "RENDER"
        return scene

    def area(self, kind):
        return areas(kind)[0]

    def start(self, operator="focus", **properties):
        """Starts an operator as a button of the panel does."""
        with bpy.context.temp_override(window=window(), area=self.area("PROPERTIES")):
            return getattr(bpy.ops.postlens, operator)("INVOKE_DEFAULT", **properties)

    def ended(self):
        return self.operators.Pictures.running is None

    def press(self, key):
        subprocess.run(["xdotool", "mousemove", "600", "300", "key", key], check=True, timeout=SOON_S)

    def stopped_soon(self):
        """Presses Esc, and waits until the operator has ended."""
        self.press("Escape")
        asked = time.monotonic()
        yield self.ended
        self.assertLess(time.monotonic() - asked, SOON_S)
        self.assertEqual(children(), [])
        self.assertFalse(rendering())

    def reports(self):
        """The lines of Blender's report list, which the Info editor shows."""
        area = self.area("OUTLINER")
        before = area.type
        area.type = "INFO"
        with bpy.context.temp_override(window=window(), area=area, region=area.regions[-1]):
            bpy.ops.info.select_all(action="SELECT")
            bpy.ops.info.report_copy()
        area.type = before
        return bpy.context.window_manager.clipboard.splitlines()

    @contextlib.contextmanager
    def open_panel(self):
        """Opens the panel in the body, as a closed panel is not drawn. Gives a list that grows when it is drawn."""
        from postlens_addon import panel

        kind, drawn = panel.POSTLENS_PT_render, []
        bpy.utils.unregister_class(kind)
        options, draw = kind.bl_options, kind.draw
        kind.bl_options, kind.draw = set(), lambda panel, context: drawn.append(draw(panel, context))
        bpy.utils.register_class(kind)
        try:
            yield drawn
        finally:
            kind.bl_options, kind.draw = options, draw

    def scroll_down(self):
        """Scrolls to the end of the render properties, where the panel is."""
        for area in areas("PROPERTIES"):
            region = next(r for r in area.regions if r.type == "WINDOW")
            with bpy.context.temp_override(window=window(), area=area, region=region):
                for _ in range(4):
                    bpy.ops.view2d.scroll_down(page=True)

    def screenshot(self, name):
        if self.pictures:
            with bpy.context.temp_override(window=window(), area=self.area("PROPERTIES")):
                bpy.ops.screen.screenshot(filepath=os.path.join(self.pictures, name + ".png"))

    def made(self, beginning=""):
        return sorted(n for n in os.listdir(self.folder) if n.startswith(beginning))

    @without_render
    def test_the_panel_is_drawn(self):
        scene = self.scene()
        with self.open_panel() as drawn:
            for method, camera in (("layers", scene.camera), ("lightfield", scene.camera), ("scatter", None)):
                drawn.clear()
                scene.postlens.method, scene.camera = method, camera
                self.area("PROPERTIES").tag_redraw()
                yield lambda: drawn
                self.scroll_down()
                yield lambda: True
                self.screenshot("panel_" + method)

    def test_the_window_responds_and_shows_progress_and_result(self):
        scene = self.scene("320x180", 16, frames=2)
        scene.postlens.method, scene.postlens.views = "lightfield", 1024
        with bpy.context.temp_override(window=window(), area=self.area("VIEW_3D")):
            bpy.ops.screen.area_split(direction="VERTICAL", factor=0.7)
        left, right = sorted(areas("VIEW_3D"), key=lambda area: area.x)
        left.type, right.type = "IMAGE_EDITOR", "PROPERTIES"
        # A properties editor has no contexts before it is drawn.
        yield lambda: self.ticks["wait"] > 3
        right.spaces.active.context = "RENDER"
        before = all_settings(scene)
        with self.open_panel() as drawn:
            self.assertEqual(self.start(animation=True), {"RUNNING_MODAL"})
            yield lambda: self.ticks["render"] > 5 and drawn
            self.scroll_down()
            yield lambda: "frame 2" in self.seen[-1] and self.ticks["render"] > 10
            self.assertEqual(left.spaces.active.image.name, "postlens")
            self.screenshot("working")
            yield self.ended
        self.assertGreater(self.ticks["command"], 5)
        shares = [int(text.split()[1]) for text in self.seen]
        self.assertEqual(shares, sorted(shares))
        self.assertGreater(len(set(shares)), 4, self.seen)
        for text in ("frame 1 (1 of 2): rendering", "rendering what is behind", "frame 2 (2 of 2): applying the lens"):
            self.assertTrue(any(text in said for said in self.seen), self.seen)
        image = left.spaces.active.image
        self.assertEqual((image.name, image.size[:]), ("postlens", (320, 180)))
        self.assertGreater(max(image.pixels[:4000]), 0)
        self.assertEqual(all_settings(scene), before)
        self.assertIn("2 of 2 pictures", self.reports()[-1])

    def test_a_trace_leaves_renders_and_edits_alone(self):
        scene = self.scene("64x36", frames=2)
        bpy.context.preferences.view.render_display_type = "NONE"
        with bpy.context.temp_override(window=window()):
            edited = [o for o in scene.objects if o.type == "MESH"][:2]
            for o in edited:
                o.select_set(True)
            bpy.context.view_layer.objects.active = edited[0]
            bpy.ops.object.mode_set(mode="EDIT")
            bpy.ops.render.render(scene=scene.name)
        edited[1].select_set(False)
        shown = next(i for i in bpy.data.images if i.type == "RENDER_RESULT")
        saved = [os.path.join(self.folder, name) for name in ("before.png", "after.png")]
        for path in saved:
            before = all_settings(scene)
            shown.save_render(path)
            self.start("trace", animation=True)
            yield self.ended
            self.assertEqual(all_settings(scene), before)
            self.assertEqual(self.made("traced"), ["traced.0001.exr", "traced.0002.exr"])
        self.assertTrue(self.program("compare", *saved)["identical"])
        self.assertEqual([o.mode for o in edited], ["EDIT", "EDIT"])

    @without_render
    def test_a_view_keeps_its_own_camera(self):
        scene = self.scene("64x36")
        own = bpy.data.objects.new("own", scene.camera.data)
        scene.collection.objects.link(own)
        space = self.area("VIEW_3D").spaces.active
        space.use_local_camera, space.camera = True, own
        self.start("trace")
        yield self.ended
        self.assertEqual((space.use_local_camera, space.camera), (True, own))

    def test_the_layer_of_the_window_is_not_rendered_alone(self):
        scene = self.scene("64x36", make=boxes)
        other = scene.view_layers.new("other")
        other.material_override = glowing("other", (5, 0, 0))
        pictures = []
        for scene.render.use_single_layer in (False, True):
            window().view_layer = other
            with bpy.context.temp_override(window=window()):
                self.assertEqual(bpy.ops.postlens.focus(), {"FINISHED"})
            pictures.append(os.path.join(self.folder, f"picture {len(pictures)}.exr"))
            os.rename(os.path.join(self.folder, "focused.0000.exr"), pictures[-1])
        self.assertTrue(self.program("compare", *pictures)["identical"])
        self.assertEqual((scene.render.use_single_layer, window().view_layer), (True, other))
        yield lambda: True

    def test_the_result_opens_an_image_editor(self):
        self.scene("64x36")
        self.assertEqual(areas("IMAGE_EDITOR"), [])
        self.start()
        yield self.ended
        self.assertEqual([a.spaces.active.image.name for a in areas("IMAGE_EDITOR")], ["postlens"])

    def test_escape_stops_a_render(self):
        scene = self.scene("240x135", ENDLESS_SPP)
        before = all_settings(scene)
        view = bpy.context.preferences.view.render_display_type
        self.start()
        yield lambda: self.ticks["render"] > 5
        yield from self.stopped_soon()
        self.assertEqual(self.made(), [])
        self.assertEqual(all_settings(scene), before)
        self.assertEqual(bpy.context.preferences.view.render_display_type, view)
        self.assertIn("was stopped: 0 of 1 pictures", self.reports()[-1])
        # Blender's next render must not be stopped as well.
        scene.cycles.samples = 1
        self.start()
        yield self.ended
        self.assertEqual(self.made("focused"), ["focused.0000.exr"])

    def test_escape_stops_a_command(self):
        scene = self.scene("480x270")
        scene.postlens.method, scene.postlens.views = "lightfield", ENDLESS_VIEWS
        before = all_settings(scene)
        self.start()
        yield children
        yield from self.stopped_soon()
        self.assertEqual(self.made(), ["behind.0000.exr", "front.0000.exr"])
        self.assertEqual(all_settings(scene), before)

    def test_escape_stops_the_tracer(self):
        scene = self.scene("1920x1080")
        before = all_settings(scene)
        self.start("trace")
        yield children
        yield from self.stopped_soon()
        self.assertEqual(self.made(), ["scene.0000.glb"])
        self.assertEqual(all_settings(scene), before)

    def test_escape_in_a_pull_of_focus_keeps_finished_frames(self):
        scene = self.scene("240x135", frames=40)
        scene.postlens.only_lens_changes = True
        for frame, focus_m in ((1, 3), (40, 12)):
            scene.camera.data.dof.focus_distance = focus_m
            scene.camera.data.dof.keyframe_insert("focus_distance", frame=frame)
        scene.frame_set(7)
        before = all_settings(scene)
        self.start(animation=True)
        yield lambda: len(self.made("focused")) > 2
        yield from self.stopped_soon()
        done = self.made("focused")
        self.assertEqual(done, [f"focused.{i + 1:04d}.exr" for i in range(len(done))])
        self.assertLess(len(done), 40)
        self.assertEqual([n for n in self.made() if n not in done], ["behind.0001.exr", "front.0001.exr"])
        for name in done:
            self.assertEqual(self.program("compare", *[os.path.join(self.folder, name)] * 2)["identical"], True)
        self.assertEqual(all_settings(scene), before)
        self.assertIn(f"was stopped: {len(done)} of 40 pictures", self.reports()[-1])

    def test_a_second_start_is_refused(self):
        scene = self.scene("240x135", ENDLESS_SPP)
        self.start()
        yield lambda: self.ticks["render"] > 5
        for operator in ("focus", "trace"):
            with self.assertRaises(RuntimeError) as caught:
                self.start(operator)
            self.assertIn("postlens is at work already (Esc stops it)", str(caught.exception))
        self.assertFalse(self.ended())
        # Keys that change the scene have no effect while it is prepared for a render.
        samples = scene.cycles.samples
        self.press("ctrl+z")
        self.press("F12")
        yield lambda: self.ticks["render"] > 20
        self.assertFalse(self.ended())
        self.assertEqual(scene.cycles.samples, samples)
        yield from self.stopped_soon()

    def test_a_start_during_a_render_of_blender_is_refused(self):
        scene = self.scene("240x135", ENDLESS_SPP)
        bpy.context.preferences.view.render_display_type = "NONE"
        with bpy.context.temp_override(window=window()):
            bpy.ops.render.render("INVOKE_DEFAULT")
        yield rendering
        with self.assertRaises(RuntimeError) as caught:
            self.start()
        self.assertIn("Blender is rendering", str(caught.exception))
        self.press("Escape")
        yield lambda: not rendering()
        self.assertEqual(scene.postlens.folder, self.folder)

    @without_render
    def test_failures_are_one_line(self):
        scene = self.scene("64x36")
        nowhere = os.path.join(self.folder, "file", "nowhere")
        open(os.path.dirname(nowhere), "w").close()
        begins = (
            ({"program": "/nowhere/postlens"}, "postlens is not installed (looked for /nowhere/postlens"),
            ({"folder": "//postlens"}, "folder //postlens is relative to the .blend file, which is not saved"),
        )
        later = (
            ({"folder": nowhere}, f"{nowhere}: Not a directory"),
            ({"program": "/bin/false"}, "postlens ended with code 1"),
        )
        before = all_settings(scene)
        for wrong, said in begins + later:
            right = {name: getattr(scene.postlens, name) for name in wrong}
            for name, value in wrong.items():
                setattr(scene.postlens, name, value)
            count = len(self.reports())
            if (wrong, said) in begins:
                with self.assertRaises(RuntimeError) as caught:
                    self.start("trace")
                self.assertIn(said, str(caught.exception))
                self.assertEqual(len(str(caught.exception).strip().splitlines()), 1)
            else:
                self.assertEqual(self.start("trace"), {"RUNNING_MODAL"})
                yield self.ended
                reports = self.reports()[count:]
                self.assertEqual([line for line in reports if said in line], reports[-1:], reports)
            for name, value in right.items():
                setattr(scene.postlens, name, value)
            self.assertEqual(all_settings(scene), before)

    @without_render
    def test_the_tracer_works_right_after_a_file_is_opened(self):
        # Right after a file is opened, the context has no window.
        scene = self.scene("64x36")
        self.assertIsNone(bpy.context.window)
        self.assertEqual(bpy.ops.postlens.trace(), {"FINISHED"})
        self.assertEqual((bpy.data.scenes[:], window().scene), ([scene], scene))
        yield lambda: True

    @without_render
    def test_another_file_ends_the_work(self):
        self.scene("1920x1080")
        self.start("trace")
        yield children
        bpy.ops.wm.read_factory_settings()
        self.assertTrue(self.ended())
        self.assertEqual(children(), [])
        self.assertEqual(self.made(), ["scene.0000.glb"])

    @without_render
    def test_closing_blender_ends_the_command(self):
        self.scene("1920x1080")
        self.start("trace")
        yield children
        # blender_window_test.sh looks for the command after Blender's end.
        print(f"command {children()[0]}", flush=True)
        bpy.ops.wm.quit_blender()
        yield lambda: False

    def test_switching_the_add_on_off_ends_the_work(self):
        scene = self.scene("480x270")
        scene.postlens.method, scene.postlens.views = "lightfield", ENDLESS_VIEWS
        before = all_settings(scene)
        self.start()
        yield children
        import postlens_addon

        postlens_addon.unregister()
        self.assertEqual(children(), [])
        postlens_addon.register()
        yield lambda: True
        self.assertEqual(all_settings(scene), before)


def exceptions():
    """Number of exceptions that Blender has printed, as for a panel that cannot be drawn."""
    sys.stdout.flush()
    with open(Window.log, errors="replace") as file:
        return len(re.findall(r"^(Traceback|\w+Error:)", file.read(), re.MULTILINE))


def steps():
    """Runs the test. A generator that yields between two checks of the condition for which the test waits. Returns an
    exit code."""
    name = words()[3]
    test, start, passed = Window(name), time.monotonic(), False
    test.setUp()
    try:
        for condition in getattr(test, name)():
            waits = time.monotonic()
            while True:
                yield
                test.tick()
                if condition():
                    break
                if time.monotonic() - waits > PATIENCE_S:
                    raise AssertionError(f"waited {PATIENCE_S} s in vain")
        passed = not exceptions()
    except Exception:
        traceback.print_exc()
    finally:
        for child in children():
            os.kill(child, signal.SIGKILL)
        test.tearDown()
    print(f"{name} ... {'ok' if passed else 'FAIL'} ({time.monotonic() - start:.1f} s)", flush=True)
    return 0 if passed else 1


class POSTLENS_OT_test(bpy.types.Operator):
    """Goes on with the test on a timer"""

    # In Blender 3.4 a panel that is drawn while a render begins can forbid timers of bpy.app to change anything from
    # then on. Operators are not affected.
    bl_idname = "postlens.test"
    bl_label = "Test"

    def invoke(self, context, event):
        context.window_manager.event_timer_add(TICK_S, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "TIMER":
            step()
        return {"PASS_THROUGH"}


def step():
    try:
        next(POSTLENS_OT_test.steps)
    except StopIteration as done:
        # A script cannot choose the exit code with which Blender quits.
        os._exit(done.value)


def begin():
    # The first step of a test loads a file. An operator does not survive this, so the first step runs without one.
    step()
    if getattr(getattr(Window, words()[3]), "without_render", False):
        bpy.app.timers.register(again, first_interval=TICK_S, persistent=True)
        return
    bpy.utils.register_class(POSTLENS_OT_test)
    with bpy.context.temp_override(window=window()):
        bpy.ops.postlens.test("INVOKE_DEFAULT")


def again():
    step()
    return TICK_S


if __name__ == "__main__":
    Window.program = Program(words()[0])
    Window.log, Window.pictures = words()[1:3]
    POSTLENS_OT_test.steps = steps()
    bpy.app.timers.register(begin, first_interval=1, persistent=True)
