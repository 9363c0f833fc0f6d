#!/usr/bin/env bash
# The source package for firmware projects: package.sh VERSION DIRECTORY
# Makes DIRECTORY/joulepath-VERSION/ and DIRECTORY/joulepath-VERSION.tar.gz: the library, the portable part of hal/, and
# what CMake, Zephyr and PlatformIO want to find at the root. Equal sources give equal bytes.
set -euo pipefail
cd "$(dirname "$0")/../.."

[ $# -eq 2 ] || {
    echo "usage: tools/packaging/package.sh VERSION DIRECTORY" >&2
    exit 2
}
version=$1
directory=$2
name=joulepath-$version
# Archives of the zip kind know no earlier time.
epoch=${SOURCE_DATE_EPOCH:-315532800}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tree=$work/$name

copy() {
    local file
    for file in "$@"; do
        install -D -m 644 "$file" "$tree/$file"
    done
}

copy LICENSE include/joulepath/*.h src/*/*.[ch] src/single_precision.txt
copy hal/README.md hal/*.[ch] hal/storage/*.[ch] hal/can/*.[ch] hal/can/joulepath.dbc hal/app/*.[ch] hal/skeleton/*.[ch]
install -m 644 tools/packaging/README.md "$tree/README.md"
install -m 644 tools/packaging/CMakeLists.txt "$tree/CMakeLists.txt"
install -D -m 644 -t "$tree/zephyr" tools/packaging/zephyr/*
sed "s/@VERSION@/$version/" tools/packaging/library.json.in >"$tree/library.json"
find "$tree" -exec chmod u=rwX,go=rX {} + -exec touch --no-dereference --date="@$epoch" {} +

tar --create --sort=name --mtime="@$epoch" --owner=0 --group=0 --numeric-owner --format=ustar \
    --directory="$work" "$name" | gzip --no-name --best >"$work/$name.tar.gz"

mkdir -p "$directory"
rm -rf "${directory:?}/$name"
mv "$tree" "$directory/$name"
mv "$work/$name.tar.gz" "$directory/$name.tar.gz"
