# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""`lamina export --to mixture`.

usage: mixture_test.py LAMINA ROOT
"""
import json
import os
import unittest

from exporting import Folder, diffuse_total, export, run


class Mixture(Folder):
    def test_of_three_media_is_nearer_than_one_and_has_the_color(self):
        _, files = export(self.folder, "donner_jensen_skin", "mixture")
        data = json.loads(files["donner_jensen_skin_mixture.json"])
        totals = [diffuse_total(self.folder, medium["sigma_a"], medium["sigma_s"], data["g"], data["ior"])[0]
                  for medium in data["media"]]
        for c, (misfit, one) in enumerate(zip(data["misfit"], data["misfit_of_one_medium"])):
            weights = [medium["weights"][c] for medium in data["media"]]
            self.assertAlmostEqual(sum(weights), 1, delta=1e-12)
            self.assertGreaterEqual(min(weights), 0)
            mixed = sum(weight * total[c] for weight, total in zip(weights, totals))
            self.assertAlmostEqual(mixed, misfit["reflectance"]["wanted_total"], delta=2e-4)
            self.assertLess(misfit["reflectance"]["profile_rms"], 0.5 * one["reflectance"]["profile_rms"])
            self.assertLess(misfit["reflectance"]["profile_rms"], 0.06)

    def test_is_of_something_thick(self):
        result = run("export", "paper", "--to", "mixture", "-o", self.folder)
        self.assertEqual((result.returncode, os.listdir(self.folder)), (2, []))
        self.assertIn("must be thick", result.stderr)


if __name__ == "__main__":
    unittest.main()
