# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""blender/lamina_materials/rules.py, without Blender: what Cycles makes of the sockets is the medium that was meant.

usage: rules_test.py ROOT
"""
import ast
import importlib.util
import json
import math
import pathlib
import sys
import unittest

ROOT = pathlib.Path(sys.argv.pop(1)).resolve()
ADD_ON = ROOT / "blender/lamina_materials"


def load(name):
    spec = importlib.util.spec_from_file_location(name, ADD_ON / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


rules = load("rules")

MEDIUM = {"material": "m", "ior": 1.4, "roughness": 0.09, "g": 0.6, "albedo": [0.99, 0.95, 0.5],
          "mean_free_path_mm": [0.5, 0.3, 0.1], "reflectance": [0.5, 0.3, 0.1]}
SHEET = {"material": "s", "ior": 1.4, "roughness": 0.0, "reflectance": [0.1, 0.3, 0.05], "transmittance": [0.3, 0.3, 0.01]}


def cycles(plan, medium, rule):
    """(albedo, mean free path in mm, factor of the color) that Cycles makes of sockets; of the radius of a method that
    does not look at the color. Written after Cycles' kernel, apart from the rules."""
    inputs, media = plan["inputs"], []
    g = inputs["Subsurface Anisotropy"]
    new = rule == "5.2" and plan["method"] == "RANDOM_WALK"
    scale = inputs.get("Subsurface Scale", 1.0)
    for color, radius in zip(inputs["Base Color"], inputs["Subsurface Radius"]):
        length = scale * radius if new else 0.25 / math.pi * scale * radius
        if new:
            albedo, sigma_t = rules.van_de_hulst_albedo(color, g), 1 / length
        else:
            albedo, sigma_t = rules.wrenninge_albedo(color, g), 1 / length / (1 - g)
        media.append((albedo, 1 / sigma_t))
    return media


class Rules(unittest.TestCase):
    def test_versions(self):
        for version, rule in (((3, 0), "3.0"), ((3, 4, 1), "3.0"), ((4, 0, 0), "4.0"), ((4, 5, 3), "4.0"), ((5, 1, 0), "4.0"),
                              ((5, 2, 0), "5.2"), ((6, 0), "5.2")):
            self.assertEqual(rules.rule_of(version), rule)
        with self.assertRaisesRegex(rules.Refused, "begin with 3.0"):
            rules.rule_of((2, 93, 0))

    def test_sockets_are_those_of_the_version(self):
        old = rules.plan(MEDIUM, (3, 4, 1), 1)
        self.assertEqual((old["method"], old["inputs"]["Subsurface"]), ("RANDOM_WALK_FIXED_RADIUS", 1.0))
        self.assertEqual(old["inputs"]["Subsurface Color"], old["inputs"]["Base Color"])
        self.assertAlmostEqual(old["inputs"]["Specular"], (0.4 / 2.4) ** 2 / 0.08)
        self.assertEqual(rules.plan(MEDIUM, (3, 4, 1), 1, "SKIN")["method"], "RANDOM_WALK")
        for version, methods in (((4, 5), ("RANDOM_WALK", "SKIN")), ((5, 2), rules.METHODS)):
            for method in methods:
                plan = rules.plan(MEDIUM, version, 1, method)
                self.assertEqual(plan["method"], "RANDOM_WALK" + ("" if method == "RANDOM_WALK" else "_" + method))
                self.assertEqual(max(plan["inputs"]["Subsurface Radius"]), 1)
                self.assertNotIn("Subsurface", plan["inputs"])
        for plan in (old, rules.plan(MEDIUM, (4, 5), 1)):
            self.assertAlmostEqual(plan["inputs"]["Roughness"] ** 2, MEDIUM["roughness"])

    def test_walk_is_in_the_medium(self):
        for version, method in (((3, 4), "RANDOM_WALK"), ((4, 5), "RANDOM_WALK"), ((5, 2), "RANDOM_WALK"), ((5, 2), "LEGACY")):
            rule = rules.rule_of(version)
            plan = rules.plan(MEDIUM, version, 10, method)
            for (albedo, length), wanted, wanted_length in zip(cycles(plan, MEDIUM, rule), MEDIUM["albedo"],
                                                               MEDIUM["mean_free_path_mm"]):
                self.assertAlmostEqual(10 * length / wanted_length, 1, delta=1e-9)
                ratio = rules.van_de_hulst_color(albedo, 0.6) / rules.van_de_hulst_color(wanted, 0.6)
                self.assertGreater(ratio, 0.9)  # what surface and entry take is given back
                self.assertLess(ratio, 1.35)

    def test_radius_is_the_mean_free_path_from_5_2_on(self):
        for version, factor in (((3, 4), 4 * math.pi / 0.4), ((5, 1), 4 * math.pi / 0.4), ((5, 2), 1)):
            inputs = rules.plan(MEDIUM, version, 10)["inputs"]
            for radius, length in zip(inputs["Subsurface Radius"], MEDIUM["mean_free_path_mm"]):
                self.assertAlmostEqual(10 * inputs.get("Subsurface Scale", 1) * radius, factor * length, delta=1e-9)

    def test_surface_and_burley_take_what_was_given(self):
        walk, retro = rules.burley_factors(0.3)
        self.assertAlmostEqual(walk, 1 - 1 / 42, delta=2e-3)  # of the mean of (1 - cos)^5
        plan = rules.plan(MEDIUM, (3, 4), 1)
        for (albedo, _), color, wanted in zip(cycles(plan, MEDIUM, "3.0"), plan["inputs"]["Base Color"], MEDIUM["albedo"]):
            obtained = walk * rules.van_de_hulst_color(albedo, 0.6) + retro * color
            self.assertAlmostEqual(obtained / rules.van_de_hulst_color(wanted, 0.6), 1, delta=2e-3)

    def test_burley_with_the_retro_reflection_is_nearly_white_at_middle_roughness(self):
        walk, retro = rules.burley_factors(0.5)  # Burley 2012 made it so, with the factor on the way in as well
        self.assertAlmostEqual(walk * walk + retro, 1, delta=0.03)

    def test_color_of_an_albedo_has_it(self):
        for fit in (rules.wrenninge_albedo, rules.van_de_hulst_albedo):
            for g in (0.0, 0.5, 0.9):
                for albedo in (0.25, 0.7, 0.99, 0.9999):
                    self.assertAlmostEqual(fit(rules.color_of(albedo, g, fit), g), albedo, delta=1e-9)
        for albedo in (0.3, 0.99):
            self.assertAlmostEqual(rules.van_de_hulst_albedo(rules.van_de_hulst_color(albedo, 0.4), 0.4), albedo, delta=3e-5)

    def test_diffuse_light_is_reflected_as_known(self):
        self.assertAlmostEqual(rules.fresnel_diffuse(1.4), 0.0769, delta=2e-4)  # Walsh's formula
        self.assertAlmostEqual(rules.fresnel(0.3, 1.0), 0.0, delta=1e-15)

    def test_refraction_at_entry_changes_nothing_where_nothing_refracts(self):
        self.assertAlmostEqual(rules.refracted_entry_factor(0.9, 0.0, 1.0), 1)
        self.assertLess(rules.refracted_entry_factor(0.9, 0.0, 1.5), 1)  # deeper in, less returns

    def test_skin_has_the_radius_of_its_reduced_albedo(self):
        plan, fixed = (rules.plan(MEDIUM, (3, 4), 1, method) for method in ("SKIN", "RANDOM_WALK"))
        for c in range(3):
            albedo = rules.dipole_albedo(plan["inputs"]["Base Color"][c], 1.4)
            self.assertAlmostEqual(plan["inputs"]["Subsurface Radius"][c] * math.sqrt(3 * (1 - albedo)),
                                   fixed["inputs"]["Subsurface Radius"][c] / (4 * math.pi), delta=1e-9)

    def test_sheets_are_two_lobes_or_a_thin_wall(self):
        plan = rules.plan(SHEET, (4, 5), 1)
        self.assertEqual(plan["kind"], "sheet")
        enters = 1 - rules.fresnel_diffuse(1.4)
        for side in ("reflectance", "transmittance"):
            for value, wanted in zip(plan[side], SHEET[side]):
                self.assertAlmostEqual(value * enters, wanted)
        inputs = rules.plan(SHEET, (5, 2), 1)["inputs"]
        self.assertIs(inputs["Thin Wall"], True)
        self.assertAlmostEqual((1 + inputs["Subsurface Anisotropy"]) / 2, 0.61 / 1.06)

    def test_what_cannot_be_is_refused(self):
        for change, version, method, words in (({"g": 0.95}, (3, 4), "RANDOM_WALK", "g must lie"),
                                               ({"g": -0.2}, (4, 5), "RANDOM_WALK", "g must lie"),
                                               ({}, (3, 4), "LEGACY", "method must be"), ({}, (4, 5), "BURLEY", "method must be")):
            with self.assertRaisesRegex(rules.Refused, words):
                rules.plan({**MEDIUM, **change}, version, 1, method)
        rules.plan({**MEDIUM, "g": -0.2}, (5, 2), 1)
        with self.assertRaisesRegex(rules.Refused, "mm_per_unit"):
            rules.plan(MEDIUM, (3, 4), 0)


