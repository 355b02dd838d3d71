# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""`lamina export`, run: what the tests of all formats share."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

LAMINA, ROOT = os.path.abspath(sys.argv.pop(1)), pathlib.Path(sys.argv.pop(1)).resolve()

# Of one clear layer.
CLEAR = {"lamina": "material", "version": 1, "name": "clear", "length_unit": "mm", "bands": "rgb",
         "ior_above": 1.0, "ior_below": 1.0,
         "layers": [{"sigma_a": 1.0, "sigma_s": 0, "g": 0, "ior": 1.4, "thickness": 1.0}]}


def run(*args, cwd=None):
    return subprocess.run([LAMINA, *map(str, args)], capture_output=True, text=True, timeout=300, cwd=cwd)


def export(folder, material, formats, *args):
    """The result, with the text of every file by its name."""
    result = run("export", material, "--to", formats, "-o", str(folder) + "/", "--json", "-", *args)
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout), {file.name: file.read_bytes() for file in pathlib.Path(folder).iterdir()}


def names():
    return [row["name"] for row in json.loads(run("export", "--to", "list", "--json", "-").stdout)["formats"]]


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)


def diffuse_total(folder, sigma_a, sigma_s, g, ior, thickness="infinite"):
    """What a medium returns of diffuse light, per channel, by `lamina slab`."""
    material = {"lamina": "material", "version": 1, "name": "written", "length_unit": "mm", "bands": "rgb",
                "ior_above": 1.0,
                "layers": [{"sigma_a": sigma_a, "sigma_s": sigma_s, "g": g, "ior": ior, "thickness": thickness}]}
    if thickness != "infinite":
        material["ior_below"] = 1.0
    (folder / "written.json").write_text(json.dumps(material))
    result = json.loads(run("slab", folder / "written.json", "--incidence", "diffuse", "--json", "-").stdout)
    (folder / "written.json").unlink()
    return result["diffuse_reflectance"], result["transmittance"]
