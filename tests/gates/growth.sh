#!/usr/bin/env bash
# No number of a core grew by over 5 % without an explanation (growth.py). Arguments: what size.py, stack.py and
# cycles.py of tools/measure read, one list each; each of them is one test.
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
finish
