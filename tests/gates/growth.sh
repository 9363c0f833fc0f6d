#!/usr/bin/env bash
# No number of a core grew by over 5 % without an explanation (tools/growth.py). Arguments: what tools/size.py, stack.py
# and cycles.py read, one list each; each of them is one test.
. "$(dirname "$0")/gate.sh"

judge() {
    local kind=$1
    shift
    "${PYTHON:-.venv/bin/python}" "tools/$kind.py" "$@" && "${PYTHON:-.venv/bin/python}" tools/growth.py "$kind"
}

for kind in size stack cycles; do
    read -ra inputs <<<"$1"
    shift
    check "growth/$kind" judge "$kind" "${inputs[@]}"
done
finish
