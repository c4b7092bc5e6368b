"""Examines a scene as Blender renders it. The dependency graph of the viewport may have other modifiers, numbers of
particles, curve resolutions and hidden objects."""

import contextlib

import bpy

from .passes import kept, layer_of

# Name of Blender's render slot (place for a finished render) that this add-on uses for its own renders. So they do not
# replace the user's last render.
SLOT = "postlens"
SIZE_PX = 16  # the smallest that Blender renders
HANDLERS = ("render_init", "render_pre", "render_post", "render_complete", "render_cancel")


@contextlib.contextmanager
def unnoticed():
    """Within the body of the `with` statement, renders do not replace the image of an earlier render. They also do not
    call the user's render handlers, which may save or send images."""
    handlers = [getattr(bpy.app.handlers, name) for name in HANDLERS]
    before = [(functions, list(functions)) for functions in handlers]
    image = next((i for i in bpy.data.images if i.type == "RENDER_RESULT"), None)
    slots = image and image.render_slots
    shown = image and slots.active_index
    try:
        for functions in handlers:
            functions.clear()
        if image:
            if SLOT not in [slot.name for slot in slots]:
                slots.new(name=SLOT)
            slots.active_index = [slot.name for slot in slots].index(SLOT)
        yield
    finally:
        for functions, users in before:
            functions[:] = users
        if image:
            slots.active_index = shown
        else:
            bpy.data.batch_remove([i for i in bpy.data.images if i.type == "RENDER_RESULT"])


def rendered(scene, look):
    """Returns what `look` returns for the dependency graph of a render of the scene's current frame.

    Blender makes this graph only for render engines. Therefore, a temporary engine that renders nothing calls `look`.
    The engine is removed afterwards, so that it does not appear in the user's list of engines.
    """
    found, errors, render = [], [], scene.render

    class Engine(bpy.types.RenderEngine):
        bl_idname, bl_label = "POSTLENS_LOOK", "postlens"
        bl_use_custom_freestyle = True  # otherwise Blender would draw Freestyle lines

        def render(self, depsgraph):
            try:
                found.append(look(depsgraph))
            except Exception as error:  # Blender would print the error and continue
                errors.append(error)

    names = ("engine", "resolution_x", "resolution_y", "resolution_percentage", "use_compositing", "use_sequencer",
             "use_persistent_data")  # fmt: skip
    bpy.utils.register_class(Engine)
    try:
        with unnoticed(), kept((render, names)):
            render.engine = Engine.bl_idname
            render.resolution_x, render.resolution_y, render.resolution_percentage = SIZE_PX, SIZE_PX, 100
            render.use_compositing = render.use_sequencer = render.use_persistent_data = False
            bpy.ops.render.render(scene=scene.name, layer=layer_of(scene).name)
    finally:
        bpy.utils.unregister_class(Engine)
    if errors:
        raise errors[0]
    if not found:
        raise RuntimeError(f"Blender does not render scene {scene.name} (expected a render of its first view layer)")
    return found[0]
