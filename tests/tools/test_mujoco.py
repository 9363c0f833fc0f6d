"""tools/mujoco: models of robot files, their ledgers, sensors, the frames of the bus, and bad input."""
import dataclasses
import json
import math
import re
import subprocess

import mujoco
import numpy as np
import pytest
from conftest import BIN, ROOT, assert_one_line_error, run_tool

from tools.common import ToolError
from tools.mujoco import film, mission
from tools.mujoco.articulation import articulated
from tools.mujoco.drive import load_robot
from tools.mujoco.ground import GRAVITY, Ground, Patch, Step
from tools.mujoco.instruments import converted, duty, sensed
from tools.mujoco.lockstep import Message
from tools.mujoco.world import Conditions, World
from tools.operate.can_messages import database

NAMES = ("courier24", "gao2018", "burger", "zhang2018")


def world_of(name, conditions=Conditions()):
    return World(load_robot(name), conditions)


def drive(world, seconds, left, right):
    for _ in range(round(seconds * world.rate)):
        world.command(True, left, right)
        world.step()


def turned(world, seconds, left, right):
    """rad, beyond half a turn too."""
    total, last = 0.0, world.pose()[2]
    for _ in range(round(seconds * world.rate)):
        world.command(True, left, right)
        world.step()
        total += math.remainder(world.pose()[2] - last, math.tau)
        last = world.pose()[2]
    return total


# ---- the model -----------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("name", NAMES)
def test_the_model_has_mass_and_centre_of_the_file(name):
    robot = load_robot(name)
    world = World(robot, Conditions())
    model, data = world.model, world.data
    balances = robot.type == "balancer"
    wheels = sum(wheel.mass for wheel in articulated(robot).wheels)
    total = robot.number("body.mass_kg") + (wheels if balances else 0)
    assert float(model.body_subtreemass[0]) == pytest.approx(total, rel=1e-4)
    if not balances:
        centre = data.subtree_com[world.model.body("body").id] - data.qpos[0:3]
        assert centre[0] == pytest.approx(robot.number("body.centre_ahead_m"), abs=1e-4)
        assert centre[2] + world._robot.radius == pytest.approx(robot.number("body.centre_height_m"), abs=1e-3)


@pytest.mark.parametrize("name", ("burger", "zhang2018"))
def test_the_model_turns_with_the_inertia_of_the_file(name):
    """About the vertical through the centre of mass, spinning wheels apart."""
    robot = load_robot(name)
    world = World(robot, Conditions())
    unit, moment = np.zeros(world.model.nv), np.zeros(world.model.nv)
    unit[5] = 1.0
    mujoco.mj_mulM(world.model, world.data, moment, unit)
    offset = robot.number("body.centre_ahead_m")
    about_origin = robot.number("body.yaw_inertia_kg_m2") + robot.number("body.mass_kg") * offset ** 2
    assert moment[5] == pytest.approx(about_origin, rel=0.02)


@pytest.mark.parametrize("name", NAMES)
def test_tyres_sink_in_as_they_shall(name):
    world = world_of(name, Conditions(sinking=0.002))
    if world.balances:
        world.held = False
        world.model.dof_damping[3:6] = 1e3  # a hand holds it upright
        world.model.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP)
    drive(world, 1.0, 0, 0)
    sunk = world._robot.radius - world.data.xpos[world._wheel_bodies[0]][2]
    assert sunk == pytest.approx(0.002, rel=0.05)


# ---- ledger and physics --------------------------------------------------------------------------------------------

@pytest.mark.parametrize("name, left, right, conditions", [
    ("burger", 0.5, 0.3, Conditions()), ("burger", 0.6, 0.6, Conditions(Ground(math.radians(8)))),
    ("zhang2018", 0.3, -0.3, Conditions()), ("zhang2018", 0.3, 0.2, Conditions(Ground(across=0.1))),
    ("zhang2018", 0.2, 0.2, Conditions(Ground(steps=(Step(0.5, 0.005),)), backlash=0.01))])
def test_the_ledger_closes(name, left, right, conditions):
    world = world_of(name, conditions)
    drive(world, 3.0, left, right)
    ledger = world.ledger()
    assert abs(ledger["open"]) < 0.005 * ledger["cells"]
    assert ledger["cells"] == pytest.approx(sum(ledger.values()) - ledger["cells"], abs=1e-9)


