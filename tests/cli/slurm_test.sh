#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# A picture and photons in 16 shards under a real Slurm, two of which are killed: the result is bit by bit
# that of one machine. Starts its own munged, slurmctld and slurmd, one node with two slots, in a scratch
# folder; ends with 77, which ctest counts as skipped, where that cannot be.
#   slurm_test.sh LAMINA SCENES
# On Debian: apt install slurm-wlm munge; as root, since slurmd starts jobs for users.
set -euo pipefail
lamina=$1 scenes=$2
PATH=$PATH:/usr/sbin:/sbin
skip() { echo "skipped: $*"; exit 77; }
fail() { echo "FAILED: $*" >&2; exit 1; }
for tool in munged mungekey slurmctld slurmd sbatch squeue sinfo; do
  command -v $tool >/dev/null || skip "$tool is not installed (Debian: slurm-wlm, munge)"
done
[ "$(id -u)" = 0 ] || skip "slurmd has to be started by root"

folder=$(mktemp -d)
chmod 755 "$folder"
finish() {
  local name
  for name in slurmd slurmctld munged; do
    if [ -s "$folder/$name.pid" ]; then kill "$(cat "$folder/$name.pid")" 2>/dev/null || true; fi
  done
  sleep 1
  rm -rf "$folder"
}
trap finish EXIT
cd "$folder"

mungekey --create --keyfile="$folder/key" >/dev/null 2>&1 || skip "mungekey makes no key"
munged --force --key-file="$folder/key" --socket="$folder/munge" --pid-file="$folder/munged.pid" \
  --log-file="$folder/munged.log" --seed-file="$folder/seed" 2>/dev/null || skip "munged does not start"
host=$(hostname -s) port=$((20000 + $$ % 20000))
mkdir state spool
cat >slurm.conf <<END
ClusterName=lamina
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
AuthType=auth/munge
AuthInfo=socket=$folder/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SchedulerParameters=sched_interval=1
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES
END
export SLURM_CONF=$folder/slurm.conf
slurmctld >/dev/null 2>&1 || skip "slurmctld does not start"
slurmd >/dev/null 2>&1 || skip "slurmd does not start"
for ((i = 0; i < 100; i++)); do
  [ "$(sinfo --noheader --format=%t 2>/dev/null)" = idle ] && break
  sleep 0.2
done
[ "$(sinfo --noheader --format=%t 2>/dev/null)" = idle ] || skip "no node: $(tail -n 2 slurmd.log slurmctld.log)"

# Shards 3 and 9 are held when they first run, until the test has killed them.
cat >holding <<END
#!/bin/sh
"$lamina" "\$@" &
process=\$!
for shard in 3/16 9/16; do
  case " \$* " in *" \$shard "*)
    held=$folder/held.\${shard%/16}
    if [ ! -e "\$held" ]; then
      kill -STOP \$process
      echo \$process >"\$held"
    fi ;;
  esac
done
wait \$process
END
chmod +x holding
export LAMINA=$folder/holding

await() {  # await SECONDS WHAT COMMAND...
  local left=$(($1 * 5)) what=$2; shift 2
  until "$@"; do
    ((left-- > 0)) || fail "$what: $("$lamina" status "$job" 2>&1; squeue; cat "$job"/log/* | tail -n 20)"
    sleep 0.2
  done
}
queue_is_empty() { [ -z "$(squeue --noheader)" ]; }

# run JOB COMMAND: in 16 shards, with two killed and redone.
run() {
  job=$1
  rm -f held.*
  echo "\$ lamina submit '$2' --shards 16 --partition main"
  "$lamina" submit "$2" --shards 16 --partition main
  await 60 "shard 3" test -s held.3
  kill -KILL "$(cat held.3)"       # the program: its script notes the exit code
  await 60 "shard 9" test -s held.9
  read -r _ _ script _ <"$job/state/9"
  kill -KILL "$script" "$(cat held.9)"  # all of it, as with its machine
  echo "\$ lamina status $job"
  "$lamina" status "$job"
  await 120 "the rest" queue_is_empty
  echo "\$ lamina status $job"
  "$lamina" status "$job" | tee told
  grep -q '14 of 16 shards done, 0 running, 0 waiting, 2 failed' told || fail "not two shards are missing"
  grep -q '3: failed with exit code 137' told && grep -q '9: killed on' told || fail "not shards 3 and 9"
  local before; before=$(stat -c '%n %Y %i' "$job"/shards/*.shard)
  echo "\$ lamina submit $job"
  "$lamina" submit "$job"
  squeue --array
  await 120 "the redone shards" queue_is_empty
  echo "\$ lamina status $job"
  "$lamina" status "$job" | tee told
  grep -q 'merge: done' told || fail "$(cat "$job/log/merge.log")"
  [ "$before" = "$(stat -c '%n %Y %i' $(sed 's/ .*//' <<<"$before"))" ] || fail "shards were made twice"
}

printf '{ "lamina": "scene", "base": "%s", "render": { "profile": "diffusion", "samples_per_pixel": 32 }, "film": { "width": 64, "height": 60 } }' \
  "$scenes/sphere_skin.json" >scene.json
run picture.job 'render scene.json -o picture'
"$lamina" render scene.json -o whole >/dev/null 2>&1
cmp whole.exr picture.exr && cmp whole.png picture.png || fail "another picture"

photons="photons donner_jensen_skin --photons 200000 --tally r,angle --seed 3"
run photons.job "$photons --json photons.json"
"$lamina" $photons --counts --json whole.json >/dev/null
cmp <(grep -v '"command"' whole.json) <(grep -v '"command"' photons.json) || fail "other photons"
echo "the picture and the photons are those of one machine, bit by bit"
