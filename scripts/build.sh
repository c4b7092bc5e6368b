#!/usr/bin/env bash
# Installs missing packages, configures the build and builds on all cores. demo.sh and test.sh call this script.
#
#   scripts/build.sh [--for build|checks|fuzzing] [PRESET [TARGET...]]
#
#   PRESET  a preset of CMakePresets.json (default: release); the results are in build/PRESET
#   TARGET  a target to build (default: all targets)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

purpose=build
if [[ ${1:-} == --for ]]; then
    purpose=${2:-}
    shift 2
fi
preset=${1:-release}
targets=("${@:2}")

scripts/install_dependencies.sh --for "$purpose"
# Only warnings of CMake are printed.
cmake --preset "$preset" --log-level=WARNING
cmake --build "build/$preset" --parallel "$(nproc)" ${targets[0]:+--target "${targets[@]}"}
