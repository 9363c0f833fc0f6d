#!/usr/bin/env python3
"""Design the controller of a robot and write its C configuration.

Robot file → linear plant → LQR gains, estimator, reference, monitor, meter and limits → src/tables/robot_<name>.c.
Prints the gains, the closed loop's poles and its settling time. Exit status 2: bad input; nothing was written.
"""
import math
from pathlib import Path

import numpy as np

from tools.common import ROOT, ArgumentParser, print_aligned, run, shown_path, write_whole
from tools.design import (c_tables, closed_loop, cruise, energy_unit, estimator_gains, linear_model, reversal,
                          robot_json, specification)

TURN = 2 * math.pi
TICKS_PER_SET_POINT = 2  # JP_TICKS_PER_SET_POINT of include/joulepath/trajectory.h

# Share of a sensor's full scale beyond which a reading cannot be told from a clipped one.
FULL_SCALE_SHARE = 0.99
# For an ideal sensor, which has no full scale.
IDEAL_GYRO_TURNS_PER_S = 100.0
IDEAL_ACCEL_G = 100.0
# Nothing that a format holds is beyond these: the check is off.
OFF_TURNS_PER_S = 127.0
OFF_AMPERES = 32767.0
# Encoder steps: twice the wheel speed without load at the supply's voltage, plus what a slow loop may add.
ENCODER_SPEED_MARGIN = 2.0
ENCODER_COUNT_MARGIN = 16
# A runaway is this many times the fastest that steps of the speed make the wheels turn.
OVERSPEED = 1.25
# Of the fastest turn that gyro and wheels allow; the rest is for balance, and for the way back to the path.
TURN_RATE_SHARE = 0.75
# How far a loop stays from −1; 0.5 halves the gain at most, or doubles it.
MARGIN_MIN = 0.4
# V, of a current through the motor: far above any supply (src/balancer/monitor.c).
RESISTIVE_MAX = 32000.0
CONFIRM_TICKS = 3
RESIDUAL_TICKS = 50

EPSILON = 2**-31


def estimator_group(robot, to):
    rate = robot.positive("control.rate_hz")
    counts = robot.positive("encoder.counts_per_turn")
    yaw_share = robot.positive("wheel.radius_m") / robot.positive("body.width_m")
    angle_gain, rate_gain = estimator_gains.tracking_gains(robot.number("control.encoder_bandwidth_rad_s"), rate)
    tilt_gain, bias_gain = estimator_gains.levelling_gains(robot)
    return c_tables.Group("estimator", [
        to.whole("tick_rate", rate, "Hz", 100, 10000),
        to.phase("wheel_per_count", 1 / (2 * counts), "turn"),
        to.phase("yaw_per_count", yaw_share / counts, "turn"),
        to.q16("tracking_gain", angle_gain, "", 2**-16, 1),
        to.q16("tracking_rate_gain", rate_gain, "1/s", 2**-16, rate),
        to.q31("tilt_gain", tilt_gain, "a tick", 0, 1 - EPSILON),
        to.q31("bias_gain", bias_gain, "turn/s from turn, a tick", 0, 1 - EPSILON),
    ])


def check_shaping(robot):
    for key in ("control.travel_shaping_s", "control.yaw_shaping_s"):
        shaping = robot.number(key)
        if shaping != 0 and not 0.01 <= shaping <= 60:
            raise robot.error(key, f"is {shaping:g} s, must be 0 or 0.01 to 60")


def reference_group(robot, turning, to):
    def bandwidth(name, key):
        return to.q16(name, estimator_gains.reciprocal(robot.number(key)), "rad/s", 0, 100)

    return c_tables.Group("reference", [
        to.whole("tick_rate", robot.positive("control.rate_hz"), "Hz", 100, 10000),
        to.q24("turns_per_metre", 1 / (TURN * robot.positive("wheel.radius_m")), "turn/m", 0.1, 16),
        bandwidth("travel_bandwidth", "control.travel_shaping_s"),
        bandwidth("yaw_bandwidth", "control.yaw_shaping_s"),
        to.whole("rest_ticks", turning.rest_ticks(robot), "ticks", 0, 10_000_000),
    ])


