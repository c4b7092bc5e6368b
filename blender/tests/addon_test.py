"""Tests the add-on in Blender without a window: images compared with Cycles' lens, cameras, restored settings,
failures.

    blender -b --factory-startup -noaudio --python-exit-code 1 -P addon_test.py -- POSTLENS [TEST...]
"""

import math
import os
import shutil
import sys
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from mathutils import Matrix, Vector  # noqa: E402

from blender_bench import Program, bars, box, boxes, by_cycles, bpy, folder, glowing, words  # noqa: E402

from postlens_addon import passes  # noqa: E402
from postlens_addon.rendered import rendered  # noqa: E402

program = Program(words()[0]) if words() else None


def all_settings(scene):
    """The values of all plain properties that the add-on may change during a render."""
    out = {}
    camera = scene.camera.data
    places = {"render": scene.render, "image": scene.render.image_settings, "camera": camera, "dof": camera.dof,
              "layer": scene.view_layers[0], "scene": scene}  # fmt: skip
    places |= {f"object {o.name}": o for o in scene.objects}
    places |= {f"modifier {m.name} of {o.name}": m for o in scene.objects for m in o.modifiers}
    places |= {f"collection {c.name}": c for c in bpy.data.collections}
    places |= {f"layer collection {c.name}": c for c in scene.view_layers[0].layer_collection.children}
    for name, place in places.items():
        for p in place.bl_rna.properties:
            if p.type in ("BOOLEAN", "INT", "FLOAT", "STRING", "ENUM") and not p.is_readonly:
                value = getattr(place, p.identifier)
                out[f"{name}.{p.identifier}"] = tuple(value) if getattr(p, "is_array", False) else value
    for o in scene.objects:
        out[f"object {o.name} in the viewport"] = o.mode, o.select_get(), o.hide_get()
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

    def boxes(self, spp=32, **lens):
        scene = boxes("160x90", spp, **lens)
        scene.postlens.program, scene.postlens.folder = program.path, self.folder
        return scene

    def truth(self, scene, spp=128):
        """Two halves of the scene's image by Cycles' own lens."""
        image = scene.render.image_settings
        with passes.kept((scene.cycles, ("samples", "seed")), (image, ("file_format",)), (scene.render, ("filepath",))):
            return [by_cycles(scene, self.path(f"half{i}.exr"), spp, i) for i in (1, 2)]

    def path(self, name):
        return os.path.join(self.folder, name)

    def fails(self, operator, *said):
        with self.assertRaises(RuntimeError) as caught:
            operator()
        # Blender adds the line of its own code that has called the operator.
        lines = [line for line in str(caught.exception).splitlines() if not line.startswith("Location: ")]
        self.assertEqual(len(lines), 1, lines)
        for text in said:
            self.assertIn(text, lines[0])

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

    def test_the_focus_bone_counts_as_in_cycles(self):
        from postlens_addon import camera as cameras

        scene = self.boxes(1)
        rig = bpy.data.objects.new("rig", bpy.data.armatures.new("rig"))
        scene.collection.objects.link(rig)
        bpy.context.view_layer.objects.active = rig
        bpy.ops.object.mode_set(mode="EDIT")
        bone = rig.data.edit_bones.new("bone")
        bone.head, bone.tail = (0, 0, -5), (0, 1, -5)
        bpy.ops.object.mode_set(mode="OBJECT")
        rig.location = (0, 0, 3.5)
        dof = scene.camera.data.dof
        dof.focus_object = rig
        for name, focus_m in (("bone", 1.5), ("", 3.5), ("no such bone", 3.5)):
            dof.focus_subtarget = name
            scene.frame_set(0)
            lens = cameras.lens_of(scene.camera, bpy.context.evaluated_depsgraph_get())
            self.assertAlmostEqual(lens.focus_m, focus_m, 5)

    def depths(self, scene):
        scene.frame_set(0)
        return rendered(scene, lambda depsgraph: passes.depths(scene, scene.camera, depsgraph))

    def hidden(self, scene):
        """Names of the objects that lie before 4 m."""
        return {o.name for o in passes.hidden_before(self.depths(scene), 4)}

    def test_the_scale_of_the_camera_has_no_effect(self):
        scene = self.boxes(1)
        posts = {f"post {i}" for i in range(5)}
        self.assertEqual(self.hidden(scene), posts)
        parent = bpy.data.objects.new("parent", None)
        scene.collection.objects.link(parent)
        scene.camera.parent = parent
        for scale in (0.1, 10):
            parent.scale = (scale, scale, scale)
            self.assertEqual(self.hidden(scene), posts)

    def test_instances_are_hidden_with_all_that_shows_them(self):
        scene = self.boxes(1)
        several = bpy.data.collections.new("several")
        several.objects.link(scene.objects["post 0"])
        instancer = bpy.data.objects.new("instancer", None)
        instancer.instance_type, instancer.instance_collection = "COLLECTION", several
        scene.collection.objects.link(instancer)
        self.assertLessEqual({"instancer", "post 0"}, self.hidden(scene))
        # An instance that is far away must not be hidden. The object of which the instance is made must not be hidden
        # either.
        instancer.location = (0, 0, -9)
        self.assertTrue({"instancer", "post 0"}.isdisjoint(self.hidden(scene)))
        scene.collection.objects.unlink(scene.objects["post 0"])
        instancer.location = (0, 0, 0)
        self.assertIn("instancer", self.hidden(scene))

    def test_what_is_behind_the_camera_is_not_near(self):
        scene = self.boxes(1)
        before = {o.name: span for o, span in self.depths(scene).items()}
        box(scene, "behind the camera", (0, 0, 5), (1, 1, 1), (1, 1, 1))
        self.assertEqual({o.name: span for o, span in self.depths(scene).items()}, before)
        for i in range(5):
            scene.objects[f"post {i}"].hide_render = True
        bpy.ops.postlens.focus()
        self.assertFalse(os.path.exists(self.path("behind.0000.exr")))

    def test_depths_are_those_of_the_rendered_layer(self):
        scene = self.boxes(1)
        row = scene.objects["post 0"].modifiers.new("row", "ARRAY")
        row.use_relative_offset, row.use_constant_offset, row.constant_offset_displace = False, True, (0, 0, -9)
        row.show_viewport = False
        self.assertEqual(self.hidden(scene), {f"post {i}" for i in range(1, 5)})
        near = bpy.data.collections.new("near")
        near.objects.link(scene.objects["post 1"])
        instancer = bpy.data.objects.new("instancer", None)
        instancer.instance_type, instancer.instance_collection = "COLLECTION", near
        place = bpy.data.collections.new("place")
        scene.collection.children.link(place)
        place.objects.link(instancer)
        scene.collection.objects.unlink(scene.objects["post 1"])
        other = scene.view_layers.new("other")
        for layer in (other, scene.view_layers[0]):
            for each in scene.view_layers:
                each.layer_collection.children["place"].exclude = each != layer
            bpy.context.window.view_layer = other
            self.assertEqual("instancer" in self.hidden(scene), layer != other)
        scene.objects["post 2"].hide_viewport = True
        scene.objects["post 3"].hide_render = True
        self.assertEqual(self.hidden(scene), {"instancer", "post 1", "post 2", "post 4"})

    def test_the_holdout_of_an_instance_stays_in_front(self):
        scene = self.boxes(16)
        scene.render.film_transparent = True
        several = bpy.data.collections.new("several")
        several.objects.link(scene.objects["post 2"])
        scene.collection.objects.unlink(scene.objects["post 2"])
        instancer = bpy.data.objects.new("instancer", None)
        instancer.instance_type, instancer.instance_collection = "COLLECTION", several
        held = bpy.data.collections.new("held")
        scene.collection.children.link(held)
        held.objects.link(instancer)
        scene.view_layers[0].layer_collection.children["held"].holdout = True
        self.assertEqual(self.hidden(scene), {"post 0", "post 1", "post 3", "post 4"})
        found, _ = program.psnr_db(self.focused("held"), self.truth(scene, 64))
        self.assertGreater(found, 22)

    def test_a_holdout_stays_in_front(self):
        # Holdouts of objects and of collections must not be omitted together with the objects in front of the focus
        # plane.
        scene = self.boxes(16)
        scene.render.film_transparent = True
        held = bpy.data.collections.new("held")
        scene.collection.children.link(held)
        held.objects.link(scene.objects["post 1"])
        scene.collection.objects.unlink(scene.objects["post 1"])
        scene.objects["post 2"].is_holdout = True
        scene.view_layers[0].layer_collection.children["held"].holdout = True
        self.assertEqual(self.hidden(scene), {"post 0", "post 3", "post 4"})
        found, _ = program.psnr_db(self.focused("held"), self.truth(scene, 64))
        self.assertGreater(found, 22)

    def test_the_larger_side_of_the_aperture_decides_what_is_behind(self):
        scene = self.boxes(16, f_number=4)
        scene.camera.data.dof.aperture_ratio = 0.2
        found, _ = program.psnr_db(self.focused("wide"), self.truth(scene))
        self.assertTrue(os.path.exists(self.path("behind.0000.exr")))
        self.assertGreater(found, 34)

    def test_everything_is_put_back(self):
        scene = self.scene("64x36", 1)
        image = scene.render.image_settings
        # Each file format has colour modes and depths of its own.
        for file_format, mode, depth in (("PNG", "RGBA", "8"), ("JPEG", "BW", "8"), ("PNG", "RGB", "16"), ("OPEN_EXR", "RGB", "16")):
            image.file_format, image.color_mode, image.color_depth = file_format, mode, depth
            image.color_management = "OVERRIDE" if mode == "RGB" else "FOLLOW_SCENE"
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

    def focused(self, name):
        """Renders and focuses the current frame. Returns the path of the image, which gets this name."""
        bpy.ops.postlens.focus()
        os.rename(self.path(f"focused.{bpy.context.scene.frame_current:04d}.exr"), self.path(name + ".exr"))
        return self.path(name + ".exr")

    def same(self, found, expected):
        psnr_db = program("compare", found, expected)["psnr_db"]
        self.assertTrue(psnr_db is None or psnr_db > 60, psnr_db)

    def test_a_scene_has_one_view_layer(self):
        # Blender calls the copy of a layer ViewLayer.001.
        scene = self.boxes(4)
        near = bpy.data.collections.new("near")
        scene.collection.children.link(near)
        near.objects.link(scene.objects["post 0"])
        scene.collection.objects.unlink(scene.objects["post 0"])
        scene.render.use_motion_blur = True
        alone = self.focused("alone")
        scene.view_layers[0].name = "ViewLayer"
        other = scene.view_layers.new("ViewLayer.001")
        other.material_override = glowing("other", (5, 0, 0))
        before = [(layer.use, layer.use_pass_z) for layer in scene.view_layers]
        self.same(self.focused("first"), alone)
        self.assertEqual([(layer.use, layer.use_pass_z) for layer in scene.view_layers], before)
        scene.view_layers[0].material_override, other.material_override = other.material_override, None
        scene.view_layers[0].use = False
        self.same(self.focused("second"), alone)
        # The tracer uses that layer, too, whatever layer the window shows.
        for layer in scene.view_layers:
            layer.layer_collection.children["near"].exclude = layer != other
        for shown in scene.view_layers:
            bpy.context.window.view_layer = shown
            bpy.ops.postlens.trace()
            self.assertIn("post 0", program("info", self.path("records.0000.exr"))["ids"].values())
            self.assertEqual(bpy.context.window.view_layer, shown)

    def test_the_scenes_own_output_changes_nothing(self):
        scene = self.boxes(4)
        alone = self.focused("alone")
        image = scene.render.image_settings
        image.file_format, image.color_management = "OPEN_EXR", "OVERRIDE"
        image.linear_colorspace_settings.name = "XYZ"
        scene.render.use_stamp = True
        self.same(self.focused("settings"), alone)
        self.assertEqual((image.color_management, image.linear_colorspace_settings.name), ("OVERRIDE", "XYZ"))
        scene.render.use_multiview = True
        self.fails(bpy.ops.postlens.focus, "several views")

    def test_an_animated_shift_is_that_of_the_frame(self):
        scene = self.boxes(4)
        camera = scene.camera.data
        camera.shift_x, camera.shift_y = 0.2, 0.1
        still = self.focused("still")
        camera.keyframe_insert("shift_x", frame=0)
        camera.driver_add("shift_y").driver.expression = "0.1"
        self.same(self.focused("animated"), still)
        animation = camera.animation_data
        curves = [*animation.action.fcurves, *animation.drivers]
        self.assertEqual([curve.mute for curve in curves], [False, False])
        action, animation.action = animation.action, None
        animation.nla_tracks.new().strips.new("strip", 0, action)
        self.same(self.focused("strip"), still)
        self.assertEqual([curve.mute for curve in curves], [False, False])

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

    def test_a_pull_of_focus_refuses_other_changes_of_the_camera(self):
        scene = self.boxes(1)
        scene.frame_start, scene.frame_end, scene.postlens.only_lens_changes = 0, 1, True
        camera = scene.camera.data

        def refused(*said):
            self.fails(lambda: bpy.ops.postlens.focus(animation=True), "frame 1: more than the lens changes", *said)

        for name, values, said in (("lens", (50, 80), "got focal length 80 mm; expected 50 mm"),
                                   ("lens", (50, 50.001), "got focal length 50.0009995 mm; expected 50 mm"),
                                   ("shift_x", (0, 0.5), "got shift 0.5, 0; expected 0, 0")):  # fmt: skip
            for frame, value in enumerate(values):
                setattr(camera, name, value)
                camera.keyframe_insert(name, frame=frame)
            refused(said)
            camera.animation_data_clear()
            setattr(camera, name, values[0])
        other = bpy.data.objects.new("other", camera.copy())
        scene.collection.objects.link(other)
        for frame, marked in enumerate((scene.camera, other)):
            scene.timeline_markers.new(marked.name, frame=frame).camera = marked
        refused("got camera other; expected camera as in the first frame")

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

    def test_the_shutter_opens_and_closes_as_in_cycles(self):
        # The camera moves past all objects. The whole image therefore shifts with the position of the exposure within
        # the frame.
        scene = self.boxes(32)
        camera = scene.camera
        for frame in (0, 2):
            camera.location.x = 0.1 * (frame - 1)
            camera.keyframe_insert("location", frame=frame)
        for key in camera.animation_data.action.fcurves[0].keyframe_points:
            key.interpolation = "LINEAR"
        scene.frame_set(1)
        scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 0.5
        for position in ("START", "CENTER", "END"):
            scene.cycles.motion_blur_position = position
            found, _ = program.psnr_db(self.focused(position), self.truth(scene, 64))
            self.assertGreater(found, 33, position)

    def test_a_part_of_a_frame_is_its_instant(self):
        scene = self.boxes(4)
        for frame in (0, 1):
            scene.camera.location.x = 0.4 * frame
            scene.camera.keyframe_insert("location", frame=frame)
        scene.frame_set(0, subframe=0.5)
        moving = self.focused("moving")
        self.assertEqual((scene.frame_current, scene.frame_subframe), (0, 0.5))
        scene.camera.animation_data_clear()
        scene.camera.location.x = 0.2
        self.same(moving, self.focused("still"))

    def test_the_image_has_the_view_of_a_render(self):
        scene = self.boxes(1)
        own = bpy.data.images.new("postlens", 8, 8)
        for _ in range(2):
            bpy.ops.postlens.focus()
        shown = [i for i in bpy.data.images if i.filepath]
        self.assertEqual([(i.size[0], i.use_view_as_render) for i in shown], [(160, True)])
        self.assertEqual(own.source, "GENERATED")

    def test_folders_have_any_name(self):
        scene = self.boxes(1)
        scene.postlens.folder = self.path("shot #2 %04d é") + "/"
        for operator, made in ((bpy.ops.postlens.focus, "focused"), (bpy.ops.postlens.trace, "traced")):
            operator()
            self.assertTrue(os.path.exists(os.path.join(scene.postlens.folder, made + ".0000.exr")))

    def test_the_tracer_of_postlens_sees_the_same_scene(self):
        scene = self.scene("96x54", 16)
        self.assertEqual(bpy.ops.postlens.trace(), {"FINISHED"})
        self.assertEqual(program("info", self.path("traced.0000.exr"))["width"], 96)

    def traces_as_cycles(self, scene, least_db=42):
        bpy.ops.postlens.trace()
        found, _ = program.psnr_db(self.path("traced.0000.exr"), self.truth(scene))
        self.assertGreater(found, least_db)

    def test_the_tracer_sees_what_a_render_shows(self):
        # Modifiers, shape keys, hidden objects, instances and materials of objects make the rendered scene differ from
        # the meshes in edit mode.
        scene = self.boxes(f_number=2)
        wide = scene.objects["box"]
        wide.shape_key_add(name="Basis")
        for corner in wide.shape_key_add(name="wide").data:
            corner.co.x *= 2
        wide.data.shape_keys.key_blocks["wide"].value = 1
        row = scene.objects["post 0"].modifiers.new("row", "ARRAY")
        row.count, row.relative_offset_displace = 3, (2, 0, 0)
        scene.objects["post 1"].hide_render = True
        scene.objects["post 2"].hide_viewport = True
        slot = scene.objects["post 3"].material_slots[0]
        slot.link, slot.material = "OBJECT", glowing("of the object", (0, 1, 0))
        unused = bpy.data.collections.new("unused")
        scene.collection.children.link(unused)
        unused.objects.link(box(scene, "unused", (0, 0, -2), (1, 1, 1), (1, 1, 1)))
        scene.collection.objects.unlink(bpy.data.objects["unused"])
        scene.view_layers[0].layer_collection.children["unused"].exclude = True
        several = bpy.data.collections.new("several")
        several.instance_offset = (0, 0, -3)
        several.objects.link(box(scene, "one", (0, 0, -3), (0.3, 0.3, 0.3), (1, 1, 0)))
        scene.collection.objects.unlink(bpy.data.objects["one"])
        bpy.data.objects["one"].rotation_euler = (0.3, 0.2, 0.5)
        instancer = bpy.data.objects.new("instancer", None)
        instancer.instance_type, instancer.instance_collection = "COLLECTION", several
        instancer.location, instancer.scale, instancer.rotation_euler = (-0.6, 0.3, -4), (2, 0.5, 1), (0, 0, 0.4)
        scene.collection.objects.link(instancer)
        for name in ("post 0", "post 1", "wall"):
            scene.objects[name].select_set(True)
        scene.objects["post 4"].hide_set(True)
        row = scene.objects["post 4"].modifiers.new("row", "ARRAY")
        row.show_viewport, row.relative_offset_displace = False, (3, 0, 0)
        ball = box(scene, "ball", (-0.3, 0, -5), (0.8, 0.8, 0.8), (0.2, 0.9, 0.2))
        round = ball.modifiers.new("round", "SUBSURF")
        round.levels, round.render_levels = 0, 3
        for name, hidden in (("eye", "hide_viewport"), ("not rendered", "hide_render")):
            collection = bpy.data.collections.new(name)
            scene.collection.children.link(collection)
            collection.objects.link(box(scene, "in " + name, (0.9, -0.5, -4), (0.3, 0.3, 0.3), (0, 1, 0)))
            scene.collection.objects.unlink(bpy.data.objects["in " + name])
            place = collection if hidden == "hide_render" else scene.view_layers[0].layer_collection.children[name]
            setattr(place, hidden, True)
        bpy.context.view_layer.update()
        kinds = bpy.data.objects, bpy.data.meshes, bpy.data.shape_keys, bpy.data.scenes
        counts, before = [len(kind) for kind in kinds], all_settings(scene)
        self.traces_as_cycles(scene)
        names = program("info", self.path("records.0000.exr"))["ids"].values()
        self.assertEqual(set(names), {"post 0", "post 2", "post 3", "post 4", "box", "wall", "one", "ball", "in eye"})
        self.assertEqual(all_settings(scene), before)
        self.assertEqual([len(kind) for kind in kinds], counts)

    def test_the_tracer_sees_the_resolutions_of_a_render(self):
        from postlens_addon import export

        scene = self.boxes(1)
        hairs = scene.objects["wall"]
        hairs.modifiers.new("hairs", "PARTICLE_SYSTEM")
        hairs = hairs.particle_systems[0].settings
        hairs.type, hairs.count, hairs.use_advanced_hair = "HAIR", 50, True
        hairs.render_type, hairs.instance_object = "OBJECT", scene.objects["post 0"]
        curve = bpy.data.curves.new("curve", "CURVE")
        curve.splines.new("BEZIER").bezier_points.add(1)
        curve.splines[0].bezier_points[1].co, curve.dimensions = (1, 0, 0), "3D"
        curve.bevel_depth, curve.render_resolution_u = 0.05, 12
        ball = bpy.data.metaballs.new("ball")
        ball.elements.new()
        ball.render_resolution = 0.2
        for data in (curve, ball):
            scene.collection.objects.link(bpy.data.objects.new(data.name, data))
        smooth = scene.objects["box"].modifiers.new("smooth", "SUBSURF")
        smooth.levels = smooth.render_levels = 3
        scene.render.use_simplify = True
        found = []
        for hairs.display_percentage, curve.resolution_u, ball.resolution, scene.render.simplify_subdivision in (
            (10, 1, 1, 0), (100, 12, 0.2, 6)):  # fmt: skip
            export.export(scene, scene.camera, self.path("scene.glb"))
            said = program("info", self.path("scene.glb"))
            found.append((said["objects"], said["triangles"]))
        self.assertEqual(found[0], found[1])

    def test_the_tracer_sees_what_is_edited(self):
        scene = self.boxes(f_number=2)
        edited = [scene.objects["post 1"], scene.objects["post 2"]]
        row = edited[1].modifiers.new("row", "ARRAY")
        row.show_in_editmode, row.relative_offset_displace = False, (3, 0, 0)
        for o in edited:
            o.select_set(True)
        bpy.context.view_layer.objects.active = edited[1]
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.transform.translate(value=(0.1, 0.5, 0))
        edited[0].select_set(False)
        before = all_settings(scene)
        bpy.ops.postlens.trace()
        self.assertEqual(all_settings(scene), before)
        self.assertEqual([o.mode for o in edited], ["EDIT", "EDIT"])
        found, _ = program.psnr_db(self.path("traced.0000.exr"), self.truth(scene))
        self.assertGreater(found, 42)

    def test_a_trace_leaves_renders_alone(self):
        scene = self.boxes(1)
        scene.use_nodes, scene.view_layers[0].use_pass_cryptomatte_object = True, True
        nodes, links = scene.node_tree.nodes, scene.node_tree.links
        layers, output = (next(n for n in nodes if n.type == kind) for kind in ("R_LAYERS", "COMPOSITE"))
        links.new(layers.outputs["CryptoObject00"], output.inputs[0])
        called, saved = [], [self.path("before.png"), self.path("after.png")]
        bpy.ops.render.render(scene=scene.name)
        shown = next(i for i in bpy.data.images if i.type == "RENDER_RESULT")
        shown.render_slots.active_index = 2
        bpy.ops.render.render(scene=scene.name)
        handlers = [getattr(bpy.app.handlers, "render_" + name) for name in ("init", "pre", "post", "complete")]
        for functions in handlers:
            functions.append(lambda *_: called.append(True))
        try:
            for path in saved:
                shown.save_render(path)
                bpy.ops.postlens.trace()
            self.assertEqual(called, [])
            bpy.ops.render.render(scene=scene.name)
            self.assertEqual(len(called), 4)
        finally:
            for functions in handlers:
                functions.clear()
        self.same(*saved)
        self.assertEqual(shown.render_slots.active_index, 2)
        self.assertEqual([link.from_socket.name for link in links], ["CryptoObject00"])
        kinds = [kind.bl_idname for kind in bpy.types.RenderEngine.__subclasses__() if kind.is_registered]
        self.assertNotIn("POSTLENS_LOOK", kinds)

    def test_the_tracer_sees_bones_text_and_generated_instances(self):
        scene = self.boxes(f_number=2)
        text = bpy.data.curves.new("text", "FONT")
        text.body, text.extrude = "A", 0.05
        text.materials.append(glowing("text", (1, 1, 0)))
        shown = bpy.data.objects.new("text", text)
        shown.location = (-1, 0.2, -5)
        scene.collection.objects.link(shown)
        bones = bpy.data.armatures.new("bones")
        rig = bpy.data.objects.new("rig", bones)
        scene.collection.objects.link(rig)
        bpy.context.view_layer.objects.active = rig
        bpy.ops.object.mode_set(mode="EDIT")
        bone = bones.edit_bones.new("bone")
        bone.tail = (0, 1, 0)
        bpy.ops.object.mode_set(mode="OBJECT")
        moved = scene.objects["box"]
        moved.vertex_groups.new(name="bone").add(range(8), 1, "REPLACE")
        moved.modifiers.new("rig", "ARMATURE").object = rig
        rig.pose.bones["bone"].location = (-0.5, 0.3, 0)
        cubes = bpy.data.node_groups.new("cubes", "GeometryNodeTree")
        cubes.inputs.new("NodeSocketGeometry", "Geometry")
        cubes.outputs.new("NodeSocketGeometry", "Geometry")
        nodes = [cubes.nodes.new(kind) for kind in ("NodeGroupInput", "GeometryNodeMeshCube", "GeometryNodeSetMaterial",
                                                    "GeometryNodeInstanceOnPoints", "NodeGroupOutput")]  # fmt: skip
        given, cube, painted, placed, result = nodes
        cube.inputs[0].default_value = (0.2, 0.4, 0.1)
        painted.inputs["Material"].default_value = glowing("painted", (0, 1, 1))
        for source, target in ((given, placed.inputs["Points"]), (cube, painted.inputs[0]),
                               (painted, placed.inputs["Instance"]), (placed, result.inputs[0])):  # fmt: skip
            cubes.links.new(source.outputs[0], target)
        scene.objects["post 2"].modifiers.new("cubes", "NODES").node_group = cubes
        bpy.context.view_layer.objects.active = scene.objects["post 4"]
        bpy.ops.object.mode_set(mode="EDIT")
        self.traces_as_cycles(scene)
        self.assertEqual(scene.objects["post 4"].mode, "EDIT")

    def test_the_tracer_sees_the_material_of_the_layer(self):
        scene = self.boxes(f_number=2)
        scene.objects["post 2"].data.materials.clear()
        scene.objects["box"].data.materials.append(glowing("second", (1, 1, 1)))
        scene.objects["box"].data.polygons[0].material_index = 1
        scene.view_layers[0].material_override = glowing("of the layer", (0, 0.6, 0.2))
        bpy.ops.postlens.trace()
        self.same(self.path("traced.0000.exr"), self.truth(scene, 1)[0])

    def test_the_tracer_says_what_gltf_lacks(self):
        from postlens_addon import export

        scene = self.boxes(spp=1)
        lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "AREA"))
        scene.collection.objects.link(lamp)
        scene.objects["post 1"].visible_camera = False
        reflected = bpy.data.collections.new("reflected")
        scene.collection.children.link(reflected)
        reflected.objects.link(scene.objects["post 2"])
        scene.collection.objects.unlink(scene.objects["post 2"])
        scene.view_layers[0].layer_collection.children["reflected"].indirect_only = True
        scene.objects["post 3"].is_holdout = True
        held = bpy.data.collections.new("held")
        scene.collection.children.link(held)
        held.objects.link(scene.objects["post 4"])
        scene.collection.objects.unlink(scene.objects["post 4"])
        scene.view_layers[0].layer_collection.children["held"].holdout = True
        for name, kind, drawn in (("fur", "HAIR", "PATH"), ("dust", "EMITTER", "HALO"), ("unused", "HAIR", "PATH")):
            modifier = scene.objects["wall"].modifiers.new(name, "PARTICLE_SYSTEM")
            modifier.particle_system.settings.type, modifier.particle_system.settings.render_type = kind, drawn
            modifier.particle_system.name, modifier.show_render = name, name != "unused"
        said = export.export(scene, scene.camera, self.path("scene.glb"))
        hidden = "is left out: it is hidden from the camera's rays alone"
        solid = "is traced as it looks: glTF has no holdouts"
        self.assertEqual(
            set(said), {"lamp is left out: glTF has no area lights", f"post 1 {hidden}", f"post 2 {hidden}",
                        f"post 3 {solid}", f"post 4 {solid}", "fur of wall is left out: glTF has no hair"}
        )  # fmt: skip
        self.assertEqual(program("info", self.path("scene.glb"))["objects"], 5)
        scene.camera.data.shift_x = 0.1
        self.fails(bpy.ops.postlens.trace, "shifted", "0.1, 0")

    def test_a_warning_is_given_once(self):
        from postlens_addon import operators, pictures

        scene = self.boxes(1)
        scene.collection.objects.link(bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "AREA")))
        scene.frame_start, scene.frame_end, scene.render.use_motion_blur = 1, 3, True
        job = operators.job_of(scene, animation=True)
        for _ in pictures.trace_frames(job):
            pass
        found = [line for line in job.warning_lines() if "no light in the scene" not in line]
        self.assertEqual(
            found, ["motion blur is on, but a traced picture is of one instant",
                    "frame 1: lamp is left out: glTF has no area lights"]
        )  # fmt: skip

    def test_the_tracer_removes_its_copy_of_many_objects_at_once(self):
        from postlens_addon import export

        scene = self.boxes(1)
        copy, mesh = export.Copy(scene.view_layers[0]), scene.objects["box"].data
        begun = time.monotonic()
        for i in range(3000):
            copy.add(f"copy {i}", mesh, Matrix())
        added = time.monotonic()
        copy.remove()
        self.assertLess(time.monotonic() - added, 10 * (added - begun))
        self.assertEqual([o.name for o in bpy.data.objects if o.name.startswith("copy")], [])

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
        scene.postlens.program = shutil.which("true")
        self.fails(bpy.ops.postlens.focus, "true is not postlens")
        scene.postlens.program = self.path("latin1")
        with open(self.path("latin1"), "w") as script:
            script.write("#!/bin/sh\nprintf 'caf\\351.exr: cannot read\\n' >&2\nexit 3\n")
        os.chmod(self.path("latin1"), 0o700)
        self.fails(bpy.ops.postlens.focus, ".exr: cannot read")
        scene.postlens.program, scene.postlens.folder = program.path, ""
        self.fails(bpy.ops.postlens.focus, "no folder")
        scene.postlens.folder = self.folder
        os.mkdir(self.path("scene.0000.glb"))
        self.fails(bpy.ops.postlens.trace, "scene.0000.glb")
        scene.camera = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "POINT"))
        self.fails(bpy.ops.postlens.focus, "lamp is a light")
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
