"""tools/design/specification.py: settings that a robot file leaves out, against their physics; what is refused."""
import copy
import functools
import math

import numpy as np
import pytest
from conftest import JP_ROBOT, ROOT, assert_one_line_error, run_tool
from scipy import integrate

from tools.common import ToolError
from tools.design import closed_loop, linear_model, robot_json, specification
from tools.measure import random_robots

def robot_of(seed, **changes):
    """A random robot with other values; group__key names one."""
    data = copy.deepcopy(random_robots.draw(seed))
    for key, value in changes.items():
        group, entry = key.split("__")
        data.setdefault(group, {})[entry] = value
    return robot_json.Robot(f"random{seed}", data)


def is_strong(robot):
    try:
        specification.check_strength(robot, linear_model.linear_plant(robot), specification.VOLTAGE_RESERVE)
    except ToolError:
        return False
    return True


STRONG = [seed for seed in range(1, 40) if is_strong(robot_of(seed))][:6]


@functools.cache
def completed(seed):
    return specification.completed(robot_of(seed))


@pytest.fixture(params=STRONG)
def robot(request):
    return robot_of(request.param)


def test_the_rule_draws_strong_and_weak_robots():
    strong = [is_strong(robot_of(seed)) for seed in range(1, 101)]
    assert 50 < sum(strong) < 100


def test_every_setting_is_found_and_those_that_are_given_stay(robot):
    found = completed(int(robot.name.removeprefix("random")))
    assert all(found.is_given(f"control.{key}") for key in specification.SETTINGS)
    assert specification.completed(found) is found
    mine = specification.completed(robot.varied({"control.tilt_limit_deg": 33.0}))
    assert mine.number("control.tilt_limit_deg") == 33
    assert mine.numbers("control.weights", 8) == found.numbers("control.weights", 8)


def test_the_slowest_mode_settles_as_specified(robot):
    """But for the integrals, which come after it."""
    plant = linear_model.linear_plant(robot)
    seed = int(robot.name.removeprefix("random"))
    for settling, asked in ((specification.SETTLING / specification.falling_rate(plant), completed(seed)),
                            (5.0, specification.completed(robot_of(seed, specification__settling_s=5.0)))):
        weights = np.diag(asked.numbers("control.weights", 8))
        for angles, row, pace in (((0, 1), [1, 1], 1), ((2,), [-1, 1], specification.YAW_PACE)):
            states = [*angles, *(angle + 3 for angle in angles)]
            decay = specification.regulator_decay(
                plant.a[np.ix_(states, states)], (plant.b[states] @ row)[:, None] / math.sqrt(2),
                weights[angles[0], angles[0]] / asked.number("control.input_weight"))
            assert decay == pytest.approx(pace * specification.SETTLED / settling, rel=1e-3)


def test_the_whole_loop_settles(robot):
    for axis in closed_loop.axes(completed(int(robot.name.removeprefix("random")))):
        assert np.abs(np.linalg.eigvals(axis.matrix)).max() < 1


@pytest.mark.parametrize("seed", STRONG[:4])
@pytest.mark.parametrize("share, falls", [(0.97, False), (1.03, True)])
def test_full_voltage_brings_back_what_is_recoverable(seed, share, falls):
    """Full voltage against the falling mode, until it is gone: of the linear plant, by another way."""
    robot = robot_of(seed)
    plant = linear_model.linear_plant(robot)
    speed = 0.5 * robot.number("limits.speed_m_s")
    poles, covectors = np.linalg.eig(plant.a.T)
    falling = covectors[:, poles.real.argmax()].real
    falling = falling / falling[1]
    steady = plant.volts_per_speed * speed
    start = np.zeros(8)
    start[1] = share * specification.recoverable_lean(robot, plant, speed)
    push = math.copysign(robot.number("supply.voltage_v") - steady, -falling @ plant.b.sum(axis=1))

    def away(_, state):
        return plant.a @ state + plant.b.sum(axis=1) * push

    rate = specification.falling_rate(plant)
    end = integrate.solve_ivp(away, (0, 6 / rate), start, method="LSODA", rtol=1e-9, atol=1e-12).y[:, -1]
    assert (falling @ end > 0) == falls


