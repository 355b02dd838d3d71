#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Wrong inputs flip verdicts: items of `reproduce` with one thing changed.

    wrong_inputs_test.py LAMINA SOURCES [NAME...]

Each case keeps of an item those runs and features that it is about, so that most take a second or two. As
it stands all of these hold; with the wrong input the verdict is "differs", and the features that are named
do not hold. Without names the slow ones are left out, and those that need the demo's head where it is not there.
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import time

MARBLE = '"surface": { "roughness": 0.1 }', '"surface": { "roughness": 1.0 }'
SPONGY = '{ "sigma_a": [3.0, 1.8, 6.0], "sigma_s": 60,'

SLOW = {"a Lambertian face in place of the layers", "leaves that no light goes through",
        "a high sun that stands low", "marble whose roughnesses are turned", "a leaf without a cuticle"}

# name: item, runs (by how their names begin), features (by words in them), what is replaced by what,
# and words of the features that then must fail
CASES = {
    "a phase function of another g": (
        "hery_2003/single_scattering", ["closed", "plate"], ["a plate is brighter"],
        [('"g": 0.6', '"g": 0.5')], ["forward scattering, refracted ways"]),
    "another albedo": (
        "hery_2003/single_scattering", ["closed", "plate"], ["a plate is brighter"],
        [('"sigma_a": [0.8, 0.4, 0.2], "sigma_s": [3.2, 3.6, 3.8], "g": 0,',
          '"sigma_a": [1.6, 0.8, 0.4], "sigma_s": [3.2, 3.6, 3.8], "g": 0,')],
        ["even scattering, straight ways"]),
    "no light scattered once": (
        "hery_2003/single_scattering", ["closed", "plate"], ["a plate is brighter"],
        [('--single-scattering {way} --samples', '--single-scattering none --samples')],
        ["even scattering, straight ways"]),
    "maps of a leaf in each other's place": (
        "hanrahan_krueger_1993/plate_5", [""], [""],
        [("scenes/leaf/color.png", "scenes/leaf/x.png"),
         ("scenes/leaf/thickness.png", "scenes/leaf/color.png"),
         ("scenes/leaf/x.png", "scenes/leaf/thickness.png")], ["the blade as well"]),
    "a thickness that is decoded as a color": (
        "hanrahan_krueger_1993/plate_5", [""], [""],
        [('"encoding": "linear"', '"encoding": "srgb"')], ["the blade as well"]),
    "a leaf without an outline": (
        "hanrahan_krueger_1993/plate_5", [""], [""],
        [(', "opacity": { "map": "{sources}/scenes/leaf/outline.png" }', "")], ["corners"]),
    "paint below jade": (
        "donner_jensen_2005/figure_5", ["total", "paint", "even"],
        ["painted jade", "by the paper", "is whiter"],
        [('"slab {m}" }', '"slab turned_{m}.json" }'),
         ('"files": [', """"files": [
    { "for": { "m": ["jade", "painted_jade"] }, "name": "turned_{m}.json", "content": { "lamina": "material",
      "version": 1, "length_unit": "mm", "bands": "rgb", "layers": [
        { "sigma_a": [0.10, 0.015, 0.06], "sigma_s": 4.0, "g": 0.8, "ior": 1.61, "thickness": 40 },
        { "sigma_a": [0.02, 0.02, 0.03], "sigma_s": 100, "g": 0.8, "ior": 1.5, "thickness": "infinite" } ] } },""")],
        ["by the paper", "is whiter"]),
    "paint that scatters a third": (
        "donner_jensen_2005/figure_5", ["total", "paint", "even"], ["by the paper"],
        [('"sigma_s": 100,', '"sigma_s": 33,')], ["by the paper"]),
    "a leaf of equal layers": (
        "donner_jensen_2005/figure_6", ["even_upper", "even_lower"], ["twice"],
        [(SPONGY, '{ "sigma_a": [8.0, 5.0, 20.0], "sigma_s": 20,')], ["twice"]),
    "another leaf from below": (
        "donner_jensen_2005/figure_6", ["even_upper", "even_lower"], ["transmit the same"],
        [('"sigma_s": 20, "g": 0.8, "ior": 1.33, "thickness": 0.12 } ] }',
          '"sigma_s": 20, "g": 0.8, "ior": 1.33, "thickness": 0.1 } ] }')], ["transmit the same"]),
    "marble whose roughnesses are turned": (
        "donner_jensen_2005/figure_7", ["picture"], ["at its highlight", "is veiled"],
        [(MARBLE[0], "X"), (MARBLE[1], MARBLE[0]), ("X", MARBLE[1])], ["at its highlight", "is veiled"]),
    "skin with another dermis": (
        "donner_jensen_2005/figure_8", ["total"], ["together", "bloody dermis alone is"],
        [('"sigma_a": [0.085, 1.0, 25.0]', '"sigma_a": [1.0, 0.085, 25.0]')], ["bloody dermis"]),
    "skin without an upper dermis": (
        "donner_jensen_2005/figure_8", ["total"], ["all three layers reflect"],
        [('"g": 0.25, "ior": 1.34, "thickness": 0.05 },\n        {',
          '"g": 0.25, "ior": 1.34, "thickness": 0.005 },\n        {')],
        ["all three layers reflect"]),
    "a dipole of another skin": (
        "donner_jensen_2005/figure_8", ["spread", "total"], ["the dipole"],
        [("profile jensen_skin1", "profile jensen_skin2")], ["closed form"]),
    "a leaf without a cuticle": (
        "hanrahan_krueger_1993/plate_6", [""], [""],
        [("{160|720} --height {160|720} --samples {16|256}",
          "{160|720} --height {160|720} --samples {16|256} --set materials.leaf.coat=null")],
        ["largely gloss"]),
    "leaves that no light goes through": (
        "hanrahan_krueger_1993/plate_6", [""], [""],
        [("leaves.json' -o", "leaves.json' --set materials.leaf.thin=null --set "
          "materials.leaf.diffuse=[0.1,0.2,0.05] --set materials.leaf.color=null "
          "--set materials.leaf.thickness=null --set materials.leaf.coat=null -o")],
        ["lit from behind, is brighter"]),
    "a high sun that stands low": (
        "hanrahan_krueger_1993/plate_6", [""], [""],
        [("[0.35,0.55,-0.8]", "[-0.4,0.05,-0.9]")], ["shadows"]),
    "a Lambertian face in place of the layers": (
        "hanrahan_krueger_1993/plate_2", [""], [""],
        [("plate2_{k}_{a}.json'", "plate2_lambert_{a}.json'")], ["0°: and darker", "on the slopes"]),
}


