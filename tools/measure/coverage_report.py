#!/usr/bin/env python3
"""Table of a coverage summary by gcovr, and its figures for tools/measure/figures.py.

Prints lines and branches of each file and how many of them the tests take; to stderr one `file:1: error: what` for each
file that they do not take all of.
"""
import argparse
import json
import sys
from pathlib import Path

from tools.common import ArgumentParser, print_aligned, read_text, run, write_whole

COUNTS = {"line": "lines of src/ executed", "branch": "branches of src/ taken"}


def percent(entry, what):
    total = entry[f"{what}_total"]
    return 100 * entry[f"{what}_covered"] / total if total else 100.0


def row(name, entry):
    return [name] + [cell for what in COUNTS for cell in (str(entry[f"{what}_total"]), f"{percent(entry, what):.2f}")]


def problems(summary):
    for entry in summary["files"]:
        missing = {what: entry[f"{what}_total"] - entry[f"{what}_covered"] for what in COUNTS}
        if any(missing.values()):
            yield f"{entry['filename']}:1: error: not tested: {missing['line']} lines, {missing['branch']} branches"


def figures(summary):
    return [{"name": f"host tests: {name}", "value": percent(summary, what), "unit": "%",
             "bound": {"op": "==", "value": 100}, "command": "make coverage"} for what, name in COUNTS.items()]


def main():
    parser = ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("summary", type=Path, help="gcovr's --json-summary")
    parser.add_argument("figures", type=Path, help="to be written")
    arguments = parser.parse_args()
    summary = json.loads(read_text(arguments.summary))

    print_aligned([["file", "lines", "%", "branches", "%"]]
                  + [row(entry["filename"], entry) for entry in summary["files"]] + [row("all", summary)])
    for problem in problems(summary):
        print(problem, file=sys.stderr)
    write_whole(arguments.figures, json.dumps(figures(summary), indent=1) + "\n")


if __name__ == "__main__":
    run(main)
