#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# Jobs of many shards by their scripts, with a Slurm that only notes what it is asked for.
#   submit_command_test.sh LAMINA SCENES INPUTS
set -euo pipefail
lamina=$1 scenes=$2 inputs=$3 root=$(cd "$2/.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fail() { echo "FAILED: $*" >&2; exit 1; }

# expect CODE TEXT ARGUMENT...: `lamina ARGUMENT...` ends with CODE and prints TEXT.
expect() {
  local code=$1 text=$2 got=0; shift 2
  "$lamina" "$@" >output 2>&1 || got=$?
  [ "$got" = "$code" ] || fail "$*: exit code $got instead of $code: $(cat output)"
  grep -qF -- "$text" output || fail "$*: no '$text' in: $(cat output)"
}

mkdir "it's here" && cd "it's here"
printf '{ "lamina": "scene", "base": "%s", "render": { "profile": "diffusion", "samples_per_pixel": 7 }, "film": { "width": 20, "height": 18 } }' \
  "$scenes/sphere_skin.json" >"a scene.json"

# By hand: nothing without the preparation, then in any order, twice, and only what is missing.
expect 0 'by hand: sh' submit "lamina render 'a scene.json' -o \"my picture\" --denoise --view agx --color-space acescg" --shards 3 --dry-run
job="my picture.job"
for script in prepare shard merge submit; do sh -n "$job/$script.sh"; done
expect 0 '0 of 3 shards done, 0 running, 0 waiting, 0 failed, 3 not started' status "$job"
sh "$job/shard.sh" 1 2>output && fail "a shard without the preparation"
grep -q 'nothing is prepared yet' output || fail "$(cat output)"
sh "$job/prepare.sh" >/dev/null 2>&1
sh "$job/shard.sh" 2 >/dev/null 2>&1
SLURM_ARRAY_TASK_ID=0 sh "$job/shard.sh" >/dev/null 2>&1
stamp=$(stat -c %Y.%i "$job/shards/2.shard")
sh "$job/shard.sh" 2 >output 2>&1
[ "$stamp" = "$(stat -c %Y.%i "$job/shards/2.shard")" ] || fail "a shard was made twice"
expect 0 '2 of 3 shards done' status "$job"
sed -n 's/^  1: not started: //p' output >made.sh  # a shell takes the command as it stands
sh "$job/merge.sh" 2>output && fail "merged without all shards"
grep -q '1 of 3 shards are missing: 1/3' output || fail "$(cat output)"
expect 0 'merge: failed with exit code 2' status "$job"
sh made.sh >/dev/null 2>&1
expect 0 'the merge is left: sh' status "$job"
sh "$job/merge.sh" >/dev/null 2>&1
expect 0 'merge: done' status "$job"
expect 0 'nothing is left to submit' submit "$job"
expect 0 whole render "a scene.json" -o whole --denoise --view agx --color-space acescg
cmp whole.exr "my picture.exr" && cmp whole.png "my picture.png" || fail "shards make another picture"
sh "$job/shard.sh" 3 2>output && fail "a shard that there is not"
grep -q 'usage: sh shard.sh I, with I from 0 to 2' output || fail "$(cat output)"

# Light that is kept is made once.
expect 0 'by hand' submit "render 'a scene.json' --method hierarchy --cache light.ply -o kept.exr" --shards 2 --dry-run
sh kept.job/prepare.sh >/dev/null 2>&1
[ -s light.ply ] || fail "no light"
for i in 0 1; do sh kept.job/shard.sh $i >/dev/null 2>&1; done
sh kept.job/merge.sh >/dev/null 2>&1
expect 0 '' render "a scene.json" --method hierarchy --cache light.ply --cache-only -o whole.exr
cmp whole.exr kept.exr || fail "shards of kept light make another picture"

# Flags of one render's own unfinished picture are none of a shard's, which has --resume.
for flag in --fresh --resume; do
  expect 0 'by hand' submit "render 'a scene.json' $flag -o flag.exr" --shards 2 --dry-run
  sh flag.job/prepare.sh >/dev/null 2>&1
  for i in 0 1; do sh flag.job/shard.sh $i >output 2>&1 || fail "$flag: $(cat output)"; done
  sh flag.job/merge.sh >/dev/null 2>&1 || fail "$flag is not merged"
  rm -r flag.job flag.exr
done

# Photons. One that is killed is told from one that fails, and goes on.
photons="photons donner_jensen_skin --photons 4000 --tally r --seed 3 --json all.json --plot all.svg"
cat >job.json <<END
{ "lamina": "job", "version": 1, "command": "$photons", "shards": 3, "time": "10", "sbatch": ["--account=light"] }
END
expect 0 'by hand' submit job.json --dry-run
sh all.job/shard.sh 0 >/dev/null
echo "start $(uname -n) 999999999 1" >all.job/state/1
LAMINA=/bin/false sh all.job/shard.sh 2 >/dev/null && fail "no failure"
expect 0 '1 of 3 shards done, 0 running, 0 waiting, 2 failed' status all.job --json state.json
grep -q '1: killed on' output && grep -q '2: failed with exit code 1' output || fail "$(cat output)"
grep -q '"merge": "not started"' state.json || fail "$(cat state.json)"
sh all.job/shard.sh 1 >/dev/null
sh all.job/shard.sh 02 >/dev/null  # as seq -w counts
[ "$(cd all.job/shards && echo *)" = "0.shard 1.shard 2.shard" ] || fail "$(ls all.job/shards)"
for wrong in 03 -1 1.0 99999999999999999999; do sh all.job/shard.sh $wrong 2>/dev/null && fail "shard $wrong"; done
[ "$(cd all.job/state && echo *)" = "0 1 2" ] || fail "$(ls all.job/state)"
sh all.job/merge.sh >/dev/null
[ -s all.svg ] || fail "no plot"
eval "$lamina ${photons/all.json/whole.json} --counts" >/dev/null
cmp <(grep -v '"command"' whole.json) <(grep -v '"command"' all.json) || fail "photons of shards differ"

# What Slurm is asked for: the array behind the preparation, the merge behind all.
mkdir bin
cat >bin/sbatch <<'END'
#!/bin/sh
[ "$1" = --version ] && exit 0
echo "${LAMINA_FIRST_SHARD:-} $*" >>asked
wc -l <asked
END
cat >bin/squeue <<'END'
#!/bin/sh
cat "$(dirname "$0")/queue" 2>/dev/null || true
END
chmod +x bin/*
export PATH=$PWD/bin:$PATH
expect 0 'submitted 2500 of 2500 shards' submit 'photons donner_jensen_skin --json big.json' --shards 2500 \
  --partition cpu --time 1:00:00 --memory 2G --cores 2 --sbatch=--account=light
asked() { grep -qF -- "$1" big.job/asked || fail "no '$1' in: $(cat big.job/asked)"; }
asked '0 --parsable --requeue --open-mode=append --job-name=lamina-big --cpus-per-task=2 --partition=cpu --time=1:00:00 --mem=2G --account=light --array=0-999 '
asked '1000 --parsable'; asked '2000 --parsable'; asked '--array=0-499'
asked '--dependency=afterany:1:2:3'
printf '1 999 PD\n1 5 R\n4 N/A PD\n' >bin/queue
expect 0 '0 of 2500 shards done, 1 running, 1 waiting, 0 failed, 2498 not started' status big.job
grep -q 'merge: waiting' output || fail "$(cat output)"
rm bin/queue
LAMINA_FIRST_SHARD=2000 SLURM_ARRAY_TASK_ID=7 LAMINA=/bin/true sh big.job/shard.sh 2>/dev/null || true
[ -e big.job/state/2007 ] || fail "the number of a later array"
seq 0 2499 | sed 's|.*|big.job/shards/&.shard|' | grep -v -e /3.shard -e /1007.shard -e /1008.shard | xargs touch
rm big.job/asked
expect 0 'submitted 3 of 2500 shards' submit big.job
asked '0 --parsable'; asked '--array=3 '; asked '1000 --parsable'; asked '--array=7-8 '
[ "$(wc -l <big.job/asked)" = 3 ] || fail "$(cat big.job/asked)"
printf '#!/bin/sh\n[ "$1" = --version ] || { echo "sbatch: error: invalid partition" >&2; exit 1; }\n' >bin/sbatch
expect 1 'sbatch: error: invalid partition' submit 'photons donner_jensen_skin --json other.json' --shards 2

# Fits of a batch, and items of papers; tiles are in acquire_command_test.py.
mkdir spectra
for name in a b c; do cp "$root/examples/measurements/cuvette.csv" spectra/$name.csv; done
fit="fit $root/examples/measurements/liquid.json --batch spectra"
expect 0 'by hand' submit "$fit -o found.csv" --shards 2 --dry-run
for i in 1 0; do sh found.job/shard.sh $i >/dev/null; done
sh found.job/merge.sh >/dev/null
expect 0 'merge: done' status found.job
expect 0 '' $fit -o whole.csv
cmp whole.csv found.csv || fail "shards of fits make another table"
expect 2 '3 samples can have at most as many shards' submit "$fit -o found.csv" --shards 4
expect 2 '--batch: must name the samples' submit "fit $root/examples/measurements/liquid.json -o x.json" --shards 2
expect 2 '--report: does not go with shards' submit "$fit -o found.csv --report x.html" --shards 2
sed 's/my.item/my.other/' "$inputs/reproduction/good/marble.json" >other.json
items="reproduce $inputs/reproduction/good/marble.json other.json"
expect 0 'by hand' submit "$items -o papers" --shards 2 --dry-run
sh papers.job/shard.sh 1 2>/dev/null >&2
sh papers.job/merge.sh >output 2>&1 && fail "merged without all items"
grep -q '1 of 2 shards are missing' output || fail "$(cat output)"
[ -e papers/my.other/finished.json ] && [ ! -e papers/my.item ] || fail "not the items of the shard"
sh papers.job/shard.sh 0 2>/dev/null >&2
sh papers.job/merge.sh 2>/dev/null >&2
expect 0 'merge: done' status papers.job
expect 0 '' $items -o whole
for item in my.item my.other; do cmp papers/$item/numbers.csv whole/$item/numbers.csv || fail "items of shards have other numbers"; done
expect 2 '2 items can have at most as many shards' submit "$items -o papers" --shards 3
expect 2 'solved as a whole' submit "acquire $inputs/capture/good/bands.json --set population=forearms" --shards 2

# Without Slurm; what cannot be split; and what is not so.
mkdir empty && for tool in sh seq; do ln -s "$(command -v $tool)" empty; done
got=0
PATH=$PWD/empty "$lamina" submit 'photons donner_jensen_skin --json few.json' --shards 2 2>output || got=$?
[ $got = 1 ] && grep -q 'sbatch: there is no such program here.* by hand: seq 0 1' output || fail "$got: $(cat output)"
expect 2 'holds 3 shards of' submit "$photons" --shards 4
expect 2 'the command must be render, photons, fit, acquire or reproduce' submit 'slab donner_jensen_skin' --shards 4
expect 2 '--json: must name the file of the merged result' submit 'photons donner_jensen_skin' --shards 4
expect 2 'there is no option --photonz; did you mean "--photons"' submit 'photons donner_jensen_skin --photonz 3 --json x.json' --shards 4
expect 2 'at most as many shards' submit "render 'a scene.json' -o x" --shards 99
expect 2 '--shards: must say into how many parts' submit "render 'a scene.json' -o x"
expect 2 'must close its quotes' submit "render 'a scene.json -o x" --shards 2
expect 2 'nope.json: there is no such file' submit 'render nope.json' --shards 2
expect 2 '--shard: is for the jobs' submit "render 'a scene.json' --shard 0/2" --shards 2
expect 2 '--time: does not go with shards' submit 'photons donner_jensen_skin --time 3 --json x.json' --shards 2
expect 2 'must hold a job.json' submit empty --shards 2
expect 2 'must be the folder of a job' status empty
while read -r file _ what; do
  [ "$file" = "#" ] || expect 2 "$what" submit "$inputs/job/bad/$file" --dry-run
done <"$inputs/job/bad/expected.txt"
for file in "$inputs"/job/good/*.json; do
  cp "$file" good.json
  expect 0 'by hand' submit good.json --dry-run -o "$(basename "$file" .json).job"
done
for bad in x.job x.exr; do [ ! -e $bad ] || fail "$bad is left over"; done
