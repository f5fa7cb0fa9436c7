#!/usr/bin/env python3
"""Bytes per vertex against error, from the CSV of bench_codes, as SVG:

    bench_codes SCENE --albedo=0.8,0.5,0.3 --csv ... > codes.csv
    bench/plot_codes.py codes.csv docs/pictures/bytes_per_vertex.svg
"""
import csv
import math
import pathlib
import sys

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 720, 420, 60, 210, 30, 50
COLORS = ["#1b6ca8", "#c0392b", "#3c8d40", "#8e5ea2"]


def read(path):
    curves = {}
    with open(path, newline="") as file:
        for row in csv.reader(file):
            if not row or row[0] == "scene":
                continue
            name = pathlib.Path(row[0]).stem
            kind = "one cluster" if float(row[9]) == 0.0 else "clustered"  # a cluster in each cell: no ids
            curves.setdefault((name, kind), []).append((100 * float(row[11]), float(row[7])))
    return {key: sorted(points) for key, points in curves.items()}


def main(source, target):
    curves = read(source)
    most = max(y for points in curves.values() for _, y in points) * 1.05
    low, high = math.log(0.08), math.log(1.25)

    def place(error, size):
        x = LEFT + (math.log(error) - low) / (high - low) * (WIDTH - LEFT - RIGHT)
        return x, HEIGHT - BOTTOM - size / most * (HEIGHT - TOP - BOTTOM)

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
           'font-family="sans-serif" font-size="12">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>']
    for size in range(0, int(most) + 1, 8):
        (x0, y), (x1, _) = place(0.08, size), place(1.25, size)
        out.append(f'<path d="M{x0:.1f} {y:.1f}H{x1:.1f}" stroke="#ddd"/>'
                   f'<text x="{x0 - 8:.1f}" y="{y + 4:.1f}" text-anchor="end">{size}</text>')
    for error in (0.1, 0.3, 0.5, 1.0):
        x, y = place(error, 0)
        out.append(f'<path d="M{x:.1f} {TOP}V{y:.1f}" stroke="#ddd"/>'
                   f'<text x="{x:.1f}" y="{y + 18:.1f}" text-anchor="middle">{error:g} %</text>')
    out.append(f'<text x="{LEFT}" y="{TOP - 12}">bytes a vertex (codebook, ids and weights) against relative '
               'error of shaded radiance</text>')
    for i, name in enumerate(sorted({name for name, _ in curves})):
        for kind, dash in (("clustered", ""), ("one cluster", ' stroke-dasharray="5 4"')):
            points = [place(*point) for point in curves.get((name, kind), [])]
            if not points:
                continue
            path = "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
            out.append(f'<path d="M{path}" fill="none" stroke="{COLORS[i]}" stroke-width="2"{dash}/>')
            out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{COLORS[i]}"/>' for x, y in points]
            row = TOP + 20 + 40 * i + (18 if dash else 0)
            out.append(f'<path d="M{WIDTH - RIGHT + 15} {row}h30" stroke="{COLORS[i]}" stroke-width="2"{dash}/>'
                       f'<text x="{WIDTH - RIGHT + 52}" y="{row + 4}">{name}, {kind}</text>')
    out.append("</svg>")
    pathlib.Path(target).write_text("\n".join(out) + "\n")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
