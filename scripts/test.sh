#!/usr/bin/env bash
# Everything that must hold before a change is handed in: format, build, dependencies, documents, all tests.
#
#   scripts/test.sh [--sanitize]
#
#   --sanitize  also build with the address and undefined-behaviour sanitizers and run all tests with them
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

sanitize=false
case ${1:-} in
    '') ;;
    --sanitize) sanitize=true ;;
    *) echo "test.sh: unknown argument (got $1; expected --sanitize)" >&2 && exit 2 ;;
esac

scripts/install_dependencies.sh --for checks
scripts/check_format.sh
scripts/check_includes.py
scripts/build.sh --for checks release
scripts/check_dependencies.sh build/release
scripts/check_readme.sh
if $sanitize; then
    scripts/test_sanitized.sh asan
fi
# At the end, so that the last lines say how many tests passed.
ctest --test-dir build/release --parallel "$(nproc)" --output-on-failure --no-tests=error
