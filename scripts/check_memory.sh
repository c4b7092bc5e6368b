#!/usr/bin/env bash
# Traces a scene at 3840x2160 px into a sample file of more than three records per pixel, makes its pinhole image and
# focuses it. Prints the peak memory and the processor time of each command, and fails if a peak exceeds 1.5 GiB.
#
#   scripts/check_memory.sh [METHOD...]
#
#   METHOD   method of `focus`, which runs at f/8 and f/1.8 (default: scatter)
#   POSTLENS the program (environment variable; default: build/release/apps/postlens)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

limit_bytes=$((3 << 29))
postlens=${POSTLENS:-build/release/apps/postlens}
if [[ ! -x $postlens ]]; then
    echo "check_memory.sh: $postlens is missing; build it with scripts/build.sh" >&2
    exit 1
fi
methods=("$@")
((${#methods[@]} > 0)) || methods=(scatter)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

failures=0
# measured NAME COMMAND...: runs a command, saves its JSON report, and compares its peak memory with the limit.
measured() {
    local name=$1 peak cpu
    shift
    TIMEFORMAT='%U %S'
    cpu=$({ time "$postlens" "$@" --json >"$folder/json" 2>"$folder/said"; } 2>&1) || {
        cat "$folder/said" >&2
        exit 1
    }
    peak=$(sed -nE 's/^ *"peak_memory_bytes": ([0-9]+).*/\1/p' "$folder/json")
    echo "$name: peak $((peak >> 20)) MiB of $((limit_bytes >> 20)), CPU seconds (user, system): $cpu"
    ((peak <= limit_bytes)) || failures=$((failures + 1))
}

frame=$folder/frame.exr
measured trace trace samples/scenes/still_life.toml -o "$frame" --size 3840x2160 --subdivide 1
records=$(sed -nE 's/^ *"records": ([0-9]+).*/\1/p' "$folder/json")
echo "records: $records, $((100 * records / (3840 * 2160))) for 100 pixels"
if ((records < 3 * 3840 * 2160)); then
    echo "check_memory.sh: too few records (got $records; expected 3 a pixel)" >&2
    exit 1
fi
measured image image "$frame" -o "$folder/image.exr"
for method in "${methods[@]}"; do
    for f_number in 8 1.8; do
        measured "focus --method $method --f-number $f_number" \
            focus "$frame" -o "$folder/focus.exr" --f-number "$f_number" --focus 1.5 --method "$method"
    done
done
if ((failures > 0)); then
    echo "check_memory.sh: $failures above $((limit_bytes >> 20)) MiB" >&2
    exit 1
fi
echo "check_memory.sh: all within $((limit_bytes >> 20)) MiB"
