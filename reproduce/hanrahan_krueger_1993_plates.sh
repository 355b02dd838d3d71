#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# Plates 1 to 4 of Hanrahan & Krueger 1993, on the head that ./demo.sh fetches: the factors of the
# first order; layers against a Lambertian surface, with light from 0 and 45 degrees, and where they
# differ; a dark complexion, matte and oily, and freckles.
#
#   hanrahan_krueger_1993_plates.sh LAMINA OUT_FOLDER [OPTIONS OF lamina render...]
#
# The difference is drawn by the example 03_layers_against_lambert, looked for beside LAMINA.
set -euo pipefail
lamina=$(realpath "$1") out=$(mkdir -p "$2" && realpath "$2")
shift 2
cd "$(dirname "$0")"
source ./sheet.sh
scenes=../scenes/hanrahan_krueger
[ -e ../demo/assets/head.obj ] || { echo "demo/assets/head.obj: not there; ./demo.sh fetches it" >&2; exit 2; }

plate() { "$lamina" render "$scenes/$1.json" -o "$out/$1.png" "${@:2}" >/dev/null; }

pictures=()
while read -r name caption; do
  plate "plate1_$name" "$@"
  pictures+=("$out/plate1_$name.png" "$caption")
done <<'FACTORS'
1_fresnel Fresnel factors
2_seeliger Seeliger's law
3_depth finite depth
4_backward phase function, g = -.25
5_forward phase function, g = .75
6_all all four, g = .75
FACTORS
sheet "$out/plate_1.png" 3 256 256 "${pictures[@]}"

pictures=()
difference=$(dirname "$lamina")/examples/03_layers_against_lambert
for angle in 0 45; do
  for kind in lambert layered; do plate "plate2_${kind}_$angle" "$@"; done
  pictures+=("$out/plate2_lambert_$angle.png" "Lambert, ${angle}°" "$out/plate2_layered_$angle.png" "layers, ${angle}°")
  if [ -x "$difference" ]; then
    "$difference" $scenes/plate2_layered_$angle.json $scenes/plate2_lambert_$angle.json \
      "$out/plate2_difference_$angle.png"
    pictures+=("$out/plate2_difference_$angle.png" "red: layers brighter, blue: darker")
  fi
done
sheet "$out/plate_2.png" $((${#pictures[@]} / 4)) 256 256 "${pictures[@]}"

for name in plate3_matte plate3_oily plate4_freckles; do plate $name "$@"; done
sheet "$out/plates_3_4.png" 3 384 384 "$out/plate3_matte.png" "melanin by a map, matte" \
  "$out/plate3_oily.png" "the same, oily" "$out/plate4_freckles.png" "blood by a map, freckles by noise"
