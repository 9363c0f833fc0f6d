"""excite.py: routes for a space, tried out on the simulated robot, and driven against a stand-in of the ECU."""
import functools
import json

import numpy as np
import pytest
from conftest import ROOT, assert_one_line_error, run_tool
from fake_ecu import FakeEcu

from tools.common import ToolError
from tools.operate import can_client, excite
from programs import BIN

PLANT = BIN / "jp-plant"
COURIER = ROOT / "sim/robots/courier24.cfg"


@pytest.fixture(scope="module", name="routes")
def fixture_routes():
    return excite.plan(PLANT, COURIER, excite.Space(1.25, 1.0))


def test_routes_stay_in_the_space_and_tell_of_all_motion(routes):
    assert [route.name for route in routes] == list(excite.PATTERNS)
    for route in routes:
        assert route.reach[0] <= 1.25 and route.reach[1] <= 1.0
        assert len(route.waypoints) <= 32
    speeds = [speed for route in routes for speed in route.speeds]
    assert min(speeds) < 0.6 * max(speeds) and max(speeds) <= 1.0
    assert 60 < excite.duration(routes) < 300


@pytest.mark.parametrize("space", [excite.Space(0.8, 0.8), excite.Space(0.9, 0.9, is_round=True)])
def test_where_the_robot_was_is_inside(space):
    pose = excite.Pose(0.0, 0.0, 0.0)
    for name in ("there and back", "loops"):
        route, end = excite.fitted(PLANT, COURIER, space, name, pose)
        _, places, _, _ = excite.try_route(PLANT, COURIER, name, route.waypoints, pose)
        assert space.holds(*places)
        pose = end


def test_too_small_a_space_is_refused():
    with pytest.raises(ToolError, match="give more room"):
        excite.plan(PLANT, COURIER, excite.Space(0.2, 0.2))


def test_poses_turn_points_there_and_back():
    pose = excite.Pose(1.0, -2.0, 0.7)
    assert pose.to_world(*pose.to_local((0.3, 0.4))) == pytest.approx((0.3, 0.4))


def test_a_margin_is_kept():
    space = excite.Space(1.0, 0.5)
    assert space.holds(np.array([0.95]), np.array([0.1])) and not space.holds(np.array([0.95]), np.array([0.1]), 0.1)


@pytest.fixture(name="robot")
def fixture_robot(monkeypatch, tmp_path, routes):
    """Runs the tool beside a stand-in of the ECU, which says that it is at 1.5, −2.5 m."""
    def run(*space, trouble=None):
        run.ecu = FakeEcu(trouble)
        monkeypatch.setattr(excite, "plan", lambda *_: routes[:2])
        monkeypatch.setattr(excite, "open_bus", lambda name: run.ecu)
        monkeypatch.setattr(excite, "Operator", functools.partial(can_client.Operator, clock=run.ecu.clock))
        return run_tool("operate.excite", "courier24", *space, "--bus", "fake:ecu", "--output", tmp_path / "out.json")
    run.output = tmp_path / "out.json"
    return run


def test_routes_are_written_and_driven(robot, routes):
    result = robot("--space", "8x8")
    assert not result.returncode, result.stderr
    assert robot.ecu.violations == []
    assert robot.ecu.driven == [(round(x * 65536), round(y * 65536)) for x, y in routes[1].waypoints]
    written = json.loads(robot.output.read_text())
    assert written["space_m"] == [8, 8]
    assert [one["name"] for one in written["routes"]] == [one.name for one in routes[:2]]
    assert "s in all" in result.stdout


def test_a_robot_outside_the_space_is_stopped(robot):
    result = robot("--radius", "2")
    assert result.returncode == 1
    assert "the robot is at 1.50, -2.50 m and so outside the space" in result.stderr


def test_a_robot_that_falls_is_told(robot):
    result = robot("--space", "8x8", trouble="falls")
    assert result.returncode == 1 and "has fallen" in result.stderr


@pytest.mark.parametrize(("space", "part"), [("4", "LENGTHxWIDTH"), ("4x", "0.1 to 1000 m"), ("4x-3", "0.1 to 1000 m")])
def test_bad_spaces(space, part):
    assert_one_line_error(run_tool("operate.excite", "courier24", f"--space={space}"), "--space", part)


def test_a_robot_that_is_not_built_in():
    assert_one_line_error(run_tool("operate.excite", "nxtway", "--space", "4x3"), "nxtway", "make gains")
