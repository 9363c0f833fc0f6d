"""tools/design/skid_odometry.py: the odometry of skid steer by the tyre's model, and what the tests of the core take for it."""
import json
import math
import os
import re
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT

from tools.design import c_tables, robot_json, skid_odometry

BUILD = Path(os.environ.get("JP_BUILD", ROOT / "build")).resolve()
ROBOTS = ("zhang2018", "burger")

# Prints the members in their order, as JSON, by the check of tests/support.
PROGRAM = """
#include <stdio.h>
#include "tests/support/skid_odometry_config.h"
int main(int count, char **arguments)
{
    struct skid_steer_model model;
    if (count != 2 || !skid_robot_load(arguments[1], &model)) {
        return 1;
    }
    const struct jp_skid_odometry_config config = skid_odometry_config_of(&model);
    const char *field = "";
    const int32_t *members = (const int32_t *)&config;
    for (size_t i = 0; i < sizeof config / sizeof *members; i++) {
        printf("%s%d", i == 0 ? "[" : ", ", (int)members[i]);
    }
    printf("]\\n");
    return jp_skid_odometry_check(&config, &field) != JP_OK;
}
"""


def robot(name):
    return robot_json.load_skid_steer(ROOT / "sim" / "robots" / f"{name}.cfg", BUILD / "bin" / "jp-robot")


def members(of_robot):
    group = skid_odometry.odometry_group(of_robot, c_tables.Converter(of_robot.source))
    return {member.name: int(member.value.rstrip("U")) for member in group.members}


def number(of_robot, name):
    return members(of_robot)[name] / 2**24


@pytest.fixture(scope="module", name="program")
def fixture_program(tmp_path_factory):
    folder = tmp_path_factory.mktemp("skid_odometry")
    source, program = folder / "print.c", folder / "print"
    source.write_text(PROGRAM)
    libraries = [BUILD / "host" / f"lib{name}.a" for name in ("sim", "can", "joulepath_float", "joulepath")]
    subprocess.run(["gcc", "-std=c11", "-D_GNU_SOURCE", "-I", ROOT / "include", "-I", ROOT, source, *libraries,
                    "-lconfig", "-lm", "-o", program], check=True)
    return program


@pytest.mark.parametrize("name", ROBOTS)
def test_it_makes_what_the_tests_of_the_core_take(name, program):
    printed = json.loads(subprocess.run([program, ROOT / "sim" / "robots" / f"{name}.cfg"], capture_output=True,
                                        check=True).stdout)
    made = members(robot(name))
    assert len(made) == len(printed)
    for (member, value), expected in zip(made.items(), printed):
        assert abs(value - expected) <= 1, member


def test_members_stand_in_the_order_of_the_header():
    header = (ROOT / "include" / "joulepath" / "skid_odometry.h").read_text("utf-8")
    struct = re.search(r"struct jp_skid_odometry_config \{(.*?)\n\};", header, re.DOTALL)[1]
    assert list(members(robot("burger"))) == re.findall(r"^    \w+ (\w+);", struct, re.MULTILINE)


def test_two_axles_have_the_ratio_of_their_base():
    zhang = robot("zhang2018")
    for friction in (0.2, 0.69, 1.5):
        varied = zhang.varied({"ground.friction": friction, "tyre.stiffness_per_m": 300 * friction})
        assert number(varied, "ratio") == pytest.approx(1 / (1 + (0.5 / 0.7)**2), abs=1e-6)


def test_slippery_ground_lets_a_turn_creep_further():
    zhang = robot("zhang2018")
    slippery = zhang.varied({"ground.friction": 0.345})
    assert number(slippery, "turn_creep_across") > 1.7 * number(zhang, "turn_creep_across")
    assert number(slippery, "turn_force") < 0.6 * number(zhang, "turn_force")


def test_differential_drive_turns_nearly_by_its_track():
    burger = robot("burger")
    assert 0.99 < number(burger, "ratio") < 1
    assert number(burger, "ratio_deviation") < 0.0025
    assert number(burger, "caster_drag") == pytest.approx(0.05 * 0.029 / 0.081, rel=1e-5)


def test_third_axle_slips_more():
    zhang = robot("zhang2018")
    assert number(zhang.varied({"wheel.axles": 3}), "ratio") > number(zhang, "ratio")


def test_load_that_is_ahead_loads_the_front_axle():
    tyres = skid_odometry.tyres(robot("zhang2018").varied({"body.centre_ahead_m": 0.1}))
    assert tyres.shares == pytest.approx([0.3, 0.7])


def test_steps_take_ten_milliseconds_where_ticks_permit():
    zhang = robot("zhang2018")
    ticks = {rate: members(zhang.varied({"control.rate_hz": rate}))["step_ticks"] for rate in (100, 500, 1000, 10000)}
    assert ticks == {100: 6, 500: 6, 1000: 10, 10000: 32}


def test_ideal_sensors_leave_some_noise():
    zhang = robot("zhang2018").varied({"gyro.bias_dps": 0, "gyro.noise_rms_dps": 0, "gyro.step_dps": 0})
    assert number(zhang, "bias_deviation") == pytest.approx(0.01 / 360, rel=1e-2)
    assert number(zhang, "gyro_noise") > 0
    assert math.isclose(number(zhang, "accel_noise"), number(robot("zhang2018"), "accel_noise"))
