#!/usr/bin/env python3
"""Run the fuzz targets of tests/fuzz, one after the other, and say what they found.

Each begins with its seeds: those in tests/fuzz/seeds/<target>, files of this repository of the kind that it reads, and a
few long inputs of any bytes. What it learns stays in FOLDER/<target>/corpus, an input that breaks it in
FOLDER/<target>/found-*. With --runs instead of --seconds it begins anew and does the same each time. Exit status 1: an
input broke a target; 2: bad input.
"""
import json
import os
import random
import re
import shutil
import subprocess
from dataclasses import asdict, dataclass
from pathlib import Path

from tools.common import EXIT_MISSED, ROOT, ArgumentParser, ToolError, print_aligned, run, whole_number, write_whole

SEEDS = ROOT / "tests/fuzz/seeds"
LEAKS = ROOT / "tests/fuzz/leaks.txt"
# What the readers of files read.
FILES = {"robot_file": "sim/robots/*.cfg", "scenario": "sim/scenarios/*.cfg", "map_file": None}
LONG_SEEDS = (256, 1024, 4096)
STATISTIC = re.compile(r"^stat::(\w+):\s+(\d+)$", re.M)
FEATURES = re.compile(r"\bft: (\d+)")
REASON = re.compile(r"^.*(?:ERROR: |runtime error).*$", re.M)


@dataclass
class Outcome:
    """What became of a target."""

    target: str
    executions: int
    executions_per_second: int
    features: int
    findings: list[str]
    reason: str


def write_long_seeds(folder, target):
    """Inputs long enough to lead somewhere, always the same."""
    folder.mkdir(parents=True, exist_ok=True)
    source = random.Random(target)
    for length in LONG_SEEDS:
        (folder / f"long_{length}").write_bytes(source.randbytes(length))


def seeds_of(target, folder):
    """Folders of seeds."""
    if target not in FILES:
        write_long_seeds(folder, target)
        yield folder
    elif FILES[target]:
        folder.mkdir(parents=True, exist_ok=True)
        for path in ROOT.glob(FILES[target]):
            shutil.copy(path, folder)
        yield folder
    if (SEEDS / target).is_dir():
        yield SEEDS / target


def fuzz(program, options):
    target = program.name.removeprefix("fuzz_")
    folder = options.folder / target
    if options.runs:
        shutil.rmtree(folder, ignore_errors=True)
    corpus = folder / "corpus"
    corpus.mkdir(parents=True, exist_ok=True)
    before = set(folder.glob("found-*"))
    command = [program, f"-artifact_prefix={folder}/found-", "-print_final_stats=1", "-timeout=20", "-rss_limit_mb=2048",
               f"-seed={options.seed}", f"-runs={options.runs}" if options.runs else f"-max_total_time={options.seconds}",
               corpus, *seeds_of(target, folder / "seeds")]
    log = folder / "log"
    environment = os.environ | {"LSAN_OPTIONS": f"suppressions={LEAKS}:print_suppressions=0",
                                "UBSAN_OPTIONS": "print_stacktrace=1"}
    with log.open("wb") as output:
        status = subprocess.run(command, stdout=output, stderr=subprocess.STDOUT, env=environment,
                                check=False).returncode
    text = log.read_text(errors="replace")
    statistics = dict(STATISTIC.findall(text))
    findings = [str(path) for path in sorted(set(folder.glob("found-*")) - before)]
    reason = REASON.search(text)
    if status == 0 and "number_of_executed_units" not in statistics:
        raise ToolError(f"{program}: ran nothing; see {log}")
    if status != 0 and not findings:
        findings = [str(log)]
    return Outcome(target, int(statistics.get("number_of_executed_units", 0)),
                   int(statistics.get("average_exec_per_sec", 0)),
                   max(map(int, FEATURES.findall(text)), default=0), findings,
                   reason[0].strip() if findings and reason else "")


def print_unity(outcome):
    """As a test program does, for tools/measure/test_summary.py."""
    place = f"tests/fuzz/fuzz_{outcome.target}.c:1:no_input_breaks_it"
    failed = bool(outcome.findings)
    print(f"{place}:FAIL: {outcome.findings[0]}: {outcome.reason}" if failed else f"{place}:PASS")
    print(f"{outcome.executions} executions, {outcome.features} features\n\n1 Tests {int(failed)} Failures 0 Ignored")


def print_table(outcomes):
    print_aligned([("target", "executions", "executions/s", "features", "findings"),
                   *((o.target, str(o.executions), str(o.executions_per_second), str(o.features), str(len(o.findings)))
                     for o in outcomes)])
    for outcome in outcomes:
        for finding in outcome.findings:
            print(f"{finding}: {outcome.reason}")


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("programs", metavar="PROGRAM", type=Path, nargs="+")
    parser.add_argument("--folder", metavar="DIR", type=Path, required=True, help="for what is found")
    length = parser.add_mutually_exclusive_group(required=True)
    length.add_argument("--seconds", metavar="S", type=whole_number(1, 1000000), help="for each target")
    length.add_argument("--runs", metavar="N", type=whole_number(1, 1000000000), help="as one test of a suite")
    parser.add_argument("--seed", metavar="N", type=whole_number(0, 2**32 - 1), default=0, help="0: another each time")
    parser.add_argument("--json", metavar="FILE", type=Path, help="the table, for programs")
    options = parser.parse_args()
    for program in options.programs:
        if not program.is_file():
            raise ToolError(f"{program}: no such program; targets are the files of tests/fuzz")
    return options


def main():
    options = arguments()
    outcomes = []
    for number, program in enumerate(options.programs, 1):
        if options.seconds:
            print(f"{program.name}: {number} of {len(options.programs)}, {options.seconds} s", flush=True)
        outcomes.append(fuzz(program, options))
    if options.runs:
        for outcome in outcomes:
            print_unity(outcome)
    else:
        print_table(outcomes)
    if options.json:
        write_whole(options.json, json.dumps([asdict(outcome) for outcome in outcomes], indent=1) + "\n")
    return EXIT_MISSED if any(outcome.findings for outcome in outcomes) else 0


if __name__ == "__main__":
    run(main)
