#!/usr/bin/env python3
"""Prove the absence of undefined behaviour by abstract interpretation: Frama-C's Eva on the drivers of tests/proof.

A driver calls a module with anything that its header allows. Compiled in is what it stands on, which the linker tells
from the libraries that are given. An alarm is an operation that Eva cannot prove to be defined. tests/proof/alarms.yaml
lists those that were reviewed: with the reason why they cannot happen, or as open. Prints a table, and each alarm beyond
the list.
tests/proof/functions.yaml lists the public functions that drivers reach, and those that none does.
Results are kept in FOLDER by the content of all that was compiled in. Exit status 1: an alarm that is not listed, one
that is listed and gone, a list of functions that is not true, or a driver that was not analysed to its end; 2: bad input.
"""
import csv
import hashlib
import json
import os
import re
import signal
import subprocess
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

import yaml

from tools.common import (EXIT_MISSED, ROOT, ArgumentParser, ToolError, print_aligned, read_text, run, whole_number,
                          write_whole)
from tools.measure.proof_functions import FUNCTIONS, problems, public_functions, write_functions

ROOM = ROOT / "tests/proof"
DRIVERS = ROOM / "drivers"
ALARMS = ROOM / "alarms.yaml"
# Of the sources that the analyser reads in the place of the core's.
INSTEAD = "tests/proof/c11"
# Before the directory in which the analyser compiles.
INCLUDES = (f"-iquote{INSTEAD}", "-Iinclude", "-I.", "-include", f"{INSTEAD}/atomics.h")
# 32 bits as the cores have; each result of a function is followed by itself, a check's verdict with what it saw.
# Loops over a table or its members are followed turn by turn.
EVA = ("-c11", "-machdep", "gcc_x86_32", "-eva", "-eva-precision", "1", "-eva-auto-loop-unroll", "128",
       "-eva-split-return", "full", "-eva-show-progress", "-eva-msg-key=-final-states,-initial-state",
       "-eva-warn-key", "loop-unroll=inactive")
# What is added to the name of a static function that several sources have, or of a copy in line.
COPY = re.compile(r"(__fc_inline)?(_\d+)?$")
OPTIONS = re.compile(r"^// eva: (.*)$", re.M)
# What is added to the name of a parameter or a constant that several functions or sources have.
RENAMED = re.compile(r"\b([A-Za-z]\w*?)_\d+\b")
REACHED = re.compile(r"In th(?:is|ese) functions?, (\d+) statements reached \(out of (\d+)\)")
ANALYSED = re.compile(r"computing for function (\w+) <-")
UNKNOWN = re.compile(r"Neither code nor specification for function (\w+)")
COUNTED = re.compile(r"(\d+) functions? analyzed")
END = "Frama_C_show_each_end"
# Properties that are no alarms: what a declaration assumes of a library's function.
ASSUMED = ("assigns clause", "from clause", "postcondition", "complete behaviors", "disjoint behaviors", "complete clause",
           "disjoint clause", "behavior", "default behavior")
PROVED = ("Valid", "Valid but dead", "Considered valid")


@dataclass
class Result:
    """Of a driver. `trouble`: why it was not analysed to its end."""

    driver: str
    functions: int
    reached: int
    statements: int
    alarms: list  # [file, line, function, kind, property]
    seconds: float
    trouble: str
    names: list  # of the functions that were analysed


def driver_name(path):
    return f"{path.parent.name}/{path.stem.removeprefix('prove_')}"


def call(command, **options):
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False, **options)


def members(driver, libraries, folder):
    """Sources of the libraries' members that the linker takes for the driver, in the order of their names."""
    base = folder / driver_name(driver).replace("/", "_")
    compiled = call(["gcc", "-std=c11", "-c", "-I.", "-Iinclude", driver, "-o", f"{base}.o"])
    if compiled.returncode != 0:
        raise ToolError(f"{driver}: does not compile:\n{compiled.stderr}")
    linked = call(["ld", "-r", "--print-map", f"{base}.o", "--start-group", *libraries, "--end-group", "-o", "/dev/null"])
    names = sorted(set(re.findall(r"^\S+\.a\(([\w.-]+)\.o\)", linked.stdout, re.M)))
    return [source_of(name) for name in names]


