#!/usr/bin/env bash
# cppcheck finds nothing in the library, the HAL and the simulator.
. "$(dirname "$0")/gate.sh"

examine() {
    cppcheck --quiet --error-exitcode=1 --std=c11 --inline-suppr --enable=warning,performance,portability,style \
        --suppressions-list=tests/gates/cppcheck.txt --template='{file}:{line}: {severity}: {message} [{id}]' \
        -Iinclude -I. "$1"
}
export -f examine

mapfile -t files < <(written_by_hand c src hal sim)
check_each examine "${files[@]}"
finish
