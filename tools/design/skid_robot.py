#!/usr/bin/env python3
"""Design the controller of a skid-steered or differential-drive robot and write its C configuration.

Robot file → loads of the motors, gains, monitor, limits → src/tables/skid_robot_<name>.c. Prints what it found. Exit
status 2: bad input; nothing was written.
"""
import math
from pathlib import Path

from tools.common import ROOT, ArgumentParser, print_aligned, run, shown_path, write_whole
from tools.design import c_tables, estimator_gains, path_table, robot_json, skid_odometry
from tools.design.skid_loads import (LATERAL_AT_PIVOT, LATERAL_PER_RADIUS, acceleration_limit, back_emf, current_limit,
                                     loads, steering_ratio, turn_acceleration_limit, weight)

TURN = 2 * math.pi

# The loop of a side: both poles at this, in 1/s and as a share of the ticks.
BANDWIDTH = 25.0
BANDWIDTH_SHARE = 1 / 20
# The encoders' tracker: as fast as steps of the counts, seen as current, permit; as shares of the current's limit, of the
# ticks at most and of the loop at least.
TRACKING_NOISE = 0.01
TRACKING_TICKS = 2.0
TRACKING_LOOPS = 4.0
# The heading that a command has missed comes back so fast, 1/s: far slower than the sides.
HEADING_GAIN = 2.0

# A side accelerates for the speed and for the turn at once.
TURN_SHARE = 0.5
# Speeds below this share of the greatest count as creeping.
CREEP_SHARE = 0.02

# A sensor whose reading is this near to its full scale may be clipped.
FULL_SCALE_SHARE = 0.99
IDEAL_GYRO_TURNS_PER_S = 100.0
IDEAL_ACCEL_G = 100.0
OFF_TURNS_PER_S = 127.0
# Of the most that grip can turn the robot in a tick.
GYRO_JUMP = 1.5
NOISE_DEVIATIONS = 6.0
ENCODER_SPEED_MARGIN = 4.0  # ticks until an IMU that failed is told from the wheels, and one
ENCODER_COUNT_MARGIN = 16
VOLTAGE_LOW, VOLTAGE_HIGH = 0.75, 1.25  # of the supply
CURRENT_RESIDUAL = 0.1  # of the stalled current: a warm winding
OVERSPEED = 1.25
CONFIRM_TICKS = 3
RESIDUAL_S = 0.1
# Frozen sensors are told by their noise.
FREEZE_S, FREEZE_TICKS_MIN = 0.05, 10
NOISE_STEPS = 0.5

# Slope and currents are low-passed so, and last so long until they count, s.
SMOOTHING_S = 0.2
SLOPE_S = 0.2
STALL_S = 0.5
CONTRADICTED_S = 0.3
# Of the accelerometer's bias, for the slope.
BIAS_MARGIN = 2.0
STALL_SHARE = 0.8
SPIN_SHARE = 1 / 8  # of lattice.turn_rate_rad_s
SPIN_BIAS = 4.0
CARRIED_SHARE = 0.5

EPSILON = 2**-31


def loop_gains(robot, load):
    """V·s/rad and V/rad. With a motor that is faster than the loop the integral alone closes it."""
    constant = back_emf(robot)
    time = load.inertia * robot.positive("motor.resistance_ohm") / constant**2
    bandwidth = loop_bandwidth(robot)
    if 2 * bandwidth * time > 1:
        return (2 * bandwidth * time - 1) * constant, bandwidth**2 * time * constant
    return 0.0, bandwidth * (1 - bandwidth * time) * constant


def loop_bandwidth(robot):
    """1/s."""
    return min(BANDWIDTH, BANDWIDTH_SHARE * robot.positive("control.rate_hz"))


def tracking_bandwidth(robot):
    """1/s. A step q of the encoder is noise of q/√12, of which a critically damped tracker of bandwidth b leaves
    q √(b³/48 f) of the rate at f ticks a second."""
    rate = robot.positive("control.rate_hz")
    step = 1 / robot.positive("encoder.counts_per_turn")
    noise = TRACKING_NOISE * current_limit(robot) * robot.positive("motor.resistance_ohm") / (back_emf(robot) * TURN)
    quiet = (48 * rate * (noise / step)**2)**(1 / 3)
    return min(max(quiet, TRACKING_LOOPS * loop_bandwidth(robot)), TRACKING_TICKS * rate)


