#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Built-in materials in Cycles beside lamina's own random_walk: colors in even light, and how far light bleeds into shadow.

usage: round_trip.py LAMINA FOLDER [--scenes ball,bust,edge] [--spp N] [MATERIAL ...]

Exports each material for Blender, renders the same meshes by both, and prints a table of
  ball, bust: color obtained over that of lamina, mean over the object, per channel [%]
  edge: where the light that bleeds from a lit half into the dark half of a block has fallen to 50 % and 10 % of what it is at the
        edge, in mm by lamina's radiative transfer of diffuse light, to which random_walk converges, and obtained over that [%]
Needs `blender` (or the command that BLENDER names); without it, says so and ends. Files stay in FOLDER.
"""
import argparse
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve()
sys.path.insert(0, str(HERE.parents[2] / "tests/cli"))
from exr_file import Exr  # noqa: E402


def ball(radius, rows=48):
    vertices, faces, columns = [(0, radius, 0)], [], 2 * rows
    for i in range(1, rows):
        theta = math.pi * i / rows
        for j in range(columns):
            phi = 2 * math.pi * j / columns
            vertices.append((radius * math.sin(theta) * math.cos(phi), radius * math.cos(theta),
                             -radius * math.sin(theta) * math.sin(phi)))
    vertices.append((0, -radius, 0))
    at = lambda i, j: 1 + (i - 1) * columns + j % columns
    for j in range(columns):
        faces += [(0, at(1, j), at(1, j + 1)), (len(vertices) - 1, at(rows - 1, j + 1), at(rows - 1, j))]
        for i in range(1, rows - 1):
            faces.append((at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)))
    return vertices, faces


def bust(height, rows=72):
    """A head on shoulders, turned, with a nose and sockets pressed in."""
    vertices, faces = ball(1.0, rows)
    shaped = []
    for x, y, z in vertices:
        head = math.exp(-((y - 0.35) / 0.34) ** 4)
        shoulders = 1 / (1 + math.exp((y + 0.62) / 0.05))
        width = 0.18 + 0.24 * head + 0.5 * shoulders
        depth = 0.18 + 0.28 * head + 0.18 * shoulders
        around = math.sqrt(max(1 - y * y, 1e-12))
        cap = min(1.0, 1.6 * around)
        nose = 0.10 * math.exp(-((y - 0.3) / 0.1) ** 2 - (x / around / 0.22) ** 2) if z > 0 else 0.0
        eyes = 0.05 * math.exp(-((y - 0.45) / 0.07) ** 2 - ((abs(x / around) - 0.42) / 0.16) ** 2) if z > 0 else 0.0
        scale = cap * (1 + nose / depth - eyes / depth)
        shaped.append((0.5 * height * width * scale * x / around, 0.5 * height * y, 0.5 * height * depth * scale * z / around))
    return shaped, faces


def block(unit):
    w, d = 30 * unit, 24 * unit
    corners = [(x, y, z) for x in (-8 * unit, w) for y in (-w, w) for z in (-d, 0)]
    return corners, [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def wall(unit):
    """From below the block to as high as its shadow is long, so that light at 45 degrees begins at x = 0."""
    x, w, d, h = -8.001 * unit, 60 * unit, 60 * unit, 8.001 * unit
    return [(x, -w, -d), (x, w, -d), (x, w, h), (x, -w, h)], [(0, 1, 2, 3)]


def write_obj(file, mesh):
    lines = ["v %.9g %.9g %.9g" % v for v in mesh[0]] + ["f " + " ".join(str(i + 1) for i in f) for f in mesh[1]]
    file.write_text("\n".join(lines) + "\n")


def read_exr(file):
    """R, G, B of a picture of lamina, [row][column]."""
    planes = [Exr(file).channels[c] for c in "RGB"]
    return [list(zip(*rows)) for rows in zip(*planes)]


def edge_distances(csv):
    """Where diffuse light that falls on one half of the plane has fallen, in the other half, to 50 % and 10 % of what leaves at the
    border, in mm per channel: from R(r) as `lamina export --to table` has it, by radiative transfer."""
    rows = [line.split(",") for line in csv.read_text().splitlines() if not line.startswith("#")][1:]
    r = [float(row[0]) for row in rows]
    step = math.log(r[1] / r[0])
    result = []
    for c in range(3):
        rings = [2 * math.pi * x * x * step * float(row[1 + c]) for x, row in zip(r, rows)]
        beyond = lambda x: sum(flux * math.acos(x / radius) / math.pi for flux, radius in zip(rings, r) if radius > x)
        half = 0.5 * sum(rings)
        result.append([])
        for part in (0.5, 0.1):
            low, high = 0.0, r[-1]
            for _ in range(50):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if beyond(middle) > part * half else (low, middle)
            result[-1].append(low)
    return result


def lamina(command, *words):
    result = subprocess.run([command, *map(str, words)], capture_output=True, text=True)
    if result.returncode:
        sys.exit(result.stderr)
    return result.stdout


def views(unit):
    """Camera distance, fov in degrees, pixels, light, by scene; lengths in mm."""
    return {"ball": {"distance": 200, "fov": 12.5, "size": (48, 48)},
            "bust": {"distance": 400, "fov": 12.5, "size": (48, 64)},
            "edge": {"distance": 400 * unit, "fov": math.degrees(2 * math.atan(6 / 400)), "size": (240, 4)}}


def scene_of(kind, material, view, samples):
    meshes = [{"file": f"{kind}.obj", "material": "m"}]
    lights = [{"type": "environment", "radiance": [1, 1, 1], "visible": False}]
    return {"lamina": "scene", "version": 1, "mm_per_unit": 1,
            "camera": {"position": [0, 0, view["distance"]], "look_at": [0, 0, 0], "horizontal_fov": view["fov"]},
            "film": {"width": view["size"][0], "height": view["size"][1]},
            "materials": {"m": {"subsurface": material}}, "meshes": meshes, "lights": lights,
            "render": {"method": "random_walk", "samples_per_pixel": samples, "max_bounces": 6}}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("lamina")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("materials", nargs="*")
    parser.add_argument("--scenes", default="ball,bust,edge")
    parser.add_argument("--spp", type=int, default=32, help="samples per pixel of ball and bust; edges take 64 times as many")
    arguments = parser.parse_intermixed_args()
    blender = shutil.which(os.environ.get("BLENDER", "blender"))
    if not blender:
        print("skipped: there is no blender")
        return
    folder = arguments.folder
    folder.mkdir(parents=True, exist_ok=True)
    kinds = arguments.scenes.split(",")
    names = arguments.materials or [one["name"] for one in
                                    json.loads(lamina(arguments.lamina, "materials", "--json", "-"))["materials"]]
    write_obj(folder / "ball.obj", ball(20))
    write_obj(folder / "bust.obj", bust(90))
    jobs = []
    for name in names:
        if not (folder / f"{name}_blender.json").exists():
            export = subprocess.run([arguments.lamina, "export", name, "--to", "blender", "-o", f"{folder}/"],
                                    capture_output=True, text=True)
            if export.returncode:
                print(f"| {name} | not exported: {export.stderr.strip()} |")
                continue
        medium = json.loads((folder / f"{name}_blender.json").read_text())
        if "transmittance" in medium:
            continue
        unit = max(m["reflectance"]["wanted_mean_square_radius_mm2"] for m in medium["misfit"]) ** 0.5
        for kind in kinds:
            view = views(unit)[kind]
            samples = arguments.spp * (64 if kind == "edge" else 1)
            meshes = {"ball": [folder / "ball.obj"], "bust": [folder / "bust.obj"]}.get(kind)
            if kind == "edge":
                meshes = [folder / f"{name}_edge.obj", folder / f"{name}_wall.obj"]
                for file, mesh in zip(meshes, (block(unit), wall(unit))):
                    write_obj(file, mesh)
            stem = folder / f"{name}_{kind}"
            if kind == "edge":
                if not (folder / f"{name}_profile.csv").exists():
                    lamina(arguments.lamina, "export", name, "--to", "table", "-o", f"{folder}/")
                jobs.append({"material": name, "kind": kind, "unit": unit, "samples": samples, "meshes": list(map(str, meshes)),
                             "stem": str(stem), "script": str(folder / f"{name}_blender.py"),
                             "wanted": edge_distances(folder / f"{name}_profile.csv"), **view})
                continue
            if not stem.with_suffix(".exr").exists():
                stem.with_suffix(".json").write_text(json.dumps(scene_of(kind, name, view, samples)))
                render = subprocess.run([arguments.lamina, "render", str(stem.with_suffix(".json")), "-o",
                                         str(stem.with_suffix(".exr"))], capture_output=True, text=True)
                if render.returncode:
                    print(f"| {name} | {kind} | not rendered by lamina: {render.stderr.strip()} |")
                    continue
            stem.with_name(stem.name + "_lamina.json").write_text(json.dumps(read_exr(stem.with_suffix(".exr"))))
            jobs.append({"material": name, "kind": kind, "unit": unit, "samples": samples, "meshes": list(map(str, meshes)),
                         "stem": str(stem), "script": str(folder / f"{name}_blender.py"), **view})
    (folder / "jobs.json").write_text(json.dumps(jobs))
    run = subprocess.run([blender, "--background", "--factory-startup", "--python-exit-code", "1", "--python",
                          str(HERE.with_name("render_jobs.py")), "--", str(folder)], capture_output=True, text=True)
    if run.returncode:
        sys.exit(run.stdout[-3000:] + run.stderr[-3000:])
    for row in json.loads((folder / "results.json").read_text()):
        print(row["text"])


if __name__ == "__main__":
    main()
