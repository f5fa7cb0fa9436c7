"""Lambent for Blender: marks objects, bakes a selection or the scene with the program `lambent`, and shows the bundle.

`marks` owns the custom properties and writes them into glTF's extras, `export` writes the scene as glTF, `child` runs
Lambent's programs, and `panel` has settings, operators and the panel. docs/blender.md is the manual.
"""
bl_info = {
    "name": "Lambent",
    "description": "Bake light transport into bundles for real-time display",
    "author": "The Lambent authors",
    "version": (0, 10, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Lambent",
    "category": "Import-Export",
}

from . import marks, panel
from .marks import glTF2ExportUserExtension  # Blender's glTF exporter looks for this name in each add-on.


def register() -> None:
    marks.register()
    panel.register()


def unregister() -> None:
    panel.unregister()
    marks.unregister()
