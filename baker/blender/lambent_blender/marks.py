"""The marks of objects and meshes, and the hook by which they become `extras.lambent` (docs/authoring.md).

Blender's exporter writes custom properties by itself, but Blender 3.4 turns true into 1, and volumes need axes of their
own. So the hook writes them. It also serves File > Export > glTF 2.0. What a script stored in object["lambent"] under
other names than ours is kept.
"""
import copy
import inspect
import math
import os
import urllib.parse

import bpy
from bpy.props import (BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntVectorProperty,
                       PointerProperty, StringProperty)
from mathutils import Vector


class LambentObjectMarks(bpy.types.PropertyGroup):
    movable: BoolProperty(
        name="Movable", description="Let it be moved by hand after the bake. What an animation moves needs no mark")
    is_lamp: BoolProperty(name="Lamp", description="Let all of its surface shine, whatever its materials say")
    lamp_color: FloatVectorProperty(name="Color", subtype="COLOR", size=3, min=0.0, max=1.0, default=(1.0, 1.0, 1.0))
    lamp_strength: FloatProperty(
        name="Strength", description="Radiance, as the emission strength of a material", min=0.0, max=1e9, default=10.0)
    is_volume: BoolProperty(
        name="Volume", description="Let it hold the densities of a file. The bounding box of a mesh is filled with "
        "them, and the mesh is not shown. An empty takes the file's own place and size")
    volume_file: StringProperty(
        name="File", subtype="FILE_PATH", description="A .vdb or .nrrd file, or procedural:cloud,SEED")
    volume_grid: StringProperty(name="Grid", description="The grid of an OpenVDB file; empty: density, or the only one")
    density_scale: FloatProperty(
        name="Density Scale", description="The file's values times this are the extinction per meter",
        min=0.0, max=1e12, default=1.0)
    albedo: FloatVectorProperty(
        name="Albedo", description="The share of the extinction that scatters", subtype="COLOR", size=3, min=0.0,
        max=1.0, default=(1.0, 1.0, 1.0))
    anisotropy: FloatProperty(
        name="Anisotropy", description="Mean cosine of the scattering angle; positive: forwards", min=-0.99, max=0.99)
    has_neighborhood: BoolProperty(
        name="Neighborhood", description="Bake a grid around it, with which its shadow and reflected light move along")
    neighborhood_size: IntVectorProperty(
        name="Points", description="Points of the grid along x, y and z", size=3, min=2, max=256, default=(16, 16, 16))
    neighborhood_extent: FloatVectorProperty(
        name="Extent", description="Size of the grid; 0: chosen by the bake, as are the points", subtype="XYZ",
        unit="LENGTH", size=3, min=0.0)


class LambentMeshMarks(bpy.types.PropertyGroup):
    # The numbers of the items are what Blender stores, and so what it exports where this add-on is off.
    texture_transfer: EnumProperty(
        name="Texels", description="Texture transfer: bake at the texels of the mesh's second UV map, or its only one, "
        "in which nothing overlaps",
        items=[("0", "Off", "Bake at vertices", 0)] +
        [(str(1 << n), f"{1 << n} x {1 << n}", "Texels", 1 << n) for n in range(4, 12)])


def holds_volume(thing: bpy.types.Object) -> bool:
    return thing.lambent.is_volume or thing.type == "VOLUME"


def volume_extras(thing: bpy.types.Object, folder: str) -> dict:
    """Returns extras.lambent.volume, with the file's path from `folder`."""
    marks = thing.lambent
    file = thing.data.filepath if thing.type == "VOLUME" else marks.volume_file
    if file and not file.startswith("procedural:"):
        file = bpy.path.abspath(file, library=thing.library)
        file = urllib.parse.quote(os.path.relpath(os.path.realpath(file), os.path.realpath(folder)))
    volume = {"file": file, "density_scale": marks.density_scale, "albedo": list(marks.albedo), "g": marks.anisotropy}
    if marks.volume_grid:
        volume["grid"] = marks.volume_grid
    return volume


def neighborhood_extras(marks: LambentObjectMarks) -> dict:
    if not all(marks.neighborhood_extent):
        return {}
    size, extent = marks.neighborhood_size, marks.neighborhood_extent  # Blender's z is glTF's y.
    return {"size": [size[0], size[2], size[1]], "extent": [extent[0], extent[2], extent[1]]}


