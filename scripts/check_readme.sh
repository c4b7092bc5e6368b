#!/usr/bin/env bash
# Checks the shell commands in README.md and docs/. Fails if a script is missing or not executable, if a file of the
# repository does not exist, if `postlens --help` does not list a subcommand or an option, if a CMake preset is not
# defined, or if a program is not installed. Prints the file and line of each error.
#
#   scripts/check_readme.sh [--postlens PROGRAM] [FILE.md...]
#
#   --postlens PROGRAM  the program whose --help is used (default: build/release/apps/postlens)
#   FILE.md             the files to check (default: README.md, docs/*.md and docs/tutorials/*.md)
#
# Code blocks marked sh, bash, shell or console are checked (in console, only lines that begin with "$ "). In blocks
# without a mark, only lines that begin with postlens or scripts/ are checked. Text in <...> or in capitals is a
# placeholder.
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

# Prints "LINE<tab>COMMAND" for each command of a document. Lines that end with a backslash are joined with the next.
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
            # Commands joined by ||, &&, | or ; are printed on separate lines.
            gsub(/ (\|\||&&|\||;) /, "\n" first "\t", text)
            if (text ~ /[^ ]/) print first "\t" text
        }' "$1"
}

declare -A help_texts=()
help=''
# Sets `help` to the output of `postlens WORDS --help`, or to an empty text if there is no such subcommand.
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
        [[ $'\n'$help$'\n' =~ [[:space:],[]$option[][:space:],=:] ]] || complain "postlens${path[*]:+ ${path[*]}} has no option $option"
    done
}

# Returns whether build/PRESET/FILE exists, or is a target that the build of all targets leaves out.
is_built() {
    [[ -x $1 ]] || ninja -C "$(cut -d/ -f1-2 <<<"$1")" -t query "$(cut -d/ -f3- <<<"$1")" >/dev/null 2>&1
}

check_command() {
    local words word split
    # xargs splits a line into words as a shell does, and interprets quotes.
    if ! split=$(xargs printf '%s\n' <<<"$1" 2>/dev/null); then
        complain "cannot be read as a command: $1"
        return
    fi
    mapfile -t words <<<"$split"
    # Removes keywords such as `do`, and environment variables, before the command.
    while [[ ${words[0]:-} =~ ^(do|then|else|time|!|[A-Za-z_][A-Za-z0-9_]*=.*)$ ]]; do words=("${words[@]:1}"); done
    [[ ${words[0]:-} =~ ^(|for|while|if|done|fi|cd|export|source)$ ]] && return
    commands=$((commands + 1))

    case ${words[0]} in
        bash | sh) [[ ${words[1]:-} == -* || -f ${words[1]:-} ]] || complain "there is no ${words[1]:-script to run}" ;;
        postlens | */apps/postlens) check_postlens "${words[@]:1}" ;;
        scripts/* | ./scripts/* | .ci/*) [[ -x ${words[0]} ]] || complain "${words[0]} is missing or not executable" ;;
        build/* | ./build/*) is_built "${words[0]#./}" || complain "${words[0]} is not what the build makes" ;;
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
