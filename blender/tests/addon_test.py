"""Tests the add-on in Blender without a window: images compared with Cycles' lens, cameras, restored settings,
failures.

    blender -b --factory-startup -noaudio --python-exit-code 1 -P addon_test.py -- POSTLENS [TEST...]
"""

import math
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from mathutils import Vector  # noqa: E402

from blender_bench import Program, bars, by_cycles, bpy, folder, words  # noqa: E402

program = Program(words()[0]) if words() else None


def all_settings(scene):
    """The values of all plain properties that the add-on may change during a render."""
    out = {}
    camera = scene.camera.data
    places = {"render": scene.render, "image": scene.render.image_settings, "camera": camera, "dof": camera.dof,
              "layer": scene.view_layers[0], "scene": scene}  # fmt: skip
    places |= {f"object {o.name}": o for o in scene.objects}
    for name, place in places.items():
        for p in place.bl_rna.properties:
            if p.type in ("BOOLEAN", "INT", "FLOAT", "STRING", "ENUM") and not p.is_readonly:
                value = getattr(place, p.identifier)
                out[f"{name}.{p.identifier}"] = tuple(value) if getattr(p, "is_array", False) else value
    return out


class Addon(unittest.TestCase):
    def setUp(self):
        self.scratch = folder()
        self.folder = self.scratch.name

    def tearDown(self):
        self.scratch.cleanup()

    def scene(self, size="240x135", spp=64, **lens):
        scene = bars(size, spp, **lens)
        scene.postlens.program, scene.postlens.folder = program.path, self.folder
        return scene

    def path(self, name):
        return os.path.join(self.folder, name)

    def fails(self, operator, *said):
        with self.assertRaises(RuntimeError) as caught:
            operator()
        for text in said:
            self.assertIn(text, str(caught.exception))

    def test_is_as_right_as_two_layers_allow(self):
        scene = self.scene("480x270")
        found = {}
        for name, behind in (("flat", False), ("two", True)):
            scene.postlens.behind = behind
            self.assertEqual(bpy.ops.postlens.focus(), {"FINISHED"})
            self.assertEqual(bpy.data.images["postlens"].size[:], (480, 270))
            os.rename(self.path("focused.0000.exr"), self.path(name + ".exr"))
        halves = [by_cycles(scene, self.path(f"half{i}.exr"), 128, i) for i in (1, 2)]
        for name in ("flat", "two"):
            found[name], noise = program.psnr_db(self.path(name + ".exr"), halves)
        self.assertGreater(noise, 36)
        self.assertGreater(found["two"], 36)
        self.assertGreater(found["two"], found["flat"] + 2)

    def test_blades_turn_and_squeeze_as_in_cycles(self):
        # The image of a small light source out of focus has the shape of the aperture. Behind the focus distance this
        # shape is upright.
        scene = self.scene("160x90", 64, f_number=0.25, focus_m=1.2)
        ball = next(o for o in scene.objects if o.name.startswith("light at 9 m"))
        for other in list(scene.objects):
            if other.type == "MESH" and other is not ball:
                bpy.data.objects.remove(other)
        ball.location = scene.camera.matrix_world @ Vector((0, 0, -9))
        ball.scale = (3, 3, 3)
        dof = scene.camera.data.dof
        dof.aperture_blades, dof.aperture_rotation, dof.aperture_ratio = 5, math.radians(10), 1.6
        halves = [by_cycles(scene, self.path(f"half{i}.exr"), 1024, i) for i in (1, 2)]
        found = {}
        for rotation, ratio in ((10, 1.6), (10 + 36, 1.6), (-10, 1.6), (10, 1 / 1.6)):
            dof.aperture_rotation, dof.aperture_ratio = math.radians(rotation), ratio
            bpy.ops.postlens.focus()
            said = program("compare", self.path("focused.0000.exr"), halves[0], "--noise", halves[1])
            found[rotation, ratio] = said["psnr_above_noise_db"]
        right = found.pop((10, 1.6))
        for other, psnr_db in found.items():
            self.assertGreater(right, psnr_db + 6, other)

    def test_films_are_those_of_blender(self):
        from postlens_addon import camera as cameras

        scene = self.scene("160x90", 1)
        data, render = scene.camera.data, scene.render
        for fit in ("AUTO", "HORIZONTAL", "VERTICAL"):
            for width, height in ((160, 90), (90, 160), (100, 100)):
                for percentage in (100, 50):
                    data.sensor_fit, data.sensor_width, data.sensor_height = fit, 36, 20
                    render.resolution_x, render.resolution_y = width, height
                    render.resolution_percentage = percentage
                    film = cameras.film_of(scene, scene.camera)
                    corners = data.view_frame(scene=scene)
                    tangent = max(c.x for c in corners) / -corners[0].z
                    self.assertAlmostEqual(film.width_mm / 2 / film.distance_mm, tangent, 5)
                    self.assertEqual(film.width_px, width * percentage // 100)
                    wide = film.with_margin(7)
                    self.assertAlmostEqual(wide.width_mm / wide.width_px, film.width_mm / film.width_px)

    def test_what_is_beyond_the_frame_is_the_same_view(self):
        # Tests a margin with a shifted sensor. The inner part of the pinhole image with the margin must equal the
        # pinhole image without it.
        from postlens_addon import camera as cameras
        from postlens_addon import passes

        scene = self.scene("96x54", 16)
        scene.camera.data.shift_x, scene.camera.data.shift_y = 0.1, -0.05
        film = cameras.film_of(scene, scene.camera)
        for name, margin in (("exact", 0), ("wide", 13)):
            with passes.pinhole(scene, scene.camera, film.with_margin(margin), vectors=False):
                for _ in passes.render_to(scene, self.path(name + ".exr")):
                    pass
        flat = ["--film-width", "36", "--focal-length", "50", "--method", "pinhole"]
        for name, margin in (("exact", 0), ("wide", 13)):
            program("focus", self.path(name + ".exr"), "-o", self.path(name + ".png"), *flat, "--overscan", str(margin))
        said = program("compare", self.path("wide.png"), self.path("exact.png"))
        self.assertGreater(said["psnr_db"], 24)  # 16 samples per pixel at other positions: the noise at edges is 1/8

    def test_the_focus_object_counts_along_the_axis(self):
        from postlens_addon import camera as cameras

        scene = self.scene("160x90", 1)
        target = bpy.data.objects.new("target", None)
        scene.collection.objects.link(target)
        scene.camera.data.dof.focus_object = target
        target.location = (1.5, 0.5, -3)
        bpy.context.view_layer.update()
        lens = cameras.lens_of(scene.camera, bpy.context.evaluated_depsgraph_get())
        camera = scene.camera.matrix_world
        self.assertAlmostEqual(lens.focus_m, -(camera.inverted() @ target.location).z, 5)

    def test_everything_is_put_back(self):
        scene = self.scene("64x36", 1)
        image = scene.render.image_settings
        # Each file format has colour modes and depths of its own.
        for file_format, mode, depth in (("PNG", "RGBA", "8"), ("JPEG", "BW", "8"), ("PNG", "RGB", "16"), ("OPEN_EXR", "RGB", "16")):
            image.file_format, image.color_mode, image.color_depth = file_format, mode, depth
            before = all_settings(scene)
            bpy.ops.postlens.focus()
            self.assertEqual(all_settings(scene), before)
        # The settings must be restored even if the render or the command fails.
        os.chmod(self.path("front.0000.exr"), 0o400)
        scene.postlens.folder = "/dev/null/nowhere"
        self.fails(bpy.ops.postlens.focus)
        scene.postlens.folder = self.folder
        after = all_settings(scene)
        self.assertEqual(after, before)

    def test_a_pull_of_focus_renders_a_still_scene_once(self):
        scene = self.scene("64x36", 1)
        scene.frame_start, scene.frame_end = 3, 5
        dof = scene.camera.data.dof
        for frame, focus in ((3, 2), (5, 20)):
            dof.focus_distance = focus
            dof.keyframe_insert("focus_distance", frame=frame)
        scene.postlens.only_lens_changes = True
        scene.frame_set(4)
        bpy.ops.postlens.focus(animation=True)
        made = sorted(os.listdir(self.folder))
        self.assertEqual([n for n in made if n.startswith("focused")], [f"focused.{i:04d}.exr" for i in (3, 4, 5)])
        self.assertEqual([n for n in made if n.startswith("front")], ["front.0003.exr"])
        self.assertEqual(scene.frame_current, 4)
        said = program("compare", self.path("focused.0003.exr"), self.path("focused.0005.exr"))
        self.assertLess(said["psnr_db"], 40)

    def test_motion_is_blurred_along_its_vectors(self):
        scene = self.scene("96x54", 4)
        camera = scene.camera
        scene.frame_start, scene.frame_end = 0, 2
        for frame in (0, 2):
            camera.location.x = 0.05 * frame
            camera.keyframe_insert("location", frame=frame)
        scene.frame_set(1)
        still = {}
        for moves in (False, True):
            scene.render.use_motion_blur = moves
            bpy.ops.postlens.focus()
            still[moves] = self.path(f"moves{moves}.exr")
            os.rename(self.path("focused.0001.exr"), still[moves])
        self.assertTrue(os.path.exists(self.path("moved.0001.exr")))
        self.assertLess(program("compare", still[True], still[False])["psnr_db"], 40)

    def test_the_tracer_of_postlens_sees_the_same_scene(self):
        scene = self.scene("96x54", 16)
        self.assertEqual(bpy.ops.postlens.trace(), {"FINISHED"})
        self.assertEqual(program("info", self.path("traced.0000.exr"))["width"], 96)

    def test_failures_are_one_line(self):
        scene = self.scene("64x36", 1)
        scene.camera.data.type = "ORTHO"
        self.fails(bpy.ops.postlens.focus, "ortho", "perspective")
        scene.camera.data.type = "PERSP"
        scene.camera.data.dof.focus_distance = 0
        self.fails(bpy.ops.postlens.focus, "focus distance 0 m")
        scene.camera.data.dof.focus_distance = 5
        scene.postlens.program = "/nowhere/postlens"
        self.fails(bpy.ops.postlens.focus, "/nowhere/postlens", "not installed")
        scene.postlens.program = program.path
        scene.camera = None
        self.fails(bpy.ops.postlens.focus, "no camera")

    def test_registers_again(self):
        import postlens_addon

        self.scene("64x36", 1)
        postlens_addon.unregister()
        self.assertFalse(hasattr(bpy.types.Scene, "postlens"))
        postlens_addon.register()


if __name__ == "__main__":
    if program is None:
        sys.exit("addon_test.py: no program (got nothing after --; expected the path of postlens)")
    suite = unittest.defaultTestLoader.loadTestsFromTestCase(Addon)
    if words()[1:]:
        suite = unittest.TestSuite(Addon(name) for name in words()[1:])
    result = unittest.TextTestRunner(verbosity=2).run(suite)
    sys.exit(0 if result.wasSuccessful() else 1)
