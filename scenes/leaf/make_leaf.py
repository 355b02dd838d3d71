#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Draws the maps of scenes/leaf and bends the sheets that they lie on.

    make_leaf.py FOLDER

One leaf of length 1 along +y, its stalk at the origin: outline.png, thickness.png (255 is the
thickest, the midrib), color.png (over the mean leaf), and three meshes: flat.obj and curled.obj,
rectangles that outline.png cuts, and blade.obj, which ends where the leaf does.
"""
import pathlib
import struct
import sys
import zlib

import numpy as np

WIDTH, HEIGHT = 448, 768
LEFT, BOTTOM, SPAN = -0.32, -0.13, 1.16  # the texture's corner and height; its pixels are square
rng = np.random.default_rng(7)


def save_png(path, pixels):
    """8 bit, grey [y, x] or RGB [y, x, 3], values in [0, 1]."""
    levels = np.round(np.clip(pixels, 0, 1) * 255).astype(np.uint8)
    height, width = levels.shape[:2]
    rows = b"".join(b"\0" + row.tobytes() for row in levels)
    def chunk(kind, data):
        return (struct.pack(">I", len(data)) + kind + data +
                struct.pack(">I", zlib.crc32(kind + data)))
    header = struct.pack(">IIBBBBB", width, height, 8, 2 if levels.ndim == 3 else 0, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) +
                     chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def smooth_noise(size):
    """Mean 0, standard deviation 1, features of `size` pixels."""
    fy, fx = np.fft.fftfreq(HEIGHT)[:, None], np.fft.rfftfreq(WIDTH)[None, :]
    spectrum = np.fft.rfft2(rng.normal(size=(HEIGHT, WIDTH)))
    noise = np.fft.irfft2(spectrum * np.exp(-0.5 * (size * np.hypot(fx, fy) * np.pi) ** 2))
    return (noise - noise.mean()) / noise.std()


def half_width(y):
    t = np.clip(y, 0, 1)
    return 0.27 * np.sin(np.pi * t ** 0.8) ** 0.85 * (1 - 0.25 * t)


scale = SPAN / HEIGHT
x = LEFT + (np.arange(WIDTH) + 0.5)[None, :] * scale
y = BOTTOM + SPAN - (np.arange(HEIGHT) + 0.5)[:, None] * scale
across = np.abs(x) + 0 * y
side = np.sign(x)

# The outline: teeth that point to the tip, and a stalk.
saw = (y * 26) % 1.0
edge = half_width(y) * (1 - 0.055 * saw ** 2)
stalk = np.where(y < 0.08, 0.011, 0.0)
distance = np.maximum(np.where((y > 0) & (y < 1), edge, 0.0), stalk) - across
distance = np.where((y < -0.11) | (y > 0.995), -1.0, distance)
outline = np.clip(distance / scale + 0.5, 0, 1)


def ridge(offset, width):
    return np.exp(-(offset / width) ** 2)


# Veins: a midrib, nine pairs that bend to the tip, and the net between them.
midrib = ridge(across, 0.011 * (1.1 - np.clip(y, 0, 1))) * (y < 0.985)
pairs = np.zeros_like(midrib)
for k in range(9):
    for s in (-1, 1):
        start = 0.05 + 0.095 * k + (0.02 if s > 0 else 0.0) + rng.normal() * 0.005
        path = start + 0.75 * across + 0.9 * across ** 2  # height of the vein beside the midrib
        reach = np.clip(1 - across / (half_width(start + 0.2) + 0.02), 0, 1)
        vein = ridge((y - path) * 0.75, 0.0028 + 0.003 * reach)
        pairs = np.maximum(pairs, np.where(side == s, vein * (0.35 + 0.65 * reach), 0))
seeds = np.stack([rng.uniform(LEFT, LEFT + WIDTH * scale, 2600),
                  rng.uniform(BOTTOM, BOTTOM + SPAN, 2600)])
net = np.empty_like(midrib)
for row in range(HEIGHT):  # the edges of Voronoi cells, where two seeds are as near
    d = np.sqrt((x[0][:, None] - seeds[0]) ** 2 + (y[row] - seeds[1]) ** 2)
    d = np.partition(d, 1, axis=1)
    net[row] = ridge(d[:, 1] - d[:, 0], 0.0022)

blade = 0.30 * (1 + 0.05 * smooth_noise(18))
thickness = blade + 0.70 * midrib + 0.42 * pairs * (1 - midrib) + 0.07 * net * (1 - pairs)
thickness = np.where(distance > -0.02, thickness, 0.3)  # what is cut off need not be stored
save_png(pathlib.Path(sys.argv[1]) / "thickness.png", thickness)
save_png(pathlib.Path(sys.argv[1]) / "outline.png", outline)

veins = np.clip(midrib + 0.6 * pairs + 0.15 * net, 0, 1)[..., None]
mottle = (0.86 + 0.05 * smooth_noise(60) + 0.03 * smooth_noise(9))[..., None]
rim = np.clip(1 - distance / 0.02, 0, 1)[..., None] * 0.3
# The blade holds the pigments: its color is the darker one. Veins are nearly as white as the tissue without
# them, so that they are bright where light falls on them, and dark against it since they are thick.
tint = np.array([0.61, 0.65, 0.56]) * (1 - rim) + np.array([0.66, 0.55, 0.40]) * rim
color = mottle * tint * (1 - veins) + np.array([0.93, 0.955, 0.84]) * veins
color = np.where((distance > -0.02)[..., None], color, 0.9)
color = 0.25 * (color[0::2, 0::2] + color[1::2, 0::2] + color[0::2, 1::2] + color[1::2, 1::2])
save_png(pathlib.Path(sys.argv[1]) / "color.png", np.round(color * 64) / 64)


def bent(px, py, fold, arch, twist):
    """A place of the flat leaf: folded along the midrib, arched along it, twisted about it."""
    z = fold * (np.hypot(px, 0.03) - 0.03) + 0.02 * np.sin(9 * py) * px / 0.3
    a = twist * py
    px, z = px * np.cos(a) - z * np.sin(a), px * np.sin(a) + z * np.cos(a)
    b = arch * max(py, 0.0)  # an arc of curvature `arch`
    if b:
        qy, qz = np.sin(b) / arch, -(1 - np.cos(b)) / arch
        py, z = qy + z * np.sin(b), qz + z * np.cos(b)
    return px, py, z


def save_sheet(name, columns, rows, place, fold, arch, twist):
    """A grid of squares; place(u, v) of one corner, on the flat leaf, for u and v in [0, 1]."""
    lines = [f"# {name}, by make_leaf.py"]
    for j in range(rows + 1):
        for i in range(columns + 1):
            px, py = place(i / columns, j / rows)
            x, y, z = bent(px, py, fold, arch, twist)
            lines.append(f"v {x:.4f} {y:.4f} {z:.4f}")
            lines.append(f"vt {(px - LEFT) / (WIDTH * scale):.4f} {(py - BOTTOM) / SPAN:.4f}")
    for j in range(rows):
        for i in range(columns):
            a = j * (columns + 1) + i + 1
            b, c, d = a + 1, a + columns + 2, a + columns + 1
            lines.append("f " + " ".join(f"{k}/{k}" for k in (a, b, c, d)))
    (pathlib.Path(sys.argv[1]) / name).write_text("\n".join(lines) + "\n")


def on_rectangle(u, v):
    return LEFT + u * WIDTH * scale, BOTTOM + v * SPAN


def within_outline(u, v):
    """The leaf itself without its teeth, for sheets that cannot be cut out by a map."""
    py = -0.10 + 1.09 * v
    half = max(half_width(py) if 0 < py < 1 else 0.0, 0.011 if py < 0.08 else 0.002)
    return (2 * u - 1) * half, py


save_sheet("flat.obj", 8, 20, on_rectangle, 0.25, 0.35, 0.15)
save_sheet("curled.obj", 8, 20, on_rectangle, 0.5, 1.1, -0.4)
save_sheet("blade.obj", 16, 64, within_outline, 0.35, 0.5, 0.3)
