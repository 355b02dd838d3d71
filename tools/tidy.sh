#!/usr/bin/env bash
# Runs clang-tidy, as .clang-tidy says, on sources that changed: those of the last commits (20, or
# given), or with --all on all of them. Needs a configured build/dev (cmake --preset dev).
set -euo pipefail
cd "$(dirname "$0")/.."
[ -e build/dev/compile_commands.json ] || cmake --preset dev >/dev/null
if [ "${1:-}" = --all ]; then
  mapfile -t files < <(git ls-files 'src/lamina/*.cpp' 'cli/*.cpp')
else
  first=$(git rev-list --max-count=$((${1:-20} + 1)) HEAD | tail -1)
  mapfile -t files < <(git diff --name-only --diff-filter=d "$first" -- 'src/lamina/*.cpp' 'cli/*.cpp')
fi
# What Highway compiles once per instruction set is read by the compiler's own warnings.
kept=()
for file in "${files[@]}"; do
  grep -q foreach_target "$file" || kept+=("$file")
done
[ ${#kept[@]} -eq 0 ] && exit 0
printf '%s\0' "${kept[@]}" | xargs -0 -P "$(nproc)" -n 4 clang-tidy -quiet -p build/dev
