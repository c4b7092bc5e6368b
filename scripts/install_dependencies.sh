#!/usr/bin/env bash
# Installs the missing ones of the Debian 12 packages with which postlens is built and checked. If none is missing, the
# script needs neither a network nor root.
#
#   scripts/install_dependencies.sh [--for build|checks|cpus|peers|fuzzing] [--list]
#
#   --for build    what building, running and testing need
#   --for checks   what building needs, and the tools of the checks in scripts/test.sh (default)
#   --for cpus     what scripts/check_instruction_sets.sh and scripts/check_aarch64.sh need beside the program
#   --for peers    what `checks` needs, and the programs with which postlens works (Blender, Slurm)
#   --for fuzzing  what building needs, and the compiler of scripts/fuzz.sh
#   --list         print the packages and install nothing
set -euo pipefail

# cmake/postlens_dependencies.cmake searches for these libraries. scripts/check_dependencies.sh compares both lists.
build_packages=(
    cmake g++ ninja-build pkg-config ccache
    libembree-dev libtbb-dev libglm-dev libfmt-dev
    libopenexr-dev libimath-dev
    # The CMake package of libopenimageio-dev requires the programs of openimageio-tools.
    libopenimageio-dev openimageio-tools libpng-dev
    libopencv-dev
    libassimp-dev
    libfftw3-dev libceres-dev
    libcli11-dev libtomlplusplus-dev nlohmann-json3-dev
    libxxhash-dev libdeflate-dev libssl-dev libcpp-httplib-dev
    pybind11-dev python3-dev python3-numpy
    libgtest-dev libgmock-dev libbenchmark-dev
    gnuplot-nox
)
# chromium displays the page that `postlens chart` writes. chromium-driver and selenium test the viewer. help2man and
# dpkg-dev make the Debian packages of postlens. The other Python packages test the Python module.
check_packages=(git doxygen clang-format clang-tidy chromium help2man dpkg-dev file
    python3-pytest mypy chromium-driver python3-selenium)
cpus_packages=("${build_packages[@]}" qemu-user g++-aarch64-linux-gnu)
# xvfb, xauth and xdotool provide a display and key presses for the tests in Blender's window. nbconvert, ipykernel and
# matplotlib run the notebook.
peers_packages=("${build_packages[@]}" "${check_packages[@]}" blender xvfb xauth xdotool slurm-wlm munge
    python3-nbconvert python3-ipykernel python3-matplotlib)
# clang only recommends the package with libFuzzer and the run time of the sanitizers, so it is listed.
fuzzing_packages=(clang libclang-rt-14-dev)

purpose=checks
list_only=false
while (($# > 0)); do
    case $1 in
        --for) purpose=${2:-} && shift ;;
        --list) list_only=true ;;
        -h | --help) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0" && exit 0 ;;
        *) echo "install_dependencies.sh: unknown argument (got $1; expected --for or --list)" >&2 && exit 2 ;;
    esac
    shift || true
done
case $purpose in
    build) packages=("${build_packages[@]}") ;;
    checks) packages=("${build_packages[@]}" "${check_packages[@]}") ;;
    cpus) packages=("${cpus_packages[@]}") ;;
    peers) packages=("${peers_packages[@]}") ;;
    fuzzing) packages=("${build_packages[@]}" "${fuzzing_packages[@]}") ;;
    *) echo "install_dependencies.sh: unknown purpose (got '$purpose'; expected build, checks, cpus, peers or fuzzing)" >&2 && exit 2 ;;
esac
if $list_only; then
    printf '%s\n' "${packages[@]}"
    exit 0
fi

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "install_dependencies.sh: this is no Debian system, nothing was installed; needed are what Debian 12 calls:" >&2
    echo "  ${packages[*]}" >&2
    exit 0
fi

installed=$(dpkg-query -W -f='${Package} ${db:Status-Status}\n' "${packages[@]}" 2>/dev/null || true)
missing=()
for package in "${packages[@]}"; do
    grep -qx "$package installed" <<<"$installed" || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
    exit 0
fi

as_root=()
if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
        echo "install_dependencies.sh: missing packages, and neither root nor sudo to install them. As root, run:" >&2
        echo "  apt-get install --no-install-recommends ${missing[*]}" >&2
        exit 1
    fi
    as_root=(sudo)
fi
apt_get() {
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3 "$@" \
        </dev/null
}
install_missing() {
    apt_get install -y --no-install-recommends "${missing[@]}"
}

echo "Installing ${missing[*]}"
# The package lists are updated only if a package is in none of them, or if the installation fails.
lists_know_all=true
for package in "${missing[@]}"; do
    apt-cache show --no-all-versions "$package" >/dev/null 2>&1 || lists_know_all=false
done
if $lists_know_all && install_missing; then
    exit 0
fi
apt_get update
install_missing
