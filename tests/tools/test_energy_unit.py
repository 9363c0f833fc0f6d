"""energy_unit.py: the unit of a robot's energies by its size; the tables that are made in it."""
import dataclasses
import json
import re

import pytest
from conftest import ROBOTS, ROOT, assert_one_line_error, robot_text, run_tool
from test_gain_design import changed

from tools.design import c_tables, energy_unit, learning, linear_model, robot_json

# What is so many times as great in a robot that moves alike with the same lengths: its masses and torques, and its voltages.
BY_MASS = ("body.mass_kg", "wheel.mass_kg", "motor.rotor_inertia_kg_m2", "motor.friction_nm_s_per_rad",
           "ground.friction_nm_s_per_rad", "electronics.power_w", "supply.capacity_wh")
BY_VOLTS = ("motor.torque_constant_nm_per_a", "motor.back_emf_v_s_per_rad", "supply.voltage_v", "bus_sense.full_scale_v",
            "control.voltage_min_v", "control.voltage_max_v")
BY_AMPERES = ("current_sense.full_scale_a", "current_sense.noise_rms_a", "control.current_residual_a")
BY_OHMS = ("motor.resistance_ohm", "supply.resistance_ohm")


def similar(name, mass, volts=1):
    """A robot whose energies are `mass` times, and whose voltages `volts` times as great."""
    data = json.loads(robot_text(name))
    for keys, factor in ((BY_MASS, mass), (BY_VOLTS, volts), (BY_AMPERES, mass / volts), (BY_OHMS, volts**2 / mass),
                         (("control.input_weight",), volts**-2)):
        for key in keys:
            group, entry = key.split(".")
            data[group][entry] *= factor
    return data


def robot_of(data):
    return robot_json.from_text("test.json", json.dumps(data))


def integers(text):
    body = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    return [int(number) for number in re.findall(r"(?<![\w\[])-?\d+", body[body.index("= {"):])]


@pytest.mark.parametrize("name", ROBOTS)
def test_the_robots_of_the_project_count_joules(name):
    assert energy_unit.exponent(robot_of(changed(name))) == 0
    for suffix in ("", "_battery"):
        assert ".unit_exponent = 0," in (ROOT / f"src/tables/energy_{name}{suffix}.c").read_text()


@pytest.mark.parametrize("exponent", [-6, -1, 3, 7])
def test_a_unit_grows_with_the_robot(exponent):
    robot = robot_of(similar("courier24", 2.0**exponent))
    assert energy_unit.exponent(robot) == exponent
    model, of_courier = (linear_model.linear_energy_model(of) for of in (robot, robot_of(changed("courier24"))))
    table, expected = (integers(c_tables.render(c_tables.energy_table("x", *of, "", "", "")))
                       for of in ((model, exponent), (of_courier, 0)))
    assert table[-1] == exponent and expected[-1] == 0
    assert table[:-1] == pytest.approx(expected[:-1], abs=2)


def test_what_motion_takes_makes_the_unit_greater():
    """A heavy robot with the electronics of a light one."""
    heavy = similar("courier24", 400)
    heavy["electronics"]["power_w"] = 4.0
    robot = robot_of(heavy)
    model = linear_model.linear_energy_model(robot)
    exponent = energy_unit.exponent(robot)
    assert exponent > 3
    greatest = max(abs(value) for value in (*model.a[:12], *model.b))
    assert greatest * energy_unit.RESERVE <= energy_unit.PARAMETER_MAX * 2**exponent < 2 * greatest * energy_unit.RESERVE


def test_a_small_resistance_keeps_its_digits():
    robot = robot_of(changed("courier24"))
    model = dataclasses.replace(linear_model.linear_energy_model(robot), a=(0.1,) * 13, b=(0.1, 0.1))
    for resistance, expected in ((0.03, 0), (0.3, -4), (3.0, -5)):
        small = dataclasses.replace(model, motor_resistance=resistance, electronics_power=0.125)
        assert energy_unit.exponent(robot, small) == expected


def test_a_robot_beyond_all_units_is_refused(tmp_path):
    source = tmp_path / "robot.json"
    source.write_text(json.dumps(similar("courier24", 2.0**20)))
    assert_one_line_error(run_tool("design.horizon", "courier24", "--robot-json", source, "--tables", tmp_path / "t"),
                          "robot.json", "units of 2^20 J")


# Of 0.3 kg with 5 kΩ, of 100 kg with 30 mΩ.
EXTREMES = [(1 / 12, 10.2), (29, 0.466)]


@pytest.mark.parametrize("mass, volts", EXTREMES)
def test_small_and_heavy_robots_get_all_tables(mass, volts, tmp_path):
    source = tmp_path / "robot.json"
    source.write_text(json.dumps(similar("courier24", mass, volts)))
    result = run_tool("design.gain_design", "--robot-json", source, "--tables", tmp_path, "--initial-energy")
    assert result.returncode == 0, result.stderr
    assert f".unit_exponent = {energy_unit.exponent(robot_json.load_json(source))}," in (
        tmp_path / "energy_courier24.c").read_text()
    built_in = learning.read_built_in(tmp_path / "energy_courier24.c")
    assert built_in.motor_resistance == pytest.approx(4 * volts**2 / mass, rel=1e-4)


def test_a_great_resistance_limits_the_current_to_what_the_monitor_can_tell(tmp_path):
    source = tmp_path / "robot.json"
    source.write_text(json.dumps(changed("courier24", motor__resistance_ohm=5000.0,
                                         motor__torque_constant_nm_per_a=28.0)))
    result = run_tool("design.gain_design", "--robot-json", source, "--tables", tmp_path)
    assert result.returncode == 0, result.stderr
    limit = int(re.search(r"\.current_limit = (\d+)", (tmp_path / "robot_courier24.c").read_text())[1])
    assert limit == round(32000 / 5000 * 65536)


def test_learned_energies_are_in_the_unit_of_the_model():
    robot = robot_of(changed("courier24"))
    zeros = learning.np.zeros(4)
    what = learning.Learning(learning.np.full((15, 4), 6.0), zeros, zeros, 0.1, 0.1, 0.01, 0.5, 8.0,
                             learning.np.zeros((3, 4)), 0.01, 0.02, 4.0, 1.0)
    quality = learning.Quality(zeros, zeros, zeros, zeros, zeros)
    text = c_tables.render(learning.c_table(robot, "motor", what, quality, 3))
    rows = re.findall(r"\{(\d+), \d+, \d+, \d+\}, +/\* ([ab]\d+):", text)
    assert [int(number) for number, _ in rows] == [(6 if name == "a13" else 0.75) * 65536 for _, name in rows]
    assert len(rows) == 15
    assert ".noise = 65536, /* 8 J */" in re.sub(" +", " ", text)
    assert ".leg_noise = 32768, /* 4 J */" in re.sub(" +", " ", text)
