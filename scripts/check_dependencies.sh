#!/usr/bin/env bash
# Checks that a new machine that has only the packages of install_dependencies.sh can configure postlens. Fails if
# - the CMake files search for something that is in none of these packages, or
# - a CMake package requires a file that is neither in these packages nor in their dependencies.
#
#   scripts/check_dependencies.sh [BUILD]     BUILD: a configured build folder (default: build/release)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build=${1:-build/release}
cache=$build/CMakeCache.txt
if [[ ! -f $cache ]]; then
    echo "check_dependencies.sh: $cache is missing; configure with: cmake --preset release" >&2
    exit 1
fi
if ! command -v dpkg-query >/dev/null; then
    echo "dependencies: not checked, this is no Debian system"
    exit 0
fi

mapfile -t listed < <(scripts/install_dependencies.sh --for build --list)
is_listed() {
    printf '%s\n' "${listed[@]}" | grep -qx -- "$1"
}
declare -A owner=()
# Sets `owner` to the packages of all given files. dpkg is called only once, because every call reads the file lists of
# all packages. The lists of older packages omit /usr.
find_owners() {
    local package name
    while IFS=$'\t' read -r package name; do
        owner[$name]=$package
        owner[/usr$name]=$package
    done < <({ dpkg-query -S "$@" "${@#/usr}" 2>/dev/null || true; } | sed -nE 's/^([^:, ]+)[^/]*: (.*)/\1\t\2/p')
}
# Prints the value of the first cache entry whose name matches.
cached() {
    sed -nE "s#^($1):[A-Z]+=(/.*)#\\2#p" "$cache" | head -n 1
}

failures=0
complain() {
    echo "check_dependencies.sh: $*" >&2
    failures=$((failures + 1))
}

# For each package, finds the folder of the CMake package, or the library or header that a find module of CMake found.
mapfile -t cmake_files < <(git ls-files --cached --others --exclude-standard -- '*CMakeLists.txt' '*.cmake' ':!samples')
mapfile -t names < <(sed -nE 's/^ *find_package\(([A-Za-z0-9_]+).*/\1/p' "${cmake_files[@]}" | sort -u)
mapfile -t variables < <(sed -nE 's/^ *find_(path|library)\(([A-Za-z0-9_]+).*/\2/p' "${cmake_files[@]}" | sort -u)
declare -A found=()
config_folders=()
for name in "${names[@]}" "${variables[@]}"; do
    # The cache has no entry for the path of Python3. The files are in packages on which python3-dev depends.
    if [[ $name == Python3 ]]; then
        is_listed python3-dev || complain "Python3: install_dependencies.sh does not list python3-dev"
        continue
    fi
    if folder=$(cached "${name}_DIR") && [[ -n $folder ]]; then
        config_folders+=("$folder")
        file=$(find -L "$folder" -maxdepth 1 -iname "$name*config.cmake" | head -n 1)
    elif file=$(cached "$name") && [[ -n $file ]]; then
        # Many packages share a folder of headers, so the header itself identifies the package.
        header=$(sed -nE "s/^ *find_path\($name ([^ )]+).*/\1/p" "${cmake_files[@]}" | head -n 1)
        file=$file${header:+/$header}
    else
        file=$(cached "${name^^}_[A-Z0-9_]*LIBRARY[A-Z_]*")
    fi
    if [[ -n $file ]]; then
        found[$name]=$file
    else
        complain "$name: the CMake files look for it, $cache does not say where it was found"
    fi
done
find_owners "${found[@]}"
for name in "${!found[@]}"; do
    package=${owner[${found[$name]}]:-}
    if [[ -z $package ]]; then
        complain "$name: no Debian package holds ${found[$name]}"
    elif ! is_listed "$package"; then
        complain "$name: found in package $package, which install_dependencies.sh does not list"
    fi
done

# Checks that the listed packages and their dependencies contain all files that the CMake packages require.
brought=$(dpkg-query -W -f='${Package}\t${Pre-Depends}, ${Depends}\t${Provides}\n' |
    awk -F '\t' -v wanted="${listed[*]}" '
        # Uses only the names of packages, ignores versions and architectures, and accepts all alternatives.
        function names(text, out) {
            gsub(/\([^)]*\)|:[a-z0-9]+/, "", text)
            return split(text, out, /[ ,|]+/)
        }
        {
            depends[$1] = $2
            n = names($3, provided)
            for (i = 1; i <= n; i++) if (provided[i] != "") providers[provided[i]] = providers[provided[i]] " " $1
        }
        END {
            todo = split(wanted, queue, " ")
            for (next_one = 1; next_one <= todo; next_one++) {
                package = queue[next_one]
                if (package in seen) continue
                seen[package] = 1
                if (package in depends) print package
                n = names(depends[package] " " providers[package], more)
                for (i = 1; i <= n; i++) if (more[i] != "" && !(more[i] in seen)) queue[++todo] = more[i]
            }
        }')
mapfile -t insisted < <(
    for folder in "${config_folders[@]}"; do
        grep -hE '^list\(APPEND _(cmake_import_check_files_for|IMPORT_CHECK_FILES_FOR)_' "$folder"/*.cmake || true
    done | grep -oE '/[^" ]+' | sed 's#^#/usr#' | sort -u
)
find_owners "${insisted[@]}"
checked=0
for file in "${insisted[@]}"; do
    # A file that no installed package contains did not make CMake fail on this machine, so it is not required.
    package=${owner[$file]:-}
    [[ -n $package ]] || continue
    checked=$((checked + 1))
    grep -qx -- "$package" <<<"$brought" ||
        complain "$file: a CMake package insists on it; its package $package is not among what the list brings"
done

if ((failures > 0)); then
    exit 1
fi
echo "dependencies: ${#names[@]} CMake packages, ${#variables[@]} headers and libraries, $checked files they insist on"
