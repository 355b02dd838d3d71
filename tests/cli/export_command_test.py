# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Files of `lamina export`, read by parsers that are not lamina's.

usage: export_command_test.py LAMINA ROOT
"""
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

LAMINA, ROOT = os.path.abspath(sys.argv.pop(1)), pathlib.Path(sys.argv.pop(1)).resolve()

# What is exported most: of one band, which is solved fastest.
CLEAR = {"lamina": "material", "version": 1, "name": "clear", "length_unit": "mm", "bands": "rgb",
         "ior_above": 1.0, "ior_below": 1.0,
         "layers": [{"sigma_a": 1.0, "sigma_s": 0, "g": 0, "ior": 1.4, "thickness": 1.0}]}


def run(*args, cwd=None):
    return subprocess.run([LAMINA, *map(str, args)], capture_output=True, text=True, timeout=300, cwd=cwd)


def export(folder, material, formats, *args):
    """The result, with the text of every file by its name."""
    result = run("export", material, "--to", formats, "-o", str(folder) + "/", "--json", "-", *args)
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout), {file.name: file.read_bytes() for file in pathlib.Path(folder).iterdir()}


def names():
    return [row["name"] for row in json.loads(run("export", "--to", "list", "--json", "-").stdout)["formats"]]


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)


class Gaussians(Folder):
    def test_sum_to_the_totals_and_say_how_wrong_they_are(self):
        result, files = export(self.folder, "jade", "gaussians", "--mm-per-unit", 10)
        data = json.loads(files["jade.json"])
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
            errors.append(json.loads(files["jade.json"])["reflectance"]["largest_flux_error"])
        self.assertGreater(errors[0], errors[1])
        self.assertGreater(errors[1], errors[2])


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


class Command(Folder):
    def test_lists_every_format_in_help(self):
        text = run("export", "--help").stdout
        for name in names():
            self.assertIn(f"\n  {name} ", text)

    def test_one_file_goes_to_the_path_given(self):
        file = self.folder / "own.mci"
        self.assertEqual(run("export", "jade", "--to", "mcml", "-o", file).returncode, 0)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["own.mci"])

    def test_wrong_use_is_one_line(self):
        clear = self.folder / "clear.json"
        clear.write_text(json.dumps(CLEAR))
        inside = sorted(p.name for p in self.folder.iterdir())
        for args, words in ((["jade", "--to", "gausians"], ["gausians", "gaussians"]),
                            (["--to", "mcml"], ["MATERIAL"]),
                            (["jade"], ["--to"]),
                            (["jade", "--to", "mcml", "--mm-per-unit", "0"], ["--mm-per-unit"]),
                            (["jade", "--to", "mcml", "--g", "1"], ["--g"]),
                            ([clear, "--to", "gaussians"], ["must scatter", "clear", "band R"]),
                            ([clear, "--to", "mcml", "-o", clear], ["clear.json"]),
                            (["jade", "--to", "mcml", "-o", clear / "x.mci"], ["clear.json"])):
            result = run("export", *args, cwd=self.folder)
            self.assertIn(result.returncode, (1, 2), args)
            self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)
            for word in words:
                self.assertIn(word, result.stderr)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), inside)
        self.assertEqual(json.loads(clear.read_text()), CLEAR)


if __name__ == "__main__":
    unittest.main()
