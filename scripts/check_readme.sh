#!/usr/bin/env bash
# Fails, and says where, when a shell command that README.md shows does not exist: a script that is missing or not
# executable, a file of the repository that is not there, a subcommand or an option that `postlens --help` does not
# name, a CMake preset that is not defined, a program that is not installed.
#
#   scripts/check_readme.sh [--postlens PROGRAM] [FILE.md...]
#
#   --postlens PROGRAM  whose help counts (default: build/release/apps/postlens)
#   FILE.md             what to read (default: README.md, docs/*.md and docs/tutorials/*.md)
#
# Read are code blocks marked sh, bash, shell or console (there: lines that begin with "$ "), and in blocks without
# a mark the lines that begin with postlens or scripts/. Text inside <...> or in capitals stands for the reader's own.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

postlens=build/release/apps/postlens
if [[ ${1:-} == --postlens ]]; then
    postlens=${2:-}
    shift 2
fi
if (($# > 0)); then
    documents=("$@")
else
    documents=(README.md)
    for document in docs/*.md docs/tutorials/*.md; do
        [[ ! -f $document ]] || documents+=("$document")
    done
fi
if [[ ! -x $postlens ]]; then
    echo "check_readme.sh: $postlens is missing; build it with scripts/build.sh" >&2
    exit 1
fi

commands=0
failures=0
place=''
complain() {
    echo "$place: $*" >&2
    failures=$((failures + 1))
}

# Prints "LINE<tab>COMMAND" for each command of a document; a trailing backslash joins lines.
shell_lines() {
    awk '
        /^ *```/ {
            inside = !inside
            mark = $0
            sub(/^ *```+/, "", mark)
            sub(/[ {].*/, "", mark)
            pending = ""
            next
        }
        !inside { next }
        mark !~ /^(|sh|bash|shell|console)$/ { next }
        {
            text = $0
            if (pending == "") {
                if (mark == "console" && text !~ /^ *\$ /) next
                sub(/^ *(\$ +)?/, "", text)
                if (mark == "" && text !~ /^(\.\/)?(postlens |scripts\/|build\/[a-z]+\/apps\/postlens )/) next
                first = NR
            }
            if (sub(/\\ *$/, "", text)) { pending = pending text " "; next }
            text = pending text
            pending = ""
            sub(/(^| )#( .*|$)/, "", text)
            # One command per line of output, whatever joins them.
            gsub(/ (\|\||&&|\||;) /, "\n" first "\t", text)
            if (text ~ /[^ ]/) print first "\t" text
        }' "$1"
}

declare -A help_texts=()
help=''
# Sets `help` to what `postlens WORDS --help` prints, empty where there is no such subcommand.
ask_help() {
    if [[ -z ${help_texts["postlens $*"]+set} ]]; then
        help_texts["postlens $*"]=$("$postlens" "$@" --help </dev/null 2>/dev/null || true)
    fi
    help=${help_texts["postlens $*"]}
}

has_subcommand() { # in `help`
    sed -n '/^Subcommands:/,$p' <<<"$help" | grep -qE -- "^ +$1( |\$)"
}

check_postlens() {
    local path=() word option
    ask_help
    if [[ -z $help ]]; then
        complain "$postlens --help fails"
        return
    fi
    while (($# > 0)) && [[ $1 =~ ^[a-z][a-z-]*$ ]] && has_subcommand "$1"; do
        path+=("$1")
        shift
        ask_help "${path[@]}"
    done
    if ((${#path[@]} == 0)) && (($# > 0)) && [[ $1 != -* ]]; then
        complain "postlens has no subcommand $1"
        return
    fi
    for word in "$@"; do
        [[ $word =~ ^(--?[A-Za-z][A-Za-z0-9-]*)(=.*)?$ ]] || continue
        option=${BASH_REMATCH[1]}
        [[ $option != --help ]] || continue
        grep -qE -- "(^|[ ,[])$option([] ,=:]|\$)" <<<"$help" || complain "postlens${path[*]:+ ${path[*]}} has no option $option"
    done
}

check_command() {
    local words word split
    # xargs splits as a shell does, quotes included.
    if ! split=$(xargs -n 1 printf '%s\n' <<<"$1" 2>/dev/null); then
        complain "cannot be read as a command: $1"
        return
    fi
    mapfile -t words <<<"$split"
    # Keywords of a loop and settings of the environment stand before the command.
    while [[ ${words[0]:-} =~ ^(do|then|else|time|!|[A-Za-z_][A-Za-z0-9_]*=.*)$ ]]; do words=("${words[@]:1}"); done
    [[ ${words[0]:-} =~ ^(|for|while|if|done|fi|cd|export|source)$ ]] && return
    commands=$((commands + 1))

    case ${words[0]} in
        bash | sh) [[ ${words[1]:-} == -* || -f ${words[1]:-} ]] || complain "there is no ${words[1]:-script to run}" ;;
        postlens | */apps/postlens) check_postlens "${words[@]:1}" ;;
        scripts/* | ./scripts/* | .ci/*) [[ -x ${words[0]} ]] || complain "${words[0]} is missing or not executable" ;;
        build/* | ./build/*) [[ -x ${words[0]} ]] || complain "${words[0]} is not what the build makes" ;;
        *) command -v -- "${words[0]}" >/dev/null || complain "there is no program ${words[0]}" ;;
    esac
    for word in "${words[@]:1}"; do
        case $word in
            *'$'* | *'*'*) ;;
            samples/* | tests/* | docs/* | cmake/* | bench/*)
                [[ -e $word ]] || complain "there is no $word"
                ;;
        esac
    done
    for ((i = 1; i < ${#words[@]} - 1; i++)); do
        if [[ ${words[0]} =~ ^(cmake|ctest)$ && ${words[i]} == --preset ]]; then
            grep -qE "\"name\": \"${words[i + 1]}\"" CMakePresets.json || complain "there is no preset ${words[i + 1]}"
        fi
    done
}

for document in "${documents[@]}"; do
    place=$document
    if [[ ! -f $document ]]; then
        complain "is missing"
        continue
    fi
    before=$commands
    while IFS=$'\t' read -r line text; do
        place=$document:$line
        check_command "$text"
    done < <(shell_lines "$document")
    place=$document
    if [[ $document == README.md ]] && ((commands == before)); then
        complain "shows no command"
    fi
done
if ((failures > 0)); then
    exit 1
fi
echo "documents: $commands commands in ${#documents[@]} files"
