"""What moving takes of the motors of a skid-steered or differential-drive robot, and what they leave to speed up with."""
import math
from dataclasses import dataclass

from tools.design import skid_odometry

GRAVITY = 9.80665

# Of the lateral resistance (joulepath/skid_steer.h).
LATERAL_AT_PIVOT, LATERAL_PER_RADIUS = 0.925, 0.15

# Of what grip, tipping over or the current permit on the steepest slope.
ACCELERATION_SHARE = 0.25
# Bridges limit the current at motor.current_limit_a themselves; the controller stays below.
CURRENT_SHARE = 0.95


@dataclass(frozen=True)
class Loads:
    """Currents of a side's motor, A, where it drives, and inertias at the wheels."""
    per_force: float         # for 1 N of the tread
    friction: float          # dry
    rolling: float
    climbing: float          # at a slope whose sine is 1
    turning: float           # on the spot
    acceleration: float      # for 1 m/s²
    turn_acceleration: float  # for 1 rad/s²
    inertia: float           # kg·m², of a side with its half of the body


def steering_ratio(robot):
    """Turn of the body over that of the wheels, on the spot."""
    contacts = skid_odometry.tyres(robot)
    return contacts.half_width / (contacts.half_width + contacts.pivot_slip())


def weight(robot):
    return robot.positive("body.mass_kg") * GRAVITY


def back_emf(robot):
    """V·s/rad at the wheels, and N·m/A."""
    return robot.positive("motor.torque_constant_nm_per_a") * robot.positive("motor.gear_ratio")


def caster_share(robot):
    """Of the weight."""
    caster = robot.given("caster.ahead_m", 0.0)
    return robot.number("body.centre_ahead_m") / caster if caster != 0 else 0.0


def loads(robot, steering):
    radius, width = robot.positive("wheel.radius_m"), robot.positive("body.width_m")
    gear = robot.positive("motor.gear_ratio")
    per_torque = 1 / (back_emf(robot) * robot.positive("motor.efficiency"))
    per_force = radius * per_torque
    rotating = robot.given("wheel.axles", 1) * robot.number("wheel.inertia_kg_m2") + gear**2 * robot.number("motor.rotor_inertia_kg_m2")
    caster = caster_share(robot)
    rolls = (1 - caster) * robot.number("ground.rolling") + caster * robot.given("caster.rolling", 0.0)
    wheelbase = robot.given("body.wheelbase_m", 0.0)
    mass = robot.positive("body.mass_kg")
    moment = robot.number("ground.friction") * weight(robot) * wheelbase / 4 / LATERAL_AT_PIVOT
    return Loads(
        per_force=per_force,
        friction=robot.number("motor.friction_nm") * per_torque,
        rolling=rolls * weight(robot) / 2 * per_force,
        climbing=weight(robot) / 2 * per_force,
        turning=moment / width * per_force,
        acceleration=(mass / 2 + rotating / radius**2) * per_force,
        turn_acceleration=(robot.positive("body.yaw_inertia_kg_m2") / width +
                           rotating * width / (2 * steering * radius**2)) * per_force,
        inertia=rotating + mass * radius**2 / 2,
    )


def current_limit(robot):
    return CURRENT_SHARE * robot.positive("motor.current_limit_a")


def tipping_acceleration(robot, slope):
    """m/s², at which the robot on this slope, rad, loses the contact of an axle or its caster; the worse direction."""
    half = robot.given("body.wheelbase_m", 0.0) / 2
    ends = [half, -half, robot.given("caster.ahead_m", 0.0)]
    centre, height = robot.number("body.centre_ahead_m"), robot.number("body.centre_height_m")
    reach = min(max(ends) - centre, centre - min(ends))
    return math.inf if height == 0 else GRAVITY * (reach / height * math.cos(slope) - math.sin(slope))


def acceleration_limit(robot, load):
    """m/s²."""
    slope = math.radians(robot.number("limits.slope_deg"))
    driven = 1 - caster_share(robot)
    grip = GRAVITY * (robot.number("ground.friction") * driven * math.cos(slope) - math.sin(slope))
    spare = current_limit(robot) - load.rolling - load.friction - load.climbing * math.sin(slope)
    found = ACCELERATION_SHARE * min(grip, tipping_acceleration(robot, slope), spare / load.acceleration)
    if found < 0.01:
        raise robot.error("limits.slope_deg", f"{math.degrees(slope):.3g}°: friction, motor.current_limit_a or the "
                          "centre's height leave no acceleration there; correct one of them")
    return found


def turn_acceleration_limit(robot, acceleration):
    """rad/s², for which the tyres push no more than for this acceleration, m/s², and no side accelerates more."""
    half = robot.positive("body.width_m") / 2
    mass, offset = robot.positive("body.mass_kg"), robot.number("body.centre_ahead_m")
    inertia = robot.positive("body.yaw_inertia_kg_m2") + mass * offset**2
    return acceleration / half * min(1, mass * half**2 / inertia)
