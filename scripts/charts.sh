#!/usr/bin/env bash
# Makes the charts and tables of docs/accuracy.md, and the atlas of docs/failures.md, in 20 to 40 minutes on two cores.
#
#   scripts/charts.sh [--build BUILD] [--out DIR] [--charts-only | --atlas-only]
#
#   BUILD  a built folder (default: build/release)
#   DIR    folder of the pages and pictures (default: build/charts); finished results in it are kept
#
# Nothing else should run on the machine, because times are measured.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build=build/release
out=build/charts
charts=true
atlas=true
while (($# > 0)); do
    case $1 in
        --build) build=${2:?} && shift ;;
        --out) out=${2:?} && shift ;;
        --charts-only) atlas=false ;;
        --atlas-only) charts=false ;;
        -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0" && exit 0 ;;
        *) echo "charts.sh: unknown argument (got $1; expected --build, --out, --charts-only or --atlas-only)" >&2 && exit 2 ;;
    esac
    shift
done
postlens=$build/apps/postlens
[[ -x $postlens ]] || { echo "charts.sh: $postlens is missing; build with scripts/build.sh" >&2 && exit 1; }
mkdir -p "$out"

# chart NAME SCENE OPTIONS...
chart() {
    local name=$1 scene=$2
    shift 2
    echo "== $name"
    "$postlens" chart "$scene" -o "$out/$name" "$@" --quiet >"$out/$name.md"
    for kind in speed_accuracy cost; do
        cp "$out/$name/$kind.svg" "docs/images/chart_${name}_$kind.svg"
        cp "$out/$name/$kind.png" "docs/images/chart_${name}_$kind.png"
    done
    scripts/splice.py docs/accuracy.md "chart $name" "$out/$name/chart.md"
}

if $charts; then
    # Cheap shading: all materials only emit light, so rays are fast.
    chart cheap samples/scenes/bars.toml --size 960x540 --f-number 1.4 --focus 5 --reference-spp 1024 --rays 1,4,16,64,256,1024 \
        --views 16,64,256 --depths 32 --rounds 2 --once-above 5
    # Expensive shading: shadows of three lights, a mirror ball, a glass ball and a polished table.
    chart costly samples/scenes/still_life.toml --size 384x216 --f-number 1.4 --focus 1.2 --reference-spp 1024 --rays 1,4,16,64,256,1024 \
        --views 16,32,64,256 --depths 32 --rounds 2 --once-above 5
    # Expensive shading, but rays need few samples: polished spheres, most of them in focus.
    chart balls tests/data/nff/balls_s2.nff --size 960x540 --focal-length 100 --f-number 1.4 --focus 2.2 --reference-spp 512 \
        --rays 1,4,16,64,256 --views 16,64,256 --depths 32 --rounds 2 --once-above 5
    # Defocus and motion blur together.
    chart both samples/scenes/motion.toml --size 384x216 --f-number 1.4 --focus 4 --shutter 0:1 --reference-spp 2048 \
        --rays 1,4,16,64,256,1024 --views 16,64,256 --depths 32 --rounds 2 --once-above 5
fi
if $atlas; then
    echo "== atlas"
    "$postlens" chart --atlas tests/stability -o "$out/atlas" --quiet >"$out/atlas.txt"
    cp "$out/atlas/failures.md" docs/failures.md
    rm -rf docs/images/failures
    mkdir -p docs/images/failures
    cp "$out"/atlas/images/failures/*.png docs/images/failures/
fi
