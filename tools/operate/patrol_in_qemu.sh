#!/usr/bin/env bash
# Lets the firmware's image of the patrol robot drive in QEMU: patrol_in_qemu.sh ROBOT SCENE [options of jp-patrol]
# Exit status that of jp-patrol; 2: one line says why.
set -uo pipefail

die() {
    echo "patrol_in_qemu: $*" >&2
    exit 2
}

[ $# -ge 2 ] || die "usage: tools/operate/patrol_in_qemu.sh ROBOT SCENE [options of jp-patrol]"
build=${JP_BUILD:-$(dirname "$0")/../../build}
robot=$1
shift
image=$build/firmware/$robot/emulated.elf
[ -e "$image" ] || die "$image: is not there; run make $image"

log=$(mktemp) || die "no room for a temporary file"
trap 'kill $(jobs -p) 2>/dev/null; wait; rm -f "$log"' EXIT
qemu-system-arm -M mps2-an500 -nographic -monitor none -serial pty -kernel "$image" >"$log" 2>&1 &
for _ in $(seq 100); do
    line=$(sed -n 's/^char device redirected to \([^ ]*\) .*/\1/p' "$log")
    [ -n "$line" ] && break
    sleep 0.05
done
[ -n "$line" ] || die "$(tail -n 1 "$log")"
"$build/bin/jp-patrol" --robot "$robot" "$@" --bus "slcan:$line"
