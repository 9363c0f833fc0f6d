"""tools/measure/cycles.py: figures of the benches to a table."""
import json

import pytest
from conftest import assert_one_line_error, run_tool


def figure(name, value):
    return {"name": name, "value": value, "unit": "instructions", "bound": None, "command": "make figures"}


FIGURES = [figure("x: whole tick", 700), figure("x: whole tick, worst", 900),
           figure("x: sensor decode to PWM, worst", 800), figure("x: controller tick", 5000), figure("x: segment optimiser, worst of 5", 7000),
           figure("x: energy forecast, worst of 5", 4000), figure("x: energy regressors, worst of 5", 4000),
           figure("x: learner: update, worst of 5", 13000), figure("x: learner: forecast of a segment", 12000),
           figure("x: current check: update, worst of 5", 4600),
           figure("x: slice of 32 expansions of the planner", 70000), figure("x: TEB cycle, 50 poses", 3000000),
           figure("x: slice of 32 expansions of the grid planner, worst of 9", 80000),
           figure("x: localiser, scan of 360 beams, worst", 656000),
           figure("x: four wheels: tick, worst", 7500), figure("x: pure pursuit: tick, worst", 27000)]


@pytest.fixture
def tabulate(monkeypatch, tmp_path):
    monkeypatch.setenv("JP_BUILD", str(tmp_path / "build"))

    def run(benches):
        paths = []
        for name, figures in benches.items():
            paths.append(tmp_path / f"{name}.json")
            paths[-1].write_text(figures if isinstance(figures, str) else json.dumps(figures))
        measured = tmp_path / "build/numbers/cycles.json"
        return run_tool("measure.cycles", *paths), measured
    return run


def test_the_worst_of_each_row_and_core_counts(tabulate):
    result, measured = tabulate({"target_a-cortex-m4": FIGURES, "target_a-cortex-m0-o2": FIGURES[:2],
                                 "target_b-cortex-m0-o2": [figure("x: whole tick, falling", 901)]})
    assert result.returncode == 0, result.stderr
    table = json.loads(measured.read_text())
    assert table["whole tick"] == {"Cortex-M0": 901, "Cortex-M4": 900}
    assert table["jp_segment_optimise"] == {"Cortex-M4": 7000}
    assert table["jp_planner_work, 32 expansions"] == {"Cortex-M4": 70000}
    assert table["jp_grid_planner_work, 32 expansions"] == {"Cortex-M4": 80000}


@pytest.mark.parametrize("benches, part", [
    ({"target_a-cortex-m4": FIGURES[:10]}, "expansions"), ({"target_a-host": FIGURES}, "host"),
    ({"target_a-cortex-m4": "a robot left its state"}, "no JSON")])
def test_bad_benches_are_refused(tabulate, benches, part):
    result, measured = tabulate(benches)
    assert_one_line_error(result, part)
    assert not measured.exists()
