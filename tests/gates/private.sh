#!/usr/bin/env bash
# Members called `internal` are read by the room that declares them, by no other.
COMPILER_HEADERS=$(gcc -print-file-name=include) exec "${PYTHON:-python3}" "$(dirname "$0")/private.py"
