#!/usr/bin/env bash
# Builds the libFuzzer targets with clang++ and runs each of them on randomly changed copies of files of the repository.
# Fails if an input causes a crash, a report of a sanitizer, more than 10 s of processor time, or more than 1 GB of
# memory. The input is then stored in build/fuzz/findings.
#
#   scripts/fuzz.sh [SECONDS [TARGET...]]
#
#   SECONDS  duration for each target (default: 60)
#   TARGET   for example sample_file_fuzz (default: all in fuzz/)
#   FUZZ_SEED  environment variable: seed of the random changes (default: a different seed in each run)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

seconds=${1:-60}
if ! [[ $seconds =~ ^[1-9][0-9]*$ ]]; then
    echo "fuzz.sh: not a number of seconds (got '$seconds'; expected 1 or more)" >&2
    exit 2
fi
mapfile -t all < <(cd fuzz && ls -- *_fuzz.cpp | sed 's/\.cpp$//')
targets=("${@:2}")
((${#targets[@]} > 0)) || targets=("${all[@]}")
for target in "${targets[@]}"; do
    if [[ ! -f fuzz/$target.cpp ]]; then
        echo "fuzz.sh: no such target (got $target; expected some of: ${all[*]})" >&2
        exit 2
    fi
done

scripts/install_dependencies.sh --for fuzzing
# The program makes sample files and a part of an image as seeds, because the repository contains none.
postlens=build/release/apps/postlens
[[ -x $postlens ]] || scripts/build.sh --for fuzzing release postlens
# With -O1 and assertions, compilation takes half the time, and each input takes hardly longer.
CXX=clang++ cmake -S . -B build/fuzz -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo \
    -DCMAKE_CXX_FLAGS_RELWITHDEBINFO='-O1 -gline-tables-only' -DPOSTLENS_FUZZ=ON -DPOSTLENS_TESTS=OFF -DPOSTLENS_BENCH=OFF \
    --log-level=WARNING
cmake --build build/fuzz --parallel "$(nproc)" --target "${targets[@]}"

export LSAN_OPTIONS=suppressions=$PWD/scripts/lsan_suppressions.txt:print_suppressions=0
# By default, the sanitizer keeps up to 256 MB of freed memory, which would count towards the limit of 1 GB.
export ASAN_OPTIONS=${ASAN_OPTIONS:+$ASAN_OPTIONS:}quarantine_size_mb=32

seeds=build/fuzz/seeds findings=$PWD/build/fuzz/findings
rm -rf "$seeds"
mkdir -p "$findings"
for target in "${all[@]}"; do mkdir -p "$seeds/$target"; done
# Makes a sample file as a seed. In files without compression, random changes affect the records directly.
trace() {
    "$postlens" trace "samples/scenes/$1.toml" -o "$seeds/sample_file_fuzz/$2.exr" --size 8x6 --quiet "${@:3}"
}
trace still_life one --compression none
trace motion keys --compression none --for-shutter 0:1 --keys 3
trace bars hidden --compression none --for-f-number 1.4 --for-focus 5
trace still_life zips
"$postlens" focus "$seeds/sample_file_fuzz/one.exr" -o "$seeds/picture_part_fuzz/rows.exr" --method scatter --f-number 2 --focus 1 \
    --share 0/2 --quiet
cp tests/data/exr/*.exr tests/data/exr-damaged/* "$seeds/foreign_picture_fuzz"
cp tests/data/exr/nan_inf.exr tests/data/exr-damaged/* "$seeds/render_state_fuzz"
cp tests/data/exr/nan_inf.exr tests/data/exr-damaged/* samples/scenes/textures/*.png "$seeds/picture_fuzz"
cp samples/scenes/*.toml samples/scenes/*/*.toml "$seeds/toml_scene_fuzz"
cp samples/paths/*.toml "$seeds/paths_file_fuzz"
cp tests/data/nff/*.nff "$seeds/nff_scene_fuzz"
cp tests/data/mesh/*.glb tests/data/mesh/*.gltf "$seeds/gltf_scene_fuzz"
printf '0 0\n0.5 1\n1 0\n' >"$seeds/shutter_curve_fuzz/triangle"
# For targets that read several formats, the first byte of the input selects the format.
with_first_byte() {
    local byte=$1 to=$2 file
    for file in "${@:3}"; do
        [[ -f $file ]] || continue
        { printf '%b' "\\x$byte" && cat "$file"; } >"$seeds/$to/$(basename "$file")"
    done
}
with_first_byte 00 mesh_scene_fuzz tests/data/mesh/*.obj
with_first_byte 01 mesh_scene_fuzz tests/data/mesh/*.ply
with_first_byte 00 prescription_fuzz tests/data/lens/*.dat
with_first_byte 01 prescription_fuzz tests/data/lens/*.zmx
with_first_byte 02 prescription_fuzz tests/data/lens/*.seq
with_first_byte 03 prescription_fuzz tests/data/lens/*.toml samples/lenses/*.toml

# only_slow_by_the_clock TARGET LOG: returns whether the finding is only a timeout of 10 s, caused by other work on the
# machine. If the input needs less than 10 s of processor time, it is removed.
only_slow_by_the_clock() {
    local input
    input=$(sed -nE 's/^artifact_prefix=.*Test unit written to (.*-timeout-[0-9a-f]+)$/\1/p' "$2")
    [[ -n $input ]] && (ulimit -t 10 && "build/fuzz/fuzz/$1" -timeout=0 "$input") </dev/null >/dev/null 2>&1 && rm -f "$input"
}

# longest_input TARGET: prints the largest size of an input, in bytes. The pixels of an image can need 4096 times as
# much memory as its file (deflate expands up to 1032 times, and a byte becomes a float of 4 bytes), and twice as much
# if the display window is not the data window. A valid longer file could therefore exceed 1 GB.
longest_input() {
    case $1 in
        picture_fuzz) echo 65536 ;;
        *) echo 262144 ;;
    esac
}

# run TARGET: runs a target. Creates build/fuzz/TARGET.failed if it finds an error.
run() {
    local target=$1 log=build/fuzz/$1.log
    rm -f "build/fuzz/$target.failed"
    # Inputs that reach new code are kept in a separate folder for later runs.
    mkdir -p "build/fuzz/corpus/$target"
    if build/fuzz/fuzz/"$target" -max_total_time="$seconds" -rss_limit_mb=1024 -timeout=10 -max_len="$(longest_input "$target")" \
        -seed="${FUZZ_SEED:-0}" -artifact_prefix="$findings/$target-" -print_final_stats=1 "build/fuzz/corpus/$target" "$seeds/$target" \
        </dev/null >"$log" 2>&1; then
        echo "$target: nothing in $(sed -nE 's/^stat::number_of_executed_units: *//p' "$log") inputs"
    elif only_slow_by_the_clock "$target" "$log"; then
        echo "$target: nothing in $(sed -nE 's/^stat::number_of_executed_units: *//p' "$log") inputs; it ended early, since others kept the machine busy"
    else
        tail -n 60 "$log"
        echo "$target: FOUND something, the input is in ${findings#"$PWD"/}"
        touch "build/fuzz/$target.failed"
    fi
}

# Runs as many targets at the same time as there are processors.
for target in "${targets[@]}"; do
    while (($(jobs -rp | wc -l) >= $(nproc))); do wait -n; done
    run "$target" &
done
wait
for target in "${targets[@]}"; do
    [[ ! -e build/fuzz/$target.failed ]] || exit 1
done
echo "fuzz: ${#targets[@]} targets, nothing found in $seconds s each"
