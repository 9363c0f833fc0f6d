"""tools/design/gain_design.py: bytes of the committed tables, physics of the design, bad input."""
import itertools
import json
import math

import numpy as np
import pytest
from conftest import JP_ROBOT, ROBOTS, ROOT, assert_one_line_error, robot_text, run_tool

from tools.design import estimator_gains, linear_model, reversal, robot_json


# The design note's weights, with which it lists a1 173, a2 8.3, a3 13.5, a7 = a10 16.5, a13 5.82.
NOTE_EXPONENTS = (3.25, 0.09, 6.97, 0.63, 4.71, 6.66, 2.58, 5.90)
NOTE_SETTLING = 5.82


def changed(name, **changes):
    """A robot with some keys replaced; group__key names a key."""
    data = json.loads(robot_text(name))
    for key, value in changes.items():
        group, entry = key.split("__")
        data[group][entry] = value
    return data


def robot_of(data):
    return robot_json.from_text("test.json", json.dumps(data))


@pytest.fixture(scope="module")
def note_robot():
    return robot_of(changed("gao2018", control__weights=[10**e for e in NOTE_EXPONENTS]))


@pytest.mark.parametrize("name", ROBOTS)
def test_committed_table_is_what_the_tool_makes(name, tmp_path):
    result = run_tool("design.gain_design", name, "--jp-robot", JP_ROBOT, "--tables", tmp_path)
    assert result.returncode == 0, result.stderr
    committed = ROOT / "src" / "tables" / f"robot_{name}.c"
    assert (tmp_path / committed.name).read_bytes() == committed.read_bytes(), f"run `make gains ROBOT={name}`"


def test_json_on_standard_input_gives_the_same_table(tmp_path):
    result = run_tool("design.gain_design", "--robot-json", "-", "--tables", tmp_path, input=robot_text("courier24"))
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "robot_courier24.c").read_bytes() == (ROOT / "src/tables/robot_courier24.c").read_bytes()


def test_energy_coefficients_of_the_design_note(note_robot):
    model = linear_model.linear_energy_model(note_robot, settling_seconds=NOTE_SETTLING)
    assert model.a[0] == pytest.approx(173, rel=0.005)
    assert model.a[6] == pytest.approx(16.5, rel=0.005)
    assert model.a[9] == model.a[6]
    assert model.a[12] == pytest.approx(5.82)
    assert model.b[0] == pytest.approx(20.87, rel=0.001)


def test_yaw_coefficients_of_the_design_note_belong_to_steps_of_5_ms(note_robot):
    """The note's a2 and a3 are sums over steps of 5 ms, coarse beside the yaw's fastest pole of 139 1/s (a 150 Hz loop
    gives them too); at 1 kHz they are 6.4 and 8.1."""
    loop = linear_model.design(note_robot)
    responses = linear_model.step_responses(note_robot, loop, NOTE_SETTLING)
    scale = 2 / note_robot.number("motor.resistance_ohm") * 0.005
    assert scale * np.sum(responses.turn_rate[::5]**2) == pytest.approx(8.3, rel=0.03)
    assert scale * np.sum(responses.turn[::5]**2) == pytest.approx(13.5, rel=0.05)
    model = linear_model.linear_energy_model(note_robot, loop, NOTE_SETTLING)
    assert model.a[1] == pytest.approx(6.41, rel=0.01)
    assert model.a[2] == pytest.approx(8.14, rel=0.01)


