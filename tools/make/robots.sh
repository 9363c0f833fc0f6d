#!/usr/bin/env bash
# The lists of built-in robots, of each kind, and of lattices, as C for the simulator: robots.sh TABLES
# A robot is built in when the folder holds what its kind cannot do without; tables beside that may be missing.
set -euo pipefail

tables=$1
declared=
listed=

has() {
    [ -e "$tables/$1.c" ]
}

# add TYPE FILE [TABLE]: the table jp_FILE, or TABLE, or NULL where its file is not made.
add() {
    if has "$2"; then
        declared+="extern const struct $1 ${3-jp_$2};"$'\n'
        listed+=" &${3-jp_$2},"
    else
        listed+=" NULL,"
    fi
}

# names KIND NEEDED...: of the robots with the table KIND_name and all NEEDED_name.
names() {
    local kind=$1 file name needed
    shift
    for file in "$tables/${kind}"_*.c; do
        name=$(basename "$file" .c)
        name=${name#"${kind}"_}
        for needed in "$kind" "$@"; do
            has "${needed}_$name" || continue 2
        done
        echo "$name"
    done
}

balancer() {
    add jp_robot_config "robot_$1" "jp_robot_$1"
    add jp_energy_model "energy_$1" "jp_energy_model_$1"
    add jp_energy_model "energy_$1_battery" "jp_energy_model_$1_battery"
    local kind
    for kind in "$1" "$1_battery"; do
        add jp_horizon "horizon_$kind"
        add jp_learning "learning_$kind"
    done
    add jp_lattice "lattice_$1"
    add jp_navigator_body "navigation_$1"
    add jp_battery_config "pack_$1" "jp_battery_config_$1"
}

skid() {
    add jp_skid_robot_config "skid_robot_$1"
    add jp_skid_energy_model "skid_energy_$1"
    add jp_skid_learning "skid_learning_$1"
    add jp_path_limits "path_limits_$1"
    add jp_lattice "lattice_$1"
    add jp_skid_steer_config "skid_steer_$1"
    add jp_navigator_body "navigation_$1"
    if has "lattice_$1_navigation"; then
        add jp_lattice "lattice_$1_navigation"
    else
        add jp_lattice "lattice_$1" # which sweeps the disc
    fi
    add jp_battery_config "pack_$1" "jp_battery_config_$1"
}

four_wheel() {
    add jp_four_wheel_robot_config "four_wheel_robot_$1"
    add jp_patrol_config "patrol_$1" "jp_patrol_config_$1"
    add jp_localiser_config "patrol_localiser_$1" "jp_localiser_config_$1"
    add jp_patrol_scanner "patrol_scanner_$1"
    add jp_four_wheel_energy_model "four_wheel_energy_$1"
    add jp_factor_learning "four_wheel_learning_$1"
}

# list KIND STRUCT ARRAY NEEDED...: the array, up to an entry without a name. KIND is the function that adds a robot's tables.
list() {
    local kind=$1 struct=$2 array=$3 name
    shift 3
    listed+="const struct $struct ${array}[] = {"$'\n'
    for name in $(names "$@"); do
        listed+="    {\"$name\","
        "$kind" "$name"
        listed+="},"$'\n'
    done
    listed+="    {.name = NULL},"$'\n'"};"$'\n'
}

list balancer robot_entry robots robot energy
listed+="const size_t robot_count = sizeof robots / sizeof robots[0] - 1;"$'\n'
list skid skid_robot_entry skid_robots skid_robot skid_energy skid_learning path_limits lattice skid_steer
list four_wheel patrol_robot_entry patrol_robots four_wheel_robot patrol patrol_localiser patrol_scanner \
    four_wheel_energy four_wheel_learning
listed+="const struct jp_lattice *const lattices[] = {"$'\n'
for file in "$tables"/lattice_*.c; do
    [ -e "$file" ] || continue
    listed+="   "
    add jp_lattice "$(basename "$file" .c)"
    listed+=$'\n'
done
printf '#include "sim/balancer/robots.h"\n#include "sim/four_wheel/patrol_robots.h"\n#include "sim/skid_steer/skid_robots.h"\n'
printf '%s%s    NULL,\n};\n' "$declared" "$listed"
