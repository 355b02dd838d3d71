# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""The EXR files that lamina writes, by Python's own modules."""
import struct
import zlib


class Exr:
    """Scanlines of floats or halves, by zip.

    channels: by name, [row][column]; data, display: windows as (left, top, right, bottom);
    attributes: the bytes of each.
    """

    def __init__(self, file):
        with open(file, "rb") as stream:
            data = stream.read()
        assert data[:4] == b"\x76\x2f\x31\x01", f"{file}: no EXR"
        at, channels, self.attributes = 8, [], {}
        while data[at]:
            name, kind = (data[at:].split(b"\0", 2)[i] for i in range(2))
            at += len(name) + len(kind) + 2
            (size,) = struct.unpack_from("<i", data, at)
            self.attributes[name.decode()] = data[at + 4:at + 4 + size]
            at += 4 + size
        at += 1
        rest = self.attributes["channels"]
        while rest[0]:
            name, rest = rest.split(b"\0", 1)
            channels.append((name.decode(), {1: ("e", 2), 2: ("f", 4), 0: ("I", 4)}[struct.unpack_from("<i", rest)[0]]))
            rest = rest[16:]
        self.data = left, top, right, bottom = struct.unpack("<4i", self.attributes["dataWindow"])
        self.display = struct.unpack("<4i", self.attributes["displayWindow"])
        width, height = right - left + 1, bottom - top + 1
        lines_per_block = {0: 1, 2: 1, 3: 16}[self.attributes["compression"][0]]
        line_size = sum(width * size for _, (_, size) in channels)
        self.channels = {name: [None] * height for name, _ in channels}
        for block in range(-(-height // lines_per_block)):
            (offset,) = struct.unpack_from("<Q", data, at + 8 * block)
            y, size = struct.unpack_from("<ii", data, offset)
            packed, lines = data[offset + 8:offset + 8 + size], min(lines_per_block, height - (y - top))
            if size < line_size * lines:
                packed = unpacked(packed)
            start = 0
            for line in range(lines):
                for name, (code, size) in channels:
                    self.channels[name][y - top + line] = struct.unpack_from(f"<{width}{code}", packed, start)
                    start += width * size


def unpacked(packed):
    """Bytes before zip: differences of the even ones, then of the odd ones."""
    mixed = bytearray(zlib.decompress(packed))
    for i in range(1, len(mixed)):
        mixed[i] = (mixed[i - 1] + mixed[i] - 128) & 255
    half = (len(mixed) + 1) // 2
    result = bytearray(len(mixed))
    result[::2], result[1::2] = mixed[:half], mixed[half:]
    return bytes(result)
