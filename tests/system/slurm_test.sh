#!/usr/bin/env bash
# scripts/slurm on a Slurm of the test's own, on this machine: a film, a sweep and a render's samples in shares, with a
# task that is killed and taken up again and a node that is drained meanwhile; compared with undivided runs bit for bit.
# Ends with 77, and says so, where Slurm is not installed or the user is not root, as whom its daemons run here.
#
#   slurm_test.sh POSTLENS SOURCE_DIR
set -euo pipefail

postlens=$1 source_dir=$2
export PATH=$PATH:/usr/sbin
for program in munged slurmctld slurmd sbatch scontrol; do
    if ! command -v "$program" >/dev/null; then
        echo "skipped: $program is not installed (scripts/install_dependencies.sh --for peers)"
        exit 77
    fi
done
if ((EUID != 0)); then
    echo "skipped: the daemons of Slurm need root here"
    exit 77
fi
# munged insists that nobody but root may change its folder.
folder=$(mktemp -d)
chmod 755 "$folder"
daemons=()
finish() {
    local code=$?
    ((code == 0)) || tail -n 15 "$folder"/log/* "$folder"/work/slurm-*.out 2>/dev/null || true
    # In the opposite order, each by its own number.
    for ((i = ${#daemons[@]} - 1; i >= 0; --i)); do
        kill "${daemons[i]}" 2>/dev/null || true
        wait "${daemons[i]}" 2>/dev/null || true
    done
    rm -rf "$folder"
}
trap finish EXIT
mkdir "$folder"/{state,spool,log,work}
(umask 077 && head -c 128 /dev/urandom >"$folder/munge.key")
node=$(hostname -s)
ports=$((20000 + $$ % 20000))
cat >"$folder/slurm.conf" <<CONF
ClusterName=postlens
SlurmctldHost=$node(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
SlurmctldPort=$ports
SlurmdPort=$((ports + 1))
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/log/slurmctld
SlurmdLogFile=$folder/log/slurmd
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
KillWait=10
SchedulerParameters=batch_sched_delay=1,sched_interval=2
RequeueExit=75
NodeName=$node NodeAddr=127.0.0.1 CPUs=2 RealMemory=4096 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$folder/slurm.conf
munged --force --foreground --key-file="$folder/munge.key" --socket="$folder/munge.socket" --pid-file="$folder/munged.pid" \
    --log-file="$folder/log/munged" --seed-file="$folder/munge.seed" 2>"$folder/log/munged.err" &
daemons+=($!)
wait_until() {
    local i
    for ((i = 0; i < $1 * 4; ++i)); do
        if "${@:2}" >/dev/null 2>&1; then return; fi
        sleep 0.25
    done
    echo "slurm_test.sh: waited ${1} s in vain for: ${*:2}" >&2
    return 1
}
wait_until 20 test -S "$folder/munge.socket"
slurmctld -D -f "$SLURM_CONF" >"$folder/log/slurmctld.out" 2>&1 &
daemons+=($!)
wait_until 30 scontrol ping
slurmd -D -f "$SLURM_CONF" -N "$node" >"$folder/log/slurmd.out" 2>&1 &
daemons+=($!)
is_idle() { [[ $(sinfo -h -o %T) == idle ]]; }
wait_until 60 is_idle
nothing_queued() { [[ -z $(squeue -h) ]]; }
running() { [[ -n $(squeue -h -t R -j "$1") ]]; }

cd "$folder/work"
scenes=$source_dir/samples/scenes
lens=(--f-number 1.4 --focus 5)
submit() { "$source_dir/scripts/slurm/submit" "$@" 2>>"$folder/log/submitted"; }

# A film of 12 frames, whose first task is killed as it runs and requeued, and whose node is drained meanwhile.
film=("$postlens" render "$scenes/motion.toml" --size 96x54 --spp 192 --frames 0-11)
"${film[@]}" -o 'whole.%04d.exr' --quiet
job=$(submit --shares 4 "${film[@]}" -o 'film.%04d.exr')
wait_until 60 running "${job}_0"
scontrol requeue "${job}_0"
scontrol update NodeName="$node" State=DRAIN Reason=test
sleep 2
scontrol update NodeName="$node" State=RESUME
# A sweep of 24 lenses, and 8 shares of a render's samples, queued behind it.
"$postlens" trace "$scenes/bars.toml" -o frame.exr --size 96x54 --for-f-number 1.4 --for-focus 1 --quiet
sweep=("$postlens" sweep frame.exr --f-number 1.4,2,2.8,4,5.6,8 --focus 1,2,5,10 --method scatter)
"${sweep[@]}" -o whole_sweep --quiet
submit --shares 4 "${sweep[@]}" -o sweep >/dev/null
rays=("$postlens" render "$scenes/bars.toml" --size 160x90 --spp 1024 "${lens[@]}")
"${rays[@]}" -o whole.exr --quiet
job=$(submit --shares 8 --by-samples "${rays[@]}" -o rays.exr | head -n 1)
submit --shares 3 "$postlens" trace "$scenes/bars.toml" --size 96x54 --for-f-number 1.4 --for-focus 1 -o traced.exr >/dev/null
wait_until 300 nothing_queued
for i in 00 01 02 03 04 05 06 07 08 09 10 11; do cmp "whole.00$i.exr" "film.00$i.exr"; done
for file in whole_sweep/*.exr whole_sweep/contact.png; do cmp "$file" "sweep/${file##*/}"; done
[[ $(find whole_sweep -name '*.exr' | wc -l) == 24 ]]
cmp whole.exr rays.exr
cmp frame.exr traced.exr
echo "slurm: a film of 12 frames, a sweep of 24 lenses, a render of 8 shares of samples, a trace of 3: the bits of the undivided runs"
