#!/usr/bin/env bash
# The list of built-in robots and lattices for sim/balancer/robots.h, as C: robots.sh TABLES
# A robot is built in when src/tables/ holds its controller and its energy model.
set -euo pipefail

tables=$1

# pointer PREFIX NAME: the table jp_PREFIX_NAME, or NULL where it is not made.
pointer() {
    local file=${1/energy_model/energy}_$2.c
    if [ -e "$tables/$file" ]; then echo "&jp_$1_$2"; else echo NULL; fi
}

echo '#include "sim/balancer/robots.h"'
echo '#include <joulepath/tables.h>'
echo 'const struct robot_entry robots[] = {'
for file in "$tables"/robot_*.c; do
    name=$(basename "$file" .c)
    name=${name#robot_}
    [ -e "$tables/energy_$name.c" ] || continue
    echo "    {\"$name\", &jp_robot_$name, &jp_energy_model_$name, $(pointer energy_model "${name}_battery"),"
    echo "     $(pointer horizon "$name"), $(pointer learning "$name"),"
    echo "     $(pointer horizon "${name}_battery"), $(pointer learning "${name}_battery")},"
done
echo '    {.name = NULL},'
echo '};'
echo 'const size_t robot_count = sizeof robots / sizeof robots[0] - 1;'
echo 'const struct jp_lattice *const lattices[] = {'
for file in "$tables"/lattice_*.c; do
    echo "    &jp_$(basename "$file" .c),"
done
echo '    NULL,'
echo '};'
