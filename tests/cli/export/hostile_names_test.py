# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Every format of a material whose name, source and layers are called what would end a comment, a string or a line: the files say
what those of a material with plain names say, and its names only where names belong.

usage: hostile_names_test.py LAMINA ROOT
"""
import ast
import json
import pathlib
import unittest
import xml.etree.ElementTree

from exporting import Folder, export
from format_readers import arnold_node, mcml_runs, openpbr_inputs, pbrt_statements, read_exported, read_glb, rib_bxdf

PLAIN = "plain"
HOSTILE = {
    # Python reads an encoding from a comment in the first two lines, and in this one escapes end the comment.
    "encoding": ("coding: raw_unicode_escape", "\\u000aimport os\\u000araise SystemExit(7)\\u000a#"),
    "another encoding": ("-*- coding=utf-7 -*-", "+AAo-raise SystemExit(7)+AAo-#"),
    "comments": ("a--b--->", "--><bsdf type=\"null\"/><!--", ),
    "quotes": ("'''\"\"\"\"'; raise SystemExit(7) #", "\\\"\\' ]]> </scene> $(touch x) `touch x` %s {0}"),
    "ends of lines": ("a\u2028raise SystemExit(7)\u2029b\u0085c\u000bd\u000ce\u001cf", "\r\n\nraise SystemExit(7)\n\t\u202e\ufeff\uffff"),
    "options and folders": ("-rf --no", "../../../etc/passwd"),
}


def material(name, source):
    return {"lamina": "material", "version": 1, "name": name, "source": source, "length_unit": "mm", "bands": "rgb",
            "layers": [{"name": name, "sigma_a": [0.1, 0.2, 0.3], "sigma_s": [1, 2, 3], "g": 0.5, "ior": 1.3, "thickness": "infinite"}]}


def tree_of(element):
    return element.tag, sorted(element.attrib.items()), [tree_of(child) for child in element]


def meaning(name, content):
    """What a program that reads the file takes from it."""
    ending = name[name.index("."):]
    if ending == ".py":
        return ast.dump(ast.parse(content))  # of bytes: the encoding that they name is obeyed
    if ending in (".xml", ".mtlx"):
        return tree_of(xml.etree.ElementTree.fromstring(content))
    if ending in (".json", ".mcx.json"):
        return json.loads(content)
    if ending == ".glb":
        return read_glb(content)
    for of, read in ((".ass", arnold_node), (".rib", rib_bxdf)):
        if ending == of:
            return read(content.decode())
    for of, read in ((".pbrt", pbrt_statements), (".mci", mcml_runs)):
        if ending == of:
            return read(content)
    if ending == ".csv":
        return [line for line in content.decode().split("\n") if line[:1] != "#"]
    return None if ending == ".exr" else content


class HostileNames(Folder):
    def exported(self, folder, name, source):
        """The files by what follows the stem, and the stem."""
        folder = self.folder / folder
        folder.mkdir()
        file = self.folder / "material.json"
        file.write_text(json.dumps(material(name, source)))
        result, files = export(folder / "out", file, "all")
        (mitsuba,) = [one["files"] for one in result["exports"] if one["format"] == "mitsuba3"]
        stem = pathlib.Path(mitsuba[0]).stem
        for one in files:
            self.assertTrue(one.startswith(stem), one)
        self.assertRegex(stem, r"\A[A-Za-z0-9_]+(-[A-Za-z0-9_]+)*-?\Z")
        return {one[len(stem):]: content for one, content in files.items()}, stem

    def renamed(self, value, pairs):
        """What was read, with plain names in place of hostile ones."""
        if isinstance(value, (list, tuple)):
            return [self.renamed(one, pairs) for one in value]
        if isinstance(value, dict):
            return {self.renamed(key, pairs): self.renamed(one, pairs) for key, one in value.items()}
        if isinstance(value, str):
            for hostile, plain in pairs:
                value = value.replace(hostile, plain)
        return value

    def test_files_mean_what_those_with_plain_names_do(self):
        plain, plain_stem = self.exported("plain", "plain_name", "a plain source")
        self.assertGreater(len(plain), 15)
        expected = {ending: self.renamed(meaning(plain_stem + ending, content), []) for ending, content in plain.items()}
        for what, (name, source) in HOSTILE.items():
            with self.subTest(what):
                files, stem = self.exported(what.replace(" ", "_"), name, source)
                self.assertEqual(set(files), set(plain))
                pairs = [(repr(source), repr("a plain source")), (repr(name), repr("plain_name")), (source, "a plain source"),
                         (name, "plain_name"), (stem.replace("-", "_"), plain_stem), (stem, plain_stem)]
                for ending, content in files.items():
                    with self.subTest(ending):
                        read_exported(stem + ending, content)
                        self.assertEqual(self.renamed(meaning(stem + ending, content), pairs), expected[ending])
                        if ending == "_blender.py":
                            self.assertTrue(content.startswith(b"# -*- coding: utf-8 -*-\n"))


if __name__ == "__main__":
    unittest.main()
