#!/usr/bin/env bash
# Runs one test and keeps its output: run_test.sh LOG SECONDS COMMAND...
# The last line of LOG is `run: exit STATUS, SECONDS s`; 124 and 137 stand for a run that took too long.
# Always succeeds: tools/test_summary.py judges the log.
set -uo pipefail

log=$1 limit=$2
shift 2
mkdir -p "$(dirname "$log")"
start=$(date +%s%N)
timeout --kill-after=5 "$limit" "$@" >"$log.part" 2>&1 </dev/null
status=$?
milliseconds=$((($(date +%s%N) - start) / 1000000))
printf '\nrun: exit %d, %d.%03d s\n' "$status" $((milliseconds / 1000)) $((milliseconds % 1000)) >>"$log.part"
mv "$log.part" "$log"
