"""hal/skeleton: a port of which any part is still missing leaves the motors off; with all of them it balances."""
import itertools
import json

import pytest
from conftest import PROGRAMS, ROOT, WARNINGS, command, core_sources
from once import once

WRAPPED = ["main", "board_start", "board_start_ticks", "board_read", "board_write", "board_is_switched_on",
           "board_wait", "board_feed_watchdog"]
ALL = "strwo"

# As hal/README.md says of a HAL that cannot write.
WRITE_FAULT_TICKS = 4

# Of a run of the bench.
TICKS = 3000


def make_bench(folder):
    sources = [PROGRAMS / "skeleton_bench.c", *ROOT.glob("hal/skeleton/*.c"), ROOT / "hal" / "hal.c",
               *core_sources("courier24")]
    command("gcc", "-std=c11", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", *WARNINGS, "-I",
            ROOT / "include", "-I", ROOT, *(f"-Wl,--wrap={name}" for name in WRAPPED), *sources, "-o",
            folder / "bench")


@pytest.fixture(scope="session")
def bench(tmp_path_factory):
    return once(tmp_path_factory, "skeleton", make_bench) / "bench"


def subsets():
    for size in range(len(ALL)):
        for functions in itertools.combinations(ALL, size):
            yield "".join(functions)


def run(bench, functions):
    report = json.loads(command(bench, functions))
    return report["ticks_on"], report["end"], report["rate_hz"], report["fed"]


@pytest.mark.parametrize("functions", subsets(), ids=lambda functions: functions or "nothing")
def test_what_is_not_filled_in_keeps_the_motors_off(bench, functions):
    ticks_on, at_the_end, _, _ = run(bench, functions)
    assert at_the_end == "off"
    # Only a board whose write alone is missing is asked to switch on; its refusal ends that.
    assert 0 < ticks_on <= WRITE_FAULT_TICKS if functions == "stro" else ticks_on == 0


@pytest.mark.parametrize("functions", ["", "trwo", "srwo"])
def test_a_board_that_does_not_start_is_left_to_the_watchdog(bench, functions):
    assert run(bench, functions)[2:] == (0, 0)


def test_all_filled_in_waits_for_the_switch(bench):
    assert run(bench, "strw") == (0, "off", 1000, TICKS)


def test_all_filled_in_balances_when_switched_on(bench):
    ticks_on, *rest = run(bench, ALL)
    assert ticks_on > TICKS - 100 and rest == ["on", 1000, TICKS]


def test_without_ticks_the_watchdog_starves(bench):
    assert run(bench, ALL + "d")[3] == TICKS // 2
