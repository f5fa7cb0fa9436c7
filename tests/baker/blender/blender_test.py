"""Tests the add-on in Blender without a window; run_blender.sh runs it."""
import json
import os
import sys
import threading
import time
import unittest
from pathlib import Path

import bpy

import playground
from playground import FOLDER, info, make_scene

# With one thread this takes long enough on any machine to be cancelled.
MANY_RAYS = "--rays 20000 --bounces 4 --max-edge 0.1 --checkpoint 0.1 --threads 1"


def exported() -> dict:
    """Returns the scene as File > Export > glTF 2.0 writes it: nodes by name, and meshes, materials and all."""
    file = FOLDER / "exported.gltf"
    bpy.ops.export_scene.gltf(filepath=str(file), export_format="GLTF_SEPARATE", export_extras=True)
    gltf = json.loads(file.read_text())
    gltf["by_name"] = {node["name"]: node for node in gltf["nodes"]}
    return gltf


def ours(thing: dict) -> dict:
    return thing.get("extras", {}).get("lambent", {})


def exports() -> list[str]:
    """Returns the names of scenes that were exported for a bake and are still there."""
    return [file.name for file in Path(os.environ["XDG_CACHE_HOME"], "lambent-blender").glob("*/*")]


def objects() -> bpy.types.bpy_prop_collection:
    return bpy.data.objects


