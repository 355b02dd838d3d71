#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# The pictures of Xu & Sun 2008: Figures 10 and 11, a rough face with a far and a near light inside;
# Figures 12 and 13, a sculpture with a light behind it.
#
#   xu_sun_2008_pictures.sh LAMINA OUT_FOLDER [OPTIONS OF lamina render...]
set -euo pipefail
lamina=$(realpath "$1") out=$(mkdir -p "$2" && realpath "$2")
shift 2
cd "$(dirname "$0")"
source ./sheet.sh

near=(--set 'lights[0]={ "type": "point", "position": [0, 0, -0.8], "intensity": 0.64 }')
far=()
for light in far near; do
  declare -n settings=$light
  pictures=()
  for ior in 1.4 0.7142857; do
    for s in 6 3 1; do
      "$lamina" render ../scenes/rough_plate.json -o "$out/$light-$ior-$s.png" "${settings[@]}" \
        --set materials.frost.dielectric.ior=$ior --set materials.frost.dielectric.smoothness=$s "$@" >/dev/null
      n=1.4
      [ $ior != 1.4 ] || n=1/1.4
      pictures+=("$out/$light-$ior-$s.png" "n = $n, s = $s")
    done
  done
  sheet "$out/$([ $light = far ] && echo figure_10 || echo figure_11).png" 3 256 256 "${pictures[@]}"
done

pictures=()
for s in 2 3 4 5; do
  "$lamina" render ../scenes/bust.json -o "$out/bust-$s.png" --set materials.frost.dielectric.smoothness=$s "$@" >/dev/null
  pictures+=("$out/bust-$s.png" "s = $s")
done
sheet "$out/figure_12.png" 4 240 320 "${pictures[@]}"
