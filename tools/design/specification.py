"""The settings of a balancer's controller that its robot file leaves out, from its constants and its specification.

Without control a robot falls as exp(p t). That rate and the supply's voltage are the units of what is chosen here, so one
rule serves robots of any size. Weights price the angles of wheels and heading, their integrals and the voltage, and
nothing else: that is the least voltage with which the slowest mode decays as the specification asks.
"""
import math

import numpy as np
from scipy import linalg, optimize

from tools.design import closed_loop, linear_model

# Until 2 % of a displacement are left, the slowest mode decays by this exponent.
SETTLED = 4.0
# What settling takes without a specification, in falling times 1/p.
SETTLING = 16.0
# The heading settles faster than travel by this factor: the way bends with it.
YAW_PACE = 2.0
# The integrals take so many times as long as the angles.
INTEGRAL_SLOWER = 5.0

# In falling times 1/p, at least: the reference's shaping, and the tilt toward the accelerometer's vertical.
TRAVEL_SHAPING = 12.0
YAW_SHAPING = 1.0
TILT = 7.0
# s; a step is tried out for so many times the shaping, and the shaping grows by at least this factor.
TRAVEL_SHAPING_MAX = 60.0
STEP_S, STEP_SHAPINGS, SHAPING_STEP = 0.01, 8.0, 1.1
# The gyro's bias is learned so much slower.
BIAS = 15.0
# In falling rates p: the encoders' tracker, slower where their steps would shake the motors. At most this share of the
# control rate.
ENCODER_BANDWIDTHS = (20.0, 35.0)
ENCODER_BANDWIDTH_SHARE = 0.25
# Power that steps of the encoders may make the motors take, by that of the electronics.
STEPS_POWER = 0.002

VOLTAGE_RESERVE = 0.15
VOLTAGE_LOW, VOLTAGE_HIGH = 0.75, 1.25  # of the supply
# Planned leans leave as much again to pushes, and their sine is the angle within this share.
LEAN_SHARE = 0.5
LINEAR_WITHIN = 0.01
# Fallen: beyond what the motors lift by this factor, within these degrees.
TILT_LIMIT = 1.5
TILT_LIMITS = (20.0, 45.0)
# Less, and a doorsill or a draught throws it over.
LEAN_MIN = 3.0  # °

# Of the gyro's range, for planned turns.
GYRO_SHARE = 0.75

# A frozen sensor is told by its noise, which repeats itself less long; it must reach half a step.
FREEZE_S = 0.05
NOISE_STEPS = 0.5
# A gyro's change in a tick: motors and pushes stay below a quarter of it.
GYRO_JUMP = 4.0
NOISE_DEVIATIONS = 6.0
# The current may miss its model by so much of the stalled one: a warm winding.
CURRENT_RESIDUAL = 0.1

# Of the group control, all but its rate.
SETTINGS = ("weights", "input_weight", "yaw_shaping_s", "encoder_bandwidth_rad_s", "tilt_time_constant_s",
            "bias_time_constant_s", "pitch_reserve_share", "tilt_limit_deg", "freeze_ticks", "gyro_jump_dps",
            "current_residual_a", "voltage_min_v", "voltage_max_v", "travel_shaping_s")

# Logarithms of prices, in units of p and the supply, among which the right one is sought from the likeliest on.
UPWARDS = np.log(10) * np.arange(-3, 13)
DOWNWARDS = np.log(10) * np.arange(-3, -13, -1)


def falling_rate(plant):
    """p, 1/s."""
    return float(np.linalg.eigvals(plant.a).real.max())


def recoverable_lean(robot, plant, speed=0.0):
    """rad, at this speed: where full voltage just brings the body back. Beyond it the falling mode grows faster than what
    steady motion leaves of the voltage can push it."""
    poles, covectors = np.linalg.eig(plant.a.T)
    falling = poles.real.argmax()
    covector = covectors[:, falling].real
    voltage = robot.positive("supply.voltage_v") - plant.volts_per_speed * speed
    push = abs(covector @ plant.b.sum(axis=1)) * voltage
    return float(push / (poles[falling].real * abs(covector[linear_model.STATES.index("ψ")])))


def regulator_decay(a, b, price):
    """Of the slowest mode when the first state has this price and the input that of 1."""
    weights = np.zeros(len(a))
    weights[0] = price
    gain = b.T @ linalg.solve_continuous_are(a, b, np.diag(weights), np.eye(1))
    return -np.linalg.eigvals(a - b @ gain).real.max()


def price_of_angle(a, b, decay):
    """The price of the first state at which the slowest mode decays so fast; or None with the fastest that was found. The
    time unit is that of a and b."""
    def excess(logarithm):
        try:
            return regulator_decay(a, b, math.exp(logarithm)) - decay
        except (np.linalg.LinAlgError, ValueError):
            return -decay  # so cheap or so dear that the solver does not tell it from 0 or infinite

    fastest = -decay
    for prices in (UPWARDS, DOWNWARDS):
        found = [excess(prices[0])]
        for before, price in zip(prices, prices[1:]):
            found.append(excess(price))
            if found[-2] * found[-1] <= 0:
                return math.exp(optimize.brentq(excess, before, price, xtol=1e-8)), decay
        fastest = max(fastest, *found)
    return None, decay + fastest


