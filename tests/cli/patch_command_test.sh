#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# `lamina maps` and `lamina patch`: from a recipe to a picture, and how they refuse.
#   patch_command_test.sh LAMINA EXAMPLES
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

expect 0 'hemoglobin_dermis.exr' maps "$examples/skin/freckles.json" -o freckles --json maps.json
[ -s freckles/melanin.exr ] && [ -s freckles/patch.json ] || fail "no maps"
expect 0 '' maps "$examples/skin/freckles.json" -o again
cmp -s freckles/melanin.exr again/melanin.exr || fail "the same recipe gave another map"
expect 0 '' maps "$examples/skin/freckles.json" -o other --seed 9 --png
[ -s other/melanin.png ] || fail "no picture of the map"
cmp -s freckles/melanin.exr other/melanin.exr && fail "the seed does nothing"

# Spread over more skin, and over a mesh with ink on it.
maps() {  # maps NAME KEYS FEATURES: a maps file
  echo "{ \"lamina\": \"maps\", \"version\": 1, \"width\": 64, \"height\": 64, $2, \"skin\": {}, \"features\": [ $3 ] }" >"$1"
}
spread='{ "synthesis": { "patch": "freckles/patch.json" } }'
maps spread.json '"mm_per_pixel": 0.5' "$spread"
expect 0 'melanin_blend.exr' maps spread.json
printf 'v 0 0 0\nv 5 0 0\nv 5 5 0\nv 0 5 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n' >square.obj
printf 'v 0 0 0\nv 5 0 0\nv 5 5 0\nf 1 2 3\n' >bare.obj
on_square='"surface": { "file": "square.obj", "mm_per_unit": 10 }'
maps mesh.json "$on_square" "$spread, { \"tattoo\": { \"image\": \"$examples/skin/ink.png\", \"at\": [2, 2, 0], \"width\": 20 } }"
expect 0 'junction_absorption.exr' maps mesh.json
expect 0 'material.json' maps mesh.json

# A small patch of these maps: resampled, said, the same for any number of threads.
sed -e 's/"width": 512/"width": 48/; s/"height": 512/"height": 48/; s/"mm_per_pixel": 0.05/"mm_per_pixel": 0.5/' \
    -e 's/^{/{ "bands": [470, 620], "totals": "diffusion",/' freckles/patch.json >freckles/small.json
expect 0 'resampled to 48 x 48' patch freckles/small.json -o one --threads 1 --json one.json
expect 0 'ns per texel' patch freckles/small.json -o two --threads 2
cmp -s one.exr two.exr || fail "the picture depends on the threads"
[ -s one.png ] || fail "no PNG"
for key in mean_reflectance fit_error interlayer_bounces last_bounce mean_rgb warnings; do
  grep -q "\"$key\"" one.json || fail "no $key in the JSON"
done

# What is wrong is said in one line, and nothing is written.
expect 2 'no_such.json' patch no_such.json
echo '{ "lamina": "patch", "version": 1, "mm_per_pixel": 0.1, "width": 4, "height": 4, "skin": {"melanin": 3} }' >bad.json
expect 2 'bad.json:1: skin.melanin' patch bad.json
[ "$(wc -l <output)" = 1 ] && [ ! -e bad.exr ] || fail "more than one line"
for bad in '"synthesis": { "patch": "no_such.json" }|features[0].synthesis.patch' \
    '"synthesis": { "patch": "freckles/patch.json", "tile": -1 }|features[0].synthesis.tile must' \
    '"tattoo": { "image": "no.png", "at": [1, 1] }|features[0].tattoo.image' \
    '"tattoo": { "image": "one.png", "at": [1, 1], "width": -3 }|features[0].tattoo.width must'; do
  maps bad.json '"mm_per_pixel": 0.5' "{ ${bad%|*} }"
  expect 2 "bad.json:1: ${bad#*|}" maps bad.json
  [ "$(wc -l <output)" = 1 ] || fail "more than one line: $(cat output)"
done
maps bad.json '"surface": { "file": "bare.obj", "mm_per_unit": 10 }' "$spread"
expect 2 'must have texture coordinates' maps bad.json
maps bad.json "$on_square" '{ "pressed": { "at": [90, 2, 0] } }'
expect 2 'mm of the surface, but is' maps bad.json
expect 1 'there is no folder' patch freckles/small.json -o nowhere/image
echo "as expected"
