# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""`lamina export --to pbrt-v4`.

usage: pbrt_v4_test.py LAMINA ROOT
"""
import unittest

from exporting import Folder, diffuse_total, export
from format_readers import pbrt_statements


class Pbrt(Folder):
    def test_medium_returns_the_light_of_the_layers(self):
        result, files = export(self.folder, "donner_jensen_skin", "pbrt-v4", "--mm-per-unit", 10)
        statements = pbrt_statements(files["donner_jensen_skin.pbrt"])
        self.assertEqual({of_type for _, of_type, _ in statements.values()},
                         {"homogeneous", "dielectric", "subsurface", "coateddiffuse"})
        self.assertEqual(len([name for name in statements if "_layer_" in name]), 3)
        medium = statements["donner_jensen_skin_medium"][2]
        self.assertEqual(float(medium["scale"][1][0]), 10)
        numbers = {name: [float(x) for x in medium[name][1]] for name in ("sigma_a", "sigma_s")}
        total, _ = diffuse_total(self.folder, numbers["sigma_a"], numbers["sigma_s"], float(medium["g"][1][0]),
                                 float(statements["donner_jensen_skin_boundary"][2]["eta"][1][0]))
        for value, misfit in zip(total, result["exports"][0]["misfit"]):
            self.assertAlmostEqual(value, misfit["reflectance"]["wanted_total"], delta=1e-4)
        layer = statements["donner_jensen_skin_layer_3"][2]
        self.assertEqual([float(x) for x in layer["sigma_a"][1]], [0.085, 1.0, 25.0])

    def test_wavelengths_are_spectra(self):
        _, files = export(self.folder, "snow", "pbrt-v4", "--channels", "bands", "--bands", "500,600")
        statements = pbrt_statements(files["snow.pbrt"])
        self.assertEqual(statements["snow_medium"][2]["sigma_s"][0], "spectrum")


if __name__ == "__main__":
    unittest.main()
