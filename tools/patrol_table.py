#!/usr/bin/env python3
"""Make the C tables of a patrol robot's controller from its file, with jp-patrol-config.

Writes src/float/tables/patrol_<robot>.c and, of pure pursuit, which has no floating point,
src/tables/pure_pursuit_<robot>.c: the numbers with which the simulator drives, bit by bit. Exit status 2: bad input;
nothing was written.
"""
import argparse
import itertools
import json
from pathlib import Path

import numpy as np

import c_tables
import robot_json
from common import ROOT, run, shown_path, write_whole

# How a stored value is written, and what it means in its unit.
FORMATS = {
    "float": (lambda value: float_text(value), None),
    "q24": (str, 2**-24),
    "angle": (str, 2**-32),
    "whole": (lambda value: f"{value}U", None),
    "flag": (lambda value: str(value).lower(), None),
}
PURE_NUMBER = "1"  # as a unit


def float_text(value):
    """The shortest constant that a compiler reads back to the same single-precision number."""
    return np.format_float_positional(np.float32(value), unique=True, trim="0") + "f"


def member_of(name, data):
    text, step = FORMATS[data["format"]]
    quantity = f"{data['value'] * step:.6g}" if step else ""
    unit = "" if data["unit"] == PURE_NUMBER else data["unit"]
    return c_tables.Member(name, text(data["value"]), f"{quantity} {unit}".strip())


def members_of(data, depth=0):
    """Members and groups of them, from the dots in their keys."""
    members = []
    for name, group in itertools.groupby(data, lambda member: member["key"].split(".")[depth]):
        group = list(group)
        if group[0]["key"].count(".") == depth:
            members.append(member_of(name, group[0]))
        else:
            members.append(c_tables.Group(name, members_of(group, depth + 1)))
    return members


def table_text(data, part):
    name = data["name"]
    return c_tables.render(c_tables.Table(
        f"make patrol-config ROBOT={name}", f"sim/robots/{name}.cfg", "", f"joulepath/{part}.h", f"jp_{part}_config",
        f"jp_{part}_config_{name}", members_of(data[part])))


def tables(data, source):
    """{path: text}"""
    return {source / "float" / "tables" / f"patrol_{data['name']}.c": table_text(data, "patrol"),
            source / "tables" / f"pure_pursuit_{data['name']}.c": table_text(data, "pure_pursuit")}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("robot", help="robot file, or the name of one in sim/robots")
    parser.add_argument("--source", metavar="DIR", type=Path, default=ROOT / "src",
                        help="where the folders with the C files are (default: src)")
    return parser.parse_args()


def main():
    options = arguments()
    program = robot_json.build_directory() / "bin" / "jp-patrol-config"
    data = json.loads(robot_json.printed_by(program, robot_json.robot_path(options.robot), "--json"))
    for path, text in tables(data, options.source).items():
        write_whole(path, text)
        print(f"wrote {shown_path(path)}")
    return 0


if __name__ == "__main__":
    run(main)
