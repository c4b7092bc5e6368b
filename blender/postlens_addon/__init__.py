"""The postlens add-on for Blender. Renders the scene through a pinhole, then applies the camera's lens and shutter."""

bl_info = {
    "name": "postlens",
    "author": "postlens",
    "version": (0, 9, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Render > postlens",
    "description": "Depth of field and motion blur after the render, with the camera's own lens",
    "category": "Render",
}

from . import operators, panel, settings  # noqa: E402  (Blender reads bl_info from the file's beginning)


def register():
    settings.register()
    operators.register()
    panel.register()


def unregister():
    panel.unregister()
    operators.unregister()
    settings.unregister()
