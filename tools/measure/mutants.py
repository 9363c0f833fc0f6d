#!/usr/bin/env python3
"""Mutation testing: do the tests notice small faults in the code?

Each mutant (tools/measure/mutations.py) of the chosen rooms is compiled alone and loaded in the place of the library's
functions; the tests that execute its lines run, the quickest and the likeliest to notice first, until one fails, crashes,
or takes ten times as long as without. Tests that compare bits with known ones come last, and what they alone notice is
counted apart. A test that includes the mutated file is built with it. What no test notices is tried with the sanitizer of
undefined behaviour, and compiled with optimisation: the same machine code is the same program. Other mutants that change
nothing anybody could notice are listed with their reasons in tests/proof/mutants.yaml.

What is known stays in FOLDER: a mutant is judged again when its file or a header, the library, or the tests that judged
it have changed. With --sample a part of the mutants, drawn at random from a seed that is printed. Exit status 1: a mutant
survives that is not listed, or an entry of the list is not needed.
"""
import concurrent.futures
import hashlib
import json
import os
import random
import resource
import shlex
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from tools.common import EXIT_MISSED, ROOT, ArgumentParser, ToolError, print_aligned, run, whole_number, write_whole
from tools.measure import mutations
from tools.measure.proof_rooms import chosen_rooms, critical_rooms
from tools.measure.reviewed import Reviewed

REVIEWED = ROOT / "tests/proof/mutants.yaml"
KEYS = ("file", "function", "code", "becomes")
# Undefined behaviour that happens to do no harm here.
SANITIZED = ("-fsanitize=undefined", "-fno-sanitize-recover=all")
KILLED, SURVIVED, SAME, STILLBORN = "killed", "survived", "same code", "does not compile"
SLOWER, SLACK_S, LIMIT_S = 10, 2, 300
SAVE_EVERY = 100


def digest(*parts):
    total = hashlib.sha256()
    for part in parts:
        total.update(part if isinstance(part, bytes) else str(part).encode())
        total.update(b"\0")
    return total.hexdigest()


def file_digest(path):
    return digest(Path(path).read_bytes())


# ---- The tests and what they execute ---------------------------------------------------------------------------------

@dataclass
class Test:
    """A program, and the same one counting what it executes."""

    program: Path
    counting: Path
    digest: str
    is_hash: bool = False
    seconds: float = 0

    def name(self):
        return self.program.name


def passes(program, seconds, preload=None):
    environment = {"PATH": os.environ["PATH"], **({"LD_PRELOAD": str(preload)} if preload else {})}
    try:
        return subprocess.run([program], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL,
                              env=environment, timeout=seconds, check=False).returncode == 0
    except subprocess.TimeoutExpired:
        return False


def count_files(test, units, objects, folder):
    """Runs a test, and gives what gcov needs of those sources."""
    subprocess.run([test.counting], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=LIMIT_S,
                   env={"GCOV_PREFIX": str(folder), "PATH": os.environ["PATH"]}, check=False)
    for file in units:
        count = folder / objects.relative_to("/") / Path(file).with_suffix(".gcda")
        if count.exists():
            shutil.copy(objects / Path(file).with_suffix(".gcno"), count.with_suffix(".gcno"))
            yield count


def executed_lines(test, files, units, objects):
    """{file: lines} of a run, by gcov."""
    lines = {file: set() for file in files}
    with tempfile.TemporaryDirectory() as name:
        counts = list(count_files(test, units, objects, Path(name)))
        output = subprocess.run(["gcov", "--json-format", "--stdout", *counts], capture_output=True, text=True, cwd=name,
                                check=True).stdout if counts else ""
    for text in output.splitlines():
        for entry in json.loads(text)["files"]:
            if entry["file"] in lines:
                lines[entry["file"]].update(line["line_number"] for line in entry["lines"] if line["count"])
    return lines


