#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# Shards of pictures and of photons make the whole, bit by bit.   shards_command_test.sh LAMINA SCENES
set -euo pipefail
lamina=$1 scenes=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fail() { echo "FAILED: $*" >&2; exit 1; }

# expect CODE TEXT ARGUMENT...: `lamina ARGUMENT...` ends with CODE and prints TEXT.
expect() {
  local code=$1 text=$2 got=0; shift 2
  "$lamina" "$@" >output 2>&1 || got=$?
  [ "$got" = "$code" ] || fail "$*: exit code $got instead of $code: $(cat output)"
  grep -qF -- "$text" output || fail "$*: no '$text' in: $(cat output)"
}

scene=$folder/"it's a scene.json"
printf '{ "lamina": "scene", "base": "%s", "render": { "profile": "diffusion", "samples_per_pixel": 7 }, "film": { "width": 20, "height": 18 } }' \
  "$scenes/sphere_skin.json" >"$scene"

# Each method, with one and two threads, merged in any order and by way of partial sums.
for method in shadow_map hierarchy random_walk probe; do
  film=()
  [ $method != random_walk ] || film=(--width 10 --height 9)  # which takes ten times as long
  expect 0 whole.exr render "$scene" --method $method "${film[@]}" -o whole.exr
  for i in 1 2 0; do
    expect 0 $i.shard render "$scene" --method $method "${film[@]}" --shard $i/3 -o $i.shard --threads $((1 + i % 2))
  done
  expect 0 '7 of 7 samples per pixel' merge 2.shard 0.shard 1.shard -o merged.exr --all
  cmp whole.exr merged.exr || fail "$method: shards make another picture"
  expect 0 '5 of 7' merge 2.shard 0.shard -o part.shard
  expect 0 '7 of 7' merge 1.shard part.shard -o merged.exr --all
  cmp whole.exr merged.exr || fail "$method: partial sums make another picture"
done
# The denoised picture, and what the JSON says of noise.
expect 0 whole.exr render "$scene" --method probe -o whole --denoise --json whole.json
rm -f part.shard
expect 0 merged.exr merge . -o merged --denoise --json merged.json
cmp whole.exr merged.exr && cmp whole.png merged.png || fail "denoised pictures differ"
[ "$(grep -o "relative_noise_rms.: [0-9.e-]*" whole.json)" = "$(grep -o "relative_noise_rms.: [0-9.e-]*" merged.json)" ] || fail "noise differs"
[ "$(grep -o "relative_noise.: [0-9.e-]*" whole.json)" = "$(grep -o "relative_noise.: [0-9.e-]*" merged.json)" ] || fail "noise differs"
expect 0 R.exr merge . -o R.exr --channels R,variance
expect 1 'samples per pixel would do' merge . -o noisy.png --noise 0.0001
[ -s noisy.png ] || fail "no picture with its noise"

# What is missing is named with the command that makes it, which a shell takes as it stands.
expect 2 '1 of 3 shards are missing: 1/3' merge 0.shard 2.shard -o x.exr --all
[ ! -e x.exr ] || fail "a picture without all shards"
expect 0 'warning: 1 of 3 shards are missing: 1/3' merge 0.shard 2.shard -o x.exr
mv 1.shard kept
sed -n 's/^lamina: missing: //p' output >missing.sh
(lamina() { "$lamina" "$@"; }; . ./missing.sh >/dev/null 2>&1) || fail "$(cat missing.sh)"
expect 0 '7 of 7' merge 0.shard 1.shard 2.shard -o again.exr --denoise --all
cmp whole.exr again.exr || fail "the shard that was made anew is another one"

# What does not belong together, or cannot be, is refused by name.
expect 2 '0.shard: samples 0 to 1 must be given once' merge 0.shard 0.shard -o x.exr
expect 0 s.shard render "$scene" --method probe --shard 1/3 --seed 5 -o s.shard
expect 2 's.shard: the seed must be that of 0.shard, "0", but is "5"' merge 0.shard s.shard -o x.exr
expect 0 s.shard render "$scene" --method probe --shard 1/3 --set camera.horizontal_fov=20 -o s.shard
expect 2 's.shard: must be of the scene' merge 0.shard s.shard -o x.exr
expect 0 s.shard render "$scene" --method probe --shard 1/4 -o s.shard
expect 2 's.shard: the number of shards must be' merge 0.shard s.shard -o x.exr
expect 2 'but is not' merge 0.shard "$scene" -o x.exr
printf 'x' | dd of=2.shard bs=1 seek=2000 conv=notrunc 2>/dev/null
expect 2 '2.shard: is damaged' merge 0.shard 1.shard 2.shard -o damaged.exr
[ ! -e damaged.exr ] || fail "a picture of damaged shards"
expect 2 '--shard: must be I/N' render "$scene" --shard 3/3 -o x.shard
expect 2 '--noise: does not go with --shard' render "$scene" --shard 0/2 --noise 0.1 -o x.shard
expect 2 '--denoise: is for `lamina merge`' render "$scene" --shard 0/2 --denoise -o x.shard
expect 2 'can have at most as many shards' render "$scene" --shard 0/8 -o x.shard
expect 2 'must end in .shard' render "$scene" --shard 0/2 -o x.png
expect 2 '--plot: is for shards of photons' merge 0.shard 1.shard --plot x.svg

# What shards share is made once; the light of the cache is then that of the picture.
expect 0 light.ply render "$scene" --method hierarchy --cache light.ply --prepare
expect 0 whole.exr render "$scene" --method hierarchy --cache light.ply --cache-only -o whole.exr
expect 0 a.shard render "$scene" --method hierarchy --cache light.ply --cache-only --shard 0/2 -o a.shard
expect 0 b.shard render "$scene" --method hierarchy --cache light.ply --cache-only --shard 1/2 -o b.shard
expect 0 '7 of 7' merge b.shard a.shard -o merged.exr --all
cmp whole.exr merged.exr || fail "shards with a cache make another picture"

# Photons.
photons=(photons donner_jensen_skin --photons 4000 --tally r --seed 3)
expect 0 '' "${photons[@]}" --counts --json whole.json
for i in 1 2 0; do
  expect 0 '' "${photons[@]}" --shard $i/3 --json p$i.json --threads $((1 + i % 2))
done
expect 0 '' merge p2.json p0.json p1.json --json merged.json --all
[ "$(grep -c first whole.json)" -gt 0 ] || fail "no sums"
cmp <(grep -v '"command"' whole.json) <(grep -v '"command"' merged.json) || fail "photons of shards differ"
expect 2 '1 of 3 shards are missing: 1/3' merge p2.json p0.json --all
expect 2 '--output: is for shards of a picture' merge p2.json p0.json -o x.exr
