"""tools/design/cruise.py: the flat output, the modes and the turn against the plant that they come from."""
import dataclasses
import json
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import ROBOTS, robot_text
from scipy import linalg

from tools.common import ToolError
from tools.design import cruise, linear_model, robot_json


@pytest.fixture(scope="module", params=ROBOTS)
def balancer(request):
    robot = robot_json.from_text("test.json", json.dumps(json.loads(robot_text(request.param))))
    return SimpleNamespace(robot=robot, plant=linear_model.linear_plant(robot), radius=robot.number("wheel.radius_m"))


def motion_of(flat, nu):
    """v, ψ and ψ̇ of ν and its derivatives."""
    return np.array([nu[0] - flat.lag * nu[2], flat.lean @ nu[:2], flat.lean @ nu[1:3]])


def test_flat_output_moves_the_plant(balancer):
    flat = cruise.flat(balancer.plant, balancer.radius)
    states, volts = cruise.travel_plant(balancer.plant, balancer.radius)
    for nu in np.random.default_rng(1).normal(size=(20, 5)):
        expected = states @ motion_of(flat, nu) + volts * (flat.volts @ nu[:4])
        assert motion_of(flat, nu[1:]) == pytest.approx(expected, rel=1e-7, abs=1e-7)


def test_steady_voltages_are_those_of_the_energy_model(balancer):
    flat = cruise.flat(balancer.plant, balancer.radius)
    assert flat.volts[0] == pytest.approx(balancer.plant.volts_per_speed)
    assert flat.turning[0] == pytest.approx(balancer.plant.volts_per_turn_rate)


def test_turning_moves_the_plant(balancer):
    flat = cruise.flat(balancer.plant, balancer.radius)
    rate, acceleration = 0.7, -1.3
    difference = flat.turning @ [rate, acceleration]
    yaw = cruise.YAW
    moved = balancer.plant.a[yaw, yaw] * rate + balancer.plant.b[yaw] @ [-difference, difference]
    assert moved == pytest.approx(acceleration)


def test_modes_mirror_the_poles_of_the_plant(balancer):
    states, volts = cruise.travel_plant(balancer.plant, balancer.radius)
    modes = cruise.modes(balancer.robot, balancer.plant, balancer.radius)
    assert sorted(mode.decay for mode in modes) == pytest.approx(sorted(np.abs(linalg.eigvals(states))))
    for mode in modes:
        vector = np.array([1, mode.lean, mode.lean_rate])
        assert states @ vector + volts * mode.volts == pytest.approx(-mode.decay * vector, rel=1e-6, abs=1e-6)


def test_shares_take_a_difference_apart(balancer):
    modes = cruise.modes(balancer.robot, balancer.plant, balancer.radius)
    vectors = np.array([[1, mode.lean, mode.lean_rate] for mode in modes])
    assert np.array([mode.share for mode in modes]) @ vectors.T == pytest.approx(np.eye(3), abs=1e-9)


def test_turn_costs_least(balancer):
    flat = cruise.flat(balancer.plant, balancer.radius)
    best = cruise.turn(balancer.robot, flat)
    cost = cruise.turn_cost(balancer.robot, flat, best.blend, best.pace)
    for blend, pace in ((1.01, 1), (0.99, 1), (1, 1.01), (1, 0.99), (1.01, 0.99), (0.99, 1.01)):
        assert cruise.turn_cost(balancer.robot, flat, best.blend * blend, best.pace * pace) > cost


def test_a_plant_that_swings_is_refused(balancer):
    a = balancer.plant.a.copy()
    # Wheels and body on a spring: a complex pair.
    a[4, 1] = -abs(a[4, 1])
    a[4, 4] = 0
    a[4, 3] = 0
    a[3, 1] = 0
    with pytest.raises(ToolError, match="is not supported"):
        cruise.modes(balancer.robot, dataclasses.replace(balancer.plant, a=a), balancer.radius)
