"""tools/measure/bench_robots.py and random_robots.py: the rule, robots that drive, are too weak, or are broken."""
import json

import numpy as np
import pytest
from conftest import assert_one_line_error, run_tool

from tools.measure import bench_robots, random_robots


def test_robots_follow_their_rule():
    robots = [random_robots.draw(seed) for seed in range(300)]
    for (group, key), (low, high) in {("body", "mass_kg"): random_robots.MASS, ("wheel", "radius_m"): random_robots.WHEEL_RADIUS,
                                      ("supply", "voltage_v"): random_robots.VOLTAGE,
                                      ("motor", "gear_ratio"): random_robots.GEAR}.items():
        logarithms = np.log([robot[group][key] for robot in robots])
        assert logarithms.min() >= np.log(low) and logarithms.max() <= np.log(high)
        assert abs(logarithms.mean() - np.log(low * high) / 2) < 0.1 * np.log(high / low)
    assert random_robots.draw(7) == random_robots.draw(7) != random_robots.draw(8)


def test_a_short_run(tmp_path, monkeypatch):
    path = tmp_path / "robots.json"
    # The first is too weak, the second drives.
    seeds = [3, 12]
    monkeypatch.setattr(bench_robots, "range", lambda *_: seeds, raising=False)
    result = run_tool("measure.bench_robots", "--robots", 2, "--workers", 1, "--bench", path)
    assert result.returncode == 0, result.stderr
    assert "3: gain_design: gain_design.py: random3.cfg: " in result.stdout
    figures = [(figure["value"], figure["unit"]) for figure in json.loads(path.read_text())]
    assert figures[0] == (100, "%") and 0 < figures[1][0] == figures[2][0] < 2
    table = json.loads((tmp_path / "robots.tables.json").read_text())["random_robots"]["rows"]
    assert [row[1] for row in table[:3]] == ["1", "0", "1"]


def test_what_is_not_physics_counts_as_missed():
    driven = bench_robots.Result(1, "", True, 30.0, 1.0, 0.4, 0.1)
    weak = bench_robots.Result(2, "x: motor, supply: at 1 m/s the motors at full voltage just lift the body from 1°", False,
                               *4 * (float("nan"),))
    table = bench_robots.Result(3, "x: a1: is 4097, must be -4096 to 4096", False, *4 * (float("nan"),))
    assert [figure["value"] for figure in bench_robots.figures_of([driven, weak, table])] == [50, 0.4, 0.4]


@pytest.mark.parametrize("robots", ["0", "x"])
def test_bad_number_of_robots(robots):
    assert_one_line_error(run_tool("measure.bench_robots", "--robots", robots), f"--robots: {robots}: must be a whole number")
