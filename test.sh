#!/usr/bin/env bash
# Installs what is missing, builds with warnings as errors, runs every test.
set -euo pipefail
cd "$(dirname "$0")"
source ./setup.sh
install_packages "${build_packages[@]}" "${test_packages[@]}"
use_compiler_cache

cmake --preset test
cmake --build --preset test
ctest --preset test -j "$(nproc)"
echo "longest tests, in seconds:"
sed -nE 's/^([^ ]+) [0-9]+ ([0-9.]+)$/\2 \1/p' build/test/Testing/Temporary/CTestCostData.txt | sort -rn | awk 'NR <= 12'