def test_the_ledger_of_a_falling_balancer_closes_and_the_push_is_in_it():
    world = world_of("courier24", Conditions(backlash=0.01))
    world.command(True, 0, 0)
    world.push(5.0, 0.0, 50)
    while not world.fallen and world.tick < 5000:
        world.command(True, 0.02, 0.02)
        world.step()
    ledger = world.ledger()
    assert world.fallen and ledger["push"] < -0.005
    # What it lost of its height has come to something: the terms are large beside what does not close.
    assert abs(ledger["mechanical"]) > 0.5
    assert abs(ledger["open"]) < 0.005 * (ledger["cells"] - ledger["mechanical"])


def test_a_climb_is_paid_for():
    world = world_of("burger", Conditions(Ground(math.radians(8))))
    drive(world, 1.0, 0.8, 0.8)
    x, paid = world.pose()[0], world.ledger()["mechanical"]
    drive(world, 2.0, 0.8, 0.8)
    climbed = (world.pose()[0] - x) * math.sin(math.radians(8))
    assert world.ledger()["mechanical"] - paid == pytest.approx(1.0 * GRAVITY * climbed, rel=0.02)


def test_two_worlds_agree_where_tyres_hardly_slip():
    """jp-skid and MuJoCo, the same duties: what left the cells, how far and how far round."""
    told = json.loads(subprocess.run([BIN / "jp-skid", "burger", "--left=0.5", "--right=0.3", "--seconds=4", "--json=-"],
                                     capture_output=True, text=True, check=True, cwd=ROOT).stdout)
    flat = {key: value for key, value in _leaves(told)}
    world = world_of("burger")
    heading = turned(world, 4.0, 0.5, 0.3)
    assert world.ledger()["cells"] == pytest.approx(_first(flat, "battery"), rel=0.003)
    assert heading == pytest.approx(math.radians(_first(flat, "heading")), rel=0.02)


def _leaves(value, name=""):
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _leaves(inner, key)
    else:
        yield name, value


def _first(flat, word):
    return next(value for key, value in flat.items() if word in key)


def test_ice_lets_a_robot_slide():
    on_ice = Conditions(Ground(math.radians(15), patches=(Patch(0, 0, 50, 0.02),)))
    world = world_of("zhang2018", on_ice)
    drive(world, 1.0, 0, 0)
    assert world.pose()[0] < -0.5
    held = world_of("zhang2018", Conditions(Ground(math.radians(15))))
    drive(held, 1.0, 0, 0)
    assert abs(held.pose()[0]) < 0.05


def test_play_lets_the_motor_turn_before_the_wheel():
    world = world_of("courier24", Conditions(backlash=0.02))
    world.command(True, 0.05, 0.05)
    moved = []
    for _ in range(60):
        world.step()
        motor, play = world.data.qpos[world._motor_angles[0]], world.data.qpos[world._motor_angles[0] + 1]
        moved.append((motor, play))
    assert max(abs(play) for _, play in moved) == pytest.approx(0.01, rel=0.15)


def test_a_payload_is_carried():
    world = world_of("courier24", Conditions(payload=0.7))
    assert float(world.model.body_mass[world.model.body("body").id]) == pytest.approx(4.2)


# ---- sensors -------------------------------------------------------------------------------------------------------

def test_at_rest_sensors_say_so():
    world = world_of("gao2018")
    world.step()
    sample = world.read()
    assert (sample["AccelX"], sample["AccelZ"], sample["PitchRate"]) == (0, 1, 0)
    assert sample["BusVoltage"] == 256 and sample["EncoderLeft"] == 0


def test_a_slope_is_felt():
    robot, slope = load_robot("burger"), math.radians(10)
    world = World(robot, Conditions(Ground(slope)))
    samples = []
    drive(world, 1.0, 0, 0)  # shorted motors hold it
    for _ in range(200):
        world.step()
        samples.append(world.read())
    scale, bias = 1 + robot.number("accelerometer.scale_error"), robot.number("accelerometer.bias_g")
    assert np.mean([sample["AccelX"] for sample in samples]) == pytest.approx(-math.sin(world.pitch()) * scale + bias, abs=0.002)
    assert -world.pitch() == pytest.approx(slope, abs=math.radians(0.3))
    assert np.mean([sample["AccelZ"] for sample in samples]) == pytest.approx(math.cos(slope) * scale + bias, abs=0.002)


def test_late_sensors_say_what_was():
    worlds = [world_of("gao2018", Conditions(delay=delay)) for delay in (0, 3)]
    rates = [[], []]
    for world, told in zip(worlds, rates):
        world.command(True, 0.01, 0.01)
        for _ in range(40):
            world.step()
            told.append(world.read()["PitchRate"])
    assert rates[1][3:] == rates[0][:-3] and rates[0][3:] != rates[0][:-3]


