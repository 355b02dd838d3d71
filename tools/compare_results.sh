#!/bin/bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# compare_results.sh OLD_BINARY NEW_BINARY [MATERIAL...]
#
# Runs slab, profile, photons, bsdf, patch and merge of two versions of the command, over all
# built-in materials or those named, and prints a table material x command: "identical" where every
# number of --json is, else the largest difference relative to the number itself and, in brackets,
# relative to the largest number of the same list (the tail of a profile is a small difference of
# large numbers: it shows rounding first); "refused" where both versions refuse with the same words,
# else who refuses. Names that the old version had for methods and keys are known. Wall-clock times
# are the only numbers left out. Exits with 1 unless all is identical.
set -eu
[ $# -ge 2 ] || { sed -n '3,12s/^# \{0,1\}//p' "$0"; exit 2; }
old=$(realpath "$1") new=$(realpath "$2")
shift 2
here=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export LAMINA_CACHE=off

exec python3 - "$old" "$new" "$here/examples/skin/freckles.json" "$work" "$@" <<'PYTHON'
import json
import pathlib
import re
import subprocess
import sys

OLD, NEW, MAPS, WORK = sys.argv[1:5]
WORK = pathlib.Path(WORK)

# What a version calls a thing if it does not know the name of today: (command, name) -> old name.
METHODS = {("slab", "radiative_transfer"): "adding_doubling", ("bsdf", "radiative_transfer"): "adding_doubling",
           ("profile", "radiative_transfer"): "exact", ("profile", "diffusion"): "multipole"}
KEYS = {"adding_doubling": "radiative_transfer", "terms": "interlayer_bounces", "last_term": "last_bounce"}
METHOD_VALUES = {"adding_doubling": "radiative_transfer", "exact": "radiative_transfer", "multipole": "diffusion"}
PATCH = {"radiative_transfer_profile": "exact_profile", "radiative_transfer": "exact",
         "interlayer_bounces": "terms", "energy_threshold": "kept", "local_closure": "closure"}
IGNORED = re.compile(r"seconds|per_second$|^lamina$|^threads$")

MATERIAL_COMMANDS = {
    "slab": "slab {m} --method radiative_transfer",
    "slab diffuse": "slab {m} --method radiative_transfer --incidence diffuse",
    "slab diffusion": "slab {m} --method diffusion --incidence 40",
    "slab photons": "slab {m} --method monte_carlo --photons 4e3 --seed 1",
    "profile": "profile {m} --method radiative_transfer --accuracy 0.1 --radii 12",
    "profile below": "profile {m} --method radiative_transfer --accuracy 0.1 --radii 6 --incidence diffuse --from below",
    "profile oblique": "profile {m} --method radiative_transfer --radii 6 --incidence 40",
    "profile frequency": "profile {m} --method radiative_transfer --radii 6 --domain frequency",
    "profile diffusion": "profile {m} --method diffusion --radii 40",
    "profile dipole": "profile {m} --method dipole --radii 40",
    "profile photons": "profile {m} --method monte_carlo --photons 4e3 --seed 1 --radii 10",
    "photons": "photons {m} --photons 4e3 --seed 1 --tally r,rz,angle",
    "bsdf": "bsdf {m} --method radiative_transfer --step 30 --accuracy 1e-2 --theta-i 40",
    "bsdf layered": "bsdf {m} --method layered_bsdf --step 30 --theta-i 40",
    "bsdf first": "bsdf {m} --method first_order --step 30 --theta-i 40",
    "bsdf photons": "bsdf {m} --method monte_carlo --photons 4e3 --seed 1 --cosines 3 --azimuths 4 --theta-i 40",
}
OTHER_COMMANDS = {
    "bsdf rough analytic": "bsdf --model rough_transmission --method analytic",
    "bsdf rough photons": "bsdf --model rough_transmission --method monte_carlo --photons 1e4",
    "bsdf rough rays": "bsdf --model rough_transmission --method height_field --realizations 2 --photons 1e4",
    "slab compare": "slab donner_jensen_skin --compare=4000 --seed 2",
    "profile compare": "profile donner_jensen_skin --compare --accuracy 0.1 --radii 12",
    "profile gaussians": "profile donner_jensen_skin --gaussians 12",
    "bsdf compare": "bsdf leaf --compare --step 30",
}


def run(binary, arguments):
    return subprocess.run([binary] + arguments, capture_output=True, text=True, cwd=WORK)


def is_old(binary):
    return "radiative_transfer" not in run(binary, ["slab", "--help"]).stdout


AGE = {OLD: is_old(OLD), NEW: is_old(NEW)}


# What messages said before, and say now.
SAID = [("the exact profile of", "the profile by radiative transfer of"), ("an exact profile", "a profile by radiative transfer"),
        ("the exact profile", "the profile"), ("exact profile:", "radiative transfer:")] + list(METHOD_VALUES.items())


def said(text):
    """A message in the names of today."""
    for before, now in SAID:
        text = text.replace(before, now)
    return text


def result_of(binary, arguments):
    """(numbers by path) or what it says where it refuses."""
    arguments = list(arguments)
    if AGE[binary] and "--method" in arguments:
        at = arguments.index("--method") + 1
        arguments[at] = METHODS.get((arguments[0], arguments[at]), arguments[at])
    done = run(binary, arguments + ["--json", "-"])
    if done.returncode:
        return f"{done.returncode}: {said(done.stderr.strip())}"
    values = {}

    def walk(value, path):
        if isinstance(value, dict):
            for key, inner in value.items():
                if not IGNORED.search(key):
                    walk(inner, path + (KEYS.get(key, key),))
        elif isinstance(value, list):
            values[path] = len(value)
            for i, inner in enumerate(value):
                walk(inner, path + (i,))
        else:
            values[path] = METHOD_VALUES.get(value, value) if path[-1] == "method" else value

    walk(json.loads(done.stdout), ())
    return values


REFUSED = {}


def compare(name, before, after):
    if isinstance(before, str) and isinstance(after, str):
        REFUSED.setdefault(after, []).append(name)
        return "refused" if before == after else "refused in other words"
    if isinstance(before, str):
        return "old refuses: " + before
    if isinstance(after, str):
        return "new refuses: " + after
    if before == after:
        return "identical"
    if before.keys() != after.keys():
        return "other keys: " + ", ".join(sorted({".".join(map(str, p)) for p in before.keys() ^ after.keys()})[:3])
    def list_of(path):
        return tuple(part for part in path if isinstance(part, str))

    scale = {}
    for path, a in before.items():
        if isinstance(a, (int, float)) and not isinstance(a, bool):
            scale[list_of(path)] = max(scale.get(list_of(path), 0.0), abs(a))
    largest = of_list = 0.0
    for path, a in before.items():
        b = after[path]
        if a == b:
            continue
        if isinstance(a, (str, bool, type(None))) or isinstance(b, (str, bool, type(None))):
            return f"other {'.'.join(map(str, path))}: {a}, {b}"
        largest = max(largest, abs(a - b) / max(abs(a), abs(b)))
        of_list = max(of_list, abs(a - b) / max(scale[list_of(path)], abs(b)))
    return f"{largest:.1e} ({of_list:.0e})"


def patch_result(binary, totals, transport):
    folder = WORK / f"patch_{binary == NEW}"
    if not folder.exists():
        done = run(binary, ["maps", MAPS, "-o", str(folder)])
        if done.returncode:
            return done.stderr.strip()
    names = PATCH if AGE[binary] else {}
    patch = json.loads((folder / "patch.json").read_text())
    patch.update(totals=names.get(totals, totals), width=64, height=64, bands=[470, 645],
                 transport={names.get(key, key): value for key, value in transport.items()})
    (folder / "compared.json").write_text(json.dumps(patch))
    return result_of(binary, ["patch", str(folder / "compared.json"), "-o", str(WORK / "patch.exr")])


def merge_result(binary):
    files = []
    for shard in ("0/2", "1/2"):
        files.append(str(WORK / f"shard_{binary == NEW}_{shard[0]}.json"))
        done = run(binary, ["photons", "leaf", "--photons", "4e3", "--shard", shard, "--json", files[-1]])
        if done.returncode:
            return done.stderr.strip()
    return result_of(binary, ["merge"] + files)


def row(title, cells):
    print("| " + title + " | " + " | ".join(cells) + " |", flush=True)
    return all(cell in ("identical", "refused") for cell in cells)


materials = sys.argv[5:]
if not materials:
    listed = [[line.split()[0] for line in run(b, ["materials"]).stdout.splitlines()[1:]] for b in (OLD, NEW)]
    if listed[0] != listed[1]:
        sys.exit(f"the versions have other materials: {sorted(set(listed[0]) ^ set(listed[1]))}")
    materials = listed[1]
same = True
row("material", MATERIAL_COMMANDS)
print("|---" * (len(MATERIAL_COMMANDS) + 1) + "|")
for material in materials:
    cells = []
    for name, line in MATERIAL_COMMANDS.items():
        arguments = line.format(m=material).split()
        cells.append(compare(f"{material}, {name}", result_of(OLD, arguments), result_of(NEW, arguments)))
    same &= row(material, cells)
print("\n| command | result |\n|---|---|")
for name, line in OTHER_COMMANDS.items():
    same &= row(name, [compare(name, result_of(OLD, line.split()), result_of(NEW, line.split()))])
for totals in ("diffusion", "radiative_transfer", "radiative_transfer_profile"):
    for transport in ({"interlayer_bounces": 2}, {"energy_threshold": 0.99, "local_closure": False, "profile": "both"}):
        name = f"patch {totals} {' '.join(transport)}"
        same &= row(name, [compare(name, patch_result(OLD, totals, transport), patch_result(NEW, totals, transport))])
same &= row("photons, merge", [compare("merge", merge_result(OLD), merge_result(NEW))])
if REFUSED:
    print("\nRefused by both:")
    for message, names in REFUSED.items():
        print(f"- {message}  ({len(names)}: {', '.join(names[:3])}{', ...' if len(names) > 3 else ''})")
sys.exit(0 if same else 1)
PYTHON
