#!/usr/bin/env bash
# Fuzzes every reader of files, and one target that runs tiny cases behind them, each for so long:
#   tools/fuzz.sh SECONDS [TARGET...]           as in tests/fuzz, without _fuzz; all of them
#   RUNS=1000000 tools/fuzz.sh SECONDS ...      ... or until so many runs were made
# Several at a time. The corpora are those of tests/inputs, and what is found is added to
# build/fuzz/corpus. Prints a line per target; a crash, a hang (120 s) or more than 2 GiB ends it
# with 1, and the input is in build/fuzz: LAMINA_FUZZ_TARGET=obj build/asan/tests/fuzz_targets INPUT
# runs it again.
set -euo pipefail
cd "$(dirname "$0")/.."
source ./setup.sh
install_packages "${build_packages[@]}" "${test_packages[@]}" "${sanitize_packages[@]}"
seconds=${1:?usage: tools/fuzz.sh SECONDS [TARGET...]}
shift
targets=("$@")
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(cd tests/fuzz && ls ./*_fuzz.cpp | sed 's|.*/||; s|_fuzz.cpp||')

cmake --preset asan >/dev/null
cmake --build --preset asan --target fuzz_targets lamina_command
mkdir -p build/fuzz/corpus build/fuzz/seeds
export LAMINA_CACHE=off seconds RUNS="${RUNS:--1}"

# Seeds of formats that no file in the tree is of.
seeds=build/fuzz/seeds
mkdir -p $seeds/merge $seeds/cache $seeds/envi $seeds/image $seeds/job
if [ ! -e $seeds/merge/0.shard ]; then
  render() { build/asan/lamina render scenes/bumpy.json --width 4 --samples 4 "$@" >/dev/null; }
  render --method probe --profile diffusion --shard 0/2 -o $seeds/merge/0.shard
  build/asan/lamina photons marble --photons 100 --shard 0/2 --json $seeds/merge/photons.json >/dev/null
  render --method hierarchy --profile diffusion --cache $seeds/light.ply -o $seeds/picture.png
  { printf '\003'; cat $seeds/light.ply; } >$seeds/cache/light
  { cat tests/inputs/capture/good/leaf.hdr; printf '\0'; cat tests/inputs/capture/good/leaf.raw; } >$seeds/envi/leaf
  cp tests/inputs/*/good/*.png $seeds/image
  printf '%s\0prepare 0 16\nshards 0 17\nmerge 0 18\n\0start a 7 1\nend 1 9\n\0start a 7 1\n\00017 0 R\n17 1 PD\n18 N/A PD\n' \
    '{"lamina":"job","version":1,"command":"render s.json","shards":4}' >$seeds/job/submitted
fi

fuzz() {
  target=$1
  mkdir -p build/fuzz/corpus/"$target"
  folders=(build/fuzz/corpus/"$target")
  for folder in tests/inputs/"$target"/good tests/inputs/"$target"/bad build/fuzz/seeds/"$target"; do
    [ -d "$folder" ] && folders+=("$folder")
  done
  case $target in
    obj|gltf|materialx) folders+=(tests/inputs/scene/good) ;;
    csv) folders+=(tests/inputs/measurement/good) ;;
  esac
  log=build/fuzz/$target.log
  # The library keeps threads for its work, of which one suffices here.
  if LAMINA_FUZZ_TARGET=$target build/asan/tests/fuzz_targets -max_total_time="$seconds" -runs="$RUNS" -timeout=120 \
    -rss_limit_mb=2048 -max_len=65536 -artifact_prefix=build/fuzz/"$target"_ -print_final_stats=1 \
    "${folders[@]}" >"$log" 2>&1; then
    awk -v t="$target" '/number_of_executed_units/ {runs = $2} / cov: / {for (i = 1; i < NF; ++i) if ($i == "cov:") cov = $(i + 1)}
      END {printf "%-12s %9d runs, %6d edges\n", t, runs, cov}' "$log"
  else
    echo "failed: $target"
    tail -n 40 "$log"
    exit 1
  fi
}
export -f fuzz
printf '%s\n' "${targets[@]}" | xargs -P "$(nproc)" -I {} bash -c 'fuzz {}'
