# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""All options of what `lamina render` writes, alone, in pairs and in triples: each picture has the numbers that its options
say, or is refused by the name of one of them.

A channel has a witness made with as few options as possible: those that are meant to change it.

usage: output_options_test.py LAMINA
"""
import functools
import itertools
import json
import math
import os
import struct
import subprocess
import sys
import tempfile
import unittest

from exr_file import Exr

LAMINA = os.path.abspath(sys.argv.pop(1))
WIDTH, HEIGHT, SAMPLES = 16, 16, 4
REGION = (3, 5, 9, 7)  # x, y, width, height

# A translucent ball on a floor that ends in the picture; a lamp, a sky and a panel that shines.
SCENE = {
    "lamina": "scene", "version": 1, "mm_per_unit": 10,
    "camera": {"position": [0, 1, 12], "look_at": [0, 0, 0], "horizontal_fov": 30},
    "film": {"width": WIDTH, "height": HEIGHT},
    "materials": {
        "wax": {"subsurface": {"lamina": "material", "version": 1, "name": "wax", "length_unit": "mm", "bands": "rgb", "ior_below": 1.4,
                               "layers": [{"sigma_a": [0.01, 0.03, 0.1], "sigma_s": 1, "g": 0, "ior": 1.4, "thickness": 50}]}},
        "floor": {"diffuse": [0.6, 0.4, 0.3]}, "panel": {"diffuse": 0, "emission": [2, 1, 1]}},
    "meshes": [{"shape": "sphere", "radius": 1.6, "material": "wax"},
               {"shape": "box", "size": [4, 0.2, 4], "material": "floor", "transform": {"translate": [0, -1.7, 0]}},
               {"shape": "box", "size": [0.1, 1.5, 1.5], "material": "panel", "transform": {"translate": [-2.2, 0, 0]}}],
    "lights": [{"name": "key", "type": "rectangle", "position": [-6, 6, 6], "look_at": [0, 0, 0], "size": 3, "radiance": 10},
               {"name": "sky", "type": "environment", "radiance": 0.3}],
    "render": {"samples_per_pixel": SAMPLES, "method": "probe", "profile": "diffusion"}}
LIGHTS = ("key", "sky", "panel")

OCIO = """ocio_profile_version: 2
search_path: ""
roles: {default: lin_rec709, scene_linear: lin_rec709}
displays:
  Monitor:
    - !<View> {name: Root, colorspace: root}
colorspaces:
  - !<ColorSpace> {name: lin_rec709}
  - !<ColorSpace>
    name: root
    from_scene_reference: !<ExponentTransform> {value: [2, 2, 2, 1], direction: inverse}
