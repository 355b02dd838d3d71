# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""What users meet at the command line: help, exit codes, one-line errors, JSON.

usage: command_test.py LAMINA
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest

LAMINA = sys.argv.pop(1)
os.environ["LAMINA_CACHE"] = "off"


def run(*args):
    return subprocess.run([LAMINA, *args], capture_output=True, text=True, timeout=120)


def json_of(*args):
    result = run(*args, "--json", "-")
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


def subcommands():
    lines = run("--help").stdout.split("Subcommands:")[1].splitlines()
    return [line.split()[0] for line in lines if line.startswith("  ") and line.strip()]


class Help(unittest.TestCase):
    def test_every_subcommand_has_help_with_an_example(self):
        self.assertGreaterEqual(set(subcommands()), {"materials", "slab", "profile", "render"})
        for command in subcommands():
            result = run(command, "--help")
            self.assertEqual(result.returncode, 0, command)
            self.assertIn(f"lamina {command}", result.stdout, command)
            self.assertIn("--json", result.stdout, command)


class WrongUse(unittest.TestCase):
    def check(self, args, *words):
        result = run(*args)
        self.assertEqual(result.returncode, 2, (args, result.stderr))
        self.assertEqual(result.stdout, "", args)
        self.assertEqual(result.stderr.count("\n"), 1, (args, result.stderr))
        for word in words:
            self.assertIn(word, result.stderr, args)

    def test_is_one_line_and_exit_code_2(self):
        self.check([])
        self.check(["nonsense"], "nonsense")
        self.check(["slab"])
        self.check(["slab", "donner_jensen_skim"], "donner_jensen_skin")
        self.check(["slab", "donner_jensen_skin", "--incidence", "91"], "91")
        self.check(["slab", "donner_jensen_skin", "--method", "magic"], "magic")
        self.check(["profile", "no/such/file.json"], "no/such/file.json")
        self.check(["profile", "donner_jensen_skin", "--radii", "-3"], "-3")
        self.check(["render", "no_such_scene.json"], "no_such_scene.json")
        self.check(["materials", "jad"], "jade")

    def test_names_file_line_and_field(self):
        with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
            file.write('{ "lamina": "material", "version": 1,\n "length_unit": "mm", "bands": "rgb",\n'
                       ' "layers": [ {\n  "sigma_a": -1, "sigma_s": 2, "g": 0, "ior": 1.3,'
                       ' "thickness": "infinite" } ] }')
            file.flush()
            self.check(["slab", file.name], file.name + ":4", "layers[0].sigma_a", "-1")


class FailedWork(unittest.TestCase):
    def test_a_result_that_cannot_be_written_is_exit_code_1(self):
        result = run("slab", "jade", "--method", "diffusion", "--json", "/no/such/folder/x.json")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr.count("\n"), 1)


    @unittest.skipUnless(hasattr(os, "mkfifo"), "needs links")
    def test_a_link_stays_a_link(self):
        with tempfile.TemporaryDirectory() as folder:
            target, link = os.path.join(folder, "target.json"), os.path.join(folder, "link.json")
            open(target, "w").close()
            os.symlink(target, link)
            self.assertEqual(run("slab", "jade", "--method", "diffusion", "--json", link).returncode, 0)
            self.assertTrue(os.path.islink(link))
            self.assertGreater(os.path.getsize(target), 0)


class Json(unittest.TestCase):
    def test_says_what_made_it(self):
        result = json_of("slab", "donner_jensen_skin", "--method", "diffusion")
        self.assertEqual(result["command"], "slab")
        self.assertEqual(result["method"], "diffusion")
        self.assertEqual(result["bands"], ["R", "G", "B"])
        for key in ("specular_reflectance", "diffuse_reflectance", "transmittance"):
            self.assertEqual(len(result[key]), 3)
        self.assertEqual([len(layer) for layer in result["absorptance"]], [3, 3, 3])

    def test_light_is_neither_lost_nor_made(self):
        for method in ("diffusion",):
            result = json_of("slab", "parchment", "--method", method)
            for band in range(3):
                total = sum(result[key][band] for key in
                            ("specular_reflectance", "diffuse_reflectance", "transmittance"))
                total += sum(layer[band] for layer in result["absorptance"])
                self.assertAlmostEqual(total, 1.0, delta=1e-6)

    def test_profile_has_the_shape_that_it_states(self):
        result = json_of("profile", "donner_jensen_skin", "--method", "multipole", "--radii", "40")
        self.assertEqual(result["per"], "entered_flux")
        self.assertEqual(len(result["r_mm"]), 40)
        self.assertEqual({len(row) for row in result["reflectance_profile"]}, {3})
        for total, expected in zip(result["total_reflectance"], (0.40861, 0.39882, 0.33281)):
            self.assertAlmostEqual(total, expected, delta=1e-4)


if __name__ == "__main__":
    os.chdir(tempfile.mkdtemp())
    unittest.main()
