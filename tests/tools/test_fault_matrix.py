"""tools/measure/fault_matrix.py: the page of faults is what the tests say; empty cells and tests that are none are errors."""
import json

import pytest
import yaml
from conftest import ROOT, assert_one_line_error, run_tool

from tools.common import build_directory
from tools.measure import fault_matrix

PROGRAMS = sorted(build_directory() / "host-gcc" / path.stem for path in (ROOT / "tests/fault").glob("fault_matrix_*.c"))


@pytest.fixture(name="matrix")
def fixture_matrix(tmp_path, monkeypatch):
    """One robot with two states and one fault."""
    monkeypatch.setattr(fault_matrix, "STATES", {"robot": ["off", "on"]})
    monkeypatch.setattr(fault_matrix, "TRANSPORTS", ("wire",))
    monkeypatch.setattr(fault_matrix, "FAULTS", tmp_path / "faults.h")
    (tmp_path / "faults.h").write_text("    JP_FAULT_HEAT = 1 << 0,\n", encoding="utf-8")

    def matrix(cells, listed=(), *arguments):
        program = tmp_path / "fault_matrix_robot"
        lines = "".join(f"{json.dumps(cell)}\n" for cell in cells)
        program.write_text(f"#!/bin/sh\ncat >>\"$FAULT_CELLS\" <<'END'\n{lines}END\n", encoding="utf-8")
        program.chmod(0o755)
        (tmp_path / "cells.yaml").write_text(yaml.safe_dump(list(listed)), encoding="utf-8")
        return run_tool("measure.fault_matrix", "--cells", tmp_path / "cells.yaml", "--page", tmp_path / "FAULTS.md",
                        *arguments, program)
    matrix.page = tmp_path / "FAULTS.md"
    return matrix


def cell(fault, state, seen, ticks=0):
    return {"robot": "robot", "transport": "wire", "fault": fault, "state": state, "expected": seen, "seen": seen,
            "ticks": ticks}


WHOLE = [cell("HEAT", "off", "off"), cell("HEAT", "on", "fault: HEAT and SMOKE", 3)]


def test_a_line_of_the_page(matrix):
    assert matrix(WHOLE).returncode == 0
    assert ("| HEAT | wire | off | HEAT, SMOKE, 3 ticks | [fault_matrix_robot.c](fault/fault_matrix_robot.c) |"
            in matrix.page.read_text(encoding="utf-8"))
    assert matrix(WHOLE, (), "--check").returncode == 0
    stale = matrix([WHOLE[0], cell("HEAT", "on", "fault: HEAT", 4)], (), "--check")
    assert stale.returncode == 1 and "make faults" in stale.stderr


def test_empty_cells_are_errors(matrix):
    result = matrix(WHOLE[:1])
    assert result.returncode == 1 and result.stderr == "FAULTS.md: error: empty: robot, wire, HEAT, on\n"
    assert "| off | empty |" in matrix.page.read_text(encoding="utf-8")
    result = matrix([])
    assert result.returncode == 1 and result.stderr == "FAULTS.md: error: empty: robot, wire, HEAT\n"


def test_a_cause_of_a_fault_is_the_fault(matrix):
    assert matrix([cell("HEAT: of the motor", "off", "off"), cell("HEAT: of the motor", "on", "on")]).returncode == 0


def listed(**keys):
    return {"robot": "robot", "transport": "wire", "fault": "HEAT", **keys}


def test_what_is_listed_fills_cells(matrix):
    assert matrix([], [listed(impossible="it is cold")]).returncode == 0
    assert "- wire: HEAT: it is cold." in matrix.page.read_text(encoding="utf-8")
    name = "tests/fault/fault_lcm.c::test_junk_is_dropped"
    assert matrix([], [listed(test=name, seen="dropped")]).returncode == 0
    assert "| dropped | dropped | [test_junk_is_dropped](fault/fault_lcm.c) |" in matrix.page.read_text(encoding="utf-8")


@pytest.mark.parametrize("entry, reason", [
    (listed(test="tests/fault/fault_lcm.c::test_none", seen="x"), "there is no test"),
    (listed(test="tests/fault/none.c::test_junk_is_dropped", seen="x"), "there is no test"),
    (listed(), "must have"), ({"robot": "robot"}, "must have")])
def test_entries_that_name_nothing_are_errors(matrix, entry, reason):
    assert_one_line_error(matrix([], [entry]), reason)


def test_two_cells_in_one_place_are_an_error(matrix):
    assert_one_line_error(matrix(WHOLE + WHOLE[:1]), "two cells")


def test_the_page_is_what_the_tests_say():
    assert len(PROGRAMS) >= 2
    result = run_tool("measure.fault_matrix", "--check", *PROGRAMS)
    assert result.returncode == 0, result.stderr
    assert result.stderr == ""
