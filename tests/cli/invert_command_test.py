#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""What users meet at `lamina invert`: colors, textures, material files, refusals.

usage: invert_command_test.py LAMINA
"""

import json
import os
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

LAMINA = os.path.abspath(sys.argv.pop(1))


def run(*arguments, command="invert"):
    return subprocess.run([LAMINA, command, *map(str, arguments)], capture_output=True, text=True, timeout=120)


def result_of(*arguments, command="invert"):
    result = run(*arguments, "--json", "-", command=command)
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


def write_png(path, width, rows):
    """8 bit RGB; rows of [r, g, b, r, g, b, ...]."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    pixels = b"".join(b"\0" + bytes(row) for row in rows)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, len(rows), 8, 2, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(pixels)) + chunk(b"IEND", b""))


class Invert(unittest.TestCase):
    def test_color_comes_out_by_the_solver_of_slabs(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "wax.json")
            color = [0.7, 0.4, 0.1]
            look = ["--color", *color, "--ior", 1.45, "--g", 0.6, "--radius", 0.5, 0.3, 0.2]
            for definition in ("openpbr", "normal", "diffuse", "furnace"):
                found = result_of(*look, "--definition", definition, "-o", file)
                light = "normal" if definition in ("openpbr", "normal") else "diffuse"
                slab = result_of(file, "--incidence", light, command="slab")
                for c in range(3):
                    first, rest = slab["specular_reflectance"][c], slab["diffuse_reflectance"][c]
                    out = {"openpbr": rest / (1 - first), "furnace": first + rest}.get(definition, rest)
                    self.assertAlmostEqual(out / color[c], 1.0, delta=1e-3, msg=definition)
                    self.assertAlmostEqual(1 / (found["sigma_a"][c] + found["sigma_s"][c]), [0.5, 0.3, 0.2][c])
                    self.assertAlmostEqual(found["colors"][definition][c], color[c])

    def test_colors_are_said_in_several_ways(self):
        linear = [0.5271151257, 0.2158605001, 0.1169706678]
        for said in (["#c08060"], linear, [192 / 255, 128 / 255, 96 / 255, "--srgb"]):
            for wanted, found in zip(linear, result_of("--color", *said)["color"]):
                self.assertAlmostEqual(wanted, found, places=9)
        self.assertEqual(result_of("--color", 0.5)["color"], [0.5, 0.5, 0.5])
        self.assertEqual(result_of("--color", 1, 1, 1)["albedo"], [1, 1, 1])

    def test_radius_has_a_unit_and_a_meaning(self):
        color = ["--color", 0.5, "--g", 0.5]
        mm = result_of(*color, "--radius", 0.2)
        self.assertEqual(result_of(*color, "--radius", 200, "--radius-unit", "um")["sigma_s"], mm["sigma_s"])
        diffuse = result_of(*color, "--radius", 0.2, "--radius-meaning", "diffuse_mean_free_path")
        a, s = diffuse["sigma_a"][0], diffuse["sigma_s"][0]
        self.assertAlmostEqual((3 * a * (a + 0.5 * s)) ** -0.5, 0.2)

    def test_check_solves_without_the_table(self):
        found = result_of("--color", 0.6, 0.3, 0.05, "--check")
        for color, solved in zip(found["color"], found["solved"]["color"]):
            self.assertLess(abs(solved / color - 1), 1e-3)
            self.assertNotEqual(solved, color)
        self.assertIn("off by [%]", run("--color", 0.6, "--check").stdout)

    def test_texture_has_the_albedos_of_its_colors(self):
        with tempfile.TemporaryDirectory() as folder:
            texture, output = os.path.join(folder, "t.png"), os.path.join(folder, "albedo.exr")
            write_png(texture, 2, [[192, 128, 96] * 2] * 3)
            found = result_of("--texture", texture, "-o", output, "--definition", "diffuse", "--radius", 1)
            alone = result_of("--color", "#c08060", "--definition", "diffuse")["albedo"]
            self.assertEqual(found["size"], [2, 3])
            for mean, albedo in zip(found["mean_albedo"], alone):
                self.assertAlmostEqual(mean, albedo, places=6)
            linear = result_of("--texture", texture, "-o", output, "--encoding", "linear")["mean_albedo"]
            for mean, albedo in zip(linear, result_of("--color", 192 / 255, 128 / 255, 96 / 255)["albedo"]):
                self.assertAlmostEqual(mean, albedo, places=6)
            # What is written is read again: albedos in the place of colors.
            again = os.path.join(folder, "again.exr")
            twice = result_of("--texture", output, "-o", again)["mean_albedo"]
            for mean, albedo in zip(twice, result_of("--color", *map(str, linear))["albedo"]):
                self.assertAlmostEqual(mean, albedo, places=5)

    def test_texels_out_of_reach_are_refused_or_clamped(self):
        with tempfile.TemporaryDirectory() as folder:
            texture, output = os.path.join(folder, "t.png"), os.path.join(folder, "albedo.exr")
            write_png(texture, 2, [[9, 9, 9, 9, 9, 9], [9, 9, 9, 9, 255, 255]])
            look = ["--texture", texture, "-o", output, "--definition", "normal"]
            result = run(*look)
            self.assertEqual(result.returncode, 2)
            self.assertEqual(result.stderr.count("\n"), 1)
            for word in (texture, "1 of 4 texels", "x 1, y 1", "G", "0.9722", "--clamp"):
                self.assertIn(word, result.stderr)
            self.assertFalse(os.path.exists(output))
            self.assertEqual(result_of(*look, "--clamp")["clamped_texels"], 1)

    def test_wrong_use_is_refused_in_one_line(self):
        with tempfile.TemporaryDirectory() as folder:
            broken = os.path.join(folder, "broken.png")
            with open(broken, "wb") as file:
                file.write(b"\x89PNG\r\n\x1a\nno")
            exr, material = os.path.join(folder, "a.exr"), os.path.join(folder, "a.json")
            color = ["--color", 0.5]
            for arguments, words in (
                    ([], ("--color", "--texture")),
                    (["--color", 0.5, 0.5], ("--color", "three numbers", "0.5 0.5")),
                    (["--color", "#12345g"], ("--color", "#12345g")),
                    (["--color", "nan"], ("--color", "nan")),
                    (["--color", "-0.1"], ("--color", "-0.1")),
                    (["--color", 1.01], ("R", "[0, 1]", "1.01")),
                    (["--color", 0.99, "--definition", "normal"], ("0.9722", "0.99", "normal, ior 1.4")),
                    (["--color", 0.05, "--definition", "furnace"], ("0.0769", "0.05")),
                    ([*color, "--ior", 1.7], ("--ior", "1.7", "1.6")),
                    ([*color, "--g", 0.96], ("--g", "0.96", "0.95")),
                    ([*color, "--roughness", 2], ("--roughness", "2")),
                    ([*color, "--definition", "openpbrr"], ("--definition", "openpbr")),
                    ([*color, "--radius", 1, 2], ("--radius", "2")),
                    ([*color, "--radius", 0], ("radius", "0")),
                    ([*color, "--radius-unit", "cm"], ("--radius-unit", "--radius")),
                    (["--color", 1, "--radius", 1, "--radius-meaning", "diffuse_mean_free_path"], ("without end",)),
                    ([*color, "--clamp"], ("--clamp", "--texture")),
                    ([*color, "-o", exr], (".json", exr)),
                    ([*color, "--texture", broken], ("--color",)),
                    (["--texture", broken], ("--output",)),
                    (["--texture", broken, "-o", material], (".exr", material)),
                    (["--texture", broken, "-o", exr], (broken,)),
                    (["--texture", os.path.join(folder, "none.png"), "-o", exr], ("none.png",)),
                    (["--texture", broken, "-o", exr, "--check"], ("--check", "--color"))):
                with self.subTest(arguments=arguments):
                    result = run(*arguments)
                    self.assertEqual(result.returncode, 2, result.stderr)
                    self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
                    for word in words:
                        self.assertIn(word, result.stderr)
            self.assertEqual(sorted(os.listdir(folder)), ["broken.png"])


if __name__ == "__main__":
    unittest.main()
