#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# `lamina render`: what it writes, and how it ends.   command_test.sh LAMINA SCENES
set -euo pipefail
lamina=$1 scenes=$2
folder=$(mktemp -d)
trap 'chmod -R u+w "$folder"; rm -rf "$folder"' EXIT
cd "$folder"

fail() { echo "FAILED: $*" >&2; exit 1; }

# expect CODE TEXT ARGUMENT...: `lamina render ARGUMENT...` ends with CODE and prints TEXT.
expect() {
  local code=$1 text=$2 got=0; shift 2
  "$lamina" render "$@" >output 2>&1 || got=$?
  [ "$got" = "$code" ] || fail "render $*: exit code $got instead of $code: $(cat output)"
  grep -qF -- "$text" output || fail "render $*: no '$text' in: $(cat output)"
}

# Profiles by diffusion are there at once.
scene=$folder/given/sphere_skin.json
mkdir given
printf '{ "lamina": "scene", "base": "%s", "render": { "profile": "diffusion", "samples_per_pixel": 64 } }' \
  "$scenes/sphere_skin.json" >"$scene"
small=(--samples 2 --width 24 --height 16)
expect 0 'Example:' --help

# Without a name both files, named after the scene; with an ending only that one.
expect 0 'sphere_skin.png' "$scene" "${small[@]}" --json result.json
[ -s sphere_skin.exr ] && [ -s sphere_skin.png ] || fail "not both files"
for key in wall_seconds cpu_seconds samples_per_pixel relative_noise relative_noise_rms peak_memory_mib; do
  grep -q "\"$key\"" result.json || fail "no $key in the JSON"
done
expect 0 'only.png' "$scene" "${small[@]}" -o only.png
[ -s only.png ] && [ ! -e only.exr ] || fail "not the one file asked for"

# --set is as if the file said so; a wrong key or value is named.
sed 's/"samples_per_pixel": [0-9]*/"samples_per_pixel": 2/' "$scene" >said.json
expect 0 'said.exr' said.json "${small[@]}" -o said.exr
expect 0 'set.exr' "$scene" --set film.width=24 --set film.height=16 --set render.samples_per_pixel=2 -o set.exr
cmp said.exr set.exr || fail "--set gives another picture than the file"
expect 2 '--set film.widht: film: unknown key "widht"; did you mean "width"?' "$scene" --set film.widht=24
expect 2 '--set film.width must be a whole number' "$scene" --set film.width=wide
expect 2 '--set meshes[7].material: meshes has' "$scene" --set meshes[7].material=skin
printf '{ "lamina": "scene", "base": "said.json", "film": { "width": 24, "height": 16 } }' >based.json
expect 0 'based.exr' based.json --set render.samples_per_pixel=2 -o based.exr
cmp said.exr based.exr || fail "a base gives another picture than the file"

for name in leaves bust rough_plate; do
  expect 0 "$name.png" "$scenes/$name.json" "${small[@]}" -o "$name.png"
  ! grep -q ' 0.00 % noise' output || fail "$name: noise measured where there is nothing to measure"
done

# A method that is left open is chosen, one that is named is not; what it takes is said before.
expect 0 'lamina: method hierarchy (' "$scenes/arm.json" "${small[@]}" --profile diffusion -o open.exr --json open.json
grep -qE 'method hierarchy \(.*\): about [0-9.]+ CPU-s' output || fail "no choice and cost: $(cat output)"
for key in '"method": "hierarchy"' '"method_chosen_because"' '"expected_cpu_seconds"'; do
  grep -q "$key" open.json || fail "no $key in the JSON"
done
expect 0 'lamina: method hierarchy: about ' "$scenes/arm.json" "${small[@]}" --profile diffusion -o named.exr --method hierarchy --json named.json
grep -q '"method": "hierarchy"' named.json || fail "a method that was named was switched"
! grep -q chosen named.json || fail "a method that was named was chosen"
expect 0 'method hierarchy (its light can be kept)' "$scenes/arm.json" "${small[@]}" --profile diffusion -o open.exr --cache open.ply

expect 0 '' "$scene" "${small[@]}" -o dipole.exr --profile dipole
cmp -s sphere_skin.exr dipole.exr && fail "--profile does nothing"

