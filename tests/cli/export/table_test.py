# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""`lamina export --to table`.

usage: table_test.py LAMINA ROOT
"""
import json
import math
import struct
import unittest

from exporting import Folder, export, run


class Table(Folder):
    def test_is_read_by_numpy_and_has_what_slab_has(self):
        import numpy
        export(self.folder, "jade", "table")
        data = numpy.load(self.folder / "jade.npz", allow_pickle=False)
        r, profile = data["r_mm"], data["reflectance_profile"]
        self.assertEqual(profile.shape, (len(r), 3))
        slab = json.loads(run("slab", "jade", "--incidence", "diffuse", "--json", "-").stdout)
        rings = 2 * math.pi * (r[:, None] ** 2 * profile)
        flux = numpy.sum(0.5 * (rings[1:] + rings[:-1]) * numpy.log(r[1:] / r[:-1])[:, None], axis=0)
        for c in range(3):
            self.assertAlmostEqual(data["total_reflectance"][c], slab["diffuse_reflectance"][c], delta=2e-5)
            self.assertAlmostEqual(flux[c] / data["total_reflectance"][c], 1, delta=0.02)
        # The BRDF over the hemisphere of a normal beam.
        theta, phi = (numpy.radians(data[name]) for name in ("theta_o_deg", "phi_o_deg"))
        self.assertEqual(data["brdf"].shape, (len(data["theta_i_deg"]), len(theta), len(phi), 3))
        ring = numpy.mean(0.5 * (data["brdf"][0][:, 1:] + data["brdf"][0][:, :-1]), axis=1)
        ring *= 2 * math.pi * (numpy.sin(theta) * numpy.cos(theta))[:, None]
        ring, theta = numpy.vstack([ring, numpy.zeros((1, 3))]), numpy.append(theta, math.pi / 2)
        total = numpy.sum(0.5 * (ring[1:] + ring[:-1]) * numpy.diff(theta)[:, None], axis=0)
        normal = json.loads(run("slab", "jade", "--json", "-").stdout)["diffuse_reflectance"]
        for value, wanted in zip(total, normal):
            self.assertAlmostEqual(value / wanted, 1, delta=0.02)

    def test_pictures_and_csv_say_the_same(self):
        import numpy
        _, files = export(self.folder, "jade", "table")
        data = numpy.load(self.folder / "jade.npz")
        rows = [line for line in files["jade_profile.csv"].decode().splitlines() if not line.startswith("#")]
        self.assertEqual(rows[0], "r_mm,R_R,R_G,R_B,T_R,T_G,T_B")
        numbers = numpy.array([[float(x) for x in row.split(",")] for row in rows[1:]])
        self.assertTrue(numpy.array_equal(numbers[:, 0], data["r_mm"]))
        self.assertTrue(numpy.array_equal(numbers[:, 1:4], data["reflectance_profile"]))
        for name, width, height in (("jade_profile.exr", len(data["r_mm"]), 2), ("jade_brdf.exr", 18 * 13, 6)):
            picture = files[name]
            self.assertEqual(struct.unpack("<I", picture[:4])[0], 20000630)  # the magic number of OpenEXR
            at = picture.index(b"dataWindow\0box2i\0") + len(b"dataWindow\0box2i\0") + 4
            self.assertEqual(struct.unpack("<4i", picture[at:at + 16]), (0, 0, width - 1, height - 1))


if __name__ == "__main__":
    unittest.main()