def lqr_group(robot, gains, to):
    for row in (gains.common, gains.difference):
        if abs(row).sum() * TURN > 32767:
            raise robot.error("control.weights", "the gains of a row add up to more than 32 767 V per turn")

    def gain(name, unit):
        return to.q16(name, getattr(gains, name) * TURN, unit, -32767, 32767)

    supply = robot.positive("supply.voltage_v")
    reserve = robot.number("control.pitch_reserve_share") * supply
    return c_tables.Group("lqr", [
        to.whole("tick_rate", robot.positive("control.rate_hz"), "Hz", 100, 10000),
        gain("wheel", "V/turn"),
        gain("pitch", "V/turn"),
        gain("wheel_rate", "V·s/turn"),
        gain("pitch_rate", "V·s/turn"),
        gain("wheel_integral", "V/(turn·s)"),
        gain("yaw", "V/turn"),
        gain("yaw_rate", "V·s/turn"),
        gain("yaw_integral", "V/(turn·s)"),
        to.q16("pitch_reserve", reserve, "V", 0, supply),
    ])


def encoder_jump(robot):
    """Counts a tick that no wheel can make."""
    no_load = robot.positive("supply.voltage_v") / (
        robot.positive("motor.gear_ratio") * robot.positive("motor.back_emf_v_s_per_rad"))
    counts = no_load / TURN * robot.positive("encoder.counts_per_turn") / robot.positive("control.rate_hz")
    return math.ceil(ENCODER_SPEED_MARGIN * counts) + ENCODER_COUNT_MARGIN


def gyro_limit(robot):
    return robot.number("gyro.full_scale_dps") / 360 * FULL_SCALE_SHARE or IDEAL_GYRO_TURNS_PER_S


def current_limit(robot):
    """A: what the sensor shows, as long as the voltage that it takes fits the monitor's format."""
    return min(robot.positive("current_sense.full_scale_a") * FULL_SCALE_SHARE,
               RESISTIVE_MAX / robot.positive("motor.resistance_ohm"))


def monitor_group(robot, turning, to):
    jump = robot.number("control.gyro_jump_dps") / 360 or OFF_TURNS_PER_S
    accel = robot.number("accelerometer.full_scale_g") * FULL_SCALE_SHARE or IDEAL_ACCEL_G
    residual = robot.number("control.current_residual_a") or OFF_AMPERES
    half_track = robot.positive("body.width_m") / (2 * robot.positive("wheel.radius_m"))
    back_emf = robot.positive("motor.gear_ratio") * robot.positive("motor.back_emf_v_s_per_rad") * TURN
    voltage_min = robot.positive("control.voltage_min_v")
    voltage_max = robot.positive("control.voltage_max_v")
    supply = robot.positive("supply.voltage_v")
    if not voltage_min < supply < voltage_max:
        raise robot.error("supply.voltage_v", f"{supply:g} V is outside control.voltage_min_v to voltage_max_v")

    return c_tables.Group("monitor", [
        to.q24("tilt_limit", robot.positive("control.tilt_limit_deg") / 360, "turn", 0.01, 0.25),
        to.q24("gyro_limit", gyro_limit(robot), "turn/s", 2**-24, 127),
        to.q24("gyro_jump", jump, "turn/s", 2**-24, 127),
        to.q24("accel_limit", accel, "g", 1 + 2**-24, 127),
        to.whole("encoder_jump", encoder_jump(robot), "counts a tick", 1, 2**32 - 1),
        to.q16("current_limit", current_limit(robot), "A", 2**-16, 32767),
        to.q16("voltage_min", voltage_min, "V", 2**-16, 32767),
        to.q16("voltage_max", voltage_max, "V", 2**-16, 1000),
        to.q16("motor_resistance", robot.positive("motor.resistance_ohm"), "Ω", 0.01, 32767),
        to.q16("back_emf", back_emf, "V·s/turn", 2**-16, 255),
        to.q16("half_track", half_track, "wheel turns a body turn", 2**-16, 64),
        to.q24("wheel_rate_limit", OVERSPEED * turning.wheel_rate_share * robot.positive("limits.speed_m_s") / (
            TURN * robot.positive("wheel.radius_m")), "turn/s", 2**-24, 127),
        to.q16("current_residual", residual, "A", 2**-16, 32767),
        to.whole("confirm_ticks", CONFIRM_TICKS, "ticks", 1, 65535),
        to.whole("freeze_ticks", robot.number("control.freeze_ticks"), "ticks", 0, 10_000_000),
        to.whole("residual_ticks", RESIDUAL_TICKS, "ticks", 1, 65535),
    ])


def meter_group(robot, to):
    return c_tables.Group("meter", [
        to.whole("tick_rate", robot.positive("control.rate_hz"), "Hz", 100, 10000),
        to.q16("motor_resistance", robot.positive("motor.resistance_ohm"), "Ω", 0.01, 32767),
        to.q16("electronics_power", robot.positive("electronics.power_w"), "W", 0, 256),
    ])