def with_ours(extras: dict | None, ours: dict, marks: bpy.types.PropertyGroup) -> dict | None:
    """Returns extras with `ours` in place of the raw properties that the exporter wrote."""
    extras = dict(extras or {})
    raw = extras.pop("lambent", None)
    if isinstance(raw, dict):
        ours = {**{key: value for key, value in raw.items() if key not in marks.bl_rna.properties}, **ours}
    if ours:
        extras["lambent"] = ours
    return extras or None


class glTF2ExportUserExtension:
    def __init__(self) -> None:
        # These modules are there only while the exporter is.
        from io_scene_gltf2.io.com import gltf2_io
        from io_scene_gltf2.io.com.gltf2_io_extensions import Extension
        self.gltf, self.extension = gltf2_io, Extension

    def empty(self, kind: type):
        """Returns a node or material without anything; its constructor wants all fields, which differ by version."""
        return kind(**{name: None for name in inspect.signature(kind).parameters})

    def gather_node_hook(self, node, thing: bpy.types.Object, export_settings: dict) -> None:
        if not isinstance(thing, bpy.types.Object):  # Later exporters make nodes of collections too.
            return
        marks = thing.lambent
        ours = {}
        if marks.movable:
            ours["movable"] = True
        if marks.has_neighborhood:
            ours["neighborhood"] = neighborhood_extras(marks)
        node.extras = with_ours(node.extras, ours, marks)
        if holds_volume(thing):
            volume = volume_extras(thing, export_settings["gltf_filedirectory"])
            node.children = [*(node.children or []), self.volume_node(thing, volume)]
            node.mesh = None
        elif node.mesh and isinstance(thing.data, bpy.types.Mesh):
            texels = int(thing.data.lambent.texture_transfer)
            texture_transfer = {"texture_transfer": texels} if texels else {}
            node.mesh.extras = with_ours(node.mesh.extras, texture_transfer, thing.data.lambent)
        if node.mesh and marks.is_lamp:
            node.mesh = self.shining(node.mesh, marks)

    def gather_scene_hook(self, scene, blender_scene: bpy.types.Scene, export_settings: dict) -> None:
        # The settings of the panel are of no use in a glTF file.
        scene.extras = with_ours(scene.extras, {}, blender_scene.lambent)

    def volume_node(self, thing: bpy.types.Object, volume: dict):
        """Returns a child whose axes are Blender's, as those of files are; procedural clouds have glTF's, with y up."""
        node = self.empty(self.gltf.Node)
        node.name = thing.name + " volume"
        upright = volume["file"].startswith("procedural:")
        if thing.type == "MESH":
            corners = [Vector(corner) for corner in thing.bound_box]
            size, center = corners[6] - corners[0], (corners[6] + corners[0]) / 2
            volume["size"] = [size.x, size.z, size.y] if upright else list(size)
            node.translation = [center.x, center.z, -center.y]
        if not upright:
            node.rotation = [-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]
        node.extras = {"lambent": {"volume": volume}}
        return node

    def shining(self, mesh, marks: LambentObjectMarks):
        """Returns a copy of the mesh, since others may share it, whose materials shine."""
        mesh = copy.copy(mesh)
        mesh.primitives = [copy.copy(primitive) for primitive in mesh.primitives]
        for primitive in mesh.primitives:
            material = copy.copy(primitive.material) if primitive.material else self.empty(self.gltf.Material)
            material.name = f"{material.name or mesh.name} lamp"
            material.emissive_texture = None
            material.emissive_factor = list(marks.lamp_color)
            name = "KHR_materials_emissive_strength"
            strength = self.extension(name, {"emissiveStrength": marks.lamp_strength}, False)
            material.extensions = {**(material.extensions or {}), name: strength}
            primitive.material = material
        return mesh


def register() -> None:
    bpy.utils.register_class(LambentObjectMarks)
    bpy.utils.register_class(LambentMeshMarks)
    bpy.types.Object.lambent = PointerProperty(type=LambentObjectMarks)
    bpy.types.Mesh.lambent = PointerProperty(type=LambentMeshMarks)


def unregister() -> None:
    del bpy.types.Object.lambent, bpy.types.Mesh.lambent
    bpy.utils.unregister_class(LambentMeshMarks)
    bpy.utils.unregister_class(LambentObjectMarks)
