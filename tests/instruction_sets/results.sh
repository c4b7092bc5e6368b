#!/usr/bin/env bash
# Runs the command on small inputs, so that every kernel that is compiled for several instruction sets is at work, and
# leaves the results in a folder: files that another processor, or another clone of a kernel, must make alike.
#
#   tests/instruction_sets/results.sh DIR COMMAND...
#
#   DIR      where the results go; it must not exist
#   COMMAND  postlens, or what runs it: build/release/apps/postlens, qemu-x86_64 -cpu Nehalem build/release/apps/postlens
set -euo pipefail

if (($# < 2)) || [[ -e $1 ]]; then
    echo "results.sh: needs a folder that does not exist and a command (got: $*)" >&2
    exit 2
fi
out=$1
shift
command=("$@")
scenes=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../samples/scenes" && pwd)
mkdir -p "$out"

postlens() {
    "${command[@]}" "$@" --threads 1 --quiet </dev/null
}
# Emission only, with points of the lens to see past edges; mirrors and glass; a turning wheel.
postlens trace "$scenes/bars.toml" -o "$out/bars.exr" --size 64x36 --for-f-number 1.4 --for-focus 5
postlens trace "$scenes/still_life.toml" -o "$out/still_life.exr" --size 48x27 --max-depth 4
postlens trace "$scenes/motion/rolling_wheel.toml" -o "$out/wheel.exr" --size 48x27 --for-shutter 0:1 --keys 3

lens=(--f-number 1.4 --focus 3)
postlens focus "$out/bars.exr" -o "$out/scatter.exr" "${lens[@]}"
postlens focus "$out/still_life.exr" -o "$out/refocused.tif" --f-number 1.8 --focus 1
postlens focus "$out/bars.exr" -o "$out/layers.exr" "${lens[@]}" --method layers --impulse polygon:7 --cats-eye 0.6
postlens focus "$out/bars.exr" -o "$out/light_field.exr" "${lens[@]}" --method lightfield --views 16
postlens focus "$out/bars.exr" -o "$out/hybrid.exr" "${lens[@]}" --method hybrid --views 16 --scene "$scenes/bars.toml"
postlens focus "$out/still_life.exr" -o "$out/mirrored.exr" --f-number 1.8 --focus 1 --method lightfield --views 8
postlens focus "$out/still_life.exr" -o "$out/layers_mirrored.exr" --f-number 1.8 --focus 1 --method layers
postlens lens psf "$out/psf.exr" --focal-length 50 --f-number 8 --focus 1.5 --depth 2 --impulse diffraction --size 33
postlens motionblur "$out/wheel.exr" -o "$out/convolved.exr" --shutter 0:1 --method convolve
postlens motionblur "$out/wheel.exr" -o "$out/views.exr" --shutter 0:1 --method lightfield --views 8

for sampler in sobol jittered random poisson; do
    postlens render "$scenes/bars.toml" -o "$out/$sampler.exr" --size 32x18 --spp 16 --sampler $sampler "${lens[@]}"
done
postlens render "$scenes/still_life.toml" -o "$out/shaded.exr" --size 24x14 --spp 4 --max-depth 4 --f-number 1.8 --focus 1
postlens render "$scenes/motion/rolling_wheel.toml" -o "$out/moving.exr" --size 32x18 --spp 4 --shutter 0:1
# All figures but the time it took.
postlens compare "$out/scatter.exr" "$out/light_field.exr" --json --map "$out/map.png" |
    sed '/"seconds":/d; /"peak_memory_bytes":/d' >"$out/compared.json"