# The same picture for any number of threads, another for another seed.
expect 0 '' "$scene" "${small[@]}" -o one.exr --threads 1
expect 0 '' "$scene" "${small[@]}" -o two.exr --threads 2
expect 0 '' "$scene" "${small[@]}" -o seed.exr --seed 5
cmp -s one.exr two.exr || fail "the picture depends on the threads"
cmp -s one.exr seed.exr && fail "the seed does nothing"

# What cannot be written is refused before the work: such a scene would take hours.
endless=(--samples 1000000 --width 4000)
expect 1 'there is no folder' "$scene" "${endless[@]}" -o no/such/folder/x.png
expect 2 '.exr or .png' "$scene" "${endless[@]}" -o picture.jpg
mkdir -p named_so/sphere_skin.exr
expect 1 'is a folder' "$scene" "${endless[@]}" -o named_so
if [ "$(id -u)" != 0 ]; then
  mkdir locked; chmod a-w locked
  expect 1 'no permission' "$scene" "${endless[@]}" -o locked/x.png
fi
expect 2 'must be different files' "$scene" "${endless[@]}" -o same.png --json same.png
expect 2 'there is no such file' no_scene.json
expect 2 'method' "$scene" --method magic

# One question, how good: method, correction and samples follow, and what is named wins.
tiny=(--width 12 --height 8)
expect 0 'method probe (quality preview), 8 samples: about' "$scene" "${tiny[@]}" --quality preview -o q.exr --json q.json
for line in '"quality": "preview"' '"method": "probe"' '"is_corrected": false' '"samples_per_pixel": 8'; do
  grep -qF -- "$line" q.json || fail "--quality preview: no $line in $(cat q.json)"
done
expect 0 'method hierarchy (no noise below surfaces), corrected, 1 samples: about' "$scene" "${tiny[@]}" --quality final --samples 1 -o final.exr
expect 0 'method hierarchy: about' "$scene" "${tiny[@]}" --method hierarchy --correct --samples 1 -o named.exr
cmp final.exr named.exr || fail "--quality final is not hierarchy, corrected"
expect 0 'method random_walk (quality reference), 1 samples' "$scene" "${tiny[@]}" --quality reference --samples 1 -o q.exr
grep -qF 'render.profile: left out, method "random_walk"' output || fail "a key of the file steers the reference: $(cat output)"
expect 0 'method probe, 2 samples' "$scene" "${small[@]}" --quality reference --method probe -o q.exr
expect 0 'method hierarchy (' "$scene" "${tiny[@]}" --quality preview --correct --samples 1 -o q.exr
cmp q.exr final.exr || fail "--correct does not win over --quality preview"
expect 2 '--correct: method "random_walk" does not honour it' "$scene" "${small[@]}" --quality reference --correct
expect 2 '--cache: the method must be hierarchy or texture_space' "$scene" "${small[@]}" --quality reference --cache q.ply
expect 0 'method hierarchy (its light can be kept), 2 samples' "$scene" "${small[@]}" --quality preview --cache q.ply -o q.exr
expect 2 'did you mean "preview"?' "$scene" "${small[@]}" --quality previw
expect 2 'did you mean "final"?' "$scene" "${small[@]}" --set render.quality=fnal
expect 0 '1024 samples per pixel, method random_walk, quality reference' "$scene" --quality reference --check
expect 0 '64 samples per pixel, method auto, quality final' "$scenes/sphere_skin.json" --quality final --check
expect 0 '3 samples per pixel, method probe, quality preview' "$scene" --set render.quality=preview --set render.samples_per_pixel=3 --check
# Samples are kept for the method that was chosen, whoever chose it; parts are those of the picture.
rm -f q.exr
expect 0 'q.exr' "$scene" "${tiny[@]}" --quality preview --samples 2 -o q.exr --keep
expect 0 'q.exr' "$scene" "${tiny[@]}" --method probe --samples 4 -o q.exr --resume
expect 0 'whole.exr' "$scene" "${tiny[@]}" --quality preview --samples 4 -o whole.exr
cmp q.exr whole.exr || fail "a kept picture of --quality preview is not that of probe"
for i in 0 1; do expect 0 "$i.shard" "$scene" "${tiny[@]}" --quality preview --samples 4 --shard "$i/2" -o "$i.shard"; done
"$lamina" merge 0.shard 1.shard -o merged.exr >output 2>&1 || fail "parts of --quality preview: $(cat output)"
cmp merged.exr whole.exr || fail "the parts of --quality preview make another picture"

