#!/usr/bin/env bash
# Runs clang-tidy with .clang-tidy over the project's C++ files, all cores at once. Fails on any finding.
#
#   scripts/check_tidy.sh [BUILD [FILE.cpp...]]
#
#   BUILD     a configured build folder with compile_commands.json (default: build/release)
#   FILE.cpp  what to look at (default: every .cpp that BUILD compiles); headers are looked at from there
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build=${1:-build/release}
database=$build/compile_commands.json
if [[ ! -f $database ]]; then
    echo "check_tidy.sh: $database is missing; configure with: cmake --preset release" >&2
    exit 1
fi
# clang-tidy checks each file by itself, also files that are compiled together, and without precompiled headers, which
# only g++ can read, as some options. Each file therefore has to include what it uses.
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
# clang-tidy also counts, on stderr, the warnings in system headers that it does not show.
printf '%s\0' "${files[@]}" |
    xargs -0 -n 1 -P "$(nproc)" clang-tidy --quiet -p "$tidy_build" 2> >(grep -vE '^[0-9]+ warnings?( and [0-9]+ errors?)? generated|^$' >&2)
echo "clang-tidy: ${#files[@]} files"
