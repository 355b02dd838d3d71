# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""`lamina export` to the sheets of Arnold, RenderMan, Unreal and Unity.

usage: parameter_sheets_test.py LAMINA ROOT
"""
import json
import math
import unittest

from exporting import Folder, export
from format_readers import SHEETS, arnold_node, check_sheet, rib_bxdf


class Sheets(Folder):
    def sheet(self, material, name, *args):
        export(self.folder, material, name, *args)
        data = json.loads((self.folder / f"{material}_{name}.json").read_text())
        check_sheet(data)
        return data

    def test_keep_to_the_schema_for_something_thick_and_a_leaf(self):
        for name in SHEETS:
            for material in ("donner_jensen_skin", "leaf"):
                with self.subTest(f"{name}, {material}"):
                    self.sheet(material, name)

    def test_schema_refuses_what_is_missing_or_unknown(self):
        try:
            import jsonschema
        except ImportError:
            self.skipTest("no jsonschema")
        data = self.sheet("jade", "unreal")
        for change in (lambda p: p.pop("bEnableMeanFreePath"), lambda p: p.update(bEnableMeanFreePath=False),
                       lambda p: p.update(Glow=1), lambda p: p.update(MeanFreePathDistance=-1)):
            broken = json.loads(json.dumps(data))
            change(broken["parameters"])
            with self.assertRaises(jsonschema.ValidationError):
                check_sheet(broken)

    def test_lengths_are_those_of_the_medium(self):
        export(self.folder, "jade", "blender")
        medium = json.loads((self.folder / "jade_blender.json").read_text())
        arnold = self.sheet("jade", "arnold", "--mm-per-unit", 10)["parameters"]
        renderman = self.sheet("jade", "renderman", "--mm-per-unit", 10)["parameters"]
        self.assertAlmostEqual(renderman["unitLength"], 0.1)
        for c, (albedo, length) in enumerate(zip(medium["albedo"], medium["mean_free_path_mm"])):
            self.assertAlmostEqual(10 * arnold["subsurface_scale"] * arnold["subsurface_radius"][c] / length, 1, delta=1e-9)
            sigma_a, sigma_t_prime = (1 - albedo) / length, (1 - albedo * medium["g"]) / length
            dmfp = 1 / math.sqrt(3 * sigma_a * sigma_t_prime)
            self.assertAlmostEqual(renderman["subsurfaceDmfp"] * renderman["subsurfaceDmfpColor"][c] / dmfp, 1, delta=1e-9)

    def test_scenes_of_arnold_say_what_the_sheet_says(self):
        for material in ("jade", "leaf"):
            sheet = self.sheet(material, "arnold", "--mm-per-unit", 10)["parameters"]
            kind, name, values = arnold_node((self.folder / f"{material}.ass").read_text())
            self.assertEqual((kind, name), (sheet.pop("node"), material))
            self.assertEqual(values, sheet)

    def test_ribs_say_what_the_sheet_says(self):
        for material in ("jade", "leaf"):
            sheet = self.sheet(material, "renderman", "--mm-per-unit", 10)["parameters"]
            kind, name, values = rib_bxdf((self.folder / f"{material}.rib").read_text())
            self.assertEqual((kind, name), (sheet.pop("node"), material))
            choices = {"specularFresnelMode": {"Physical": 1}, "subsurfaceType": {"Path Traced, exponential": 4}}
            expected = {}
            for key, value in sheet.items():
                if isinstance(value, list):
                    expected[key] = ("color", value)
                elif isinstance(value, (bool, str)):
                    expected[key] = ("int", [choices[key][value] if key in choices else int(value)])
                else:
                    expected[key] = ("color", 3 * [value]) if key == "specularIor" else ("float", [value])
            self.assertEqual(values, expected)

    def test_burleys_profile_has_the_total_and_falls_as_it_should(self):
        result, _ = export(self.folder, "jade", "unity-hdrp")
        data = json.loads((self.folder / "jade_unity-hdrp.json").read_text())["parameters"]
        for c, misfit in enumerate(result["exports"][0]["misfit"]):
            light = misfit["reflectance"]
            self.assertEqual(light["wanted_total"], light["obtained_total"])
            d = data["scatteringDistance"][c] * data["scatteringDistanceMultiplier"]
            self.assertAlmostEqual(light["obtained_mean_square_radius_mm2"] / (14 * d * d), 1, delta=0.02)
            self.assertLess(light["profile_rms"], 0.6)


if __name__ == "__main__":
    unittest.main()