def in_falling_times(plant, angles, input_row, rate, voltage):
    """a and b of these angles and their rates, with time in 1/p and the voltage in the supply's. Two motors share it."""
    states = [*angles, *(angle + 3 for angle in angles)]
    scale = np.array([*(1.0 for _ in angles), *(1 / rate for _ in angles)])
    a = plant.a[np.ix_(states, states)] * scale[:, None] / scale / rate
    b = plant.b[states] @ input_row * scale * voltage / rate / math.sqrt(2)
    return a, b[:, None]


def weights(robot, plant, settling):
    """Of linear_model.STATES, where the input's weight is 1 by the square of the supply's voltage."""
    rate, voltage = falling_rate(plant), robot.positive("supply.voltage_v")
    decay = SETTLED / settling
    result = np.zeros(len(linear_model.STATES))
    for angle, angles, input_row, pace in ((0, (0, 1), np.array([1.0, 1.0]), 1.0),
                                           (2, (2,), np.array([-1.0, 1.0]), YAW_PACE)):
        wanted = pace * decay / rate
        price, fastest = price_of_angle(*in_falling_times(plant, angles, input_row, rate, voltage), wanted)
        if price is None:
            raise robot.error("specification.settling_s", f"{settling:.3g} s: the body falls in {1 / rate:.2g} s, and no "
                              f"voltage lets the wheels settle in less than {SETTLED * pace / (fastest * rate):.3g} s")
        result[angle] = price
        result[angle // 2 + 6] = price * (pace * decay / INTEGRAL_SLOWER)**2
    return [float(f"{weight:.6g}") for weight in result]


def yaw_shaping(robot, plant, rate, reserve):
    """s: the greatest turn takes no more voltage than the greatest speed and the reserve leave, and the gyro measures it.
    A critically damped step turns at most with 1/e of itself by the time, and speeds up with itself by its square."""
    turn = math.radians(robot.number("limits.turn_deg"))
    push = plant.b[linear_model.STATES.index("φ̇")] @ [-1, 1]
    steady, changing = plant.volts_per_turn_rate * turn / math.e, turn / push
    left = ((1 - reserve) * robot.positive("supply.voltage_v")
            - plant.volts_per_speed * robot.positive("limits.speed_m_s"))
    by_voltage = (steady + math.sqrt(steady**2 + 4 * changing * left)) / (2 * left)
    measured = GYRO_SHARE * math.radians(robot.number("gyro.full_scale_dps")) or math.inf
    return max(YAW_SHAPING / rate, by_voltage, turn / math.e / measured)


def encoder_bandwidth(robot, plant, rate, priced):
    """rad/s. A step q of the encoder is noise of q/√12, of which a critically damped tracker of bandwidth b leaves
    q √(b³/48 f) of the rate at f ticks a second. The rate's gain makes voltage of it, and the resistance power."""
    gains = linear_model.regulator(robot, plant, priced, np.eye(2) / robot.positive("supply.voltage_v")**2)
    gain = np.hypot(gains[0, linear_model.STATES.index("θ̇")],
                    gains[0, linear_model.STATES.index("φ̇")] * robot.positive("wheel.radius_m") * math.sqrt(2) /
                    robot.positive("body.width_m"))
    step = math.tau / robot.positive("encoder.counts_per_turn")
    volts = math.sqrt(STEPS_POWER * robot.positive("electronics.power_w") * robot.positive("motor.resistance_ohm") / 2)
    ticks = robot.positive("control.rate_hz")
    quiet = (48 * ticks * (volts / (gain * step))**2)**(1 / 3)
    low, high = (share * rate for share in ENCODER_BANDWIDTHS)
    return float(min(np.clip(quiet, low, high), ENCODER_BANDWIDTH_SHARE * ticks))


def freeze_ticks(robot):
    """0: readings repeat themselves while the robot stands."""
    moves = all(robot.number(f"{sensor}.noise_rms_{unit}") >= NOISE_STEPS * robot.number(f"{sensor}.step_{unit}") > 0
                for sensor, unit in (("gyro", "dps"), ("accelerometer", "g")))
    return round(FREEZE_S * robot.positive("control.rate_hz")) if moves else 0


def gyro_jump(robot, plant):
    """°/s; 0, off, for an ideal gyro."""
    if robot.number("gyro.full_scale_dps") == 0:
        return 0.0
    acceleration = abs(plant.b[linear_model.STATES.index("ψ̇")].sum()) * robot.positive("supply.voltage_v")
    change = math.degrees(acceleration) / robot.positive("control.rate_hz")
    return GYRO_JUMP * change + NOISE_DEVIATIONS * robot.number("gyro.noise_rms_dps")


def current_residual(robot):
    """A."""
    stalled = robot.positive("supply.voltage_v") / robot.positive("motor.resistance_ohm")
    return CURRENT_RESIDUAL * stalled + NOISE_DEVIATIONS * robot.number("current_sense.noise_rms_a")


def check_strength(robot, plant, reserve):
    """The motors reach the speed that is asked for, and there still lift the body."""
    speed, turn_rate = robot.positive("limits.speed_m_s"), robot.positive("limits.turn_rate_rad_s")
    needed = plant.volts_per_speed * speed + plant.volts_per_turn_rate * turn_rate
    given = (1 - reserve) * robot.positive("supply.voltage_v")
    if needed > given:
        raise robot.error("limits", f"{speed:.3g} m/s with {turn_rate:.3g} rad/s takes {needed:.3g} V, and {given:.3g} V "
                          "are left beside the reserve for balance: slower, or a lower gear")
    lean = math.degrees(recoverable_lean(robot, plant, speed))
    if lean < LEAN_MIN:
        raise robot.error("motor, supply", f"at {speed:.3g} m/s the motors at full voltage just lift the body from "
                          f"{lean:.2g}°; it takes {LEAN_MIN:g}° or more: more torque, a lower or lighter body, or slower")


def tilt_limit(robot, plant):
    """rad."""
    found = float(np.clip(TILT_LIMIT * math.degrees(recoverable_lean(robot, plant)), *TILT_LIMITS))
    return math.radians(robot.given("control.tilt_limit_deg", found))


def largest_lean(robot, plant):
    """rad, of planned changes of the speed."""
    if robot.is_given("specification.lean_deg"):
        return math.radians(robot.positive("specification.lean_deg"))
    return min(tilt_limit(robot, plant) / 2, math.sqrt(6 * LINEAR_WITHIN),
               LEAN_SHARE * recoverable_lean(robot, plant, robot.positive("limits.speed_m_s")))


def travel_shaping(robot, plant, found):
    """s: a step to the greatest speed leans the closed loop no more than it may, and longer than the loop itself takes.
    found: the other settings."""
    speed, lean = robot.positive("limits.speed_m_s"), largest_lean(robot, plant)
    shaping = TRAVEL_SHAPING / falling_rate(plant)
    while shaping <= TRAVEL_SHAPING_MAX:
        # Settings that the file gives are tried as they are.
        tried = robot.varied({f"control.{key}": value for key, value in found.items()
                              if not robot.is_given(f"control.{key}")} | {"control.travel_shaping_s": shaping})
        stride = round(STEP_S * robot.positive("control.rate_hz"))
        leans = closed_loop.travel_step(tried, linear_model.design(tried).gains, STEP_SHAPINGS * shaping, stride)[1]
        most = speed * np.abs(leans).max()
        if most <= lean:
            return shaping
        shaping *= max(SHAPING_STEP, most / lean)
    raise robot.error("limits.speed_m_s", f"{speed:.3g} m/s: the robot must not lean more than {math.degrees(lean):.2g}°, "
                      f"and so takes more than {TRAVEL_SHAPING_MAX:g} s to speed up; slower, or stronger motors")


def tilt_time_constant(robot, rate):
    """s. Before it is learned the gyro's bias tilts the estimate by itself times this; a change of the speed, which the
    accelerometer takes for a tilt, by itself over g and this. Both are alike where their sum is least. 0: an ideal gyro
    needs no vertical."""
    bias = math.radians(abs(robot.number("gyro.bias_dps")))
    if bias == 0:
        return 0.0
    return max(TILT / rate, math.sqrt(robot.positive("limits.speed_m_s") / (linear_model.GRAVITY * bias)))


def settings(robot, plant):
    """All of SETTINGS."""
    rate, voltage = falling_rate(plant), robot.positive("supply.voltage_v")
    reserve = robot.given("specification.voltage_reserve", VOLTAGE_RESERVE)
    check_strength(robot, plant, reserve)
    priced = weights(robot, plant, robot.given("specification.settling_s", SETTLING / rate))
    found = {
        "weights": priced,
        "input_weight": 1 / voltage**2,
        "yaw_shaping_s": yaw_shaping(robot, plant, rate, reserve),
        "encoder_bandwidth_rad_s": encoder_bandwidth(robot, plant, rate, priced),
        "tilt_time_constant_s": tilt_time_constant(robot, rate),
        "bias_time_constant_s": BIAS * tilt_time_constant(robot, rate),
        "pitch_reserve_share": reserve,
        "tilt_limit_deg": math.degrees(tilt_limit(robot, plant)),
        "freeze_ticks": freeze_ticks(robot),
        "gyro_jump_dps": gyro_jump(robot, plant),
        "current_residual_a": current_residual(robot),
        "voltage_min_v": VOLTAGE_LOW * voltage,
        "voltage_max_v": VOLTAGE_HIGH * voltage,
    }
    # Last: it is tried out with all others.
    return found | {"travel_shaping_s": travel_shaping(robot, plant, found)}


def completed(robot):
    """The robot with every setting; those that its file gives stay."""
    missing = [key for key in SETTINGS if not robot.is_given(f"control.{key}")]
    if robot.is_given("control.weights") != robot.is_given("control.input_weight"):
        raise robot.error("control", "weights and input_weight stand together; give both, or neither")
    if not missing:
        return robot
    found = settings(robot, linear_model.linear_plant(robot))
    return robot.varied({f"control.{key}": found[key] for key in missing})
