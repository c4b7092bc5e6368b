#!/usr/bin/env bash
# Installs what is missing, configures and builds with all cores. The demo and the tests start with this.
#
#   scripts/build.sh [--for build|checks|fuzzing] [PRESET [TARGET...]]
#
#   PRESET  one of CMakePresets.json (default: release); the results are in build/PRESET
#   TARGET  what to build (default: everything)
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
# An unchanged configuration is not worth a page of text; what CMake warns of still shows.
cmake --preset "$preset" --log-level=WARNING
# With no target named, CMake builds all.
cmake --build "build/$preset" --parallel "$(nproc)" ${targets[0]:+--target "${targets[@]}"}
