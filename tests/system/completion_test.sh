#!/usr/bin/env bash
# Completion offers the subcommands, options and words that --help lists.
#
#   completion_test.sh COMPLETION PROGRAM
set -euo pipefail
source "$1"
program=$2

# offers WANTED WORDS...: what completing the last of the words offers.
offers() {
    local wanted=$1
    shift
    COMP_WORDS=("$program" "$@")
    COMP_CWORD=$#
    COMPREPLY=()
    _postlens
    if [[ ${COMPREPLY[*]-} != "$wanted" ]]; then
        echo "completion_test.sh: $* (got ${COMPREPLY[*]-}; expected $wanted)" >&2
        exit 1
    fi
}

offers "focus" fo
offers "trace image records render focus motionblur shoot sweep lens compare chart view merge info" ""
offers "coc" lens c
offers "scatter layers lightfield hybrid auto pinhole" focus a.exr --method ""
offers "layers lightfield" focus a.exr --method l
offers "layers lightfield" focus a.exr --method = l
offers "auto" trace scene.toml --overscan =
offers "auto" trace scene.toml --overscan ""
offers "W path first-hit" focus a.exr --depth-model ""
offers "distance inverse normalized:" focus a.exr --depth-encoding ""
offers "--focal-length --f-number --focus" lens coc --f
offers "" focus a
