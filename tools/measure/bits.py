#!/usr/bin/env python3
"""Write the figure of the tests of equal bits: how many of their runs passed.

Exit status 2: bad input; nothing was written.
"""
import argparse
import json
from pathlib import Path

from tools.common import read_text, run, write_whole


def figure(texts):
    passed = sum("OK" in text.splitlines() for text in texts)
    return {"name": f"planner and grid planner: same routes, costs and expansions on x86-64, -m32 and five cores, of {len(texts)}",
            "value": passed, "unit": "", "bound": {"op": "==", "value": len(texts)}, "command": "make figures"}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("logs", metavar="LOG", nargs="+", type=Path, help="of a run")
    parser.add_argument("--output", metavar="FILE", type=Path, required=True, help="of the figure, JSON")
    options = parser.parse_args()
    write_whole(options.output, json.dumps([figure([read_text(log) for log in options.logs])], indent=2) + "\n")


if __name__ == "__main__":
    run(main)
