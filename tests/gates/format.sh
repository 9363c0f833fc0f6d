#!/usr/bin/env bash
# Every C file is formatted as .clang-format says: `make format`.
. "$(dirname "$0")/gate.sh"

# One run for each folder at the top: a process a file takes longer than the work.
formatted() {
    written_by_hand '[ch]' "$1" | xargs "${CLANG_FORMAT:-clang-format}" --dry-run -Werror
}
export -f formatted sources written_by_hand

check_each formatted include src hal sim tests
finish
