"""Counts the results of `make test`.

Arguments: the name of a suite, then its logs, then the next suite. A log is the output of a Unity program or of a gate
as tools/measure/run_test.sh kept it (.log), or the JUnit file of pytest beside such a log (.xml).

A log that is missing, a program that crashed or ran too long, a test that was skipped and a suite that ran nothing are
failures. The last line is `N passed, N failed`; the exit status is 0 if nothing failed.
"""

import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

import junitparser

RESULT = re.compile(r"^(?P<place>\S[^:]*:\d+):(?P<test>\w+):(?P<result>PASS|FAIL|IGNORE)(?::\s*(?P<why>.*))?$")
COUNTS = re.compile(r"^(\d+) Tests (\d+) Failures (\d+) Ignored\s*$", re.MULTILINE)
RUN = re.compile(r"^run: exit (\d+), ([\d.]+) s$", re.MULTILINE)
TIMEOUTS = (124, 137, 152)
TAIL_LINES = 15


@dataclass
class Outcome:
    """What one log says."""

    passed: int = 0
    seconds: float = 0.0
    failures: list[str] = field(default_factory=list)


def tail(text: str) -> str:
    """The end of a log, indented, or of the report of a sanitizer in it."""
    lines = [line for line in text.splitlines() if line.strip()]
    report = next((i for i, line in enumerate(lines) if "ERROR: " in line or "runtime error" in line), None)
    chosen = lines[-TAIL_LINES:] if report is None else lines[report : report + TAIL_LINES]
    return "".join(f"\n    {line}" for line in chosen)


def read_run(log: Path, outcome: Outcome) -> int | None:
    """Exit status of the run that wrote the log; None, and a failure, if there is none."""
    if not log.is_file():
        outcome.failures.append(f"{log}: did not run: its build failed or its suite has no files")
        return None
    run = RUN.search(log.read_text(errors="replace"))
    if run is None:
        outcome.failures.append(f"{log}: the run was broken off")
        return None
    outcome.seconds = float(run[2])
    return int(run[1])


def read_unity(log: Path) -> Outcome:
    """Results of one program or gate."""
    outcome = Outcome()
    status = read_run(log, outcome)
    if status is None:
        return outcome
    text = log.read_text(errors="replace")
    ignored = 0
    for match in filter(None, map(RESULT.match, text.splitlines())):
        if match["result"] == "PASS":
            outcome.passed += 1
            continue
        ignored += match["result"] == "IGNORE"
        why = "ignored" if match["result"] == "IGNORE" else "failed"
        outcome.failures.append(f"{match['place']}: {match['test']} {why} in {log}: {match['why'] or ''}")
    reported = len(outcome.failures)
    counts = COUNTS.search(text)
    if status in TIMEOUTS:
        outcome.failures.append(f"{log}: ran too long ({outcome.seconds:.0f} s){tail(text)}")
    elif counts is None:
        outcome.failures.append(f"{log}: crashed with exit status {status}{tail(text)}")
    elif int(counts[1]) == 0:
        outcome.failures.append(f"{log}: nothing ran{tail(text)}")
    elif (int(counts[1]), int(counts[2]) + int(counts[3])) != (outcome.passed + reported, reported):
        outcome.failures.append(f"{log}: its summary does not match its results{tail(text)}")
    elif (status != 0) != (reported > ignored):
        outcome.failures.append(f"{log}: exit status {status} after {reported} failures{tail(text)}")
    return outcome


def read_pytest(report: Path) -> Outcome:
    """Results of one run of pytest."""
    outcome = Outcome()
    log = report.with_suffix(".log")
    status = read_run(log, outcome)
    if status is None:
        return outcome
    text = log.read_text(errors="replace")
    if status in TIMEOUTS or not report.is_file():
        why = "ran too long" if status in TIMEOUTS else f"pytest ended with exit status {status}"
        outcome.failures.append(f"{log}: {why}{tail(text)}")
        return outcome
    for suite in junitparser.JUnitXml.fromfile(str(report)):
        for case in suite:
            if case.is_passed:
                outcome.passed += 1
                continue
            why = "; ".join(f"{type(r).__name__.lower()}: {r.message}" for r in case.result)
            outcome.failures.append(f"{pytest_place(case)}: {case.name} {why}")
    if status != 0 and not outcome.failures:
        outcome.failures.append(f"{log}: pytest ended with exit status {status}{tail(text)}")
    elif status == 0 and outcome.passed + len(outcome.failures) == 0:
        outcome.failures.append(f"{log}: nothing ran")
    return outcome


def pytest_place(case: junitparser.TestCase) -> str:
    """file:line of a test that did not pass: the last place its traceback names."""
    for result in case.result:
        places = re.findall(r"^(\S+\.py:\d+): ", result.text or "", re.MULTILINE)
        if places:
            return places[-1]
    return (case.classname or "?").replace(".", "/") + ".py"


def parse_arguments(arguments: list[str]) -> list[tuple[str, Path]]:
    """(suite, log) of each expected log."""
    expected = []
    suite = ""
    for argument in arguments:
        if argument.endswith((".log", ".xml")):
            expected.append((suite, Path(argument)))
        else:
            suite = argument
    return expected


def print_table(rows: dict[tuple[str, str], Outcome]) -> None:
    """One line for each suite and variant."""
    print(f"\n{'suite':<10}{'variant':<18}{'passed':>8}{'failed':>8}{'time':>10}")
    for (suite, variant), outcome in rows.items():
        print(
            f"{suite:<10}{variant:<18}{outcome.passed:>8}{len(outcome.failures):>8}{outcome.seconds:>8.1f} s"
        )


def main() -> int:
    rows: dict[tuple[str, str], Outcome] = {}
    for suite, log in parse_arguments(sys.argv[1:]):
        outcome = read_pytest(log) if log.suffix == ".xml" else read_unity(log)
        row = rows.setdefault((suite, log.parent.name), Outcome())
        row.passed += outcome.passed
        row.seconds += outcome.seconds
        row.failures += outcome.failures
    failures = [failure for row in rows.values() for failure in row.failures]
    passed = sum(row.passed for row in rows.values())
    if not rows:
        failures.append("no test was expected")
    print_table(rows)
    print()
    for failure in failures:
        print(failure)
    print(f"{passed} passed, {len(failures)} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