def load(path):
    lines = path.read_text(encoding="utf-8").splitlines()
    return "\n".join(line for line in lines if not line.startswith("//"))


def part_of(text, runs, features):
    """The item with those runs and features only, and nothing to draw."""
    item = json.loads(text)
    item["runs"] = [r for r in item["runs"] if any(r["name"].startswith(n) for n in runs)]
    for kind in ("features", "numbers"):
        item[kind] = [f for f in item.get(kind, []) if any(words in f["text"] for words in features)]
        if not item[kind]:
            del item[kind]
    for key in ("figure", "table", "pictures", "picture_columns", "differs_because"):
        item.pop(key, None)
    if not any("render" in run["command"] for run in item["runs"]):
        item.pop("needs", None)
    return item


def made(lamina, sources, item):
    """The verdict, and whether each feature and number holds."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        text = json.dumps(item, ensure_ascii=False).replace("{sources}", str(sources))
        (folder / "item.json").write_text(text, encoding="utf-8")
        run = subprocess.run([lamina, "reproduce", folder / "item.json", "-o", folder / "out"],
                             capture_output=True, text=True)
        if run.returncode != 0:
            sys.exit(run.stderr)
        summary = json.loads((folder / "out/summary.json").read_text(encoding="utf-8"))
    result = summary["items"][item["id"]]
    return result["verdict"], {f["text"]: f["holds"] for kind in ("features", "numbers")
                               for f in result.get(kind, [])}


def main(lamina, sources, *names):
    sources = pathlib.Path(sources).resolve()
    passed = failed = skipped = 0
    right = {}  # what is made of an item as it stands, by the runs and features that are kept
    for name, (path, runs, features, changes, must_fail) in CASES.items():
        if name not in names if names else name in SLOW:
            continue
        text = load(sources / "reproduce" / (path + ".json"))
        item = part_of(text, runs, features)
        if any(not (sources / file).exists() for file in item.get("needs", [])):
            print(f"skipped: {name}: {item['needs']} is not there")
            skipped += 1
            continue
        for before, after in changes:
            if before not in text:
                sys.exit(f"{name}: {path} has no {before}")
            text = text.replace(before, after)
        key = path, *runs, "", *features
        if key not in right:
            right[key] = made(lamina, sources, item)
        started = time.time()
        verdict, holds = right[key]
        wrong_verdict, wrong_holds = made(lamina, sources, part_of(text, runs, features))
        missed = [words for words in must_fail
                  if all(held for text, held in wrong_holds.items() if words in text)]
        is_good = (bool(holds) and all(holds.values()) and verdict.startswith("agrees") and
                   wrong_verdict == "differs" and not missed)
        print(f"{'ok' if is_good else 'FAILED'}: {name}: {verdict}, then {wrong_verdict} ({time.time() - started:.1f} s)"
              f"{''.join(f'; still holds: {words}' for words in missed)}")
        if not is_good:
            print("  as it stands:", [text for text, held in holds.items() if not held])
        passed, failed = passed + is_good, failed + (not is_good)
    print(f"{passed} passed, {failed} failed, {skipped} skipped")
    return 1 if failed or not passed else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
