#!/usr/bin/env python3
"""Writes small scenes in which one body changes the light of what it floats above: for neighborhood_errors.sh.

  neighborhood_scene.py KIND OUT.glb [--color R,G,B] [--floor ALBEDO] [--grid XxYxZ] [--extent XxYxZ]

KIND: ball, a matte ball above a plain floor; ring, a polished band of metal standing just above a plain floor, which
gathers light inside; hills, the ball above hills that shade themselves; pair, two balls that nearly touch, whose shadows
overlap. The body may move and asks for a neighborhood;
so many points of grid, or as many as the bake gives. Cameras: "whole" sees everything, "floor" only what is below the
body. Metres. Standard library only.
"""
import argparse
import json
import math
import pathlib
import struct

BALL_RADIUS, BALL_HEIGHT = 0.5, 1.5
RING_RADIUS, RING_WIDTH, RING_THICKNESS, RING_HEIGHT = 1.0, 0.45, 0.03, 0.35
FLOOR_SIZE, FLOOR_CELLS = 10.0, 120


def grid_mesh(across, along, at, closed_across=False):
    """A net of quads: at(u, v) gives position and normal, u and v in 0..1."""
    positions, normals, triangles = [], [], []
    for j in range(along + 1):
        for i in range(across + 1):
            position, normal = at(i / across, j / along)
            length = math.sqrt(sum(x * x for x in normal))
            positions.append(position)
            normals.append([x / length for x in normal])
    for j in range(along):
        for i in range(across):
            a = j * (across + 1) + i
            b, c, d = a + 1, a + across + 1, a + across + 2
            triangles += [(a, c, b), (b, c, d)]
    return positions, normals, triangles


def facing_out(mesh):
    """Turns triangles whose corners run against their normals; drops those without area."""
    positions, normals, triangles = mesh
    kept = []
    for a, b, c in triangles:
        u = [positions[b][k] - positions[a][k] for k in range(3)]
        v = [positions[c][k] - positions[a][k] for k in range(3)]
        cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
        along = sum(cross[k] * (normals[a][k] + normals[b][k] + normals[c][k]) for k in range(3))
        if abs(along) > 1e-12:
            kept.append((a, b, c) if along > 0 else (a, c, b))
    return positions, normals, kept


def ball(radius, around=96, down=48):
    def at(u, v):
        t, p = math.pi * v, 2 * math.pi * u
        n = [math.sin(t) * math.cos(p), math.cos(t), math.sin(t) * math.sin(p)]
        return [radius * x for x in n], n
    return facing_out(grid_mesh(around, down, at))


def ring(radius, width, thickness, around=192):
    """A closed band about +Y, its flat sides with normals of their own."""
    inner, half = radius - thickness, width / 2
    positions, normals, triangles = [], [], []
    sides = (((inner, -half), (inner, half), (-1, 0), 12), ((radius, half), (radius, -half), (1, 0), 12),
             ((inner, half), (radius, half), (0, 1), 1), ((radius, -half), (inner, -half), (0, -1), 1))
    for (r0, y0), (r1, y1), (out, up), steps in sides:
        def at(u, v):
            p = 2 * math.pi * u
            r, y = r0 + (r1 - r0) * v, y0 + (y1 - y0) * v
            return [r * math.cos(p), y, r * math.sin(p)], [out * math.cos(p), up, out * math.sin(p)]
        part = grid_mesh(around, steps, at)
        base = len(positions)
        positions += part[0]
        normals += part[1]
        triangles += [tuple(base + i for i in t) for t in part[2]]
    return facing_out((positions, normals, triangles))


def floor(height=lambda x, z: 0.0):
    step = 1e-3

    def at(u, v):
        x, z = FLOOR_SIZE * (u - 0.5), FLOOR_SIZE * (v - 0.5)
        slope_x = (height(x + step, z) - height(x - step, z)) / (2 * step)
        slope_z = (height(x, z + step) - height(x, z - step)) / (2 * step)
        return [x, height(x, z), z], [-slope_x, 1.0, -slope_z]
    return facing_out(grid_mesh(FLOOR_CELLS, FLOOR_CELLS, at))


def hills(x, z):
    return 0.18 * (math.sin(2.6 * x) * math.cos(2.2 * z) + 0.5 * math.sin(4.1 * z + 1.0) * math.cos(3.3 * x + 0.5)) - 0.2


