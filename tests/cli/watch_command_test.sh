#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# `lamina render --watch`: makes the picture again when a file changes.   watch_command_test.sh LAMINA
set -euo pipefail
lamina=$1
folder=$(mktemp -d)
pid=
trap '[ -z "$pid" ] || kill -KILL "$pid" 2>/dev/null || true; rm -rf "$folder"' EXIT
cd "$folder"

fail() { echo "FAILED: $*: $(cat watch.txt 2>/dev/null)" >&2; exit 1; }

# write_scene COLOR SAMPLES
write_scene() {
  cat >scene.json <<JSON
{ "lamina": "scene", "version": 1, "mm_per_unit": 1,
  "camera": { "position": [0, 0, 9], "look_at": [0, 0, 0] }, "film": { "width": 16, "height": 16 },
  "materials": { "wall": { "diffuse": $1 }, "card": { "diffuse": { "map": "card.png", "encoding": "srgb" } } },
  "meshes": [ { "file": "card.obj", "material": "card" }, { "shape": "sphere", "material": "wall" } ],
  "lights": [ { "type": "environment", "radiance": 1 } ], "render": { "samples_per_pixel": $2 } }
JSON
}
# write_card SIZE
write_card() {
  printf 'v -%s -2 0\nv %s -2 0\nv %s 2 0\nv -%s 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n' \
    "$1" "$1" "$1" "$1" >card.obj
}
# write_map COLOR
write_map() { python3 - "$1" <<'PY'
import struct, sys, zlib
row = b"\0" + bytes([int(sys.argv[1])] * 3)
chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
with open("new.png", "wb") as file:
    file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0)) +
               chunk(b"IDAT", zlib.compress(row)) + chunk(b"IEND", b""))
PY
  mv new.png card.png
}
# Waits until the picture is that of the files as they are.
expect_picture() {
  "$lamina" render scene.json -o wanted.exr >output 2>&1 || fail "$1: $(cat output)"
  for _ in $(seq 150); do
    ! cmp -s wanted.exr seen.exr || return 0
    kill -0 "$pid" 2>/dev/null || fail "$1: it has ended"
    sleep 0.2
  done
  fail "$1: not the picture of the files"
}
# expect_line TEXT COUNT: so many lines of what it says have the text.
expect_line() {
  for _ in $(seq 100); do
    [ "$(grep -cF -- "$1" watch.txt || true)" != "$2" ] || return 0
    sleep 0.2
  done
  fail "no '$1', $2 times"
}

write_scene 0.5 2; write_card 3; write_map 200
"$lamina" render scene.json --watch -o seen.exr >watch.txt 2>&1 &
pid=$!
expect_picture "at first"
expect_line 'waiting for changes of 3 files' 1

write_scene '[0.9, 0.1, 0.1]' 2
expect_picture "after a change of the scene"
expect_line 'scene.json has changed' 1
write_card 2; expect_picture "after a change of a mesh"
expect_line 'card.obj has changed' 1
write_map 20; expect_picture "after a change of a map, by putting another in its place"

# What is wrong is said and waited for; the picture stays.
cp seen.exr before.exr
sed -i 's/"sphere"/"sphare"/' scene.json
expect_line 'scene.json:4: meshes[1].shape' 1
cmp -s before.exr seen.exr || fail "a wrong scene has changed the picture"
sed -i 's/"sphare"/"box"/' scene.json
expect_picture "after mending"
mv card.obj away.obj
expect_line 'card.obj: there is no such file' 1
mv away.obj card.obj; write_card 1
expect_picture "after a missing file has come"

# A change during the work ends it at once: this scene would take hours.
write_scene 0.5 1000000
sleep 1
write_scene 0.25 3
begin=$(date +%s)
expect_picture "after a change during the work"
[ $(($(date +%s) - begin)) -lt 20 ] || fail "it went on with a picture that is out of date"
[ ! -e seen.unfinished ] || fail "samples are kept"

kill -INT "$pid"; got=0; wait "$pid" || got=$?; pid=
[ "$got" = 130 ] || fail "interrupted: exit code $got instead of 130"
[ "$(ls)" = "$(printf '%s\n' before.exr card.obj card.png output scene.json seen.exr wanted.exr watch.txt)" ] || fail "files are left: $(ls)"

# refuse CODE TEXT ARGUMENT...
refuse() {
  local code=$1 text=$2 got=0; shift 2
  timeout 60 "$lamina" render "$@" --watch >watch.txt 2>&1 </dev/null || got=$?
  [ "$got" = "$code" ] && grep -qF -- "$text" watch.txt || fail "render $*: exit code $got, no '$text'"
}
refuse 2 '--resume: does not go with --watch' scene.json -o x.exr --resume
refuse 2 '--shard: does not go with --watch' scene.json -o x.shard --shard 0/2
refuse 2 '--compare: does not go with --watch' scene.json -o x --compare probe,hierarchy
refuse 2 'no.json: there is no such file' no.json -o x.exr
refuse 2 'the scene must be a file, but is -' - -o x.exr