def test_prediction_is_the_energy_of_a_simulated_transition(note_robot):
    """The quadratic form against the voltages of one transition, added up tick by tick."""
    loop = linear_model.design(note_robot)
    model = linear_model.linear_energy_model(note_robot, loop, NOTE_SETTLING)
    g = linear_model.step_responses(note_robot, loop, NOTE_SETTLING)
    v, w, dv, dw, sigma = 0.6, -0.2, -0.25, 0.4, 0.7
    cv, cw = model.voltage_per_speed, model.voltage_per_turn_rate
    left, right = cv * v - cw * w, cv * v + cw * w
    common, difference = dv * g.speed, dw * g.turn_rate + sigma * g.turn
    resistance = model.motor_resistance
    energy = np.sum((left + common - difference)**2 + (right + common + difference)**2) / resistance / g.rate_hz
    terms = [dv * dv, dw * dw, sigma**2, dv * dw, dv * sigma, dw * sigma, left * dv, left * dw, left * sigma,
             right * dv, right * dw, right * sigma, (left**2 + right**2) / resistance]
    assert np.dot(terms, model.a) == pytest.approx(energy, rel=1e-5)


@pytest.mark.parametrize("name", ROBOTS)
def test_steady_voltage_moves_the_linear_plant_steadily(name):
    robot = robot_of(json.loads(robot_text(name)))
    plant = linear_model.linear_plant(robot)
    radius, speed, turn_rate = robot.number("wheel.radius_m"), 0.7, 0.3
    travel, turn = plant.volts_per_speed * speed, plant.volts_per_turn_rate * turn_rate
    rates = np.array([0, 0, 0, speed / radius, 0, turn_rate, 0, 0])
    voltages = np.array([travel - turn, travel + turn])
    # The pitch that holds the drag's reaction is the one unknown.
    force = plant.a @ rates + plant.b @ voltages
    column = plant.a[:, 1]
    pitch = -force[4] / column[4]
    assert np.allclose((force + column * pitch)[3:6], 0, atol=1e-9)


def test_gains_satisfy_the_riccati_equation(gao2018):
    """Perturbing any gain of the common row raises the cost of a disturbance: the gain is optimal."""
    loop = linear_model.design(gao2018)
    index = list(linear_model.TRAVEL)
    a, b = loop.plant.a[np.ix_(index, index)], loop.plant.b[index].sum(axis=1)
    weights = np.array(gao2018.numbers("control.weights", 8))[index]
    r = 2 * gao2018.number("control.input_weight")

    def cost(gain):
        closed = a - np.outer(b, gain)
        stage = np.diag(weights) + r * np.outer(gain, gain)
        n = len(index)
        lyapunov = np.kron(np.eye(n), closed.T) + np.kron(closed.T, np.eye(n))
        return np.trace(np.linalg.solve(lyapunov, -stage.flatten()).reshape(n, n))

    best = cost(loop.gains.common)
    for i in range(len(index)):
        for factor in (0.97, 1.03):
            gain = loop.gains.common.copy()
            gain[i] *= factor
            assert cost(gain) > best


@pytest.mark.parametrize("bandwidth", [5.0, 60.0, 250.0])
def test_tracking_loop_is_critically_damped(bandwidth):
    rate = 1000.0
    angle_gain, rate_gain = estimator_gains.tracking_gains(bandwidth, rate)
    # Error of angle and rate from tick to tick, as in src/balancer/estimator.c.
    matrix = np.array([[1 - angle_gain, (1 - angle_gain) / rate], [-rate_gain, 1 - rate_gain / rate]])
    pole = math.exp(-bandwidth / rate)
    assert np.trace(matrix) == pytest.approx(2 * pole)
    assert np.linalg.det(matrix) == pytest.approx(pole**2)


def test_tracking_without_bandwidth_is_the_plain_difference():
    assert estimator_gains.tracking_gains(0, 1000.0) == (1.0, 1000.0)


def steered(impulse, inputs):
    """What a response reaches when the inputs come one after the other, the last one first in the sum."""
    return sum(h * u for h, u in zip(impulse, inputs, strict=True))


@pytest.mark.parametrize("rest", [0, 1, 2, 5])
def test_worst_case_of_forward_and_back_is_that_of_all_rows(rest):
    def allowed(row):
        signs = [(at, u) for at, u in enumerate(row) if u]
        return all(u == w or t - s > rest for (s, u), (t, w) in itertools.pairwise(signs))

    for impulse in np.random.default_rng(1).normal(size=(20, 7)):
        most = max(steered(impulse, row) for row in itertools.product((-1, 0, 1), repeat=7) if allowed(row))
        assert reversal.worst_case(impulse, rest) == pytest.approx(most)


