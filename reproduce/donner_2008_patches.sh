#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# Figures 1 and 3 of Donner et al. 2008: three maps, and the skin that they make; uniform skin, skin of maps, and
# uniform skin with an albedo texture, in full light and in strips of light. And ink of three colors under skin.
#
#   donner_2008_patches.sh LAMINA OUT_FOLDER
set -euo pipefail
lamina=$(realpath "$1") out=$(mkdir -p "$2" && realpath "$2")
cd "$(dirname "$0")"
source ./sheet.sh

"$lamina" maps ../scenes/donner_2008/figure_3.json -o "$out/figure_3" >/dev/null
# ink COLOR SPECTRUM: examples/skin/tattoo.json with ink that absorbs by a spectrum.
ink() {
  "$lamina" maps ../examples/skin/tattoo.json --set "skin.junction_spectrum=[$2]" -o "$out/ink_$1" >/dev/null
  "$lamina" patch "$out/ink_$1/patch.json" -o "$out/ink_$1" --exposure 0.5 >/dev/null
}
ink black "[400, 1]"
ink green "[440, 0.9], [490, 0.25], [530, 0.15], [570, 0.6], [610, 1]"
ink red "[560, 1], [610, 0.15], [640, 0.05]"
sheet "$out/ink.png" 3 220 220 "$out/ink_black.png" "black ink" "$out/ink_green.png" "green ink" "$out/ink_red.png" "red ink"

"$lamina" maps ../scenes/donner_2008/figure_1.json -o "$out/figure_1" --png >/dev/null
"$lamina" patch "$out/figure_1/patch.json" -o "$out/figure_1/skin" --exposure 0.5 >/dev/null
cd "$out/figure_1"
cp melanin.png junction_absorption.png hemoglobin_dermis.png skin.png "$out"
sheet "$out/figure_1.png" 4 240 240 "$out/melanin.png" "melanin" "$out/junction_absorption.png" "absorbing junction" \
  "$out/hemoglobin_dermis.png" "blood" "$out/skin.png" "the skin"

cd "$out/figure_3"
cat >uniform.json <<'PATCH'
{ "lamina": "patch", "version": 1, "mm_per_pixel": 0.05, "width": 320, "height": 320,
  "skin": { "melanin": 0.010, "hemoglobin_dermis": 0.007 } }
PATCH
strips='light={ "stripes": { "period": 5.3, "width": 1.6, "angle": 20 } }'
# patches PATCH NAME [OPTION...]: a patch in full light as NAME.exr and NAME.png, and in strips of light.
patches() {
  "$lamina" patch "$1.json" -o "$2" --exposure 0.5 "${@:3}" >/dev/null
  "$lamina" patch "$1.json" -o "$2_strips" --exposure 1.2 --set "$strips" "${@:3}" >/dev/null
}
patches uniform uniform
patches patch maps
patches uniform texture --set albedo=maps.exr
sheet figure_3.png 3 300 300 uniform.png "uniform skin" maps.png "maps of pigments" texture.png "uniform skin, albedo texture" \
  uniform_strips.png "in strips of light" maps_strips.png "in strips of light" texture_strips.png "in strips of light"
mv figure_3.png "$out"