# What hierarchy samples is kept for other cameras, and made anew for other light or after damage.
sphere=(--method hierarchy "${small[@]}" --cache cloud.ply)
expect 2 '--cache: the method must be hierarchy' "$scene" "${small[@]}" --method probe --cache cloud.ply
expect 2 '--cache: the method must be hierarchy' "$scene" "${small[@]}" --method shadow_map --cache cloud.ply
[ ! -e cloud.ply ] || fail "a cache was written for a method that has none"
expect 2 'cloud.ply: there is no such file' "$scene" "${sphere[@]}" --cache-only -o kept.exr
expect 0 '' "$scene" "${sphere[@]}" -o kept.exr
expect 0 '' "$scene" "${sphere[@]}" --cache-only -o again.exr
cmp -s kept.exr again.exr || fail "the picture depends on where the samples come from"
expect 2 'made for other settings' "$scene" "${sphere[@]}" --bounces 1 --cache-only -o other.exr
[ ! -e other.exr ] || fail "a picture was written from a stale cache"
printf '\377' | dd of=cloud.ply bs=1 seek=5000 conv=notrunc status=none
expect 2 'is damaged' "$scene" "${sphere[@]}" --cache-only -o other.exr
expect 0 'is damaged; it is made anew' "$scene" "${sphere[@]}" -o again.exr
cmp -s kept.exr again.exr || fail "the picture shows damage of the cache"
expect 0 'made for other settings' "$scene" "${sphere[@]}" --bounces 1 -o other.exr
expect 2 'goes with --cache' "$scene" "${small[@]}" --cache-only
expect 2 '--foreign-light: goes with --cache' "$scene" "${small[@]}" --foreign-light
printf '\377' | dd of=cloud.ply bs=1 seek=40 conv=notrunc status=none
cp cloud.ply as_it_was.ply
expect 2 'cloud.ply: ' "$scene" "${sphere[@]}" --foreign-light -o other.exr
cmp cloud.ply as_it_was.ply || fail "light of others was replaced"
echo holiday >mine.ply
expect 2 'another file' "$scene" --method hierarchy "${small[@]}" --cache mine.ply
[ "$(cat mine.ply)" = holiday ] || fail "a file that is no cache was overwritten"
expect 1 'there is no folder' "$scene" --method hierarchy --cache no/such/folder/cloud.ply
expect 2 'profile' "$scene" --profile guessed

# What the method does not honour is refused by its line; another method than the file's leaves out
# such settings, but not those of the command line.
cat >walk.json <<'END'
{ "lamina": "scene", "version": 1, "mm_per_unit": 1,
  "camera": { "position": [0, 0, 9], "look_at": [0, 0, 0] }, "film": { "width": 8, "height": 8 },
  "materials": { "ring": { "subsurface": "jade" }, "ear": { "subsurface": "skin_type_3" } },
  "meshes": [ { "shape": "sphere", "material": "ear" },
              { "shape": "sphere", "radius": 0.3, "material": "ring", "transform": { "translate": [2, 0, 0] } } ],
  "lights": [ { "type": "environment", "radiance": 1 } ],
  "render": { "method": "layered_bsdf", "samples_per_pixel": 1,
    "orders": "first" } }
END
expect 0 'walk.json:8: render.orders: left out, method "hierarchy" does not honour it' walk.json --method hierarchy --profile diffusion --json walk_out.json
grep -q '"band_changes"' walk_out.json && grep -q '"totals": "radiative_transfer"' walk_out.json && grep -q '"profile": "diffusion"' walk_out.json || fail "bands and skin are not in the JSON"
expect 0 'material "ring": RGB turned into the 8 wavelengths of the scene; colors differ by up to' walk.json
expect 0 'ear: skin with the constants "calibrated", totals by radiative transfer' walk.json
expect 2 '--profile: method "random_walk" does not honour it' walk.json --method random_walk --profile dipole
sed 's/layered_bsdf/random_walk/' walk.json >refused.json
expect 2 'refused.json:8: render.orders: method "random_walk" does not honour it' refused.json

