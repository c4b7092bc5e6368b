#!/usr/bin/env bash
# Checks that the program runs on every x86-64 processor, with bit-identical results. core/multiversion.h compiles
# clones of functions for newer processors. This script checks that only these clones contain AVX instructions, that the
# compiler adds no fused multiply-add, that processors emulated by qemu run the clones made for them, and that their
# output files are equal to those of this machine (except for the last bits of FFTW's results:
# tests/instruction_sets/compare_results.sh).
#
#   scripts/check_instruction_sets.sh [PROGRAM]     PROGRAM: default build/release/apps/postlens
#
# Needs qemu-x86_64 (scripts/install_dependencies.sh --for cpus).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

program=${1:-build/release/apps/postlens}
if [[ ! -x $program ]]; then
    echo "check_instruction_sets.sh: $program is missing; build it with scripts/build.sh" >&2
    exit 2
fi
for tool in qemu-x86_64 objdump nm idiff; do
    if ! command -v "$tool" >/dev/null; then
        echo "check_instruction_sets.sh: there is no $tool; install it with: scripts/install_dependencies.sh --for cpus" >&2
        exit 2
    fi
done
if [[ $(uname -m) != x86_64 ]]; then
    echo "check_instruction_sets.sh: compares with what an x86-64 machine writes itself (got $(uname -m))" >&2
    exit 2
fi

folder=$(mktemp -d "${TMPDIR:-/tmp}/instruction_sets.XXXXXX")
trap 'rm -rf "$folder"' EXIT
failures=0
complain() {
    echo "check_instruction_sets.sh: $*" >&2
    failures=$((failures + 1))
}

# --- Instructions of the program ---

# Names of the functions that have clones.
nm "$program" | sed -nE 's/^[0-9a-f]+ [a-zA-Z] (.*)\.(default|arch_x86_64_v[34])(\.[0-9]+)?$/\1/p' | sort -u >"$folder/functions"
functions=$(wc -l <"$folder/functions")
((functions > 0)) || complain "$program has no clones; was it built with POSTLENS_NO_MULTIVERSION?"

# VEX and EVEX instructions begin with v (but not verr and verw), and mask instructions with k. The other names are
# those of BMI. A fused multiply-add is allowed only if the default clone calls fma(), because it rounds differently
# from a product and a sum.
objdump -d --no-show-raw-insn "$program" | awk -F '\t' -v foreign="$folder/foreign" -v fused="$folder/fused" '
    /^[0-9a-f]+ <.*>:$/ { name = $1; sub(/^[^<]*</, "", name); sub(/>:$/, "", name); next }
    $2 ~ /^(v[a-z]|k(mov|x?n?or|andn?|xor|not|shift|unpck)[bwdq]|(andn|bextr|bls(i|r|msk)|bzhi|mulx|pdep|pext|rorx|s[ah][lr]x) )/ &&
        $2 !~ /^ver[rw]/ && name !~ /\.arch_x86_64_v[34]/ { beyond[name]++ }
    $2 ~ /^vfn?m(add|sub)/ { function_of[name] = name; sub(/\.arch_x86_64_v[34].*/, "", function_of[name]) }
    $2 ~ /^call.*<fmaf?@plt>/ { sub(/\.default.*/, "", name); asked[name] = 1 }
    END {
        for (name in beyond) print beyond[name], name > foreign
        for (name in function_of) if (!(function_of[name] in asked)) print name > fused
    }'
touch "$folder/foreign" "$folder/fused"
if [[ -s $folder/foreign ]]; then
    complain "instructions beyond x86-64 outside the clones, by function:"
    c++filt <"$folder/foreign" >&2
fi
if [[ -s $folder/fused ]]; then
    complain "fused multiply-adds that the source does not ask for:"
    c++filt <"$folder/fused" >&2
fi
echo "$program: $functions functions with clones, $(wc -l <"$folder/foreign") others with AVX," \
    "$(wc -l <"$folder/fused") with a fused multiply-add of the compiler's own"

# --- Output files ---

began_s=$SECONDS
tests/instruction_sets/results.sh "$folder/native" "$program"
echo "this machine: $(find "$folder/native" -type f | wc -l) files, $((SECONDS - began_s)) s"

# The addresses at which qemu loads a position-independent program. The range is larger than the program.
first=0x4000000000
range=$first..$(printf '0x%x' $((first + 2 * $(stat -Lc %s "$program"))))

# check MODEL SUFFIX: checks that all clones that run have this suffix, and that the files are equal to this machine's.
check() {
    local model=$1 suffix=$2 out=$folder/$1 log=$folder/$1.log began_s=$SECONDS other
    # The log lists the functions that qemu translated, that is, those that ran. Each command has its own log.
    if ! tests/instruction_sets/results.sh "$out" qemu-x86_64 -cpu "$model" -d in_asm -dfilter "$range" -D "$log.%d" "$program" \
        2>"$folder/errors"; then
        complain "$model: the program fails"
        grep -v "TCG doesn't support requested feature" "$folder/errors" >&2 || true
        return
    fi
    # The default clone may have the plain name.
    cat "$log".* | sed -nE -e 's/^IN: (.*)\.(default|arch_x86_64_v[34])(\..*)?$/\1 \2/p' -e t -e 's/^IN: (.*)$/\1 default/p' |
        sort -u | awk 'NR == FNR { has_clones[$1]; next } $1 in has_clones' "$folder/functions" - >"$folder/ran"
    rm -f "$log".*
    other=$(grep -vc " $suffix\$" "$folder/ran" || true)
    ((other == 0)) || complain "$model: $other functions run in another clone than $suffix"
    [[ -s $folder/ran ]] || complain "$model: no clone was seen to run"
    cut -d ' ' -f 1 "$folder/ran" | comm -13 - "$folder/functions" >"$folder/idle"
    echo "$model: $(wc -l <"$folder/ran") functions ran, all as $suffix; $((SECONDS - began_s)) s"
    tests/instruction_sets/compare_results.sh "$out" "$folder/native" || complain "$model: not what this machine writes"
}
# One of the first 64-bit processors, one of the last without AVX, and one with AVX2 and fused multiply-add.
check Opteron_G1 default
check Nehalem default
check Haswell arch_x86_64_v3

if [[ -s $folder/idle ]]; then
    echo "never at work in tests/instruction_sets/results.sh:"
    c++filt <"$folder/idle" | sed 's/^/  /'
fi
((failures == 0))
