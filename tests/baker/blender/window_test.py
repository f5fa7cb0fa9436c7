"""Tests the add-on in a window, where a bake must not keep Blender from going on; run_blender.sh ... --window runs it.

With LAMBENT_PICTURES=FOLDER it leaves pictures of the panel there: at rest, while it bakes, and with an error.
"""
import os
import sys
import time
import traceback
from collections.abc import Iterator

import bpy

from playground import FEW_RAYS, FOLDER, make_scene

LONGEST_S = 240
TAB = (13, 224)  # of the panel, from the upper right corner of the 3D view; only the chosen tab is drawn


def view() -> bpy.types.Area:
    return next(area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == "VIEW_3D")


def over_view():
    area = view()
    region = next(region for region in area.regions if region.type == "WINDOW")
    return bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area, region=region)


def click(x: int, y: int) -> Iterator[float]:
    window = bpy.context.window_manager.windows[0]
    for kind, value in (("MOUSEMOVE", "NOTHING"), ("LEFTMOUSE", "PRESS"), ("LEFTMOUSE", "RELEASE")):
        window.event_simulate(type=kind, value=value, x=x, y=y)
        yield 0.5  # Blender handles it.


def picture(name: str) -> None:
    if folder := os.environ.get("LAMBENT_PICTURES"):
        with over_view():
            bpy.ops.screen.screenshot(filepath=os.path.join(folder, name + ".png"))


def claims() -> Iterator[float]:
    """Yields how many seconds Blender shall go on by itself until the next line."""
    state = sys.modules["lambent_blender.operators"].state
    settings = bpy.context.scene.lambent
    box, lamp = bpy.data.objects["box"], bpy.data.objects["lamp"]
    box.lambent.movable = lamp.lambent.is_lamp = True
    view().spaces.active.show_region_ui = True
    yield 1.0
    yield from click(view().x + view().width - TAB[0], view().y + view().height - TAB[1])
    picture("rest")

    settings.options = "--rays 20000 --bounces 4 --max-edge 0.1 --threads 1"
    with over_view():
        assert bpy.ops.lambent.bake("INVOKE_DEFAULT") == {"FINISHED"}
    assert state.bake, "it returns while the bake runs"
    while state.bake and state.bake.child.share < 0.1:
        yield 0.05
    assert bpy.context.window_manager.lambent_progress >= 10
    yield 0.5
    picture("baking")
    bpy.ops.lambent.cancel()
    while state.bake:
        yield 0.05
    assert state.message.startswith("Cancelled at "), state.message
    assert not BUNDLE.exists()

    settings.options = FEW_RAYS
    with over_view():
        bpy.ops.lambent.bake("INVOKE_DEFAULT")
    while state.bake:
        yield 0.05
    assert state.level == "INFO" and BUNDLE.exists(), state.message

    settings.light = "/nowhere/sky.hdr"
    assert bpy.ops.lambent.show() == {"FINISHED"}
    while state.show:
        yield 0.05
    assert state.level == "ERROR" and "sky.hdr" in state.message, state.message

    bpy.context.view_layer.objects.active = box  # All of its marks are drawn.
    box.lambent.has_neighborhood = box.lambent.is_volume = True
    yield 0.5
    box.lambent.is_volume = False
    settings.options = "--rays many"
    with over_view():
        bpy.ops.lambent.bake("INVOKE_DEFAULT")
    while state.bake:
        yield 0.05
    assert state.level == "ERROR" and "--rays" in state.message, state.message
    yield 0.5
    picture("error")


def step() -> float:
    """Goes on with the claims, and ends Blender after the last one or a wrong one."""
    try:
        assert time.monotonic() < END, "it takes too long"
        return next(RUNNING)
    except StopIteration:
        print("passed", flush=True)
        os._exit(0)
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(1)


make_scene()
bpy.context.scene.lambent.output = "//room.lmb.glb"  # The .blend file was never saved, so it lies in the home folder.
BUNDLE = FOLDER / "room.lmb.glb"
bpy.context.preferences.view.show_splash = False
END = time.monotonic() + LONGEST_S
RUNNING = claims()
bpy.app.timers.register(step, first_interval=1.0)
