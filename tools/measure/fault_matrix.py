#!/usr/bin/env python3
"""The matrix of faults: every fault in every state of every robot on every transport, as the page tests/FAULTS.md.

Table-driven tests (tests/fault/fault_matrix_*.c) tell their cells: what is expected and what was seen. Other cells stand in
tests/proof/fault_cells.yaml with the test that has them, or why there is no such fault. A fault of enum jp_fault that
a robot has on no line, a line with an empty cell, and a test that does not exist are errors. With --check the page is
compared, not written, and empty cells are only told.
"""
import itertools
import json
import os
import re
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

import yaml

from tools.common import EXIT_MISSED, ROOT, ArgumentParser, ToolError, read_text, run, write_whole

PAGE = ROOT / "tests/FAULTS.md"
CELLS = ROOT / "tests/proof/fault_cells.yaml"
FAULTS = ROOT / "include/joulepath/monitor.h"
STATES = {"balancer": ["idle", "balancing", "driving", "fallen", "fault"],
          "skid steer": ["idle", "standing", "driving", "fault"],
          "four wheels": ["idle", "standing", "driving", "fault"]}
TRANSPORTS = ("board", "CAN", "LCM")
KEYS = {"robot", "transport", "fault", "states", "test", "seen", "impossible"}
EMPTY = "empty"
ANY = "any"

HEADING = """# Faults

Made by `make faults` from the tests that are named; do not edit. A cell says what the robot does: the state in which it
ends, the faults that it reports, and after how many ticks of its control its motors are off or it brakes. Every cell of a
table-driven test is asserted there.

"""


def fault_names():
    return re.findall(r"\bJP_FAULT_(\w+) = 1 <<", read_text(FAULTS))


# ---- Cells -----------------------------------------------------------------------------------------------------------

def tested_cells(program):
    """Of a table-driven test, with its name."""
    with tempfile.NamedTemporaryFile() as cells:
        result = subprocess.run([program], capture_output=True, check=False, env={**os.environ, "FAULT_CELLS": cells.name})
        if result.returncode != 0:
            raise ToolError(f"{program}: fails; make test SUITE=fault tells why")
        return [json.loads(line) | {"test": f"tests/fault/{program.name}.c"} for line in cells]


def has_test(name):
    path, _, function = name.partition("::")
    return (ROOT / path).is_file() and re.search(rf"\b{function}\(void\)", read_text(ROOT / path)) is not None


def as_list(value):
    return value if isinstance(value, list) else [value]


def listed_cells(path):
    for number, entry in enumerate(yaml.safe_load(read_text(path)), 1):
        if not {"robot", "transport", "fault"} <= entry.keys() <= KEYS or ("test" in entry) == ("impossible" in entry):
            raise ToolError(f"{path}: entry {number}: must have robot, transport, fault, and test with seen, or impossible")
        if "test" in entry and not has_test(entry["test"]):
            raise ToolError(f"{path}: entry {number}: there is no test {entry['test']}")
        told = {key: entry[key] for key in ("test", "seen", "impossible") if key in entry}
        for robot, transport, fault, state in itertools.product(*(as_list(entry.get(key, ANY)) for key in
                                                                  ("robot", "transport", "fault", "states"))):
            yield told | {"robot": robot, "transport": transport, "fault": fault, "state": state}


def table_of(cells):
    """{(robot, transport, fault): {state: cell}}"""
    table = {}
    for cell in cells:
        line = table.setdefault((cell["robot"], cell["transport"], cell["fault"]), {})
        state = cell.setdefault("state", ANY)
        if state in line:
            raise ToolError(f"{cell['robot']}, {cell['transport']}, {cell['fault']}, {state}: two cells")
        line[state] = cell
    return table


def problems_of(table):
    """Empty cells."""
    every = {fault for _, _, fault in table}
    for robot, states in STATES.items():
        for transport in TRANSPORTS:
            for fault in sorted(every | set(fault_names())):
                line = table.get((robot, transport, fault)) or detailed(table, robot, transport, fault)
                if not line:
                    yield f"{PAGE.name}: error: empty: {robot}, {transport}, {fault}"
                elif ANY not in line:
                    yield from (f"{PAGE.name}: error: empty: {robot}, {transport}, {fault}, {state}"
                                for state in states if state not in line)


