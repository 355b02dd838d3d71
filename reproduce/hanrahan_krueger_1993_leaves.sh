#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# Plates 5 and 6 of Hanrahan & Krueger 1993: a leaf's maps, and a cluster of leaves under the sun in
# four places, two behind it and two before it.
#
#   hanrahan_krueger_1993_leaves.sh LAMINA OUT_FOLDER [OPTIONS OF lamina render...]
set -euo pipefail
lamina=$(realpath "$1") out=$(mkdir -p "$2" && realpath "$2")
shift 2
cd "$(dirname "$0")"
source ./sheet.sh

cp ../scenes/leaf/{color,thickness,outline}.png "$out"
sheet "$out/plate_5.png" 3 224 384 "$out/color.png" color "$out/thickness.png" thickness \
  "$out/outline.png" opacity

pictures=()
while read -r name towards caption; do
  "$lamina" render ../scenes/leaves.json --set "lights[0].towards=[$towards]" -o "$out/$name.png" "$@" >/dev/null
  pictures+=("$out/$name.png" "$caption")
done <<'POSITIONS'
back_high 0.35,0.55,-0.8 sun behind, high
back_low -0.9,0.1,-0.7 sun behind, low
front_left -0.5,0.6,0.7 sun before, left
front_right 0.8,0.25,0.6 sun before, right
POSITIONS
sheet "$out/plate_6.png" 4 480 480 "${pictures[@]}"