"""

WORDS = {
    "alpha": ["--alpha"],
    "cryptomatte": ["--cryptomatte"],
    "light_layers": ["--light-layers"],
    "denoise": ["--denoise"],
    "progressive": ["--progressive"],
    "keep": ["--keep"],
    "clamp": ["--clamp", "0.4"],
    "region": ["--region", ",".join(map(str, REGION))],
    "stamp": ["--stamp"],
    "noise": ["--noise", "0.001"],  # which so few samples do not reach
    "acescg": ["--color-space", "acescg"],
    "ocio": ["--ocio", "studio.ocio", "--view", "Root"],
    "shard": None,  # in two parts, merged
    "more": None,  # half of the samples are kept, and the others added
}
OF_MERGE = {"denoise", "acescg", "ocio"}  # where there are shards

# What cannot be: an option of each pair is named.
REFUSED = {frozenset(pair) for pair in [
    *(("light_layers", other) for other in ("denoise", "progressive", "keep", "noise", "shard", "more")),
    *(("shard", other) for other in ("cryptomatte", "progressive", "keep", "stamp", "noise")),
    ("cryptomatte", "more"), ("region", "noise"),
]}
SELDOM = {"clamp", "noise", "stamp"}  # in pairs only

BASE = ["R", "G", "B", *(f"{layer}.{c}" for layer in ("subsurface", "specular", "albedo") for c in "RGB"),
        "normal.X", "normal.Y", "normal.Z", "depth.Z", "samples", "variance"]
# Options that are meant to change a channel.
CHANGES = {"R": {"alpha", "light_layers", "denoise", "clamp", "acescg"}, "albedo": {"acescg"}, "normal": set(), "depth": set(),
           "samples": set(), "A": {"alpha"}, "variance": {"alpha", "light_layers", "clamp"},
           "subsurface": {"light_layers", "clamp", "acescg"}, "specular": {"light_layers", "clamp", "acescg"},
           "noisy": {"alpha", "denoise", "clamp", "acescg"}, "light": {"alpha", "light_layers", "clamp", "acescg"},
           "CryptoObject": {"cryptomatte"}, "CryptoMaterial": {"cryptomatte"}}
OF_PNG = {"alpha", "light_layers", "denoise", "clamp", "ocio", "region"}


def options_of(channel):
    layer = channel.split(".")[0]
    return CHANGES["R" if layer in "RGB" else layer.rstrip("012") if layer.startswith("Crypto") else layer]


def expected_channels(options):
    names = list(BASE)
    if "alpha" in options:
        names.append("A")
    if "cryptomatte" in options:
        names += [f"Crypto{kind}0{i}.{c}" for kind in ("Object", "Material") for i in range(3) for c in "RGBA"]
    if "light_layers" in options:
        names += [f"light.{light}.{c}" for light in LIGHTS for c in "RGB"]
    if "denoise" in options:
        names += [f"noisy.{c}" for c in "RGB"]
    return sorted(names)


class Refused(Exception):
    pass


def run(command, *arguments):
    result = subprocess.run([LAMINA, command, *arguments, "--threads", "1"], capture_output=True, text=True, timeout=300)
    if result.returncode == 2:
        raise Refused(result.stderr)
    if result.returncode != 0:
        raise AssertionError(f"{command} {' '.join(arguments)}: {result.returncode}: {result.stderr}")


def cut(rows):
    x, y, width, height = REGION
    return [row[x:x + width] for row in rows[y:y + height]]


@functools.lru_cache(maxsize=None)
def picture(options):
    """The EXR and the PNG of a set of options. @raises Refused"""
    with tempfile.TemporaryDirectory(dir=".") as folder:
        name = os.path.join(folder, "picture")
        words = [word for option in sorted(options) if WORDS[option] and not ("shard" in options and option in OF_MERGE)
                 for word in WORDS[option]]
        if "shard" in options:
            shards = [os.path.join(folder, f"{i}.shard") for i in range(2)]
            for i, shard in enumerate(shards):
                run("render", "scene.json", *words, "--shard", f"{i}/2", "-o", shard)
            run("merge", *shards, "-o", name, *(word for option in sorted(options & OF_MERGE) for word in WORDS[option]))
        elif "more" in options:
            run("render", "scene.json", *words, *([] if "keep" in options else ["--keep"]), "--samples", str(SAMPLES // 2), "-o", name)
            run("render", "scene.json", *words, "--resume", "-o", name)
        else:
            run("render", "scene.json", *words, "-o", name)
        assert os.path.exists(name + ".unfinished") == ("keep" in options), "what is kept"
        with open(name + ".png", "rb") as png:
            return Exr(name + ".exr"), png.read()


class OutputOptions(unittest.TestCase):
    def check(self, options):
        refused = [pair for pair in REFUSED if pair <= options]
        try:
            exr, png = picture(options)
        except Refused as refusal:
            self.assertTrue(refused, f"is refused: {refusal}")
            self.assertEqual(str(refusal).count("\n"), 1, refusal)
            return
        self.assertFalse(refused, "is not refused")
        self.assertEqual(sorted(exr.channels), expected_channels(options))
        x, y, width, height = REGION
        whole = (0, 0, WIDTH - 1, HEIGHT - 1)
        self.assertEqual(exr.display, whole)
        self.assertEqual(exr.data, (x, y, x + width - 1, y + height - 1) if "region" in options else whole)
        self.assertEqual(struct.unpack(">II", png[16:24]), (width, height) if "region" in options else (WIDTH, HEIGHT))
        # Averages look at what is around a region, too: there the noisy colors are compared.
        is_other = {"denoise", "region"} <= options
        for name, rows in exr.channels.items():
            numbers = [number for row in rows for number in row]
            self.assertTrue(all(math.isfinite(n) or (name == "depth.Z" and n == math.inf) for n in numbers), name)
            if is_other and name in "RGB":
                continue
            wanted = picture(frozenset(options & options_of(name)))[0].channels[name]
            self.assertEqual(rows, cut(wanted) if "region" in options else wanted, name)
        if not is_other:
            self.assertEqual(png, picture(frozenset(options & OF_PNG))[1])

    def test_alone_in_pairs_and_in_triples(self):
        for count in range(4):
            for options in itertools.combinations(WORDS, count):
                if {"shard", "more"} <= set(options) or (count == 3 and not SELDOM.isdisjoint(options)):
                    continue
                with self.subTest(" ".join(options)):
                    self.check(frozenset(options))

    def test_layers_of_light_add_up_to_the_picture(self):
        for others in ((), ("alpha",), ("cryptomatte",), ("acescg",), ("clamp",), ("region",), ("alpha", "cryptomatte", "acescg")):
            channels = picture(frozenset(("light_layers", *others)))[0].channels
            for c in "RGB":
                for row, sums in zip(channels[c], zip(*(channels[f"light.{light}.{c}"] for light in LIGHTS))):
                    for number, parts in zip(row, zip(*sums)):  # halves: 11 bits each
                        self.assertAlmostEqual(number, sum(parts), delta=2**-10 * sum(map(abs, parts)) + 1e-6)

    def test_colors_of_acescg_are_those_of_rec709(self):
        to_ap1 = [[0.61309, 0.33952, 0.04737], [0.07020, 0.91635, 0.01345], [0.02062, 0.10957, 0.86961]]  # Bradford, to D60
        given, found = (picture(frozenset(options))[0].channels for options in ((), ("acescg",)))
        for layer in ("", "subsurface.", "specular.", "albedo."):
            for y, x in itertools.product(range(HEIGHT), range(WIDTH)):
                color = [given[layer + c][y][x] for c in "RGB"]
                for c, weights in zip("RGB", to_ap1):
                    wanted = sum(w * n for w, n in zip(weights, color))
                    self.assertAlmostEqual(found[layer + c][y][x], wanted, delta=2e-3 * max(map(abs, color)) + 1e-6)

    def test_clamp_is_the_most_that_a_sample_has(self):
        plain, clamped = (picture(frozenset(options))[0].channels for options in ((), ("clamp",)))
        self.assertGreater(max(max(row) for row in plain["R"]), 0.4)
        for c in "RGB":
            for row, cut_row in zip(plain[c], clamped[c]):
                for number, less in zip(row, cut_row):
                    self.assertLessEqual(less, min(number, 0.4) + 1e-3)
        self.assertEqual(plain["R"][0][0], clamped["R"][0][0])  # the sky is below

    def test_wrong_regions_are_refused(self):
        for region in ("1,2,3", "1,2,3,4,5", "1,2,3,x", "1,2,0,4", "-1,2,3,4", "9,9,9,9", "1;2;3;4", "1,2,3,4 "):
            with self.subTest(region), self.assertRaises(Refused) as refusal:
                run("render", "scene.json", "--region", region, "-o", "wrong.exr")
            self.assertIn("--region", str(refusal.exception))


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        os.chdir(scratch)
        with open("scene.json", "w") as scene_file:
            json.dump(SCENE, scene_file)
        with open("studio.ocio", "w") as config:
            config.write(OCIO)
        try:
            picture(frozenset(("ocio",)))
        except (Refused, AssertionError) as failure:
            if "built with" not in str(failure):
                raise
            del WORDS["ocio"]  # a build without OpenColorIO
        result = unittest.main(exit=False, argv=[sys.argv[0], *sys.argv[1:]]).result
        os.chdir("/")
    sys.exit(not result.wasSuccessful())
