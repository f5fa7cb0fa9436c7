#!/usr/bin/env python3
"""How many bands does a shadow need? Bakes a ball on a floor from arrays, lights it by a sun of 10 degrees in a grey sky,
and holds each order against the exact light on the floor.

Usage: orders.py OUT.png            (needs the module lambent, NumPy and matplotlib; see docs/python.md)
"""
import pathlib
import sys
import tempfile

import lambent
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

# %% A floor of squares, and a ball of radius 1 that lies on it.
line = np.linspace(-4, 4, 65)
x, z = np.meshgrid(line, line)
floor = np.stack([x, 0 * x, z], axis=-1).reshape(-1, 3)
corner = (np.arange(64)[:, None] * 65 + np.arange(64)).reshape(-1)
squares = np.stack([corner, corner + 65, corner + 1, corner + 1, corner + 65, corner + 66], axis=-1).reshape(-1, 3)

a, b = np.meshgrid(np.linspace(0, np.pi, 33), np.linspace(0, 2 * np.pi, 65), indexing="ij")
ball = np.stack([np.sin(a) * np.sin(b), np.cos(a), np.sin(a) * np.cos(b)], axis=-1).reshape(-1, 3)
corner = (np.arange(32)[:, None] * 65 + np.arange(64)).reshape(-1)
faces = np.stack([corner, corner + 65, corner + 1, corner + 1, corner + 65, corner + 66], axis=-1).reshape(-1, 3)
lift = np.eye(4)
lift[1, 3] = 1

# %% Bake once, with all eight bands. Bounces are left out, since the exact light below has none.
with tempfile.TemporaryDirectory() as folder:
    path = str(pathlib.Path(folder) / "ball.lmb.glb")
    lambent.bake([dict(name="floor", positions=floor, triangles=squares),
                  dict(name="ball", positions=ball, normals=ball, triangles=faces, world_from_mesh=lift)],
                 path, order=8, rays=4096, bounces=0, refine="off", codes=0.002, effects="diffuse")
    bundle = lambent.Bundle(path)
surface = next(i for i, s in enumerate(bundle.surfaces) if s.mesh == "floor")
points = bundle.surface(surface)["positions"]

# %% The exact light on the floor: what the ball leaves of the sky, and of the disc of the sun.
sun_radius, sun_radiance, sky = np.radians(10), 20.0, 0.5
to_sun = np.array([np.sin(np.radians(60)) * np.cos(np.radians(45)), np.sin(np.radians(45)), np.cos(np.radians(60)) * np.cos(np.radians(45))])
to_ball = np.array([0, 1, 0]) - points
distance = np.linalg.norm(to_ball, axis=1)
height = to_ball[:, 1] / distance  # a ball above the horizon takes sin² of its radius times the cosine to its centre
exact = sky * (1 - height / np.maximum(distance, 1) ** 2)
side = np.cross(to_sun, [0, 1, 0])
side /= np.linalg.norm(side)
steps = (np.arange(48) + 0.5) / 48
for share in steps:  # rings of the disc that have the same solid angle
    cosine = 1 - share * (1 - np.cos(sun_radius))
    for turn in 2 * np.pi * steps:
        across = np.cos(turn) * side + np.sin(turn) * np.cross(side, to_sun)
        d = cosine * to_sun + np.sqrt(1 - cosine**2) * across
        along = to_ball @ d
        seen = (along < 0) | ((to_ball**2).sum(axis=1) - along**2 > 1)
        exact += seen * sun_radiance * d[1] * 2 * (1 - np.cos(sun_radius)) / len(steps) ** 2

# %% Light it with 2 to 8 bands, and look at the error.
words = [f"sun:60,45,10,{sun_radiance},{sun_radiance},{sun_radiance}", f"constant:{sky},{sky},{sky}"]
beyond = distance > 1.2  # beside the point of contact
errors = {}
for order in range(2, 9):
    shown = bundle.shade(surface, lambent.light(words, order))[:, 0]
    errors[order] = np.sqrt(np.mean((shown - exact)[beyond] ** 2) / np.mean(exact[beyond] ** 2))
    print(f"order {order}: {100 * errors[order]:5.2f} %")

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.5))
left.plot(list(errors), [100 * e for e in errors.values()], "o-")
left.set(xlabel="order (bands)", ylabel="relative RMS error on the floor, %", ylim=(0, None))
row = np.abs(points[:, 2] - 0.5) < 1e-3
by_x = np.argsort(points[row, 0])
right.plot(points[row, 0][by_x], exact[row][by_x], "k", label="exact")
for order in (3, 5, 8):
    right.plot(points[row, 0][by_x], bundle.shade(surface, lambent.light(words, order))[row, 0][by_x], label=f"order {order}")
right.set(xlabel="across the shadow, m", ylabel="E / π")
right.legend()
figure.tight_layout()
figure.savefig(sys.argv[1], dpi=120)
