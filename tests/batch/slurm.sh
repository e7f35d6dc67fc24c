#!/usr/bin/env bash
# A batch on Slurm: a controller and two nodes on this machine's loopback, in a directory of their own. A shard is killed in
# mid-run, then a node with its work, then the controller; what is merged has to be the same bytes as that of one process
# on one machine.
# Usage: SINEW_SLURM=1 tests/batch/slurm.sh SINEW. As root (slurmd starts tasks as their owner). Takes two minutes, most of them
# until Slurm misses its node. Ends with 77, skipped, where Slurm is not installed (tools/setup.sh --farm), where its daemons
# do not come up, or where SINEW_SLURM is not set.
set -euo pipefail
sinew=$(realpath "$1")
[ -n "${SINEW_SLURM:-}" ] || { echo "skipped: for tests/run.sh --all (SINEW_SLURM=1)"; exit 77; }
for program in munged slurmctld slurmd sbatch squeue scontrol; do
  command -v $program >/dev/null || { echo "skipped: $program is not installed (tools/setup.sh --farm)"; exit 77; }
done
[ "$(id -u)" -eq 0 ] || { echo "skipped: this needs root"; exit 77; }

farm=$(mktemp -d)
export SLURM_CONF=$farm/slurm.conf
port=$((20000 + $$ % 20000))
declare -A daemons
failure=1

kill_tree() {  # kill_tree PID: with all that it started
  local child
  for child in $(ps -o pid= --ppid "$1"); do kill_tree "$child"; done
  kill -9 "$1" 2>/dev/null || true
}

kill_node() {  # kill_node NODE: its daemon and all that runs on it, as if its machine were switched off
  local script step
  kill -9 "${daemons[$1]}" 2>/dev/null || true
  for script in $(ps -e -o pid=,args= | awk -v spool="$farm/$1/" 'index($0, spool) && !/awk/ {print $1}'); do
    step=$(ps -o ppid= -p "$script" | tr -d ' ' || true)
    if [ -n "$step" ] && ps -o args= -p "$step" | grep -q '^slurmstepd: '; then
      kill_tree "$step"  # Slurm's own process for the task
    else
      kill_tree "$script"
    fi
  done
}

end() {
  local name
  for name in n1 n2; do [ -z "${daemons[$name]:-}" ] || kill_node $name; done
  for name in "${!daemons[@]}"; do kill -9 "${daemons[$name]}" 2>/dev/null || true; done
  sleep 0.5
  rm -rf "$farm"
}
trap end EXIT

configure() {
  mkdir -p "$farm"/{munge,state,n1,n2}
  chmod 755 "$farm" "$farm"/munge
  head -c 1024 /dev/urandom >"$farm/munge/key"
  chmod 400 "$farm/munge/key"
  cat >"$SLURM_CONF" <<END
ClusterName=loopback
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=$port
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$farm/munge/socket
CryptoType=crypto/munge
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
StateSaveLocation=$farm/state
SlurmdSpoolDir=$farm/%n
SlurmctldPidFile=$farm/slurmctld.pid
SlurmdPidFile=$farm/%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SlurmdParameters=config_overrides
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdTimeout=5
SlurmctldTimeout=5
KillWait=2
MinJobAge=300
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0,bf_interval=1
NodeName=n[1-2] NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=[$((port + 1))-$((port + 2))] CPUs=1 State=UNKNOWN
PartitionName=all Nodes=n[1-2] Default=YES MaxTime=INFINITE State=UP
END
}

start() {  # start NAME COMMAND…
  local name=$1
  shift
  "$@" >>"$farm/$name.log" 2>&1 &
  daemons[$name]=$!
  disown  # or the shell reports those that are killed here
}

start_farm() {
  start munged munged --foreground --force --key-file "$farm/munge/key" --socket "$farm/munge/socket" \
    --pid-file "$farm/munge/pid" --log-file "$farm/munge/log" --seed-file "$farm/munge/seed"
  failure=77  # Slurm's own failure, not ours
  until_true 10 "munged" test -S "$farm/munge/socket"
  start slurmctld slurmctld -D -f "$SLURM_CONF"
  start n1 slurmd -D -N n1 -f "$SLURM_CONF"
  start n2 slurmd -D -N n2 -f "$SLURM_CONF"
  until_true 60 "two idle nodes" sh -c '[ "$(sinfo -h -o %D -t idle)" = 2 ]'
  failure=1
}

