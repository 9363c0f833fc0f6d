#!/usr/bin/env bash
# The list of built-in robots and lattices for sim/balancer/robots.h, as C: robots.sh TABLES
# A robot is built in when the folder holds its controller and its energy model.
set -euo pipefail

tables=$1
declared=
listed=

# add TYPE TABLE FILE: the table, or NULL where its file is not made.
add() {
    if [ -e "$tables/$3.c" ]; then
        declared+="extern const struct $1 $2;"$'\n'
        listed+=" &$2,"
    else
        listed+=" NULL,"
    fi
}

for file in "$tables"/robot_*.c; do
    name=$(basename "$file" .c)
    name=${name#robot_}
    [ -e "$tables/energy_$name.c" ] || continue
    listed+="    {\"$name\","
    add jp_robot_config "jp_robot_$name" "robot_$name"
    add jp_energy_model "jp_energy_model_$name" "energy_$name"
    add jp_energy_model "jp_energy_model_${name}_battery" "energy_${name}_battery"
    for kind in "$name" "${name}_battery"; do
        add jp_horizon "jp_horizon_$kind" "horizon_$kind"
        add jp_learning "jp_learning_$kind" "learning_$kind"
    done
    add jp_lattice "jp_lattice_$name" "lattice_$name"
    add jp_navigator_body "jp_navigation_$name" "navigation_$name"
    add jp_battery_config "jp_battery_config_$name" "pack_$name"
    listed+="},"$'\n'
done
listed+='    {.name = NULL},
};
const size_t robot_count = sizeof robots / sizeof robots[0] - 1;
const struct jp_lattice *const lattices[] = {
'
for file in "$tables"/lattice_*.c; do
    [ -e "$file" ] || continue
    listed+="   "
    add jp_lattice "jp_$(basename "$file" .c)" "$(basename "$file" .c)"
    listed+=$'\n'
done
printf '#include "sim/balancer/robots.h"\n%sconst struct robot_entry robots[] = {\n%s    NULL,\n};\n' "$declared" "$listed"
