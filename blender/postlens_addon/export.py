"""Exports the scene as Blender renders it to a glTF file: a mesh for every visible instance, with its modifiers, shape
keys and armatures applied. Blender's exporter alone would write the meshes as they are edited, hidden objects too."""

import contextlib
import json
import struct

import bpy
from mathutils import Matrix

from .passes import kept, layer_of

# Types of objects that a render shows and that glTF has no equivalent for.
LEFT_OUT = {"CURVES": "hair", "POINTCLOUD": "point clouds", "VOLUME": "volumes", "GPENCIL": "drawings"}
# Error of a matrix without its shear, relative to its largest scale, that is a matter of rounding.
SHEAR = 1e-5


def layer_collections(top):
    yield top
    for child in top.children:
        yield from layer_collections(child)


@contextlib.contextmanager
def seen_as_rendered(layer):
    """In the body, the viewport's dependency graph has the objects and modifiers of a render."""
    # Pairs of the viewport's properties and those of a render, which replace them.
    pairs = {
        bpy.types.Object: {"hide_viewport": "hide_render", "show_instancer_for_viewport": "show_instancer_for_render"},
        bpy.types.Collection: {"hide_viewport": "hide_render"},
        bpy.types.Modifier: {"show_viewport": "show_render", "levels": "render_levels"},
    }
    modifiers = [m for o in bpy.data.objects for m in o.modifiers]
    changes = [
        (thing, viewport, getattr(thing, rendered))
        for kind, names in pairs.items()
        for thing in (*bpy.data.objects, *bpy.data.collections, *modifiers)
        for viewport, rendered in names.items()
        if isinstance(thing, kind) and hasattr(thing, rendered)
    ]
    # The eyes of the outliner, which a render does not look at.
    changes += [(c, "hide_viewport", False) for c in layer_collections(layer.layer_collection)]
    hidden = [o for o in layer.objects if o.hide_get(view_layer=layer)]
    with kept(*((thing, (name,)) for thing, name, _ in changes)):
        try:
            for thing, name, value in changes:
                setattr(thing, name, value)
            for thing in hidden:
                thing.hide_set(False, view_layer=layer)
            yield
        finally:
            for thing in hidden:
                thing.hide_set(True, view_layer=layer)


@contextlib.contextmanager
def left_mode():
    """In the body, no object is edited. The evaluated mesh of an object in edit mode cannot be copied."""
    active = bpy.context.view_layer.objects.active
    mode = active.mode if active else "OBJECT"
    if mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    try:
        yield
    finally:
        if mode != "OBJECT":
            bpy.ops.object.mode_set(mode=mode)


class Copy:
    """A scene of plain meshes, lights and a camera. `names`: names of the objects, by the names of their copies."""

    def __init__(self, layer):
        self.layer, self.scene = layer, bpy.data.scenes.new("postlens")
        self.meshes, self.names, self.warnings = {}, {}, []

    def add(self, name, data, matrix):
        thing = bpy.data.objects.new(name, data)
        thing.matrix_world = matrix
        self.scene.collection.objects.link(thing)
        self.names[thing.name] = name

    def mesh_of(self, thing, key):
        """The mesh of an object. Objects that share their mesh and materials share the copy, too."""
        if key not in self.meshes:
            mesh = self.meshes[key] = thing.data.copy()
            # A material belongs to the mesh or to the object. The slots have both.
            for i, slot in enumerate(thing.material_slots):
                mesh.materials[i] = slot.material and slot.material.original
        return self.meshes[key]

    def add_shape(self, thing, matrix):
        key = (thing.data.as_pointer(), *(slot.material for slot in thing.material_slots))
        unsheared = Matrix.LocRotScale(*matrix.decompose())
        if max(abs(x) for row in matrix - unsheared for x in row) <= SHEAR * max(map(abs, matrix.to_scale())):
            self.add(thing.name, self.mesh_of(thing, key), matrix)
        else:  # A node of glTF cannot shear, so this mesh is sheared itself.
            mesh = self.mesh_of(thing, (*key, matrix.copy().freeze()))
            mesh.transform(matrix)
            self.add(thing.name, mesh, Matrix())

    def add_instance(self, instance):
        thing, kind = instance.object, instance.object.type
        if isinstance(thing.data, bpy.types.Mesh):
            owners = [o.original for o in (thing, instance.parent) if o]
            if not all(o.visible_camera and not o.indirect_only_get(view_layer=self.layer) for o in owners):
                self.warnings.append(f"{thing.name} is left out: it is hidden from the camera's rays alone")
            elif instance.show_self:
                self.add_shape(thing, instance.matrix_world)
        elif kind == "LIGHT" and thing.data.type == "AREA" or kind in LEFT_OUT:
            self.warnings.append(f"{thing.name} is left out: glTF has no {LEFT_OUT.get(kind, 'area lights')}")
        elif kind == "LIGHT":
            self.add(thing.name, thing.data.original, instance.matrix_world)

    def remove(self):
        meshes = set(self.meshes.values())
        # A copied mesh leaves the copy of its shape keys in the file. Each removal on its own would search the whole file
        # for users, and that of a scene needs a window.
        keys = [key for key in bpy.data.shape_keys if key.user in meshes]
        bpy.data.batch_remove([*self.scene.objects, *meshes, *keys, self.scene])


def rename_nodes(path, names):
    """Gives the nodes of a .glb file other names."""
    with open(path, "rb") as file:
        head, rest = file.read(20), file.read()
    size = struct.unpack_from("<I", head, 12)[0]
    said = json.loads(rest[:size])
    for node in said["nodes"]:
        node["name"] = names.get(node["name"], node["name"])
    text = json.dumps(said, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as file:
        file.write(struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest) - size, len(text), 0x4E4F534A))
        file.write(text + rest[size:])


def export(camera, path):
    """Writes what Blender renders of the current scene to a .glb file, with this camera alone. Returns a line for each
    object that is left out."""
    layer = layer_of(bpy.context.scene)
    # After a script has opened a file, the context has no window until Blender's next event.
    window = bpy.context.window or bpy.context.window_manager.windows[0]
    copy = Copy(layer)
    try:
        with left_mode(), seen_as_rendered(layer):
            with bpy.context.temp_override(view_layer=layer):
                depsgraph = bpy.context.evaluated_depsgraph_get()
            for instance in depsgraph.object_instances:
                copy.add_instance(instance)
            copy.add(camera.name, camera.data, camera.evaluated_get(depsgraph).matrix_world)
        with bpy.context.temp_override(window=window), kept((window, ("scene", "view_layer"))):
            window.scene = copy.scene
            bpy.ops.export_scene.gltf(
                filepath=path, export_cameras=True, export_lights=True, export_current_frame=True,
                export_animations=False, export_morph=False, export_skins=False, use_active_scene=True,
            )  # fmt: skip
    finally:
        copy.remove()
    rename_nodes(path, copy.names)
    return copy.warnings
