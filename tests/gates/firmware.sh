#!/usr/bin/env bash
# No floating-point helper or instruction is left in a linked image: the codec's functions with `double` are dropped, and
# the whole firmware computes in integers. Arguments: images of the targets, each of them one test.
. "$(dirname "$0")/gate.sh"

# Of the Arm EABI and of libgcc, which has names of its own for some.
helpers='__aeabi_(c?[df](add|sub|rsub|mul|div|neg|cmp[a-z]*|rcmp[a-z]*|2[a-z0-9]+)|u?[il]2[df]|h2f[a-z_]*)'
helpers+='|__[a-z]+[sd]f[23]?|__(fix|fixuns)[sd]f[sd]i|__(float|floatun)[sd]i[sd]f|__(extend|trunc)[sd]f[sd]f2'

# What a Cortex-M4F computes with where others call helpers. setjmp() saves the registers; that computes nothing.
instructions() {
    ! "$(tools_of "$2")objdump" -d "$1" | grep -oE '\sv(add|sub|mul|div|neg|cmp|cvt|fma|mla|mls|sqrt|abs)[a-z]*\.[fsu][0-9.fsu]+' |
        sort -u | sed "s|^\s*|$2: error: computes by |" | grep .
}

# The codec must be there, or nothing was proved.
examine() {
    local symbols
    symbols=$("$(tools_of "$2")nm" --format=posix "$1" | awk '{print $1}')
    if ! grep -q '^jp_can_.*_pack$' <<<"$symbols"; then
        echo "$2: error: holds no function of the codec"
        return 1
    fi
    ! grep -xE "$helpers" <<<"$symbols" | sed "s|^|$2: error: holds |" | grep . && instructions "$1" "$2"
}

for image in "$@"; do
    name=$(basename "$(dirname "$image")")/$(basename "$image")
    check "$name" examine "$image" "$name"
done
finish
