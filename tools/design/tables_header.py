#!/usr/bin/env python3
"""Write include/joulepath/tables.h, which declares the tables in src/tables/.

Exit status 2: bad input; nothing was written.
"""
import argparse
import re
from pathlib import Path

from tools.common import ROOT, ToolError, read_text, run, shown_path, write_whole

DEFINITION = re.compile(r"^const struct (\w+) (jp_\w+) = \{$", re.M)
HEADER = ROOT / "include/joulepath/tables.h"
TABLES = ROOT / "src/tables"

HEAD = """/**
 * The tables that ship, in ROM: one for each file of src/tables/, which names the command that made it of a robot file.
 * Include the header of the module that takes a table. Made by: make tables
 */
#ifndef JOULEPATH_TABLES_H
#define JOULEPATH_TABLES_H

#ifdef __cplusplus
extern "C" {
#endif

"""
TAIL = """
#ifdef __cplusplus
}
#endif

#endif
"""


def definitions(folder):
    """[(struct, name)] of the tables, sorted."""
    found = []
    for path in sorted(folder.glob("*.c")):
        tables = DEFINITION.findall(read_text(path))
        if len(tables) != 1:
            raise ToolError(f"{shown_path(path)}: defines {len(tables)} tables; must define one")
        found += tables
    return sorted(found)


def render(tables):
    structs = "".join(f"struct {struct};\n" for struct in sorted({struct for struct, _ in tables}))
    return HEAD + structs + "\n" + "".join(f"extern const struct {struct} {name};\n" for struct, name in tables) + TAIL


def declare(output=HEADER):
    """Write the header of what src/tables/ holds now."""
    write_whole(output, render(definitions(TABLES)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--output", metavar="FILE", type=Path, default=HEADER, help="default: include/joulepath/tables.h")
    options = parser.parse_args()
    declare(options.output)
    print(f"wrote {shown_path(options.output)}")


if __name__ == "__main__":
    run(main)
