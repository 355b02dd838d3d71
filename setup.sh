#!/usr/bin/env bash
# What lamina needs, by package name. Sourced by demo.sh and test.sh: `install_packages NAME...`
# installs those that are missing; `build_packages` is what every build needs.
set -euo pipefail

build_packages=(g++ cmake ninja-build libtbb-dev libeigen3-dev libfmt-dev nlohmann-json3-dev
  libcli11-dev libhwy-dev libembree-dev libopenexr-dev libpng-dev libjpeg-dev libtiff-dev liblcms2-dev libopencolorio-dev
  python3-dev python3-numpy pybind11-dev)
test_packages=(ccache libbenchmark-dev libgtest-dev librapidcheck-dev python3 python3-jsonschema
  python3-pytest python3-hypothesis python3-matplotlib python3-xarray mypy mkdocs-material
  python3-build python3-setuptools python3-wheel)
tidy_packages=(clang-19 clang-tidy-19)
sanitize_packages=(clang-19 libclang-rt-19-dev)

install_packages() {
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "This system has no apt. Please install what these Debian 12 packages hold, then build with" >&2
    echo "  cmake --preset release && cmake --build --preset release" >&2
    echo "  $*" >&2
    [ "${LAMINA_SKIP_PACKAGES:-}" = 1 ] && return 0
    echo "and run this again with LAMINA_SKIP_PACKAGES=1." >&2
    exit 2
  fi
  local missing=() name
  for name in "$@"; do
    dpkg-query -W -f '${Status}' "$name" 2>/dev/null | grep -q 'ok installed' || missing+=("$name")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  local sudo=""
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "Please install as root: ${missing[*]}" >&2; exit 2; }
    sudo=sudo
  fi
  echo "Installing: ${missing[*]}"
  $sudo apt-get update -qq
  $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

# Compilations that any checkout made before are found again, also in another folder.
use_compiler_cache() {
  command -v ccache >/dev/null || return 0
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros
}
