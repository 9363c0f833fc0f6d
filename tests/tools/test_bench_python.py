"""tools/measure/bench_python.py: the commands of the README, a fresh copy, figures of what was measured."""
import json
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import ROOT, assert_one_line_error, run_tool

from tools.common import ToolError
from tools.measure import bench_python
from tools.measure.figure_store import read_figures


def test_the_readme_has_at_most_five_lines_to_the_first_joules():
    commands = bench_python.first_commands()
    assert len(commands) <= bench_python.LINES_BAR
    assert commands[0].startswith("python3 -m venv ") and " install ./tools/python" in commands[1] and "drive" in commands[-1]


def test_a_copy_is_the_project_without_what_was_built(tmp_path):
    bench_python.copy_sources(tmp_path / "copy")
    assert not (tmp_path / "copy/build").exists() and not (tmp_path / "copy/.venv").exists()
    for name in ("Makefile", "tools/python/pyproject.toml", "src/base/fixed.c"):
        assert (tmp_path / "copy" / name).read_bytes() == (ROOT / name).read_bytes()


def test_time_of_processors_is_that_of_the_command_alone():
    clock, processors = bench_python.timed(["python3", "-c", "sum(range(10**6))"])
    assert 0 < processors
    clock, processors = bench_python.timed(["sleep", "0.3"])
    assert clock >= 0.3 and processors < 0.2
    with pytest.raises(ToolError, match="exit status 3: why"):
        bench_python.timed("echo why >&2; exit 3", shell=True)


def test_hills_are_the_same_every_time_and_their_walls_have_gaps(tmp_path):
    for name in ("one", "other"):
        bench_python.write_hills(tmp_path / name, 60, 3, 0.2)
    one, other = (json.loads((tmp_path / name).read_text()) for name in ("one", "other"))
    assert one | {"name": ""} == other | {"name": ""}
    walls = np.array([list(row) for row in one["rows"]]) == "#"
    assert [walls[:, x].sum() for x in (20, 40)] == [48, 48] and walls.sum() == 96
    assert 0.1 < np.ptp(one["elevation_m"]) < 3.1


@pytest.fixture(name="measured")
def fixture_measured(tmp_path, monkeypatch):
    (tmp_path / "bench").mkdir()
    monkeypatch.setattr(bench_python, "build_directory", lambda: tmp_path)
    monkeypatch.setattr(bench_python, "install", lambda: [("venv", 2.0, 1.0), ("pip", 100.0, 40.0)])
    return tmp_path / "bench"


def test_figures_are_sums_means_and_worsts(measured, monkeypatch):
    monkeypatch.setattr(bench_python, "comparisons", lambda: [("office", 0.1, 0.105), ("yard", 0.2, 0.2)])
    result = run_tool("measure.bench_python", "install", "planning")
    assert result.returncode == 0, result.stderr
    for part, values in (("install", [2, 102, 41]), ("planning", [0.305 / 0.3, 1.025, 1.05])):
        assert [figure["value"] for figure in read_figures(measured / f"python_{part}.json")] == pytest.approx(values)


def test_plans_that_differ_are_no_measurement(measured, monkeypatch):
    monkeypatch.setattr(bench_python, "comparisons", lambda: [bench_python.compare(
        SimpleNamespace(Robot=str, Terrain=SimpleNamespace(load=str)), "office", "office.json", "burger", None)])
    monkeypatch.setattr(bench_python, "program_plans", lambda *_: (
        {"start": [0, 0, 0], "goal_m": [1, 1]}, {"whole_s": 1.0, "energy_j": 10.0}))
    monkeypatch.setattr(bench_python, "python_plans", lambda *_: (1.0, SimpleNamespace(joules=11.0)))
    assert_one_line_error(run_tool("measure.bench_python", "planning"), "office, burger", "11.0 J in Python, 10.0 J of jp-plan")
    assert list(measured.iterdir()) == []
