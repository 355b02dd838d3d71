#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# `lamina materials`: what it prints, and how it ends.   command_test.sh LAMINA PYTHON
set -euo pipefail
lamina=$1 python=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fail() { echo "FAILED: $*" >&2; exit 1; }

# expect CODE TEXT ARGUMENT...: `lamina materials ARGUMENT...` ends with CODE and prints TEXT.
expect() {
  local code=$1 text=$2 got=0; shift 2
  "$lamina" materials "$@" >output 2>&1 || got=$?
  [ "$got" = "$code" ] || fail "materials $*: exit code $got instead of $code"
  grep -qF -- "$text" output || fail "materials $*: no '$text' in: $(cat output)"
}

expect 0 'painted_jade'
expect 0 'Donner & Jensen 2005, Table 3'
expect 0 'Example:' --help
expect 2 'did you mean "jade"?' jaed
expect 2 'there is no such file' ./jade
expect 1 'cannot be written' --json no/such/folder/list.json

# Names are the first column; what is printed for each is a file that reads back.
names=$("$lamina" materials | tail -n +2 | cut -d' ' -f1)
[ "$(echo "$names" | wc -l)" -ge 20 ] || fail "fewer than 20 materials"
for name in $names; do
  "$lamina" materials "$name" >"$name.json"
  "$lamina" materials "./$name.json" >again.json || fail "$name does not read back"
  "$lamina" materials ./again.json | cmp -s - again.json || fail "$name changes when read again"
done

"$lamina" materials --json - | "$python" -c '
import json, sys
result = json.load(sys.stdin)
assert result["command"] == "materials" and len(result["materials"]) >= 20
skin = result["materials"][0]
assert skin["name"] == "donner_jensen_skin" and skin["bands"] == ["R", "G", "B"]
assert skin["layers"] == ["epidermis", "upper dermis", "bloody dermis"]'
"$lamina" materials jade --json jade_result.json >/dev/null
"$python" -c '
import json
assert json.load(open("jade_result.json"))["material"]["layers"][0]["ior"] == 1.61'
