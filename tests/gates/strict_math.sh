#!/usr/bin/env bash
# What is simulated has the same bits on every machine: neither the simulator nor what it drives asks the C library for
# functions that C libraries round differently; sim/base/strict_math.h has them. Arguments: host libraries, and programs'
# objects; each object is one test.
. "$(dirname "$0")/gate.sh"

inexact='a?(sin|cos|tan)h?|sincos|atan2|hypot|cbrt|exp(2|10|m1)?|log(2|10|1p|b)?|pow|erfc?|[lt]gamma|j[01n]|y[01n]'

# references OBJECT|LIBRARY: its objects, each with such functions as it references: OBJECT:FUNCTION, or OBJECT:
references() {
    nm --undefined-only --format=posix "$1" | awk -v inexact="^($inexact)[fl]?$" -v object="$(basename "$1")" '
        /:$/ {object = $0; gsub(/.*\[|\]?:$/, "", object)}
        !(object in seen) {seen[object] = 1; print object ":"}
        $1 ~ inexact {print object ":" $1}'
}

examine() {
    local found
    found=$(references "$1") || return
    awk -F: -v gate="$gate" -v of="$(basename "${1%/*}")" '
        !($1 in names) {names[$1]; order[++count] = $1}
        $2 {calls[$1] = calls[$1] " " $2}
        END {for (i = 1; i <= count; i++) {
            object = order[i]
            print of "/" object ":1:" gate ":" (calls[object] ? "FAIL: calls" calls[object] ", not of sim/base/strict_math.h" : "PASS")
        }}' <<<"$found" >"$results/${1//\//%}.objects"
}

for file in "$@"; do
    check "$file" examine "$file"
    [ ! -e "$results/${file//\//%}.objects" ] || mv "$results/${file//\//%}.objects" "$results/${file//\//%}"
done
finish
