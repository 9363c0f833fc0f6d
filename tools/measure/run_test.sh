#!/usr/bin/env bash
# Runs one test and keeps its output: run_test.sh LOG SECONDS COMMAND...
# SECONDS are of the processor's time, so that other work on the machine fails no test; who waits in vain is stopped after
# WAIT_LIMIT. The last line of LOG is `run: exit STATUS, SECONDS s`; 124, 137 and 152 stand for a run that took too long.
# Always succeeds: tools/measure/test_summary.py judges the log.
set -uo pipefail

log=$1 limit=$2
shift 2
[ -d "${log%/*}" ] || mkdir -p "${log%/*}"
start=${EPOCHREALTIME//[!0-9]/}
(ulimit -S -t "$limit" && exec timeout --kill-after=5 "${WAIT_LIMIT:-1200}" "$@") >"$log.part" 2>&1 </dev/null
status=$?
milliseconds=$(((${EPOCHREALTIME//[!0-9]/} - start) / 1000))
printf '\nrun: exit %d, %d.%03d s\n' "$status" $((milliseconds / 1000)) $((milliseconds % 1000)) >>"$log.part"
mv "$log.part" "$log"
