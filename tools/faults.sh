#!/usr/bin/env bash
# Makes the machine fail under the command, at length; docs/measurements/reliability.md has the counts:
#   tools/faults.sh [faults] [kills] [threads]     all three unless named
# Calls of the system that fail (FIRST of each kind, then LATER at random, 300 each), 200 kills, and
# 1, 2 and 64 threads.
set -euo pipefail
cd "$(dirname "$0")/.."
source ./setup.sh
install_packages "${build_packages[@]}" "${test_packages[@]}"
cmake --preset test >/dev/null
cmake --build --preset test --target lamina_command lamina_faults
lamina=build/test/lamina
for part in "${@:-faults kills threads}"; do
  for name in $part; do
    echo "== $name"
    case $name in
      faults) python3 tests/faults/fault_runs.py $lamina "$(ls build/test/tests/liblamina_faults.*)" . \
        --first "${FIRST:-300}" --later "${LATER:-300}" ;;
      kills) python3 tests/faults/kill_runs.py $lamina . --kills 200 ;;
      threads) python3 tests/faults/thread_runs.py $lamina . ;;
      *) echo "faults, kills or threads, not $name" >&2; exit 2 ;;
    esac
  done
done