def test_the_margin_tells_when_a_loop_swings(robot):
    """Against the loop itself: more gain at the motors, or less, until it does not settle."""
    axis = closed_loop.axes(completed(int(robot.name.removeprefix("random"))))[0]
    margin = closed_loop.modulus_margin(axis)
    assert 0.4 < margin <= 1

    def settles(gain):
        return np.abs(np.linalg.eigvals(axis.matrix + (gain - 1) * np.outer(axis.push, axis.voltage))).max() < 1

    assert all(settles(gain) for gain in np.linspace(1 / (1 + 0.99 * margin), 1 / (1 - 0.99 * margin), 9))
    least = max(gain for gain in np.linspace(0, 1, 400) if not settles(gain))
    # L runs through −1 at that gain; at 1 it is at −1/least.
    assert margin <= 1 / least - 1 + 1e-2


def test_a_late_sensor_takes_margin(robot):
    axis = closed_loop.axes(completed(int(robot.name.removeprefix("random"))))[0]
    found = [closed_loop.modulus_margin(axis, delay) for delay in (0, 0.001, 0.01, 0.1)]
    assert found == sorted(found, reverse=True) and found[-1] < 0.8 * found[0]


def test_a_sensor_that_is_too_late_is_refused(tmp_path):
    path = tmp_path / f"random{STRONG[1]}.cfg"
    path.write_text(random_robots.robot_file(random_robots.draw(STRONG[1])) + "specification: { sensor_delay_s = 0.2; };")
    assert_one_line_error(run_tool("design.gain_design", path, "--jp-robot", JP_ROBOT, "--tables", tmp_path),
                          "specification.sensor_delay_s: 0.2 s: travel comes within")
    assert not list(tmp_path.glob("*.c"))


def test_a_step_to_the_greatest_speed_leans_the_robot_no_more_than_it_may(robot):
    """By the firmware's loop in real numbers, longer than it was tried out."""
    found = completed(int(robot.name.removeprefix("random")))
    shaping = found.number("control.travel_shaping_s")
    leans = closed_loop.travel_step(found, linear_model.design(found).gains, 20 * shaping, 1)[1]
    most = np.abs(leans).max() * robot.number("limits.speed_m_s")
    assert most <= 1.02 * specification.largest_lean(found, linear_model.linear_plant(found))


def test_shaping_is_tried_with_the_settings_that_the_file_gives(robot):
    found = completed(int(robot.name.removeprefix("random")))
    own = {f"control.{key}": 4.0 * value if key == "tilt_time_constant_s" else value for key, value in (
        (key, found.number(f"control.{key}")) for key in ("tilt_time_constant_s", "bias_time_constant_s"))}
    mixed = specification.completed(robot.varied(own))
    whole = specification.completed(found.varied({**own, "control.travel_shaping_s": None}))
    assert mixed.number("control.travel_shaping_s") == pytest.approx(whole.number("control.travel_shaping_s"))


def test_a_smaller_lean_takes_slower_shaping():
    times = [specification.completed(robot_of(STRONG[0], specification__lean_deg=lean)).number("control.travel_shaping_s")
             for lean in (8.0, 2.0, 1.0)]
    assert times == sorted(times) and times[2] == pytest.approx(2 * times[1], rel=0.3)


def test_a_turn_stays_within_the_voltage_that_the_greatest_speed_leaves(robot):
    plant = linear_model.linear_plant(robot)
    shaping = specification.yaw_shaping(robot, plant, 1e9, 0.15)
    time = np.linspace(0, 12 * shaping, 20000)
    turn = math.radians(robot.number("limits.turn_deg"))
    rate = turn * time / shaping**2 * np.exp(-time / shaping)
    volts = plant.volts_per_turn_rate * rate + np.gradient(rate, time) / (plant.b[5] @ [-1, 1])
    left = 0.85 * robot.number("supply.voltage_v") - plant.volts_per_speed * robot.number("limits.speed_m_s")
    assert np.abs(volts).max() <= left * (1 + 1e-3)
    assert rate.max() <= math.radians(0.75 * 500) * (1 + 1e-9)
    assert np.abs(volts).max() > 0.3 * left or rate.max() > 0.99 * math.radians(0.75 * 500)


