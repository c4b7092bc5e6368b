#!/usr/bin/env bash
# Runs all checks that a change must pass: format, includes, documents, build, dependencies and tests.
#
#   scripts/test.sh [--sanitize] [--peers]
#
#   --peers     also install the programs that postlens works with (Blender, Slurm), and run the tests that need them
#   --sanitize  also build with the address and undefined-behaviour sanitizers and run all tests with them
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

sanitize=false packages=checks
for word in "$@"; do
    case $word in
        --sanitize) sanitize=true ;;
        --peers) packages=peers ;;
        *) echo "test.sh: unknown argument (got $word; expected --sanitize or --peers)" >&2 && exit 2 ;;
    esac
done

scripts/install_dependencies.sh --for $packages
scripts/check_format.sh
scripts/check_includes.py
scripts/docs.sh
scripts/build.sh --for checks release
scripts/check_dependencies.sh build/release
scripts/check_readme.sh
if $sanitize; then
    scripts/test_sanitized.sh asan
fi
if [[ $packages == peers ]]; then
    ctest --test-dir build/release -L peers --output-on-failure --no-tests=error
else
    echo "peers: skipped, the tests inside Blender, on Slurm and of the notebook (scripts/test.sh --peers)"
fi
# These tests run last, so that the last lines of the output state how many tests passed. The tests of the viewer
# mostly wait for the browser, so one test more than there are processors runs at a time.
ctest --test-dir build/release -LE peers --parallel "$(($(nproc) + 1))" --output-on-failure --no-tests=error
