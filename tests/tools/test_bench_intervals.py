"""tools/measure/bench_intervals.py: missions counted, and driven by the tables of a robot in the making."""
import shutil

import pytest
from conftest import assert_one_line_error, run_tool

from tools.common import ROOT, ToolError
from tools.measure import bench_intervals, random_robots


def trip(measured, inside=True, outcome="done"):
    return {"outcome": outcome, "predicted_j": 101.0, "std_j": 0.5, "measured_j": measured, "inside": inside,
            "prior_predicted_j": 110.0}


def test_a_mission_that_does_not_end_is_outside():
    found = [trip(100.0), trip(101.0), trip(101.0, inside=False), trip(0.0, outcome="fell")]
    assert bench_intervals.row("x", found) == ("x", "4", "50.0", "0.333", "0.497", "9.27")
    with pytest.raises(ToolError, match="x: no mission came to its end"):
        bench_intervals.row("x", found[3:])


def test_too_many_inside_miss_the_bar_as_well():
    figures = bench_intervals.figures_of([("x", "500", "98.0", "", "", ""), ("y", "500", "93.0", "", "", "")])
    assert [figure["value"] for figure in figures] == [3, 2]
    assert figures[0]["name"] == "500 missions of x that learned: share in the 95 % interval is off 95 % by"


def test_missions_are_driven_by_the_tables_that_were_made(tmp_path, monkeypatch):
    def copy(making):
        for path in (ROOT / "src" / "tables").glob("*courier24*.c"):
            shutil.copy(path, making.tables)

    monkeypatch.setattr(bench_intervals, "make_tables", copy)
    monkeypatch.setattr(bench_intervals, "AT_ONCE", 1)
    found = bench_intervals.drive_all([ROOT / "sim" / "robots" / "courier24.cfg"], tmp_path, 2, 1)["courier24"]
    assert [one["seed"] for one in found] == [bench_intervals.MISSION_SEED, bench_intervals.MISSION_SEED + 1]
    assert all(one["outcome"] == "done" for one in found)
    # What was driven is not driven again.
    monkeypatch.setattr(bench_intervals.robot_trials, "called", lambda command, what: pytest.fail(what))
    program = tmp_path / "courier24" / "jp-trip"
    again = bench_intervals.trips((program, ROOT / "sim" / "robots" / "courier24.cfg", 0, 1))
    assert again == ("courier24", found[:1])


def test_weak_robots_are_passed_over(tmp_path, monkeypatch):
    # 823 is too weak: its motors just lift it from 2.2°.
    monkeypatch.setattr(bench_intervals, "RANDOM_SEED", 823)
    monkeypatch.setattr(bench_intervals, "RANDOM", 1)
    file, = bench_intervals.strong_robots(tmp_path)
    assert file.stem == "random824" and file.read_text() == random_robots.robot_file(random_robots.draw(824))
    assert list((file.parent / "tables").glob("*.c"))


def test_bad_number_of_missions():
    assert_one_line_error(run_tool("measure.bench_intervals", "--missions", 0), "--missions: 0: must be a whole number")
