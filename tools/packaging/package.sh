#!/usr/bin/env bash
# The source packages for firmware projects: package.sh VERSION DIRECTORY
# Makes DIRECTORY/joulepath-VERSION/ and DIRECTORY/joulepath-VERSION.tar.gz: the library, the portable part of hal/, and
# what CMake, Zephyr, PlatformIO and ESP-IDF want to find at the root; and DIRECTORY/joulepath-arduino-VERSION.zip, the
# same as an Arduino library. Equal sources give equal bytes.
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

# arduino: the library without its floating-point part, below the one folder in which Arduino looks for headers.
arduino() {
    local library=$work/Joulepath single
    mkdir -p "$library/src" "$library/examples"
    cp -r "$tree/include/joulepath" "$tree/hal" "$library/src"
    cp -r "$tree/src" "$library/src/src"
    rm -rf "$library/src/hal/skeleton"
    while read -r single; do
        rm -f "$library/src"/$single
    done <src/single_precision.txt
    cp tools/packaging/arduino/joulepath.h "$library/src"
    cp -r tools/packaging/arduino/examples/Balancer "$library/examples"
    cp LICENSE "$library"
    sed "s/@VERSION@/$version/" tools/packaging/arduino/library.properties.in >"$library/library.properties"
    find "$library" -exec chmod u=rwX,go=rX {} + -exec touch --no-dereference --date="@$epoch" {} +
    (cd "$work" && python3 -m zipfile -c "$work/arduino.zip" Joulepath)
}

copy LICENSE include/joulepath/*.h src/*/*.[ch] src/single_precision.txt
copy hal/README.md hal/*.[ch] hal/storage/*.[ch] hal/can/*.[ch] hal/can/joulepath.dbc hal/app/*.[ch] hal/skeleton/*.[ch]
install -m 644 tools/packaging/README.md "$tree/README.md"
install -m 644 tools/packaging/CMakeLists.txt "$tree/CMakeLists.txt"
install -D -m 644 -t "$tree/zephyr" tools/packaging/zephyr/*
sed "s/@VERSION@/$version/" tools/packaging/library.json.in >"$tree/library.json"
sed "s/@VERSION@/$version/" tools/packaging/idf_component.yml.in >"$tree/idf_component.yml"
mkdir "$tree/examples"
cp -r tools/packaging/esp_idf/plan "$tree/examples"
find "$tree" -exec chmod u=rwX,go=rX {} + -exec touch --no-dereference --date="@$epoch" {} +

tar --create --sort=name --mtime="@$epoch" --owner=0 --group=0 --numeric-owner --format=ustar \
    --directory="$work" "$name" | gzip --no-name --best >"$work/$name.tar.gz"

arduino

mkdir -p "$directory"
rm -rf "${directory:?}/$name"
mv "$tree" "$directory/$name"
mv "$work/$name.tar.gz" "$directory/$name.tar.gz"
mv "$work/arduino.zip" "$directory/joulepath-arduino-$version.zip"