def test_tilt_weighs_the_bias_against_changes_of_speed():
    robot = robot_of(STRONG[0], gyro__bias_dps=-0.5)
    plant = linear_model.linear_plant(robot)
    rate, speed = specification.falling_rate(plant), robot.number("limits.speed_m_s")
    time = specification.tilt_time_constant(robot, rate)
    assert time > specification.TILT / rate
    assert math.radians(0.5) * time == pytest.approx(speed / linear_model.GRAVITY / time)
    assert specification.tilt_time_constant(robot_of(STRONG[0], gyro__bias_dps=100.0), rate) == pytest.approx(
        specification.TILT / rate)
    assert specification.tilt_time_constant(robot_of(STRONG[0], gyro__bias_dps=0.0), rate) == 0


def test_sensors_without_noise_cannot_be_told_from_frozen_ones():
    assert specification.freeze_ticks(robot_of(1)) == 50
    assert specification.freeze_ticks(robot_of(1, gyro__noise_rms_dps=0.0)) == 0
    assert specification.freeze_ticks(robot_of(1, accelerometer__step_g=0.0)) == 0
    assert specification.gyro_jump(robot_of(1, gyro__full_scale_dps=0.0), None) == 0


@pytest.mark.parametrize("changes, message", [
    ({"limits__speed_m_s": 5.9}, "limits: 5.9 m/s with 0.35 rad/s takes .* V, and .* V are left beside the reserve"),
    ({"specification__voltage_reserve": 0.89}, "limits: .* V are left beside the reserve"),
    ({"specification__settling_s": 0.01}, "specification.settling_s: 0.01 s: the body falls in .* s, and no voltage "
                                          "lets the wheels settle in less than .* s"),
    ({"specification__lean_deg": 0.1}, "limits.speed_m_s: .* must not lean more than 0.1°, and so takes more than 60 s"),
    ({"control__input_weight": 1.0}, "control: weights and input_weight stand together; give both, or neither"),
])
def test_what_physics_forbids_is_refused_in_a_sentence(changes, message):
    with pytest.raises(ToolError, match=message):
        specification.completed(robot_of(STRONG[0], **changes))


def test_motors_that_are_too_weak_are_named():
    # Twenty times the weight: a twentieth of the lean.
    data = random_robots.draw(STRONG[0])
    with pytest.raises(ToolError, match="motor, supply: at .* m/s the motors at full voltage just lift the body from .*°"):
        specification.completed(robot_of(STRONG[0], body__mass_kg=20 * data["body"]["mass_kg"]))


def test_a_file_without_settings_gets_gains(tmp_path):
    path = tmp_path / f"random{STRONG[1]}.cfg"
    path.write_text(random_robots.robot_file(random_robots.draw(STRONG[1])))
    result = run_tool("design.gain_design", path, "--jp-robot", JP_ROBOT, "--tables", tmp_path)
    assert result.returncode == 0, result.stderr
    assert f"jp_robot_random{STRONG[1]}" in (tmp_path / f"robot_random{STRONG[1]}.c").read_text()


def test_a_shipped_robot_without_its_settings_is_much_like_it(tmp_path):
    text = (ROOT / "sim/robots/courier24.cfg").read_text()
    head, rest = text.split("control: {")
    path = tmp_path / "courier24.cfg"
    path.write_text(head + "control: { rate_hz = 1000; };" + rest.split("};", 1)[1])
    bare = robot_json.load(path, JP_ROBOT)
    own = robot_json.load(ROOT / "sim/robots/courier24.cfg", JP_ROBOT)
    for key in ("encoder_bandwidth_rad_s", "tilt_time_constant_s", "tilt_limit_deg", "voltage_min_v", "voltage_max_v",
                "current_residual_a", "freeze_ticks"):
        assert bare.number(f"control.{key}") == pytest.approx(own.number(f"control.{key}"), rel=0.8), key


@pytest.mark.parametrize("group", ["specification: { settling_s = 0.0; };", "specification: { lean_deg = 31.0; };",
                                   "specification: { voltage_reserve = 1.0; };", "specification: { delay = 1.0; };"])
def test_a_specification_out_of_range_is_refused(group, tmp_path):
    path = tmp_path / "random1.cfg"
    path.write_text(random_robots.robot_file(random_robots.draw(STRONG[0])) + group)
    assert_one_line_error(run_tool("design.gain_design", path, "--jp-robot", JP_ROBOT, "--tables", tmp_path),
                          "specification")
    assert not list(tmp_path.glob("*.c"))