class Executed:
    """Which tests execute which lines; what was measured of a test stays known while the test is the same."""

    def __init__(self, tests, units, objects, folder):
        """Of `units`, each file with the sources that its code is compiled in."""
        self.tests = {test.name(): test for test in tests}
        self.units = units
        path = folder / "lines.json"
        known = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
        for number, test in enumerate(tests, 1):
            self.complete(known, test, units, objects, f"{number} of {len(tests)}")
        self.lines = {name: {file: set(of) for file, of in known[name]["lines"].items()} for name in self.tests}
        write_whole(path, json.dumps(known))

    @staticmethod
    def complete(known, test, units, objects, progress):
        key = file_digest(test.counting)
        if known.get(test.name(), {}).get("key") != key:
            known[test.name()] = {"key": key, "lines": {}}
        files = {*units, *(source for of in units.values() for source in of)}
        missing = sorted(files - set(known[test.name()]["lines"]))
        if missing:
            show(f"lines that tests execute: {progress}, {test.name()}")
            sources = sorted({source for file in missing for source in units.get(file, [file])})
            known[test.name()]["lines"] |= {
                file: sorted(of) for file, of in executed_lines(test, missing, sources, objects).items()}

    def by(self, mutant):
        """Tests that execute a mutant's lines; of lines that are not executed, its function; of none, what it is in."""
        for lines in (mutant.lines, mutant.scope or ()):
            found = [self.tests[name] for name, of in self.lines.items() if not of[mutant.file].isdisjoint(lines)]
            if found:
                return found
        within = () if mutant.scope else (mutant.file, *self.units[mutant.file])
        return [self.tests[name] for name, of in self.lines.items() if any(of[file] for file in within)]


def show(text):
    if sys.stderr.isatty():
        print(text, file=sys.stderr)


# ---- One mutant ------------------------------------------------------------------------------------------------------

class Judge:
    """Compiles mutants and lets tests judge them."""

    def __init__(self, options, executed, units):
        self.flags = shlex.split(options.flags)
        self.build = options.build
        self.executed = executed
        self.units = units
        self.killers = {}
        self.lock = threading.Lock()
        self.library = file_digest(options.build / "libcore.so")
        self.including = including_tests(options.build, executed.tests)

    def compiler(self, overlay, *arguments):
        command = ["gcc", f"-I{overlay}", *self.flags, "-w", "-fuse-ld=gold", *map(str, arguments)]
        return subprocess.run(command, capture_output=True, check=False, cwd=ROOT).returncode == 0

    def loaded(self, overlay, file, *flags):
        """A library of the mutated file, or None."""
        library = overlay / "mutant.so"
        sources = [overlay / file if unit == file else ROOT / unit for unit in self.units[file]]
        built = self.compiler(overlay, "-O0", "-fPIC", "-shared", *flags, *sources, "-lm", "-o", library)
        return library if built else None

    def check_unchanged(self, file, tests):
        """A file that is loaded before the library must change nothing, or all of its mutants would seem killed."""
        with tempfile.TemporaryDirectory(prefix="mutant") as name:
            overlay = Path(name)
            target = overlay / file
            target.parent.mkdir(parents=True)
            target.write_bytes((ROOT / file).read_bytes())
            library = self.loaded(overlay, file)
            failed = library and self.killed_by(tests, library)
        if failed:
            raise ToolError(f"{failed.name()}: fails with {file} as it is loaded before the library; build anew, or see "
                            "what it is linked with")

    def judge(self, mutant, source, known):
        """(verdict, killer or digests of the tests that did not notice)."""
        if self.is_known(mutant, known):
            return known
        tests = self.tests_for(mutant)
        with tempfile.TemporaryDirectory(prefix="mutant") as name:
            overlay = Path(name)
            target = overlay / mutant.file
            target.parent.mkdir(parents=True)
            target.write_bytes(mutant.applied(source))
            library = self.loaded(overlay, mutant.file)
            if library is None:
                return {"verdict": STILLBORN}
            killer = (self.killed_by(tests, library) or self.killed_inside(mutant, overlay) or
                      self.killed_by(tests, self.loaded(overlay, mutant.file, *SANITIZED)))
            if killer:
                self.remember(mutant, killer)
                return {"verdict": KILLED, "by": killer.name(), "digest": killer.digest, "is_hash": killer.is_hash}
            same = self.same_code(mutant.file, overlay)
        return {"verdict": SAME if same else SURVIVED, "tests": {test.name(): test.digest for test in tests}}

    def is_known(self, mutant, known):
        return bool(known) and self.still_holds(known, self.tests_for(mutant))

    def still_holds(self, known, tests):
        if known["verdict"] == KILLED:
            killer = self.executed.tests.get(known["by"])
            return killer is not None and killer.digest == known["digest"]
        return known["verdict"] in (STILLBORN, SAME) or known["tests"] == {test.name(): test.digest for test in tests}

    def tests_for(self, mutant):
        tests = self.executed.by(mutant)
        with self.lock:
            killers = self.killers.get((mutant.file, mutant.function), Counter())
            return sorted(tests, key=lambda test: (test.is_hash, -killers[test.name()], test.seconds))

    def remember(self, mutant, killer):
        with self.lock:
            self.killers.setdefault((mutant.file, mutant.function), Counter())[killer.name()] += 1

    @staticmethod
    def killed_by(tests, library):
        return next((test for test in tests
                     if not passes(test.program, SLOWER * test.seconds + SLACK_S, library)), None)

    def killed_inside(self, mutant, overlay):
        """By a test that has the mutated file in itself."""
        for test in self.including.get(mutant.file, ()):
            program = overlay / test.name()
            source = self.build.parent / "runners" / test_source(self.build, test)
            built = self.compiler(overlay, "-O0", source, *(self.build / name for name in ("libdrivers.a", "libcore.so")),
                                  f"-Wl,-rpath,{self.build}", "-lm", "-o", program)
            if built and not passes(program, SLOWER * test.seconds + SLACK_S):
                return test
        return None

    def same_code(self, file, overlay):
        """Whether an optimising compiler makes the same of the mutant and of the source."""
        codes = []
        for root in (ROOT, overlay):
            codes.append([])
            for unit in self.units[file]:
                target = overlay / "code.o"
                path = root / unit if unit == file else ROOT / unit
                if not self.compiler(overlay if root == overlay else ROOT, "-O2", "-c", path, "-o", target):
                    return False
                stripped = overlay / "code.bin"
                subprocess.run(["objcopy", "-R", ".comment", "--strip-all", target, stripped], check=True)
                codes[-1].append(stripped.read_bytes())
        return codes[0] == codes[1]