def source_of(name):
    found = [path for room in ("src", "hal") for path in ROOT.glob(f"{room}/**/{name}.c")]
    if len(found) != 1:
        raise ToolError(f"{name}.c: {len(found)} sources of that name")
    source = found[0].relative_to(ROOT)
    instead = Path(INSTEAD) / source
    return str(instead if (ROOT / instead).exists() else source)


def digest(sources, options):
    """Of all that is read, by content."""
    listed = call(["gcc", "-MM", *INCLUDES, *sources])
    if listed.returncode != 0:
        raise ToolError(f"{sources[0]}: {listed.stderr.strip()}")
    files = sorted({word for word in listed.stdout.replace("\\\n", " ").split() if not word.endswith(":")})
    content = hashlib.sha256("\n".join([*INCLUDES, *options, *sources, version()]).encode())
    for file in files:
        content.update((ROOT / file).read_bytes())
    return content.hexdigest()


def version():
    return call(["frama-c", "-version"]).stdout.strip()


def analyse(driver, options):
    folder = options.folder
    relative = str(driver.relative_to(ROOT))
    sources = [relative, *members(driver, options.libraries, folder)]
    eva = [*EVA, *(word for line in OPTIONS.findall(read_text(driver)) for word in line.split())]
    kept = folder / f"{driver_name(driver).replace('/', '_')}.json"
    key = digest(sources, eva)
    if kept.exists():
        result = json.loads(kept.read_text())
        if result.pop("key") == key:
            return Result(**result)
    result = interpret(driver_name(driver), sources, eva, kept, options.limit)
    write_whole(kept, json.dumps(asdict(result) | {"key": key}, indent=1) + "\n")
    return result


def interpret(name, sources, options, kept, limit):
    report, log = kept.with_suffix(".csv"), kept.with_suffix(".log")
    report.unlink(missing_ok=True)
    command = ["frama-c", *options, f"-cpp-extra-args={' '.join(INCLUDES)}", *sources, "-then", "-report-csv",
               str(report)]
    before = os.times()
    try:
        ran = call(["prlimit", f"--cpu={limit}", *command])
    except OSError as error:
        raise ToolError(f"frama-c: {error.strerror}; `tools/setup.sh prove` installs it") from None
    after = os.times()
    seconds = round(after.children_user - before.children_user, 1)
    write_whole(log, ran.stdout + ran.stderr)
    reached, functions = REACHED.search(ran.stdout), COUNTED.search(ran.stdout)
    if ran.returncode != 0 or reached is None:
        too_long = ran.returncode in (-signal.SIGXCPU, -signal.SIGKILL)
        trouble = f"took more than {limit} s" if too_long else f"frama-c failed; see {log}"
        return Result(name, 0, 0, 0, [], seconds, trouble, [])
    trouble, names = trouble_of(ran.stdout), sorted({"main", *ANALYSED.findall(ran.stdout)})
    return Result(name, int(functions[1]), int(reached[1]), int(reached[2]), read_alarms(report, set(names)), seconds,
                  trouble, names)


def trouble_of(log):
    unknown = UNKNOWN.search(log)
    if unknown:
        return f"no source of {unknown[1]}"
    return "" if END in log.partition("ANALYSIS SUMMARY")[0] else "its end is not reached"


def read_alarms(report, analysed):
    """Of the functions that were analysed: nothing is known of others."""
    with open(report, encoding="utf-8") as file:
        rows = list(csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE))
    return sorted([f"{row['directory']}/{row['file']}", int(row["line"]), COPY.sub("", row["function"]),
                   COPY.sub("", row["property kind"]), RENAMED.sub(r"\1", row["property"])]
                  for row in rows if row["function"] in analysed and is_alarm(row))


def is_alarm(row):
    return (row["status"] not in PROVED and row["property kind"] not in ASSUMED
            and not row["directory"].startswith(("FRAMAC_SHARE", INSTEAD)))


# ---- The reviewed list -----------------------------------------------------------------------------------------------

KEYS = {"file", "function", "kind", "count"}


@dataclass
class Listed:
    count: int
    explained: bool


