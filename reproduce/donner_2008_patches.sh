#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# Figure 1 of Donner et al. 2008: three maps, and the skin that they make.
#
#   donner_2008_patches.sh LAMINA OUT_FOLDER
set -euo pipefail
lamina=$(realpath "$1") out=$(mkdir -p "$2" && realpath "$2")
cd "$(dirname "$0")"
source ./sheet.sh

"$lamina" maps ../scenes/donner_2008/figure_1.json -o "$out/figure_1" --png >/dev/null
"$lamina" patch "$out/figure_1/patch.json" -o "$out/figure_1/skin" --exposure 0.5 >/dev/null
cd "$out/figure_1"
cp melanin.png junction_absorption.png hemoglobin_dermis.png skin.png "$out"
sheet "$out/figure_1.png" 4 240 240 "$out/melanin.png" "melanin" "$out/junction_absorption.png" "absorbing junction" \
  "$out/hemoglobin_dermis.png" "blood" "$out/skin.png" "the skin"
