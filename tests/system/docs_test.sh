#!/usr/bin/env bash
# scripts/docs.sh passes for the headers as they are, and fails by the name of what is added without a description.
#
#   docs_test.sh SOURCE
set -euo pipefail
source=$1
folder=$(mktemp -d "${TMPDIR:-/tmp}/postlens_docs.XXXXXX")
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/headers"

documented() {
    "$source/scripts/docs.sh" --headers "$folder/headers" "$folder/out" >"$folder/log" 2>&1
}
# refused TEXT DECLARATION: DECLARATION is refused, and TEXT is in the message.
refused() {
    cp "$source"/postlens/*.h "$folder/headers"
    printf '\nnamespace postlens::api {\n%s\n}\n' "$2" >>"$folder/headers/lens.h"
    if documented || ! grep -q -- "$1" "$folder/log"; then
        echo "docs_test.sh: not refused: $2" >&2
        cat "$folder/log" >&2
        exit 1
    fi
}

refused 'added_function' 'void added_function();'
refused 'added_member' $'/// Text.\nstruct Added {\n    int added_member = 0;\n};'
refused 'parameters of member postlens::api::added' $'/// Text.\nvoid added(int parameter);'
refused 'return type of member postlens::api::added' $'/// Text.\nint added();'
refused 'added_value' $'/// Text.\nenum class Added { added_value };'

cp "$source"/postlens/*.h "$folder/headers"
documented || { cat "$folder/log" >&2; exit 1; }
