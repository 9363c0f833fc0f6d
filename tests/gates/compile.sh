#!/usr/bin/env bash
# Every C file passes both compilers without a warning: those that no test builds with gcc, and that tidy.sh does not take
# through clang, do it here. All public headers compile together with all of the HAL; that each compiles alone, in C and
# C++, tests/package tests of those installed.
. "$(dirname "$0")/gate.sh"

read -ra flags <<<"${GATE_CFLAGS:?is set by the Makefile}"

for_clang() {
    read -ra flags <<<"$GATE_CFLAGS"
    clang "${flags[@]}" -fsyntax-only "$@"
}

for_gcc() {
    read -ra flags <<<"$GATE_CFLAGS"
    gcc "${flags[@]}" -fsyntax-only "$@"
}

for_target() {
    read -ra flags <<<"$GATE_CFLAGS"
    arm-none-eabi-gcc -mthumb -mcpu=cortex-m4 "${flags[@]}" -DUNITY_INCLUDE_CONFIG_H -UUNITY_INCLUDE_DOUBLE \
        -fsyntax-only "$@"
}

# With those of one board: an image is of one.
together() {
    local flags headers other
    read -ra flags <<<"$GATE_CFLAGS"
    for other in hal/mps2 hal/stm32f4; do
        mapfile -t headers < <(sources h include/joulepath hal | grep -v "^$other/")
        printf '#include "%s"\n' "${headers[@]}" | gcc "${flags[@]}" -fsyntax-only -x c - || return
    done
}
export -f for_clang for_gcc for_target

mapfile -t on_target < <(sources c tests/target tests/bench | grep -E 'tests/target/|/target_')
mapfile -t benches < <(sources c tests/bench | grep -v /target_)
mapfile -t not_tidied < <(sources c tests/support && comm -23 <(sources c src hal sim) <(written_by_hand c src hal sim))
check_together for_clang "${benches[@]}" "${not_tidied[@]}"
check_together for_gcc "${benches[@]}"
check together together
check_together for_target "${on_target[@]}"
finish