def control_group(robot, load, to):
    rate = robot.positive("control.rate_hz")
    radius, width = robot.positive("wheel.radius_m"), robot.positive("body.width_m")
    around = TURN * radius
    proportional, integral = loop_gains(robot, load)
    angle_gain, rate_gain = estimator_gains.tracking_gains(tracking_bandwidth(robot), rate)
    creep = CREEP_SHARE * robot.positive("limits.speed_m_s")
    return c_tables.Group("control", [
        to.whole("tick_rate", rate, "Hz", 100, 10000),
        to.phase("wheel_per_count", 1 / robot.positive("encoder.counts_per_turn"), "turn"),
        to.q16("tracking_gain", angle_gain, "", 2**-16, 1),
        to.q16("tracking_rate_gain", rate_gain, "1/s", 2**-16, rate),
        to.q24("turns_per_metre", 1 / around, "turn/m", 0.03, 32),
        to.q24("turns_per_radian", width / 2 / around, "turn/rad", 0.001, 4),
        to.q16("back_emf", back_emf(robot) * TURN, "V·s/turn", 2**-16, 255),
        to.q16("resistance", robot.positive("motor.resistance_ohm"), "Ω", 0.001, 100),
        to.q16("current_limit", current_limit(robot), "A", 2**-16, 2047),
        to.q16("rolling", load.rolling + load.friction, "A", 0, 2047),
        to.q24("creep", creep / around, "turn/s", 2**-24, 64),
        to.q16("climbing", load.climbing, "A", 0, 2047),
        to.q16("acceleration", load.acceleration, "A·s²/m", 0, 2047),
        to.q16("turn_acceleration", load.turn_acceleration, "A·s²/rad", 0, 2047),
        to.q16("turning", load.turning, "A", 0, 2047),
        to.q24("turning_decrease", LATERAL_PER_RADIUS / LATERAL_AT_PIVOT / width, "rad/m", 0, 8),
        to.q24("turning_creep", 2 * creep / width, "rad/s", 0.0001, 1),
        to.q24("braking", robot.positive("motor.efficiency")**2, "", 0, 1),
        to.q16("proportional", proportional * TURN, "V·s/turn", 0, 2047),
        to.q16("integral", integral * TURN, "V/turn", 2**-16, 32767),
    ])


def gyro_jump(robot):
    """turn/s in a tick: all grip turns the robot, or it drives at full speed over the top of its steepest slope."""
    if robot.number("gyro.full_scale_dps") == 0:
        return OFF_TURNS_PER_S
    moment = robot.number("ground.friction") * weight(robot) * robot.positive("body.width_m") / 2
    turning = moment / robot.positive("body.yaw_inertia_kg_m2") / robot.positive("control.rate_hz")
    length = max(robot.given("body.wheelbase_m", 0.0), abs(robot.given("caster.ahead_m", 0.0)))
    slope = math.radians(robot.number("limits.slope_deg"))
    tilting = 2 * math.sin(slope) * robot.positive("limits.speed_m_s") / length
    noise = NOISE_DEVIATIONS * robot.number("gyro.noise_rms_dps") / 360
    return min(max(GYRO_JUMP * turning, tilting) / TURN + noise, OFF_TURNS_PER_S)


def encoder_jump(robot):
    """Counts a tick that no wheel can make."""
    free = robot.positive("supply.voltage_v") / back_emf(robot) / TURN
    counts = free * robot.positive("encoder.counts_per_turn") / robot.positive("control.rate_hz")
    return math.ceil(ENCODER_SPEED_MARGIN * counts) + ENCODER_COUNT_MARGIN


def freeze_ticks(robot):
    """0: readings repeat themselves while the robot stands."""
    moves = all(robot.number(f"{sensor}.noise_rms_{unit}") >= NOISE_STEPS * robot.number(f"{sensor}.step_{unit}") > 0
                for sensor, unit in (("gyro", "dps"), ("accelerometer", "g")))
    return max(round(FREEZE_S * robot.positive("control.rate_hz")), FREEZE_TICKS_MIN) if moves else 0


def accelerometer_margin(robot):
    """g."""
    return (BIAS_MARGIN * abs(robot.number("accelerometer.bias_g")) + abs(robot.number("accelerometer.scale_error")) +
            robot.number("accelerometer.noise_rms_g"))