class Document:
    def __init__(self):
        self.bytes = b""
        self.json = {"asset": {"version": "2.0", "generator": "neighborhood_scene.py"}, "scene": 0,
                     "scenes": [{"nodes": []}], "nodes": [], "meshes": [], "materials": [], "accessors": [],
                     "bufferViews": [], "cameras": []}

    def accessor(self, rows, kind, component, code):
        flat = [x for row in rows for x in row]
        data = struct.pack("<%d%s" % (len(flat), code), *flat)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(data)})
        self.bytes += data
        entry = {"bufferView": len(self.json["bufferViews"]) - 1, "componentType": component, "type": kind,
                 "count": len(flat) if kind == "SCALAR" else len(rows)}
        if kind == "VEC3":
            entry["min"] = [min(row[k] for row in rows) for k in range(3)]
            entry["max"] = [max(row[k] for row in rows) for k in range(3)]
        self.json["accessors"].append(entry)
        return len(self.json["accessors"]) - 1

    def body(self, name, mesh, material, place=(0, 0, 0), lambent=None):
        positions, normals, triangles = mesh
        primitive = {"attributes": {"POSITION": self.accessor(positions, "VEC3", 5126, "f"),
                                    "NORMAL": self.accessor(normals, "VEC3", 5126, "f")},
                     "indices": self.accessor(triangles, "SCALAR", 5125, "I"),
                     "material": len(self.json["materials"])}
        self.json["materials"].append(dict(material, name=name))
        self.json["meshes"].append({"name": name, "primitives": [primitive]})
        node = {"name": name, "mesh": len(self.json["meshes"]) - 1, "translation": list(place)}
        if lambent:
            node["extras"] = {"lambent": lambent}
        self.add(node)

    def camera(self, name, place, turn, yfov):
        """turn: degrees down from level."""
        self.json["cameras"].append({"name": name, "type": "perspective",
                                     "perspective": {"yfov": math.radians(yfov), "znear": 0.01, "zfar": 100}})
        half = math.radians(-turn) / 2
        self.add({"name": name, "camera": len(self.json["cameras"]) - 1, "translation": list(place),
                  "rotation": [math.sin(half), 0, 0, math.cos(half)]})

    def add(self, node):
        self.json["scenes"][0]["nodes"].append(len(self.json["nodes"]))
        self.json["nodes"].append(node)

    def write(self, path):
        self.json["buffers"] = [{"byteLength": len(self.bytes)}]
        text = json.dumps(self.json, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        body = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(self.bytes), 0x004E4942) + self.bytes
        path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(body)) + body)


def matte(color):
    return {"pbrMetallicRoughness": {"baseColorFactor": list(color) + [1], "metallicFactor": 0, "roughnessFactor": 1},
            "extensions": {"KHR_materials_specular": {"specularFactor": 0}}}


def metal(color, roughness):
    return {"pbrMetallicRoughness": {"baseColorFactor": list(color) + [1], "metallicFactor": 1,
                                     "roughnessFactor": roughness}}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("kind", choices=("ball", "ring", "hills", "pair"))
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--color", metavar="R,G,B", help="of the body")
    parser.add_argument("--floor", type=float, default=0.5, help="albedo")
    parser.add_argument("--grid", metavar="XxYxZ", help="points")
    parser.add_argument("--extent", metavar="XxYxZ", help="metres that they cover")
    a = parser.parse_args()
    color = [float(c) for c in a.color.split(",")] if a.color else None
    neighborhood = {}
    if a.grid:
        neighborhood["size"] = [int(n) for n in a.grid.split("x")]
    if a.extent:
        neighborhood["extent"] = [float(n) for n in a.extent.split("x")]
    lambent = {"movable": True, "neighborhood": neighborhood}

    document = Document()
    document.json["extensionsUsed"] = ["KHR_materials_specular"]
    document.body("floor", floor(hills) if a.kind == "hills" else floor(), matte([a.floor] * 3))
    if a.kind == "ring":
        document.body("ring", ring(RING_RADIUS, RING_WIDTH, RING_THICKNESS), metal(color or [0.95, 0.9, 0.8], 0.05),
                      (0, RING_HEIGHT, 0), lambent)
        # From within the band's mouth: the floor that it encloses and nothing of the band.
        document.camera("floor", (0, 1.2, 0), 90, 56)
        document.camera("whole", (0, 3.2, 3.2), 45, 45)
    else:
        document.body("ball", ball(BALL_RADIUS), matte(color or [0.8, 0.3, 0.15]), (0, BALL_HEIGHT, 0), lambent)
        if a.kind == "pair":
            document.body("other ball", ball(BALL_RADIUS), matte([0.2, 0.4, 0.7]),
                          (2.1 * BALL_RADIUS, BALL_HEIGHT, 0), lambent)
        document.camera("floor", (0, BALL_HEIGHT - 1.05 * BALL_RADIUS, 0), 90, 115)
        document.camera("whole", (0, 3.2, 4.2), 35, 45)
    document.write(a.out)


if __name__ == "__main__":
    main()