# Ctrl-C keeps the picture as far as it got.
"$lamina" render "$scene" --samples 1000000 --width 16 -o stopped >stopped.txt 2>&1 &
pid=$!
sleep 2
for _ in $(seq 60); do  # until it has had two seconds of a busy machine
  [ "$(ps -o times= -p "$pid")" -lt 2 ] || break
  sleep 1
done
kill -INT "$pid"
got=0; wait "$pid" || got=$?
[ "$got" = 130 ] || fail "interrupted: exit code $got instead of 130"
[ -s stopped.exr ] && [ -s stopped.png ] || fail "interrupted: no picture"
[ -s stopped.unfinished ] || fail "interrupted: nothing to go on from"
grep -q 'once more ends at once' stopped.txt || fail "interrupted: $(cat stopped.txt)"
expect 2 'so that many or more must be wanted, but it is 1' "$scene" --samples 1 --width 16 -o stopped --resume
expect 2 'other settings' "$scene" --samples 1000000 --width 16 --seed 3 -o stopped --resume
expect 0 '' "$scene" "${small[@]}" -o resumed.exr --resume
cmp -s resumed.exr one.exr || fail "--resume without a start differs"
[ ! -e resumed.unfinished ] || fail "a finished picture leaves its checkpoint"

# More samples onto a finished picture make that of all at once; hierarchy keeps to the light that
# was sampled for fewer, so its samples have to be as good.
more=("$scene" --width 24 --height 16 --method hierarchy)
expect 0 '' "${more[@]}" --samples 4 -o more.exr --keep
expect 2 'its light was sampled for fewer or more samples' "${more[@]}" --samples 40 -o more.exr --resume
for method in probe hierarchy; do
  more=("$scene" --width 24 --height 16 --method "$method" --set render.hierarchy.irradiance_samples=32)
  [ "$method" = hierarchy ] || unset 'more[7]' 'more[8]'
  expect 0 '' "${more[@]}" --samples 40 -o once.exr
  expect 0 '' "${more[@]}" --samples 24 -o more.exr --keep --fresh
  [ -s more.unfinished ] || fail "$method: --keep keeps nothing"
  expect 0 '40 samples per pixel' "${more[@]}" --samples 40 -o more.exr --resume
  cmp once.exr more.exr || fail "$method: more samples make another picture than all at once"
  [ ! -e more.unfinished ] || fail "$method: samples are kept without --keep"
done
more=("$scene" --width 24 --height 16 --method probe)

# What an earlier render has kept stays, which is said, until one goes on from it or is told to replace it.
expect 0 '' "${more[@]}" --samples 8 -o held.exr --keep
cp held.unfinished held.before
expect 0 'held.unfinished keeps 8 samples per pixel of an earlier render. It stays' "${more[@]}" --samples 4 -o held.exr
expect 2 '--keep: held.unfinished keeps 8 samples per pixel of an earlier render; --resume adds to it' "${more[@]}" --samples 4 -o held.exr --keep
expect 2 '--fresh: does not go with --resume' "${more[@]}" --samples 9 -o held.exr --resume --fresh
expect 0 'held.unfinished keeps 8 samples' "${more[@]}" --shard 0/2 --samples 4 -o held.shard
cmp held.before held.unfinished || fail "samples that were kept are gone"
expect 0 '' "${more[@]}" --samples 4 -o held.exr --keep --fresh
cmp -s held.before held.unfinished && fail "--fresh keeps what was there"
expect 0 '' "${more[@]}" --samples 4 -o held.exr --fresh
[ ! -e held.unfinished ] || fail "--fresh leaves what was there"
echo mine >held.unfinished
expect 0 'held.unfinished is there, and is no unfinished picture of this version' "${more[@]}" --samples 4 -o held.exr
[ "$(cat held.unfinished)" = mine ] || fail "a file that is no unfinished picture was replaced"

# What cannot be kept is no success; and what cannot be written is known before the work.
if [ -e /dev/full ]; then
  ln -s /dev/full full.unfinished
  expect 1 'full.unfinished: cannot be written: No space left on device: the picture is whole, but its samples are not kept' \
    "${more[@]}" --samples 4 -o full.exr --keep --fresh
  [ -s full.exr ] || fail "no picture where samples cannot be kept"
