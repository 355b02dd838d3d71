# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""`lamina export --to mcml`.

usage: mcml_test.py LAMINA ROOT
"""
import json
import math
import unittest

from exporting import Folder, export, run


class Mcml(Folder):
    def test_is_run_by_photons_to_the_totals_of_slab(self):
        export(self.folder, "donner_jensen_skin", "mcml")
        photons = run("photons", self.folder / "donner_jensen_skin.mci", "--photons", 20000, "--output", self.folder,
                      "--json", "-")
        self.assertEqual(photons.returncode, 0, photons.stderr)
        slab = json.loads(run("slab", "donner_jensen_skin", "--json", "-").stdout)
        for band, name in enumerate("RGB"):
            lines = (self.folder / f"donner_jensen_skin_{name}.mco").read_text().splitlines()
            reflected = float(next(line for line in lines if "Diffuse reflectance" in line).split()[0])
            self.assertAlmostEqual(reflected, slab["diffuse_reflectance"][band], delta=4 * 0.5 / math.sqrt(20000))

    def test_says_what_it_cannot(self):
        result, _ = export(self.folder, "dust", "mcml", "--bands", 550)
        notes = " ".join(result["exports"][0]["notes"])
        self.assertIn("ground", notes)
        misfit = result["exports"][0]["misfit"][0]["reflectance"]
        self.assertGreater(misfit["wanted_total"], misfit["obtained_total"] + 0.005)  # what the ground returns


if __name__ == "__main__":
    unittest.main()
