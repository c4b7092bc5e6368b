#!/usr/bin/env bash
# Compares two folders that results.sh made. The files must be the same bytes, but for what FFTW transforms: it chooses its
# routines by the processor, and single precision rounds each of them elsewhere. Prints what differs, and how far.
#
#   tests/instruction_sets/compare_results.sh DIR REFERENCE [BOUND]
#
#   BOUND  by how much the numbers of a record may differ (default: 0); the pinhole picture of a sample file never may
set -euo pipefail

if (($# < 2 || $# > 3)) || [[ ! -d $1 || ! -d $2 ]]; then
    echo "compare_results.sh: needs two folders (got: $*)" >&2
    exit 2
fi
transformed=convolved.exr
bound=1e-6 # of values of about 1; measured were 1.5e-7
record_bound=${3:-0}

# The largest difference of a part of two OpenEXR files (idiff is silent on equal parts); -1 where they do not compare.
largest() { # part file file
    local told status=0
    told=$(idiff -a -fail 0 -warn 0 "$2" "$3" 2>/dev/null) || status=$?
    if ((status > 2)); then
        echo -1
        return
    fi
    awk -v part="$1" '/^Subimage/ { now = $2 } /Max error/ && now == part { largest = $4 } END { print largest + 0 }' <<<"$told"
}

failures=0
for reference in "$2"/*; do
    name=${reference##*/}
    if cmp -s "$1/$name" "$reference"; then
        continue
    elif [[ $name == "$transformed" ]] && idiff -q -a -fail $bound -warn $bound "$1/$name" "$reference" >/dev/null; then
        echo "  $name: the same to $bound (FFTW)"
    elif [[ $record_bound != 0 && $(largest 0 "$1/$name" "$reference") == 0 ]] &&
        records=$(largest 1 "$1/$name" "$reference") && awk "BEGIN { exit !($records >= 0 && $records <= $record_bound) }"; then
        echo "  $name: the same picture; records differ by up to $records (at most $record_bound)"
    else
        echo "  $name differs"
        failures=$((failures + 1))
    fi
done
((failures == 0))
