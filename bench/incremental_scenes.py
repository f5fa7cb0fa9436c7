#!/usr/bin/env python3
"""Ten movable copies of a .glb scene's first mesh on a plate each, and what a person might change in them:

  incremental_scenes.py IN.glb FOLDER     writes FOLDER/{full,albedo,node,group,carried}.glb

full: as it is. albedo: one group in another colour. node: the body of one group stands elsewhere on its plate. group: one
group's body is another size. carried: one group stands elsewhere as a whole. Standard library only.
"""
import copy
import json
import math
import pathlib
import struct
import sys

from with_material import JSON_CHUNK, chunks_of, write

GROUPS = 10


def add_plate(document, binary, size):
    """A square of 16 x 16 cells in the xz plane; returns its primitive without a material."""
    n = 16
    positions, indices = [], []
    for j in range(n + 1):
        for i in range(n + 1):
            positions.append((size * (i / n - 0.5), 0.0, size * (j / n - 0.5)))
    for j in range(n):
        for i in range(n):
            a, b, c, d = (j * (n + 1) + i, (j + 1) * (n + 1) + i, j * (n + 1) + i + 1, (j + 1) * (n + 1) + i + 1)
            indices += [a, b, c, c, b, d]
    accessors = []
    for values, kind, component, target in ((sum(positions, ()), "VEC3", 5126, 34962),
                                            ((0.0, 1.0, 0.0) * len(positions), "VEC3", 5126, 34962),
                                            (indices, "SCALAR", 5125, 34963)):
        binary += b"\0" * (-len(binary) % 4)
        data = struct.pack(f"<{len(values)}{'f' if component == 5126 else 'I'}", *values)
        document["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data), "target": target})
        count = len(values) // (3 if kind == "VEC3" else 1)
        accessor = {"bufferView": len(document["bufferViews"]) - 1, "componentType": component, "count": count, "type": kind}
        if kind == "VEC3":
            accessor["min"] = [min(values[k::3]) for k in range(3)]
            accessor["max"] = [max(values[k::3]) for k in range(3)]
        document["accessors"].append(accessor)
        accessors.append(len(document["accessors"]) - 1)
        binary += data
    document["buffers"][0]["byteLength"] = len(binary)
    return {"attributes": {"POSITION": accessors[0], "NORMAL": accessors[1]}, "indices": accessors[2]}


def main():
    source, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    (_, text), (kind, binary) = list(chunks_of(source.read_bytes()))[:2]
    document, binary = json.loads(text), bytearray(binary)
    body = document["meshes"][0]
    bounds = [document["accessors"][p["attributes"]["POSITION"]] for p in body["primitives"]]
    low = [min(b["min"][k] for b in bounds) for k in range(3)]
    high = [max(b["max"][k] for b in bounds) for k in range(3)]
    size = math.dist(low, high)
    plate = add_plate(document, binary, 1.5 * size)

    # A mesh of its own for each group: what is baked for one is not there for the next.
    document["materials"], document["meshes"], document["nodes"] = [], [], []
    for key in ("animations", "skins", "cameras"):
        document.pop(key, None)
    roots = []
    for g in range(GROUPS):
        grey = 0.5 + 0.03 * g
        document["materials"].append({"name": f"grey {g}", "pbrMetallicRoughness": {
            "baseColorFactor": [grey, grey, grey, 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0}})
        mesh = copy.deepcopy(body)
        for primitive in mesh["primitives"]:
            primitive["material"] = g
        document["meshes"] += [mesh, {"primitives": [{**plate, "material": g}]}]
        first = len(document["nodes"])
        lift = [-(low[0] + high[0]) / 2, 0.01 * size - low[1], -(low[2] + high[2]) / 2]
        # Sizes differ by hundredths, so that no group is like another.
        scale = 1.0 + 0.01 * g
        document["nodes"] += [
            {"name": f"group {g}", "children": [first + 1, first + 2], "translation": [3.0 * size * g, 0.0, 0.0],
             "extras": {"lambent": {"movable": True}}},
            {"name": f"body {g}", "mesh": 2 * g, "translation": lift, "scale": [scale] * 3},
            {"name": f"plate {g}", "mesh": 2 * g + 1}]
        roots.append(first)
    document["scenes"], document["scene"] = [{"nodes": roots}], 0

    def save(name, change):
        changed = copy.deepcopy(document)
        change(changed)
        write(folder / f"{name}.glb", [(JSON_CHUNK, json.dumps(changed).encode()), (kind, bytes(binary))])

    def nudge(node, by):
        node["translation"] = [t + size * b for t, b in zip(node["translation"], by)]

    save("full", lambda d: None)
    save("albedo", lambda d: d["materials"][3]["pbrMetallicRoughness"].update(baseColorFactor=[0.8, 0.4, 0.2, 1.0]))
    save("node", lambda d: nudge(d["nodes"][3 * 5 + 1], (0.1, 0.0, 0.05)))
    save("group", lambda d: d["nodes"][3 * 7 + 1].update(scale=[0.8] * 3))
    save("carried", lambda d: nudge(d["nodes"][3 * 6], (0.0, 0.5, 0.3)))


if __name__ == "__main__":
    main()
