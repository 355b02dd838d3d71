#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# `lamina materials`: what it prints, and how it ends.   command_test.sh LAMINA PYTHON SOURCE
set -euo pipefail
lamina=$1 python=$2 source=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fail() { echo "FAILED: $*" >&2; exit 1; }

# expect CODE TEXT ARGUMENT...: `lamina materials ARGUMENT...` ends with CODE and prints TEXT.
expect() {
  local code=$1 text=$2 got=0; shift 2
  "$lamina" materials "$@" >output 2>&1 || got=$?
  [ "$got" = "$code" ] || fail "materials $*: exit code $got instead of $code"
  grep -qF -- "$text" output || fail "materials $*: no '$text' in: $(cat output)"
}

expect 0 'painted_jade'
expect 0 'Donner & Jensen 2005, Table 3'
expect 0 'Example:' --help
expect 2 'did you mean "jade"?' jaed
expect 2 'there is no such file' ./jade
expect 1 'cannot be written' --json no/such/folder/list.json

# Names are the first column; what is printed for each is a file that reads back.
names=$("$lamina" materials | tail -n +2 | cut -d' ' -f1)
[ "$(echo "$names" | wc -l)" -ge 20 ] || fail "fewer than 20 materials"
for name in $names; do
  "$lamina" materials "$name" >"$name.json"
  "$lamina" materials "./$name.json" >again.json || fail "$name does not read back"
  "$lamina" materials ./again.json | cmp -s - again.json || fail "$name changes when read again"
done

"$lamina" materials --json - | "$python" -c '
import json, sys
result = json.load(sys.stdin)
assert result["command"] == "materials" and len(result["materials"]) >= 20
skin = result["materials"][0]
assert skin["name"] == "donner_jensen_skin" and skin["bands"] == ["R", "G", "B"]
assert skin["layers"] == ["epidermis", "upper dermis", "bloody dermis"]'
"$lamina" materials jade --json jade_result.json >/dev/null
"$python" -c '
import json
assert json.load(open("jade_result.json"))["material"]["layers"][0]["ior"] == 1.61'

# Other wavelengths: of a table, a law and a recipe; every command that takes --bands has the same ones.
cp -r "$source/tests/inputs/material/good/." .
expect 0 '"bands": [450, 575, 700]' spectra.json --bands 450:700:125
expect 0 '"bands": [540.5]' skin_type_1 --bands 540.5
expect 2 '"bands" has 710' spectra.json --bands 700,710
expect 2 'must be ascending wavelengths in [200, 3000] nm as in 400:700:10' spectra.json --bands 700,450
for bands in 450,450 '450,,500' 450:700 450:700:0 700:450:10 450:700:nan 100:700:10 450nm '450,5;' ' '; do
  expect 2 '--bands: must be ascending' spectra.json --bands "$bands"
done
expect 2 'cannot be had at other wavelengths' jade --bands 450,550,650
expect 2 '--bands: must be left out without a material' --bands 450
"$lamina" slab spectra.json --bands 500,600 --json slab.json >/dev/null
"$lamina" photons spectra.json --bands 500,600 --photons 20000 --threads 1 --json photons.json >/dev/null
"$lamina" profile spectra.json --bands 500,600 --method diffusion --radii 8 --json profile.json >/dev/null
"$lamina" bsdf spectra.json --bands 500,600 --method first_order --step 45 --json bsdf.json >/dev/null
"$python" -c '
import json
slab, *others = (json.load(open(name + ".json")) for name in ("slab", "photons", "profile", "bsdf"))
assert all(result["bands"] == [500, 600] for result in (slab, *others))
photons, profile = others[:2]  # the bands are not only called so: both methods find the same there
for band in range(2):
    assert abs(profile["total_reflectance"][band] / slab["diffuse_reflectance"][band] - 1) < .3'
