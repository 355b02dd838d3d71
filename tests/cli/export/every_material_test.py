# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Every format on every built-in material and on materials at the edges: files that parsers take, or one line and exit code 2.

EXPORT_PART=1/4 in the environment takes every fourth built-in material, from the second on; the others are of the part 0.

usage: every_material_test.py LAMINA ROOT
"""
import json
import math
import os
import sys
import unittest

from exporting import CLEAR, Folder, export, names, run
from format_readers import read_exported

PART, PARTS = map(int, os.environ.get("EXPORT_PART", "0/1").split("/"))
# Of `varnish`, a clear film over gesso, formats that ask for a profile are refused after 47 s of solving.
DEAR = {"varnish": "mcml,mcx"}


def material_of(name, **layer):
    material = CLEAR | {"name": name, "layers": [CLEAR["layers"][0] | layer]}
    if layer.get("thickness") == "infinite":
        del material["ior_below"]
    return material


EDGES = {
    "clear": CLEAR,
    "clear_without_end": material_of("clear_without_end", thickness="infinite"),
    "thin": material_of("thin", sigma_s=50.0, thickness=1e-4),
    "white_without_end": material_of("white_without_end", sigma_a=0.0, sigma_s=[1.0, 2.0, 4.0], thickness="infinite"),
    "black": material_of("black", sigma_a=1000.0, sigma_s=0.01, thickness="infinite"),
    "backward": material_of("backward", sigma_s=20.0, g=-0.5, thickness="infinite"),
}


class EveryMaterial(Folder):
    def check(self, material, formats, *args):
        """What was refused, by format."""
        result, files = export(self.folder / material, material, formats, *args)
        self.assertEqual([one["format"] for one in result["exports"]], names() if formats == "all" else formats.split(","))
        for one in result["exports"]:
            self.assertNotEqual(bool(one["files"]), "refusal" in one)
            self.assertEqual(len(one.get("refusal", "a line").splitlines()), 1)
            for misfit in one["misfit"]:
                for light in misfit.values():
                    if not isinstance(light, str):
                        self.assertTrue(all(math.isfinite(x) for x in light.values()), light)
        for name, content in files.items():
            read_exported(name, content)
        return {one["format"]: one["refusal"] for one in result["exports"] if "refusal" in one}

    def test_built_in_ones(self):
        listed = json.loads(run("materials", "--json", "-").stdout)["materials"]
        self.assertGreater(len(listed), 40)
        for material in listed[PART::PARTS]:
            name = material["name"]
            with self.subTest(name):
                # One wavelength is enough of those that have others than their file's.
                is_free = run("materials", name, "--bands", 550).returncode == 0
                bands = ["--bands", 550] if is_free and isinstance(material["bands"][0], (int, float)) else []
                refused = self.check(name, DEAR.get(name, "all"), *bands)
                self.assertFalse({"mcml", "mcx"} & set(refused), refused)  # layers are always said

    def test_wavelengths_without_conversion(self):
        for name in ("snow", "green_leaf"):  # one thick, one a sheet
            with self.subTest(name):
                refused = self.check(name, "all", "--channels", "bands", "--bands", "500,600")
                self.assertIn("openpbr", refused)
                self.assertNotIn("pbrt-v4", refused)

    def test_edges(self):
        for name, content in EDGES.items():
            file = self.folder / f"{name}.json"
            file.write_text(json.dumps(content))
            refused = set()
            for to in names():
                with self.subTest(f"{name}, {to}"):
                    folder = self.folder / f"{name}_{to}"
                    result = run("export", file, "--to", to, "-o", str(folder) + "/")
                    self.assertIn(result.returncode, (0, 2), result.stderr)
                    if result.returncode == 2:
                        refused.add(to)
                        self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)
                        self.assertFalse(folder.exists())
                    else:
                        for one in folder.iterdir():
                            read_exported(one.name, one.read_bytes())
            self.assertFalse({"mcml", "mcx"} & refused, name)
            if name.startswith("clear"):
                self.assertEqual(refused, set(names()) - {"mcml", "mcx"})


def load_tests(loader, tests, _):
    return tests if PART == 0 else loader.loadTestsFromName("EveryMaterial.test_built_in_ones", sys.modules[__name__])


if __name__ == "__main__":
    unittest.main()
