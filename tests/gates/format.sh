#!/usr/bin/env bash
# Every C file is formatted as .clang-format says: `make format`.
. "$(dirname "$0")/gate.sh"

formatted() {
    "${CLANG_FORMAT:-clang-format}" --dry-run -Werror "$1"
}
export -f formatted

mapfile -t files < <(written_by_hand '[ch]' include src hal sim tests)
check_each formatted "${files[@]}"
finish
