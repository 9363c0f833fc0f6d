#!/usr/bin/env bash
# clang-tidy finds nothing in the library, the HAL and the simulator; .clang-tidy says what it looks for.
. "$(dirname "$0")/gate.sh"

: "${GATE_CFLAGS:?is set by the Makefile}"

examine() {
    read -ra flags <<<"$GATE_CFLAGS"
    clang-tidy --quiet "$1" -- "${flags[@]}"
}
export -f examine

mapfile -t files < <(sources c src hal sim)
check_each examine "${files[@]}"
finish
