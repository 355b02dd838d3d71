# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""lamina reproduce --resume: what has finished is not made again, unless something it came of has changed.

usage: reproduce_command_test.py LAMINA
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest

LAMINA = os.path.abspath(sys.argv.pop(1))
os.environ["LAMINA_CACHE"] = "off"


def run(*args):
    return subprocess.run([LAMINA, *args], capture_output=True, text=True, timeout=120)


class Reproduce(unittest.TestCase):
    """A call that is made again with --resume runs only what has not finished with the same program and files."""

    def test_goes_on_where_it_was_interrupted(self):
        item = {"lamina": "reproduction", "version": 1, "paper": "donner_2008", "id": "my.slab", "title": "A slab",
                "shows": "Its albedo.", "inputs": [{"what": "a slab"}],
                "runs": [{"name": "a", "command": "slab marble"}, {"name": "b", "command": "slab jensen_marble"}],
                "features": [{"text": "less than all", "holds": "a.diffuse_reflectance[0] < 1", "measure":
                              "a.diffuse_reflectance[0]"}]}
        with tempfile.TemporaryDirectory() as folder:
            def made():
                with open(f"{folder}/item.json", "w") as file:
                    json.dump(item, file)
                result = run("reproduce", f"{folder}/item.json", "-o", f"{folder}/out", "--resume", "--json", "-")
                self.assertEqual(result.returncode, 0, result.stderr)
                return json.loads(result.stdout)["summary"]["items"]["my.slab"]["features"][0]["measure"]

            right = made()
            finished = f"{folder}/out/my.slab/finished.json"
            with open(finished) as file:
                kept = json.load(file)
            self.assertEqual(len(kept["runs"]), 2)
            first = json.loads(kept["runs"][0]["result"])
            first["diffuse_reflectance"][0] = 0.125
            kept["runs"] = [{"result": json.dumps(first), "seconds": 0}]  # as if the second had not finished
            with open(finished, "w") as file:
                json.dump(kept, file)
            self.assertEqual(made(), 0.125)
            with open(finished) as file:
                self.assertEqual(len(json.load(file)["runs"]), 2)
            item["runs"][1]["command"] = "slab jensen_ketchup"  # another item: all is run again
            self.assertEqual(made(), right)

    def test_begins_anew_where_what_it_needs_has_changed(self):
        layer = {"sigma_a": 0.1, "sigma_s": 5, "g": 0.8, "ior": 1.4, "thickness": 1}
        item = {"lamina": "reproduction", "version": 1, "paper": "donner_2008", "id": "my.slab", "title": "A slab",
                "shows": "Its albedo.", "inputs": [{"what": "a slab"}], "needs": ["slabs"],
                "runs": [{"name": "a", "command": "slab {sources}/slabs/one.json"}],
                "features": [{"text": "less than all", "holds": "a.diffuse_reflectance[0] < 1", "measure":
                              "a.diffuse_reflectance[0]"}]}
        with tempfile.TemporaryDirectory() as folder:
            os.mkdir(f"{folder}/slabs")
            with open(f"{folder}/item.json", "w") as file:
                json.dump(item, file)

            def made(sigma_a):
                with open(f"{folder}/slabs/one.json", "w") as file:
                    json.dump({"lamina": "material", "version": 1, "length_unit": "mm", "bands": [600], "ior_below": 1,
                               "layers": [{**layer, "sigma_a": sigma_a}]}, file)
                result = run("reproduce", f"{folder}/item.json", "-o", f"{folder}/out", "--sources", folder, "--resume",
                             "--json", "-")
                self.assertEqual(result.returncode, 0, result.stderr)
                return json.loads(result.stdout)["summary"]["items"]["my.slab"]["features"][0]["measure"]

            pale, dark = made(0.1), made(0.2)
            self.assertLess(dark, 0.8 * pale)


if __name__ == "__main__":
    os.chdir(tempfile.mkdtemp())
    unittest.main()