def dependencies(build):
    """{object: sources it is made of}, of all in a build."""
    found = {}
    for path in build.rglob("*.d"):
        text = path.read_text(encoding="utf-8").replace("\\\n", " ").split("\n", maxsplit=1)[0]
        found[path.with_suffix(".o")] = text.partition(":")[2].split()
    return found


def units_of(build, files):
    """Of each file the sources that its code is compiled in."""
    made_of = dependencies(build).values()
    return {file: [file] if file.endswith(".c") else
            sorted({of[0] for of in made_of if file in of and of[0].startswith(("src/", "hal/"))}) for file in files}


def including_tests(build, tests):
    found = {}
    for path, of in dependencies(build).items():
        if path.stem in tests:
            for file in of:
                if file.startswith(("src/", "hal/")):
                    found.setdefault(file, []).append(tests[path.stem])
    return found


def test_source(build, test):
    return next(path.relative_to(build).with_suffix(".c") for path in build.rglob(f"{test.name()}.o"))


# ---- All of them -----------------------------------------------------------------------------------------------------

class Store:
    """Verdicts by what they depend on."""

    def __init__(self, folder):
        self.path = folder / "verdicts.json"
        self.known = json.loads(self.path.read_text(encoding="utf-8")) if self.path.exists() else {}

    def save(self):
        write_whole(self.path, json.dumps(self.known))


def tests_of(judge, file, chosen):
    """That judge any mutant of a file."""
    found = {test.name(): test for mutant in chosen if mutant.file == file for test in judge.tests_for(mutant)}
    return list(found.values())


