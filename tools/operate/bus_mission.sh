#!/usr/bin/env bash
# Drives a scenario with controller and robot as two programs: bus_mission.sh BUS SCENARIO DIR
#   BUS  vcan (vcan0 is there; see with_vcan.sh), slcan (a pseudo-terminal), or pil: the firmware's image in QEMU, which
#        speaks SLCAN on its serial line
# Writes the report's data and all frames (frames.log) to DIR; on vcan also what candump saw of telemetry and commands
# (candump.log). Exit status 2: one line says why.
set -uo pipefail

die() {
    echo "bus_mission: $*" >&2
    exit 2
}

[ $# -eq 3 ] || die "usage: tools/operate/bus_mission.sh vcan|slcan|pil SCENARIO DIR"
bus=$1 scenario=$2 output=$3
programs=${JP_BUILD:-$(dirname "$0")/../../build}/bin
mkdir -p "$output" || die "$output: cannot be made; choose another folder"

robot=$(sed -n 's/^robot *= *"\(.*\/\)\?\([^"/]*\)\.cfg".*/\2/p' "$scenario")
[ -n "$robot" ] || die "$scenario: names no robot; add robot = \"../robots/name.cfg\";"
model=$(sed -n 's/^energy_model *= *"\([a-z]*\)".*/\1/p' "$scenario")
energy=$(sed -n 's/^energy *= *"\([a-z]*\)".*/\1/p' "$scenario")

trap 'kill $(jobs -p) 2>/dev/null; wait' EXIT
case $bus in
vcan)
    plant_bus=can:vcan0 ecu_bus=can:vcan0
    candump -L vcan0,100:700 >"$output/candump.log" &
    ;;
slcan)
    line=$(mktemp -u)
    plant_bus=pty:$line ecu_bus=slcan:$line
    ;;
pil)
    image=${JP_BUILD:-$(dirname "$0")/../../build}/firmware/$robot/emulated.elf
    [ -e "$image" ] || die "$image: is not there; run make firmware ROBOT=$robot"
    [ "${model:-identified}" = identified ] || die "$scenario: energy_model = \"$model\", but the image has the identified one"
    [ "${energy:-motor}" = motor ] || die "$scenario: energy = \"$energy\", but the image has the model of the motors' energy"
    qemu-system-arm -M netduinoplus2 -nographic -monitor none -serial pty -kernel "$image" >"$output/qemu.log" 2>&1 &
    for _ in $(seq 100); do
        line=$(sed -n 's/^char device redirected to \([^ ]*\) .*/\1/p' "$output/qemu.log")
        [ -n "$line" ] && break
        sleep 0.05
    done
    [ -n "$line" ] || die "$(tail -n 1 "$output/qemu.log")"
    plant_bus=slcan:$line
    ;;
*) die "BUS=$bus: must be vcan, slcan or pil" ;;
esac
if [ "$bus" = pil ]; then
    "$programs/jp-plant" "$scenario" --bus "$plant_bus" --output "$output" --frames
    exit
fi

"$programs/jp-plant" "$scenario" --bus "$plant_bus" --output "$output" --frames &
plant=$!
if [ "$bus" = slcan ]; then
    for _ in $(seq 100); do
        [ -e "$line" ] && break
        sleep 0.05
    done
fi
"$programs/jp-ecu" --bus "$ecu_bus" --robot "$robot" --model "${model:-identified}" --energy "${energy:-motor}" >"$output/ecu.log" &
ecu=$!
wait "$plant"
status=$?
kill "$ecu" 2>/dev/null && wait "$ecu"
sed 's/^/  /' "$output/ecu.log"
exit "$status"
