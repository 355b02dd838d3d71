#!/usr/bin/env bash
# A fast subset, for every change: the address and undefined-behavior sanitizers on the tests of all
# that reads files, on those of optics and materials and on all options of what renders write; the thread sanitizer on the tests of core and
# on small runs of the solvers and of every method of rendering. All tests run with
# `cmake --preset asan && cmake --build --preset asan && ctest --preset asan`; so does `tsan`.
set -euo pipefail
cd "$(dirname "$0")/.."
source ./setup.sh
install_packages "${build_packages[@]}" "${test_packages[@]}" "${sanitize_packages[@]}"
use_compiler_cache
export LAMINA_CACHE=off
export TSAN_OPTIONS="suppressions=$PWD/tools/tsan_suppressions.txt halt_on_error=1"
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
export out

# Runs each line of standard input, several at a time; says how long each took, which fails, and what it printed.
run_all() {
  xargs -P "$(nproc)" -d '\n' -I {} bash -c '
    log=$(mktemp -p "$out") TIMEFORMAT="%U s CPU: $1"
    time eval "$1" >"$log" 2>&1 || { echo "failed: $1"; head -n 60 "$log"; exit 1; }' _ {}
}

cmake --preset asan >/dev/null
cmake --build --preset asan --target core_test optics_test image_test materials_test mesh_test acquire_test lamina_command
echo "address and undefined behavior: core, io, spectrum, optics, image, plot, reproduction, materials, maps, mesh, files of patches and captures, options of pictures"
run_all <<'END'
python3 tests/cli/output_options_test.py build/asan/lamina
build/asan/tests/materials_test --gtest_brief=1
build/asan/tests/optics_test --gtest_brief=1
build/asan/tests/mesh_test --gtest_brief=1 --gtest_filter=-SkinPatch.*:MaterialPatches.*:PatchFiles.Shade*
build/asan/tests/image_test --gtest_brief=1
build/asan/tests/acquire_test --gtest_brief=1 --gtest_filter=Capture*:Acqui*:ColorChart*:PixelMask*:Develop*
build/asan/tests/core_test --gtest_brief=1
END

echo "fuzzing"
tools/fuzz.sh 5

cmake --preset tsan >/dev/null
cmake --build --preset tsan --target core_test thread_sanitizer_runs
echo "threads: core, solvers, rendering"
# Profiles by radiative transfer take minutes where each access is watched: they are solved so once, by
# the render without a cache. The others take theirs from one that the same code has filled.
solver=build/test/lamina  # quicker, where it is built
[ -x $solver ] || solver=build/asan/lamina
for scene in bumpy arm; do
  LAMINA_CACHE=$out/cache $solver render scenes/$scene.json -o "$out/fill.png" --method hierarchy --width 4 --samples 1 >/dev/null 2>&1
done
# run RUN [WIDTH SAMPLES METHOD]: a run of tests/faults/thread_sanitizer_runs.cpp, whose scenes are of scenes/
run() {
  if [ $# = 1 ]; then
    build/tsan/tests/thread_sanitizer_runs "$1"
  else
    build/tsan/tests/thread_sanitizer_runs "scenes/$1.json" film.width="$2" film.height="$2" \
      render.samples_per_pixel="$3" ${4:+render.method="$4"}
  fi
}
export -f run
run_all <<'END'
run bumpy 16 1 random_walk
LAMINA_CACHE=$out/cache run bumpy 16 2 hierarchy
run bumpy 16 2 probe
LAMINA_CACHE=$out/cache run bumpy 16 2 shadow_map
run bodies 16 1
LAMINA_CACHE=$out/cache run arm 16 2
run photons
run bsdf
run profile
run slab
build/tsan/tests/core_test --gtest_brief=1
END
