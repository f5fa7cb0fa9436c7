#!/usr/bin/env python3
"""Bytes per vertex of visibility against error, a curve for each number of clusters, as SVG and as a table:

    bench_glossy_codes SCENE --bounces=0 --grid --csv > grid.csv
    bench/plot_glossy_codes.py grid.csv docs/pictures/glossy_bytes.svg
"""
import csv
import math
import sys

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 720, 420, 60, 150, 34, 46
COLORS = ["#1b6ca8", "#c0392b", "#3c8d40", "#8e5ea2", "#b07d10", "#333333"]


def read(path):
    curves = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            if row["part"] == "visibility":
                curves.setdefault(int(row["clusters_asked"]), []).append(
                    (int(row["axes_asked"]), float(row["bytes"]), 100 * float(row["part_error"])))
    return curves


def table(curves):
    axes = [a for a, _, _ in next(iter(curves.values()))]
    print("| clusters | " + " | ".join(f"n' = {a}" for a in axes) + " |")
    print("|---" * (len(axes) + 1) + "|")
    for clusters, points in curves.items():
        print(f"| {clusters} | " + " | ".join(f"{size:.1f}, {error:.1f} %" for _, size, error in points) + " |")


def main(source, target):
    curves = read(source)
    points = [p for curve in curves.values() for p in curve]
    x_of = [math.log(f(p[1] for p in points)) for f in (min, max)]
    y_of = [math.log(f(p[2] for p in points)) for f in (min, max)]

    def place(size, error):
        x = LEFT + (math.log(size) - x_of[0]) / (x_of[1] - x_of[0]) * (WIDTH - LEFT - RIGHT)
        y = HEIGHT - BOTTOM - (math.log(error) - y_of[0]) / (y_of[1] - y_of[0]) * (HEIGHT - TOP - BOTTOM)
        return x, y

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" '
           f'font-size="12"><rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
           f'<text x="{LEFT}" y="18">error of reflected light, %, against bytes a vertex; n\' = 0, 1, 2, 4, 8, 16 axes '
           'along each curve</text>']
    for error in (2, 5, 10, 20, 50):
        if y_of[0] <= math.log(error) <= y_of[1]:
            _, y = place(1, error)
            out.append(f'<path d="M{LEFT} {y:.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>'
                       f'<text x="{LEFT - 8}" y="{y + 4:.1f}" text-anchor="end">{error} %</text>')
    for size in (0.1, 1, 2, 5, 10, 20, 30):
        if x_of[0] <= math.log(size) <= x_of[1]:
            x, _ = place(size, 10)
            out.append(f'<path d="M{x:.1f} {TOP}V{HEIGHT - BOTTOM}" stroke="#ddd"/>'
                       f'<text x="{x:.1f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle">{size:g}</text>')
    for i, (clusters, curve) in enumerate(curves.items()):
        at = [place(size, error) for _, size, error in curve]
        path = "L".join(f"{x:.1f} {y:.1f}" for x, y in at)
        out.append(f'<path d="M{path}" fill="none" stroke="{COLORS[i]}" stroke-width="2"/>')
        out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{COLORS[i]}"/>' for x, y in at]
        row = TOP + 20 + 20 * i
        out.append(f'<path d="M{WIDTH - RIGHT + 15} {row}h24" stroke="{COLORS[i]}" stroke-width="2"/>'
                   f'<text x="{WIDTH - RIGHT + 45}" y="{row + 4}">{clusters} clusters</text>')
    with open(target, "w") as file:
        file.write("\n".join(out) + "</svg>\n")
    table(curves)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