def limits_group(robot, to):
    return c_tables.Group("limits", [
        to.q24("speed", robot.positive("limits.speed_m_s"), "m/s", 2**-24, 8),
        to.q24("turn_rate", robot.positive("limits.turn_rate_rad_s"), "rad/s", 2**-24, 8),
        to.q24("turn", math.radians(robot.number("limits.turn_deg")), "rad", 0, math.pi),
        to.q16("duration", robot.positive("limits.duration_s"), "s", 0.1, 16384),
    ])


def array(name, convert, values, units, limit, low=None):
    """Each element within ±limit."""
    members = [convert(f"{name}[{i}]", value, unit, -limit if low is None else low, limit)
               for i, (value, unit) in enumerate(zip(values, units))]
    return c_tables.Array(name, [member.value for member in members], [member.comment for member in members])


def modes_group(modes, rate, to):
    by_turn = np.array([1, TURN, TURN])  # shares of ψ and ψ̇
    shares = np.concatenate([mode.share * by_turn for mode in modes])
    return c_tables.Group("modes", [
        array("decay", to.q16, [mode.decay / math.log(2) for mode in modes], 3 * ["1/s"], 32767, 2**-16),
        array("keep", to.q31, [math.exp(-mode.decay / rate) for mode in modes], 3 * [""], 1 - EPSILON, EPSILON),
        array("share", to.q16, shares, 3 * ["", "m/s per turn", "m per turn"], 1024),
        array("lean", to.q24, [mode.lean / TURN for mode in modes], 3 * ["turn·s/m"], 16),
        array("lean_rate", to.q24, [mode.lean_rate / TURN for mode in modes], 3 * ["turn/m"], 64),
        array("volts", to.q16, [mode.volts for mode in modes], 3 * ["V·s/m"], 4096),
    ])


def turn_rate(robot, turning):
    """turn/s: less than the gyro measures, and than the wheels may turn beside the robot's greatest speed."""
    spare = (OVERSPEED * turning.wheel_rate_share - 1) * robot.positive("limits.speed_m_s")
    by_wheels = spare / (robot.positive("body.width_m") / 2) / TURN
    return TURN_RATE_SHARE * min(gyro_limit(robot), by_wheels)


def trajectory_group(robot, plant, turning, to):
    radius = robot.positive("wheel.radius_m")
    flat = cruise.flat(plant, radius)
    turn = cruise.turn(robot, flat)
    back = cruise.way_back(robot, flat, turn)
    rate = robot.positive("control.rate_hz")
    set_points = rate / TICKS_PER_SET_POINT
    return c_tables.Group("trajectory", [
        to.whole("tick_rate", rate, "Hz", 100, 10000),
        to.q24("turns_per_metre", 1 / (TURN * radius), "turn/m", 0.1, 16),
        to.q24("lag", flat.lag, "s²", 0, 1),
        array("lean", to.q24, flat.lean / TURN, ("turn·s/m", "turn·s²/m"), 16),
        array("volts", to.q16, flat.volts, ("V·s/m", "V·s²/m", "V·s³/m", "V·s⁴/m"), 4096),
        array("turning", to.q16, flat.turning * TURN, ("V·s/turn", "V·s²/turn"), 4096),
        to.q16("voltage", robot.positive("supply.voltage_v") * (1 - robot.number("control.pitch_reserve_share")), "V",
               2**-16, 512),
        to.q24("pitch", specification.largest_lean(robot, plant) / TURN, "turn", 2**-24, 0.125),
        to.q16("blend", turn.blend, "s", 0.05, 60),
        to.q24("turn_pace", turn.pace, "1/s", 0.01, 64),
        to.q24("turn_rate", turn_rate(robot, turning), "turn/s", 0.01, 64),
        to.number("steering", back.steering / set_points, 32, "", 0, 0.25),
        to.q24("aim", back.aim, "turn per turn", 0, 16),
        modes_group(cruise.modes(plant, radius), set_points, to),
    ])


def source_of(robot):
    return f"sim/robots/{robot.name}.cfg"


def robot_table(robot, loop):
    """The C table of struct jp_robot_config."""
    to = c_tables.Converter(robot.source)
    check_shaping(robot)
    turning = reversal.design(robot, loop.gains)
    members = [
        c_tables.Member("name", f'"{robot.name}"'),
        estimator_group(robot, to),
        reference_group(robot, turning, to),
        lqr_group(robot, loop.gains, to),
        monitor_group(robot, turning, to),
        meter_group(robot, to),
        limits_group(robot, to),
        trajectory_group(robot, loop.plant, turning, to),
        to.q24("metres_per_turn", TURN * robot.positive("wheel.radius_m"), "m", 2**-24, 16),
    ]
    return c_tables.Table(f"make gains ROBOT={robot.name}", source_of(robot), "", "joulepath/robot.h",
                          "jp_robot_config", f"jp_robot_{robot.name}", members)


