"""tools/measure/energy_limit.py and bench_limit.py: the plant, limits that are known otherwise, drives of a random route;
bad input."""
import json
import math
import re
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from conftest import JP_ROBOT, ROOT, assert_one_line_error, run_tool

from tools.design import robot_json, robot_trials
from tools.measure import bench_limit, energy_limit
from tools.measure.energy_limit import (BATTERY, MOTOR, PITCH, PITCH_RATE, SPEED, STATES, YAW_RATE, Plant, Problem, Task,
                                        follow, guess_of, integrate, least, least_in, shares_of)
from tools.measure.trajectory_oracle import Linear, Plan

SEED = 11
SPEED_AT_END = 0.45  # m/s


def plant_of(name, energy=MOTOR):
    return Plant(robot_json.load(ROOT / f"sim/robots/{name}.cfg", JP_ROBOT), energy)


@pytest.fixture(scope="module", params=["gao2018", "courier24"])
def plant(request):
    return plant_of(request.param)


@pytest.fixture(scope="module")
def bend():
    """There and round a corner."""
    return Task(plant_of("gao2018"), np.array([[0, 0], [1.5, 0.5], [1, 2.5]]))


@pytest.fixture(scope="module")
def solution(bend):
    return least(bend, [SPEED_AT_END], 2)[0]


# ---- Plant ---------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("energy", [MOTOR, BATTERY])
def test_energy_balances(energy):
    """What flows in and is not lost is held, in any state."""
    plant, generator = plant_of("courier24", energy), np.random.default_rng(SEED)
    state, volts = ca.SX.sym("state", STATES), ca.SX.sym("volts", 2)
    rate, counted, terminal, lost, held = plant.step(state, volts)
    balance = ca.Function("balance", [state, volts], [terminal - lost - ca.jtimes(held, state, rate), counted, terminal])
    for _ in range(100):
        left, counted, terminal = balance(generator.normal(0, 1, STATES), generator.normal(0, 10, 2))
        assert abs(float(left)) < 1e-9 * (1 + abs(float(terminal)))
        assert energy == MOTOR or float(counted) == pytest.approx(float(terminal) + plant.electronics)


def test_steady_voltages_hold_a_straight_drive(plant):
    state = np.zeros(STATES)
    state[SPEED] = 0.7
    # On a straight way the body leans against the ground's friction: only the sum of the forces is balanced upright.
    rate = np.array(plant.step(state, plant.steady_volts(0.7))[0]).ravel()
    assert rate[YAW_RATE] == pytest.approx(0, abs=1e-12)
    assert plant.cruise() == pytest.approx(least_by_search(plant), rel=1e-3)


def least_by_search(plant):
    speeds = np.linspace(0.2, 0.9, 2000)
    powers = [float(plant.step([0, 0, 0, speed, 0, 0, 0], plant.steady_volts(speed))[1]) for speed in speeds]
    return speeds[np.argmin(np.array(powers) / speeds)]


# ---- Limits --------------------------------------------------------------------------------------------------------

def test_limits_are_those_of_another_program():
    """Computed with Gauss-Legendre points, wheel coordinates and equations of motion written by hand."""
    corners = [[0, 0], [0.990, 0.990], [2.242, 1.616], [2.868, 2.868]]
    found, = least(Task(plant_of("gao2018"), np.array(corners)), [SPEED_AT_END], 2)
    assert found.energy == pytest.approx(103.2048125, rel=1e-6)


def test_the_solution_is_a_drive(solution, bend):
    check = integrate(solution)
    assert check.energy == pytest.approx(solution.energy, rel=1e-5)
    assert max(check.misses) < 1e-5 and abs(check.balance) < 1e-6
    assert solution.at_waypoints()[:2].T == pytest.approx(bend.points, abs=1e-9)
    assert solution.states[SPEED, -1] == pytest.approx(SPEED_AT_END)
    assert np.allclose(solution.states[2:, 0], 0)
    assert np.abs(solution.volts).max() < 2 * bend.plant.voltage_max


