#!/usr/bin/env bash
# cppcheck finds nothing in the library, the HAL and the simulator.
. "$(dirname "$0")/gate.sh"

examine() {
    cppcheck --quiet --error-exitcode=1 --std=c11 --inline-suppr --enable=warning,performance,portability,style \
        --suppressions-list=tests/gates/cppcheck.txt --template='{file}:{line}: {severity}: {message} [{id}]' \
        -Iinclude -I. "$@"
}

examine_once() {
    local same
    read -ra same <<<"$same_words"
    examine "${same[@]}" "$@"
}
export -f examine examine_once
export same_words="${same_everywhere[*]}"

mapfile -t differing < <(written_by_hand c src hal sim | xargs grep -lE "$differing_names")
mapfile -t alike < <(written_by_hand c src hal sim | xargs grep -LE "$differing_names")
check_together examine "${differing[@]}"
check_together examine_once "${alike[@]}"
finish