class AddOn(unittest.TestCase):
    def setUp(self) -> None:
        self.bundle = make_scene()
        self.state = sys.modules["lambent_blender.operators"].state

    def test_has_the_version_of_the_project(self) -> None:
        version = ".".join(map(str, sys.modules["lambent_blender"].bl_info["version"]))
        self.assertEqual(version, os.environ["LAMBENT_VERSION"])

    def test_can_be_turned_off_and_on_again(self) -> None:
        bpy.ops.preferences.addon_disable(module="lambent_blender")
        self.assertFalse(hasattr(bpy.types.Scene, "lambent"))
        bpy.ops.preferences.addon_enable(module="lambent_blender")
        self.assertTrue(hasattr(bpy.types.Scene, "lambent"))

    def test_writes_nothing_for_objects_without_marks(self) -> None:
        gltf = exported()
        for thing in [*gltf["nodes"], *gltf["meshes"], *gltf["scenes"]]:
            self.assertNotIn("lambent", thing.get("extras", {}), thing["name"])

    def test_writes_marks_as_extras(self) -> None:
        box = objects()["box"]
        box.lambent.movable = True
        box.lambent.has_neighborhood = True
        box.lambent.neighborhood_size = (32, 16, 4)
        box.lambent.neighborhood_extent = (4, 3, 2)
        box["weight"] = 3
        floor = objects()["floor"]
        floor.data.lambent.texture_transfer = "256"
        gltf = exported()
        node = gltf["by_name"]["box"]
        self.assertIs(ours(node)["movable"], True, "Blender's exporter alone writes 1, which Lambent does not take")
        self.assertEqual(ours(node)["neighborhood"], {"size": [32, 4, 16], "extent": [4, 2, 3]}, "with y up")
        self.assertEqual(set(ours(node)), {"movable", "neighborhood"})
        self.assertEqual(node["extras"]["weight"], 3)
        self.assertEqual(ours(gltf["meshes"][gltf["by_name"]["floor"]["mesh"]]), {"texture_transfer": 256})

    def test_keeps_what_a_script_has_put_under_our_name(self) -> None:
        objects()["floor"]["lambent"] = {"movable": True, "later": {"size": [1, 2]}}
        self.assertEqual(ours(exported()["by_name"]["floor"]), {"movable": True, "later": {"size": [1, 2]}})

    def test_lets_the_surface_of_a_lamp_shine_and_not_that_of_its_twin(self) -> None:
        lamp = objects()["lamp"]
        twin = lamp.copy()
        twin.name = "twin"
        bpy.context.collection.objects.link(twin)
        lamp.lambent.is_lamp = True
        lamp.lambent.lamp_color = (1, 0.5, 0.25)
        lamp.lambent.lamp_strength = 20
        gltf = exported()
        shining = gltf["meshes"][gltf["by_name"]["lamp"]["mesh"]]["primitives"][0]
        material = gltf["materials"][shining["material"]]
        self.assertEqual(material["emissiveFactor"], [1, 0.5, 0.25])
        self.assertEqual(material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"], 20)
        self.assertIn("KHR_materials_emissive_strength", gltf["extensionsUsed"])
        self.assertNotIn("material", gltf["meshes"][gltf["by_name"]["twin"]["mesh"]]["primitives"][0])

    def test_fills_the_box_of_a_mesh_with_a_volume(self) -> None:
        box = objects()["box"]
        box.lambent.is_volume = True
        box.lambent.volume_file = str(FOLDER / "some smoke.vdb")
        box.lambent.density_scale = 40
        for vertex in box.data.vertices:  # 1 x 2 x 3, and no more around its origin
            vertex.co.y *= 2
            vertex.co.z = vertex.co.z * 3 + 1
        box.data.update()
        gltf = exported()
        node = gltf["by_name"]["box"]
        self.assertNotIn("mesh", node)
        child = gltf["nodes"][node["children"][0]]
        volume = ours(child)["volume"]
        self.assertEqual((volume["file"], volume["density_scale"], volume["size"]), ("some%20smoke.vdb", 40, [1, 2, 3]))
        self.assertEqual(child["translation"], [0, 1, 0])
        self.assertAlmostEqual(child["rotation"][0], -0.5**0.5, places=6)

    def test_bakes_and_the_marks_arrive(self) -> None:
        box, lamp = objects()["box"], objects()["lamp"]
        box.lambent.movable = True
        lamp.lambent.is_lamp = True
        smoke = FOLDER / "smoke.nrrd"
        smoke.write_bytes(b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 3 2\nencoding: raw\n\n" + bytes(24 * [1]))
        bpy.ops.object.empty_add(location=(-2, 0, 2))
        bpy.context.object.name = "smoke"
        bpy.context.object.lambent.is_volume = True
        bpy.context.object.lambent.volume_file = str(smoke)
        bpy.context.scene.lambent.options += " --volume-grid 4"
        self.assertEqual(bpy.ops.lambent.bake(), {"FINISHED"})
        self.assertRegex(self.state.message, r"^room\.lmb\.glb: baked, \d+\.\d MB, \d+ s$")
        baked = info(self.bundle)
        names = [group["name"] for group in baked["groups"]]
        self.assertEqual(set(names), {"static", "box", "smoke volume"})
        transfer = [part for group in baked["groups"] for part in group["transfer"]]
        self.assertIn("lamps", [part["light"] for part in transfer], "the lamp lights the floor")
        self.assertEqual(baked["settings"]["rays"], "128")
        self.assertEqual(exports(), [], "the export is removed")

    def test_bakes_the_selection_alone_and_not_what_is_hidden_from_renders(self) -> None:
        bpy.ops.object.select_all(action="DESELECT")
        objects()["box"].select_set(True)
        bpy.ops.lambent.bake(selection=True)
        self.assertEqual(info(self.bundle)["draws"], 1)
        objects()["lamp"].hide_render = True
        bpy.ops.lambent.bake()
        self.assertEqual(info(self.bundle)["draws"], 2)

    def test_leaves_a_user_in_edit_mode_there(self) -> None:
        bpy.context.view_layer.objects.active = objects()["box"]
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.lambent.bake()
        self.assertEqual(objects()["box"].mode, "EDIT")
        bpy.ops.object.mode_set(mode="OBJECT")

    def fails(self, **words) -> str:
        """Returns the error of a bake, which must be one line."""
        with self.assertRaises(RuntimeError) as caught:
            bpy.ops.lambent.bake(**words)
        line = str(caught.exception).strip()
        self.assertNotIn("\n", line)
        self.assertNotIn("Traceback", line)
        self.assertTrue(line.startswith("Error: "), line)
        self.assertFalse(self.bundle.exists())
        self.assertIsNone(self.state.bake)
        return line.removeprefix("Error: ")

    def test_says_that_the_program_is_not_there_and_where_to_correct_it(self) -> None:
        bpy.context.preferences.addons["lambent_blender"].preferences.program = "/nowhere/lambent"
        self.assertEqual(self.fails(),
                         "/nowhere/lambent is not a program; correct the path in Preferences > Add-ons > Lambent")

    def test_says_that_nothing_is_selected(self) -> None:
        bpy.ops.object.select_all(action="DESELECT")
        self.assertEqual(self.fails(selection=True), "nothing is selected; select what to bake, or bake the scene")

    def test_passes_on_the_errors_of_lambent(self) -> None:
        bpy.context.scene.lambent.options = "--rays many"
        self.assertRegex(self.fails(), "rays.*many")
        bpy.context.scene.lambent.options = ""
        objects()["box"].lambent.is_volume = True
        objects()["box"].lambent.volume_file = "/nowhere/smoke.vdb"
        self.assertRegex(self.fails(), r'^room\.glb: .*"smoke\.vdb" is not a file; put it beside the scene$')

    def test_cancels_without_a_trace_and_goes_on_from_there(self) -> None:
        def cancelled_at(least: float) -> float:
            """Bakes until a share is reached, at once if it begins there, and returns the first share that was seen."""
            seen = []

            def cancel() -> None:
                while not (bake := self.state.bake) or bake.child.share == 0.0:
                    time.sleep(0.01)
                seen.append(bake.child.share)
                while bake.child.share < least:
                    time.sleep(0.01)
                time.sleep(0.3)
                bpy.ops.lambent.cancel()

            canceller = threading.Thread(target=cancel, daemon=True)
            canceller.start()
            self.assertEqual(bpy.ops.lambent.bake(), {"CANCELLED"})
            canceller.join()
            return seen[0]

        bpy.context.scene.lambent.options = MANY_RAYS
        first = cancelled_at(0.1)
        self.assertRegex(self.state.message, r"^Cancelled at \d+%; the next bake goes on from there$")
        self.assertEqual(list(self.bundle.parent.iterdir()), [], "neither a bundle nor a part of one")
        self.assertEqual(exports(), ["room.glb"], "the next bake finds the scene")
        self.assertLess(first, 0.1)
        self.assertGreaterEqual(cancelled_at(0.0), 0.1, "it goes on")
        bpy.context.scene.lambent.options = playground.FEW_RAYS
        self.assertEqual(bpy.ops.lambent.bake(), {"FINISHED"})


if __name__ == "__main__":
    # Blender ends with an error if a script raises one.
    chosen = os.environ.get("LAMBENT_BLENDER_TESTS", "").split()  # such as AddOn.test_writes_marks_as_extras; none: all
    program = unittest.main(argv=["blender_test", "-v", *chosen], exit=False)
    if not program.result.wasSuccessful() or not program.result.testsRun:
        raise SystemExit(1)
