#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# `lamina info`: what it prints of meshes and scenes, and how it ends.   info_command_test.sh LAMINA PYTHON SOURCE
set -euo pipefail
lamina=$1 python=$2 source=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fail() { echo "FAILED: $*" >&2; exit 1; }

# expect CODE TEXT ARGUMENT...: `lamina info ARGUMENT...` ends with CODE and prints TEXT.
expect() {
  local code=$1 text=$2 got=0; shift 2
  "$lamina" info "$@" >output 2>&1 || got=$?
  [ "$got" = "$code" ] || fail "info $*: exit code $got instead of $code"
  grep -qF -- "$text" output || fail "info $*: no '$text' in: $(cat output)"
}

good=$source/tests/inputs/scene/good
expect 0 'Example:' --help
expect 0 'UDIM tiles 1001 to 1002 (2)' "$good/two_tiles.obj"
expect 0 'units: the longest is 2 mm if they are mm, 20 mm if cm, 2000 mm if m' "$good/two_tiles.obj"
expect 0 'with mm_per_unit 1000, for glTF is in metres' "$good/triangle.gltf"
expect 0 '"paint": {"diffuse":{"vertex_colors":true,"value":[0.8,0.4,0.2]},"coat":{"ior":1.5,"roughness":0.25,"distribution":"ggx"}}' "$good/triangle.gltf"
expect 0 'with mm_per_unit 100 it would be 200 mm' "$good/two_tiles.obj" --mm-per-unit 1
expect 0 'is 20 m long' "$good/two_tiles.obj" --mm-per-unit 10000
touch head.abc
expect 2 'which lamina does not read' head.abc
expect 2 'there is no such file' none.obj
expect 2 '--set: is for scenes' "$good/two_tiles.obj" --set film.width=3
expect 2 '--mm-per-unit: a scene says this itself' "$good/minimal.json" --mm-per-unit 3
expect 0 'wall (diffuse): 2 triangles, open' "$good/minimal.json"

# A head of 20 m, and one of 2 mm.
cat >head.json <<'END'
{ "lamina": "scene", "version": 1, "mm_per_unit": 1000,
  "camera": { "position": [0, 0, 50], "look_at": [0, 0, 0] },
  "materials": { "skin": { "subsurface": "jensen_skin1" } },
  "meshes": [ { "shape": "bust", "height": 20, "tessellation": 16, "material": "skin" } ],
  "lights": [ { "type": "point", "position": [0, 9, 9], "intensity": 1 } ] }
END
expect 0 'warning: bust is 19.9 m long' head.json
expect 0 'with mm_per_unit 10 it would be 199.4 mm' head.json
expect 0 'bust is 1.994 mm long' head.json --set mm_per_unit=0.1
"$lamina" info head.json --set mm_per_unit=10 > output 2>&1
grep -q warning output && fail "a head of 200 mm is likely"
# A render says the same.
"$lamina" render head.json --set film.width=2 --set film.height=2 --samples 1 --method layered_bsdf -o h > output 2>&1
grep -qF 'with mm_per_unit 10 it would be 199.4 mm' output || fail "render: no warning of units in $(cat output)"

# A lathe whose poles differ by rounding is closed.
"$lamina" info --json - "$source/tests/inputs/scene/good/lathe.obj" | grep -q '"closed": true' || fail "lathe: open"

"$lamina" info --json - "$good/two_tiles.obj" | "$python" -c '
import json, sys
result = json.load(sys.stdin)
assert result["command"] == "info" and result["kind"] == "mesh"
assert result["faces"] == 2 and result["triangles"] == 4 and result["open_edges"] == 6
assert result["udim_tiles"] == [1001, 1002] and result["vertex_colors"] and result["creases"] == 1
assert [part["names"] for part in result["parts"]] == [["head_left"], ["head_right"]]
assert result["memory_bytes"] > 0 and "size_mm" not in result
'
"$lamina" info --json - "$good/meshes.json" 2>/dev/null | "$python" -c '
import json, sys
result = json.load(sys.stdin)
assert result["kind"] == "scene" and len(result["meshes"]) == 6 and result["lights"] == 2
assert any("emission" in part["kind"] for mesh in result["meshes"] for part in mesh["parts"])
'

