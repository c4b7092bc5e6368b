#!/usr/bin/env bash
# Makes the Debian packages, installs them below a folder of their own, uses them there, and removes them.
#
#   packages_test.sh BUILD SOURCE
set -euo pipefail
build=$1 source=$2
folder=$(mktemp -d "${TMPDIR:-/tmp}/postlens_packages.XXXXXX")
trap 'rm -rf "$folder"' EXIT
if ! command -v dpkg-shlibdeps >/dev/null; then
    echo "packages: not made, this is no Debian system with dpkg-dev"
    exit 0
fi

# Compression would take a fifth of the time.
cpack --config "$build/CPackConfig.cmake" -B "$folder/packages" -D CPACK_DEBIAN_COMPRESSION_TYPE=none >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
packages=("$folder"/packages/*.deb)
names=$(for p in "${packages[@]}"; do dpkg-deb --field "$p" Package; done | sort | xargs)
[[ $names == "libpostlens-dev postlens python3-postlens" ]] || { echo "packages_test.sh: got $names" >&2; exit 1; }
# What they need is named, not guessed.
dpkg-deb --field "$folder"/packages/postlens_*.deb Depends | grep -q libembree3
dpkg-deb --field "$folder"/packages/python3-postlens_*.deb Depends | grep -q python3-numpy

root=$folder/root
mkdir -p "$root/var/lib/dpkg/info" "$root/var/lib/dpkg/updates"
touch "$root/var/lib/dpkg/status"
# Their dependencies are installed outside of that folder.
dpkg=(dpkg --root="$root" --log="$folder/dpkg.log" --force-not-root --force-depends --force-bad-path --no-triggers)
"${dpkg[@]}" --install "${packages[@]}" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }

scene=$source/samples/scenes/bars.toml
"$root/usr/bin/postlens" trace "$scene" -o "$folder/frame.exr" --size 48x27 --quiet
"$root/usr/bin/postlens" focus "$folder/frame.exr" -o "$folder/a.exr" --f-number 2 --focus 5 --quiet
"$root/usr/bin/postlens" image "$folder/frame.exr" -o "$folder/frame.jpg" --quiet
grep -q "circle of confusion" <(tr 'A-Z' 'a-z' <"$root/usr/share/man/man1/postlens-lens-coc.1")
[[ -f $root/usr/share/bash-completion/completions/postlens ]]
PYTHONPATH=$root/usr/lib/python3/dist-packages PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 -c "
import postlens
assert postlens.__file__.startswith('$root')
postlens.open('$folder/frame.exr').focus(f_number=2, focus_m=5).save('$folder/b.exr')
postlens.read_picture('$folder/frame.jpg')"
cmp "$folder/a.exr" "$folder/b.exr"

"${dpkg[@]}" --purge python3-postlens libpostlens-dev postlens >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
left=$(find "$root" -type f -not -path "$root/var/*")
[[ -z $left ]] || { echo "packages_test.sh: left behind: $left" >&2; exit 1; }
