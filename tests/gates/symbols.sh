#!/usr/bin/env bash
# Core and CAN application on a microcontroller need no library but memcpy, memset, memmove and the compiler's integer
# helpers, and have no writable data. Arguments: the libraries built for the targets; each object in them is one test.
# jp_can.o is left out: cantools always emits functions with `double`, and the gate `firmware` proves them dropped.
. "$(dirname "$0")/gate.sh"

allowed='^(memcpy|memset|memmove|__aeabi_mem(cpy|set|move|clr)[48]?'
allowed+='|__aeabi_(u?idiv|u?idivmod|u?ldivmod|lmul|llsl|llsr|lasr|lcmp|ulcmp|idiv0|ldiv0)'
allowed+='|__gnu_thumb1_case_[a-z]+|__(u?div|u?mod|mul|ashl|ashr|lshr)di3|__(ctz|clz|popcount)[sd]i2|jp_[a-z0-9_]+)$'

# problems LIBRARY TOOLS: the symbols that the core must not reference, and the sections .data and .bss with something in
# them, as OBJECT:REASON.
problems() {
    "$2nm" -A --undefined-only --format=posix "$1" | sed 's/^[^[]*\[\([^]]*\)\]: \([^ ]*\).*/\1 \2/' |
        awk -v allowed="$allowed" '$2 !~ allowed {print $1 ":references " $2}' &&
    "$2size" -A "$1" | awk '/ \(ex / {object = $1}
        $1 ~ /^\.s?(data|bss)/ && $1 !~ /^\.data\.rel\.ro/ && $2 > 0 {print object ":" $2 " bytes in " $1}'
}

# examine LIBRARY: a test for each of its objects.
examine() {
    local variant tools objects found
    variant=$(basename "$(dirname "$1")")
    tools=$(tools_of "$variant")
    objects=$("${tools}ar" t "$1") && found=$(problems "$1" "$tools") || return
    awk -F: -v variant="$variant" -v gate="$gate" '
        NR == FNR {if (NF > 1) {reasons[$1] = reasons[$1] "\n    " $2; if (!first[$1]) first[$1] = $2}; next}
        $1 != "jp_can.o" {
            print variant "/" $1 ":1:" gate ":" (first[$1] ? "FAIL: " first[$1] reasons[$1] : "PASS")
        }' <(echo "$found") <(echo "$objects") >"$results/${1//\//%}.objects"
}

# One pass for each library: an object alone costs five processes.
for library in "$@"; do
    check "$library" examine "$library"
    [ ! -e "$results/${library//\//%}.objects" ] || mv "$results/${library//\//%}.objects" "$results/${library//\//%}"
done
finish
