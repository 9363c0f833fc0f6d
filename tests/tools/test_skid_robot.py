"""tools/design/skid_robot.py: bytes of the committed tables, physics of the design, bad input."""
import json
import math

import pytest
from conftest import JP_ROBOT, ROOT, assert_one_line_error, robot_text, run_tool

from tools.design import robot_json, skid_loads, skid_robot

SKID_ROBOTS = sorted(path.stem.removeprefix("skid_robot_") for path in (ROOT / "src/tables").glob("skid_robot_*.c"))


def robot_of(name, **changes):
    """A robot with some keys replaced; group__key names a key."""
    data = json.loads(robot_text(name))
    for key, value in changes.items():
        group, entry = key.split("__")
        data[group][entry] = value
    return robot_json.from_text("test.json", json.dumps(data))


def loads_of(robot):
    return skid_loads.loads(robot, skid_loads.steering_ratio(robot))


def test_the_tables_are_those_of_zhang2018_and_burger():
    assert SKID_ROBOTS == ["burger", "zhang2018"]


@pytest.mark.parametrize("name", SKID_ROBOTS)
def test_committed_table_is_what_the_tool_makes(name, tmp_path):
    result = run_tool("design.skid_robot", name, "--jp-robot", JP_ROBOT, "--tables", tmp_path)
    assert result.returncode == 0, result.stderr
    committed = ROOT / "src/tables" / f"skid_robot_{name}.c"
    assert (tmp_path / committed.name).read_bytes() == committed.read_bytes(), f"run `make skid-robot ROBOT={name}`"


def test_json_on_standard_input_gives_the_same_table(tmp_path):
    result = run_tool("design.skid_robot", "--robot-json", "-", "--tables", tmp_path, input=robot_text("burger"))
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "skid_robot_burger.c").read_bytes() == (ROOT / "src/tables/skid_robot_burger.c").read_bytes()


@pytest.mark.parametrize("name", SKID_ROBOTS)
def test_loop_of_a_side_has_its_poles(name):
    """s² τ + (1 + kp) s + ki of kp, ki over K: both at the bandwidth, or, without a proportional gain, one there."""
    robot = robot_of(name)
    load, constant = loads_of(robot), skid_loads.back_emf(robot)
    proportional, integral = skid_robot.loop_gains(robot, load)
    time = load.inertia * robot.number("motor.resistance_ohm") / constant**2
    bandwidth = min(25, robot.number("control.rate_hz") / 20)

    def characteristic(s):
        return time * s**2 + (1 + proportional / constant) * s + integral / constant
    assert characteristic(-bandwidth) == pytest.approx(0, abs=1e-9)
    assert (proportional > 0) == (2 * bandwidth * time > 1)
    if proportional > 0:
        assert 2 * time * -bandwidth + 1 + proportional / constant == pytest.approx(0, abs=1e-9)


def test_the_slope_that_stops_it_leaves_room_for_the_accelerometer():
    for name in SKID_ROBOTS:
        robot = robot_of(name)
        steepest = math.degrees(skid_robot.tilt_limit(robot))
        assert robot.number("limits.slope_deg") + 2 < steepest < robot.number("limits.slope_deg") + 4


@pytest.mark.parametrize("name, key, value, named", [
    ("zhang2018", "motor__current_limit_a", 3.0, "limits.slope_deg"),
    ("zhang2018", "control__rate_hz", 50, "tick_rate"),
    ("burger", "limits__slope_deg", 18.4, "limits.slope_deg"),
])
def test_what_cannot_be_designed_is_refused(name, key, value, named, tmp_path):
    data = json.loads(robot_text(name))
    group, entry = key.split("__")
    data[group][entry] = value
    result = run_tool("design.skid_robot", "--robot-json", "-", "--tables", tmp_path, input=json.dumps(data))
    assert_one_line_error(result, named)
    assert not list(tmp_path.iterdir())
