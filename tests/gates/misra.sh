#!/usr/bin/env bash
# MISRA C:2012, as far as cppcheck's addon knows its rules: in include/ and src/ each violation has a reason, recorded in
# misra.yaml, and each recorded reason is needed. A file on which the addon breaks down fails. The last lines are a table
# of what was found and why it stays.
. "$(dirname "$0")/gate.sh"

records=tests/gates/misra.yaml
scratch=$(mktemp -d)
# What was found stays until a source, the checker or its rules change: the checker's own memory of a file outlives a
# comment that moves the lines below it.
addon=$(find /usr/share/cppcheck /usr/lib /usr/local/share -path '*cppcheck/addons/misra*.py' 2>/dev/null | sort)
rules=$({ cppcheck --version && cat "${BASH_SOURCE[0]}" "$(dirname "$0")"/{gate.sh,cppcheck.txt} $addon &&
    find include src -name '*.[ch]' -print0 | sort -z | xargs -0 sha256sum; } | sha256sum)
known=${JP_BUILD:-build}/misra/${rules:0:16}
find "${known%/*}" -mindepth 1 -maxdepth 1 ! -path "$known" -exec rm -rf {} + 2>/dev/null
mkdir -p "$known"
export records scratch
trap 'rm -rf "$results" "$scratch"' EXIT

mapfile -t files < <(sources c src)
mapfile -t differing < <(grep -lE "$differing_names" "${files[@]}")

# Of the project as a whole: they need all of its files.
of_the_project='misra-c2012-(2\.[345]|5\.[6-9]|8\.[567])$'

examine() {
    cppcheck --quiet -j "${JOBS:-$(nproc)}" --cppcheck-build-dir="$known" --std=c11 --enable=style --addon=misra \
        --addon-python="${PYTHON:-python3}" \
        --suppressions-list=tests/gates/cppcheck.txt --template='{file}:{line}:{column}: {id}' -Iinclude -I. "$@" 2>&1
}

# First those that differ, in all configurations; what was found of them is kept in the folder for the second run.
find_violations() {
    examine "${differing[@]}" >"$scratch/first" &&
        examine "${same_everywhere[@]}" "${files[@]}" >"$scratch/second" || return
    grep -vE "$of_the_project" "$scratch/first" | cat - "$scratch/second" >"$scratch/violations"
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
    find_violations && judge && return
    rm -rf "$known"
    cat "$scratch"/{first,second,problems}
    return 1
}

mapfile -t headers < <(sources h include src)
check cppcheck analyse
check_each no_problem_in "${files[@]}" "${headers[@]}" "$records" project
! grep -qs 'the addon failed' "$scratch/problems" || rm -rf "$known"
find "$known" -name '*.dump' -delete 2>/dev/null
cat "$scratch/table"
finish