fi
long=$(printf 'y%.0s' $(seq 252))
expect 1 'File name too long' "$scene" "${endless[@]}" -o "$long.exr"
expect 1 '.unfinished: cannot be written: File name too long' "$scene" "${endless[@]}" -o "${long:6}.exr" --keep
expect 1 '.unfinished: cannot be written: File name too long' "$scene" "${endless[@]}" --shard 0/2 -o "${long:4}.shard" --keep
expect 1 'File name too long' "$scene" "${endless[@]}" --shard 0/2 -o "$long.shard"
expect 1 'File name too long' "$scene" "${endless[@]}" -o x.exr --json "$long.json"
expect 0 'nothing is kept if this render is stopped' "$scene" "${small[@]}" -o "${long:6}.exr"
samples_of() { sed -n 's/.*"samples_per_pixel": \([0-9]*\).*/\1/p' "$1"; }
expect 0 '' "${more[@]}" --samples 400 --noise .3 -o calm.exr --keep --json calm.json
expect 0 '' "${more[@]}" --samples 400 --noise .05 -o calm.exr --resume --json calmer.json
[ "$(samples_of calmer.json)" -gt "$(samples_of calm.json)" ] || fail "--noise: nothing added for less of it"

# A picture that grows is there before it is finished.
"$lamina" render "$scene" --samples 1000000 --width 16 -o grows --progressive >grows.txt 2>&1 &
pid=$!
for _ in $(seq 200); do [ ! -s grows.png ] || break; sleep 0.3; done
kill -0 "$pid" || fail "a picture of many samples was finished"
[ -s grows.exr ] && [ -s grows.png ] || fail "--progressive: no picture while it grows"
cp grows.exr early.exr
kill -INT "$pid"; wait "$pid" || true
cmp -s early.exr grows.exr && fail "--progressive: the last picture is the first"

# Coverage, mattes and what a file says of itself.
expect 0 '' "$scene" "${small[@]}" -o said_so.exr --alpha --cryptomatte --view agx
for text in lamina/camera_position_mm lamina/version CryptoObject02 CryptoMaterial00 manifest chromaticities agx; do
  grep -qa "$text" said_so.exr || fail "no $text in the EXR"
done
! grep -qa lamina/date said_so.exr || fail "a date without --stamp"
expect 0 '' "$scene" "${small[@]}" -o stamped.exr --stamp
for text in lamina/date lamina/scene '--stamp' lamina/cpu_seconds; do
  grep -qa -- "$text" stamped.exr || fail "no $text in a stamped EXR"
done
expect 2 '--view' "$scene" --view sepia
expect 2 'mattes are of all samples' "$scene" "${small[@]}" -o said_so.exr --cryptomatte --resume
expect 2 '--cryptomatte: does not go with --shard' "$scene" "${small[@]}" --shard 0/2 -o x.shard --cryptomatte

# Color spaces of the EXR, and views of an OpenColorIO config.
expect 0 '' "$scene" "${small[@]}" -o linear.exr
expect 0 '' "$scene" "${small[@]}" -o aces --color-space acescg
cmp -s linear.exr aces.exr && fail "--color-space changes nothing"
expect 0 '' "$scene" "${small[@]}" -o filmic.png
cmp filmic.png aces.png || fail "--color-space changes the PNG"
expect 2 '--color-space: must be one of rec709, acescg, but is aces' "$scene" "${small[@]}" -o x.exr --color-space aces
cat >studio.ocio <<'END'
ocio_profile_version: 2
search_path: ""
roles: {default: lin_rec709, scene_linear: lin_rec709}
displays:
  Monitor:
    - !<View> {name: Linear, colorspace: lin_rec709}
    - !<View> {name: Root, colorspace: root}
colorspaces:
  - !<ColorSpace> {name: lin_rec709}
  - !<ColorSpace>
    name: root
    from_scene_reference: !<ExponentTransform> {value: [2, 2, 2, 1], direction: inverse}
END
env -u OCIO "$lamina" render "$scene" "${small[@]}" -o root.png --ocio studio.ocio --view Root >output 2>&1 || {
  grep -q 'built with' output || fail "--ocio: $(cat output)"; }
