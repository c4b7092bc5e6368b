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
failed() {
    echo "docs_test.sh: $1" >&2
    cat "$folder/log" >&2
    exit 1
}

# Any single message makes docs.sh fail, so one run tests all declarations.
cp "$source"/postlens/*.h "$folder/headers"
cat >>"$folder/headers/lens.h" <<'END'

namespace postlens::api {
void added_function();
/// Text.
struct Added {
    int added_member = 0;
};
/// Text.
void with_parameter(int parameter);
/// Text.
int with_result();
/// Text.
enum class AddedEnum { added_value };
}
END
! documented || failed "accepted"
for missing in added_function added_member 'parameters of member postlens::api::with_parameter' \
    'return type of member postlens::api::with_result' added_value; do
    grep -q -- "$missing" "$folder/log" || failed "no message about: $missing"
done
# Doxygen repeats some messages. There are none about anything else.
(($(sed 's/.*warning: //' "$folder/log" | sort -u | wc -l) == 5)) || failed "other messages than the five"

cp "$source"/postlens/*.h "$folder/headers"
documented || failed "refused"
