#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Makes hand.obj of MakeHuman's base mesh and a target, both CC0: the left hand with its forearm, in mm,
fingers towards +y, palm towards +z, its texture coordinates spread over the unit square so that a texel
is as wide on the hand as on the arm; and hand_creases.png, heights of its creases over these coordinates.
Usage: make_hand.py base.obj caucasian-female-young.target FOLDER"""
import math
import random
import struct
import sys
import zlib
from collections import defaultdict

MM = 100.0  # the base mesh is in decimetres


def read(base, target):
    points, uvs, quads, group = [], [], [], ""
    for line in open(base):
        word, *rest = line.split() or [""]
        if word == "v":
            points.append([MM * float(x) for x in rest[:3]])
        elif word == "vt":
            uvs.append([float(x) for x in rest[:2]])
        elif word == "g":
            group = rest[0]
        elif word == "f" and group == "body":
            quads.append([tuple(int(x) - 1 for x in corner.split("/")[:2]) for corner in rest])
    for line in open(target):
        if line.strip() and not line.startswith("#"):
            index, *offset = line.split()
            points[int(index)] = [p + MM * float(d) for p, d in zip(points[int(index)], offset)]
    return points, uvs, quads


def mean(rows):
    rows = list(rows)
    return [sum(column) / len(rows) for column in zip(*rows)]


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    return [x / math.sqrt(dot(a, a)) for x in a]


def area(corners):
    a, b, c, d = [corner + [0.0] * (3 - len(corner)) for corner in corners]
    n = cross(minus(c, a), minus(d, b))
    return 0.5 * math.sqrt(dot(n, n))


def islands(quads):
    """Quads that hang together in texture coordinates."""
    parent = {}

    def root(x):
        while parent.setdefault(x, x) != x:
            x = parent[x]
        return x

    for quad in quads:
        for _, uv in quad[1:]:
            parent[root(uv)] = root(quad[0][1])
    found = defaultdict(list)
    for quad in quads:
        found[root(quad[0][1])].append(quad)
    return sorted(found.values(), key=len, reverse=True)


# Creases of the palm and of the fingers in mm, in the plane of the palm: points of a line, and its depth.
PALM = [([(52, -26), (40, -24), (24, -22), (8, -17), (-2, -9)], 0.5),
        ([(-14, -24), (2, -27), (20, -33), (40, -47)], 0.45),
        ([(-14, -24), (0, -32), (11, -46), (20, -64), (30, -84)], 0.5),
        ([(34, -90), (46, -86), (60, -76)], 0.4)]
FINGERS = [((-12, -6), (-58, 26)), ((-1, 1), (-31, 55)), ((18, 3), (3, 61)), ((41, -9), (34, 40)), ((-14, -58), (-58, -50))]


def creases():
    lines = list(PALM)
    for (bx, by), (tx, ty) in FINGERS:
        length = math.hypot(tx - bx, ty - by)
        ax, ay = -(ty - by) / length, (tx - bx) / length
        for at in (0.04, 0.38, 0.41, 0.68, 0.7):
            x, y = bx + at * (tx - bx), by + at * (ty - by)
            lines.append(([(x - 9 * ax, y - 9 * ay), (x + 9 * ax, y + 9 * ay)], 0.3))
    draw = random.Random(1)
    for _ in range(160):  # fine lines all over the palm
        x, y, turn, half = draw.uniform(-10, 55), draw.uniform(-85, -8), draw.uniform(0, math.pi), draw.uniform(2, 5)
        dx, dy = half * math.cos(turn), half * math.sin(turn)
        lines.append(([(x - dx, y - dy), (x + dx, y + dy)], draw.uniform(0.05, 0.15)))
    return [(a, b, depth) for points, depth in lines for a, b in zip(points, points[1:])]


def depth_at(x, y, segments):
    deepest = 0.0
    for (ax, ay), (bx, by), depth in segments:
        if min(ax, bx) - 2 > x or max(ax, bx) + 2 < x or min(ay, by) - 2 > y or max(ay, by) + 2 < y:
            continue
        dx, dy = bx - ax, by - ay
        t = min(max(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy), 0.0), 1.0)
        across = math.hypot(x - ax - t * dx, y - ay - t * dy) / 0.7
        deepest = max(deepest, depth * math.exp(-across * across))
    return deepest


def save_creases(folder, quads, place, uv, size=1024):
    """White is as high as the skin, black .5 mm below."""
    segments = creases()
    rows = [bytearray([255] * size) for _ in range(size)]
    for quad in quads:
        for corners in ((quad[0], quad[1], quad[2]), (quad[0], quad[2], quad[3])):
            (p, q, r), (a, b, c) = ([place[i] for i, _ in corners], [uv[j] for _, j in corners])
            n = cross(minus(q, p), minus(r, p))
            whole = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
            if whole == 0:
                continue
            faces_palm = n[2] > 0.1 * math.sqrt(dot(n, n))
            xs, ys = [size * k[0] - 0.5 for k in (a, b, c)], [size * (1 - k[1]) - 0.5 for k in (a, b, c)]
            for y in range(max(int(min(ys)) - 1, 0), min(int(max(ys)) + 3, size)):
                for x in range(max(int(min(xs)) - 1, 0), min(int(max(xs)) + 3, size)):
                    u, v = (x + 0.5) / size, 1 - (y + 0.5) / size
                    s = ((u - a[0]) * (c[1] - a[1]) - (v - a[1]) * (c[0] - a[0])) / whole
                    t = ((b[0] - a[0]) * (v - a[1]) - (b[1] - a[1]) * (u - a[0])) / whole
                    if min(s, t, 1 - s - t) < -0.2:  # goes on a little beyond the seams
                        continue
                    px, py = (p[k] + s * (q[k] - p[k]) + t * (r[k] - p[k]) for k in (0, 1))
                    depth = depth_at(px, py, segments) if faces_palm else 0.0
                    rows[y][x] = round(255 * max(1 - 2 * depth, 0))
    chunk = lambda kind, data: (struct.pack(">I", len(data)) + kind + data
                                + struct.pack(">I", zlib.crc32(kind + data)))
    with open(f"{folder}/hand_creases.png", "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 0, 0, 0, 0))
                   + chunk(b"IDAT", zlib.compress(b"".join(b"\0" + bytes(row) for row in rows), 9)) + chunk(b"IEND", b""))


def main(base, target, folder):
    points, uvs, quads = read(base, target)
    quads = [q for q in quads if mean(points[p] for p, _ in q)[0] > 305.0]  # the left arm stretches along +x
    # Axes: along the middle finger, and across the palm.
    hand = islands(quads)[0]
    used = sorted({p for q in hand for p, _ in q})
    middle = mean(points[p] for p in used)
    along = [0.6, -0.7, 0.3]
    for _ in range(50):  # the longest extent, by power iteration
        along = unit([sum(dot(minus(points[p], middle), along) * minus(points[p], middle)[k] for p in used)
                      for k in range(3)])
    across = [1.0, 0.3, -0.5]
    for _ in range(200):
        across = [sum(dot(minus(points[p], middle), across) * minus(points[p], middle)[k] for p in used)
                  for k in range(3)]
        across = unit(minus(across, [dot(across, along) * x for x in along]))
    out = cross(across, along)
    frame = [across, along, out]
    order = sorted({p for q in quads for p, _ in q})
    place = {p: [dot(minus(points[p], middle), axis) for axis in frame] for p in order}
    # Texture coordinates in mm, islands above each other.
    new_uv, top, width = {}, 0.0, 0.0
    for island in islands(quads):
        scale = math.sqrt(sum(area([points[p] for p, _ in q]) for q in island) /
                          sum(area([uvs[u] for _, u in q]) for q in island))
        mine = sorted({u for q in island for _, u in q})
        low = [min(uvs[u][k] for u in mine) for k in (0, 1)]
        for u in mine:
            new_uv[u] = [scale * (uvs[u][0] - low[0]) + 4.0, top + scale * (uvs[u][1] - low[1]) + 4.0]
        top = max(new_uv[u][1] for u in mine) + 4.0
        width = max(width, max(new_uv[u][0] for u in mine) + 4.0)
    side = max(top, width)
    uv_order = sorted(new_uv)
    p_index = {p: i + 1 for i, p in enumerate(order)}
    u_index = {u: i + 1 for i, u in enumerate(uv_order)}
    save_creases(folder, quads, place, {u: [x / side for x in new_uv[u]] for u in new_uv})
    with open(f"{folder}/hand.obj", "w") as file:
        file.write("# A left hand, in mm. Of MakeHuman's base mesh and its target caucasian-female-young, CC0 1.0,\n"
                   "# by make_hand.py.\n")
        for p in order:
            file.write("v " + " ".join(f"{x:.2f}" for x in place[p]) + "\n")
        for u in uv_order:
            file.write("vt " + " ".join(f"{x / side:.5f}" for x in new_uv[u]) + "\n")
        file.write("g skin\n")
        for q in quads:
            file.write("f " + " ".join(f"{p_index[p]}/{u_index[u]}" for p, u in q) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:4])
