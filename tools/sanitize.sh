#!/usr/bin/env bash
# Address and undefined-behaviour sanitizers on what reads files and on the quick solvers; the thread
# sanitizer on what uses threads. A fast subset, for every change; `cmake --preset asan` and `ctest
# --preset asan` run all.
set -euo pipefail
cd "$(dirname "$0")/.."
export LAMINA_CACHE=off

cmake --preset asan >/dev/null
cmake --build --preset asan --target core_test optics_test image_test materials_test mesh_test
slow='*MonteCarlo*:*Photons*:*Measured*:*RayTraced*:*HeightField*:*Synthesis*:PatchFiles.*:SkinPatch.*'
for program in core optics image materials mesh; do
  echo "asan: $program"
  build/asan/tests/${program}_test --gtest_brief=1 --gtest_filter="-$slow"
done

cmake --preset tsan >/dev/null
cmake --build --preset tsan --target core_test lamina_command
# Not instrumented themselves, the libraries below synchronize in ways that the sanitizer cannot see.
export TSAN_OPTIONS="suppressions=$PWD/tools/tsan_suppressions.txt halt_on_error=1"
echo "tsan: core, photons, profiles, patches, renders"
build/tsan/tests/core_test --gtest_brief=1
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
build/tsan/lamina photons jade --photons 20000 --threads 4 >/dev/null
build/tsan/lamina slab donner_jensen_skin --threads 4 >/dev/null
for method in probe hierarchy shadow_map random_walk; do
  build/tsan/lamina render scenes/slab_backlit.json --method $method --width 24 --samples 2 \
    --threads 4 -o "$out/$method" >/dev/null
done