def test_no_drive_forward_takes_less_than_the_bound(solution, bend):
    """With u0 = √(Ps Rm/2) the motors' energy is a price of the way and of the momentum at the end, plus two integrals of
    squares; chords are the least way."""
    plant, speed = bend.plant, bend.plant.cruise()
    state = np.zeros(STATES)
    state[SPEED] = speed
    a_metre = float(plant.step(state, plant.steady_volts(speed))[1]) / speed
    assert solution.energy > a_metre * bend.chords.sum()
    assert solution.energy < a_metre * bend.chords.sum() * 1.15


def test_a_faster_end_takes_more(bend):
    slow, fast = least(bend, [0.3, 0.5], 1)
    assert 14 * 0.2 * 0.3 < fast.energy - slow.energy < 14 * 0.2 * 1.5  # about 14 J for each m/s


def test_the_time_that_it_would_choose_changes_nothing(bend, solution):
    given, = least_in(bend, [(SPEED_AT_END, solution.durations.sum())], 1)
    assert given.energy == pytest.approx(solution.energy, rel=1e-6)


def test_any_other_time_takes_more(bend, solution):
    times = [share * solution.durations.sum() for share in (1.2, 0.9, 0.8)]
    slow, fast, faster = least_in(bend, [(SPEED_AT_END, seconds) for seconds in times], 1)
    assert [found.durations.sum() for found in (slow, fast, faster)] == pytest.approx(times)
    assert slow.energy > 1.001 * solution.energy
    assert faster.energy > fast.energy > 1.001 * solution.energy


def test_a_time_that_is_too_short_is_no_solution(bend, monkeypatch):
    monkeypatch.setattr(energy_limit, "ITERATIONS", 20)
    seconds = 0.9 * bend.chords.sum() / bend.plant.speed_max
    assert least_in(bend, [(SPEED_AT_END, seconds), (SPEED_AT_END, seconds)], 1) == [None, None]


def test_limits_of_the_robot_hold():
    """Of pitch and voltage, which bind."""
    robot = robot_json.load(ROOT / "sim/robots/gao2018.cfg", JP_ROBOT)
    tight = Plant(robot.varied({"supply.voltage_v": 5.0, "control.tilt_limit_deg": 4.0}))
    task = Task(tight, np.array([[0, 0], [2.0, 1.0]]))
    free, = least(Task(Plant(robot), task.points), [SPEED_AT_END], 1)
    bound, = least(task, [SPEED_AT_END], 1)
    assert bound.energy > free.energy
    assert np.abs(bound.states[PITCH]).max() <= math.radians(4) + 1e-6
    sides = np.abs([bound.volts[0] - bound.volts[1], bound.volts[0] + bound.volts[1]])
    assert sides.max() <= 5 + 1e-6
    assert bound.states[PITCH_RATE, -1] == pytest.approx(0, abs=1e-9)


def test_what_cannot_be_is_no_solution(bend, monkeypatch):
    """An end faster than the robot may drive."""
    monkeypatch.setattr(energy_limit, "ITERATIONS", 20)
    assert least(bend, [2 * bend.plant.speed_max], 1) == [None]


def test_a_finer_mesh_changes_nothing(solution, bend):
    finer = Problem(bend, [np.repeat(leg / 2, 2) for leg in solution.shares]).solve(guess_of(solution), SPEED_AT_END)
    assert finer.energy == pytest.approx(solution.energy, rel=1e-6)


def test_shares_of_a_leg():
    for seconds in (0.08, 1.0, 40.0):
        shares = shares_of(seconds, 0.05)
        assert shares.sum() == pytest.approx(1) and np.array_equal(shares, shares[::-1]) and shares[0] == shares.min()


# ---- Cruise and transients -----------------------------------------------------------------------------------------

@pytest.fixture(scope="module")
def plan(bend):
    return Plan(bend, SPEED_AT_END)


def travel_rates(plant, travel, mean):
    """Of the plant close to standing upright: speed, pitch and pitch rate."""
    state, places, small = np.zeros(STATES), [SPEED, PITCH, PITCH_RATE], 1e-6
    state[places] = small * travel
    return np.array(plant.step(state, [small * float(mean), 0])[0]).ravel()[places] / small


