#!/usr/bin/env bash
# Traces SPD pictures with POV-Ray 3.7 and postlens by turns, and prints the time and the number of rays of both.
#
#   scripts/peers/spd_povray.sh NFF BUILD [--rounds N] [--published CSV]
#
#   NFF              folder with balls.nff, tetra.nff and mount.nff
#   BUILD            build folder with bench/eye_rays_bench, a release build
#   --rounds N       timed runs of each program and scene (default: 5)
#   --published CSV  published ray counts (default: NFF/../tables/spd_published_ray_counts.csv, where it exists)
#
# Both programs trace 513 x 513 rays through pixel corners to depth 5, without antialiasing and without writing a file,
# on the same two processors.
set -euo pipefail
export LC_ALL=C # so that EPOCHREALTIME has a decimal point

die() {
    echo "spd_povray.sh: $*" >&2
    exit 1
}
usage() {
    echo "spd_povray.sh: $*" >&2
    exit 2
}

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
scenes=(balls tetra mount)
rounds=5
published=
folders=()
while (($# > 0)); do
    case $1 in
        --rounds | --published)
            [[ -n ${2:-} ]] || usage "$1: no value (expected one after it)"
            if [[ $1 == --rounds ]]; then rounds=$2; else published=$2; fi
            shift
            ;;
        -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0" && exit 0 ;;
        -*) usage "unknown option (got $1; expected --rounds or --published)" ;;
        *) folders+=("$1") ;;
    esac
    shift
