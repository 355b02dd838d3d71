#!/usr/bin/env bash
# Makes tables and figures of the papers in draft quality and fails if a verdict is worse than in
# reproduce/summary.json. The page stays in build/reproduction; what the same program made there before
# is not made again. With keep, all are made, and the verdicts become those of reproduce/summary.json.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# = 0 ] || [ "$*" = keep ] || { echo "usage: $0 [keep]" >&2; exit 2; }
source ./setup.sh
install_packages "${build_packages[@]}" "${test_packages[@]}"
use_compiler_cache
cmake --preset test >/dev/null
cmake --build --preset test --target lamina_command >/dev/null
if [ $# = 1 ]; then
  build/test/lamina reproduce -o build/reproduction
  cp build/reproduction/summary.json reproduce/summary.json
  python3 tools/docs/write_pages.py build/test/lamina
else
  build/test/lamina reproduce -o build/reproduction --resume --before reproduce/summary.json
fi
