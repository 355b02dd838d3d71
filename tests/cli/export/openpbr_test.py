# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""`lamina export --to openpbr`.

usage: openpbr_test.py LAMINA ROOT
"""
import json
import os
import unittest

from exporting import Folder, diffuse_total, export, run
from format_readers import openpbr_inputs


class OpenPbr(Folder):
    def test_the_definition_makes_the_medium_that_returns_the_light(self):
        result, files = export(self.folder, "donner_jensen_skin", "openpbr", "--mm-per-unit", 10)
        inputs = openpbr_inputs(files["donner_jensen_skin.mtlx"])
        (g,), (radius,) = inputs["subsurface_scatter_anisotropy"], inputs["subsurface_radius"]
        sigma_a, sigma_s = [], []
        inverted = json.loads(run("invert", "--color", *inputs["subsurface_color"], "--ior", *inputs["specular_ior"], "--g", g,
                                  "--definition", "openpbr", "--json", "-").stdout)
        for albedo, scale in zip(inverted["albedo"], inputs["subsurface_radius_scale"]):
            sigma_s.append(albedo / (10 * radius * scale))
            sigma_a.append((1 - albedo) / (10 * radius * scale))
        total, _ = diffuse_total(self.folder, sigma_a, sigma_s, g, *inputs["specular_ior"])
        for value, misfit in zip(total, result["exports"][0]["misfit"]):
            self.assertAlmostEqual(value, misfit["reflectance"]["wanted_total"], delta=3e-4)
        self.assertIn("by the definition of OpenPBR 1.1.1", files["donner_jensen_skin.mtlx"].decode())

    def test_skins_have_radii_of_their_own_and_the_same_name_by_materialx(self):
        found = []
        for name in ("skin_type_2", "skin_type_6"):
            export(self.folder, name, "materialx", "--bands", "450,550,650")
            found.append(openpbr_inputs((self.folder / f"{name}.mtlx").read_text()))
        light, dark = found
        self.assertGreater(min(a - b for a, b in zip(light["subsurface_color"], dark["subsurface_color"])), 0.05)
        self.assertNotEqual(light["subsurface_radius"], dark["subsurface_radius"])
        for inputs in found:
            self.assertEqual(inputs["geometry_thin_walled"], [0.0])
            self.assertEqual(sorted(inputs["subsurface_radius_scale"], reverse=True), inputs["subsurface_radius_scale"])

    def test_sheets_are_thin_walls(self):
        result, files = export(self.folder, "leaf", "openpbr")
        inputs = openpbr_inputs(files["leaf.mtlx"])
        self.assertEqual(inputs["geometry_thin_walled"], [1.0])
        self.assertNotIn("subsurface_radius", inputs)
        slab = json.loads(run("slab", "leaf", "--incidence", "diffuse", "--json", "-").stdout)
        lit = sum(slab["diffuse_reflectance"]), sum(slab["transmittance"])
        (forward,) = inputs["subsurface_scatter_anisotropy"]
        self.assertAlmostEqual((1 + forward) / 2, lit[1] / sum(lit), delta=1e-4)
        for misfit in result["exports"][0]["misfit"]:
            self.assertAlmostEqual(*(sum(misfit[side][key] for side in ("reflectance", "transmittance"))
                                     for key in ("wanted_total", "obtained_total")), delta=1e-9)

    def test_wavelengths_are_refused(self):
        result = run("export", "snow", "--to", "openpbr", "--channels", "bands", "-o", self.folder)
        self.assertEqual((result.returncode, os.listdir(self.folder)), (2, []))
        self.assertIn("must be R, G, B", result.stderr)


if __name__ == "__main__":
    unittest.main()
