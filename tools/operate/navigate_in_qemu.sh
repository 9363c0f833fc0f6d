#!/usr/bin/env bash
# Lets the firmware's image of a robot find its way in QEMU: navigate_in_qemu.sh ROBOT MAP [options of jp-navigate]
# Exit status that of jp-navigate; 2: one line says why.
set -uo pipefail

die() {
    echo "navigate_in_qemu: $*" >&2
    exit 2
}

[ $# -ge 2 ] || die "usage: tools/operate/navigate_in_qemu.sh ROBOT MAP [options of jp-navigate]"
build=${JP_BUILD:-$(dirname "$0")/../../build}
image=$build/firmware/$1/emulated.elf
[ -e "$image" ] || die "$image: is not there; run make $image"
shift

log=$(mktemp) || die "no room for a temporary file"
trap 'kill $(jobs -p) 2>/dev/null; wait; rm -f "$log"' EXIT
qemu-system-arm -M netduinoplus2 -nographic -monitor none -serial pty -kernel "$image" >"$log" 2>&1 &
for _ in $(seq 100); do
    line=$(sed -n 's/^char device redirected to \([^ ]*\) .*/\1/p' "$log")
    [ -n "$line" ] && break
    sleep 0.05
done
[ -n "$line" ] || die "$(tail -n 1 "$log")"
"$build/bin/jp-navigate" "$@" --bus "slcan:$line" --frames
