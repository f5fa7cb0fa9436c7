"""What the tests of the add-on share: the add-on installed as a user does it, and a small scene."""
import json
import os
import subprocess
from pathlib import Path

import bpy

FOLDER = Path(os.environ["LAMBENT_TEST_FOLDER"])
PROGRAM = os.environ["LAMBENT_PROGRAM"]
FEW_RAYS = "--rays 128 --bounces 1 --neighborhood-grid 4x4x4"


def install() -> None:
    """Installs the add-on once, and turns it on again after the settings were reset."""
    if not (FOLDER / "scripts/addons/lambent_blender").exists():
        bpy.ops.preferences.addon_install(filepath=str(FOLDER / "lambent-blender.zip"))
    bpy.ops.preferences.addon_enable(module="lambent_blender")


def make_scene(program: str = PROGRAM) -> Path:
    """Makes a floor, a box and a lamp above it, and returns where their bundle will be."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    install()
    bpy.context.preferences.addons["lambent_blender"].preferences.program = program
    bpy.ops.mesh.primitive_plane_add(size=8)
    bpy.context.view_layer.objects.active.name = "floor"
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 1))
    bpy.context.view_layer.objects.active.name = "box"
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.3, location=(1, -2, 3), segments=12, ring_count=8)
    bpy.context.view_layer.objects.active.name = "lamp"
    settings = bpy.context.scene.lambent
    settings.quality, settings.options = "draft", FEW_RAYS
    bundle = FOLDER / "bundles" / "room.lmb.glb"
    bundle.parent.mkdir(exist_ok=True)
    bundle.unlink(missing_ok=True)
    settings.output = str(bundle)
    return bundle


def info(bundle: Path) -> dict:
    said = subprocess.run([PROGRAM, "info", "--json", str(bundle)], check=True, stdout=subprocess.PIPE)
    return json.loads(said.stdout)
