#!/usr/bin/env python3
"""Show what bench_plan measured, and write its tables for tools/measure/figures.py.

Written are the tables of the scenes, which come with the project; maps of others are shown on the terminal only.
"""
import json
import statistics
from pathlib import Path

from tools.common import ArgumentParser, ToolError, print_aligned, read_text, run, shown_path
from tools.measure.figure_store import write_tables

ROUTES = ("optimal", "within bound")
SCENE_HEADINGS = ("block, KiB", "states that fit", "routes", "optimal", "cost / optimum, median", "worst",
                  "proved bound, median", "expansions, median")
MAP_HEADINGS = ("map", "cells", "block, KiB", "routes", "partial", "unreachable", "cost / optimum, median")
CURVE_HEADINGS = ("price of length, J/m", "energy saved, %", "longer by, %")


def read_rows(path):
    try:
        rows = json.loads(read_text(path))
        return rows["scenes"], rows["maps"], rows["curve"]
    except (ValueError, KeyError, TypeError) as error:
        raise ToolError(f"{path}: not what bench_plan writes: {error}") from None


def grouped(rows, *keys):
    groups = {}
    for row in rows:
        groups.setdefault(tuple(row[key] for key in keys), []).append(row)
    return groups


def median(values, digits):
    return f"{statistics.median(values):.{digits}f}" if values else "-"


def count(rows, *answers):
    return str(sum(row["answer"] in answers for row in rows))


def ratios(rows):
    return [row["ratio"] for row in rows if row["answer"] in ROUTES and row["ratio"] is not None]


def scene_table(rows):
    for (kib,), group in grouped(rows, "block_kib").items():
        routes = [row for row in group if row["answer"] in ROUTES]
        found = ratios(group)
        yield (str(kib), str(group[0]["states_max"]), f"{len(routes)} of {len(group)}", count(group, "optimal"),
               median(found, 3), f"{max(found):.3f}" if found else "-", median([row["bound"] for row in routes], 2),
               median([row["expansions"] for row in group], 0))


def map_table(rows):
    for (name, kib), group in grouped(rows, "map", "block_kib").items():
        yield (name, f"{group[0]['width']} × {group[0]['height']}", str(kib),
               f"{count(group, *ROUTES)} of {len(group)}", count(group, "partial"), count(group, "unreachable"),
               median(ratios(group), 3))


def curve_table(rows):
    for row in rows:
        yield f"{row['price_j_per_m']:.0f}", f"{row['saved_percent']:.1f}", f"{row['longer_percent']:.1f}"


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("rows", metavar="ROWS.json", type=Path, help="what bench_plan --rows wrote")
    parser.add_argument("tables", metavar="TABLES.json", type=Path, help="where the tables go")
    return parser.parse_args()


def main():
    options = arguments()
    scenes, maps, curve = read_rows(options.rows)
    blocks, prices = list(scene_table(scenes)), list(curve_table(curve))
    write_tables(options.tables, {"plan": (SCENE_HEADINGS, blocks), "prices": (CURVE_HEADINGS, prices)})

    print_aligned([SCENE_HEADINGS, *blocks])
    print()
    print_aligned([CURVE_HEADINGS, *prices])
    if maps:
        print()
        print_aligned([MAP_HEADINGS, *map_table(maps)])
    print(f"\nwrote {shown_path(options.tables)}")
    return 0


if __name__ == "__main__":
    run(main)
