#!/usr/bin/env bash
# Traces a scene once through a pinhole, and focuses the sample file at three distances.
#
#   scripts/demo.sh
#
# The pictures are in out/demo: still_life_pinhole.png and still_life_{near,middle,far}.png.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scene=samples/scenes/still_life.toml
out=out/demo
focal_length_mm=50
f_number=1.8
overscan_px=72 # suffices for the largest circles of confusion at the border of the image
declare -A focus_m=([near]=0.8 [middle]=1.5 [far]=4)

scripts/build.sh --for build release postlens postlens_python
postlens=build/release/apps/postlens
mkdir -p "$out"

step() {
    echo "+ $*"
    "$@"
}
echo
step "$postlens" trace "$scene" -o "$out/still_life.exr" --overscan "$overscan_px"
step "$postlens" image "$out/still_life.exr" -o "$out/still_life_pinhole.png"
for place in near middle far; do
    step "$postlens" focus "$out/still_life.exr" -o "$out/still_life_$place.png" \
        --focal-length "$focal_length_mm" --f-number "$f_number" --focus "${focus_m[$place]}"
done

echo
echo "One trace, four pictures:"
printf '  %-36s everything sharp\n' "$out/still_life_pinhole.png"
for place in near middle far; do
    printf '  %-36s focused at %s m, %s mm, f/%s\n' "$out/still_life_$place.png" "${focus_m[$place]}" \
        "$focal_length_mm" "$f_number"
done
