#!/usr/bin/env bash
# MISRA C:2012, as far as cppcheck's addon knows its rules: in include/ and src/ each violation has a reason, recorded in
# misra.yaml, and each recorded reason is needed. The last lines are a table of what was found and why it stays.
. "$(dirname "$0")/gate.sh"

records=tests/gates/misra.yaml
scratch=$(mktemp -d)
export records scratch
trap 'rm -rf "$results" "$scratch"' EXIT

mapfile -t files < <(sources c src)

# All at once: some rules are about the project as a whole.
find_violations() {
    cppcheck --quiet -j "${JOBS:-$(nproc)}" --cppcheck-build-dir="$scratch" --std=c11 --enable=style --addon=misra \
        --suppressions-list=tests/gates/cppcheck.txt --template='{file}:{line}:{column}: {id}' -Iinclude -I. \
        "${files[@]}" >"$scratch/violations" 2>&1
}

no_problem_in() {
    ! grep -F "$1:" "$scratch/problems"
}
export -f no_problem_in

judge() {
    "${PYTHON:-python3}" -m tools.measure.misra_report "$records" "$scratch/violations" \
        >"$scratch/table" 2>"$scratch/problems"
}

analyse() {
    find_violations && judge || ! cat "$scratch/violations" "$scratch/problems"
}

mapfile -t headers < <(sources h include src)
check cppcheck analyse
check_each no_problem_in "${files[@]}" "${headers[@]}" "$records"
cat "$scratch/table"
finish