def test_the_flat_output_tells_states_and_voltage(plant):
    linear, generator = Linear(plant), np.random.default_rng(SEED)
    for _ in range(20):
        flat = generator.normal(0, 1, 4)
        rates = travel_rates(plant, linear.states @ flat[:3], linear.volts @ flat)
        assert rates == pytest.approx(linear.states @ flat[1:], abs=1e-6)
    assert linear.states[0, 0] == pytest.approx(1)


@pytest.mark.parametrize("energy", [MOTOR, BATTERY])
def test_a_difference_decays_as_under_the_regulator(energy):
    plant = plant_of("courier24", energy)
    linear, start = Linear(plant), np.array([-0.5, 0.1, -0.3])
    assert np.array(linear.decayed(ca.DM(start), 0)).ravel() == pytest.approx(start)
    for time in (0.05, 0.3, 1.0):
        at, after = (np.array(linear.decayed(ca.DM(start), moment)).ravel() for moment in (time, time + 1e-6))
        assert (after - at) / 1e-6 == pytest.approx(travel_rates(plant, at, -linear.gain @ at), abs=1e-3)
    assert np.abs(linear.decayed(ca.DM(start), 20.0)).max() < 1e-9


def test_its_modes_are_the_poles_of_the_robot():
    """Where voltage alone has a price, what does not fall is left alone, and what falls is mirrored."""
    plant = plant_of("gao2018")
    linear = Linear(plant)
    slopes = np.column_stack([travel_rates(plant, unit, 0.0) for unit in np.eye(3)])
    assert sorted(-linear.rates.real) == pytest.approx(sorted(np.abs(np.linalg.eigvals(slopes).real)), rel=1e-4)
    assert np.abs(linear.rates.imag).max() < 1e-6


def test_a_plan_passes_its_waypoints_and_costs_what_it_says(plan, bend, solution):
    drive = follow(bend.plant, bend.points, *plan.sampled())
    assert plan.is_found and max(drive.misses) < 0.005
    assert drive.energy == pytest.approx(plan.energy, rel=2e-3)
    assert solution.energy < plan.energy < 1.005 * solution.energy
    assert drive.end_state[SPEED] == pytest.approx(SPEED_AT_END, abs=2e-3)


def test_a_plan_is_continuous(plan):
    steps, states, volts, ends = plan.sampled()
    assert ends[-1] == len(steps) and steps.sum() == pytest.approx(plan.seconds)
    # In the middle of the first step, from rest.
    assert np.abs(states[[SPEED, PITCH]][:, 0]).max() < 0.01
    for place, largest in ((SPEED, 0.01), (PITCH, 0.01), (YAW_RATE, 0.02)):
        assert np.abs(np.diff(states[place])).max() < largest
    assert np.abs(volts).max() < 20


# ---- Bench ---------------------------------------------------------------------------------------------------------

def test_random_routes_follow_their_rule():
    for seed in range(20):
        points = robot_trials.draw_points(np.random.default_rng(seed))
        legs = np.diff(points, axis=0)
        lengths, directions = np.hypot(*legs.T), np.arctan2(legs[:, 1], legs[:, 0])
        turns = (np.diff(directions, prepend=0) + math.pi) % math.tau - math.pi
        assert len(legs) == robot_trials.LEGS and not points[0].any()
        assert lengths.min() >= 1 and lengths.max() <= 15 and np.abs(turns).max() <= robot_trials.TURN


def to_its_first_corner(route):
    """A scenario of one leg."""
    return replace(route, scenario=re.sub(r"waypoints = .*;", "waypoints = ( [0.0, 0.0], [0.99, 0.99] );", route.scenario,
                                          flags=re.DOTALL))


