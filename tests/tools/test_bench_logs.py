"""tools/measure/bench_logs.py: wrong files, what is compared, figures; a robot that does not drive is another one."""
import json

import pytest
from conftest import ROOT, assert_one_line_error, run_tool

from tools.common import ToolError
from tools.design import robot_json
from tools.measure import bench_logs
from tools.measure.bench_logs import SAMPLES, TELEMETRY, Found, Result


@pytest.mark.parametrize("name", bench_logs.ROBOTS)
def test_every_constant_is_wrong_by_20_percent(name):
    true = robot_json.load(ROOT / f"sim/robots/{name}.cfg")
    seen = set()
    for seed in range(20):
        values = bench_logs.wrong_values(true, seed)
        assert all(abs(abs(value / true.number(key) - 1) - 0.2) < 1e-9 for key, value in values.items())
        assert true.number("control.voltage_min_v") < values["supply.voltage_v"] < true.number("control.voltage_max_v")
        seen |= {(key, value > true.number(key)) for key, value in values.items() if key != "supply.voltage_v"}
    assert len(seen) == 2 * (len(values) - 1)
    assert bench_logs.wrong_values(true, 1) == bench_logs.wrong_values(true, 1)


def result(seed=1):
    return Result("courier24", seed, [Found("courier24", SAMPLES, "body.mass_kg", 1.0, 1.0),
                                      Found("courier24", SAMPLES, "wheel.mass_kg", -3.0, 1.0),
                                      Found("courier24", TELEMETRY, "body.mass_kg", -4.0, 4.0)],
                  [-20.0, 10.0], [0.5, -1.5])


def test_figures_of_what_was_found():
    assert [figure["value"] for figure in bench_logs.figures_of([result()])] == [2.0, 50.0, 4.0, 100.0, 15.0, 1.0, 1.5]
    assert bench_logs.table_of([result(), result()])[0] == ("courier24", SAMPLES, "body.mass_kg", "1.00", "1.00", "%")


def test_robots_that_do_not_drive_are_drawn_again(monkeypatch, tmp_path):
    def measure(name, seed, folder):
        if seed % 2:
            raise ToolError(f"{folder}/x: has fallen")
        return result(seed)
    monkeypatch.setattr(bench_logs, "measure", measure)
    path = tmp_path / "logs.json"
    done = run_tool("measure.bench_logs", "--robots", "courier24", "--draws", 2, "--seed", 1, "--bench", path)
    assert not done.returncode, done.stderr
    assert "courier24, seed 1: x: has fallen" in done.stdout
    assert "seed 4: forecast off by 1.00 % after 15.0 %" in done.stdout
    assert len(json.loads(path.read_text())) == 7
    assert json.loads((tmp_path / "logs.tables.json").read_text())["logs"]["rows"][0][0] == "courier24"
    monkeypatch.setattr(bench_logs, "ATTEMPTS_MAX", 3)
    assert_one_line_error(run_tool("measure.bench_logs", "--robots", "courier24", "--draws", 2, "--bench", path),
                          "only 1 drive")
