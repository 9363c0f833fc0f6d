#!/usr/bin/env bash
# clang-tidy finds nothing in the library, the HAL and the simulator, and clang has no warning for them; .clang-tidy says
# what it looks for. Its static analyser, which takes thirty times as long, runs in analyse.sh.
. "$(dirname "$0")/gate.sh"

: "${GATE_CFLAGS:?is set by the Makefile}"

# clang-tidy comes without a compiler's own headers, such as stdbool.h; gcc's serve.
examine() {
    read -ra flags <<<"$GATE_CFLAGS"
    "${CLANG_TIDY:-clang-tidy}" --quiet "--checks=${checks:--clang-analyzer-*}" "$@" -- "${flags[@]}" -isystem "$(gcc -print-file-name=include)"
}
export -f examine

mapfile -t files < <(written_by_hand c src hal sim)
check_together examine "${files[@]}"
finish