def test_a_short_run(tmp_path, monkeypatch):
    whole = bench_limit.scenario_route
    monkeypatch.setattr(bench_limit, "scenario_route", lambda name: to_its_first_corner(whole(name)))
    monkeypatch.setattr(bench_limit, "SCENARIOS", ("courier24_short",))
    monkeypatch.setattr(bench_limit, "ROBOTS", ("gao2018",))
    monkeypatch.setattr(bench_limit, "STARTS", 1)
    monkeypatch.setattr(robot_trials, "LEGS", 1)
    path = tmp_path / "limit.json"
    result = run_tool("measure.bench_limit", "--routes", 1, "--unseen", 1, "--seed", 5, "--workers", 1, "--bench", path)
    assert result.returncode == 0, result.stderr
    figures = {figure["name"]: figure["value"] for figure in json.loads(path.read_text())}
    beside = [name for name in figures if name.startswith("cruise and transients, ")]
    assert len(figures) == 8 + 2 * 8 + 2 * 2 + len(beside) and len(beside) == 2 * (2 + 3 + 3 + 1) + 2
    # After one leg the rule's drive is some millimetres short of its waypoint, and so below the limit.
    others = [name for name in beside if "another strategy" in name]
    assert [int(name.split(": ")[1].split()[0]) for name in others] == [2, 3]
    assert all(-20 < figures[name] < 0.01 for name in others)
    assert all(-0.5 < value < 100 for name, value in figures.items() if name not in others)
    assert all(figures[name] < 4 for name in beside)
    # Of the limit that another program finds, 25.24216 J.
    assert figures["energy limit: courier24_short, energy-optimal segments: above the limit"] == \
        pytest.approx(4.43, abs=0.1)
    for text in ("courier24_short", "gao2018", "worst miss, cm", "turns to ±120°"):
        assert text in result.stdout
    tables = json.loads((tmp_path / "limit.tables.json").read_text())
    assert [len(tables[name]["rows"]) for name in ("limit_scenarios", "limit_routes")] == [8, 10]

    def not_again(*_):
        raise AssertionError("what was found is kept")

    monkeypatch.setattr(bench_limit.energy_limit, "least", not_again)
    again = run_tool("measure.bench_limit", "--routes", 1, "--unseen", 1, "--seed", 5, "--workers", 1, "--bench", path)
    assert again.stdout == result.stdout, again.stderr


def test_a_limit_that_is_not_found_is_named(monkeypatch):
    monkeypatch.setattr(bench_limit.energy_limit, "least", lambda *_: [None])
    route = bench_limit.Route("corner", "", 1)
    with pytest.raises(bench_limit.ToolError, match="corner: no limit found that ends at 0.400 m/s"):
        bench_limit.limits_found(route, None, [0.4])


def test_a_limit_at_another_end(bend):
    speed = bend.plant.cruise()
    near, far = (bench_limit.Limit(end, found.energy, found.durations.sum())
                 for end, found in zip((speed, speed + 0.005), least(bend, [speed, speed + 0.005], 1)))
    moved = bench_limit.moved(bend.plant, near, far.end_speed)
    assert moved - near.energy == pytest.approx(far.energy - near.energy, rel=0.02)
    assert bench_limit.moved(bend.plant, near, speed) == near.energy


def test_only_what_no_kept_limit_is_near_is_found(tmp_path, monkeypatch):
    asked = []

    def found(_route, _task, speeds):
        asked.append(speeds)
        return [bench_limit.Limit(speed, 100 * speed, 1.0) for speed in speeds]

    monkeypatch.setattr(bench_limit, "limits_found", found)
    path = tmp_path / "limits.json"
    for speeds, ends in (([0.5, 0.3], [0.5, 0.3]), ([0.505, 0.309], [0.5, 0.3]), ([0.52, 0.3], [0.52, 0.3])):
        assert [limit.end_speed for limit in bench_limit.limits_of(None, None, speeds, path)] == ends
    assert asked == [[0.5, 0.3], [0.52]]


def test_a_failed_mission_is_named():
    route = bench_limit.Route("broken", "name = ;", 1)
    with pytest.raises(bench_limit.ToolError, match="broken: jp-mission: .*route.cfg"):
        bench_limit.driven(route)


def test_missing_program_is_named(monkeypatch, tmp_path):
    monkeypatch.setenv("JP_BUILD", str(tmp_path))
    with pytest.raises(bench_limit.ToolError, match="jp-mission: .*build it with `make`"):
        bench_limit.driven(bench_limit.random_route("gao2018", 1))


@pytest.mark.parametrize("option", ["--routes", "--unseen"])
@pytest.mark.parametrize("routes", ["0", "x"])
def test_bad_number_of_routes(option, routes):
    assert_one_line_error(run_tool("measure.bench_limit", option, routes), f"{option}: {routes}: must be a whole number")
