#!/usr/bin/env bash
# The rooms include each other as layers.yaml says, downwards only and from the root.
exec "${PYTHON:-python3}" "$(dirname "$0")/includes.py"
