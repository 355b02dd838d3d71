#!/usr/bin/env bash
# Runs clang-tidy, as .clang-tidy says, on lamina's own code: all of it, or what lies in folders with
# the given text in their path. Sources are read as a fast build compiles them, several at a time:
# headers, which cost most, are read a tenth as often, and all is checked each time.
set -euo pipefail
cd "$(dirname "$0")/.."
source ./setup.sh
install_packages "${build_packages[@]}" "${tidy_packages[@]}"

cmake --preset tidy >/dev/null
# Headers that the build writes.
ninja -C build/tidy -t targets all | sed -n 's/^\(src.*[.]h\): CUSTOM_COMMAND$/\1/p' | xargs ninja -C build/tidy >/dev/null

check() {
  local findings
  findings=$(clang-tidy-19 -quiet -p build/tidy "$1" 2>&1) && return
  echo "$findings" | grep -v 'warnings.* generated'
  return 1
}
export -f check
sed -nE 's/^ *"file": "(.*)"$/\1/p' build/tidy/compile_commands.json |
  grep -vE '_verify_interface_header_sets/|/nothing\.cpp$' | grep -- "${1:-}" | tac |
  xargs -P "$(nproc)" -I {} bash -c 'check {}'
