# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""`lamina export --to gaussians`.

usage: gaussians_test.py LAMINA ROOT
"""
import json
import math
import unittest

from exporting import Folder, export


class Gaussians(Folder):
    def test_sum_to_the_totals_and_say_how_wrong_they_are(self):
        result, files = export(self.folder, "jade", "gaussians", "--mm-per-unit", 10)
        data = json.loads(files["jade_gaussians.json"])
        sums = data["reflectance"]
        for c, misfit in enumerate(data["misfit"]):
            total = sum(row[c] for row in sums["weights"])
            self.assertAlmostEqual(total, misfit["reflectance"]["wanted_total"], delta=1e-9)
            kernel = sum(row[c] for row in sums["separable_kernel"]["weights"])
            self.assertAlmostEqual(kernel, total, delta=1e-9)
            radius = sum(2 * v * row[c] for v, row in zip(sums["variance_mm2"], sums["weights"])) / total
            self.assertAlmostEqual(radius / misfit["reflectance"]["obtained_mean_square_radius_mm2"], 1, delta=2e-3)
        for mm, unit, variance in zip(sums["width_mm"], sums["width_scene_units"], sums["variance_mm2"]):
            self.assertAlmostEqual(mm / unit, 10)
            self.assertAlmostEqual(mm, math.sqrt(variance))
        self.assertLess(sums["largest_flux_error"], 0.03)
        self.assertEqual(result["exports"][0]["misfit"], data["misfit"])

    def test_more_of_them_are_nearer(self):
        errors = []
        for count in (2, 5, 9):
            _, files = export(self.folder, "jade", "gaussians", "--gaussians", count)
            errors.append(json.loads(files["jade_gaussians.json"])["reflectance"]["largest_flux_error"])
        self.assertGreater(errors[0], errors[1])
        self.assertGreater(errors[1], errors[2])


if __name__ == "__main__":
    unittest.main()
