"""The odometry of a skid-steered or differential-drive robot: what joulepath/skid_odometry.h is configured with.

Ratio and creep are those of a steady turn on the spot on level ground by the tyre's model of the robot file (lumped LuGre:
force = load · slip/(|slip|/μ + κ |tread speed|/σ0)). With two axles the ratio is 1/(1 + (wheelbase/width)²), whatever the
ground; force and creep depend on its friction.
"""
import math
from dataclasses import dataclass

from tools.design import c_tables

GRAVITY = 9.80665
RELAXATION = 1.2  # of a tread that rolls, over the length of its contact
STEPS_PER_SECOND = 100
STEP_TICKS_MIN, STEP_TICKS_MAX = 6, 32

# How far the ratio may be from the model's: share of the turn, of track and radius, and share of what slip takes of it.
TRACK_DEVIATION = 0.002
SLIP_DEVIATION = 0.003
# What the wheels do not show of the heading: rad/√m of way by slopes; share of a turn, and of what slip takes of it.
WAY_NOISE = 0.03
TURN_NOISE = 0.005
SLIP_NOISE = 0.02
# A gyro's bias wanders by its deviation in so many seconds.
BIAS_MEMORY = 10_000_000
# Grades: a quarter of the largest, and another one after so many metres.
TILT_SHARE = 0.25
TILT_LENGTH = 3.125
# g: vibration that the accelerometer shows.
ACCEL_NOISE = 0.003
# Of ideal sensors: °/s.
BIAS_MIN = 0.01
GYRO_NOISE_MIN = 0.001


# Of the position: share of the way by wheels' radii and by treads that are softer or harder; random walks by grades to the
# left that only turns show, over a metre and over a radian.
WAY_DEVIATION = 0.002
CREEP_SHARE = 0.3
WAY_DRIFT = 2.0
TURN_DRIFT = 0.25


@dataclass(frozen=True)
class Pivot:
    """A steady turn on the spot at 1 rad/s; forces over the weight."""
    moment: float      # of the treads that drive it less what brakes it, m
    force: float       # (right − left) of the sides
    along: float       # growth of the force with slip, s/m
    across: float
    push_along: float   # by the moment that moves load to the right side, 1/m
    push_left: float    # by that which moves load to the axles behind, 1/m
    slip: float        # mean over the treads, m/s
    saturation: float  # share of the treads' yield that is sliding


@dataclass(frozen=True)
class Tyres:
    """Where the robot touches the ground; weights are shares of its own."""
    half_width: float
    places: list       # of the axles, ahead of the middle between them
    shares: list       # of the weight, on each
    friction: float
    relaxation: float  # slip over tread speed, per g
    caster_drag: float
    caster_arm: float

    def turn(self, slip):
        """With treads that slip by `slip` m/s along."""
        moment, force, along, across, slips, sliding = -self.caster_drag * self.caster_arm, 0.0, 0.0, 0.0, 0.0, 0.0
        squares, push = sum(x**2 for x in self.places), 0.0
        for x, share in zip(self.places, self.shares):
            size = math.hypot(slip, x) + 1e-12
            softness = size / self.friction + self.relaxation * (self.half_width + slip)
            fall = 1 / (self.friction * size * softness**2)
            moment += share * (self.half_width * slip - x**2) / softness
            force += share * slip / softness
            along += share * (1 / softness - slip**2 * fall)
            across += share * (1 / softness - x**2 * fall)
            slips += share * size
            sliding += share * size / self.friction / softness
            push += x**2 / squares / softness if squares > 0 else 0.0
        weight = sum(self.shares)
        return Pivot(moment, force, along, across, force / self.half_width, push, slips / weight, sliding / weight)

    def pivot_slip(self):
        """m/s along, at 1 rad/s."""
        low, high = 0.0, 100 * self.half_width
        for _ in range(60):
            middle = (low + high) / 2
            if self.turn(middle).moment < 0:
                low = middle
            else:
                high = middle
        return high


def tyres(robot):
    axles = round(robot.given("wheel.axles", 1))
    ahead = robot.number("body.centre_ahead_m")
    caster = robot.given("caster.ahead_m", 0.0)
    places = [0.0] if axles == 1 else [robot.positive("body.wheelbase_m") * (axle / (axles - 1) - 0.5)
                                       for axle in range(axles)]
    if caster != 0:
        shares = [1 - ahead / caster]
    else:
        squares = sum(x**2 for x in places)
        shares = [1 / axles + ahead * x / squares for x in places]
    return Tyres(robot.positive("body.width_m") / 2, places, shares, robot.positive("ground.friction"),
                 RELAXATION / robot.positive("tyre.contact_length_m") / robot.positive("tyre.stiffness_per_m"),
                 robot.number("caster.rolling") * ahead / caster if caster != 0 else 0.0, abs(caster))