def judged(judge, chosen, store, jobs):
    """[(mutant, verdict)] in order."""
    headers = digest(*(path.read_bytes() for top in ("include", "src", "hal") for path in sorted((ROOT / top).rglob("*.h"))))
    sources = {file: (ROOT / file).read_bytes() for file in {mutant.file for mutant in chosen}}

    def key_of(mutant):
        return digest(mutant.file, mutant.applied(sources[mutant.file]), headers, judge.library)

    def one(mutant):
        key = key_of(mutant)
        return key, judge.judge(mutant, sources[mutant.file], store.known.get(key))

    unknown = [mutant for mutant in chosen if not judge.is_known(mutant, store.known.get(key_of(mutant)))]
    for file in sorted({mutant.file for mutant in unknown}):
        judge.check_unchanged(file, tests_of(judge, file, unknown))
    console = Console(stderr=True)
    bar = Progress(TextColumn("mutants"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn(), console=console,
                   disable=not console.is_terminal, transient=True)
    results = []
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool, bar:
        for mutant, (key, verdict) in bar.track(zip(chosen, pool.map(one, chosen)), len(chosen)):
            store.known[key] = verdict
            results.append((mutant, verdict))
            if len(results) % SAVE_EVERY == 0:
                store.save()
    store.save()
    return results


@dataclass
class Count:
    """Of a file or a room."""

    mutants: int = 0
    killed: int = 0
    by_hash: int = 0
    equivalent: int = 0
    survived: int = 0

    def add(self, known, is_listed):
        verdict = known["verdict"]
        if verdict == STILLBORN:
            return
        self.mutants += 1
        self.killed += verdict == KILLED
        self.by_hash += verdict == KILLED and known.get("is_hash", False)
        self.equivalent += verdict == SAME or is_listed
        self.survived += verdict == SURVIVED and not is_listed

    def plus(self, other):
        return Count(*(getattr(self, name) + getattr(other, name) for name in self.__dataclass_fields__))

    def percent(self):
        able = self.mutants - self.equivalent
        return 100 * self.killed / able if able else 100.0

    def row(self, name):
        return (name, str(self.mutants), str(self.killed), str(self.by_hash), str(self.equivalent), str(self.survived),
                f"{self.percent():.2f}")


def count(results, reviewed):
    """({file: Count}, problems)."""
    counts, problems = {}, []
    for mutant, verdict in results:
        survived = verdict["verdict"] == SURVIVED
        is_listed = survived and reviewed.explains(*mutant.name())
        counts.setdefault(mutant.file, Count()).add(verdict, is_listed)
        if survived and not is_listed:
            problems.append(f"{mutant.file}:{mutant.lines[0]}: error: {mutant.operator} in {mutant.function}, noticed by none of "
                            f"{len(verdict['tests'])} tests: {marked(mutant.code, mutant.becomes)}")
    return counts, problems


def marked(code, becomes):
    """The code, with what becomes of some of its words in brackets."""
    start = 1 + os.path.commonprefix([code, becomes]).rfind(" ")
    end = 1 + os.path.commonprefix([code[start:][::-1], becomes[start:][::-1]]).rfind(" ")
    return f"{code[:start]}[{code[start:len(code) - end]} => {becomes[start:len(becomes) - end]}]{code[len(code) - end:]}"


def total_of(files, counts):
    total = Count()
    for file in files:
        total = total.plus(counts.get(file, Count()))
    return total


def print_table(rooms, counts):
    rows = [("file", "mutants", "killed", "by bits", "equivalent", "survived", "%")]
    every = Count()
    for room, files in rooms.items():
        rows += [counts[file].row(file) for file in files if file in counts]
        total = total_of(files, counts)
        rows.append(total.row(f"{room}:"))
        every = every.plus(total)
    print_aligned([*rows, every.row("all:")])


# ---- The record ------------------------------------------------------------------------------------------------------

RECORD_HEAD = """# Mutants, room by room

Made by `make mutants RECORD=1`, which changes the rows of the rooms that it judges. `mutants`: all, or a sample that was
drawn at random. `judges`: all unit tests and those of equal bits, or the unit tests of one folder: then % is a lower
bound. `by bits`: of the killed, those that only tests of equal bits notice. %: killed of those that are not equivalent.
Bars: 100 % in the [rooms that can hurt someone](rooms.yaml), 95 % in the others.

| room | mutants | judges | judged | killed | by bits | equivalent | survived | % | bar |
|---|---|---|---|---|---|---|---|---|---|
"""
BAR, CRITICAL_BAR = 95, 100


def record(path, rooms, counts, chosen, judges):
    """Changes the rows of these rooms in a page; by which mutants, and which tests."""
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    rows = {line.split(" | ")[0]: line for line in text.splitlines() if line.startswith("| `")}
    critical = critical_rooms()
    for room, files in rooms.items():
        name, *numbers = total_of(files, counts).row(f"| `{room}`")
        bar = CRITICAL_BAR if room in critical else BAR
        rows[name] = " | ".join([name, chosen, judges, *numbers, f"{bar} |"])
    write_whole(path, RECORD_HEAD + "".join(f"{row}\n" for _, row in sorted(rows.items())))


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("tests", metavar="TEST", nargs="+", help="names of test programs")
    parser.add_argument("--hash", metavar="TEST", action="append", default=[],
                        help="one that compares bits with known ones; judges what the others do not notice")
    parser.add_argument("--room", metavar="NAME", action="append", help="instead of those that can hurt someone")
    parser.add_argument("--build", metavar="DIR", type=Path, required=True, help="tests that load the library")
    parser.add_argument("--counting", metavar="DIR", type=Path, required=True, help="tests that gcov counts")
    parser.add_argument("--flags", metavar="TEXT", required=True, help="that sources are compiled with")
    parser.add_argument("--headers", metavar="DIR", required=True, help="of the compiler")
    parser.add_argument("--folder", metavar="DIR", type=Path, required=True, help="for what is known")
    parser.add_argument("--reviewed", metavar="FILE", type=Path, default=REVIEWED)
    parser.add_argument("--sample", metavar="N", type=whole_number(1, 1000000), help="mutants of each room")
    parser.add_argument("--seed", metavar="N", type=whole_number(0, 2**32 - 1), default=1)
    parser.add_argument("--json", metavar="FILE", type=Path, help="the table, for programs")
    parser.add_argument("--record", metavar="FILE", type=Path, help="the page with a row for each room")
    parser.add_argument("--judges", metavar="NAME", default="all", help="what the tests are, for the page")
    parser.add_argument("--jobs", metavar="N", type=whole_number(1, 1024), default=1)
    return parser.parse_args()


def time_tests(executed):
    """How long those that are concerned take without a mutant, and that they pass."""
    for name, test in executed.tests.items():
        if not any(executed.lines[name].values()):
            continue
        start = time.monotonic()
        if not passes(test.program, LIMIT_S):
            raise ToolError(f"{test.program}: fails without a mutant")
        test.seconds = time.monotonic() - start


def chosen_mutants(rooms, options):
    flags = [*shlex.split(options.flags), "-isystem", options.headers]
    source = random.Random(options.seed)
    for files in rooms.values():
        mutants = [mutant for file in files for mutant in mutations.mutants_of(file, ROOT / file, flags)]
        if options.sample and options.sample < len(mutants):
            mutants = sorted(source.sample(mutants, options.sample), key=lambda mutant: (mutant.file, mutant.start))
        yield from mutants


def main():
    options = arguments()
    rooms = chosen_rooms(options.room)
    reviewed = Reviewed(options.reviewed, KEYS)
    options.folder.mkdir(parents=True, exist_ok=True)
    options.build = options.build.absolute()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # of mutants that crash
    tests = [Test(options.build / name, options.counting.absolute() / name, file_digest(options.build / name),
                  name in options.hash) for name in [*options.tests, *options.hash]]
    files = sorted({file for of_room in rooms.values() for file in of_room})
    units = units_of(options.build, files)
    executed = Executed(tests, units, options.counting.absolute(), options.folder)
    time_tests(executed)
    chosen = list(chosen_mutants(rooms, options))
    results = judged(Judge(options, executed, units), chosen, Store(options.folder), options.jobs)
    counts, problems = count(results, reviewed)
    if options.sample:
        print(f"{options.sample} mutants of each room, drawn with seed {options.seed}")
    else:
        problems += reviewed.unneeded(set(files))
    print_table(rooms, counts)
    for problem in problems:
        print(problem, file=sys.stderr)
    if options.json:
        write_whole(options.json, json.dumps({"seed": options.seed if options.sample else None, "files": {
            file: {**of.__dict__, "percent": of.percent()} for file, of in counts.items()}}, indent=1) + "\n")
    if options.record:
        sample = f"{options.sample}, seed {options.seed}" if options.sample else "all"
        record(options.record, rooms, counts, sample, options.judges)
    return EXIT_MISSED if problems else 0


if __name__ == "__main__":
    run(main)