@pytest.mark.parametrize("name", ROBOTS)
def test_after_the_rest_a_reversal_is_no_worse_than_a_start(name):
    robot = robot_of(changed(name))
    turning = reversal.design(robot, linear_model.design(robot).gains)
    assert 0.5 < turning.rest_s < 5
    assert 1 < turning.wheel_rate_share < 3


def test_initial_energy_never_replaces_an_identified_one(tmp_path):
    arguments = ("courier24", "--jp-robot", JP_ROBOT, "--tables", tmp_path, "--initial-energy")
    assert run_tool("design.gain_design", *arguments).returncode == 0
    energy = tmp_path / "energy_courier24.c"
    assert "Predicted from the linear plant; run make identify ROBOT=courier24." in energy.read_text()
    energy.write_text("identified")
    assert run_tool("design.gain_design", *arguments).returncode == 0
    assert energy.read_text() == "identified"


BAD = [
    ({"motor__torque_constant_nm_per_a": 0.0}, "motor.torque_constant_nm_per_a"),
    ({"wheel__radius_m": "wide"}, "wheel.radius_m"),
    ({"body__mass_kg": float("nan")}, "body.mass_kg"),
    ({"control__weights": [1, 1, 1]}, "control.weights"),
    ({"control__weights": [1, 1, 1, 1, 1, 1, 0, 1]}, "control.weights[6]"),
    ({"control__weights": [1, 1, -1, 1, 1, 1, 1, 1]}, "control.weights"),
    ({"control__weights": [1e12] * 8, "control__input_weight": 1e-9}, "control"),
    ({"control__travel_shaping_s": 0.001}, "control.travel_shaping_s"),
    ({"control__rate_hz": 20000}, "tick_rate"),
    ({"control__voltage_max_v": 20.0}, "supply.voltage_v"),
    ({"body__centre_height_m": 1e-12}, ""),
    ({"motor__torque_constant_nm_per_a": 1e-200}, ""),
]


@pytest.mark.parametrize("changes, key", BAD)
def test_bad_robots_are_refused_in_one_line_and_leave_nothing(changes, key, tmp_path):
    source = tmp_path / "robot.json"
    source.write_text(json.dumps(changed("courier24", **changes)))
    tables = tmp_path / "tables"
    result = run_tool("design.gain_design", "--robot-json", source, "--tables", tables)
    assert_one_line_error(result, "robot.json", key)
    assert not tables.exists()


@pytest.mark.parametrize("text", ["", "{", "[]", '{"name": "x"}', '{"name": "no good"}', '{"name": "x", "body": 3}'])
def test_garbled_json_is_refused(text, tmp_path):
    result = run_tool("design.gain_design", "--robot-json", "-", "--tables", tmp_path, input=text)
    assert_one_line_error(result, "standard input")


@pytest.mark.parametrize("tool", ["gain_design", "horizon", "identify", "learning"])
def test_a_copy_under_another_name_is_refused(tool, tmp_path):
    copy = tmp_path / "mine.cfg"
    copy.write_bytes((ROOT / "sim/robots/courier24.cfg").read_bytes())
    result = run_tool(f"design.{tool}", copy, "--jp-robot", JP_ROBOT, "--tables", tmp_path / "tables")
    assert_one_line_error(result, "mine.cfg", "name: is 'courier24'", "same name")
    assert not (tmp_path / "tables").exists()


def test_missing_program_and_missing_robot_are_named(tmp_path):
    assert_one_line_error(run_tool("design.gain_design", "courier24", "--jp-robot", tmp_path / "none"), "none")
    assert_one_line_error(run_tool("design.gain_design", tmp_path / "no.cfg", "--jp-robot", JP_ROBOT), "no.cfg")
