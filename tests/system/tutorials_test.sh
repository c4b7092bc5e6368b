#!/usr/bin/env bash
# Runs every command of a tutorial, in order, in a folder where the source tree is read only by name. Sizes and positions
# of pixels are divided by three, because the time of most commands is proportional to the number of pixels.
#
#   tutorials_test.sh SOURCE BUILD TUTORIAL.md FILE...     FILE: what the commands must have made
set -euo pipefail
source=$1 build=$2 tutorial=$3
shift 3
folder=$(mktemp -d "${TMPDIR:-/tmp}/postlens_tutorial.XXXXXX")
trap 'rm -rf "$folder"' EXIT
ln -s "$source/samples" "$folder/samples"
mkdir -p "$folder/build"
ln -s "$build" "$folder/build/release"
cd "$folder"

# Blender's picture of the one who reads: a frame of ours as another program would have written it.
if [[ $tutorial == *blender.md ]]; then
    "$build/apps/postlens" trace samples/scenes/bars.toml -o bars.exr --size 240x135 --quiet
    "$build/bench/foreign_export" bars.exr shot.exr most cryptomatte
fi

sed -n '/^```sh$/,/^```$/{/^```/d;p}' "$tutorial" |
    perl -pe 's{(--size|--focus-at|--at) (\d+)([x,])(\d+)}{"$1 " . int($2 / 3) . $3 . int($4 / 3)}ge' >commands.sh
[[ -s commands.sh ]]
bash -euo pipefail commands.sh
for file in "$@"; do
    [[ -s $file ]] || { echo "tutorials_test.sh: $tutorial did not make $file" >&2; exit 1; }
done