def read_listed(path):
    """{(file, function, kind): Listed}."""
    listed = {}
    for entry in yaml.safe_load(read_text(path)) or []:
        if not isinstance(entry, dict) or entry.keys() not in (KEYS | {"reason"}, KEYS | {"open"}):
            raise ToolError(f"{path}: each entry must have {', '.join(sorted(KEYS))}, and either reason or open: "
                            f"{entry}")
        key = (entry["file"], entry["function"], entry["kind"])
        if key in listed:
            raise ToolError(f"{path}: {' '.join(key)}: listed twice")
        listed[key] = Listed(entry["count"], "reason" in entry)
    return listed


def distinct_alarms(results):
    """One that several drivers raise is one."""
    return sorted({tuple(alarm) for result in results for alarm in result.alarms})


def counted(alarms):
    return Counter((file, function, kind) for file, _, function, kind, _ in alarms)


def judge(found, listed, is_whole):
    """Sentences of what is wrong: of the alarms, and where every driver ran of the list too."""
    for key, count in sorted(found.items()):
        allowed = listed[key].count if key in listed else 0
        if count > allowed:
            yield f"{' '.join(key)}: {count} alarms, {allowed} listed"
    for key, entry in sorted(listed.items()):
        if is_whole and found[key] < entry.count:
            yield f"{ALARMS.name}: {' '.join(key)}: {found[key]} alarms are left of {entry.count}: lower the count"


def explained(found, listed):
    return sum(count for key, count in found.items() if key in listed and listed[key].explained)


def show(results):
    rows = [(r.driver, str(r.functions), str(r.reached), f"{100 * r.reached / max(r.statements, 1):.1f} %",
             str(len(r.alarms)), f"{r.seconds:.1f}", r.trouble) for r in results]
    print_aligned([("driver", "functions", "statements", "reached", "alarms", "s", ""), *rows])


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("libraries", metavar="LIBRARY", nargs="+", help="of this machine, for what a driver stands on")
    parser.add_argument("--folder", metavar="DIR", type=Path, required=True, help="for what was proved")
    parser.add_argument("--room", default="", help="of the drivers, or room/driver (default: all)")
    parser.add_argument("--jobs", type=whole_number(1, 256), default=1)
    parser.add_argument("--limit", metavar="S", type=whole_number(1, 100000), default=600, help="for a driver")
    parser.add_argument("--list", metavar="FILE", type=Path, default=ALARMS,
                        help="alarms that were reviewed (default: tests/proof/alarms.yaml)")
    parser.add_argument("--record", action="store_true", help="write tests/proof/functions.yaml, when all drivers ran")
    parser.add_argument("--alarms", action="store_true", help="print all, also those that are listed")
    return parser.parse_args()


def chosen(room):
    drivers = sorted(DRIVERS.glob("*/prove_*.c"))
    of_room = [driver for driver in drivers if room in ("", driver.parent.name, driver_name(driver))]
    if not of_room:
        raise ToolError(f"{room}: no drivers; rooms are {', '.join(sorted({d.parent.name for d in drivers}))}")
    return of_room, len(of_room) == len(drivers)


def main():
    options = arguments()
    listed = read_listed(options.list)
    drivers, is_whole = chosen(options.room)
    options.folder.mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(options.jobs) as pool:
        results = list(pool.map(lambda driver: analyse(driver, options), drivers))
    show(results)
    alarms = distinct_alarms(results)
    found = counted(alarms)
    wrong = [*judge(found, listed, is_whole), *(f"{r.driver}: {r.trouble}" for r in results if r.trouble)]
    public = public_functions(options.libraries)
    reached = {COPY.sub("", name) for result in results for name in result.names}
    if is_whole and options.record:
        write_functions(public, reached, FUNCTIONS)
    wrong += problems(public, reached, FUNCTIONS) if is_whole else []
    named = {line.partition(":")[0] for line in wrong}
    for file, line, function, kind, what in alarms:
        if options.alarms or f"{file} {function} {kind}" in named:
            print(f"{file}:{line}: {function}: {kind}: {what}")
    for line in wrong:
        print(f"prove: {line}", file=sys.stderr)
    why = explained(found, listed)
    print(f"{len(public.keys() & reached)} of {len(public)} public functions reached")
    print(f"{len(results)} drivers, {len(alarms)} alarms: {why} explained, {len(alarms) - why} open")
    return EXIT_MISSED if wrong else 0


if __name__ == "__main__":
    run(main)
