#!/usr/bin/env python3
"""Judge the MISRA violations that cppcheck found by the recorded reasons.

The violations are lines `file:line:column: misra-c2012-RULE`. Prints the records with how often each was needed; to
stderr one `place: error: what` for each violation without a record, each record without a violation, and each file that
was not checked because cppcheck or its addon broke down on it, which cppcheck's exit status does not tell.
"""
import argparse
import re
import sys
from dataclasses import dataclass
from pathlib import Path

import yaml
from tools.common import ArgumentParser, ToolError, print_aligned, read_text, run

VIOLATION = re.compile(r"(?P<file>[^:]+):(?P<line>\d+):\d+: misra-c2012-(?P<rule>\d+\.\d+)")
FOUND = re.compile(r"(?P<file>[^:]+):\d+:\d+: (?P<what>[\w.-]+)")
BAILED_OUT = re.compile(r"Bailing out from checking (?P<file>.*?) ?since there was an internal error: (?P<why>.*)")
PROJECT = "project"  # what is checked of all files together has none
KEYS = {"rule", "class", "in", "code", "reason"}
CLASSES = ("advisory", "required")


@dataclass
class Record:
    """A rule that is deviated from, in these files and lines with this code."""

    place: str
    rule: str
    kind: str
    files: str
    code: str
    reason: str
    found: int = 0

    def covers(self, rule, file, text):
        return rule == self.rule and re.fullmatch(self.files, file) and re.search(self.code, text)

    def where(self):
        return " ".join(filter(None, ["" if self.files == ".*" else self.files, self.code])) or "everywhere"


def record_of(entry, place):
    if not isinstance(entry, dict) or not {"rule", "class", "reason"} <= entry.keys() <= KEYS:
        raise ToolError(f"{place}: must have rule, class and reason, and may have in and code")
    if entry["class"] not in CLASSES:
        raise ToolError(f"{place}: class must be {' or '.join(CLASSES)}")
    return Record(place, str(entry["rule"]), entry["class"], entry.get("in", ".*"), entry.get("code", ""),
                  " ".join(entry["reason"].split()))


def read_records(path):
    text = read_text(path)
    lines = [number for number, line in enumerate(text.splitlines(), 1) if line.startswith("- ")]
    return [record_of(entry, f"{path}:{line}") for entry, line in zip(yaml.safe_load(text), lines)]


def read_violations(path):
    """(file, line, rule), one for each column."""
    matches = filter(None, map(VIOLATION.fullmatch, sorted(set(read_text(path).splitlines()))))
    return [(match["file"], int(match["line"]), match["rule"]) for match in matches]


def breakdowns(path):
    """Of all that is not something found: where cppcheck gave up, with the last line of what it says of it."""
    broken = {}
    place = PROJECT
    for line in filter(None, map(str.strip, read_text(path).splitlines())):
        bailed, found = BAILED_OUT.match(line), FOUND.fullmatch(line)
        if found and found["what"] != "internalError":
            continue
        place = bailed["file"] or PROJECT if bailed else found["file"] if found else place
        broken[place] = bailed["why"] if bailed else line
    for place, why in broken.items():
        yield f"{place}:1: error: not checked for MISRA C:2012, the addon failed: {why}"


def unexplained(records, violations):
    """Counts for each record what it covers, and yields what none covers."""
    for file, line, rule in violations:
        text = read_text(file).splitlines()[line - 1].strip()
        covering = [record for record in records if record.covers(rule, file, text)]
        for record in covering:
            record.found += 1
        if not covering:
            yield f"{file}:{line}: error: MISRA C:2012 rule {rule}, and no reason is recorded: {text}"


def main():
    parser = ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("records", type=Path, help="YAML")
    parser.add_argument("violations", type=Path, help="output of cppcheck")
    arguments = parser.parse_args()
    records = read_records(arguments.records)

    for problem in [*breakdowns(arguments.violations), *unexplained(records, read_violations(arguments.violations))]:
        print(problem, file=sys.stderr)
    for record in records:
        if record.found == 0:
            print(f"{record.place}: error: the code keeps rule {record.rule} now: remove the record", file=sys.stderr)
    print(f"{sum(record.found for record in records)} violations of {len({record.rule for record in records})} rules")
    print_aligned([["rule", "class", "found", "where", "reason"]]
                  + [[record.rule, record.kind, str(record.found), record.where(), record.reason]
                     for record in records])


if __name__ == "__main__":
    run(main)