def accel_noise(robot, ticks, step):
    """g: of the mean over a step, and of the acceleration that the encoders tell."""
    count = 2 * math.pi * robot.positive("wheel.radius_m") / robot.positive("encoder.counts_per_turn")
    of_counts = count / math.sqrt(6) / (step**2 * GRAVITY)
    return math.sqrt(ACCEL_NOISE**2 + robot.number("accelerometer.noise_rms_g")**2 / ticks + of_counts**2)


def force_per_ampere(robot):
    """g: force of a side over the weight, before losses."""
    torque = robot.positive("motor.torque_constant_nm_per_a") * robot.positive("motor.gear_ratio")
    return torque / (robot.positive("wheel.radius_m") * robot.positive("body.mass_kg") * GRAVITY)


def odometry_group(robot, to):
    """The member `odometry` of a robot's configuration; `to`: its c_tables.Converter."""
    contacts = tyres(robot)
    slip = contacts.pivot_slip()
    pivot = contacts.turn(slip)
    skidding = slip / (contacts.half_width + slip)  # share of the wheels' turn
    ratio = 1 - skidding
    creep = contacts.relaxation / sum(contacts.shares)
    rate = robot.positive("control.rate_hz")
    ticks = min(max(math.floor(rate / STEPS_PER_SECOND + 0.5), STEP_TICKS_MIN), STEP_TICKS_MAX)
    radius, counts = robot.positive("wheel.radius_m"), robot.positive("encoder.counts_per_turn")
    gyro_noise = math.hypot(robot.number("gyro.noise_rms_dps"), robot.number("gyro.step_dps") / math.sqrt(12))
    height = robot.number("body.centre_height_m")
    tilt = TILT_SHARE * math.sin(math.radians(robot.positive("limits.slope_deg")))
    step = 2.0**-40
    return c_tables.Group("odometry", [
        to.whole("tick_rate", rate, "Hz", 100, 10000),
        to.whole("step_ticks", ticks, "ticks", STEP_TICKS_MIN, STEP_TICKS_MAX),
        to.number("way_per_count", 2 * math.pi * radius / counts, 40, "m", 2**12 * step, 2**30 * step),
        to.number("turn_per_count", radius / (counts * 2 * contacts.half_width), 40, "turn", 2**12 * step, 2**30 * step),
        to.q24("ratio", ratio, "", 0.1, 1.5),
        to.q24("ratio_deviation", TRACK_DEVIATION * ratio + SLIP_DEVIATION * skidding, "", 0.0001, 0.5),
        to.q24("scale_deviation", robot.number("gyro.scale_error"), "", 0, 0.1),
        to.q24("bias_deviation", max(robot.number("gyro.bias_dps"), BIAS_MIN) / 360, "turn/s", 2**-16, 0.1),
        to.whole("bias_memory", BIAS_MEMORY, "s", 1000, 100_000_000),
        to.q24("gyro_noise", max(gyro_noise, GYRO_NOISE_MIN) / 360, "turn/s", 2**-20, 0.1),
        to.q24("way_noise", WAY_NOISE / (2 * math.pi), "turn/√m", 2**-16, 0.1),
        to.q24("turn_noise", TURN_NOISE + SLIP_NOISE * skidding, "", 0.001, 1),
        to.q24("tilt_deviation", tilt, "g", 0.005, 0.5),
        to.q24("tilt_change", tilt * math.sqrt(2 / TILT_LENGTH), "g/√m", 0.001, 1),
        to.q24("accel_noise", accel_noise(robot, ticks, ticks / rate), "g", 0.0005, 0.1),
        to.q24("accel_offset", robot.number("accelerometer.bias_g"), "g", 0, 0.5),
        to.q24("ratio_growth", skidding * (pivot.saturation / (2 * math.pi * pivot.slip))**2, "1/m²", 0, 16),
        to.q24("creep", creep, "per g", 0, 1),
        to.q24("turn_creep_along", 1 / pivot.along, "m/g", 0, 8),
        to.q24("turn_creep_across", 1 / pivot.across, "m/g", 0, 8),
        to.q24("turn_shift_along", height * pivot.push_along / pivot.along, "m/g", 0, 8),
        to.q24("turn_shift_across", height * pivot.push_left / pivot.across, "m/g", 0, 8),
        to.q24("turn_slide_most", max(contacts.places) or 1 / pivot.across, "m", 0, 4),
        to.q24("caster_drag", contacts.caster_drag, "g", 0, 0.2),
        to.q24("turn_force", pivot.force, "g", 0, 2),
        to.q24("force_per_ampere", force_per_ampere(robot), "g/A", 0, 16),
        to.q24("efficiency", robot.positive("motor.efficiency"), "", 0.1, 1),
        to.q24("rolling", robot.number("ground.rolling"), "", 0, 0.5),
        to.q24("way_deviation", WAY_DEVIATION + CREEP_SHARE * creep * tilt, "", 0, 0.1),
        to.q24("way_drift", WAY_DRIFT * creep * tilt, "m/√m", 0, 0.5),
        to.q24("turn_drift", TURN_DRIFT / pivot.across * tilt, "m/√rad", 0, 0.5),
    ])