def tilt_limit(robot):
    """rad."""
    steepest = math.sin(math.radians(robot.number("limits.slope_deg"))) + accelerometer_margin(robot)
    return math.asin(min(steepest, 1))


def monitor_group(robot, to):
    rate = robot.positive("control.rate_hz")
    supply, resistance = robot.positive("supply.voltage_v"), robot.positive("motor.resistance_ohm")
    accel = robot.number("accelerometer.full_scale_g") * FULL_SCALE_SHARE or IDEAL_ACCEL_G
    gyro = robot.number("gyro.full_scale_dps") / 360 * FULL_SCALE_SHARE or IDEAL_GYRO_TURNS_PER_S
    around = TURN * robot.positive("wheel.radius_m")
    residual = CURRENT_RESIDUAL * supply / resistance + NOISE_DEVIATIONS * robot.number("current_sense.noise_rms_a")
    return c_tables.Group("monitor", [
        to.q24("tilt_limit", tilt_limit(robot) / TURN, "turn", 0.01, 0.25),
        to.q24("gyro_limit", gyro, "turn/s", 2**-24, 127),
        to.q24("gyro_jump", gyro_jump(robot), "turn/s", 2**-24, 127),
        to.q24("accel_limit", accel, "g", 1 + 2**-24, 127),
        to.whole("encoder_jump", encoder_jump(robot), "counts a tick", 1, 2**31 - 1),
        to.q16("current_limit", robot.positive("current_sense.full_scale_a") * FULL_SCALE_SHARE, "A", 2**-16, 32767),
        to.q16("voltage_min", VOLTAGE_LOW * supply, "V", 2**-16, 1000),
        to.q16("voltage_max", VOLTAGE_HIGH * supply, "V", 2**-16, 1000),
        to.q16("motor_resistance", resistance, "Ω", 0.01, 32767),
        to.q16("back_emf", back_emf(robot) * TURN, "V·s/turn", 2**-16, 255),
        to.q16("half_track", 1, "", 1, 1),
        to.q24("wheel_rate_limit", OVERSPEED * robot.positive("limits.speed_m_s") / around, "turn/s", 2**-24, 127),
        to.q16("current_residual", residual, "A", 2**-16, 32767),
        to.whole("confirm_ticks", CONFIRM_TICKS, "ticks", 1, 65535),
        to.whole("freeze_ticks", freeze_ticks(robot), "ticks", 0, 65535),
        to.whole("residual_ticks", calls(robot, RESIDUAL_S), "of every second tick", 1, 65535),
    ])


def calls(robot, seconds):
    """Of what every second tick does."""
    return max(round(seconds * robot.positive("control.rate_hz") / 2), 1)


def stall_current(robot):
    """A: the least that the motor takes at full voltage when it does not turn."""
    by_voltage = VOLTAGE_LOW * robot.positive("supply.voltage_v") / robot.positive("motor.resistance_ohm")
    return STALL_SHARE * min(current_limit(robot), by_voltage)


def spin_rate(robot):
    """turn/s."""
    turning = SPIN_SHARE * robot.positive("lattice.turn_rate_rad_s") / TURN
    noise = (SPIN_BIAS * abs(robot.number("gyro.bias_dps")) + NOISE_DEVIATIONS * robot.number("gyro.noise_rms_dps")) / 360
    return max(turning, noise)


def wheels_group(robot, load, to):
    radius, width = robot.positive("wheel.radius_m"), robot.positive("body.width_m")
    slope = math.radians(robot.number("limits.slope_deg"))
    smoothing = 1 - math.exp(-2 / (SMOOTHING_S * robot.positive("control.rate_hz")))
    noise = NOISE_DEVIATIONS * robot.number("current_sense.noise_rms_a")
    return c_tables.Group("wheels", [
        to.q24("upright", math.cos(slope) - accelerometer_margin(robot), "g", 0, 1),
        to.q31("smoothing", smoothing, "", EPSILON, 1 - EPSILON),
        to.q16("stall_current", stall_current(robot), "A", 2**-16, 2047),
        to.q24("stall_rate", CREEP_SHARE * robot.positive("limits.speed_m_s") / (TURN * radius), "turn/s", 2**-24, 64),
        to.q16("friction", load.friction, "A", 0, 2047),
        to.q16("carried", max(CARRIED_SHARE * load.rolling, load.friction, noise), "A", 2**-16, 2047),
        to.q24("turn_per_wheel", radius / width, "turn/turn", 2**-24, 8),
        to.q24("spin_rate", spin_rate(robot), "turn/s", 2**-24, 64),
        to.whole("slope_calls", calls(robot, SLOPE_S), "of every second tick", 1, 65535),
        to.whole("stall_calls", calls(robot, STALL_S), "of every second tick", 1, 65535),
        to.whole("contradicted_calls", calls(robot, CONTRADICTED_S), "of every second tick", 1, 65535),
    ])


