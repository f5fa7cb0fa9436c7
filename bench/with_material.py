#!/usr/bin/env python3
"""Gives every material of a .glb other factors, so that one model serves for many: writes OUT.glb.

  with_material.py IN.glb OUT.glb [--roughness R] [--metallic M] [--color R,G,B] [--anisotropy S] [--ior N]
                                  [--specular S] [--brdf FILE.brdf]

A measured BRDF is copied beside OUT.glb. Standard library only.
"""
import argparse
import json
import pathlib
import shutil
import struct

JSON_CHUNK = 0x4E4F534A


def chunks_of(data):
    magic, version, length = struct.unpack_from("<III", data, 0)
    if magic != 0x46546C67 or version != 2:
        raise SystemExit("with_material.py: not a GLB 2.0 file; give a .glb")
    at = 12
    while at < length:
        size, kind = struct.unpack_from("<II", data, at)
        yield kind, data[at + 8:at + 8 + size]
        at += 8 + size


def write(path, chunks):
    body = b""
    for kind, bytes_ in chunks:
        padding = (b" " if kind == JSON_CHUNK else b"\0") * (-len(bytes_) % 4)
        body += struct.pack("<II", len(bytes_) + len(padding), kind) + bytes_ + padding
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(body)) + body)


def change(document, a, out):
    used = set(document.get("extensionsUsed", []))
    for material in document.get("materials", []):
        pbr = material.setdefault("pbrMetallicRoughness", {})
        if a.roughness is not None:
            pbr["roughnessFactor"] = a.roughness
        if a.metallic is not None:
            pbr["metallicFactor"] = a.metallic
        if a.color is not None:
            pbr["baseColorFactor"] = [float(c) for c in a.color.split(",")] + [1.0]
        for name, key, value in (("KHR_materials_anisotropy", "anisotropyStrength", a.anisotropy),
                                 ("KHR_materials_ior", "ior", a.ior),
                                 ("KHR_materials_specular", "specularFactor", a.specular)):
            if value is not None:
                material.setdefault("extensions", {}).setdefault(name, {})[key] = value
                used.add(name)
        if a.brdf is not None:
            material.setdefault("extras", {}).setdefault("lambent", {})["brdf"] = a.brdf.name
            if a.brdf.resolve() != (out.parent / a.brdf.name).resolve():
                shutil.copyfile(a.brdf, out.parent / a.brdf.name)
    if used:
        document["extensionsUsed"] = sorted(used)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    for name in ("roughness", "metallic", "anisotropy", "ior", "specular"):
        parser.add_argument("--" + name, type=float)
    parser.add_argument("--color", metavar="R,G,B")
    parser.add_argument("--brdf", type=pathlib.Path)
    a = parser.parse_args()
    chunks = list(chunks_of(a.scene.read_bytes()))
    document = json.loads(chunks[0][1])
    change(document, a, a.out)
    chunks[0] = (JSON_CHUNK, json.dumps(document, separators=(",", ":")).encode())
    write(a.out, chunks)


if __name__ == "__main__":
    main()
