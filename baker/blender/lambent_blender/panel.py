"""The preferences, the settings of a scene, and the panel in the sidebar of the 3D view."""
import textwrap

import bpy
from bpy.props import EnumProperty, FloatProperty, PointerProperty, StringProperty

from . import child, operators
from .marks import holds_volume
from .operators import output_path, state


class LambentPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__
    program: StringProperty(
        name="lambent", subtype="FILE_PATH",
        description="The program; empty: looked for on PATH. lambent-demo is expected beside it")

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.prop(self, "program")
        for name in ("lambent", "lambent-demo"):
            try:
                self.layout.label(text=str(child.find_program(name, self.program)), icon="CHECKMARK")
            except child.Problem as problem:
                self.layout.label(text=str(problem), icon="ERROR")


class LambentSceneSettings(bpy.types.PropertyGroup):
    quality: EnumProperty(
        name="Quality", description="How many rays, how small errors, and how many vertices may be added",
        items=[(name, name.capitalize(), "") for name in ("draft", "standard", "high")],
        default="standard")
    output: StringProperty(
        name="Bundle", subtype="FILE_PATH", description="The file to write, .lmb.glb; empty: beside the .blend file")
    options: StringProperty(
        name="Options",
        description="More options of lambent bake, such as --bounces 2; lambent bake --help lists them")
    light: StringProperty(
        name="Light", subtype="FILE_PATH",
        description="An environment map, .hdr or .exr, under which the bundle is shown. Bundles are baked for any light")


class LAMBENT_PT_panel(bpy.types.Panel):
    bl_label = "Lambent"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Lambent"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.lambent
        layout.prop(settings, "quality")
        layout.prop(settings, "output")
        layout.prop(settings, "options")
        self.draw_bake(context)
        layout.prop(settings, "light")
        layout.operator("lambent.show", text="Show " + output_path(settings).name, icon="PLAY")
        if context.object:
            self.draw_marks(context.object)

    def draw_bake(self, context: bpy.types.Context) -> None:
        if state.bake:
            column = self.layout.column(align=True)
            bar = column.row()
            bar.enabled = False
            bar.use_property_split = False
            bar.prop(context.window_manager, "lambent_progress", text="", slider=True)
            self.draw_text(context, state.bake.text(), "NONE")
            self.layout.operator("lambent.cancel", icon="CANCEL")
            return
        row = self.layout.row(align=True)
        row.operator("lambent.bake", text="Bake Selection").selection = True
        row.operator("lambent.bake", text="Bake Scene").selection = False
        if state.message:
            self.draw_text(context, state.message, "ERROR" if state.level == "ERROR" else "INFO")

    def draw_text(self, context: bpy.types.Context, text: str, icon: str) -> None:
        """Breaks a sentence into lines, since labels are cut off."""
        width = context.region.width / (7 * context.preferences.system.ui_scale) - 4
        column = self.layout.column(align=True)
        for line in textwrap.wrap(text, max(16, int(width))):
            column.label(text=line, icon=icon)
            icon = "BLANK1" if icon != "NONE" else "NONE"

    def draw_marks(self, thing: bpy.types.Object) -> None:
        marks = thing.lambent
        box = self.layout.box()
        box.label(text=thing.name, icon="OBJECT_DATA")
        column = box.column()
        if thing.type == "LIGHT" and thing.data.type == "AREA":
            column.label(text="glTF has no area lights; mark a mesh as lamp", icon="ERROR")
        self.draw_mark(column, marks, "movable")
        if self.draw_mark(column, marks, "has_neighborhood"):
            column.prop(marks, "neighborhood_extent")
            points = column.column()
            points.active = all(marks.neighborhood_extent)
            points.prop(marks, "neighborhood_size")
        if thing.type != "VOLUME" and self.draw_mark(column, marks, "is_volume"):
            column.prop(marks, "volume_file")
        if holds_volume(thing):
            for name in ("volume_grid", "density_scale", "albedo", "anisotropy"):
                column.prop(marks, name)
        elif thing.type == "MESH":
            if self.draw_mark(column, marks, "is_lamp"):
                column.prop(marks, "lamp_color")
                column.prop(marks, "lamp_strength")
            column.prop(thing.data.lambent, "texture_transfer")
            if thing.data.lambent.texture_transfer != "0" and not thing.data.uv_layers:
                column.label(text="It has no UV map", icon="ERROR")

    @staticmethod
    def draw_mark(layout: bpy.types.UILayout, marks: bpy.types.PropertyGroup, name: str) -> bool:
        row = layout.row()
        row.use_property_split = False
        row.prop(marks, name)
        return getattr(marks, name)


CLASSES = (LambentPreferences, LambentSceneSettings, LAMBENT_PT_panel)


def register() -> None:
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Scene.lambent = PointerProperty(type=LambentSceneSettings)
    bpy.types.WindowManager.lambent_progress = FloatProperty(
        name="Progress", subtype="PERCENTAGE", min=0.0, max=100.0, precision=0,
        get=lambda _: 100.0 * state.bake.child.share if state.bake else 0.0)
    operators.register()


def unregister() -> None:
    operators.unregister()
    del bpy.types.Scene.lambent, bpy.types.WindowManager.lambent_progress
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
