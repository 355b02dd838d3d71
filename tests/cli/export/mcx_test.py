# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""`lamina export --to mcx`.

usage: mcx_test.py LAMINA ROOT
"""
import json
import unittest

from exporting import Folder, export
from format_readers import MCX


class Mcx(Folder):
    def test_layers_are_voxels_of_the_same_optical_thickness(self):
        result, files = export(self.folder, "donner_jensen_skin", "mcx")
        data = json.loads(files["donner_jensen_skin_R.mcx.json"])
        self.assertEqual(set(data), set(MCX))
        for part, keys in MCX.items():
            if keys:
                self.assertEqual(set(data[part]), keys)
        media, unit = data["Domain"]["Media"], data["Domain"]["LengthUnit"]
        self.assertEqual([m["n"] for m in media], [1.0, 1.4, 1.34, 1.4])
        grid, layers = data["Shapes"][0]["Grid"], data["Shapes"][1]["ZLayers"]
        self.assertEqual(grid["Size"], data["Domain"]["Dim"])
        self.assertEqual([first for first, _, _ in layers], [1] + [last + 1 for _, last, _ in layers[:-1]])
        self.assertEqual(layers[-1][1], grid["Size"][2])
        for (first, last, tag), thickness, sigma_s in zip(layers, (0.03, 0.05), (48, 32)):
            self.assertAlmostEqual((last - first + 1) * unit * media[tag]["mus"], thickness * sigma_s, delta=1e-9)
        for misfit in result["exports"][0]["misfit"]:
            self.assertAlmostEqual(misfit["reflectance"]["obtained_total"], misfit["reflectance"]["wanted_total"], delta=2e-3)

    def test_python_for_pyxopto_is_in_meters(self):
        _, files = export(self.folder, "donner_jensen_skin", "mcx")
        names = {}
        exec(files["donner_jensen_skin_pyxopto.py"].decode(), names)
        rows = names["layers"]["G"]
        self.assertEqual([row["d"] for row in rows], [0.0, 3e-5, 5e-5, float("inf"), 0.0])
        self.assertEqual(rows[1], {"d": 3e-5, "n": 1.4, "mua": 2100.0, "mus": 60000.0, "g": 0.0})


if __name__ == "__main__":
    unittest.main()
