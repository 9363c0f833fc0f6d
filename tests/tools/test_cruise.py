"""tools/design/cruise.py: the flat output, the modes and the turn against the plant that they come from."""
import dataclasses
import json
import math
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import ROBOTS, robot_text
from scipy import linalg

from tools.design import cruise, linear_model, robot_json
from tools.measure import random_robots


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
    modes = cruise.modes(balancer.plant, balancer.radius)
    assert sorted(mode.decay for mode in modes) == pytest.approx(sorted(np.abs(linalg.eigvals(states))))
    for mode in modes:
        vector = np.array([1, mode.lean, mode.lean_rate])
        assert states @ vector + volts * mode.volts == pytest.approx(-mode.decay * vector, rel=1e-6, abs=1e-6)


def test_shares_take_a_difference_apart(balancer):
    modes = cruise.modes(balancer.plant, balancer.radius)
    vectors = np.array([[1, mode.lean, mode.lean_rate] for mode in modes])
    assert np.array([mode.share for mode in modes]) @ vectors.T == pytest.approx(np.eye(3), abs=1e-9)


def test_turn_costs_least(balancer):
    flat = cruise.flat(balancer.plant, balancer.radius)
    best = cruise.turn(balancer.robot, flat)
    cost = cruise.turn_cost(balancer.robot, flat, best.blend, best.pace)
    for blend, pace in ((1.01, 1), (0.99, 1), (1, 1.01), (1, 0.99), (1.01, 0.99), (0.99, 1.01)):
        assert cruise.turn_cost(balancer.robot, flat, best.blend * blend, best.pace * pace) > cost


@pytest.fixture(params=range(1, 13))
def random_balancer(request):
    robot = robot_json.Robot("random", random_robots.draw(request.param))
    return SimpleNamespace(plant=linear_model.linear_plant(robot), radius=robot.number("wheel.radius_m"))


def squared_voltage(states, push, gain, start):
    """∫ u² dt under this gain."""
    closed = states - np.outer(push, gain)
    return start @ linalg.solve_continuous_lyapunov(closed.T, -np.outer(gain, gain)) @ start


def test_modes_of_any_robot_are_apart_and_cost_hardly_more(random_balancer):
    plant, radius = random_balancer.plant, random_balancer.radius
    states, push = cruise.travel_plant(plant, radius)
    modes = cruise.modes(plant, radius)
    decays = np.array([mode.decay for mode in modes])
    assert (decays[:-1] >= cruise.MODES_APART * decays[1:] * (1 - 1e-9)).all()  # the fastest first
    # 1/√lag is where a mode leaves the speed as it is.
    lag = cruise.flat(plant, radius).lag
    if lag > 0:
        assert (np.abs(np.log(decays * math.sqrt(lag))) >= math.log(cruise.STILL_APART) * (1 - 1e-9)).all()
    vectors = np.array([[1, mode.lean, mode.lean_rate] for mode in modes])
    assert states @ vectors.T + np.outer(push, [mode.volts for mode in modes]) == pytest.approx(
        -decays * vectors.T, rel=1e-6, abs=1e-6 * np.abs(vectors).max() * decays.max())
    gain = -np.array([mode.volts for mode in modes]) @ np.linalg.inv(vectors.T)
    best = push @ linalg.solve_continuous_are(states, push[:, None], np.zeros((3, 3)), np.eye(1))
    for start in np.eye(3)[:2]:
        assert squared_voltage(states, push, gain, start) <= 1.025 * squared_voltage(states, push, best, start)


def test_decays_that_are_alike_are_moved_apart_as_little_as_possible(monkeypatch):
    monkeypatch.setattr(cruise, "MODES_APART", 1.5)
    monkeypatch.setattr(cruise, "STILL_APART", 1.2)
    assert cruise.told_apart([1.0, 8.0, 3.0], 0) == pytest.approx([1, 3, 8])
    assert cruise.told_apart([2.0, 2.0, 9.0], 0) == pytest.approx([2 / math.sqrt(1.5), 2 * math.sqrt(1.5), 9])
    assert cruise.told_apart([2.0, 2.0, 2.0], 0) == pytest.approx([2 / 1.5, 2, 3])
    # 1/√lag is 3: one is moved below, the other above.
    assert cruise.told_apart([2.9, 3.1, 9.0], 1 / 9) == pytest.approx([3 / 1.2, 3 * 1.2, 9])
    assert cruise.told_apart([2.8, 2.9, 9.0], 1 / 9) == pytest.approx([3 / 1.2 / 1.5, 3 / 1.2, 9])


def test_a_plant_that_swings_has_real_modes(balancer):
    a = balancer.plant.a.copy()
    # Wheels and body on a spring: a complex pair.
    a[4, 1] = -abs(a[4, 1])
    a[4, 4] = 0
    a[4, 3] = 0
    a[3, 1] = 0
    plant = dataclasses.replace(balancer.plant, a=a)
    states, push = cruise.travel_plant(plant, balancer.radius)
    assert np.abs(np.linalg.eigvals(states).imag).max() > 0
    for mode in cruise.modes(plant, balancer.radius):
        vector = np.array([1, mode.lean, mode.lean_rate])
        assert states @ vector + push * mode.volts == pytest.approx(-mode.decay * vector, rel=1e-6, abs=1e-6)
