#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Draws docs/figures/profile_suite.svg, time and error of each stack, from what profile_suite prints.

    profile_suite > suite.txt; plot_profile_suite.py suite.txt... > profile_suite.svg
"""
import math
import sys

COLORS = {"normal": "#0072b2", "oblique": "#d55e00", "diffuse": "#009e73"}
LEFT, TOP, WIDTH, HEIGHT = 60, 20, 400, 280
TIMES, ERRORS = (0.1, 10.0), (1e-4, 1.0)


def stacks(files):
    for file in files:
        for line in open(file):
            cells = [cell.strip() for cell in line.split("|")]
            if cells[0].startswith("stack") or len(cells) < 7:
                continue
            light = cells[0].split(" ", 1)[1].split(",")[0]
            yield light, float(cells[2]), [[float(x) for x in cell.split()] for cell in cells[4:6]]


def place(value, limits):
    low, high = (math.log10(limit) for limit in limits)
    return (math.log10(min(max(value, limits[0]), limits[1])) - low) / (high - low)


def panel(x, side, title, rows):
    def across(seconds):
        return LEFT + WIDTH * place(seconds, TIMES)

    def up(error):
        return TOP + HEIGHT * (1 - place(error, ERRORS))

    out = [f'<g transform="translate({x},40)">',
           f'<rect x="{LEFT}" y="{TOP}" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#444"/>']
    for seconds in (0.1, 0.2, 0.5, 1, 2, 5, 10):
        at = across(seconds)
        out.append(f'<line x1="{at:.1f}" x2="{at:.1f}" y1="{TOP}" y2="{TOP + HEIGHT}" stroke="#e4e4e4"/>'
                   f'<text x="{at:.1f}" y="{TOP + HEIGHT + 18}" text-anchor="middle">{seconds:g}</text>')
    for error, name in ((1e-4, "≤ .01 %"), (1e-3, ".1 %"), (5e-3, ".5 %"), (0.1, "10 %"), (1, "100 %")):
        color = "#c44" if error == 5e-3 else "#e4e4e4"
        out.append(f'<line x1="{LEFT}" x2="{LEFT + WIDTH}" y1="{up(error):.1f}" y2="{up(error):.1f}" stroke="{color}"/>'
                   f'<text x="{LEFT - 6}" y="{up(error) + 4:.1f}" text-anchor="end">{name}</text>')
    for light, seconds, sides in rows:
        bins, _, mean, noise = sides[side][:4]
        if bins == 0:
            continue
        own = math.sqrt(max(0.0, mean**2 - noise**2))
        out.append(f'<circle cx="{across(seconds):.1f}" cy="{up(own):.1f}" r="3.2" fill="{COLORS[light]}" '
                   'fill-opacity=".75"/>')
    for i, (light, color) in enumerate(COLORS.items()):
        out.append(f'<circle cx="{LEFT + 14}" cy="{TOP + 16 + 16 * i}" r="3.2" fill="{color}"/>'
                   f'<text x="{LEFT + 22}" y="{TOP + 20 + 16 * i}">'
                   f'{light + (" light" if light == "diffuse" else " beam")}</text>')
    out.append(f'<text x="{LEFT + WIDTH / 2}" y="{TOP + HEIGHT + 38}" text-anchor="middle">CPU seconds</text>'
               f'<text x="{LEFT}" y="{TOP - 8}" font-weight="600">{title}</text></g>')
    return "\n".join(out)


def main(files):
    rows = list(stacks(files))
    print('<svg xmlns="http://www.w3.org/2000/svg" width="1040" height="410" viewBox="0 0 1040 410" '
          'font-family="Inter, Helvetica, Arial, sans-serif" font-size="12">'
          '<rect width="100%" height="100%" fill="#fff"/>'
          f'<text x="20" y="26" font-size="16" font-weight="600">{len(rows)} random stacks: time, and mean error by '
          "flux, the photons’ noise taken out</text>")
    print(panel(0, 0, "R(r)", rows))
    print(panel(520, 1, "T(r)", rows))
    print("</svg>")


if __name__ == "__main__":
    main(sys.argv[1:])
