# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""`lamina export --to mitsuba3`.

usage: mitsuba3_test.py LAMINA ROOT
"""
import unittest

from exporting import Folder, diffuse_total, export
from format_readers import mitsuba_plugins


class Mitsuba(Folder):
    def test_medium_returns_the_light_of_the_layers(self):
        result, files = export(self.folder, "donner_jensen_skin", "mitsuba3", "--mm-per-unit", 1000)
        plugins = mitsuba_plugins(files["donner_jensen_skin.xml"])
        kind, medium = plugins["medium"]
        numbers = {name: [float(x) for x in medium[name].split(",")] for name in ("albedo", "sigma_t")}
        self.assertEqual(max(numbers["sigma_t"]), 1)
        sigma_t = [x * float(medium["scale"]) / 1000 for x in numbers["sigma_t"]]
        sigma_s = [a * t for a, t in zip(numbers["albedo"], sigma_t)]
        total, _ = diffuse_total(self.folder, [t - s for t, s in zip(sigma_t, sigma_s)], sigma_s,
                                 float(plugins["phase"][1]["g"]), float(plugins["bsdf"][1]["int_ior"]))
        for value, misfit in zip(total, result["exports"][0]["misfit"]):
            self.assertAlmostEqual(value, misfit["reflectance"]["wanted_total"], delta=1e-4)
            self.assertIn("%.5f" % misfit["reflectance"]["obtained_total"], files["donner_jensen_skin.xml"].decode())

    def test_a_single_rough_layer_is_as_it_was(self):
        _, files = export(self.folder, "marble", "mitsuba3")
        plugins = mitsuba_plugins(files["marble.xml"])
        self.assertEqual(plugins["bsdf"], ("roughdielectric", {"int_ior": "1.5", "ext_ior": "1",
                                                                "distribution": "beckmann", "alpha": "0.1"}))
        sigma_t = [float(x) * float(plugins["medium"][1]["scale"]) for x in plugins["medium"][1]["sigma_t"].split(",")]
        for value, sigma_s, sigma_a in zip(sigma_t, (2.19, 2.62, 3.00), (0.0021, 0.0041, 0.0071)):
            self.assertAlmostEqual(value, sigma_s + sigma_a, delta=1e-6)


if __name__ == "__main__":
    unittest.main()
