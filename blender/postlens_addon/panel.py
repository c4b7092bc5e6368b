"""The panel in the render properties."""

import bpy

from . import operators


class POSTLENS_PT_render(bpy.types.Panel):
    bl_label = "postlens"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        scene, layout = context.scene, self.layout
        s = scene.postlens
        layout.use_property_split = True
        layout.prop(s, "method")
        if s.method == "lightfield":
            layout.prop(s, "views")
        layout.prop(s, "behind")
        row = layout.row()
        row.active = s.behind
        row.prop(s, "behind_distance_m")
        layout.prop(s, "only_lens_changes")
        layout.prop(s, "folder")
        layout.prop(s, "program")
        camera = scene.camera
        if camera is None or camera.type != "CAMERA":
            layout.label(text="The scene has no camera", icon="ERROR")
            return
        dof = camera.data.dof
        focus = dof.focus_object.name if dof.focus_object else f"{dof.focus_distance:.4g} m"
        layout.label(text=f"{camera.data.lens:.4g} mm, f/{dof.aperture_fstop:.3g}, focus {focus}", icon="CAMERA_DATA")
        for operator in ("postlens.focus", "postlens.trace"):
            row = layout.row(align=True)
            row.operator(operator).animation = False
            row.operator(operator, text="All frames").animation = True
        if operators.Pictures.running:
            layout.label(text=operators.Pictures.said or "postlens", icon="TIME")


def register():
    bpy.utils.register_class(POSTLENS_PT_render)


def unregister():
    bpy.utils.unregister_class(POSTLENS_PT_render)
