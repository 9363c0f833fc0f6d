#!/usr/bin/env bash
# No number of a core grew by over 5 % without an explanation (growth.py), and the static bounds of the ticks hold
# (instruction_bound.py). Arguments: what size.py, stack.py and cycles.py of tools/measure read, one list each, and the
# folder for instruction_bound.py; each of them is one test.
. "$(dirname "$0")/gate.sh"

judge() {
    local kind=$1
    shift
    "${PYTHON:-.venv/bin/python}" -m "tools.measure.$kind" "$@" &&
        "${PYTHON:-.venv/bin/python}" -m tools.measure.growth "$kind"
}

for kind in size stack cycles; do
    read -ra inputs <<<"$1"
    shift
    check "growth/$kind" judge "$kind" "${inputs[@]}"
done
check growth/instruction_bounds "${PYTHON:-.venv/bin/python}" -m tools.measure.instruction_bound "$1"
finish
