"""Writes what is to be baked as glTF, by Blender's own exporter."""
import hashlib
import os
from pathlib import Path

import bpy

from .child import Problem


def scene_file(output: Path) -> Path:
    """Returns where the scene of a bundle is written.

    It is the same place each time, so that a bake that was cancelled goes on.
    """
    caches = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    name = output.name.removesuffix(".lmb.glb")
    return caches / "lambent-blender" / hashlib.sha256(os.fsencode(output)).hexdigest()[:16] / f"{name}.glb"


def export_scene(context: bpy.types.Context, file: Path, selection: bool) -> None:
    if selection and not context.selected_objects:
        raise Problem("nothing is selected; select what to bake, or bake the scene")
    try:
        known = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
    except KeyError:
        raise Problem("Blender's glTF exporter is off; turn on glTF 2.0 in Preferences > Add-ons") from None
    options = {
        "filepath": str(file), "check_existing": False, "export_format": "GLB", "export_extras": True,
        "use_active_scene": True, "use_selection": selection, "use_renderable": not selection, "export_yup": True,
        "export_apply": True, "export_current_frame": True, "export_cameras": True, "export_lights": True,
    }
    # Radiance without a factor of 683 lumens per watt: lights are as bright beside each other as in Blender.
    for name in ("convert_lighting_mode", "export_import_convert_lighting_mode"):
        options[name] = "COMPAT"
    active = context.view_layer.objects.active
    mode = active.mode if active else "OBJECT"
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        bpy.ops.export_scene.gltf(**{name: value for name, value in options.items() if name in known})
    except (OSError, RuntimeError) as error:
        raise Problem(f"the scene was not exported: {last_line(error)}") from None
    finally:
        if mode != "OBJECT":  # The exporter leaves edit mode.
            bpy.ops.object.mode_set(mode=mode)


def last_line(error: Exception) -> str:
    return (str(error).strip().splitlines() or [type(error).__name__])[-1]
