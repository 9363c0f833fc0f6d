#!/usr/bin/env bash
# No floating-point helper is left in a linked image: the codec's functions with `double` are dropped, and the whole
# firmware computes in integers. Arguments: images of the targets, each of them one test.
. "$(dirname "$0")/gate.sh"

# Of the Arm EABI and of libgcc, which has names of its own for some; a Cortex-M4F would need none of them.
helpers='__aeabi_(c?[df](add|sub|rsub|mul|div|neg|cmp[a-z]*|rcmp[a-z]*|2[a-z0-9]+)|u?[il]2[df]|h2f[a-z_]*)'
helpers+='|__[a-z]+[sd]f[23]?|__(fix|fixuns)[sd]f[sd]i|__(float|floatun)[sd]i[sd]f|__(extend|trunc)[sd]f[sd]f2'

# The codec must be there, or nothing was proved.
examine() {
    local symbols
    symbols=$(arm-none-eabi-nm --format=posix "$1" | awk '{print $1}')
    if ! grep -q '^jp_can_.*_pack$' <<<"$symbols"; then
        echo "$2: error: holds no function of the codec"
        return 1
    fi
    ! grep -xE "$helpers" <<<"$symbols" | sed "s|^|$2: error: holds |" | grep .
}

for image in "$@"; do
    name=$(basename "$(dirname "$image")")/$(basename "$image")
    check "$name" examine "$image" "$name"
done
finish