# Every kind of file that lamina reads, by files that it reads; what a folder of them lacks is made here.
for file in "$source"/tests/inputs/*/good/*; do
  case $file in *.raw | *.mtl) continue ;; esac  # beside an .hdr or .obj, which says what they are
  expect 0 '' "$file"
done
kind() { expect 0 "$(printf '  %-12s%s' kind "$1")" "$2"; expect 0 "$3" "$2"; }
inputs=$source/tests/inputs
kind material "$inputs/material/good/two_layers.json" 'taken by    slab'
kind capture "$inputs/capture/good/camera.json" 'taken by    acquire'
kind measurement "$inputs/measurement/good/kinds.json" 'taken by    fit'
kind population "$inputs/population/good/one.json" 'numbers'
kind patch "$inputs/patch/good/minimal.json" ' texels, '
kind 'recipe of maps' "$inputs/maps/good/everything.json" 'taken by    maps'
kind job "$inputs/job/good/all_keys.json" 'command     lamina photons'
kind reproduction "$inputs/reproduction/good/marble.json" 'taken by    reproduce'
kind image "$inputs/capture/good/skin.png" 'format      PNG'
kind 'ENVI image' "$inputs/capture/good/leaf.hdr" ' bands'
kind table "$inputs/measurement/good/totals.csv" 'columns'
kind 'MCML input' "$inputs/mcml/good/two_runs.mci" 'photons into'
kind 'MCML result' "$inputs/mcml/good/skin.mco" 'diffuse_reflectance 0.'
kind 'iad readings' "$inputs/measurement/good/iad_sphere.rxt" 'taken by    measurements'
kind MaterialX "$inputs/scene/good/look.mtlx" 'materials'
echo '{ "lamina": "material", "base": "skin_type_2", "skin": { "melanin": 0.1 } }' >darker.json
kind material darker.json 'base        skin_type_2'

"$lamina" photons marble --photons 100 --shard 0/2 --json p.json >/dev/null
kind 'counts of photons' p.json '1 of 2 shards'
"$lamina" slab marble --json r.json >/dev/null 2>&1
kind result r.json 'command     slab'
"$lamina" render "$good/minimal.json" --samples 2 --shard 0/2 --method random_walk -o one.shard >/dev/null 2>&1
kind 'shard of a picture' one.shard '1 of 2 per pixel, in 2 shards'
"$lamina" render "$good/minimal.json" --samples 2 --keep --method random_walk -o kept.png >/dev/null 2>&1
kind 'unfinished picture' kept.unfinished '2 per pixel'
"$lamina" render "$source/scenes/sphere_skin.json" --method hierarchy --cache light.ply --samples 1 --set film.width=4 --set film.height=4 -o l.png >/dev/null 2>&1
kind 'light on surfaces' light.ply 'samples'
"$lamina" submit "render '$good/minimal.json' --samples 4 --method random_walk -o job.exr" --shards 2 --dry-run >/dev/null
kind 'job folder' job.job '0 of 2 shards'
"$lamina" maps "$inputs/maps/good/everything.json" -o maps --set width=16 --set height=16 >/dev/null 2>&1
kind 'folder of maps' maps 'taken by    edit'
kind image maps/melanin.exr 'OpenEXR'

printf 'nothing' >some.thing
expect 2 'must be of a kind that lamina knows, but is none of scene (.json), material' some.thing
mkdir empty
expect 2 'must be of a kind that lamina knows' empty
printf '{ "lamina": "scenes" }' >wrong.json
expect 2 'wrong.json: "lamina" must be one of scene, material, capture' wrong.json
printf '{ "lamina": "scene"' >cut.json
expect 2 'cut.json:1:' cut.json
expect 2 'is for meshes, but this is a material' "$inputs/material/good/two_layers.json" --mm-per-unit 3
"$lamina" info --json - "$inputs/patch/good/minimal.json" | "$python" -c '
import json, sys
result = json.load(sys.stdin)
assert result["kind"] == "patch" and result["taken_by"].startswith("patch") and result["facts"]["width"] > 0
'