def meter_group(robot, to):
    return c_tables.Group("meter", [
        to.whole("tick_rate", robot.positive("control.rate_hz"), "Hz", 100, 10000),
        to.q16("motor_resistance", robot.positive("motor.resistance_ohm"), "Ω", 0.01, 32767),
        to.q16("electronics_power", robot.positive("electronics.power_w"), "W", 0, 256),
    ])


def limits_group(robot, load, steering, to):
    acceleration = acceleration_limit(robot, load)
    turning = TURN_SHARE * steering * turn_acceleration_limit(robot, acceleration)
    return c_tables.Group("limits", [
        to.q24("speed", robot.positive("limits.speed_m_s"), "m/s", 2**-24, 8),
        to.q24("acceleration", acceleration, "m/s²", 0.01, 64),
        to.q24("turn_acceleration", turning, "rad/s²", 0.01, 64),
    ])


def robot_table(robot):
    """The C table of struct jp_skid_robot_config."""
    to = c_tables.Converter(robot.source)
    steering = steering_ratio(robot)
    load = loads(robot, steering)
    members = [
        c_tables.Member("name", f'"{robot.name}"'),
        skid_odometry.odometry_group(robot, to),
        control_group(robot, load, to),
        monitor_group(robot, to),
        wheels_group(robot, load, to),
        meter_group(robot, to),
        limits_group(robot, load, steering, to),
        c_tables.Group("path", path_table.drive(robot)),
        to.q16("burnt", 1 - robot.number("motor.recuperation"), "", 0, 1),
        to.q24("heading_gain", HEADING_GAIN, "1/s", 0, 16),
    ]
    return c_tables.Table(f"make skid-robot ROBOT={robot.name}", f"sim/robots/{robot.name}.cfg", "",
                          "joulepath/skid_robot.h", "jp_skid_robot_config", f"jp_skid_robot_{robot.name}", members)


def print_design(robot):
    load = loads(robot, steering_ratio(robot))
    proportional, integral = loop_gains(robot, load)
    print(f"{robot.name}: a side's motor\n")
    print_aligned([
        ("rolling and dry friction", f"{load.rolling + load.friction:.3f}", "A"),
        ("climbing limits.slope_deg",
         f"{load.climbing * math.sin(math.radians(robot.number('limits.slope_deg'))):.3f}", "A"),
        ("turning on the spot", f"{load.turning:.3f}", "A"),
        ("limit", f"{current_limit(robot):.3f}", "A"),
        ("acceleration", f"{acceleration_limit(robot, load):.3f}", "m/s²"),
        ("proportional gain", f"{proportional:.3f}", "V·s/rad"),
        ("integral gain", f"{integral:.3f}", "V/rad"),
        ("slope that stops it", f"{math.degrees(tilt_limit(robot)):.2f}", "°"),
    ])
    print()


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument("robot", nargs="?", help="robot file, or the name of one in sim/robots")
    source.add_argument("--robot-json", metavar="FILE", help="output of jp-robot --json=-; - is standard input")
    parser.add_argument("--jp-robot", metavar="PATH", help="the program (default: build/bin/jp-robot)")
    parser.add_argument("--tables", metavar="DIR", type=Path, default=ROOT / "src" / "tables",
                        help="where the C file goes (default: src/tables)")
    return parser.parse_args()


def load_robot(options):
    if options.robot_json:
        return robot_json.load_skid_steer_json(options.robot_json)
    return robot_json.load_skid_steer(robot_json.robot_path(options.robot), options.jp_robot)


def main():
    options = arguments()
    robot = load_robot(options)
    path = options.tables / f"skid_robot_{robot.name}.c"
    text = c_tables.render(robot_table(robot))
    print_design(robot)
    write_whole(path, text)
    print(f"wrote {shown_path(path)}")
    return 0


if __name__ == "__main__":
    run(main)
