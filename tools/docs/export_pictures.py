#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""The pictures of docs/export/: a material in lamina, as a target shows it, and the difference.

usage: PYTHONPATH=BUILD/python python3 tools/docs/export_pictures.py [TARGET ...]

Writes docs/images/export_TARGET.png and prints the table of the page.

A plate lies under a uniform sky, of which a hole lets light through to a disc; sheets are lit from behind. Light that leaves at a
distance from the disc's middle is the integral of the profile R(r), or T(r), over the disc, for lamina by radiative transfer through
the layers. For a target R(r) is that of the parameters in the exported file, as its documentation explains them. Only "blender" is the
target itself: it needs `blender`, or the command that BLENDER names, and is left out without it.
"""
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass

import lamina
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parents[2]
MATERIALS = ("skin_type_3", "donner_jensen_skin", "jade", "leaf")  # of smooth surfaces: those of files are not read below
WIDTH, HEIGHT, GAP, HEAD = 216, 120, 4, 22  # of a picture, between them, above them [pixels]
DISC = 1.0 / 6.0  # radius of the lit disc over the width of the picture
FACTORS = (4.0, 2.0, 1.0, 0.5)  # of differences: the first by which none is clipped
RADII = np.geomspace(1e-5, 1e3, 3000)  # [mm]


@dataclass
class Spread:
    """Light of one side of a plate, of which a point gets a flux of 1."""

    total: np.ndarray  # fraction that leaves, axes (channel)
    profile: np.ndarray | None  # at RADII [1/mm²], axes (channel, r); None: all leaves where it entered


def spread_of(r, profile, total):
    """A profile at other radii, by its logarithm; what is nearer than the first leaves at the point itself."""
    with np.errstate(divide="ignore"):
        logs = [np.interp(np.log(RADII), np.log(r), np.log(np.maximum(p, 1e-300)), left=-np.inf, right=-np.inf) for p in profile]
    return Spread(np.asarray(total, float), np.exp(np.array(logs)))


def disc_light(spread, radius, distances):
    """What leaves at distances from the middle of a disc of unit irradiance, axes (channel, distance)."""
    inside = (distances < radius).astype(float)
    if spread.profile is None:
        return spread.total[:, None] * inside
    rings = 2.0 * math.pi * RADII**2 * math.log(RADII[1] / RADII[0]) * spread.profile
    # The part of a ring about a point that lies in the disc: by the law of cosines.
    d, r = np.maximum(distances, 1e-9)[:, None], RADII[None, :]
    part = np.arccos(np.clip((d * d + r * r - radius * radius) / (2.0 * d * r), -1.0, 1.0)) / math.pi
    return rings @ part.T + (spread.total - rings.sum(1))[:, None] * inside


def spread_of_layers(layers, side, incidence="diffuse"):
    """By radiative transfer; axes of the layers are (channel)."""
    found = lamina.profile(layers, incidence=incidence, r_min=1e-5, r_max=1e3, radii=400)
    first = {"diffuse": 1.0, "normal": 1.0 - float(np.ravel(lamina.slab(layers).specular_reflectance)[0])}[incidence]
    return spread_of(found.r, first * getattr(found, side), first * getattr(found, f"total_{side}"))


def spread_of_medium(sigma_a, sigma_s, g, ior, side, thickness=math.inf, roughness=0.0):
    column = lambda values: np.asarray(values, float)[:, None]
    outside = {"ior_below": 1.0} if math.isfinite(thickness) else {}
    return spread_of_layers(lamina.layers(sigma_a=column(sigma_a), sigma_s=column(sigma_s), g=g, ior=ior, thickness=thickness,
                                          roughness=roughness, **outside), side)


def numbers(text):
    return np.array([float(x) for x in text.replace(",", " ").split()])


def obtained(exported, side):
    return np.array([misfit[side]["obtained_total"] for misfit in exported.misfits.values()])


def text_of(exported):
    return next(iter(exported.files.values())).decode()


def table(exported, side):
    """Columns r, R and T of NAME_profile.csv."""
    lines = next(text for name, text in exported.files.items() if name.endswith(".csv")).decode().splitlines()
    rows = np.array([numbers(line) for line in lines if line[0].isdigit()])
    first = {"reflectance": 1, "transmittance": 4}[side]
    profile = rows[:, first:first + 3].T
    npz = next(text for name, text in exported.files.items() if name.endswith(".npz"))
    with tempfile.NamedTemporaryFile(suffix=".npz") as file:
        file.write(npz)
        file.flush()
        total = np.load(file.name)[f"total_{side}"]
    return spread_of(rows[:, 0], profile, total)


def gaussians(exported, side):
    sums = json.loads(text_of(exported))[side]
    variance, weights = np.array(sums["variance_mm2"]), np.array(sums["weights"])
    each = np.exp(-RADII**2 / (2.0 * variance[:, None])) / (2.0 * math.pi * variance[:, None])
    return Spread(weights.sum(0), weights.T @ each)


def mixture(exported, side):
    data = json.loads(text_of(exported))
    media = [spread_of_medium(one["sigma_a"], one["sigma_s"], data["g"], data["ior"], side, roughness=data["roughness"])
             for one in data["media"]]
    weights = [np.array(one["weights"]) for one in data["media"]]
    return Spread(sum(w * m.total for w, m in zip(weights, media)), sum(w[:, None] * m.profile for w, m in zip(weights, media)))


def thickness_of(text):
    found = re.search(r"thickness of ([\d.e+-]+) units", text)
    return float(found[1]) if found else math.inf


def pbrt(exported, side):
    """The first medium and its boundary, for volpath."""
    text = text_of(exported)
    value = lambda name: numbers(re.search(rf"{name}\" \[ ([^\]]+) \]", text)[1])
    return spread_of_medium(value("sigma_a"), value("sigma_s"), value("float g")[0], value("eta")[0], side, thickness_of(text))


def mitsuba3(exported, side):
    text = text_of(exported)
    value = {one.get("name"): numbers(one.get("value")) for one in ElementTree.fromstring(text).iter() if one.get("value")}
    sigma_t, albedo = value["sigma_t"] * value["scale"], value["albedo"]
    return spread_of_medium((1.0 - albedo) * sigma_t, albedo * sigma_t, value["g"][0], value["int_ior"][0], side, thickness_of(text))


def openpbr(exported, side):
    value = {one.get("name"): one.get("value") for one in ElementTree.fromstring(text_of(exported)).iter("input")}
    if value["geometry_thin_walled"] == "true":
        return Spread(obtained(exported, side), None)
    color, g = numbers(value["subsurface_color"]), float(value["subsurface_scatter_anisotropy"])
    ior, alpha = float(value["specular_ior"]), float(value["specular_roughness"]) ** 2
    albedo = np.array([lamina.invert(c, ior=ior, g=g, roughness=alpha, distribution="ggx", definition="openpbr").albedo
                       for c in color], float).ravel()
    path = float(value["subsurface_radius"]) * numbers(value["subsurface_radius_scale"])
    return spread_of_medium((1.0 - albedo) / path, albedo / path, g, float(value["specular_ior"]), side)


def below_a_coat(exported, side, spread):
    """What leaves a surface below which the spread has the color of the file: less what the surface reflects."""
    passed = obtained(exported, side) / spread.total
    return Spread(spread.total * passed, spread.profile * passed[:, None])


def walk_of_color(color, g, path_of):
    """A walk below a boundary that does not refract, whose albedo is that which returns the color."""
    albedo = np.array([lamina.invert(c, ior=1.0, g=g, definition="diffuse").albedo for c in color], float).ravel()
    path = path_of(albedo)
    return spread_of_medium((1.0 - albedo) / path, albedo / path, g, 1.0, "reflectance")


def arnold(exported, side):
    p = json.loads(text_of(exported))["parameters"]
    if p["thin_walled"]:
        return Spread(obtained(exported, side), None)
    path = p["subsurface_scale"] * np.array(p["subsurface_radius"])
    return below_a_coat(exported, side, walk_of_color(p["subsurface_color"], p["subsurface_anisotropy"], lambda albedo: path))


def renderman(exported, side):
    p = json.loads(text_of(exported))["parameters"]
    if "subsurfaceColor" not in p:
        return Spread(obtained(exported, side), None)
    g, lengths = p["subsurfaceDirectionality"], p["subsurfaceDmfp"] * np.array(p["subsurfaceDmfpColor"])
    # The diffuse mean free path is 1 / sqrt(3 sigma_a sigma_t').
    path_of = lambda albedo: lengths * np.sqrt(3.0 * (1.0 - albedo) * (1.0 - albedo * g))
    return below_a_coat(exported, side, walk_of_color(p["subsurfaceColor"], g, path_of))


def burley(total, d):
    """[ChristensenBurley2015] Eq. 3."""
    d = d[:, None]
    return Spread(total, total[:, None] * (np.exp(-RADII / d) + np.exp(-RADII / (3.0 * d))) / (8.0 * math.pi * d * RADII))


def unreal(exported, side):
    p = json.loads(text_of(exported))["parameters"]
    if "MeanFreePathDistance" not in p:
        return Spread(obtained(exported, side), None)
    color = np.array(p["SurfaceAlbedo"])
    path = 10.0 * p["MeanFreePathDistance"] * np.array(p["MeanFreePathColor"])  # cm to mm
    d = path / (1.85 - color + 7.0 * np.abs(color - 0.8) ** 3)  # [ChristensenBurley2015] Eq. 5
    return below_a_coat(exported, side, burley(color, d))


def unity(exported, side):
    p = json.loads(text_of(exported))["parameters"]
    if "scatteringDistance" not in p:
        return Spread(obtained(exported, side), None)
    d = p["scatteringDistanceMultiplier"] * np.array(p["scatteringDistance"])
    return below_a_coat(exported, side, burley(np.array(p["baseColor"]), d))


def gltf(exported, side):
    return Spread(obtained(exported, side), None)


def mcml(exported, side):
    """Layers of each run, in cm."""
    lines = [line.split("#")[0].split() for line in text_of(exported).splitlines()]
    layers = np.array([[float(x) for x in line] for line in lines if len(line) == 5], float)
    return photons(layers.reshape(3, -1, 5) * [1, 0.1, 0.1, 1, 10], side)


def photons(layers, side):
    """Axes (channel, layer, [n, mua, mus, g, thickness]) in mm; a pencil beam, as both programs have it."""
    ior, sigma_a, sigma_s, g, thickness = np.moveaxis(layers, -1, 0)
    is_thick = thickness[0, -1] > 1e6
    thickness = np.where(thickness > 1e6, np.inf, thickness)
    outside = {} if is_thick else {"ior_below": 1.0}
    return spread_of_layers(lamina.layers(sigma_a=sigma_a, sigma_s=sigma_s, g=g, ior=ior, thickness=thickness, **outside), side, "normal")


def mcx(exported, side):
    """Layers of whole voxels; the last goes on where the grid ends."""
    channels = []
    for name, text in exported.files.items():
        if name.endswith(".json"):
            domain, shapes = json.loads(text)["Domain"], json.loads(text)["Shapes"]
            layers = next(shape["ZLayers"] for shape in shapes if "ZLayers" in shape)
            media, depth = domain["Media"], domain["Dim"][2]
            channels.append([[media[tag]["n"], media[tag]["mua"], media[tag]["mus"], media[tag]["g"],
                              1e9 if last == depth and side == "reflectance" else (last - first + 1) * domain["LengthUnit"]]
                             for first, last, tag in layers if media[tag]["mus"] > 0.0])
    return photons(np.array(channels), side)


SPREADS = {"arnold": arnold, "gaussians": gaussians, "gltf": gltf, "mcml": mcml, "mcx": mcx, "mitsuba3": mitsuba3, "mixture": mixture,
           "openpbr": openpbr, "pbrt-v4": pbrt, "renderman": renderman, "table": table, "unity-hdrp": unity, "unreal": unreal}
TITLES = {"arnold": "Arnold, by its parameters", "blender": "Blender 3.4, Cycles", "gaussians": "sum of Gaussians",
          "gltf": "glTF, by its colors", "mcml": "layers in the MCML file", "mcx": "layers in the MCX file",
          "mitsuba3": "medium in the Mitsuba file",
          "mixture": "mixture of three media", "openpbr": "OpenPBR, by its parameters", "pbrt-v4": "medium in the pbrt file",
          "renderman": "RenderMan, by its parameters", "table": "table, interpolated", "unity-hdrp": "HDRP, by its parameters",
          "unreal": "Unreal, by its parameters"}


def materials_of(target):
    """Those that the target has. Spectral ones are known in R, G and B under diffuse light alone."""
    names = ["marble", *MATERIALS[1:]] if target in ("blender", "mcml", "mcx", "table") else MATERIALS
    return [name for name in names if target != "mixture" or name != "leaf"]


def width_of(truth):
    """Of the picture [mm]: five times the radius within which the widest channel has nine tenths of its light."""
    flux = np.cumsum(RADII**2 * truth.profile, 1)
    flux /= flux[:, -1:]
    far = [RADII[np.searchsorted(one, 0.9)] for one in flux]
    return 5.0 * max(far)


def distances(width, parts=1):
    """Of pixels, or of parts x parts points in each, from the middle [mm], axes (y, x)."""
    x, y = ((np.arange(n * parts) + 0.5) / parts - 0.5 * n for n in (WIDTH, HEIGHT))
    return np.hypot(*np.meshgrid(x, y)) * width / WIDTH


def picture(spread, width):
    """Means over pixels, axes (y, x, channel)."""
    at = distances(width, 4)
    line = np.linspace(0.0, at.max(), 2000)
    light = disc_light(spread, DISC * width, line)
    points = np.stack([np.interp(at, line, one) for one in light], -1)
    return points.reshape(HEIGHT, 4, WIDTH, 4, 3).mean((1, 3))


def ring_means(pixels):
    """Means of rings a pixel wide, and of the middle: the light is the same around the disc but for noise."""
    at = distances(WIDTH).ravel()
    ring = np.maximum(np.rint(at).astype(int) - 7, 0)
    count = np.bincount(ring)
    means = [np.bincount(ring, one) / count for one in pixels.reshape(-1, 3).T]
    middles = np.bincount(ring, at) / count
    return np.stack([np.interp(at, middles, one) for one in means], -1).reshape(HEIGHT, WIDTH, 3)


def cycles(name, width, folder):
    """The same plate and sky in Blender, of the light that leaves alone."""
    lamina.export(name, "blender").save(folder)
    job = {"script": str(folder / f"{name}_blender.py"), "material": name, "width": width, "disc": DISC * width, "size": [WIDTH, HEIGHT],
           "is_sheet": name == "leaf", "samples": 256, "out": str(folder / f"{name}.json"), "exr": str(folder / f"{name}.exr")}
    (folder / "job.json").write_text(json.dumps(job))
    subprocess.run([os.environ.get("BLENDER", "blender"), "--background", "--factory-startup", "--python-exit-code", "1", "--python",
                    str(ROOT / "tools/blender/render_disc.py"), "--", str(folder / "job.json")], check=True, stdout=subprocess.DEVNULL)
    return np.array(json.loads(pathlib.Path(job["out"]).read_text())).reshape(HEIGHT, WIDTH, 3)


def rows_of(target):
    """(name, exported, width, picture by lamina, by the target) of each material."""
    for name in materials_of(target):
        side = "transmittance" if name == "leaf" else "reflectance"
        if target in ("blender", "mcml", "mcx"):  # Blender's camera sees the light along the normal: by reciprocity that of a normal beam
            truth = spread_of_layers(lamina.material(name).layers, side, "normal")
        elif target == "table":
            truth = spread_of_layers(lamina.material(name).layers, side)
        else:
            truth = table(lamina.export(name, "table"), side)
        width, exported = width_of(truth), lamina.export(name, target)
        wanted = picture(truth, width)
        if target == "blender":
            with tempfile.TemporaryDirectory() as folder:
                yield name, exported, width, ring_means(wanted), ring_means(cycles(name, width, pathlib.Path(folder)))
        else:
            yield name, exported, width, wanted, picture(SPREADS[target](exported, side), width)


def misfits_of(exported):
    """Cells of the table: totals, and profiles, of every side that has them."""
    lights = [(channel, light) for channel, sides in exported.misfits.items() for light in sides.values() if isinstance(light, dict)]
    off = max((abs(light["obtained_total"] - light["wanted_total"]) for _, light in lights), default=0.0)
    rms = {}
    for channel, light in lights:
        if "profile_rms" in light:
            rms[channel] = max(rms.get(channel, 0.0), light["profile_rms"])
    return f"{off:.4f} | {' '.join(f'{x:.2f}' for x in rms.values()) or '–'}"


def encoded(linear):
    """Linear light as sRGB code values."""
    x = np.clip(linear, 0.0, 1.0)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1.0 / 2.4) - 0.055)


def nearest_round(x):
    """The largest of 1, 2, 5, 10 … that is not above x."""
    ten = 10.0 ** math.floor(math.log10(x))
    return ten * max(step for step in (1, 2, 5) if step * ten <= x)


def draw(target):
    rows = list(rows_of(target))
    size = (3 * WIDTH + 2 * GAP, HEAD + len(rows) * (HEIGHT + GAP) - GAP)
    figure = Figure(figsize=(size[0] / 100, size[1] / 100), dpi=100)
    figure.patch.set_facecolor("white")

    def text(x, y, words, **more):
        figure.text(x / size[0], 1.0 - y / size[1], words, **{"fontsize": 8, "va": "center", "color": "black", **more})

    for column, words in enumerate(("lamina", TITLES[target], "difference, gray: none")):
        text(column * (WIDTH + GAP) + WIDTH / 2, HEAD / 2, words, ha="center")
    for row, (name, exported, width, truth, shown) in enumerate(rows):
        scale = 0.8 / truth.max()
        light = (shown - truth) / truth.max()
        percents = [f"{round(100.0 * d.flat[np.argmax(np.abs(d))], 1) + 0.0:+.1f}" for d in np.moveaxis(light, -1, 0)]
        seen = encoded(scale * truth), encoded(scale * shown)
        difference = seen[1] - seen[0]
        factor = next((f for f in FACTORS if f * np.abs(difference).max() <= 0.5), FACTORS[-1])
        top = HEAD + row * (HEIGHT + GAP)
        for column, values in enumerate((*seen, np.clip(0.5 + factor * difference, 0.0, 1.0))):
            left = column * (WIDTH + GAP)
            ax = figure.add_axes((left / size[0], 1.0 - (top + HEIGHT) / size[1], WIDTH / size[0], HEIGHT / size[1]))
            ax.imshow(values, interpolation="nearest", aspect="auto")
            ax.axis("off")
            if column == 0:
                bar = nearest_round(0.3 * width)
                ax.plot((6, 6 + bar / width * WIDTH), (HEIGHT - 8,) * 2, color="white", lw=1.5)
                text(left + 6, top + 11, name + (", lit from behind" if name == "leaf" else ""), color="white")
                text(left + 6, top + HEIGHT - 18, f"{bar:g} mm", color="white")
        text(left + 6, top + 11, f"× {factor:g}")
        text(left + 6, top + HEIGHT - 10, "light: " + ", ".join(f"{c} {p}" for c, p in zip("RGB", percents)) + " %")
        print(f"| `{name}` | {misfits_of(exported)} | {' '.join(percents)} |", flush=True)
    figure.canvas = FigureCanvasAgg(figure)
    figure.canvas.draw()
    # In steps of 2 of 255, which nobody sees and which keeps files small.
    codes = np.minimum(2.0 * np.rint(np.asarray(figure.canvas.buffer_rgba())[..., :3] / 2.0), 255.0).astype(np.uint8)
    Image.fromarray(codes).save(ROOT / f"docs/images/export_{target}.png", optimize=True)


def main():
    targets = sys.argv[1:] or sorted(TITLES)
    if unknown := set(targets) - set(TITLES):
        sys.exit(f"{', '.join(sorted(unknown))}: must be of {', '.join(sorted(TITLES))}")
    for target in targets:
        if target == "blender" and not shutil.which(os.environ.get("BLENDER", "blender")):
            print("blender: left out, it is not installed", file=sys.stderr)
            continue
        print(f"{target}\n| material | total: largest error | profile rms R, G, B | picture R, G, B [%] |\n|---|---|---|---|")
        draw(target)


if __name__ == "__main__":
    main()