done
((${#folders[@]} == 2)) || usage "wrong number of folders (got ${#folders[@]}; expected NFF BUILD)"
[[ $rounds =~ ^[1-9][0-9]{0,2}$ ]] || usage "--rounds is out of range (got $rounds; expected 1 to 999)"
for folder in "${folders[@]}"; do
    [[ -d $folder ]] || die "$folder: no such folder"
done
nff=$(cd "${folders[0]}" && pwd)
bench=$(cd "${folders[1]}" && pwd)/bench/eye_rays_bench

command -v povray >/dev/null || die "povray is missing; install it with: apt-get install povray"
command -v python3 >/dev/null || die "python3 is missing; install it with: apt-get install python3"
command -v taskset >/dev/null || die "taskset is missing; install it with: apt-get install util-linux"
[[ -x $bench ]] || die "$bench is missing; build the target eye_rays_bench"
for scene in "${scenes[@]}"; do
    [[ -f $nff/$scene.nff ]] || die "$nff/$scene.nff is missing"
done
if [[ -n $published ]]; then
    [[ -f $published ]] || die "$published: no such file"
elif [[ -f $nff/../tables/spd_published_ray_counts.csv ]]; then
    published=$nff/../tables/spd_published_ray_counts.csv
fi

# The benchmark uses all processors that it is allowed to use, so both programs are restricted to the same two.
processors=$(python3 -c 'import os; print(*sorted(os.sched_getaffinity(0))[:2], sep=",")')
[[ $processors == *,* ]] || die "two processors are needed (got one)"

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# run_povray SCENE LOG [OPTION...]: writes the wall time of the whole process, in seconds, to LOG.wall. POV-Ray runs in
# the scratch folder, because Debian's configuration lets it read few folders other than the working folder.
run_povray() {
    local scene=$1 log=$scratch/$2 start end
    shift 2
    start=$EPOCHREALTIME
    (cd "$scratch" && taskset -c "$processors" povray "+I$scene.pov" +W513 +H513 -A -J +Q9 +WT2 -F -D -P -C -V \
        -GR -GD "$@" >"$log" 2>&1) ||
        die "povray failed on $scene: $(grep -i -m 1 'error' "$log" || tail -n 1 "$log")"
    end=$EPOCHREALTIME
    awk -v start="$start" -v end="$end" 'BEGIN { printf "%.6f\n", end - start }' >"$log.wall"
}
run_postlens() {
    local scene=$1 json=$scratch/$2
    POSTLENS_SPD=$nff taskset -c "$processors" "$bench" "--benchmark_filter=^spd_picture/$scene/" \
        --benchmark_format=json >"$json" 2>"$json.errors" ||
        die "$bench failed on $scene: $(tail -n 1 "$json.errors")"
    # The benchmark library does not fail if no benchmark matches.
    [[ -s $json ]] || die "$bench has no benchmark spd_picture/$scene"
}

# POV-Ray also counts rays at the last level, which it does not trace, and counts a shadow ray again behind each
# transparent surface. A run with one level less counts only traced rays. A run with glass that casts no shadow counts
# each shadow ray once.
for scene in "${scenes[@]}"; do
    python3 "$here/nff_to_pov.py" "$nff/$scene.nff" "$scratch/$scene.pov"
    run_povray "$scene" "$scene.traced" Declare=Max_Depth=4
    run_povray "$scene" "$scene.shadow" Declare=Clear_Glass=1
done

for ((round = 1; round <= rounds; ++round)); do
    for scene in "${scenes[@]}"; do
        # The programs alternate in running first, because the first one affects the second (clock rate, caches).
        if ((round % 2)); then
            run_povray "$scene" "$scene.povray.$round"
            run_postlens "$scene" "$scene.postlens.$round"
        else
            run_postlens "$scene" "$scene.postlens.$round"
            run_povray "$scene" "$scene.povray.$round"
        fi
    done
done

python3 - "$scratch" "$rounds" "$published" "${scenes[@]}" <<'PYTHON'
import csv
import json
import os
import re
import statistics
import sys

scratch, rounds, published_path, *scenes = sys.argv[1:]
rounds = range(1, int(rounds) + 1)


def fail(text):
    sys.exit(f"spd_povray.sh: {text}")


def read(name):
    with open(os.path.join(scratch, name), encoding="utf-8", errors="replace") as file:
        return file.read()


def seconds(name, what):
    found = re.search(rf"{what} Time:.*\(([0-9.]+) seconds\)", read(name))
    return float(found[1]) if found else fail(f"povray printed no {what} Time for {name}")


def count(name, what):
    """A counter of POV-Ray's, which it leaves out where it is 0."""
    found = re.search(rf"^{what}: +([0-9]+)", read(name), re.MULTILINE)
    return int(found[1]) if found else 0


def postlens(name):
    """Seconds for a picture, and the rays for it."""
    runs = [b for b in json.loads(read(name) or "{}").get("benchmarks", []) if b["run_type"] == "iteration"]
    if len(runs) != 1 or "error_message" in runs[0]:
        fail(f"eye_rays_bench did not time {name}: {runs[0]['error_message'] if runs else 'no such benchmark'}")
    time_s = runs[0]["real_time"] * {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1}[runs[0]["time_unit"]]
    return time_s, round(runs[0]["rays/s"] * time_s)


published = {}
if published_path:
    with open(published_path, encoding="utf-8", newline="") as file:
        published = {row["scene"]: row for row in csv.DictReader(file)}

print(f"Seconds, 513 x 513 corner rays, depth 5, 2 threads; medians of {len(rounds)} (least to most)")
print("  process: the whole program, about 0.6 s of it idle; own: parsing, bounding and tracing by POV-Ray's statistics")
print("  postlens: reading, building and tracing; ratios are POV-Ray's seconds over postlens'")
print(f"{'scene':6} {'process':>20} {'own':>20} {'trace alone':>20} {'postlens':>23}"
      f" {'process':>8} {'own':>6} {'trace':>6}")


def spread(values, digits):
    return f"{statistics.median(values):.{digits}f} ({min(values):.{digits}f}-{max(values):.{digits}f})"


pictures = {}
for scene in scenes:
    logs = [f"{scene}.povray.{i}" for i in rounds]
    for log in logs:
        if "using 2 thread(s)" not in read(log) or "Image Resolution 513 x 513" not in read(log):
            fail(f"povray did not render {log} with 2 threads at 513 x 513")
    process = [float(read(log + ".wall")) for log in logs]
    trace = [seconds(log, "Trace") for log in logs]
    own = [seconds(log, "Parse") + seconds(log, "Bounding") + t for log, t in zip(logs, trace)]
    pictures[scene] = [postlens(f"{scene}.postlens.{i}") for i in rounds]
    ours = [p[0] for p in pictures[scene]]
    ratios = [statistics.median(times) / statistics.median(ours) for times in (process, own, trace)]
    print(f"{scene:6} {spread(process, 3):>20} {spread(own, 3):>20} {spread(trace, 3):>20} {spread(ours, 4):>23}"
          f" {ratios[0]:8.1f} {ratios[1]:6.1f} {ratios[2]:6.1f}")

print("\nRays for a picture; share: of the published sum")
print("  as printed: POV-Ray's counters of the timed run, with rays that it makes at the last level and does not trace,")
print("  and with shadow rays counted anew behind each transparent surface; traced: without these")
print(f"{'scene':6} {'whose':20} {'eye':>8} {'reflected':>10} {'refracted':>10} {'shadow':>10} {'sum':>10} {'share':>7}")


def line(scene, whose, counts, total, of):
    cells = " ".join(f"{c:>{w}}" for c, w in zip(counts or [""] * 4, (8, 10, 10, 10)))
    share = f"{100 * total / of:6.1f}%" if of else ""
    print(f"{scene:6} {whose:20} {cells} {total:>10} {share:>7}")


for scene in scenes:
    of = None
    eye = 513 * 513
    if scene in published:
        counts = [eye] + [int(published[scene][k]) for k in ("reflect_rays", "refract_rays", "shadow_rays")]
        of = sum(counts)
        line(scene, "published", counts, of, of)
    timed, traced, shadow = f"{scene}.povray.1", f"{scene}.traced", f"{scene}.shadow"
    for whose, rays, lit in (("POV-Ray, traced", traced, shadow), ("POV-Ray, as printed", timed, timed)):
        counts = [count(rays, "Reflected Rays"), count(rays, "Refracted Rays"), count(lit, "Shadow Ray Tests")]
        counts.insert(0, count(rays, "Rays") - counts[0] - counts[1])
        line(scene, whose, counts, sum(counts), of)
    line(scene, "postlens", None, pictures[scene][0][1], of)
PYTHON
