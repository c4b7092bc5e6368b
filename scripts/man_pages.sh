#!/usr/bin/env bash
# Makes manual pages of the program and its subcommands from the output of --help.
#
#   scripts/man_pages.sh PROGRAM FOLDER
set -euo pipefail
program=$(realpath "$1") folder=$2
version=$("$program" --version | sed 's/postlens //')
mkdir -p "$folder"
wrapper=$(mktemp -d)
trap 'rm -rf "$wrapper"' EXIT

# page NAME WORDS...: makes a page. help2man accepts no arguments for a program, so a wrapper script adds the words.
page() {
    local name=$1 summary
    shift
    printf '#!/bin/sh\nexec "%s" %s "$@"\n' "$program" "$*" >"$wrapper/$name"
    chmod +x "$wrapper/$name"
    # The first line of --help is the summary. For the program itself, it begins with the program's name.
    summary=$("$program" "$@" --help | sed -n '1{s/^postlens: //;p}')
    help2man --no-info --section 1 --version-string "$version" --name "$summary" --source "postlens $version" \
        --output "$folder/$name.1" "$wrapper/$name"
    sed -i "s#$wrapper/##g" "$folder/$name.1"
}

subcommands() {
    "$program" "$@" --help | sed -n '/^Subcommands:/,$s/^  \([a-z]\+\) .*/\1/p'
}

page postlens
for name in $(subcommands); do
    page "postlens-$name" "$name"
    for inner in $(subcommands "$name"); do page "postlens-$name-$inner" "$name" "$inner"; done
done
