# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""`lamina export --to gltf`.

usage: gltf_test.py LAMINA ROOT
"""
import json
import math
import os
import struct
import subprocess
import unittest

from exporting import Folder, diffuse_total, export, run
from format_readers import read_glb


def validate_gltf(file):
    """By the validator of Khronos, where GLTF_VALIDATOR names the folder of its npm package; errors are none."""
    package = os.environ.get("GLTF_VALIDATOR")
    if not package:
        return
    script = ("const v=require(process.argv[1]);v.validateBytes(new Uint8Array(require('fs').readFileSync(process.argv[2])))"
              ".then(r=>process.stdout.write(JSON.stringify(r.issues)))")
    issues = json.loads(subprocess.run(["node", "-e", script, package, str(file)], capture_output=True, check=True).stdout)
    assert issues["numErrors"] == 0, issues


def triangle_glb(changes=()):
    """A triangle, twice, with a red material; `changes` replace what the file says."""
    binary = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
    root = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "buffers": [{"byteLength": 36}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}, {"attributes": {"POSITION": 0}}]}],
            "materials": [{"name": "red", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}]}
    root.update(changes)
    text = json.dumps(root).encode()
    text += b" " * (-len(text) % 4)
    return (struct.pack("<III", 0x46546C67, 2, 28 + len(text) + len(binary)) + struct.pack("<II", len(text), 0x4E4F534A) + text +
            struct.pack("<II", len(binary), 0x004E4942) + binary)


class Gltf(Folder):
    def test_leaf_reflects_and_transmits_in_two_colors(self):
        mesh = self.folder / "mesh.glb"
        mesh.write_bytes(triangle_glb())
        result, files = export(self.folder, "leaf", "gltf", "--mesh", mesh)
        root, binary = read_glb(files["leaf.glb"])
        validate_gltf(self.folder / "leaf.glb")
        self.assertEqual(binary, struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0))
        self.assertEqual([p["material"] for p in root["meshes"][0]["primitives"]], [0, 0])
        self.assertEqual(root["materials"][0]["name"], "leaf")
        slab = json.loads(run("slab", "leaf", "--incidence", "diffuse", "--json", "-").stdout)
        material = root["materials"][0]
        sheet = material["extensions"]["KHR_materials_diffuse_transmission"]
        factor = sheet["diffuseTransmissionFactor"]
        ratios = []
        for c in range(3):
            r = (1 - factor) * material["pbrMetallicRoughness"]["baseColorFactor"][c]
            t = factor * sheet["diffuseTransmissionColorFactor"][c]
            ratios += [slab["diffuse_reflectance"][c] / r, slab["transmittance"][c] / t]
        for ratio in ratios:  # what the surface lets in, of all
            self.assertAlmostEqual(ratio, ratios[0], delta=1e-3)
            self.assertTrue(0.9 < ratio < 0.95)
        info = run("info", self.folder / "leaf.glb")
        self.assertEqual(info.returncode, 0, info.stderr)

    def test_thick_ones_have_their_color_and_scatter_behind_a_flag(self):
        export(self.folder, "donner_jensen_skin", "gltf")
        root, _ = read_glb((self.folder / "donner_jensen_skin.glb").read_bytes())
        validate_gltf(self.folder / "donner_jensen_skin.glb")
        self.assertEqual(set(root["materials"][0]["extensions"]), {"KHR_materials_ior"})
        result, files = export(self.folder, "donner_jensen_skin", "gltf", "--scatter", "--mm-per-unit", 1000)
        extensions = read_glb(files["donner_jensen_skin.glb"])[0]["materials"][0]["extensions"]
        volume, scatter = extensions["KHR_materials_volume"], extensions["KHR_materials_scatter"]
        sigma_a, sigma_s = [], []
        for attenuation, color in zip(volume["attenuationColor"], scatter["multiscatterColorFactor"]):
            sigma_t = -math.log(attenuation) / (1000 * volume["attenuationDistance"])
            albedo = 1 - (4.09712 + 4.20863 * color - math.sqrt(9.59217 + 41.6808 * color + 17.7126 * color ** 2)) ** 2
            sigma_s.append(sigma_t * albedo)
            sigma_a.append(sigma_t * (1 - albedo))
        total, _ = diffuse_total(self.folder, sigma_a, sigma_s, scatter["scatterAnisotropy"], extensions["KHR_materials_ior"]["ior"])
        for value, misfit in zip(total, result["exports"][0]["misfit"]):
            self.assertAlmostEqual(value, misfit["reflectance"]["wanted_total"], delta=3e-4)

    def test_wrong_meshes_are_refused_in_one_line(self):
        for content, word in ((b"x", "GLB"), (triangle_glb()[:40], "cut off"), (b"glTF" + bytes(20), "GLB")):
            mesh = self.folder / "mesh.glb"
            mesh.write_bytes(content)
            result = run("export", "leaf", "--to", "gltf", "--mesh", mesh, "-o", self.folder / "out.glb")
            self.assertEqual(result.returncode, 2, content)
            self.assertIn(word, result.stderr)
            self.assertEqual(len(result.stderr.strip().splitlines()), 1)
            self.assertFalse((self.folder / "out.glb").exists())

    def test_wrong_glb_is_refused_with_its_place(self):
        for changes, words in (({"meshes": [{"primitives": [7]}]}, "meshes[0].primitives[0]"),
                               ({"bufferViews": None}, "bufferViews must be an array, but is null"), ({"bufferViews": []}, "accessors[0].bufferView"), ({"accessors": 3}, "accessors"),
                               ({"materials": [1, 2]}, "materials[0]"), ({"extensionsUsed": [5]}, "extensionsUsed[0]")):
            mesh = self.folder / "mesh.glb"
            mesh.write_bytes(triangle_glb(changes))
            result = run("export", "leaf", "--to", "gltf", "--mesh", mesh, "-o", self.folder / "out.glb")
            self.assertEqual(result.returncode, 2, (changes, result.stderr))
            self.assertIn(words, result.stderr)
            self.assertEqual(len(result.stderr.strip().splitlines()), 1)
            self.assertFalse((self.folder / "out.glb").exists())


if __name__ == "__main__":
    unittest.main()
