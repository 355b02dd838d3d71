#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Makes the maps of the plates: blood, melanin and lips over the texture coordinates of the head that
demo.sh fetches. Usage: make_maps.py FOLDER"""
import struct, sys, zlib
import numpy as np

size = 512
y, x = np.mgrid[0:size, 0:size].astype(float)


def spot(cx, cy, rx, ry, power=2.0):
    return np.exp(-((np.abs(x - cx) / rx) ** power + (np.abs(y - cy) / ry) ** power))


def save(name, values):
    rows = np.clip(np.round(255 * values), 0, 255).astype(np.uint8)
    raw = b"".join(b"\0" + row.tobytes() for row in rows)
    chunk = lambda kind, data: (struct.pack(">I", len(data)) + kind + data
                                + struct.pack(">I", zlib.crc32(kind + data)))
    with open(f"{sys.argv[1]}/{name}.png", "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 0, 0, 0, 0))
                   + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))


# The face lies sideways: eyes at (430, 244) and (430, 283), mouth at (466, 264), ears at the sides.
lips = spot(466, 264, 5.5, 10.5, 4)
cheeks = sum(spot(453, cy, 9, 9) for cy in (238, 290))
nose = spot(449, 264, 6, 6)
ears = sum(spot(436, cy, 14, 14) for cy in (188, 338))
forehead = spot(400, 264, 14, 40)
eyes = sum(spot(430, cy, 8, 12) for cy in (244, 283))
save("lips", lips)
save("blood", np.clip(0.12 + 0.4 * cheeks + 0.35 * nose + 0.3 * ears + 0.9 * lips, 0, 1))
save("melanin", np.clip(0.55 + 0.2 * forehead + 0.25 * eyes - 0.12 * cheeks - 0.25 * lips, 0, 1))
