#!/usr/bin/env bash
# Builds with a sanitizer and runs the tests. A test fails if the sanitizer reports an error.
#
#   scripts/test_sanitized.sh asan|tsan [CTEST_OPTION...]
#
#   asan          AddressSanitizer and UndefinedBehaviorSanitizer
#   tsan          ThreadSanitizer
#   CTEST_OPTION  for example -R NAME, which runs only some of the tests
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${1:-}
case $preset in
    asan | tsan) shift ;;
    *) echo "test_sanitized.sh: unknown sanitizer (got '$preset'; expected asan or tsan)" >&2 && exit 2 ;;
esac
scripts/build.sh --for checks "$preset"
# Without intercept_tls_get_addr=0, the search for leaks crashes in programs that have loaded OpenImageIO.
export ASAN_OPTIONS=strict_string_checks=1:detect_stack_use_after_return=1:intercept_tls_get_addr=0
export LSAN_OPTIONS=suppressions=$PWD/scripts/lsan_suppressions.txt:print_suppressions=0
export UBSAN_OPTIONS=print_stacktrace=1
export TSAN_OPTIONS=suppressions=$PWD/scripts/tsan_suppressions.txt
ctest --test-dir "build/$preset" --parallel "$(nproc)" --output-on-failure --no-tests=error "$@"
