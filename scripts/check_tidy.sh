#!/usr/bin/env bash
# Checks the project's C++ files with clang-tidy and .clang-tidy, on all cores. Fails if clang-tidy reports a warning.
#
#   scripts/check_tidy.sh [BUILD [FILE.cpp...]]
#
#   BUILD     a configured build folder with compile_commands.json (default: build/release)
#   FILE.cpp  the files to check, with the headers that they include (default: every .cpp that BUILD compiles)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build=${1:-build/release}
database=$build/compile_commands.json
if [[ ! -f $database ]]; then
    echo "check_tidy.sh: $database is missing; configure with: cmake --preset release" >&2
    exit 1
fi
# Makes compile commands for clang-tidy. Files of a unity build are checked separately. Precompiled headers and options
# that only g++ supports are removed, so each file must include all headers that it needs.
tidy_build=$build/tidy
mkdir -p "$tidy_build"
python3 - "$database" >"$tidy_build/compile_commands.json" <<'END'
import json
import re
import sys
entries = []
for entry in json.load(open(sys.argv[1])):
    entry["command"] = re.sub(r" -Winvalid-pch| -include \S*/cmake_pch\.hxx| -fpch-preprocess| --param=\S*", " ", entry["command"])
    name = entry["file"]
    parts = [name]
    if "/Unity/" in name:
        parts = re.findall(r'^#include "(.*)"', open(name).read(), re.MULTILINE)
    entries += [entry | {"file": part, "command": entry["command"].replace(name, part)} for part in parts]
json.dump(entries, sys.stdout, indent=0)
END
if (($# > 1)); then
    files=("${@:2}")
else
    mapfile -t files < <(sed -nE 's/^"file": "(.*\.cpp)",?$/\1/p' "$tidy_build/compile_commands.json" | sort -u)
fi
if ((${#files[@]} == 0)); then
    echo "check_tidy.sh: $database names no C++ file" >&2
    exit 1
fi
# On stderr, clang-tidy also counts warnings in system headers, which it does not show. These lines are removed.
printf '%s\0' "${files[@]}" |
    xargs -0 -n 1 -P "$(nproc)" clang-tidy --quiet -p "$tidy_build" 2> >(grep -vE '^[0-9]+ warnings?( and [0-9]+ errors?)? generated|^$' >&2)
echo "clang-tidy: ${#files[@]} files"
