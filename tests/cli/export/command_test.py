# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""`lamina export`: its help, paths and messages.

usage: command_test.py LAMINA ROOT
"""
import json
import unittest

from exporting import CLEAR, Folder, names, run


class Command(Folder):
    def test_lists_every_format_in_help(self):
        text = run("export", "--help").stdout
        for name in names():
            self.assertIn(f"\n  {name} ", text)

    def test_one_file_goes_to_the_path_given(self):
        file = self.folder / "own.mci"
        self.assertEqual(run("export", "jade", "--to", "mcml", "-o", file).returncode, 0)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["own.mci"])

    def test_a_file_of_several_goes_to_the_path_given_and_the_others_beside_it(self):
        for args, expected in ((("blender", "a.py"), ["a.py", "a_blender.json"]),
                               (("blender", "e_blender.py"), ["e_blender.json", "e_blender.py"]),
                               (("arnold", "b.ass"), ["b.ass", "b_arnold.json"]),
                               (("mcx", "c.json"), ["c_B.mcx.json", "c_G.mcx.json", "c_R.mcx.json", "c_pyxopto.py"]),
                               (("blender", "d"), ["d"])):
            before = set(self.folder.iterdir())
            self.assertEqual(run("export", "jade", "--to", args[0], "-o", self.folder / args[1]).returncode, 0)
            self.assertEqual(sorted(p.name for p in set(self.folder.iterdir()) - before), expected)

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