until_true() {  # until_true SECONDS WHAT COMMAND…
  local seconds=$1 what=$2 end=$((SECONDS + $1))
  shift 2
  until "$@" >/dev/null 2>&1; do
    if [ $SECONDS -ge $end ]; then
      echo "slurm: no $what within $seconds s" >&2
      squeue -r 2>&1 | tail -n 30 >&2 || true
      tail -n 20 "$farm"/*.log "$farm"/run/slurm/*.log >&2 || true
      exit $failure
    fi
    sleep 0.2
  done
}

write_work() {  # 48 small sources, one of which is none
  mkdir "$farm/art"
  for k in $(seq 47); do
    printf 'HIERARCHY\nROOT hip\n{\nOFFSET 0 0 0\nCHANNELS 3 Xrotation Yrotation Zrotation\nJOINT knee\n{\nOFFSET 0 -50 0\nCHANNELS 3 Xrotation Yrotation Zrotation\nEnd Site\n{\nOFFSET 0 -50 0\n}\n}\n}\nMOTION\nFrames: 3\nFrame Time: 0.1\n0 0 0 0 0 0\n0 0 0 %d 0 0\n0 0 0 0 0 0\n' "$k" \
      >"$farm/art/walk$k.bvh"
  done
  echo "no motion" >"$farm/art/bad.bvh"
  cat >"$farm/manifest.json" <<END
{"shard_seconds": 6, "jobs": [
  {"convert": "art", "seconds": 1},
  {"render": ["art/walk1.bvh", "art/walk2.bvh"], "ending": ".png", "seconds": 1, "arguments": ["--size", "64x64"]},
  {"study": "talk --quick --scene torque_limit", "seconds": 1}]}
END
}

configure
write_work
"$sinew" batch plan "$farm/manifest.json" -o "$farm/alone"
"$sinew" batch run "$farm/alone" -q -j 1 || [ $? = 1 ]
"$sinew" batch merge "$farm/alone" || [ $? = 1 ]
echo "one machine: $SECONDS s"
start_farm
echo "farm is up: $SECONDS s"
"$sinew" batch plan "$farm/manifest.json" -o "$farm/run"
"$sinew" batch submit "$farm/run"
until_true 60 "running task on n2" sh -c '[ -n "$(squeue -h -r -o %N -t RUNNING | grep n2)" ]'
sleep 0.5
for shard in $(ps -e -o pid=,args= | awk -v run="batch run $farm/run" 'index($0, run) && !/awk/ {print $1}' | head -n 1); do
  kill -9 "$shard" && echo "a shard killed: $SECONDS s"  # its task runs it again
done
sleep 0.3
kill_node n2
echo "node n2 killed: $SECONDS s"
sleep 6  # the controller writes down within five seconds what it was given, and loses what it has not yet
kill -9 "${daemons[slurmctld]}"
echo "controller killed: $SECONDS s"
sleep 1
start slurmctld slurmctld -D -f "$SLURM_CONF"
until_true 60 "controller" scontrol ping
"$sinew" batch status "$farm/run" -q || [ $? = 4 ]
until_true 60 "dead node noticed" sh -c '[ -n "$(sinfo -h -n n2 -t down)" ]'
squeue -r -o '%i %T %r %S' || true
start n2 slurmd -D -N n2 -f "$SLURM_CONF"
# What an administrator does who is in a hurry. Slurm holds what it has requeued for two minutes. And a controller that has
# lost its last seconds starts a task anew that is running; its node refuses that ("already running"), and both are held.
release() {
  local job node
  for job in $(squeue -h -r -o '%i %r' -t PENDING | awk '$2 == "BeginTime" {print $1}'); do
    scontrol update "jobid=$job" starttime=now || true
  done
  for job in $(squeue -h -r -o '%i %r' -t PENDING | awk '/held/ {print $1}'); do scontrol release "$job" || true; done
  for node in $(sinfo -h -N -o %n -t drained,draining,drng,drain); do scontrol update "nodename=$node" state=resume || true; done
}
finished() {
  release
  [ -z "$(squeue -h)" ] && [ -e "$farm/run/merged/report.json" ]
}
until_true 300 "end of all jobs" finished
echo "merged: $SECONDS s"
"$sinew" batch status "$farm/run" || [ $? = 1 ]
diff -r "$farm/alone/merged" "$farm/run/merged"
[ "$(find "$farm/run/merged" -type f | wc -l)" -eq 51 ]
echo "slurm: the same $(find "$farm/run/merged" -type f | wc -l) files, $SECONDS s"

# What Slurm itself takes: 20 tasks that do nothing, on two slots.
begin=$(date +%s%N)
sbatch -Q --array=1-20 --output=/dev/null --wait --wrap true
echo "slurm: $((($(date +%s%N) - begin) / 10000000)) ms per task and slot"
