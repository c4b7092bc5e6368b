#!/usr/bin/env bash
# Fails, and prints the places, if a C++ file is not formatted according to .clang-format.
#
#   scripts/check_format.sh [--fix]
#
#   --fix  format the files instead
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

case ${1:-} in
    '') mode=(--dry-run -Werror) ;;
    --fix) mode=(-i) ;;
    *) echo "check_format.sh: unknown argument (got $1; expected --fix)" >&2 && exit 2 ;;
esac
mapfile -d '' files < <(git ls-files -z --cached --others --exclude-standard -- '*.h' '*.cpp')
if ((${#files[@]} == 0)); then
    echo "check_format.sh: found no C++ files" >&2
    exit 1
fi
# A few files at a time on each core, because the sizes of the files differ.
printf '%s\0' "${files[@]}" | xargs -0 -P "$(nproc)" -n 40 clang-format "${mode[@]}" --
echo "format: ${#files[@]} files"
