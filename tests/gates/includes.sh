#!/usr/bin/env bash
# The core includes its own headers (private ones stand in src/), four headers of the C library and, for the DSP
# instructions, the compiler's; its floating-point part one more, and the core's private ones.
. "$(dirname "$0")/gate.sh"

only_allowed() {
    local system='<(joulepath/[a-z0-9_/]+|arm_acle|stdint|stdbool|stddef|string)\.h>' private='"[a-z0-9_]+\.h"'
    [[ $1 != src/float/* ]] || { system+='|<float\.h>' private='"(\.\./)?[a-z0-9_]+\.h"'; }
    ! grep -nE '^[[:space:]]*#[[:space:]]*include' "$1" |
        grep -vE "#[[:space:]]*include[[:space:]]+($system|$private)" |
        sed "s|^|$1:|; s|$| (not allowed in the core)|" | grep .
}
export -f only_allowed

mapfile -t files < <(sources '[ch]' include src)
check_each only_allowed "${files[@]}"
finish
