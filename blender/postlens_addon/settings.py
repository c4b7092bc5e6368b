"""The settings of the add-on, which Blender stores with the scene."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty


class PostlensSettings(bpy.types.PropertyGroup):
    program: StringProperty(
        name="Program", subtype="FILE_PATH", description="The postlens command; empty: the one on the search path"
    )
    folder: StringProperty(
        name="Folder", subtype="DIR_PATH", default="//postlens", description="Where passes and pictures are written"
    )
    method: EnumProperty(
        name="Method",
        default="layers",
        items=[
            ("layers", "Layers", "Circles of confusion of every depth, composited with visibility"),
            ("lightfield", "Light field", "Views from points of the lens with a depth test: for intricate edges"),
            ("scatter", "Scatter", "Circles of confusion alone: the fastest, without visibility"),
        ],
    )
    views: IntProperty(name="Views", default=256, min=1, max=4096, description="Points of the lens")
    behind: BoolProperty(
        name="Render what is behind",
        default=True,
        description="A second render without the objects before the focus, which blurred edges let through",
    )
    behind_distance_m: FloatProperty(
        name="Nearer than",
        default=0,
        min=0,
        subtype="DISTANCE",
        description="Objects that end before this distance are left out of the second render; 0: those whose circles "
        "of confusion are a pixel or more in radius",
    )
    only_lens_changes: BoolProperty(
        name="Only the lens changes",
        default=False,
        description="In a range of frames: render the first one and take its passes for all, for pulls of focus and "
        "aperture in a still scene",
    )


def register():
    bpy.utils.register_class(PostlensSettings)
    bpy.types.Scene.postlens = PointerProperty(type=PostlensSettings)


def unregister():
    del bpy.types.Scene.postlens
    bpy.utils.unregister_class(PostlensSettings)
