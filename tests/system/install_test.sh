#!/usr/bin/env bash
# Installs the build folder and builds samples/library against that alone, once with CMake and once with pkg-config;
# both must make the picture that the installed program makes.
#
#   install_test.sh BUILD SOURCE COMPILER
set -euo pipefail
build=$1 source=$2 compiler=$3
folder=$(mktemp -d "${TMPDIR:-/tmp}/postlens_install.XXXXXX")
trap 'rm -rf "$folder"' EXIT

cmake --install "$build" --prefix "$folder/first" >/dev/null
# What is installed does not know where it was installed to.
mv "$folder/first" "$folder/there"
there=$folder/there
"$there/bin/postlens" trace "$source/samples/scenes/bars.toml" -o "$folder/frame.exr" --size 48x27 --subdivide 0 --quiet
"$there/bin/postlens" focus "$folder/frame.exr" -o "$folder/wanted.exr" --focal-length 50 --f-number 2 --focus 3 --quiet
# The module with OpenImageIO is where the program looks for it.
"$there/bin/postlens" image "$folder/frame.exr" -o "$folder/frame.jpg" --quiet
"$there/bin/postlens" compare "$folder/frame.jpg" "$folder/wanted.exr" >/dev/null

# The source tree is out of reach, so that nothing of it is used by mistake.
cp -r "$source/samples/library" "$folder/library"
cmake -S "$folder/library" -B "$folder/build" -G Ninja -DCMAKE_PREFIX_PATH="$there" -DCMAKE_CXX_COMPILER="$compiler" \
    --log-level=WARNING >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
cmake --build "$folder/build" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
# Neither warnings as errors nor any other setting of ours gets to who uses the libraries.
if grep -rEq -- '-Werror|-Wshadow|-ffp-contract' "$folder/build/build.ninja" "$there"/lib*/cmake; then
    echo "install_test.sh: settings of postlens's own build have leaked" >&2
    exit 1
fi
"$folder/build/focus_frame" "$folder/frame.exr" "$folder/by_cmake.exr"
cmp "$folder/wanted.exr" "$folder/by_cmake.exr"

# Only the public headers are installed. Each needs nothing but the standard library, and has no warnings.
mapfile -t headers < <(find "$there/include" -type f)
for header in "${headers[@]}"; do
    [[ $header == "$there/include/postlens/"*.h ]] || { echo "install_test.sh: installed $header" >&2; exit 1; }
    "$compiler" -std=c++20 -fsyntax-only -Wall -Wextra -Wpedantic -Werror -I"$there/include" -x c++ - \
        <<<"#include <postlens/${header##*/}>"
done
((${#headers[@]} == 13)) || { echo "install_test.sh: installed ${#headers[@]} headers (expected 13)" >&2; exit 1; }

export PKG_CONFIG_PATH
PKG_CONFIG_PATH=$(dirname "$(find "$there" -name postlens.pc)")
read -ra flags <<<"$(pkg-config --static --cflags --libs postlens)"
"$compiler" -std=c++20 "$folder/library/focus_frame.cpp" -o "$folder/by_pkg_config" "${flags[@]}"
"$folder/by_pkg_config" "$folder/frame.exr" "$folder/by_pkg_config.exr"
cmp "$folder/wanted.exr" "$folder/by_pkg_config.exr"
[[ $(pkg-config --modversion postlens) == $("$there/bin/postlens" --version | sed 's/postlens //') ]]
