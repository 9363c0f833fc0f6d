#!/usr/bin/env bash
# Every C file passes both compilers without a warning; every public header compiles alone, as C11 and as C++17.
. "$(dirname "$0")/gate.sh"

read -ra flags <<<"${GATE_CFLAGS:?is set by the Makefile}"

for_host() {
    read -ra flags <<<"$GATE_CFLAGS"
    gcc "${flags[@]}" -fsyntax-only "$1" && clang "${flags[@]}" -fsyntax-only "$1"
}

for_target() {
    read -ra flags <<<"$GATE_CFLAGS"
    arm-none-eabi-gcc -mthumb -mcpu=cortex-m4 "${flags[@]}" -DUNITY_INCLUDE_CONFIG_H -UUNITY_INCLUDE_DOUBLE \
        -fsyntax-only "$1"
}

alone() {
    local source="#include <joulepath/$(basename "$1")>"
    local warnings=(-Wall -Wextra -Wconversion -Wshadow -Werror -Iinclude -fsyntax-only)
    gcc -std=c11 "${warnings[@]}" -x c - <<<"$source" && clang -std=c11 "${warnings[@]}" -x c - <<<"$source" &&
        g++ -std=c++17 "${warnings[@]}" -x c++ - <<<"$source"
}
export -f for_host for_target alone

mapfile -t on_target < <(sources c tests/target tests/bench | grep -E 'tests/target/|/target_')
mapfile -t on_host < <(sources c src hal sim tests | grep -vE 'tests/target/|/target_|^hal/stm32')
mapfile -t headers < <(sources h include)
check_each for_host "${on_host[@]}"
check_each for_target "${on_target[@]}"
check_each alone "${headers[@]}"
finish
