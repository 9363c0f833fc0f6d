#!/usr/bin/env python3
"""Show what bench_patrol and bench_pursuit measured, and write their tables for tools/measure/figures.py."""
import json
from pathlib import Path

from tools.common import ArgumentParser, ToolError, print_aligned, read_text, run, shown_path
from tools.measure.figure_store import write_tables

METHODS = ("improved", "plain", "pursuit")
SCENE_HEADINGS = ("scene", "drives", "arrived", "of them never backwards", "collided", "time, s", "energy, J",
                  "least clearance, cm")
COURSE_HEADINGS = ("course", "paths")


def read_rows(path, *keys):
    try:
        rows = json.loads(read_text(path))
        if not rows or not all(key in row for row in rows for key in keys):
            raise TypeError("rows or keys of them are missing")
        return rows
    except (ValueError, TypeError) as error:
        raise ToolError(f"{path}: not what the bench writes: {error}") from None


def number(value, digits):
    return "–" if value is None else f"{value:.{digits}f}"


def triple(methods, key, digits=0, scale=1):
    """A value of the three methods."""
    return " / ".join(number(None if row[key] is None else scale * row[key], digits) for row in methods)


def scene_table(path):
    places = {}
    for row in read_rows(path, "scene", "slip", "method", "drives", "arrived", "cleanly", "collided", "time_s",
                         "energy_j", "clearance_min_m"):
        places.setdefault((row["scene"], row["slip"]), {})[row["method"]] = row
    for (scene, slip), methods in places.items():
        if sorted(methods) != sorted(METHODS):
            raise ToolError(f"{path}: {scene}: must have rows of {', '.join(METHODS)}")
        rows = [methods[method] for method in METHODS]
        yield (scene + (", slippery" if slip else ""), str(rows[0]["drives"]), triple(rows, "arrived"),
               triple(rows, "cleanly"), triple(rows, "collided"), triple(rows, "time_s", 1), triple(rows, "energy_j"),
               triple(rows, "clearance_min_m", 1, 100))


def course_table(path):
    """Heading and rows: a course a row, a speed a column."""
    courses = {}
    for row in read_rows(path, "course", "speed_m_s", "drives", "arrived", "largest_m", "rms_m"):
        courses.setdefault((row["course"], row["drives"]), []).append(row)
    speeds = [row["speed_m_s"] for row in next(iter(courses.values()))]
    yield (*COURSE_HEADINGS, *(f"{speed:g} m/s" for speed in speeds))
    for (course, drives), rows in courses.items():
        yield (course, str(drives), *(f"{100 * row['largest_m']:.1f} ({100 * row['rms_m']:.1f})" for row in rows))


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("scenes", metavar="SCENES.json", type=Path, help="what bench_patrol --rows wrote")
    parser.add_argument("courses", metavar="COURSES.json", type=Path, help="what bench_pursuit --rows wrote")
    parser.add_argument("tables", metavar="TABLES.json", type=Path, help="where the tables go")
    return parser.parse_args()


def main():
    options = arguments()
    scenes = list(scene_table(options.scenes))
    heading, *courses = course_table(options.courses)
    write_tables(options.tables, {"patrol": (SCENE_HEADINGS, scenes), "pursuit": (heading, courses)})

    print("improved / plain / pursuit")
    print_aligned([SCENE_HEADINGS, *scenes])
    print("\npure pursuit, distance from the path, cm: largest (root mean square)")
    print_aligned([heading, *courses])
    print(f"\nwrote {shown_path(options.tables)}")
    return 0


if __name__ == "__main__":
    run(main)
