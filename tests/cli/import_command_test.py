# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""`lamina import`: what was exported comes back, and wrong numbers are refused.

usage: import_command_test.py LAMINA ROOT
"""
import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

LAMINA, ROOT = os.path.abspath(sys.argv.pop(1)), pathlib.Path(sys.argv.pop(1)).resolve()
SPEC = importlib.util.spec_from_file_location("rules", ROOT / "blender/lamina_materials/rules.py")
rules = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(rules)


def run(*args):
    return subprocess.run([LAMINA, *map(str, args)], capture_output=True, text=True, timeout=300)


def done(*args):
    result = run(*args)
    assert result.returncode == 0, result.stderr
    return result


class Import(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def medium(self, material):
        done("export", material, "--to", "blender", "-o", self.folder / "out", *(["--g", 0]))
        (file,) = (self.folder / "out").glob("*.json")
        medium = json.loads(file.read_text())
        for one in (self.folder / "out").iterdir():
            one.unlink()
        return medium

    def test_blenders_sockets_come_back_to_the_same_sockets(self):
        (self.folder / "out").mkdir()
        wanted = self.medium("jensen_skin2")
        for version, name in (((3, 4), "3"), ((4, 5), "4"), ((5, 2), "5.2")):
            with self.subTest(name):
                inputs = rules.plan(wanted, version, 10)["inputs"]
                material = self.folder / "imported.json"
                done("import", "--from", "principled", "--blender", name, "--color", *inputs["Base Color"], "--radius",
                     *inputs["Subsurface Radius"], "--scale", inputs.get("Subsurface Scale", 1), "--g", 0, "--ior", inputs["IOR"],
                     "--roughness", inputs["Roughness"], "--mm-per-unit", 10, "-o", material)
                obtained = self.medium(material)
                for c in range(3):
                    self.assertAlmostEqual(obtained["reflectance"][c] / wanted["reflectance"][c], 1, delta=0.01)
                    self.assertAlmostEqual(obtained["mean_free_path_mm"][c] / wanted["mean_free_path_mm"][c], 1, delta=0.02)

    def test_openpbr_comes_back_as_the_same_medium(self):
        done("export", "jensen_skin2", "--to", "openpbr", "-o", self.folder / "a.mtlx")
        root = xml.etree.ElementTree.parse(self.folder / "a.mtlx").getroot()
        inputs = {i.get("name"): i.get("value").split(", ") for i in root[0]}
        scale = float(inputs["subsurface_radius"][0])
        result = done("import", "--from", "openpbr", "--color", *inputs["subsurface_color"], "--radius", *inputs["subsurface_radius_scale"],
             "--scale", scale, "--g", *inputs["subsurface_scatter_anisotropy"], "--ior", *inputs["specular_ior"], "--roughness",
             *inputs["specular_roughness"], "-o", self.folder / "b.json")
        layer = json.loads((self.folder / "b.json").read_text())["layers"][0]
        original = json.loads(done("materials", "jensen_skin2", "--json", "-").stdout)
        layers = (original.get("material") or original)["layers"][0]
        for key in ("sigma_a", "sigma_s"):
            for obtained, wanted in zip(layer[key], layers[key]):
                self.assertAlmostEqual(obtained / wanted, 1, delta=2e-3)
        self.assertIn("by the definition of OpenPBR 1.1.1", result.stdout)

    def test_wrong_use_is_one_line(self):
        good = ["--from", "openpbr", "--color", ".5", "--radius", "1", "-o", self.folder / "m.json"]
        self.assertEqual(run("import", *good).returncode, 0)
        (self.folder / "m.json").unlink()
        for change, word in (({"--color": "1.5"}, "color R"), ({"--radius": "0"}, "radius R"), ({"--from": "unreal"}, "--from"),
                             ({"-o": self.folder / "m.exr"}, ".json"), ({"-o": self.folder / "no/m.json"}, "no")):
            arguments = [change.get(good[i - 1], x) if i else x for i, x in enumerate(good)]
            result = run("import", *arguments)
            self.assertIn(result.returncode, (1, 2), change)
            self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)
            self.assertIn(word, result.stderr)
        self.assertIn("three numbers", run("import", *good[:3], "1", "1", *good[4:]).stderr)
        self.assertEqual(list(self.folder.iterdir()), [])


if __name__ == "__main__":
    unittest.main()
