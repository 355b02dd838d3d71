#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""The table of docs/export.md: what each format misses of each built-in material.

usage: export_misfits.py LAMINA [MATERIAL ...]

Minutes for all, of which materials with a clear layer on top and thin sheets take most; what is kept in the cache is
not solved again.
"""
import json
import subprocess
import sys

LAMINA = sys.argv[1]


def result_of(*arguments):
    return json.loads(subprocess.run([LAMINA, *arguments, "--json", "-"], check=True, capture_output=True).stdout)


def lights(misfits):
    for misfit in misfits:
        yield misfit["reflectance"]
        if "transmittance" in misfit:
            yield misfit["transmittance"]


def largest(misfits, number):
    """The largest of all channels and sides that have light."""
    numbers = [number(light) for light in lights(misfits) if light["wanted_total"] > 1e-3]
    return max((one for one in numbers if one is not None), default=None)


def total(light):
    return abs(light["obtained_total"] - light["wanted_total"])


def text(value, form):
    return "–" if value is None else form % value


def row(material):
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        exports = {one["format"]: one for one in result_of("export", material, "--to", "all", "-o", folder)["exports"]}
        radius = result_of("export", material, "--to", "mitsuba3", "--match", "mean_square_radius", "-o", folder)["exports"]
    rms = lambda misfits: text(largest(misfits, lambda light: light.get("profile_rms")), "%.2f") if misfits else "–"
    of = {name: one["misfit"] for name, one in exports.items()}
    kind = "sheet" if any("transmittance" in misfit for misfit in of["gaussians"]) else "thick"
    return (f"| `{material}` | {kind} | {text(largest(of['mitsuba3'], total), '%.5f')} | {rms(of['mitsuba3'])} | "
            f"{rms(radius[0]['misfit'])} | {rms(of['blender'])} | {rms(of['unreal'])} | {rms(of['mixture'])} | {rms(of['gaussians'])} | "
            f"{text(largest(of['mcml'], total), '%.4f')} | {text(largest(of['mcx'], total), '%.4f')} |")


def main():
    names = sys.argv[2:] or [one["name"] for one in result_of("materials")["materials"]]
    print("| material | | one medium: total | profile | by radius | walk | Burley | mixture | gaussians | mcml: total | mcx: total |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for name in names:
        print(row(name), flush=True)


if __name__ == "__main__":
    main()
