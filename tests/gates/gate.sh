# Sourced by each gate: checks files in parallel and prints the results in the format of Unity.
# shellcheck shell=bash
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.." || exit 2

gate=$(basename "$0" .sh)
results=$(mktemp -d)
export gate results
trap 'rm -rf "$results"' EXIT

# tools_of VARIANT[/NAME]: prefix of the binary tools for what was built for it.
tools_of() {
    case $1 in
    rv32*) echo riscv64-unknown-elf- ;;
    *) echo arm-none-eabi- ;;
    esac
}

# check NAME COMMAND...: one test of that name, which passes when COMMAND does; its output explains a failure.
check() {
    local name=$1 output place reason
    shift
    if output=$("$@" 2>&1); then
        echo "$name:1:$gate:PASS" >"$results/${name//\//%}"
        return
    fi
    output=${output//"$PWD/"/}
    reason=$(grep -m1 -E 'error: ' <<<"$output" || grep -m1 -E '^[^ :]+:[0-9]+:' <<<"$output" || head -n 1 <<<"$output")
    place=$(grep -oE '^[^ :]+:[0-9]+' <<<"$reason" || echo "$name:1")
    {
        echo "$place:$gate:FAIL: ${reason##*error: }"
        sed 's/^/    /' <<<"$output"
    } >"$results/${name//\//%}"
}
export -f check

# check_each FUNCTION FILE...: check FILE FUNCTION FILE, several at once. FUNCTION must be exported.
check_each() {
    local function=$1
    shift
    [ $# -eq 0 ] || printf '%s\0' "$@" | xargs -0 -P "${JOBS:-$(nproc)}" -I{} bash -c 'check "$1" "$2" "$1"' - {} "$function"
}

# check_together FUNCTION FILE...: the same for a FUNCTION that takes several files, because its program takes long to start.
# When it finds something, each of the files is checked alone.
check_together() {
    local function=$1
    shift
    [ $# -eq 0 ] || printf '%s\0' "$@" | xargs -0 -P "${JOBS:-$(nproc)}" -n 12 bash -c 'check_group "$@"' - "$function"
}

check_group() {
    local function=$1 file
    shift
    if "$function" "$@" >/dev/null 2>&1; then
        for file in "$@"; do
            check "$file" true
        done
    else
        for file in "$@"; do
            check "$file" "$function" "$file"
        done
    fi
}
export -f check_group

# sources SUFFIX DIRECTORY...: the files of those directories.
sources() {
    local suffix=$1
    shift
    find "$@" -name "*.$suffix" 2>/dev/null | sort
}

# written_by_hand SUFFIX DIRECTORY...: the same without the CAN codec, whose style is that of its generator, cantools.
written_by_hand() {
    sources "$@" | grep -vE '^hal/can/jp_can\.[ch]$'
}

# What other cores have and this library asks for, in include/joulepath/fixed.h and src/base/compiler.h; cppcheck takes
# every source once with and once without each. Few sources differ by it: those that hold one of these names.
same_everywhere=(-U__ARM_ARCH_ISA_THUMB -U__ARM_FEATURE_DSP -U__OPTIMIZE_SIZE__ -UJP_NO_DSP)
differing_names='JP_DSP|JP_INLINE_FOR_SPEED|JP_LONG_MULTIPLY|jp_saturate_bits'

# Prints all results and their counts; a gate that checked nothing has failed.
finish() {
    local passed failed
    find "$results" -type f -print0 | sort -z | xargs -0 -r cat
    passed=$(cat "$results"/* 2>/dev/null | grep -cE "^[^ ].*:$gate:PASS$")
    failed=$(cat "$results"/* 2>/dev/null | grep -cE "^[^ ].*:$gate:FAIL: ")
    printf '\n-----------------------\n%d Tests %d Failures 0 Ignored \n' $((passed + failed)) "$failed"
    if [ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]; then
        echo OK
        exit 0
    fi
    echo FAIL
    exit 1
}
