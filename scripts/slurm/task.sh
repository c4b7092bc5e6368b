#!/usr/bin/env bash
# One task of a job array: runs one share of the command in its arguments. The number of the task is that of the share.
# scripts/slurm/submit passes this script to sbatch; see docs/farm.md.
#
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@60
#
#   task.sh PART_NAME|- COMMAND...
#
#   PART_NAME  output file of the share, with %I in place of its number, or - if the command names its outputs itself
set -euo pipefail

part=$1
shift
# The numbers of an array's tasks may begin anywhere, but those of shares begin at 0.
index=$((SLURM_ARRAY_TASK_ID - SLURM_ARRAY_TASK_MIN)) count=$SLURM_ARRAY_TASK_COUNT
words=("$@" --share "$index/$count" --threads "${SLURM_CPUS_PER_TASK:-1}" --quiet)
if [[ $part != - ]]; then words+=(-o "${part//%I/$index}"); fi

"${words[@]}" &
child=$!
# Slurm sends its signals to this shell, which passes them on. The command then saves its state and exits with 75.
trap 'kill -USR1 "$child" 2>/dev/null || true' USR1 TERM
code=0
wait "$child" || code=$?
while kill -0 "$child" 2>/dev/null; do
    code=0
    wait "$child" || code=$?
done
if ((code == 75)); then
    scontrol requeue "${SLURM_ARRAY_JOB_ID}_${SLURM_ARRAY_TASK_ID}"
fi
exit "$code"
