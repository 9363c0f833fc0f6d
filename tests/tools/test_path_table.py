"""path_table.py: the committed tables are fresh, its rules, and what is refused."""
import pytest
from conftest import ROOT, assert_one_line_error, run_tool

from tools.common import ToolError
from tools.design import path_table, robot_json

ROBOTS = ("burger", "zhang2018")
PARTS = ("path_drive", "path_limits")


def make(*arguments):
    return run_tool("design.path_table", *arguments)


def load(name):
    return robot_json.load_any(robot_json.robot_path(name))


@pytest.mark.parametrize("robot", ROBOTS)
def test_committed_tables_are_fresh(robot, tmp_path):
    result = make(robot, "--tables", tmp_path)
    assert result.returncode == 0, result.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == [f"{part}_{robot}.c" for part in PARTS]
    for made in tmp_path.iterdir():
        assert made.read_bytes() == (ROOT / "src" / "tables" / made.name).read_bytes(), f"run make path ROBOT={robot}"


def test_what_limits_the_acceleration():
    """zhang2018's tyres, 9.81 (0.69 cos 15° − sin 15°); burger's height when it brakes downhill."""
    assert path_table.acceleration_left(load("zhang2018")) == pytest.approx(3.998, abs=1e-3)
    assert path_table.acceleration_left(load("burger")) == pytest.approx(1.516, abs=1e-3)


def test_weak_motors_limit_it_too():
    weak = load("zhang2018").varied({"motor.current_limit_a": 6.0})
    force = 2 * 0.024 * 244.3333845 * 0.78 * 6 / 0.136
    left = (force - 92 * 9.80665 * (0.25881905 + 0.042593001)) / path_table.moving_mass(weak)
    assert path_table.acceleration_left(weak) == pytest.approx(left)


def test_moving_mass():
    """Rotors of 5e-6 kg·m² behind 244.33, and two wheels of 0.028 kg·m² a side."""
    side = 5e-6 * 244.3333845**2 + 2 * 0.028
    assert path_table.moving_mass(load("zhang2018")) == pytest.approx(92 + 2 * side / 0.136**2)


def test_slope_that_leaves_nothing():
    steep = load("zhang2018").varied({"limits.slope_deg": 35.0})
    with pytest.raises(ToolError, match=r"limits\.slope_deg: leaves nothing"):
        path_table.tables(steep, ROOT)


def test_other_robots_are_refused(tmp_path):
    assert_one_line_error(make("courier24", "--tables", tmp_path), "its sides do not steer it")
    assert not list(tmp_path.iterdir())
