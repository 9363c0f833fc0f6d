#!/usr/bin/env bash
# Copies the tools that need nothing but a robot's results and its bus, with what they read, under a name that is the
# package's: copy_tools.sh DIRECTORY, the one of the package joulepath.
set -euo pipefail

cd "$(dirname "$0")/../.."
package=$1
rooms="design identify operate report"

rm -rf "$package/tools" && mkdir -p "$package/tools" "$package/hal/can"
install -m 644 tools/__init__.py tools/common.py "$package/tools"
for room in $rooms; do
    mkdir -p "$package/tools/$room"
    install -m 644 tools/"$room"/*.py "$package/tools/$room"
done
install -m 644 tools/report/*.j2 "$package/tools/report"
install -m 644 hal/can/joulepath.dbc "$package/hal/can"
# `tools` is a name that no package may take for itself.
sed -i -E "s/\btools\.(common|${rooms// /|})\b/joulepath.tools.\1/g; s/^from tools import /from joulepath.tools import /" \
    "$package"/tools/*.py "$package"/tools/*/*.py
find sim/robots sim/scenarios -name '*.cfg' -exec install -D -m 644 {} "$package/{}" \;
