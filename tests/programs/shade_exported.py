"""Shades the vertices of an exported bundle with NumPy alone, and compares them with what the library gives.

Usage: shade_exported.py BUNDLE DIR
"""
import json
import pathlib
import sys

import lambent
import numpy as np

bundle, folder = lambent.Bundle(sys.argv[1]), pathlib.Path(sys.argv[2])
described = json.loads((folder / "bundle.json").read_text())
light = np.load(folder / described["light"]["coefficients"])


def samples_of(group, form):
    """Irradiance / pi, or light in nine bands, at the samples of a group."""
    outputs = {"vector": 1, "normal-mapped": 9}[form]
    lit = np.zeros((group["samples"], outputs, 3))
    for block in group["transfer"]:
        if block["place"] != "surface" or block["form"] != form or block["order"] == 0:
            continue
        values = np.load(folder / block["values"])[..., :block["order"] ** 2]
        if block["fullChannels"]:
            values = values[:, block["shadowedChannels"]:]
        values = np.broadcast_to(values, (values.shape[0], 3) + values.shape[2:])
        begin = block["firstSample"]
        lit[begin:begin + block["samples"]] += np.einsum("scoi,ic->soc", values, light[:values.shape[3]])
    return lit


largest, compared = 0.0, 0
for index, surface in enumerate(described["surfaces"]):
    if surface["form"] not in ("vector", "normal-mapped"):
        continue
    load = lambda name: np.load(folder / surface[name])  # noqa: E731
    lit = samples_of(described["groups"][surface["group"]], surface["form"])
    terms = load("rowWeights")[:, None, None] * lit[load("rowSamples")]
    at_vertices = np.add.reduceat(terms, load("rowOffsets")[:-1].astype(int))
    if surface["form"] == "normal-mapped":  # convolved with the cosine at the vertex's normal
        bands = np.repeat([1.0, 2 / 3, 1 / 4], [1, 3, 5])
        cosine = bands * lambent.harmonics(3, load("normals"))
        at_vertices = np.einsum("vj,vjc->vc", cosine, at_vertices)
    else:
        at_vertices = at_vertices[:, 0]
    largest = max(largest, float(np.abs(at_vertices - bundle.shade(index, light)).max()))
    compared += len(at_vertices)
print(f"{compared} vertices, largest difference {largest:.2e}")
sys.exit(0 if compared > 1000 and largest < 1e-3 else 1)
