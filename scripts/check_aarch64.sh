#!/usr/bin/env bash
# Cross-compiles the program for 64-bit ARM, runs it under qemu, and compares its output with that of this machine.
#
#   scripts/check_aarch64.sh [PROGRAM]     PROGRAM: the program of this machine (default: build/release/apps/postlens)
#
# The first run downloads 280 MB of Debian's arm64 packages into build/aarch64-sysroot (1.3 GB on disk; half a minute).
# The build in build/aarch64 takes ten minutes on one core. Needs scripts/install_dependencies.sh --for cpus.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

program=${1:-build/release/apps/postlens}
if [[ ! -x $program ]]; then
    echo "check_aarch64.sh: $program is missing; build it with scripts/build.sh" >&2
    exit 2
fi
for tool in qemu-aarch64 aarch64-linux-gnu-g++ apt-get idiff; do
    if ! command -v "$tool" >/dev/null; then
        echo "check_aarch64.sh: there is no $tool; install it with: scripts/install_dependencies.sh --for cpus" >&2
        exit 2
    fi
done

sysroot=$PWD/build/aarch64-sysroot
scripts/aarch64_sysroot.sh "$sysroot"
cmake -G Ninja -S . -B build/aarch64 --log-level=WARNING -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_TOOLCHAIN_FILE="$PWD/cmake/aarch64.cmake" -DPOSTLENS_SYSROOT="$sysroot" -DPOSTLENS_TESTS=OFF -DPOSTLENS_BENCH=OFF
cmake --build build/aarch64 --parallel "$(nproc)" --target postlens

folder=$(mktemp -d "${TMPDIR:-/tmp}/aarch64.XXXXXX")
trap 'rm -rf "$folder"' EXIT
tests/instruction_sets/results.sh "$folder/native" "$program"
began_s=$SECONDS
tests/instruction_sets/results.sh "$folder/arm" qemu-aarch64 -L "$sysroot" build/aarch64/apps/postlens
echo "aarch64: $(find "$folder/arm" -type f | wc -l) files, $((SECONDS - began_s)) s under qemu"
# The last bits of libm's results are different on ARM. Where the exact W (1/m) of mirrors and glass is 0, the stored W
# consists of rounding errors and differed by 6e-16.
if ! tests/instruction_sets/compare_results.sh "$folder/arm" "$folder/native" 1e-12; then
    echo "check_aarch64.sh: 64-bit ARM writes something else than $(uname -m)" >&2
    exit 1
fi