class AddOn(unittest.TestCase):
    def test_every_material_has_a_plan_in_every_version(self):
        materials = json.loads((ADD_ON / "materials.json").read_text())
        self.assertIn("skin_type_3", materials)
        for name, medium in materials.items():
            for version in ((3, 4, 1), (4, 5), (5, 2)):
                plan = rules.plan(medium, version, 1000)
                self.assertEqual(plan["kind"] == "sheet", bool(medium.get("transmittance")) and version < (5, 2), name)
                for color in (plan.get("inputs", {}).get("Base Color", []), plan.get("reflectance", [])):
                    self.assertTrue(all(0 <= x <= 1 for x in color), name)

    def test_skin_darkens_with_melanin_and_reddens_with_blood(self):
        sys.path.insert(0, str(ADD_ON))
        skins = load("skins")
        for i, melanin in enumerate(skins.MELANIN):
            for j, hemoglobin in enumerate(skins.HEMOGLOBIN):
                medium, known = skins.skin(melanin, hemoglobin, 0.1), skins.TABLE["media"][i][j]
                for a, b in zip(medium["albedo"], known["albedo"]):
                    self.assertAlmostEqual(a, b, delta=1e-12)
        light, dark, red = (skins.skin(*values, 0.1)["reflectance"] for values in ((0.01, 0.002), (0.08, 0.002), (0.01, 0.007)))
        self.assertTrue(all(a > b for a, b in zip(light, dark)))
        self.assertGreater(red[0] / red[1], 1.1 * light[0] / light[1])

    def test_every_file_is_python_and_imports_only_what_blender_has(self):
        allowed = {"bpy", "json", "math", "os", "pathlib", None}
        for file in ADD_ON.glob("*.py"):
            tree = ast.parse(file.read_text())
            for node in ast.walk(tree):
                names = ([alias.name for alias in node.names] if isinstance(node, ast.Import) else
                         [node.module if not node.level else None] if isinstance(node, ast.ImportFrom) else [])
                for name in names:
                    self.assertIn(name and name.split(".")[0], allowed, file.name)


if __name__ == "__main__":
    unittest.main()