if [ -s root.png ]; then
  expect 0 '' "$scene" "${small[@]}" -o first.png --ocio studio.ocio
  cmp -s first.png root.png && fail "--ocio: two views look alike"
  OCIO=studio.ocio expect 0 '' "$scene" "${small[@]}" -o by_name.png --view Root
  cmp root.png by_name.png || fail "the view of the config in OCIO"
  OCIO=studio.ocio expect 0 '' "$scene" "${small[@]}" -o own.png --view filmic
  cmp filmic.png own.png || fail "lamina's own view beside a config in OCIO"
  expect 2 'studio.ocio: the view of Monitor must be one of Linear, Root, but is Rot; did you mean "Root"?' "$scene" "${small[@]}" -o x.png --ocio studio.ocio --view Rot
  expect 2 'none.ocio: cannot be read by OpenColorIO' "$scene" "${small[@]}" -o x.png --ocio none.ocio
fi
[ ! -e x.png ] || fail "a picture in spite of a wrong view"
expect 2 '--display: goes with a config of OpenColorIO' "$scene" "${small[@]}" -o x.png --display Monitor
expect 2 '--ocio: does not go with --shard' "$scene" "${small[@]}" --shard 0/2 -o x.shard --ocio studio.ocio
expect 2 '--color-space: does not go with --compare' "$scene" "${small[@]}" --compare probe,hierarchy -o both --color-space acescg

# A layer for each light, named in the scene or after its kind.
expect 0 'light environment, 2 of 2: method probe' "$scenes/arm.json" --profile diffusion "${small[@]}" --method probe -o layers.exr --light-layers --json layers.json
grep -qa 'light.environment.R' layers.exr || fail "no layer of the sky"
grep -q '"light_layers"' layers.json || fail "no layers in the JSON"
expect 2 '--shard' "$scene" "${small[@]}" --shard 0/2 -o x.shard --light-layers
for option in --resume --keep --progressive --denoise; do
  expect 2 "$option: does not go with --light-layers" "$scene" "${small[@]}" -o x.exr --light-layers "$option"
done
expect 2 'the output must be an EXR, but is x.png' "$scene" "${small[@]}" -o x.png --light-layers
expect 2 '--noise: must be 0 with --light-layers, but is 0.1' "$scene" "${small[@]}" -o x.exr --light-layers --noise 0.1
expect 2 'does not go with --compare' "$scene" "${small[@]}" --compare probe,hierarchy -o both --light-layers
expect 2 'lights[0].name: must be 1 to 64 letters, digits, _ and -, but is "a.b"' "$scene" "${small[@]}" -o x.exr --set lights[0].name=a.b

# Sampling ends where the noise asked for is reached.
expect 0 '' "$scene" --samples 4000 --width 24 --height 16 --noise 0.5 -o calm.exr --json calm.json
grep -qE '"samples_per_pixel": (1[6-9]|[2-9][0-9])([.,]|$)' calm.json || fail "--noise: $(grep samples calm.json)"
expect 2 'noise' "$scene" --noise 7

# Methods side by side, and what they cost.
expect 0 'the reference' "$scene" "${small[@]}" --compare probe,shadow_map,hierarchy -o both --json both.json
for file in both.svg both_probe.png both_probe.exr both_shadow_map.png both_hierarchy.png both_hierarchy.exr; do
  [ -s "$file" ] || fail "--compare: no $file"
done
grep -q '"mean_error"' both.json || fail "--compare: no error"
expect 2 'two methods' "$scene" "${small[@]}" --compare probe
expect 2 'magic' "$scene" "${small[@]}" --compare probe,magic
expect 2 'no ending' "$scene" "${small[@]}" --compare probe,hierarchy -o both.png
expect 2 '--progressive: does not go' "$scene" "${small[@]}" --compare probe,hierarchy -o both --progressive
expect 2 '--keep: does not go' "$scene" "${small[@]}" --shard 0/2 -o x.shard --keep
expect 2 '--resume' "$scene" "${small[@]}" --compare probe,hierarchy -o both --resume

# Without noise, for viewing; the EXR keeps the noise too.
expect 0 '' "$scene" "${small[@]}" --denoise -o smooth.exr
cmp -s smooth.exr one.exr && fail "--denoise does nothing"
grep -q 'noisy.G' smooth.exr || fail "--denoise drops the render's own colors"
