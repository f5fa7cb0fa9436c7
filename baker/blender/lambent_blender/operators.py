"""Bakes, cancels and shows. One bake and one show run at a time, and what became of them stands in `state`."""
import os
import shlex
import shutil
import time
from pathlib import Path

import bpy
from bpy.props import BoolProperty

from . import child, export
from .child import Child, Problem

EVERY_S = 0.2


class Bake:
    """A bake that runs: exported, and in the hands of `lambent`."""

    def __init__(self, context: bpy.types.Context, selection: bool) -> None:
        settings = context.scene.lambent
        program = child.find_program("lambent", preferences(context).program)
        self.output = output_path(settings)
        try:
            options = shlex.split(settings.options)
        except ValueError as error:
            raise Problem(f"Options: {error}; close the quotation") from None
        self.scene = export.scene_file(self.output)
        export.export_scene(context, self.scene, selection)
        self.begun = time.monotonic()
        self.cancelled = False
        # Files of volumes stay where they are.
        self.child = Child([str(program), "bake", str(self.scene), "-o", str(self.output), "--allow-outside",
                            "--progress", "json", "--quality", settings.quality, *options])

    def poll(self) -> bool:
        """Returns whether it still runs; when it ends, says in `state` what became of it."""
        code = self.child.poll()
        if code is None:
            return True
        error = self.child.error().removeprefix("lambent: ").replace(f"{self.scene.parent}{os.sep}", "")
        if code == 0:
            size = self.output.stat().st_size / 1e6
            state.say("INFO", f"{self.output.name}: baked, {size:.1f} MB, {time.monotonic() - self.begun:.0f} s")
        elif self.cancelled:
            state.say("WARNING", f"Cancelled at {self.child.share:.0%}; the next bake goes on from there")
        else:
            state.say("ERROR", error)
        if not self.cancelled:
            shutil.rmtree(self.scene.parent, ignore_errors=True)
        return False

    def cancel(self) -> None:
        self.cancelled = True
        self.child.interrupt()

    def text(self) -> str:
        if self.cancelled:
            return "Stopping after the work in hand"
        return self.child.stage or "Reading the scene"


class State:
    bake: Bake | None = None
    show: Child | None = None
    level = "INFO"  # of the message, as Operator.report() has them
    message = ""

    def seen(self) -> tuple:
        """Returns what the panel shows of it."""
        return self.message, self.bake and (self.bake.text(), self.bake.child.share)

    def say(self, level: str, message: str) -> None:
        self.level, self.message = level, message

    def poll(self) -> bool:
        """Looks after what runs; returns whether something does."""
        if self.bake and not self.bake.poll():
            self.bake = None
        if self.show and (code := self.show.poll()) is not None:
            if code != 0:
                self.say("ERROR", self.show.error())
            self.show = None
        return bool(self.bake or self.show)


state = State()


def preferences(context: bpy.types.Context) -> bpy.types.AddonPreferences:
    return context.preferences.addons[__package__].preferences


def output_path(settings: bpy.types.PropertyGroup) -> Path:
    """Returns where the bundle goes: beside the .blend file, or in the home folder if that was never saved."""
    blend = Path(bpy.data.filepath or Path.home() / "untitled.blend")
    path = blend.parent / (settings.output.removeprefix("//") or blend.stem)
    path = Path(os.path.abspath(path.expanduser()))
    return path if path.name.endswith(".lmb.glb") else path.with_name(path.name.removesuffix(".glb") + ".lmb.glb")


def watch() -> float | None:
    """A timer, and no modal operator: that would keep Blender from saving by itself for as long as a bake takes."""
    before = state.seen()
    running = state.poll()
    if state.seen() != before:
        for window in bpy.context.window_manager.windows:
            for area in window.screen.areas:
                for region in area.regions:  # The sidebar alone, since the view itself may take long to draw.
                    if area.type == "VIEW_3D" and region.type == "UI":
                        region.tag_redraw()
    if state.message != before[0] and state.level == "ERROR":
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
            bpy.context.window_manager.popup_menu(
                lambda menu, _: menu.layout.label(text=state.message), title="Lambent", icon="ERROR")
    return EVERY_S if running else None


def watch_soon() -> None:
    if not bpy.app.timers.is_registered(watch):
        bpy.app.timers.register(watch, first_interval=EVERY_S, persistent=True)


class LAMBENT_OT_bake(bpy.types.Operator):
    """Export as glTF and bake with Lambent. A script that calls this waits for the end"""
    bl_idname = "lambent.bake"
    bl_label = "Bake"
    selection: BoolProperty(name="Selection", description="Bake the selected objects only", options={"SKIP_SAVE"})

    def begin(self, context: bpy.types.Context) -> bool:
        try:
            if state.bake:
                raise Problem("a bake is running; cancel it, or wait for its end")
            state.say("INFO", "")
            state.bake = Bake(context, self.selection)
        except Problem as problem:
            self.report({"ERROR"}, str(problem))
            return False
        return True

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if bpy.app.background:
            return self.execute(context)
        if not self.begin(context):
            return {"CANCELLED"}
        watch_soon()
        return {"FINISHED"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        if not self.begin(context):
            return {"CANCELLED"}
        said = 0.0
        while state.poll() and state.bake:
            if state.bake.child.share >= said + 0.1:
                said = state.bake.child.share
                print(f"Lambent: {said:.0%}  {state.bake.text()}", flush=True)
            time.sleep(EVERY_S / 4)
        self.report({state.level}, state.message)
        return {"FINISHED"} if state.level == "INFO" else {"CANCELLED"}


class LAMBENT_OT_cancel(bpy.types.Operator):
    """Stop the bake. What is done is kept, and the next bake goes on from there. A second click stops at once"""
    bl_idname = "lambent.cancel"
    bl_label = "Cancel"

    def execute(self, context: bpy.types.Context) -> set[str]:
        if not state.bake:
            return {"CANCELLED"}
        state.bake.cancel()
        return {"FINISHED"}


class LAMBENT_OT_show(bpy.types.Operator):
    """Show the bundle in lambent-demo"""
    bl_idname = "lambent.show"
    bl_label = "Show"

    def execute(self, context: bpy.types.Context) -> set[str]:
        settings = context.scene.lambent
        try:
            bundle = output_path(settings)
            if not bundle.is_file():
                raise Problem(f"{bundle} is not there; bake first")
            if state.show and state.show.poll() is None:
                raise Problem("lambent-demo is still open; close its window first")
            light = ["--light", bpy.path.abspath(settings.light)] if settings.light else []
            program = child.find_program("lambent-demo", preferences(context).program)
            state.show = Child([str(program), str(bundle), *light])
        except Problem as problem:
            self.report({"ERROR"}, str(problem))
            return {"CANCELLED"}
        watch_soon()
        return {"FINISHED"}


CLASSES = (LAMBENT_OT_bake, LAMBENT_OT_cancel, LAMBENT_OT_show)


def register() -> None:
    for each in CLASSES:
        bpy.utils.register_class(each)


def unregister() -> None:
    # Blender ends, or the add-on is turned off: nobody will watch the bake.
    if state.bake:
        state.bake.cancel()
    if bpy.app.timers.is_registered(watch):
        bpy.app.timers.unregister(watch)
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
