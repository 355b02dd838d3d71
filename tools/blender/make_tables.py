#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Writes materials.json and skins.json of blender/lamina_materials: what the add-on knows without lamina.

usage: make_tables.py LAMINA     (some minutes)
"""
import json
import pathlib
import subprocess
import sys
import tempfile

ADD_ON = pathlib.Path(__file__).resolve().parents[2] / "blender/lamina_materials"
MELANIN = [0.001, 0.004, 0.016, 0.06, 0.2]
HEMOGLOBIN = [0.001, 0.003, 0.008]
KEYS = ("material", "source", "ior", "roughness", "g", "albedo", "mean_free_path_mm", "reflectance", "transmittance")


def rounded(value):
    return [rounded(x) for x in value] if isinstance(value, list) else float("%.6g" % value) if isinstance(value, float) else value


def medium_of(material, folder):
    run = subprocess.run([sys.argv[1], "export", str(material), "--to", "blender", "-o", folder + "/"], capture_output=True, text=True)
    if run.returncode:
        print(material, run.stderr.strip())
        return None
    (file,) = pathlib.Path(folder).glob("*_blender.json")
    medium = json.loads(file.read_text())
    file.unlink()
    return {key: rounded(medium[key]) for key in KEYS if key in medium}


def main():
    listed = json.loads(subprocess.run([sys.argv[1], "materials", "--json", "-"], check=True, capture_output=True).stdout)
    with tempfile.TemporaryDirectory() as folder:
        materials = {one["name"]: medium_of(one["name"], folder) for one in listed["materials"]}
        media = []
        for melanin in MELANIN:
            media.append([])
            for hemoglobin in HEMOGLOBIN:
                file = pathlib.Path(folder) / "skin.json"
                file.write_text(json.dumps({"lamina": "material", "version": 1, "name": "skin", "length_unit": "mm", "skin": {
                    "melanin": melanin, "melanin_blend": 0.26, "hemoglobin_epidermis": 0.5 * hemoglobin,
                    "hemoglobin_dermis": hemoglobin, "carotene": 0.0004}}))
                medium = medium_of(file, folder)
                media[-1].append({key: medium[key] for key in ("albedo", "mean_free_path_mm", "reflectance")})
    lines = ",\n".join(f"{json.dumps(name)}: {json.dumps(medium)}" for name, medium in materials.items() if medium)
    (ADD_ON / "materials.json").write_text("{\n" + lines + "\n}\n")
    rows = ",\n".join(json.dumps(row) for row in media)
    (ADD_ON / "skins.json").write_text(f'{{"melanin": {MELANIN}, "hemoglobin": {HEMOGLOBIN}, "ior": {medium["ior"]}, '
                                       f'"g": {medium["g"]}, "media": [\n{rows}]}}\n')


if __name__ == "__main__":
    main()
