#!/bin/sh
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#
# Runs the tests of the Python package with its bindings under the address sanitizer, which also
# watches every allocation of the library below them. The library itself is that of the build:
# the preset asan checks it in C++.
#
# usage: tools/sanitize_python.sh BUILD [pytest arguments]      BUILD has been built, as build/dev
set -eu

build=$(realpath "$1")
source=$(realpath "$(dirname "$0")/..")
shift
out=$build/python_asan
mkdir -p "$out/lamina"
cp "$build"/python/lamina/*.py "$out/lamina/"

# The bindings' own commands of compilation and linking, with the sanitizer.
cd "$build"
ninja -t commands lamina_python | grep -- 'lamina_python.dir/bindings/[a-z_]*\.cpp\.o -c ' > "$out/commands"
while read -r command; do
  object=$out/$(echo "$command" | sed 's|.*bindings/\([a-z_]*\)\.cpp\.o -c.*|\1.o|')
  echo "$command" | sed "s| -o [^ ]*\.o -c | -O1 -fsanitize=address -fno-omit-frame-pointer -o $object -c |; s|-MF [^ ]*|-MF $object.d|; s|-MT [^ ]*||"
done < "$out/commands" > "$out/compile"
xargs -d '\n' -P "${JOBS:-2}" -n 1 sh -c < "$out/compile"
ninja -t commands lamina_python | tail -1 |
  sed "s|python/CMakeFiles/lamina_python.dir/bindings/\([a-z_]*\)\.cpp\.o|$out/\1.o|g; s|-o [^ ]*_lamina[^ ]*\.so|-fsanitize=address -o $out/lamina/_lamina.so|" > "$out/link"
sh "$out/link"

cd "$source"
export LD_PRELOAD="$(c++ -print-file-name=libasan.so) $(c++ -print-file-name=libstdc++.so)"
# Python keeps memory to its end; what is asked for here are wrong accesses.
export ASAN_OPTIONS=detect_leaks=0:abort_on_error=1:allocator_may_return_null=1
export PYTHONMALLOC=malloc PYTHONPATH="$out" LAMINA_SOURCE="$source" LAMINA_CACHE="$build/test_cache"
exec "${PYTHON:-/usr/bin/python3}" -B -m pytest -q -p no:cacheprovider -c "$source/python/pytest.ini" "${@:-$source/tests/python}"
