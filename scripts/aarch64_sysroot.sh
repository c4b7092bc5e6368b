#!/usr/bin/env bash
# Downloads Debian 12's arm64 packages of the libraries that postlens needs, and unpacks them into a folder for a
# cross-compiler. The packages of this machine are not changed. The download has 280 MB, the folder 1.3 GB.
#
#   scripts/aarch64_sysroot.sh FOLDER     a complete FOLDER from an earlier run is not changed
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if (($# != 1)); then
    echo "aarch64_sysroot.sh: needs a folder (got: $*)" >&2
    exit 2
fi
mkdir -p "$1"
root=$(cd "$1" && pwd)
if [[ -e $root/.complete ]]; then
    exit 0
fi

# apt is set up for an empty system, so that it also downloads all dependencies of the packages.
apt=$root/.apt
mkdir -p "$apt"/{state/lists/partial,cache/archives/partial,sources.d}
: >"$apt/status"
cat >"$apt/apt.conf" <<END
Dir::State "$apt/state";
Dir::State::status "$apt/status";
Dir::Cache "$apt/cache";
Dir::Etc::SourceList "/dev/null";
Dir::Etc::SourceParts "$apt/sources.d";
Dir::Etc::Parts "/dev/null";
APT::Architecture "arm64";
APT::Architectures { "arm64"; };
APT::Install-Recommends "false";
APT::Sandbox::User "$(id -un)";
Acquire::Languages "none";
Acquire::Retries "3";
END
cat >"$apt/sources.d/debian.sources" <<END
Types: deb
URIs: http://deb.debian.org/debian
Suites: bookworm bookworm-updates
Components: main
Signed-By: /usr/share/keyrings/debian-archive-keyring.gpg
END
export APT_CONFIG=$apt/apt.conf

# Libraries only, as the build uses programs of this machine. BLAS and LAPACK are the reference implementations.
mapfile -t packages < <(scripts/install_dependencies.sh --for build --list |
    grep -vxE 'cmake|g\+\+|ninja-build|pkg-config|ccache|gnuplot-nox')
packages+=(libstdc++-12-dev libblas-dev liblapack-dev)
apt-get -q update
apt-get -q -y --download-only install "${packages[@]}"

for folder in bin lib sbin; do
    mkdir -p "$root/usr/$folder"
    ln -sfn "usr/$folder" "$root/$folder"
done
for package in "$apt"/cache/archives/*.deb; do
    dpkg-deb --fsys-tarfile "$package" | tar -x --keep-directory-symlink --no-same-owner -C "$root"
done
libraries=$root/usr/lib/aarch64-linux-gnu
# On an installed system, update-alternatives makes these links.
ln -sf blas/libblas.so{,.3} lapack/liblapack.so{,.3} "$libraries"
# Absolute paths in links and in CMake's packages are changed to paths in this folder.
find "$root" -type l -lname '/*' | while IFS= read -r link; do
    target=$root$(readlink "$link")
    [[ ! -e $target ]] || ln -sfnr "$target" "$link"
done
find "$libraries/cmake" "$root"/usr/share/{cmake,*/cmake} -name '*.cmake' -exec \
    sed -i -E "/_realOrig/!s#(^|[^A-Za-z0-9_./}-])/usr/(lib|include|share)#\\1$root/usr/\\2#g" {} +
rm -rf "$apt"
touch "$root/.complete"
