"""jp-balance: how far a robot leans and is pushed before it falls, and how it stands."""
import json

import pytest
from conftest import ROOT, assert_one_line_error, run

COURIER = ROOT / "sim/robots/courier24.cfg"


def measured(tmp_path, robot, *options):
    result = run("jp-balance", robot, "--json=-", *options)
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


@pytest.fixture(scope="module")
def courier(tmp_path_factory):
    return measured(tmp_path_factory.mktemp("balance"), COURIER)


def test_the_courier_balances_well(courier):
    assert courier["lean_deg"] >= 30
    assert 3 < courier["push_n_s"] < 12  # a speed of 0.8 to 3 m/s of its 4 kg
    assert 0 < courier["standing_lean_rms_deg"] < 0.05
    assert 0 < courier["standing_voltage_rms_v"] < 0.2
    assert 0 < courier["standing_wander_m"] < 0.01
    assert abs(courier["standing_power_w"]) < 0.01


def test_it_says_the_same_again_and_with_another_noise_nearly_the_same(courier, tmp_path):
    assert measured(tmp_path, COURIER) == courier
    other = measured(tmp_path, COURIER, "--seed=2")
    assert other != courier
    assert other["push_n_s"] == pytest.approx(courier["push_n_s"], rel=0.2)


def test_ideal_sensors_stand_still(tmp_path):
    ideal = measured(tmp_path, ROOT / "sim/robots/gao2018.cfg")
    assert ideal["standing_lean_rms_deg"] < 1e-3 and ideal["standing_wander_m"] < 1e-4


def changed(tmp_path, name, old, new):
    """A file of the courier with other constants under its controller."""
    text = COURIER.read_text()
    assert old in text
    path = tmp_path / f"{name}.cfg"
    path.write_text(text.replace(old, new))
    return path


def test_less_torque_takes_less_of_a_push(courier, tmp_path):
    weak = changed(tmp_path, "weak", "torque_constant_nm_per_a = 0.0225;", "torque_constant_nm_per_a = 0.01;")
    assert measured(tmp_path, weak)["push_n_s"] < 0.85 * courier["push_n_s"]


def test_a_robot_that_cannot_stand_is_named(tmp_path):
    dead = changed(tmp_path, "dead", "torque_constant_nm_per_a = 0.0225;", "torque_constant_nm_per_a = 0.004;")
    result = run("jp-balance", dead)
    assert_one_line_error(result, "courier24: the robot does not stand")


def test_the_table(courier):
    result = run("jp-balance", COURIER)
    for text in ("courier24", ">=   30.00 °", "N·s", "m/s of its mass", "V rms"):
        assert text in result.stdout
