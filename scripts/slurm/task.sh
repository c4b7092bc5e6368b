#!/usr/bin/env bash
# One task of a job array: the share that its number says, of the command in its arguments. What scripts/slurm/submit
# hands to sbatch; see docs/farm.md.
#
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@60
#
#   task.sh PART_NAME|- COMMAND...
#
#   PART_NAME  output of the share, with %I for its number; -: the command names its outputs itself
set -euo pipefail

part=$1
shift
# Numbers of arrays may begin anywhere: shares begin at 0.
index=$((SLURM_ARRAY_TASK_ID - SLURM_ARRAY_TASK_MIN)) count=$SLURM_ARRAY_TASK_COUNT
words=("$@" --share "$index/$count" --threads "${SLURM_CPUS_PER_TASK:-1}" --quiet)
if [[ $part != - ]]; then words+=(-o "${part//%I/$index}"); fi

"${words[@]}" &
child=$!
# Slurm's signals reach this shell: the command saves what it has and ends with 75.
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