def test_what_is_sensed():
    draw = np.random.default_rng(1)
    assert sensed(0.37, 0, 0.25, 0, draw) == 0.25 and sensed(7, 0, 0, 4, draw) == 4
    assert np.std([sensed(0, 0.5, 0, 0, draw) for _ in range(2000)]) == pytest.approx(0.5, rel=0.1)
    assert converted(0.3, -1, 1, 2) == 0.5 and converted(5, -1, 1, 2) == 0.5 and converted(0.3, -1, 1, 0) == 0.3
    assert duty(0.3, 2) == 0.25 and duty(0.3, 0) == 0.3


# ---- frames --------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("name", ("WheelSensors", "BalanceSensors", "CurrentSensors", "MotorCommand", "SimTime"))
def test_messages_are_those_of_the_dbc(name):
    message, draw = database().get_message_by_name(name), np.random.default_rng(7)
    mine = Message(name)
    for _ in range(200):
        signals = {signal.name: float(draw.integers(signal.minimum / signal.scale, signal.maximum / signal.scale)) *
                   signal.scale for signal in message.signals}
        assert bytes(mine.pack(signals)) == message.encode(signals, scaling=True)
        assert mine.unpack(message.encode(signals)) == pytest.approx(message.decode(message.encode(signals)))


def test_values_beyond_a_message_are_its_ends_and_counts_wrap():
    mine = Message("WheelSensors")
    assert mine.unpack(mine.pack({"EncoderLeft": -1, "BusVoltage": 1e6}, ("EncoderLeft",)))["EncoderLeft"] == 2 ** 22 - 1
    assert mine.unpack(mine.pack({"BusVoltage": 1e6}))["BusVoltage"] == 65535 / 128


# ---- the command ---------------------------------------------------------------------------------------------------

def scenario(folder, text):
    path = folder / "scenario.cfg"
    path.write_text(text)
    return path


@pytest.mark.parametrize("text, reason", [
    ("name = ", "scenario.cfg"), ('name = "a";', "robot: is missing"),
    ('name = "a"; robot = "x.cfg"; waypoints = ([0.0, 0.0, 1.0]);', "the bus carries points alone"),
    ('name = "a"; robot = "x.cfg"; waypoints = ([0.0, 0.0]); within_joules = 3.0;', "within_joules")])
def test_a_bad_scenario_is_refused(tmp_path, text, reason):
    assert_one_line_error(run_tool("mujoco.mission", scenario(tmp_path, text), "--output", tmp_path / "out"), reason)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("option", [("--step", "1"), ("--patch", "1,2,x,0"), ("--slope", "80"), ("--backlash", "-1")])
def test_bad_conditions_are_refused(tmp_path, option):
    assert_one_line_error(run_tool("mujoco.mission", tmp_path / "s.cfg", *option), option[0].strip("-"))


def test_conditions_are_told():
    options = mission.ArgumentParser()
    mission.add_condition_arguments(options)
    given = options.parse_args(["--slope", "5", "--step", "1,5", "--patch", "1,2,3,0.2", "--hard-tyres", "0.1"])
    conditions = mission.conditions_of(given, 3)
    assert conditions == Conditions(Ground(math.radians(5), 0.0, (Step(1.0, 0.005),), (Patch(1, 2, 3, 0.2),)),
                                    sinking=0.0001, seed=3)
    assert re.search("slope 5°, step of 5 mm at x = 1 m, patch of friction 0.2", mission.conditions_text(given))


def test_a_film_is_drawn_where_nothing_renders(tmp_path):
    world = world_of("courier24")
    track = [(0.1 * i, 0, 0, 0, 0.02 * i, 0, world.data.qpos.copy()) for i in range(20)]
    film.save(tmp_path, "<mujoco/", track)  # no library renders that
    how = film.make(tmp_path, lambda: mission.drawn_film(load_robot("courier24"), track))
    assert how == film.DRAWN and (tmp_path / film.FILM_NAME).read_bytes().startswith(b"\x89PNG")


def test_no_film_of_a_folder_without_one(tmp_path):
    with pytest.raises((ToolError, OSError)):
        film.render(tmp_path)


def test_a_robot_may_have_other_tyres():
    robot = load_robot("courier24")
    soft, hard = articulated(robot), articulated(robot, 1e-4)
    assert dataclasses.replace(soft.wheels[0], sinking=1e-4) == hard.wheels[0]
