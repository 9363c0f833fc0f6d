#!/usr/bin/env bash
# Passes when a program on a target ends with exit status 1 and this last line: dies.sh LINE COMMAND...
set -uo pipefail

expected=$1
shift
output=$("$@" 2>&1)
status=$?
last=${output##*$'\n'}
test="$0:1:dies_of_${expected// /_}"
if [ "$status" -eq 1 ] && [ "$last" = "$expected" ]; then
    printf '%s:PASS\n\n1 Tests 0 Failures 0 Ignored\nOK\n' "$test"
    exit 0
fi
printf '%s:FAIL: exit status %d, last line: %s\n\n1 Tests 1 Failures 0 Ignored\nFAIL\n' "$test" "$status" "$last"
exit 1
