"""tools/design/skid_loads.py: what motion takes of the motors, and what limits the acceleration."""
import math

import pytest

from tools.common import ToolError
from tools.design import robot_json, skid_loads


def robot_of(name, **changes):
    """A robot of the project with some numbers replaced; group__key names one."""
    robot = robot_json.load_any(robot_json.robot_path(name))
    return robot.varied({key.replace("__", "."): value for key, value in changes.items()})


def loads_of(robot):
    return skid_loads.loads(robot, skid_loads.steering_ratio(robot))


def limit_of(robot):
    return skid_loads.acceleration_limit(robot, loads_of(robot))


def test_loads_are_those_of_the_paper():
    """Eq. 3 and 5 on zhang2018: rolling c G r/2, climbing G r/2, turning M r/B, each over K_T g η."""
    load = loads_of(robot_of("zhang2018"))
    per_newton = 0.136 / (0.024 * 244.3333845 * 0.78)
    weight = 92 * 9.80665
    assert load.rolling == pytest.approx(0.042593001 * weight / 2 * per_newton)
    assert load.climbing == pytest.approx(weight / 2 * per_newton)
    assert load.turning == pytest.approx(0.69 * weight * 0.5 / 4 / 0.925 / 0.7 * per_newton)
    assert load.friction == 0


def test_a_caster_takes_its_share_of_rolling():
    burger = robot_of("burger")
    free = robot_of("burger", caster__rolling=0.015)
    assert loads_of(free).rolling == pytest.approx(0.015 * 9.80665 / 2 * skid_loads.loads(free, 1).per_force)
    assert loads_of(burger).rolling > loads_of(free).rolling
    assert loads_of(burger).turning == 0


def test_braking_never_tips_the_robot_over():
    burger = robot_of("burger")
    slope = math.radians(10)
    # Its centre stands 29 mm behind the axle, 87 mm high.
    assert skid_loads.tipping_acceleration(burger, slope) == pytest.approx(
        9.80665 * (0.029 / 0.087 * math.cos(slope) - math.sin(slope)))
    assert limit_of(burger) == pytest.approx(
        skid_loads.tipping_acceleration(burger, slope) / 4)


def test_tyres_limit_the_acceleration():
    """A quarter of 9.81 (0.69 cos 15° − sin 15°)."""
    assert limit_of(robot_of("zhang2018")) == pytest.approx(3.998 / 4, abs=1e-3)


def test_weak_motors_limit_it_too():
    weak = robot_of("zhang2018", motor__current_limit_a=6.0)
    side = 5e-6 * 244.3333845**2 + 2 * 0.028
    force = 2 * 0.024 * 244.3333845 * 0.78 * 0.95 * 6 / 0.136
    left = (force - 92 * 9.80665 * (0.25881905 + 0.042593001)) / (92 + 2 * side / 0.136**2)
    assert limit_of(weak) == pytest.approx(left / 4)


def test_slope_that_leaves_nothing():
    with pytest.raises(ToolError, match=r"limits\.slope_deg: 35°: friction"):
        limit_of(robot_of("zhang2018", limits__slope_deg=35.0))
