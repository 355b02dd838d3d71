# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# Sourced. sheet OUT.png COLUMNS WIDTH HEIGHT (FILE.png CAPTION)...: pictures side by side, each with
# its caption; rsvg-convert (Debian: librsvg2-bin) draws it.
sheet() {
  local out=$1 columns=$2 w=$3 h=$4 bar=26 i=0 count svg=${1%.png}.svg
  shift 4
  count=$(($# / 2))
  {
    echo "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink'" \
      "width='$((columns * w))' height='$(((count + columns - 1) / columns * (h + bar)))'>" \
      "<rect width='100%' height='100%' fill='#14171c'/>"
    while [ $# -gt 0 ]; do
      local x=$((i % columns * w)) y=$((i / columns * (h + bar)))
      echo "<image x='$x' y='$y' width='$w' height='$h' xlink:href='$(basename "$1")'/>"
      echo "<text x='$((x + w / 2))' y='$((y + h + 18))' font-family='DejaVu Sans' font-size='13'" \
        "fill='#d8dce2' text-anchor='middle'>$2</text>"
      i=$((i + 1))
      shift 2
    done
    echo "</svg>"
  } >"$svg"
  rsvg-convert "$svg" -o "$out"
  rm "$svg"
  echo "$out"
}
