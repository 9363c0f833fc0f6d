#!/usr/bin/env python3
"""Modified condition/decision coverage of rooms by their unit tests, measured by clang 19.

Of each decision with two or more conditions: whether the tests show of each condition that it alone changes the outcome
(masking MC/DC). Of decisions with one condition: both outcomes, as of all branches. What no input can show is listed with
its reason in tests/proof/mcdc.yaml. Exit status 1: a condition or an outcome is neither shown nor explained, or an entry
of the list is not needed.
"""
import concurrent.futures
import json
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from tools.common import EXIT_MISSED, ROOT, ArgumentParser, ToolError, print_aligned, run, whole_number, write_whole
from tools.measure.proof_rooms import chosen_rooms, one_line
from tools.measure.reviewed import Reviewed

REVIEWED = ROOT / "tests/proof/mcdc.yaml"
KEYS = ("file", "decision", "condition")
LIMIT_S = 120
# Between two conditions of one decision.
JOINED = re.compile(r"[\s)]*(&&|\|\|)[\s(!]*")


@dataclass
class Decision:
    """Where it is, its text, and of each condition its text and whether it was shown."""

    file: str
    line: int
    text: str
    conditions: list[str]
    shown: list[bool]


@dataclass
class FileResult:
    """Of one source."""

    file: str
    decisions: list[Decision] = field(default_factory=list)
    outcomes: int = 0
    not_taken: list[tuple] = field(default_factory=list)  # (line, branch, outcome)
    explained: int = 0
    open: list[str] = field(default_factory=list)

    def conditions(self):
        return sum(len(decision.shown) for decision in self.decisions)

    def shown(self):
        return sum(sum(decision.shown) for decision in self.decisions)


# ---- What clang measured ---------------------------------------------------------------------------------------------

def run_test(program, folder):
    """Its profile; a test that fails tells nothing."""
    profile = folder / f"{program.name}.profraw"
    result = subprocess.run([program], capture_output=True, text=True, timeout=LIMIT_S, check=False,
                            env={"LLVM_PROFILE_FILE": str(profile)})
    if result.returncode != 0:
        raise ToolError(f"{program}: failed; make test SUITE=unit tells why")
    return profile


def output_of(command):
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout
    except FileNotFoundError:
        raise ToolError(f"{command[0]}: not installed; Debian's packages clang-19 and llvm-19 have it") from None
    except subprocess.CalledProcessError as error:
        raise ToolError(f"{command[0]}: {error.stderr.strip().splitlines()[-1]}") from None


