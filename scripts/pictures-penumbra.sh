#!/bin/sh
# pictures-penumbra.sh OUT.png: shadows of a post and a ball on a floor under discs of light of 0.27 to 60 degrees' radius, by
# transfer of orders 2, 3, 5 and 8 alone, with key lights, and path-traced. From a build folder (bin/, the programs); bundles
# and tiles are kept in ${TMPDIR:-/tmp}/lambent-penumbra, and what is there is not made again. Needs python3 and ImageMagick
# (convert, montage). BIN=FOLDER takes the programs from elsewhere, SPP=N sets the reference's samples a pixel.
set -eu
out=$1
bin=${BIN:-bin}
spp=${SPP:-256}
work=${TMPDIR:-/tmp}/lambent-penumbra
mkdir -p "$work"
scene=$work/penumbra.glb

# The floor's vertices lie 16 mm apart, so that the order of the transfer is the limit, not the vertices.
[ -f "$scene" ] || python3 - "$scene" << 'PYTHON'
import json, math, struct, sys

def grid(across, along, at):
    """A net of quads: at(u, v) gives position and normal; triangles face along the normals."""
    points = [at(i / across, j / along) for j in range(along + 1) for i in range(across + 1)]
    triangles = []
    for j in range(along):
        for i in range(across):
            a = j * (across + 1) + i
            b, c, d = a + 1, a + across + 1, a + across + 2
            for t in ((a, c, b), (b, c, d)):
                p, q, r = (points[k][0] for k in t)
                u, v = [q[k] - p[k] for k in range(3)], [r[k] - p[k] for k in range(3)]
                cross = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
                along_normal = sum(cross[k] * sum(points[m][1][k] for m in t) for k in range(3))
                if abs(along_normal) > 1e-12:
                    triangles.append(t if along_normal > 0 else (t[0], t[2], t[1]))
    return [p for p, _ in points], [n for _, n in points], triangles

def joined(parts):
    positions, normals, triangles = [], [], []
    for p, n, t in parts:
        triangles += [tuple(len(positions) + i for i in corner) for corner in t]
        positions += p
        normals += n
    return positions, normals, triangles

def box(x, z, half, height, step):
    up, side = round(height / step), round(2 * half / step)
    def wall(axis, sign):
        def at(u, v):
            a = half * (2 * u - 1)
            return ((x + sign * half, height * v, z + a) if axis == 0 else (x + a, height * v, z + sign * half),
                    (sign, 0, 0) if axis == 0 else (0, 0, sign))
        return grid(side, up, at)
    top = grid(side, side, lambda u, v: ((x + half * (2 * u - 1), height, z + half * (2 * v - 1)), (0, 1, 0)))
    return joined([wall(0, -1), wall(0, 1), wall(2, -1), wall(2, 1), top])

def ball(x, y, z, radius):
    def at(u, v):
        t, p = math.pi * v, 2 * math.pi * u
        n = (math.sin(t) * math.cos(p), math.cos(t), math.sin(t) * math.sin(p))
        return tuple(c + radius * k for c, k in zip((x, y, z), n)), n
    return grid(64, 32, at)

floor = grid(250, 250, lambda u, v: ((4 * u - 2, 0, 4 * v - 2.4), (0, 1, 0)))
meshes = [("floor", floor, (0.75, 0.75, 0.75)), ("post", box(-0.65, -0.25, 0.09, 1.05, 0.03), (0.75, 0.42, 0.18)),
          ("ball", ball(-0.4, 0.42, 0.78, 0.24), (0.2, 0.35, 0.7))]
gltf = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2, 3]}], "nodes": [], "meshes": [], "materials": [],
        "accessors": [], "bufferViews": [], "buffers": [{}]}
data = b""
for index, (name, (positions, normals, triangles), color) in enumerate(meshes):
    def add(values, code, kind, component, **more):
        global data
        raw = struct.pack("<%d%s" % (len(values) * len(values[0]), code), *(x for row in values for x in row))
        gltf["bufferViews"].append({"buffer": 0, "byteOffset": len(data), "byteLength": len(raw)})
        count = len(values) * (len(values[0]) if kind == "SCALAR" else 1)
        gltf["accessors"].append({"bufferView": len(gltf["bufferViews"]) - 1, "componentType": component, "count": count,
                                  "type": kind, **more})
        data += raw
        return len(gltf["accessors"]) - 1
    low, high = ([float(f(p[k] for p in positions)) for k in range(3)] for f in (min, max))
    attributes = {"POSITION": add(positions, "f", "VEC3", 5126, min=low, max=high), "NORMAL": add(normals, "f", "VEC3", 5126)}
    indices = add(triangles, "I", "SCALAR", 5125)
    gltf["materials"].append({"name": name, "pbrMetallicRoughness": {"baseColorFactor": [*color, 1], "metallicFactor": 0,
                                                                     "roughnessFactor": 1}})
    gltf["meshes"].append({"name": name, "primitives": [{"attributes": attributes, "indices": indices, "material": index}]})
    gltf["nodes"].append({"name": name, "mesh": index})
