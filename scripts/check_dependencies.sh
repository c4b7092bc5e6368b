#!/usr/bin/env bash
# Holds the packages of install_dependencies.sh against what CMake looks for, so that a fresh machine with exactly
# those packages can configure postlens even though this one has more installed. Fails when
# - something that the CMake files look for belongs to no package of the list, or
# - a CMake package insists on a file that the listed packages and their dependencies do not bring.
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
# Fills `owner` for all files given with one question, as each takes dpkg a look through every list of files.
# Older packages' lists leave out the /usr.
find_owners() {
    local package name
    while IFS=$'\t' read -r package name; do
        owner[$name]=$package
        owner[/usr$name]=$package
    done < <({ dpkg-query -S "$@" "${@#/usr}" 2>/dev/null || true; } | sed -nE 's/^([^:, ]+)[^/]*: (.*)/\1\t\2/p')
}
# The value of the first cache entry whose name matches.
cached() {
    sed -nE "s#^($1):[A-Z]+=(/.*)#\\2#p" "$cache" | head -n 1
}

failures=0
complain() {
    echo "check_dependencies.sh: $*" >&2
    failures=$((failures + 1))
}

# Packages: the folder of the CMake package, or the library or header that a find module of CMake's own found.
mapfile -t cmake_files < <(git ls-files --cached --others --exclude-standard -- '*CMakeLists.txt' '*.cmake' ':!samples')
mapfile -t names < <(sed -nE 's/^ *find_package\(([A-Za-z0-9_]+).*/\1/p' "${cmake_files[@]}" | sort -u)
mapfile -t variables < <(sed -nE 's/^ *find_(path|library)\(([A-Za-z0-9_]+).*/\2/p' "${cmake_files[@]}" | sort -u)
declare -A found=()
config_folders=()
for name in "${names[@]}" "${variables[@]}"; do
    # Its place is no entry of the cache; the package that has its headers only names those that hold the files.
    if [[ $name == Python3 ]]; then
        is_listed python3-dev || complain "Python3: install_dependencies.sh does not list python3-dev"
        continue
    fi
    if folder=$(cached "${name}_DIR") && [[ -n $folder ]]; then
        config_folders+=("$folder")
        file=$(find -L "$folder" -maxdepth 1 -iname "$name*config.cmake" | head -n 1)
    elif file=$(cached "$name") && [[ -n $file ]]; then
        # A folder of headers is everybody's; the header in it is the package's.
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

# Files: those whose absence makes the targets of a CMake package an error, against all that the list brings.
brought=$(dpkg-query -W -f='${Package}\t${Pre-Depends}, ${Depends}\t${Provides}\n' |
    awk -F '\t' -v wanted="${listed[*]}" '
        # Names alone: versions, architectures and alternatives are all the same here.
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
    # What no installed package holds did not stop CMake here: its check was softened by the packager.
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
