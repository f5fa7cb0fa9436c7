"""Draws a glTF file with Cycles, in Blender: ... -- SCENE.glb OUT.exr WxH SAMPLES. scripts/compare-cycles runs it.

Materials become Lambert surfaces of their base colour: Blender's Principled BSDF has another diffuse lobe than glTF.
"""
import math
import os
import sys

import bpy
import numpy
from mathutils import Vector

if "bool" not in vars(numpy):
    numpy.bool = bool  # what Blender 3.4 imports glTF with asks for it, and numpy 1.24 has dropped it

scene_path, picture_path, size, samples = sys.argv[sys.argv.index("--") + 1:]
width, height = (int(number) for number in size.split("x"))
SKY = (0.5, 0.6, 0.8)
AZIMUTH, ELEVATION, RADIUS, RADIANCE = math.radians(40), math.radians(50), math.radians(2), 800

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=scene_path)
scene = bpy.context.scene
for light in [thing for thing in bpy.data.objects if thing.type == "LIGHT"]:
    bpy.data.objects.remove(light)

for material in bpy.data.materials:
    nodes, links = material.node_tree.nodes, material.node_tree.links
    principled = next((node for node in nodes if node.type == "BSDF_PRINCIPLED"), None)
    if principled is None:
        continue
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    color = principled.inputs["Base Color"]
    if color.is_linked:
        links.new(color.links[0].from_socket, diffuse.inputs["Color"])
    else:
        diffuse.inputs["Color"].default_value = color.default_value
    output = next(node for node in nodes if node.type == "OUTPUT_MATERIAL")
    links.new(diffuse.outputs["BSDF"], output.inputs["Surface"])

world = bpy.data.worlds.new("sky")
world.use_nodes = True
world.node_tree.nodes["Background"].inputs["Color"].default_value = (*SKY, 1)
scene.world = world

# glTF's (x, y, z) are Blender's (x, -z, y). A sun's strength is its irradiance.
towards = Vector((math.cos(ELEVATION) * math.sin(AZIMUTH), -math.cos(ELEVATION) * math.cos(AZIMUTH),
                  math.sin(ELEVATION)))
sun = bpy.data.lights.new("sun", "SUN")
sun.angle = 2 * RADIUS
sun.energy = math.pi * RADIANCE * math.sin(RADIUS)**2
sun_object = bpy.data.objects.new("sun", sun)
sun_object.rotation_euler = towards.to_track_quat("Z", "Y").to_euler()
scene.collection.objects.link(sun_object)

scene.camera = next(thing for thing in bpy.data.objects if thing.type == "CAMERA" and thing.name.startswith("main"))
render = scene.render
render.engine = "CYCLES"
render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
render.film_transparent = True  # so that covered pixels are known by their alpha, as in ours
render.image_settings.file_format = "OPEN_EXR"
render.image_settings.color_mode = "RGBA"
render.image_settings.color_depth = "32"
render.filepath = os.path.abspath(picture_path)
scene.view_settings.view_transform = "Raw"
cycles = scene.cycles
cycles.samples = int(samples)
cycles.use_adaptive_sampling = cycles.use_denoising = False
cycles.pixel_filter_type = "BOX"
cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
cycles.max_bounces = cycles.diffuse_bounces = 64
bpy.ops.render.render(write_still=True)
