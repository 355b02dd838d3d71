# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Files of strangers that name where lamina should write: it writes inside of the folders that its user names.

usage: hostile_files_test.py LAMINA ROOT
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

LAMINA, ROOT = os.path.abspath(sys.argv.pop(1)), pathlib.Path(sys.argv.pop(1)).resolve()

MATERIAL = {"lamina": "material", "version": 1, "length_unit": "mm", "bands": "rgb",
            "layers": [{"sigma_a": 0.1, "sigma_s": 1, "g": 0.5, "ior": 1.3, "thickness": "infinite"}]}
SCENE = {"lamina": "scene", "version": 1, "camera": {"position": [0, 1, 14], "look_at": [0, 0, 0]}, "film": {"width": 8, "height": 8},
         "materials": {"a": {"diffuse": 0.5}}, "meshes": [{"shape": "sphere", "radius": 2, "tessellation": 2, "material": "a"}],
         "lights": [{"type": "environment", "radiance": 1}], "render": {"samples_per_pixel": 1}}


class HostileFiles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.work, self.victim = self.root / "work", self.root / "victim"
        self.work.mkdir()
        self.victim.mkdir()
        (self.victim / "settings.json").write_text("precious")

    def run_lamina(self, *args, **variables):
        environment = os.environ | {"LAMINA_CACHE": str(self.root / "cache")} | variables
        return subprocess.run([LAMINA, *map(str, args)], capture_output=True, text=True, timeout=120, cwd=self.work, env=environment)

    def assert_untouched(self):
        self.assertEqual((self.victim / "settings.json").read_text(), "precious")
        self.assertEqual(os.listdir(self.victim), ["settings.json"])
        self.assertLessEqual(set(os.listdir(self.root)), {"work", "victim", "cache"})

    def reproduce(self, id="x", command="slab jensen_skin1 --method diffusion", files=()):
        item = {"lamina": "reproduction", "version": 1, "paper": "donner_2008", "id": id, "title": "t", "shows": "s", "inputs": [],
                "files": [{"name": name, "content": content} for name, content in files],
                "runs": [{"name": "a", "command": command}], "features": [{"text": "t", "holds": "1 < 2"}]}
        (self.work / "item.json").write_text(json.dumps(item))
        return self.run_lamina("reproduce", "item.json", "-o", "out")

    def test_ids_of_items_name_folders_inside(self):
        for id in ("../victim", "..", ".", "", "/tmp/x", str(self.victim), "a/b", "a/../../victim", "a\u0000b", "a b", "-o", "\u00e9"):
            with self.subTest(id):
                result = self.reproduce(id, files=[("settings.json", {"evil": 1})])
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn("id must be of letters", result.stderr)
                self.assert_untouched()
        self.assertFalse((self.work / "out").exists())
        self.assertEqual(self.reproduce("my.item_2-b").returncode, 0)

    def test_commands_of_items_write_inside_of_their_folder(self):
        (self.work / "out" / "x").mkdir(parents=True)
        (self.work / "out" / "x" / "link.json").symlink_to(self.victim / "settings.json")
        (self.work / "out" / "x" / "new.json").symlink_to(self.victim / "new.json")
        (self.work / "out" / "x" / "way").symlink_to(self.victim)
        settings = self.victim / "settings.json"
        files = [("m.json", MATERIAL), ("s.json", SCENE)]
        for command in ("invert --color .5 --radius 1 -o ../../../victim/settings.json", f"invert --color .5 --radius 1 -o {settings}",
                        "invert --color .5 --radius 1 -o link.json", "invert --color .5 --radius 1 -o new.json",
                        "invert --color .5 --radius 1 -o way/new.json",
                        f"photons m.json --photons 100 --checkpoint {settings}",
                        f"photons m.json --photons 100 --counts --plot {self.victim}/plot.svg --tally r",
                        f"export m.json --to blender -o {self.victim}/", "export m.json --to mcml -o ../../../victim/new/folder/",
                        f"render s.json -o {self.victim}/picture", "render s.json -o ../../../victim/picture --keep",
                        f"render s.json --cache {settings} -o p", f"profile m.json --plot {self.victim}/p.svg"):
            with self.subTest(command):
                result = self.reproduce("x", command, files)
                if command.startswith("render") and "there is no subcommand" in result.stderr:
                    continue
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertIn("not_made", result.stderr)
                self.assert_untouched()
        self.assertEqual(self.reproduce("x", "invert --color .5 --radius 1 -o inside.json", files).returncode, 0)
        self.assertTrue((self.work / "out/x/inside.json").exists())

    def test_results_are_named_after_files_inside_of_the_folder(self):
        for name in ("...json", "..json"):
            for command, document in (("maps", {"lamina": "maps", "version": 1, "width": 4, "height": 4, "mm_per_pixel": 1, "skin": {}, "features": []}),
                                      ("render", SCENE)):
                with self.subTest(name, command=command):
                    (self.work / name).write_text(json.dumps(document))
                    result = self.run_lamina(command, name)
                    self.assertEqual(result.returncode, 2, result.stderr)
                    self.assertIn(f"which cannot be named after {name}", result.stderr)
                    self.assertEqual(os.listdir(self.work), [name])
                    self.assert_untouched()
                    (self.work / name).unlink()

    def test_errors_show_the_beginning_of_words_of_files(self):
        secret = "secret" + "x" * 500 + "\x1b[31m"
        files = {"word.csv": f"wavelength_nm,k\n400,1\n500,{secret},2\n", "columns.csv": f"{secret},{secret}\n1,2\n",
                 "number.obj": f"v 1 2 {secret}\n", "index.obj": f"v 1 2 3\nf 1 1 9{secret}\n", "corner.obj": f"v 1 2 3\nf 1{secret} 1 1\n",
                 "keyword.ply": f"ply\n{secret}\n", "format.ply": f"ply\nformat {secret} 1.0\n",
                 "twice.ply": f"ply\nformat ascii 1.0\nelement {secret} 1\nelement {secret} 1\n", "version.gltf": json.dumps({"asset": {"version": secret}}),
                 "run.mci": f"{secret}\n", "cube.hdr": f"ENVI\nsamples = {secret}\n", "type.hdr": f"ENVI\nsamples = 1\nlines = 1\nbands = 1\ndata type = 1\ninterleave = {secret}\n",
                 "look.mtlx": f"<{secret[:200]}/>"}
        for name, text in files.items():
            with self.subTest(name):
                (self.work / name).write_text(text)
                result = self.run_lamina("info", name)
                self.assertEqual(result.returncode, 2, result.stdout)
                self.assertNotIn("x" * 100, result.stderr)
                self.assertNotIn("\x1b", result.stderr)
                self.assertEqual(result.stderr.count("\n"), 1, result.stderr)

    def test_items_start_no_other_programs(self):
        for command in ("submit 'render s.json -o p' --shards 2", "reproduce other.json -o ../../../victim", "status p.job"):
            result = self.reproduce("x", command)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn("must be a command that computes", result.stderr)

    def test_links_in_folders_of_results_are_not_followed(self):
        (self.work / "out").mkdir()
        (self.work / "out" / "x").symlink_to(self.victim)
        result = self.reproduce("x", files=[("settings.json", {"evil": 1})])
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("must be inside of", result.stderr)
        self.assert_untouched()

    def test_a_command_held_to_a_folder_writes_there_alone(self):
        for place, code in (("inside.json", 0), ("../victim/settings.json", 1), (self.victim / "new.json", 1), ("/dev/stdout", 1)):
            result = self.run_lamina("invert", "--color", ".5", "--radius", "1", "-o", place, LAMINA_WRITE_FOLDER=str(self.work))
            self.assertEqual(result.returncode, code, result.stderr)
            self.assert_untouched()


if __name__ == "__main__":
    unittest.main()
