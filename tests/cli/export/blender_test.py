# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""`lamina export --to blender`.

usage: blender_test.py LAMINA ROOT
"""
import json
import math
import unittest

from exporting import Folder, diffuse_total, export, run


class Blender(Folder):
    def test_script_is_python_and_has_the_medium(self):
        """Run with a bpy that keeps what is set: no Blender is needed."""
        export(self.folder, "marble", "blender", "--mm-per-unit", 1000)
        medium = json.loads((self.folder / "marble_blender.json").read_text())
        total, _ = diffuse_total(self.folder, *([x(a) / l for a, l in zip(medium["albedo"], medium["mean_free_path_mm"])]
                                                for x in (lambda a: 1 - a, lambda a: a)), medium["g"], 1.0)
        for value, wanted in zip(total, medium["reflectance"]):
            self.assertAlmostEqual(value, wanted, delta=1e-4)
        source = (self.folder / "marble_blender.py").read_text().split("\nmake_material(")[0].replace("import bpy\n", "")
        names = {}
        exec(source, names)
        self.assertEqual(names["MEDIUM"], medium)
        plan = names["plan"](medium, (3, 4, 1), names["MM_PER_UNIT"])
        for radius, length in zip(plan["inputs"]["Subsurface Radius"], medium["mean_free_path_mm"]):
            self.assertAlmostEqual(radius * 1000 / (4 * math.pi * length), 1, delta=1e-9)

    def test_sheets_have_two_colors(self):
        export(self.folder, "leaf", "blender")
        medium = json.loads((self.folder / "leaf_blender.json").read_text())
        slab = json.loads(run("slab", "leaf", "--incidence", "diffuse", "--json", "-").stdout)
        for side, key in (("reflectance", "diffuse_reflectance"), ("transmittance", "transmittance")):
            for value, wanted in zip(medium[side], slab[key]):
                self.assertAlmostEqual(value, wanted, delta=2e-5)
        self.assertNotIn("albedo", medium)


if __name__ == "__main__":
    unittest.main()