def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return [x / length for x in v]
eye, target = (0.3, 2.3, 2.5), (-0.08, 0.22, 0.12)
back = unit([a - b for a, b in zip(eye, target)])
right = unit([back[2], 0, -back[0]])
above = [back[1] * right[2] - back[2] * right[1], back[2] * right[0] - back[0] * right[2], back[0] * right[1] - back[1] * right[0]]
gltf["cameras"] = [{"name": "main", "type": "perspective", "perspective": {"yfov": math.radians(31), "aspectRatio": 4 / 3,
                                                                           "znear": 0.1, "zfar": 20}}]
gltf["nodes"].append({"name": "main", "camera": 0, "matrix": [*right, 0, *above, 0, *back, 0, *eye, 1]})
gltf["buffers"][0]["byteLength"] = len(data)
text = json.dumps(gltf).encode()
text += b" " * (-len(text) % 4)
with open(sys.argv[1], "wb") as file:
    file.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(data)))
    file.write(struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data)
PYTHON

for order in 2 3 5 8; do
  bundle=$work/order-$order.lmb.glb
  [ -f "$bundle" ] || "$bin/lambent" bake "$scene" -o "$bundle" --order $order --rays 1024 --bounces 0 --refine off
done

# All discs stand 45 degrees high and give a surface that faces them the irradiance 2.6: their radiance is 2.6 over
# pi sin² of their radius. What of the widest is below the floor is lost. The sky adds an irradiance of 0.4.
tile() {  # NAME PROGRAM ARGUMENTS...
  name=$1
  shift
  [ -f "$work/$name.exr" ] || "$@" --camera main --size 480x360 > /dev/null
  # Linear, so that all are toned in one way. Transfer rings: what is below zero is shown as black.
  [ -f "$work/$name.png" ] ||
    convert "$work/$name.exr" -alpha off -set colorspace RGB -resize 160x120 -colorspace sRGB -depth 8 "$work/$name.png"
}
for angle in 0.27 5 15 30 60; do
  radiance=$(python3 -c "import math; print(2.6 / (math.pi * math.sin(math.radians($angle)) ** 2))")
  light="--light sun:-75,45,$angle,$radiance --light constant:0.13,0.13,0.13"
  for order in 2 3 5 8; do
    tile "order-$order-$angle" "$bin/lambent-demo" "$work/order-$order.lmb.glb" $light --keys off --window off \
      --headless "$work/order-$order-$angle.exr"
  done
  tile "keys-$angle" "$bin/lambent-demo" "$work/order-5.lmb.glb" $light --headless "$work/keys-$angle.exr"
  [ -f "$work/reference-$angle.exr" ] ||
    "$bin/lambent" reference "$scene" $light --bounces 0 --spp "$spp" --camera main --size 480x360 -o "$work/reference-$angle.exr" > /dev/null
  tile "reference-$angle" true
done

set --
for row in order-2 order-3 order-5 order-8 keys reference; do
  case $row in
    order-*) title="order ${row#order-}" ;;
    keys) title="key lights" ;;
    reference) title="path-traced" ;;
  esac
  convert -size 92x120 xc:white -gravity center -font DejaVu-Sans -pointsize 14 -fill '#202020' -annotate 0 "$title" "$work/title-$row.png"
  set -- "$@" "$work/title-$row.png"
  for angle in 0.27 5 15 30 60; do set -- "$@" "$work/$row-$angle.png"; done
done
montage "$@" -tile 6x6 -geometry +2+2 -background white "$work/tiles.png"
convert -size 96x24 xc:white "$work/heads.png"
for angle in 0.27 5 15 30 60; do
  convert -size 164x24 xc:white -gravity center -font DejaVu-Sans -pointsize 14 -fill '#202020' -annotate 0 "$angle°" "$work/head.png"
  convert "$work/heads.png" "$work/head.png" +append "$work/heads.png"
done
convert "$work/heads.png" "$work/tiles.png" -append -depth 8 -strip "$out"
