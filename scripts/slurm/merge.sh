#!/usr/bin/env bash
# Merges the parts of a job array after all its tasks; see docs/farm.md.
#
#   merge.sh POSTLENS OUTPUT PART...
set -euo pipefail
program=$1 output=$2
shift 2
exec "$program" merge "$@" -o "$output" --quiet
