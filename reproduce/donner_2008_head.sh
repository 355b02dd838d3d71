#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# Figures 8, 10 and 11 of Donner et al. 2008 on the head of the demo, and the head in six shares of melanin by
# four of blood. No texture of colors takes part. Takes nine minutes of CPU time.
#
#   donner_2008_head.sh LAMINA OUT_FOLDER [OPTIONS OF lamina render...]
set -euo pipefail
lamina=$(realpath "$1") out=$(mkdir -p "$2" && realpath "$2")
shift 2
cd "$(dirname "$0")"
source ./sheet.sh
scenes=$PWD/../scenes/donner_2008
[ -e ../demo/assets/head.obj ] || { echo "the head is not there: run ./demo.sh first" >&2; exit 1; }
options=(--denoise "$@")

# maps NAME FEATURE...: maps of the face with features added.
maps() {
  local name=$1 settings=()
  shift
  for feature in "$@"; do settings+=(--set "features[+]=$feature"); done
  "$lamina" maps "$scenes/face.json" -o "$out/$name" "${settings[@]}" "${size[@]}" >/dev/null
}
size=()
# render SCENE MAPS NAME [OPTION...]: the scene with those maps.
render() {
  "$lamina" render "$scenes/$1.json" -o "$out/$3.png" --set "materials.skin.subsurface=$out/$2/material.json" \
    "${options[@]}" "${@:4}" >"$out/$3.log"
  tail -n 1 "$out/$3.log"
}
# scaled MAPS NAME MELANIN BLOOD: the same maps times factors.
scaled() {
  mkdir -p "$out/$2"
  cat >"$out/$2/material.json" <<MATERIAL
{ "lamina": "material", "version": 1, "base": "../$1/material.json",
  "skin": { "melanin": { "scale": $3 },
            "hemoglobin_epidermis": { "scale": $4 }, "hemoglobin_dermis": { "scale": $4 } } }
MATERIAL
}

plain='{ "moles": { "density": 0.03, "diameter": [1.2, 2.4] } }'
maps plain "$plain"

# Figure 10: freckles spread from a sample, ink under the skin, darker skin.
"$lamina" maps ../examples/skin/sample.json -o "$out/sample" >/dev/null
freckles="{ \"synthesis\": { \"patch\": \"$out/sample/patch.json\", \"use\": \"factors\" }, \"where\": [ { \"at\": [0.4, 6.5, 1.2], \"radius\": 1.0, \"mirrored\": true }, { \"at\": [0, 7, 1.4], \"radius\": 0.9 } ] }"
maps freckles "$plain" "$freckles"
maps tattoo "$plain" "{ \"tattoo\": { \"image\": \"$PWD/../examples/skin/ink.png\", \"at\": [0.66, 6.42, 0.95], \"width\": 30, \"absorbance\": 1.5, \"angle\": -8 } }"
scaled freckles dark 3.6 1.2
for name in freckles tattoo dark; do render head $name figure_10_$name; done
sheet "$out/figure_10.png" 3 256 256 "$out/figure_10_freckles.png" "freckles" \
  "$out/figure_10_tattoo.png" "ink under the skin" "$out/figure_10_dark.png" "darker skin"

# Figure 8: fingers have pressed blood out of a cheek.
blood='{ "flush": { "hemoglobin_dermis": 0.006 } }'
press() { echo "{ \"pressed\": { \"at\": [$1], \"diameter\": 15, \"share\": 0.85 } }"; }
maps before "$plain" "$blood"
maps after "$plain" "$blood" "$(press "0.5, 6.5, 1.1")" "$(press "0.56, 6.36, 1.05")" "$(press "0.55, 6.22, 1.0")"
for name in before after; do
  render head $name figure_8_$name --set "camera.look_at=[0.34, 6.45, 1.0]" --set camera.horizontal_fov=8 --width 220
done
sheet "$out/figure_8.png" 2 220 220 "$out/figure_8_before.png" "before" "$out/figure_8_after.png" "after three fingers have pressed"

# Figure 11: an ear lit from behind, with veins.
vein() { echo "{ \"vein\": { \"from\": [$1], \"to\": [$2], \"branches\": $3, \"diameter\": [0.3, 0.6], \"depth\": [0.1, 0.2], \"hemoglobin\": 0.05, \"saturation\": 0.4, \"absorbance\": 0.9 } }"; }
size=(--set width=2048 --set height=2048)  # finer than veins
maps ear "$plain" "$(vein "0.767, 6.47, 0.367" "0.824, 6.74, 0.341" 3)" \
  "$(vein "0.715, 6.5, 0.385" "0.76, 6.6, 0.37" 2)" "$(vein "0.82, 6.72, 0.34" "0.79, 6.8, 0.355" 2)"
render ear plain figure_11_plain
render ear ear figure_11_veins
sheet "$out/figure_11.png" 2 360 360 "$out/figure_11_plain.png" "lit from behind" "$out/figure_11_veins.png" "the same with veins"

# Six shares of melanin by four of blood.
pictures=()
for blood in 0.0012 0.004 0.008 0.014; do
  for melanin in 0.006 0.0083 0.0141 0.0259 0.045 0.08; do
    name=$melanin-$blood
    scaled plain "$name" "$(awk "BEGIN { print $melanin / 0.0141 }")" "$(awk "BEGIN { print $blood / 0.004 }")"
    render head "$name" "$name.head" --width 128 --samples 8
    pictures+=("$out/$name.head.png" "$(awk "BEGIN { print 100 * $melanin }") %, $(awk "BEGIN { print 100 * $blood }") %")
  done
done
sheet "$out/human_variation.png" 6 128 128 "${pictures[@]}"