def detailed(table, robot, transport, fault):
    """The first line of a fault that has several causes, such as HARDWARE."""
    return next((line for name, line in table.items()
                 if name[:2] == (robot, transport) and name[2].startswith(f"{fault}: ")), None)


# ---- The page --------------------------------------------------------------------------------------------------------

def shown(cell):
    if "impossible" in cell:
        return "–"
    after = f", {cell['ticks']} ticks" if cell.get("ticks") else ""
    if cell["seen"].startswith("fault: "):
        return cell["seen"].removeprefix("fault: ").replace(" and ", ", ") + after
    return cell["seen"] + after


def link(test):
    path, _, function = test.partition("::")
    return f"[{function or Path(path).name}]({path.removeprefix('tests/')})"


def row(fault, transport, line, states):
    tests = dict.fromkeys(link(cell["test"]) for cell in line.values() if "impossible" not in cell)
    cells = (line.get(state) or line.get(ANY) for state in states)
    return [fault, transport, *(shown(cell) if cell else EMPTY for cell in cells), " ".join(tests)]


def is_impossible(line):
    return all("impossible" in cell for cell in line.values())


def reasons(robot, table):
    """Of a robot's impossible lines, each reason once."""
    grouped = {}
    for (name, transport, fault), line in table.items():
        if name == robot:
            for cell in line.values():
                if "impossible" in cell:
                    state = "" if cell["state"] == ANY else f" ({cell['state']})"
                    grouped.setdefault((transport, cell["impossible"]), []).append(f"{fault}{state}")
    for (transport, reason), faults in grouped.items():
        yield f"- {transport}: {', '.join(faults)}: {reason}."


def markdown(rows):
    return "\n".join("| " + " | ".join(cells) + " |" for cells in rows) + "\n"


def in_order(faults):
    """Those of enum jp_fault first."""
    names = fault_names()
    return sorted(faults, key=lambda fault: next(
        (i for i, name in enumerate(names) if fault == name or fault.startswith(f"{name}: ")), len(names)))


def page(table):
    text = HEADING
    for robot, states in STATES.items():
        faults = in_order(dict.fromkeys(fault for name, _, fault in table if name == robot))
        rows = [["fault", "transport", *states, "test"], ["---"] * (len(states) + 3)]
        rows += [row(fault, transport, line, states) for fault in faults for transport in TRANSPORTS
                 for line in [table.get((robot, transport, fault), {})] if line and not is_impossible(line)]
        text += f"## {robot.capitalize()}\n\n{markdown(rows)}\nImpossible:\n" + "\n".join(reasons(robot, table)) + "\n\n"
    return text + f"{count(table)}.\n"


def count(table):
    """Of all cells, in words."""
    kinds = Counter()
    for (robot, _, _), line in table.items():
        for state in STATES[robot]:
            cell = line.get(state) or line.get(ANY) or {}
            kinds["impossible" if "impossible" in cell else "table" if "expected" in cell else "test" if cell else EMPTY] += 1
    return (f"{kinds.total()} cells: {kinds['table']} of table-driven tests, {kinds['test']} of other tests, "
            f"{kinds['impossible']} impossible, {kinds[EMPTY]} empty")


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("programs", metavar="PROGRAM", type=Path, nargs="+", help="table-driven tests")
    parser.add_argument("--cells", metavar="FILE", type=Path, default=CELLS)
    parser.add_argument("--page", metavar="FILE", type=Path, default=PAGE)
    parser.add_argument("--check", action="store_true", help="that the page is what it would be")
    return parser.parse_args()


def main():
    options = arguments()
    cells = [cell for program in options.programs for cell in tested_cells(program)] + list(listed_cells(options.cells))
    table = table_of(cells)
    problems = list(problems_of(table))
    for problem in problems:
        print(problem, file=sys.stderr)
    if options.check:
        if read_text(options.page) != page(table):
            print(f"{options.page}: error: is not what the tests say: make faults", file=sys.stderr)
            return EXIT_MISSED
        return 0
    write_whole(options.page, page(table))
    return EXIT_MISSED if problems else 0


if __name__ == "__main__":
    run(main)
