#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Makes the maps of the plates, blood, melanin and lips, over the texture coordinates of the head that
demo.sh fetches. The outline of the lips is that of its texture. Usage: make_maps.py SKIN.png FOLDER"""
import math
import struct
import sys
import zlib

SIZE = 512


def load_rgb(name):
    """Rows of a PNG of 8 bits in red, green, blue."""
    data, at, packed = open(name, "rb").read(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR" and struct.unpack(">IIBB", body[:10]) != (SIZE, SIZE, 8, 2):
            sys.exit(f"{name}: must have {SIZE} x {SIZE} pixels of 8 bits in red, green, blue")
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    raw, rows, before = zlib.decompress(packed), [], bytes(3 * SIZE)
    for y in range(SIZE):
        start = y * (3 * SIZE + 1)
        kind, row = raw[start], bytearray(raw[start + 1:start + 3 * SIZE + 1])
        for i in range(3 * SIZE):
            left, up, corner = (row[i - 3], before[i], before[i - 3]) if i >= 3 else (0, before[i], 0)
            guess = left + up - corner
            paeth = min((left, up, corner), key=lambda value: abs(guess - value))
            row[i] = (row[i] + (0, left, up, (left + up) // 2, paeth)[kind]) & 255
        rows.append(row)
        before = row
    return rows


def save(folder, name, value):
    rows = b"".join(b"\0" + bytes(min(max(round(255 * value(x, y)), 0), 255) for x in range(SIZE))
                    for y in range(SIZE))
    chunk = lambda kind, data: (struct.pack(">I", len(data)) + kind + data
                                + struct.pack(">I", zlib.crc32(kind + data)))
    with open(f"{folder}/{name}.png", "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", SIZE, SIZE, 8, 0, 0, 0, 0))
                   + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def spot(x, y, cx, cy, rx, ry):
    return math.exp(-((x - cx) / rx) ** 2 - ((y - cy) / ry) ** 2)


# The face lies sideways: eyes at (430, 244) and (430, 283), mouth at (466, 264), ears at the sides.
skin = load_rgb(sys.argv[1])


def redness(x, y):
    return skin[y][3 * x] / max(skin[y][3 * x + 1], 1)


def lips(x, y):
    """From 0 where the texture is no redder than the skin around the mouth, to 1 within the lips."""
    if abs(x - 466) > 15 or abs(y - 264) > 18 or x < 455:
        return 0.0
    weights = {(i, j): math.exp(-0.5 * (i * i + j * j)) for i in range(-2, 3) for j in range(-2, 3)}
    mean = sum(w * redness(x + i, y + j) for (i, j), w in weights.items()) / sum(weights.values())
    t = min(max((mean - 1.35) / 0.5, 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)


def cheeks(x, y):
    return spot(x, y, 453, 238, 10, 10) + spot(x, y, 453, 290, 10, 10)


def blood(x, y):
    nose = spot(x, y, 449, 264, 6, 6)
    ears = spot(x, y, 436, 188, 14, 14) + spot(x, y, 436, 338, 14, 14)
    return 0.25 + 0.3 * cheeks(x, y) + 0.25 * nose + 0.3 * ears + 0.5 * lips(x, y)


def melanin(x, y):
    forehead = spot(x, y, 400, 264, 14, 40)
    eyes = spot(x, y, 430, 244, 8, 12) + spot(x, y, 430, 283, 8, 12)
    return 0.6 + 0.15 * forehead + 0.2 * eyes - 0.1 * cheeks(x, y) - 0.15 * lips(x, y)


for value in (lips, blood, melanin):
    save(sys.argv[2], value.__name__, value)
