#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# `lamina edit`: edits in the order written, what they leave in the folder, and how they refuse.
#   edit_command_test.sh LAMINA EXAMPLES
set -euo pipefail
lamina=$1 examples=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
export LAMINA_CACHE=off

fail() { echo "FAILED: $*" >&2; exit 1; }

# expect CODE TEXT ARGUMENT...: `lamina ARGUMENT...` ends with CODE and prints TEXT.
expect() {
  local code=$1 text=$2 got=0; shift 2
  "$lamina" "$@" >output 2>&1 || got=$?
  [ "$got" = "$code" ] || fail "$*: exit code $got instead of $code: $(cat output)"
  grep -qF -- "$text" output || fail "$*: no '$text' in: $(cat output)"
}

expect 0 '' maps "$examples/skin/freckles.json" -o skin --set width=48 --set height=48 --set mm_per_pixel=0.2 --png

# With pictures and a result, and again from what came out.
expect 0 'mean color: L* ' edit skin -o tanned --tan 0.5 --flush 0.5 --mask skin/melanin.png --json tanned.json
for file in patch.json melanin.exr saturation_epidermis.exr preview.png before_after.png; do
  [ -s "tanned/$file" ] || fail "no $file"
done
for key in percentile_5 percentile_95 clamped warnings edits ita; do
  grep -q "\"$key\"" tanned.json || fail "no $key in the JSON"
done
expect 0 'again/patch.json' edit tanned/patch.json -o again --no-preview --lipstick 0.5 --mask skin/melanin.png
[ -s again/ink_lipstick.exr ] && [ ! -e again/preview.png ] || fail "no ink, or a preview"
expect 0 'ink_lipstick' edit again -o more --no-preview --scale ink_lipstick=0.5
expect 0 '' edit skin -o same --no-preview --tan 0
expect 0 '' edit skin -o itself --no-preview --homogenize skin
for map in same/*.exr; do cmp -s "$map" "itself/${map#same/}" || fail "$map changed"; done

# Order counts.
expect 0 '' edit skin -o first --no-preview --scale melanin=2 --add melanin=0.01
expect 0 '' edit skin -o second --no-preview --add melanin=0.01 --scale melanin=2
cmp -s first/melanin.exr second/melanin.exr && fail "the order does nothing"

expect 0 'people/0001' edit skin -o people --no-preview --augment 2 --seed 4
cmp -s people/0000/melanin.exr people/0001/melanin.exr && fail "two persons are one"
[ -s people/0001/patch.json ] || fail "no patch of a person"

# What is wrong is said in one line, and nothing is written.
refuse() {  # refuse TEXT ARGUMENT...
  local text=$1; shift
  expect 2 "$text" edit "$@"
  [ "$(wc -l <output)" = 1 ] || fail "more than one line: $(cat output)"
  [ ! -e bad ] || fail "$*: something is written"
}
printf '{ "lamina": "patch", "version": 1, "mm_per_pixel": 1, "width": 4, "height": 2, "skin": {} }' >numbers.json
expect 0 'melanin: 0.02 -> 0.03' edit numbers.json -o numbers --no-preview --tan 0.5
mkdir empty
refuse '--tan: must lie in [-0.95, 10], but is 11' skin -o bad --tan 11
refuse '--tan: must be a finite number, but is much' skin -o bad --tan much
refuse 'did you mean "--freckles"' skin -o bad --freckle 1
refuse '--scale: skin has no number "melanim"; did you mean "melanin"?' skin -o bad --scale melanim=2
refuse '--gamma: must be NAME=VALUE' skin -o bad --gamma 2
refuse '--lipstick: needs a mask' skin -o bad --lipstick 1
refuse '--mask: must follow the edit' skin -o bad --mask skin/melanin.png --tan 1
refuse '--mask: nowhere.png' skin -o bad --tan 1 --mask nowhere.png
refuse '--size: is for' skin -o bad --tan 1 --size 3
refuse '--strength: must lie in [0, 1]' skin -o bad --tan 1 --strength 2
refuse '--homogenize: empty: the folder must have' skin -o bad --homogenize empty
refuse 'empty: the folder must have a patch.json or a material.json' empty -o bad --tan 1
refuse '--output: must be another folder' skin -o ./skin/../skin --tan 1
refuse '--output: must be a folder' skin -o numbers.json --tan 1
mkdir other && printf '{}' >other/material.json
refuse 'has a material.json of other maps' skin -o other --tan 1
refuse 'there must be an edit' skin -o bad
refuse '--mm-per-pixel: is for maps over a mesh' skin -o bad --tan 1 --mm-per-pixel 1
printf '{ "lamina": "material", "version": 1, "length_unit": "mm", "skin": { "melanin": { "map": "skin/melanin.exr" } } }' >face.json
refuse '--even: the size of a texel in mm must be known' face.json -o bad --even 1
expect 0 'face/material.json' edit face.json -o face --no-preview --even 1 --mm-per-pixel 0.2
echo "as expected"
