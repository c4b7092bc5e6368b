#!/usr/bin/env bash
# Builds the reference of the C++ interface and the pages of docs/ as HTML, in OUT/html. Fails if a public name,
# parameter or return value in postlens/*.h has no description, if Doxygen reports a warning, or if a link of a page has
# no target.
#
#   scripts/docs.sh [--headers FOLDER] [OUT]
#
#   --headers FOLDER  the headers to read (default: postlens)
#   OUT               default: build/docs
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

headers=postlens
if [[ ${1:-} == --headers ]]; then
    headers=$2
    shift 2
fi
mkdir -p "${1:-build/docs}"
out=$(realpath "${1:-build/docs}")
if ! command -v doxygen >/dev/null; then
    echo "docs.sh: doxygen is missing (scripts/install_dependencies.sh installs it)" >&2
    exit 1
fi

# Makes the version header from CMake's template, so that no build is needed.
version=$(sed -nE 's/^project\(postlens VERSION ([0-9.]+).*/\1/p' CMakeLists.txt)
IFS=. read -r major minor patch <<<"$version"
mkdir -p "$out/include/postlens"
sed -e "s/@PROJECT_VERSION_MAJOR@/$major/; s/@PROJECT_VERSION_MINOR@/$minor/; s/@PROJECT_VERSION_PATCH@/$patch/" \
    postlens/version.h.in >"$out/include/postlens/version.h"

rm -rf "$out/html" "$out/xml"
mkdir "$out/html"
scripts/doxygen_pages.py "$out"
{
    echo "@INCLUDE = docs/Doxyfile"
    echo "PROJECT_NUMBER = $version"
    echo "INPUT = \"$headers\" \"$out/include/postlens\" \"$out/pages\""
    echo "USE_MDFILE_AS_MAINPAGE = \"$out/pages/index.md\""
    echo "STRIP_FROM_INC_PATH = \"$PWD\" \"$out/include\""
    echo "OUTPUT_DIRECTORY = \"$out\""
    echo "WARN_LOGFILE = \"$out/doxygen.log\""
} | doxygen - >/dev/null
# Doxygen 1.9 does not warn about enumerators without a description.
python3 - "$out/xml" >>"$out/doxygen.log" <<'END'
import glob
import sys
import xml.etree.ElementTree as tree
for path in glob.glob(sys.argv[1] + "/namespacepostlens*.xml"):
    for value in tree.parse(path).iter("enumvalue"):
        if not "".join(value.find("briefdescription").itertext()).strip():
            print("warning: the value", value.find("name").text, "of an enumeration is not documented.")
END
if [[ -s $out/doxygen.log ]]; then
    sed "s#^$PWD/##" "$out/doxygen.log" >&2
    exit 1
fi
names=$(grep -cE '<member .*kind="(function|variable|enum)"' "$out/xml/index.xml")
echo "docs: $(find "$out/pages" -name '*.md' | wc -l) pages, $names names, in $out/html/index.html"
