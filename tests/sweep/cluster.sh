#!/usr/bin/env bash
# A sweep on Slurm: slurmctld, slurmd and munged on this machine, a job array of eight tasks. One task is killed, the node
# is killed and comes back, the tasks are requeued; the merged table has the bytes of a run on one core.
#
# usage: tests/sweep/cluster.sh HEADPIN TRIAL (as root)
set -euo pipefail
headpin=$(realpath "$1") trial=$(realpath "$2")
folder=$(mktemp -d)
chmod 755 "$folder"
host=$(hostname -s)
end() {
  local name
  for name in slurmd slurmctld munged; do
    [ ! -e "$folder/$name.pid" ] || kill "$(cat "$folder/$name.pid")" 2>/dev/null || true
  done
  sleep 1
  [ -n "${KEEP:-}" ] || rm -rf "$folder"
}
trap end EXIT

mkdir -p "$folder/munge" "$folder/state" "$folder/spool"
head -c 1024 /dev/urandom >"$folder/munge/key"
chmod 700 "$folder/munge"
chmod 400 "$folder/munge/key"
chown -R munge:munge "$folder/munge"
touch "$folder/munged.pid"
chown munge:munge "$folder/munged.pid"
install -d -o munge -g munge -m 755 "$folder/run"
runuser -u munge -- munged --key-file="$folder/munge/key" --socket="$folder/run/socket" \
  --log-file="$folder/munge/log" --seed-file="$folder/munge/seed" --pid-file="$folder/run/munged.pid"
cp "$folder/run/munged.pid" "$folder/munged.pid"
ports=$(python3 -c 'import socket
all = [socket.socket() for _ in range(2)]
for one in all: one.bind(("127.0.0.1", 0))
print(*(one.getsockname()[1] for one in all))')
cat >"$folder/slurm.conf" <<EOT
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/run/socket
CryptoType=crypto/munge
SlurmctldPort=${ports% *}
SlurmdPort=${ports#* }
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
ReturnToService=2
SlurmdTimeout=5
MinJobAge=3000
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=p Nodes=ALL Default=YES State=UP MaxTime=INFINITE
EOT
export SLURM_CONF="$folder/slurm.conf"
slurmctld -f "$SLURM_CONF"
slurmd -f "$SLURM_CONF"
until sinfo -h -o %T 2>/dev/null | grep -qE '^(idle|mixed|allocated)$'; do sleep 0.2; done

cd "$folder"
cp "$trial" throw.lcmlog
cat >sweep.toml <<EOT
trials = ['throw.lcmlog']
[grid]
elasticity = {from = 0, to = 1, steps = 20}
friction = {from = 0, to = 1, steps = 20}
EOT
for name in alone cluster; do "$headpin" sweep plan sweep.toml -o $name >/dev/null; done
"$headpin" sweep run alone --jobs 1 >/dev/null
"$headpin" sweep merge alone -o alone.csv >/dev/null
"$headpin" sweep slurm cluster --tasks 8 --minutes 30 >slurm.txt
job=$(sbatch --parsable cluster/sweep.sbatch)
merge=$(sbatch --parsable --dependency=afterok:"$job" cluster/merge.sbatch)

pieces() { find cluster/pieces -name '*.csv' | wc -l; }
running() { squeue -h -j "$job" -t running -o %i 2>/dev/null | head -n 1; }
until [ "$(pieces)" -ge 4 ]; do sleep 0.1; done
task=$(running)
[ -z "$task" ] || scontrol requeue "$task"           # a task that is taken away and begins again
until [ "$(pieces)" -ge 12 ]; do sleep 0.1; done
echo "the node is killed with $(pieces) pieces there"
pkill -KILL -F "$folder/slurmd.pid"
pkill -KILL -f "sweep run $folder/cluster" || true
until sinfo -h -o %T | grep -qE '^down|^drain'; do sleep 0.5; done
slurmd -f "$SLURM_CONF"
until [ -z "$(squeue -h -j "$job,$merge" 2>/dev/null)" ]; do sleep 0.5; done
scontrol -o show job "$job" | grep -o 'JobState=[A-Z]*' | sort | uniq -c
cmp alone.csv cluster/results.csv
echo "400 rows, 8 tasks, a task and the node killed: the same bytes as on one core"
