#!/usr/bin/env bash
# Core and CAN application on a microcontroller need no library but memcpy, memset, memmove and the compiler's integer
# helpers, and have no writable data. Arguments: the libraries built for the targets; each object in them is one test.
# jp_can.o is left out: cantools always emits functions with `double`, and the gate `firmware` proves them dropped.
. "$(dirname "$0")/gate.sh"

allowed='^(memcpy|memset|memmove|__aeabi_mem(cpy|set|move|clr)[48]?'
allowed+='|__aeabi_(u?idiv|u?idivmod|u?ldivmod|lmul|llsl|llsr|lasr|lcmp|ulcmp|idiv0|ldiv0)'
allowed+='|__gnu_thumb1_case_[a-z]+|__(u?div|u?mod|mul|ashl|ashr|lshr)di3|__(ctz|clz|popcount)[sd]i2|jp_[a-z0-9_]+)$'

# Symbols of the object that the core must not reference.
foreign_symbols() {
    ! "$(tools_of "$2")nm" --undefined-only --format=posix "$1" | awk '{print $1}' | grep -vE "$allowed" |
        sed "s|^|$2: error: references |" | grep .
}

# Sections .data and .bss with something in them.
writable_data() {
    ! "$(tools_of "$2")size" -A "$1" | awk -v object="$2" \
        '$1 ~ /^\.s?(data|bss)/ && $1 !~ /^\.data\.rel\.ro/ && $2 > 0 {print object ": error: " $2 " bytes in " $1}' | grep .
}

examine() {
    foreign_symbols "$1" "$2" && writable_data "$1" "$2"
}

for library in "$@"; do
    variant=$(basename "$(dirname "$library")")
    objects=$results.objects
    mkdir -p "$objects"
    "$(tools_of "$variant")ar" x --output "$objects" "$library" || check "$variant" false
    rm -f "$objects/jp_can.o"
    for object in "$objects"/*.o; do
        [ -e "$object" ] && check "$variant/$(basename "$object")" examine "$object" "$variant/$(basename "$object")"
    done
    rm -rf "$objects"
done
finish
