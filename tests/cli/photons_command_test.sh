#!/bin/sh
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# photons_command_test.sh LAMINA SOURCE PYTHON: lamina photons and lamina merge as their users call them.
set -eu
lamina=$1 source=$2 python=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# Refuses wrong use with code 2 and a line that names the option.
refuses() {
  expected=$1
  shift
  code=0
  "$lamina" "$@" > out 2> err || code=$?
  [ $code -eq 2 ] && grep -q -e "$expected" err && [ "$(wc -l < err)" -eq 1 ] && return
  echo "lamina $*: code $code, not refused with '$expected':" && cat err && exit 1
}

skin="photons donner_jensen_skin --seed 3"
"$lamina" $skin --photons 2e4 --tally r,angle,rz,orders,time --frequency 200 --counts --json whole.json > /dev/null
for shard in 0 1 2; do
  "$lamina" $skin --photons 2e4 --tally r,angle,rz,orders,time --frequency 200 --shard $shard/3 --json $shard.json > /dev/null
done
"$lamina" merge 2.json 0.json 1.json --json merged.json > /dev/null
"$python" - <<'END'
import json
whole, merged = json.load(open("whole.json")), json.load(open("merged.json"))
assert merged.pop("command") == "merge" and whole.pop("command") == "photons"
assert whole == merged, "the shards do not add up to the run"
assert len(whole["absorption"]) == 100 and len(whole["absorption"][0][0]) == 3
assert len(whole["standard_error"]["by_order_reflected"]) == 12
assert len(whole["radial_time_reflected"]) == 100 and len(whole["radial_time_reflected"][0]) == 100
assert len(whole["radial_phase_rad_reflected"]) == 100 and len(whole["mean_layer_path_reflected_mm"]) == 3
END
"$lamina" $skin --photons 1e3 --tally r,angle,time --plot plot.svg > /dev/null
grep -q "</svg>" plot.svg
"$lamina" photons "$source/tests/inputs/mcml/good/two_runs.mci" --photons 1000 > /dev/null
[ -s skin.mco ] && [ -s glass.mco ]

refuses "photons: must be a whole number" $skin --photons 0
"$lamina" merge 2.json 0.json --json part.json > /dev/null 2> warning
grep -q "1 of 3 shards are missing: 1/3" warning || { echo "merge must say which shards are missing"; exit 1; }
refuses "shard: must be I/N" $skin --shard 3/3
refuses "shard: needs --json FILE" $skin --shard 0/3
refuses "must be different files, but both are" $skin --tally r --plot same.svg --json ./same.svg
refuses "must be different files, but both are 0.json" merge 0.json 1.json --json 0.json
refuses 'did you mean "angle"' $skin --tally angel
refuses "must fit in 4 GiB, but need" $skin --tally rz --r-bins 100000 --z-bins 100000
refuses "tallies: " $skin --tally bsdf,orders,path --bsdf-cosines 900000013 --bsdf-azimuths 854015917 \
  --path-bins 28292772
refuses "incidence: must be normal" $skin --incidence 90
refuses "d_zero.mci:9: run 1, layer 1: d must be" photons "$source/tests/inputs/mcml/bad/d_zero.mci"
refuses "is given twice" merge 0.json 0.json
refuses "is given twice" merge part.json 0.json
"$lamina" merge part.json 1.json --json late.json > /dev/null
cmp late.json merged.json || { echo "parts that were merged must merge on"; exit 1; }
refuses "seed: must be a whole number" photons donner_jensen_skin --seed 18446744073709551616
refuses "a file of sums must have less than" $skin --tally rz,fluence --r-bins 2000 --z-bins 1000 --counts
refuses "needs --checkpoint" $skin --resume
refuses "must hold \"counts\"" merge "$source/CMakePresets.json"
