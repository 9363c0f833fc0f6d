#!/usr/bin/env bash
# cppcheck finds nothing in the library, the HAL and the simulator.
. "$(dirname "$0")/gate.sh"

examine() {
    local same=()
    grep -qE "$differing_names" "$1" || read -ra same <<<"$same_words"
    cppcheck --quiet --error-exitcode=1 --std=c11 --inline-suppr --enable=warning,performance,portability,style \
        --suppressions-list=tests/gates/cppcheck.txt --template='{file}:{line}: {severity}: {message} [{id}]' \
        -Iinclude -I. "${same[@]}" "$1"
}
export -f examine
export differing_names same_words="${same_everywhere[*]}"

mapfile -t files < <(written_by_hand c src hal sim)
check_each examine "${files[@]}"
finish
