#!/usr/bin/env bash
# A fast subset, for every change: the address, undefined-behavior and thread sanitizers on the tests
# of core, io and spectrum, which read files and share values between threads. `cmake --preset asan`,
# `cmake --build --preset asan` and `ctest --preset asan` run all tests; so does `tsan`.
set -euo pipefail
cd "$(dirname "$0")/.."
source ./setup.sh
install_packages "${build_packages[@]}" "${test_packages[@]}"
export LAMINA_CACHE=off
export TSAN_OPTIONS="suppressions=$PWD/tools/tsan_suppressions.txt halt_on_error=1"
for sanitizer in asan tsan; do
  cmake --preset $sanitizer >/dev/null
  cmake --build --preset $sanitizer --target core_test
  echo "$sanitizer: core, io, spectrum"
  build/$sanitizer/tests/core_test --gtest_brief=1
done
