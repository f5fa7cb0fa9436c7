#!/usr/bin/env python3
"""Error under a near light against the number of light samples, from the CSV of shadowed_light.sh, as SVG:

    bench/plot_shadowed_light.py shadowed_light.csv docs/pictures/near-light.svg
"""
import csv
import math
import pathlib
import sys

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 720, 420, 60, 210, 30, 50
COLORS = ["#3c8d40", "#1b6ca8", "#8e5ea2", "#c0392b"]
FAR = 0.01  # below this ratio a light is as good as at infinity


def read(path):
    curves = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            curves.setdefault(float(row["ratio"]), []).append((int(row["samples"]), float(row["error"])))
    return {ratio: sorted(points) for ratio, points in sorted(curves.items())}


def main(source, target):
    curves = read(source)
    errors = [error for points in curves.values() for _, error in points]
    low, high = math.floor(math.log10(min(errors))), math.ceil(math.log10(max(errors)))
    counts = sorted({count for points in curves.values() for count, _ in points})
    first, last = math.log2(counts[0]), math.log2(counts[-1])

    def place(count, error):
        x = LEFT + (math.log2(count) - first) / (last - first) * (WIDTH - LEFT - RIGHT)
        return x, HEIGHT - BOTTOM - (math.log10(error) - low) / (high - low) * (HEIGHT - TOP - BOTTOM)

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
           'font-family="sans-serif" font-size="12">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>']
    for power in range(low, high + 1):
        for step in (1, 2, 5) if power < high else (1,):
            error = step * 10.0**power
            (x0, y), (x1, _) = place(counts[0], error), place(counts[-1], error)
            out.append(f'<path d="M{x0:.1f} {y:.1f}H{x1:.1f}" stroke="#ddd"/>'
                       f'<text x="{x0 - 8:.1f}" y="{y + 4:.1f}" text-anchor="end">{error:g} %</text>')
    for count in counts:
        x, y = place(count, 10.0**low)
        out.append(f'<path d="M{x:.1f} {TOP}V{y:.1f}" stroke="#ddd"/>'
                   f'<text x="{x:.1f}" y="{y + 18:.1f}" text-anchor="middle">{count}</text>')
    out.append(f'<text x="{LEFT}" y="{TOP - 12}">error of the picture against light samples</text>'
               f'<text x="{WIDTH - RIGHT + 15}" y="{TOP + 6}">half-size / distance of the light</text>')
    near = [ratio for ratio in curves if ratio >= FAR]
    order = near[::-1] + [ratio for ratio in curves if ratio < FAR]
    for line, ratio in enumerate(order):
        color, dash = ("#777", ' stroke-dasharray="5 4"') if ratio < FAR else (COLORS[near.index(ratio) % 4], "")
        points = [place(*point) for point in curves[ratio]]
        out.append('<path d="M' + "L".join(f"{x:.1f} {y:.1f}" for x, y in points) +
                   f'" fill="none" stroke="{color}" stroke-width="2"{dash}/>')
        out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{color}"/>' for x, y in points]
        row = TOP + 28 + 20 * line
        out.append(f'<path d="M{WIDTH - RIGHT + 15} {row}h30" stroke="{color}" stroke-width="2"{dash}/>'
                   f'<text x="{WIDTH - RIGHT + 52}" y="{row + 4}">'
                   f'{f"{ratio:g}" if ratio >= FAR else "as good as infinity"}</text>')
    out.append("</svg>")
    pathlib.Path(target).write_text("\n".join(out) + "\n")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
