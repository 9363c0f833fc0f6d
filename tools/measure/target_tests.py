#!/usr/bin/env python3
"""Sum up the unit tests that ran on the emulated cores.

Arguments: their logs, of which the folder names the variant. Prints passed, failed and the seconds of each variant and
writes figures for tools/measure/figures.py. Exit status 1: a test failed; 2: bad input, nothing was written.
"""
import json
from pathlib import Path

from tools.common import ArgumentParser, ToolError, print_aligned, real_number, run, shown_path, write_whole
from tools.design import robot_json
from tools.measure import core_numbers, test_summary

TIME_BAR = 300  # s
COMMAND = "make test-targets"


def sum_by_variant(logs):
    sums = {}
    for log in logs:
        outcome = test_summary.read_unity(log)
        row = sums.setdefault(log.parent.name, test_summary.Outcome())
        row.passed += outcome.passed
        row.seconds += outcome.seconds
        row.failures += outcome.failures
    return sums


def figure(name, value, unit, bound):
    return {"name": name, "value": value, "unit": unit, "bound": bound, "command": COMMAND}


def figures(sums, seconds):
    cores = len({core_numbers.core_of(variant) for variant in sums})
    what = f"unit tests on {cores} emulated cores"
    return [figure(f"{what}: passed", sum(row.passed for row in sums.values()), "", None),
            figure(f"{what}: failed", sum(len(row.failures) for row in sums.values()), "", {"op": "==", "value": 0}),
            figure(f"{what}: time of the whole run", round(seconds, 1), "s", {"op": "<=", "value": TIME_BAR})]


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("logs", metavar="LOG", type=Path, nargs="+")
    parser.add_argument("--seconds", metavar="S", type=real_number(0, 1e6), required=True,
                        help="that all of them took, side by side")
    parser.add_argument("--bench", metavar="FILE", type=Path, default=robot_json.build_directory() / "bench/targets.json",
                        help="where the figures go (default: build/bench/targets.json)")
    options = parser.parse_args()
    if not options.seconds >= 0:
        raise ToolError(f"--seconds {options.seconds}: must be 0 or more")
    return options


def main():
    options = arguments()
    sums = sum_by_variant(options.logs)
    print_aligned([("variant", "passed", "failed", "seconds"),
                   *((variant, str(row.passed), str(len(row.failures)), f"{row.seconds:.1f}")
                     for variant, row in sums.items())])
    for row in sums.values():
        for failure in row.failures:
            print(failure)
    write_whole(options.bench, json.dumps(figures(sums, options.seconds), indent=2) + "\n")
    failed = sum(len(row.failures) for row in sums.values())
    print(f"{sum(row.passed for row in sums.values())} passed, {failed} failed, {options.seconds:.0f} s")
    print(f"wrote {shown_path(options.bench)}")
    return 1 if failed else 0


if __name__ == "__main__":
    run(main)
