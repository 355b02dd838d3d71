# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Skin by sliders: media between those of a table that tools/blender/make_tables.py writes."""
import json
import math
import pathlib

TABLE = json.loads(pathlib.Path(__file__).with_name("skins.json").read_text())
MELANIN, HEMOGLOBIN = TABLE["melanin"], TABLE["hemoglobin"]


def place(axis, value):
    """(index, part of the next) of a value on an axis of its logarithms."""
    value = min(max(value, axis[0]), axis[-1])
    i = max(i for i, low in enumerate(axis[:-1]) if low <= value)
    return i, math.log(value / axis[i]) / math.log(axis[i + 1] / axis[i])


def skin(melanin, hemoglobin, roughness):
    """A medium as rules.plan takes it. Albedos are mixed by what they absorb, lengths by their logarithms."""
    i, u = place(MELANIN, melanin)
    j, v = place(HEMOGLOBIN, hemoglobin)
    corners = [(TABLE["media"][i + a][j + b], (u if a else 1 - u) * (v if b else 1 - v)) for a in (0, 1) for b in (0, 1)]

    def mixed(key, before, after):
        return [after(sum(weight * before(corner[key][c]) for corner, weight in corners)) for c in range(3)]

    return {"material": "skin", "ior": TABLE["ior"], "roughness": roughness, "g": TABLE["g"],
            "albedo": mixed("albedo", lambda x: math.log(1 - x), lambda x: 1 - math.exp(x)),
            "mean_free_path_mm": mixed("mean_free_path_mm", math.log, math.exp),
            "reflectance": mixed("reflectance", math.log, math.exp)}