def measure(programs, objects, jobs):
    """clang's export for all files of these objects."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            profiles = list(pool.map(lambda program: run_test(program, folder), programs))
        merged = folder / "all.profdata"
        output_of(["llvm-profdata-19", "merge", "-sparse", "-o", merged, *profiles])
        return json.loads(output_of(["llvm-cov-19", "export", "-skip-expansions", f"-instr-profile={merged}",
                                     *(argument for path in objects for argument in ("-object", path))]))


# ---- What it says of a file ------------------------------------------------------------------------------------------

def text_between(lines, region):
    first_line, first_column, last_line, last_column = region
    chosen = lines[first_line - 1:last_line]
    chosen[-1] = chosen[-1][:last_column - 1]
    chosen[0] = chosen[0][first_column - 1:]
    return one_line("\n".join(chosen))


def inside(region, outer):
    return tuple(outer[:2]) <= tuple(region[:2]) and tuple(region[2:4]) <= tuple(outer[2:4])


def merged(records, combine):
    """Of the instances of a region, which a function in a header has several of, one."""
    regions = {}
    for region, value in records:
        regions[region] = combine(regions[region], value) if region in regions else value
    return regions


def condition_texts(lines, region, branches, count):
    """In the order of the source, when the branches in the decision are just its conditions."""
    own = sorted(branch for branch in branches if inside(branch, region))
    if len(own) != count:
        return [f"condition {number}" for number in range(1, count + 1)]
    return [text_between(lines, branch) for branch in own]


def decisions_of(name, lines, records, branches):
    shown = merged(((tuple(record[:4]), record[-1]) for record in records),
                   lambda a, b: [x or y for x, y in zip(a, b)])
    for region, conditions in sorted(shown.items()):
        yield Decision(name, region[0], text_between(lines, region),
                       condition_texts(lines, region, branches, len(conditions)), conditions)


def result_of(name, entries):
    lines = (ROOT / name).read_text(encoding="utf-8").splitlines()
    branches = merged(((tuple(record[:4]), (record[4], record[5])) for entry in entries for record in entry["branches"]),
                      lambda a, b: (a[0] + b[0], a[1] + b[1]))
    result = FileResult(name, outcomes=2 * len(branches))
    records = [record for entry in entries for record in entry["mcdc_records"]]
    result.decisions = list(decisions_of(name, lines, records, branches))
    result.open += unmeasured(name, lines, branches, {tuple(record[:4]) for record in records})
    for region, counts in sorted(branches.items()):
        for outcome, count in zip(("true", "false"), counts):
            if count == 0:
                result.not_taken.append((region[0], text_between(lines, region), f"never {outcome}"))
    return result


def results_of(export, files):
    entries = {}
    for entry in export["data"][0]["files"]:
        name = Path(entry["filename"])
        if name.is_relative_to(ROOT):
            entries.setdefault(name.relative_to(ROOT).as_posix(), []).append(entry)
    return [result_of(name, entries[name]) for name in files if name in entries]


def unmeasured(name, lines, branches, decisions):
    """Conditions that belong together and to no decision: clang 19 leaves out a decision with one inside a negation."""
    plain = [region for region in sorted(branches) if not any(inside(region, decision) for decision in decisions)]
    for before, after in zip(plain, plain[1:]):
        if before[2:4] <= after[:2] and JOINED.fullmatch(text_between(lines, before[2:4] + after[:2])):
            yield f"{name}:{before[0]}: error: clang 19 cannot measure this decision: write it as two, or as a function"


def judge(result, reviewed):
    for decision in result.decisions:
        for condition, shown in zip(decision.conditions, decision.shown):
            if shown:
                continue
            if reviewed.explains(decision.file, decision.text, condition):
                result.explained += 1
            else:
                result.open.append(f"{decision.file}:{decision.line}: error: not shown to matter alone: {condition} in "
                                   f"{decision.text}")
    for line, branch, outcome in result.not_taken:
        if not reviewed.explains(result.file, branch, outcome):
            result.open.append(f"{result.file}:{line}: error: {outcome}: {branch}")


# ---- What a person sees ----------------------------------------------------------------------------------------------

def percent(part, whole):
    return f"{100 * part / whole if whole else 100:.2f}"


def row(name, results):
    conditions, shown = (sum(getattr(result, what)() for result in results) for what in ("conditions", "shown"))
    outcomes = sum(result.outcomes for result in results)
    not_taken = sum(len(result.not_taken) for result in results)
    return (name, str(sum(len(result.decisions) for result in results)), str(conditions), str(shown),
            str(sum(result.explained for result in results)), percent(shown, conditions), str(outcomes),
            percent(outcomes - not_taken, outcomes))


def print_table(rooms):
    rows = [("file", "decisions", "conditions", "shown", "explained", "%", "outcomes", "%")]
    for room, results in rooms.items():
        rows += [row(result.file, [result]) for result in results]
        rows.append(row(f"{room}:", results))
    print_aligned([*rows, row("all:", [result for results in rooms.values() for result in results])])


def as_json(rooms):
    return json.dumps({room: [{"file": result.file, "decisions": len(result.decisions), "conditions": result.conditions(),
                               "shown": result.shown(), "explained": result.explained, "outcomes": result.outcomes,
                               "taken": result.outcomes - len(result.not_taken)} for result in results]
                       for room, results in rooms.items()}, indent=1) + "\n"


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("programs", metavar="PROGRAM", type=Path, nargs="+", help="unit tests")
    parser.add_argument("--room", metavar="NAME", action="append", help="instead of those that can hurt someone")
    parser.add_argument("--objects", metavar="DIR", type=Path, required=True, help="what they are linked of")
    parser.add_argument("--reviewed", metavar="FILE", type=Path, default=REVIEWED)
    parser.add_argument("--json", metavar="FILE", type=Path, help="the table, for programs")
    parser.add_argument("--jobs", metavar="N", type=whole_number(1, 1024), default=1)
    return parser.parse_args()


def main():
    options = arguments()
    chosen = chosen_rooms(options.room)
    reviewed = Reviewed(options.reviewed, KEYS)
    objects = [options.objects / Path(file).with_suffix(".o") for files in chosen.values() for file in files
               if file.endswith(".c")]
    export = measure(options.programs, objects, options.jobs)
    rooms = {room: results_of(export, files) for room, files in chosen.items()}
    results = [result for of_room in rooms.values() for result in of_room]
    for result in results:
        judge(result, reviewed)
    print_table(rooms)
    problems = [problem for result in results for problem in result.open]
    problems += reviewed.unneeded({result.file for result in results})
    for problem in problems:
        print(problem, file=sys.stderr)
    if options.json:
        write_whole(options.json, as_json(rooms))
    return EXIT_MISSED if problems else 0


if __name__ == "__main__":
    run(main)
