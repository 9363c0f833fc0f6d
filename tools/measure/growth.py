#!/usr/bin/env python3
"""Compare the measured numbers of the cores with the accepted ones in tests/target/numbers.json.

A number may grow by 5 %, and tiny ones by 16 B of size, 8 B of stack or 20 instructions. What grew more must be
explained: a line in the list "explained" with its name, the new value and a reason. Under another version of a compiler
25 % are allowed. With --accept the measured numbers become the accepted ones.
Exit status 1: a number grew unexplained, or is new or gone; nothing was accepted. 2: bad input, nothing was written.
"""
import json
import subprocess
from pathlib import Path

from tools.common import ArgumentParser, ToolError, run, shown_path, write_whole
from tools.measure import core_numbers

LIMIT, LIMIT_OTHER_COMPILER = 0.05, 0.25
SLACK = {"size": 16, "stack": 8, "cycles": 20}
COMPILERS = ("arm-none-eabi-gcc", "riscv64-unknown-elf-gcc")


def compiler_versions():
    versions = {}
    for compiler in COMPILERS:
        try:
            result = subprocess.run([compiler, "-dumpfullversion"], capture_output=True, text=True, check=True)
        except (OSError, subprocess.CalledProcessError) as error:
            raise ToolError(f"{compiler}: {error}") from None
        versions[compiler] = result.stdout.strip()
    return versions


def check_explained(source, accepted):
    """{name: value} of the explained numbers."""
    explained = {}
    for index, line in enumerate(accepted.get("explained", [])):
        if not isinstance(line, dict) or not isinstance(line.get("name"), str) or type(line.get("value")) is not int:
            raise ToolError(f"{source}: explained {index}: must have name and value")
        if not isinstance(line.get("reason"), str) or not line["reason"].strip():
            raise ToolError(f"{source}: explained {index}: {line['name']}: the reason is missing")
        explained[line["name"]] = line["value"]
    return explained


def cores_of(table):
    return {core for values in table.values() for core in values}


def flat(kind, table, cores=None):
    """{name: value}, of some cores or of all."""
    return {f"{kind}: {row}: {core}": value for row, values in table.items() for core, value in values.items()
            if cores is None or core in cores}


def may_be(kind, old, limit):
    """The greatest value that needs no explanation."""
    return old + max(SLACK[kind], int(limit * old))


def grown(kind, accepted, measured, explained, limit):
    """Complaints about numbers that grew."""
    old, new = flat(kind, accepted[kind]), flat(kind, measured)
    for name in old.keys() & new.keys():
        if new[name] > max(may_be(kind, old[name], limit), explained.get(name, 0)):
            line = json.dumps({"name": name, "value": new[name], "reason": "..."})
            yield (f"error: {name}: {old[name]} grew to {new[name]} {core_numbers.UNITS[kind]}; make it smaller, or "
                   f"explain it in tests/target/numbers.json: {line}")


def changed_names(kind, accepted, measured):
    """Complaints about numbers that are new or gone on the cores that were measured."""
    old, new = flat(kind, accepted[kind], cores_of(measured)), flat(kind, measured)
    for name in sorted(new.keys() - old.keys()):
        yield f"error: {name}: {new[name]} is new: accept it by `make numbers`"
    for name in sorted(old.keys() - new.keys()):
        yield f"error: {name}: is measured no more: accept that by `make numbers`"


def still_explained(accepted, tables):
    """Explanations of numbers that are what they say."""
    new = {name: value for kind, table in tables.items() for name, value in flat(kind, table).items()}
    return [line for line in accepted.get("explained", []) if new.get(line["name"]) == line["value"]]


def accept(path, accepted, versions, tables):
    numbers = {"compilers": versions, **tables, "explained": still_explained(accepted, tables)}
    write_whole(path, json.dumps(numbers, indent=2) + "\n")
    print(f"wrote {shown_path(path)}")


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("kinds", metavar="KIND", nargs="*", help=f"of {', '.join(core_numbers.UNITS)} (default: all)")
    parser.add_argument("--accept", action="store_true", help="make the measured numbers the accepted ones")
    parser.add_argument("--accepted", metavar="FILE", type=Path, default=core_numbers.ACCEPTED,
                        help="default: tests/target/numbers.json")
    options = parser.parse_args()
    for kind in options.kinds:
        if kind not in core_numbers.UNITS:
            raise ToolError(f"{kind}: must be one of {', '.join(core_numbers.UNITS)}")
    if options.accept and options.kinds:
        raise ToolError("--accept: takes all kinds, name none")
    options.kinds = options.kinds or list(core_numbers.UNITS)
    return options


def main():
    options = arguments()
    accepted = core_numbers.check_accepted(options.accepted, core_numbers.read_json(options.accepted))
    explained = check_explained(options.accepted, accepted)
    versions = compiler_versions()
    limit = LIMIT if versions == accepted.get("compilers") else LIMIT_OTHER_COMPILER
    tables = {kind: core_numbers.read_measured(kind) for kind in options.kinds}
    complaints = []
    for kind, table in tables.items():
        complaints += sorted(grown(kind, accepted, table, explained, limit))
        if not options.accept:
            complaints += changed_names(kind, accepted, table)
    for complaint in complaints:
        print(complaint)
    if not complaints and options.accept:
        accept(options.accepted, accepted, versions, tables)
    return 1 if complaints else 0


if __name__ == "__main__":
    run(main)