def initial_energy_table(robot, model):
    return c_tables.energy_table(robot.name, model, energy_unit.exponent(robot, model), f"make gains ROBOT={robot.name}", source_of(robot),
                                 f"Predicted from the linear plant; run make identify ROBOT={robot.name}.")


def margins(robot, loop):
    """Of travel and yaw with the estimator and the sensors' delay."""
    delay = robot.given("specification.sensor_delay_s", 0.0)
    found = {axis.name: closed_loop.modulus_margin(axis, delay) for axis in closed_loop.axes(robot, loop.gains)}
    for name, margin in found.items():
        if margin < MARGIN_MIN:
            raise robot.error("specification.sensor_delay_s", f"{delay:g} s: {name} comes within {margin:.2f} of swinging; "
                              f"{MARGIN_MIN:g} are needed: faster sensors, or a longer specification.settling_s")
    return found


def print_design(robot, loop, model):
    gains = loop.gains
    print(f"{robot.name}: LQR gains on reference − measured\n")
    rows = [("state", "row", "V per rad", "V per turn", "unit")]
    for label, row, name, unit in (
            ("θ", "common", "wheel", "V"), ("ψ", "common", "pitch", "V"), ("θ̇", "common", "wheel_rate", "V·s"),
            ("ψ̇", "common", "pitch_rate", "V·s"), ("∫θ", "common", "wheel_integral", "V/s"),
            ("φ", "difference", "yaw", "V"), ("φ̇", "difference", "yaw_rate", "V·s"),
            ("∫φ", "difference", "yaw_integral", "V/s")):
        value = getattr(gains, name)
        rows.append((label, row, f"{value:.4f}", f"{value * TURN:.4f}", f"{unit} per angle"))
    print_aligned(rows)

    print("\nclosed loop\n")
    rows = [("pole, 1/s", "", "damping", "time constant, s")]
    for pole in loop.poles:
        if pole.imag >= 0:
            imaginary = f"± {pole.imag:.4f}i" if pole.imag > 0 else ""
            rows.append((f"{pole.real:.4f}", imaginary, f"{-pole.real / abs(pole):.3f}", f"{-1 / pole.real:.4f}"))
    print_aligned(rows)

    delay = robot.given("specification.sensor_delay_s", 0.0)
    print(f"\nmodulus margin with the estimator, sensors late by {1000 * delay:g} ms\n")
    print_aligned([(name, f"{margin:.2f}", "of 1") for name, margin in margins(robot, loop).items()])

    print("\nlinear prediction\n")
    print_aligned([
        (f"settling time Ts (within {linear_model.SETTLED_VOLTS:g} V, mean)", f"{model.settling_time:.3f}", "s"),
        ("voltage per speed cv", f"{model.voltage_per_speed:.4f}", "V·s/m"),
        ("voltage per turn rate cw", f"{model.voltage_per_turn_rate:.4f}", "V·s/rad"),
        ("energy of a speed step a1", f"{model.a[0]:.3f}", "J·s²/m²"),
        ("energy of a turn step a3", f"{model.a[2]:.3f}", "J/rad²"),
        ("cruising b1", f"{model.b[0]:.3f}", "J·s/m²"),
    ])
    print()


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument("robot", nargs="?", help="robot file, or the name of one in sim/robots")
    source.add_argument("--robot-json", metavar="FILE", help="output of jp-robot --json=-; - is standard input")
    parser.add_argument("--jp-robot", metavar="PATH", help="the program (default: build/bin/jp-robot)")
    parser.add_argument("--tables", metavar="DIR", type=Path, default=ROOT / "src" / "tables",
                        help="where the C files go (default: src/tables)")
    parser.add_argument("--initial-energy", action="store_true",
                        help="also write energy_<name>.c from the linear plant when there is none")
    return parser.parse_args()


def load_robot(options):
    if options.robot_json:
        return robot_json.load_json(options.robot_json)
    return robot_json.load(robot_json.robot_path(options.robot), options.jp_robot)


def main():
    options = arguments()
    robot = load_robot(options)
    loop = linear_model.design(robot)
    files = {options.tables / f"robot_{robot.name}.c": c_tables.render(robot_table(robot, loop))}
    model = linear_model.linear_energy_model(robot, loop)
    energy = options.tables / f"energy_{robot.name}.c"
    if options.initial_energy and not energy.exists():
        files[energy] = c_tables.render(initial_energy_table(robot, model))
    print_design(robot, loop, model)
    for path, text in files.items():
        write_whole(path, text)
        print(f"wrote {shown_path(path)}")
    return 0


if __name__ == "__main__":
    run(main)
