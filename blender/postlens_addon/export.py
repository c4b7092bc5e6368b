"""Exports the scene to a glTF file as Blender renders it. The file has a mesh for every visible instance, with its
modifiers, shape keys and armatures applied. By itself, Blender's exporter would write the meshes as they are in edit
mode, and would include hidden objects."""

import json
import struct

import bpy
from mathutils import Matrix

from .passes import is_holdout, kept, layer_of
from .rendered import rendered

# Types of objects that Blender renders, but glTF does not have.
LEFT_OUT = {"CURVES": "hair", "POINTCLOUD": "point clouds", "VOLUME": "volumes", "GPENCIL": "drawings"}
# Largest shear of an object that is ignored. The object's matrix is compared with a copy from which the shear is
# removed. If no element differs by more than this fraction of the matrix's largest scale factor, the object is treated
# as unsheared.
SHEAR = 1e-5


class Copy:
    """A scene of plain meshes, lights and a camera. `names` maps the names of the copies to those of the objects."""

    def __init__(self, layer):
        self.layer, self.scene = layer, bpy.data.scenes.new("postlens")
        self.meshes, self.names, self.warnings = {}, {}, []

    def add(self, name, data, matrix):
        thing = bpy.data.objects.new(name, data)
        thing.matrix_world = matrix
        self.scene.collection.objects.link(thing)
        self.names[thing.name] = name

    def mesh_of(self, thing, key):
        """Returns the mesh of an object. Objects that share their mesh and materials also share the copy."""
        if key not in self.meshes:
            mesh = self.meshes[key] = bpy.data.meshes.new_from_object(thing)
            # Gives the exported mesh the materials of the object. In Blender, a material can belong to the mesh or to
            # the object that uses the mesh. The object's material slots list the materials of both kinds, so they are
            # copied from there.
            for i, slot in enumerate(thing.material_slots):
                mesh.materials[i] = slot.material and slot.material.original
            if self.layer.material_override:
                mesh.materials.clear()
                mesh.materials.append(self.layer.material_override)
        return self.meshes[key]

    def add_shape(self, thing, matrix):
        key = (thing.data.as_pointer(), *(slot.material for slot in thing.material_slots))
        unsheared = Matrix.LocRotScale(*matrix.decompose())
        if max(abs(x) for row in matrix - unsheared for x in row) <= SHEAR * max(map(abs, matrix.to_scale())):
            self.add(thing.name, self.mesh_of(thing, key), matrix)
        else:  # A node of glTF cannot shear, so the mesh itself is sheared.
            mesh = self.mesh_of(thing, (*key, matrix.copy().freeze()))
            mesh.transform(matrix)
            self.add(thing.name, mesh, Matrix())

    def add_instance(self, instance):
        thing, kind = instance.object, instance.object.type
        if isinstance(thing.data, bpy.types.Mesh):
            owners = [o.original for o in (thing, instance.parent) if o]
            if not all(o.visible_camera and not o.indirect_only_get(view_layer=self.layer) for o in owners):
                self.warnings.append(f"{thing.name} is left out: it is hidden from the camera's rays alone")
                return
            for system in (m.particle_system for m in thing.modifiers if m.type == "PARTICLE_SYSTEM" and m.show_render):
                if system.settings.type == "HAIR" and system.settings.render_type == "PATH":
                    self.warnings.append(f"{system.name} of {thing.name} is left out: glTF has no hair")
            if instance.show_self:
                self.add_shape(thing, instance.matrix_world)
                if any(is_holdout(o, self.layer) for o in owners):
                    self.warnings.append(f"{thing.name} is traced as it looks: glTF has no holdouts")
        elif kind == "LIGHT" and thing.data.type == "AREA" or kind in LEFT_OUT:
            self.warnings.append(f"{thing.name} is left out: glTF has no {LEFT_OUT.get(kind, 'area lights')}")
        elif kind == "LIGHT":
            self.add(thing.name, thing.data.original, instance.matrix_world)

    def remove(self):
        # A single call removes the objects, meshes and scene, because each call searches the whole Blender file.
        # Blender's function that removes only a scene would need an open window.
        bpy.data.batch_remove([*self.scene.objects, *self.meshes.values(), self.scene])


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


def export(scene, camera, path):
    """Writes a scene to a .glb file as Blender renders it, with only this camera. Returns one line for each kind of
    content that postlens traces differently from Blender."""
    # The export needs a window. Usually this is the current one. But after a script has opened a file, Blender's
    # context has no current window, so the first window is used.
    window = bpy.context.window or bpy.context.window_manager.windows[0]
    # Finds the cameras that must be restored after the export. The export shows a copy of the scene in a window.
    # While it does, Blender replaces the local cameras of this window's 3D views by the camera of the copied scene.
    spaces = [a.spaces.active for w in bpy.context.window_manager.windows for a in w.screen.areas]
    cameras = [(s, ("camera",)) for s in spaces if s.type == "VIEW_3D" and s.use_local_camera]
    copy = Copy(layer_of(scene))

    def fill(depsgraph):
        for instance in depsgraph.object_instances:
            copy.add_instance(instance)
        copy.add(camera.name, camera.data, camera.evaluated_get(depsgraph).matrix_world)

    try:
        with bpy.context.temp_override(window=window), kept((window, ("scene", "view_layer")), *cameras):
            rendered(scene, fill)
            window.scene = copy.scene
            bpy.ops.export_scene.gltf(
                filepath=path, export_cameras=True, export_lights=True, export_current_frame=True,
                export_animations=False, export_morph=False, export_skins=False, use_active_scene=True,
            )  # fmt: skip
    finally:
        copy.remove()
    rename_nodes(path, copy.names)
    return copy.warnings
