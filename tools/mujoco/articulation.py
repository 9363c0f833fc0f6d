"""A robot file as an articulated MuJoCo model: free body, wheels on hinges, gears with play, contacts.

What the robot's file leaves out and a solid body needs is said where it stands: here and nowhere else.
"""
import math
from dataclasses import dataclass, replace

from tools.design import robot_json
from tools.mujoco.ground import GRAVITY

TIMESTEP = 0.0005  # s, the longest

# Of a rubber tyre, where the file is of a robot whose wheels do not slip.
TYRE_FRICTION = 0.8

# The tyre bears on a point: its width only shows.
TYRE_WIDTH = 0.3  # of its radius

# Rubber: how far a tyre sinks in under its load where the file does not say how long its contact is, and how its bounce is
# damped.
SINKING = 0.01  # of the radius
DAMPING = 0.3   # of critical

# MuJoCo's impedance: contacts obey the spring of the tyre and no stiffer one.
IMPEDANCE = 0.5

# Of friction that does not creep: as fast as the step allows.
STICKING = (-1.0, -IMPEDANCE / TIMESTEP / 2)

STIFFEST = 100.0  # friction against the normal force

RELAXATION = 1.2  # of a tread that rolls, over the length of its contact

# Of a robot with steered wheels, whose file is of a robot on a plane: a tyre with its rim, of the robot's mass; the centre
# of mass, of its track; what turns with a wheel that is steered, with the rotor behind its gear, kg m²; the torque of that
# motor, of what the contact takes to turn on its place.
STEERED_WHEEL_MASS = 0.05
STEERED_CENTRE = 0.5
STEERED_INERTIA = 0.01
STEERING_TORQUE = 4.0

# Constraints of a contact: across the ground and along it, and what turns it on its place.
CONTACT_ROWS, SCRUB_ROWS = 3, 4

WALL_GROUP = 4  # of the geoms that are walls

# Rigid stops of the gears' play.
STOP = 'solreflimit="0.001 1" solimplimit="0.98 0.999 0.0001"'

# What MuJoCo needs of a body that has no mass of its own: a rotor whose inertia the joint has.
LEAST_MASS = 1e-5
LEAST_INERTIA = 1e-8


@dataclass(frozen=True)
class Wheel:
    motor: int     # which one turns it: 0 those on the left, 1 on the right; of steered wheels each has its own
    x: float       # of its hub from the body's origin, on the axle, m
    y: float
    radius: float
    mass: float
    spin: float    # inertia about its axle, kg m²
    friction: float
    sinking: float  # under the robot's weight, m
    slip_stiffness: float | None = None  # force over load for each unit of slip of a tyre that creeps as it rolls
    slip_damping: float | None = None    # or force over the velocity of slip, N s/m; neither: it does not creep
    scrub: float | None = None  # torque over load that it takes to turn the contact on its place, m; None: none
    steering: float | None = None  # how far it can be steered to either side, rad; None: it is not

    @property
    def creeps(self):
        return self.slip_stiffness is not None or self.slip_damping is not None

    def creep(self, load, speed):
        """Force over velocity of slip, below the limit of friction, N s/m."""
        return self.slip_damping if self.slip_stiffness is None else load * self.slip_stiffness / speed


@dataclass(frozen=True)
class Chassis:
    """All but the wheels."""
    mass: float
    centre: tuple   # of mass, from the origin, m
    inertia: tuple  # about it, kg m²
    size: tuple     # of the box that shows it, m


@dataclass(frozen=True)
class Caster:
    x: float
    friction: float


@dataclass(frozen=True)
class Robot:
    """What all kinds have in common. The rotor's inertia is at the wheel."""
    chassis: Chassis
    wheels: tuple
    rotor: float
    caster: Caster | None

    @property
    def radius(self):
        return self.wheels[0].radius


def articulated(robot, sinking=None):
    """Of a robot file; `sinking` instead of what its tyres do."""
    kinds = {robot_json.BALANCER: _balancer, robot_json.FOUR_WHEEL: _steered}
    parts = kinds.get(robot.type, _skid)(robot)
    if sinking is None:
        return parts
    return replace(parts, wheels=tuple(replace(wheel, sinking=sinking) for wheel in parts.wheels))


def _balancer(robot):
    number = robot.number
    mass, height = number("body.mass_kg"), number("body.centre_height_m")
    width, depth = number("body.width_m"), number("body.depth_m")
    radius, wheel = number("wheel.radius_m"), number("wheel.mass_kg")
    # As the equations of motion: M L²/3 is a box of twice the centre's height.
    inertia = (mass * (width ** 2 + 4 * height ** 2) / 12, mass * height ** 2 / 3, mass * (width ** 2 + depth ** 2) / 12)
    wheels = tuple(Wheel(side, 0.0, y, radius, wheel, wheel * radius ** 2 / 2, TYRE_FRICTION, SINKING * radius)
                   for side, y in enumerate((width / 2, -width / 2)))
    return Robot(Chassis(mass, (0.0, 0.0, height), inertia, (depth, width * 0.8, 2 * height)), wheels,
                 number("motor.gear_ratio") ** 2 * number("motor.rotor_inertia_kg_m2"), None)


def _skid(robot):
    number = robot.number
    radius, spin = number("wheel.radius_m"), number("wheel.inertia_kg_m2")
    axles = int(robot.given("wheel.axles", 1))
    base = robot.given("body.wheelbase_m", 0.0)
    places = [base * (i / (axles - 1) - 0.5) if axles > 1 else 0.0 for i in range(axles)]
    wheel = 2 * spin / radius ** 2  # a disc with the inertia of the file
    half = number("body.width_m") / 2
    # Of the LuGre tyre whose constants the file has, at small slip.
    slip = number("tyre.stiffness_per_m") * number("tyre.contact_length_m") / RELAXATION
    sinking = radius - math.sqrt(radius ** 2 - number("tyre.contact_length_m") ** 2 / 4)
    wheels = tuple(Wheel(side, x, y, radius, wheel, spin, number("ground.friction"), sinking, slip)
                   for x in places for side, y in enumerate((half, -half)))
    caster = None
    if robot.is_given("caster.ahead_m"):
        caster = Caster(number("caster.ahead_m"), number("caster.rolling"))
    return Robot(_skid_chassis(robot, wheels), wheels,
                 number("motor.gear_ratio") ** 2 * number("motor.rotor_inertia_kg_m2"), caster)


def _skid_chassis(robot, wheels):
    """What is left of mass, centre and yaw inertia of the file when the wheels are taken off."""
    number = robot.number
    ahead, height = number("body.centre_ahead_m"), number("body.centre_height_m")
    total, off = number("body.mass_kg"), sum(wheel.mass for wheel in wheels)
    mass = total - off
    radius = wheels[0].radius
    centre = ((total * ahead - sum(wheel.mass * wheel.x for wheel in wheels)) / mass,
              0.0, (total * height - off * radius) / mass - radius)
    yaw = number("body.yaw_inertia_kg_m2") - mass * (centre[0] - ahead) ** 2 - sum(
        wheel.mass * ((wheel.x - ahead) ** 2 + wheel.y ** 2 + radius ** 2 / 4) for wheel in wheels)
    length, width = number("body.length_m"), number("body.width_m")
    # The file has no inertias of roll and pitch: those of a box of its length and width, twice as high as its centre.
    roll, pitch = (mass * (side ** 2 + 4 * height ** 2) / 12 for side in (width, length))
    return Chassis(mass, centre, (roll, pitch, min(yaw, 0.99 * (roll + pitch))), (length, width * 0.7, height))


def _steered(robot):
    number = robot.number
    radius, total = number("wheel.radius_m"), number("body.mass_kg")
    mass = STEERED_WHEEL_MASS * total
    spin = min(mass * radius ** 2 / 2, number("wheel.inertia_kg_m2"))
    load = total * GRAVITY / 4
    ahead, aside = number("body.wheelbase_m") / 2, number("body.track_m") / 2
    # In the order of enum jp_wheel.
    places = ((ahead, aside), (ahead, -aside), (-ahead, aside), (-ahead, -aside))
    wheels = tuple(Wheel(i, x, y, radius, mass, spin, number("tyre.friction"), SINKING * radius,
                         slip_damping=number("tyre.stiffness_n_s_per_m"), scrub=number("steering.friction_nm") / load,
                         steering=math.radians(number("steering.limit_deg"))) for i, (x, y) in enumerate(places))
    return Robot(_steered_chassis(robot, wheels), wheels, number("wheel.inertia_kg_m2") - spin, None)


def _steered_chassis(robot, wheels):
    """What is left of mass and yaw inertia of the file when the wheels are taken off."""
    number = robot.number
    total, off = number("body.mass_kg"), sum(wheel.mass for wheel in wheels)
    mass, radius, height = total - off, wheels[0].radius, STEERED_CENTRE * number("body.track_m")
    length, width = number("body.length_m"), number("body.width_m")
    yaw = number("body.inertia_kg_m2") - sum(wheel.mass * (wheel.x ** 2 + wheel.y ** 2 + radius ** 2 / 4) + STEERED_INERTIA
                                             for wheel in wheels)
    roll, pitch = (mass * (side ** 2 + 4 * height ** 2) / 12 for side in (width, length))
    return Chassis(mass, (0.0, 0.0, (total * height - off * radius) / mass - radius),
                   (roll, pitch, min(yaw, 0.99 * (roll + pitch))), (length, width, height))


# ---- the model -----------------------------------------------------------------------------------------------------

def _numbers(values):
    return " ".join(f"{value:.9g}" for value in values)


def spring(sinking, load, softness):
    """solref of a tyre that sinks in so far under its load in N, damped as that load on that spring; `softness` is R of
    its contact in MuJoCo, 1/kg."""
    stiffness = IMPEDANCE * softness * load / sinking
    return -stiffness, -2 * DAMPING * stiffness * math.sqrt(sinking / GRAVITY)


def _pairs(robot, ground):
    """What may touch what: each tyre, tyre by tyre, then the caster, with each part of the ground."""
    bearers = [(f"tyre{i}", wheel.friction, wheel.scrub) for i, wheel in enumerate(robot.wheels)]
    if robot.caster is not None:
        bearers.append(("caster", robot.caster.friction, None))
    for name, friction, scrub in bearers:
        dimensions = CONTACT_ROWS if scrub is None else SCRUB_ROWS
        for part in ground.names():
            yield (f'<pair geom1="{part}" geom2="{name}" condim="{dimensions}" '
                   f'friction="{friction} {friction} {scrub or 0:.9g} 0 0" '
                   f'solimp="{IMPEDANCE} {IMPEDANCE} 0.001" solreffriction="{_numbers(STICKING)}"/>')


def _wheel(index, wheel, rotor, backlash):
    """Rotor and gear on a hinge of the body, the wheel on a second one with the gears' play."""
    cross = wheel.mass * wheel.radius ** 2 / 4
    play = "" if backlash == 0 else (
        f'<joint name="play{index}" type="hinge" axis="0 1 0" limited="true" '
        f'range="{_numbers((-backlash / 2, backlash / 2))}" {STOP}/>')
    solid = (f'{play}<inertial pos="0 0 0" mass="{wheel.mass:.9g}" diaginertia="{_numbers((cross, wheel.spin, cross))}"/>'
             f'<geom name="tyre{index}" type="sphere" size="{wheel.radius:.9g}" '
             f'contype="0" conaffinity="0" rgba="0 0 0 0" group="3"/>'
             f'<geom type="cylinder" size="{_numbers((wheel.radius, TYRE_WIDTH * wheel.radius / 2))}" euler="1.5707963 0 0" '
             f'contype="0" conaffinity="0" rgba=".12 .12 .13 1"/>'
             f'<geom type="box" size="{_numbers((wheel.radius * 0.85, TYRE_WIDTH * wheel.radius / 2 * 1.02, wheel.radius * 0.1))}" '
             f'contype="0" conaffinity="0" rgba=".75 .75 .78 1"/>')
    hinge = f'<joint name="motor{index}" type="hinge" axis="0 1 0" armature="{rotor:.9g}"/>'
    place = f'pos="{_numbers((wheel.x, wheel.y, 0))}"'
    if wheel.steering is not None:
        return (f'<body name="fork{index}" {place}><joint name="steer{index}" type="hinge" axis="0 0 1" '
                f'armature="{STEERED_INERTIA}"/><inertial pos="0 0 0" mass="{LEAST_MASS}" '
                f'diaginertia="{_numbers((LEAST_INERTIA,) * 3)}"/><body name="wheel{index}">{hinge}{solid}</body></body>')
    if backlash == 0:
        return f'<body name="wheel{index}" {place}>{hinge}{solid}</body>'
    return (f'<body name="rotor{index}" {place}>{hinge}<inertial pos="0 0 0" mass="{LEAST_MASS}" '
            f'diaginertia="{_numbers((LEAST_INERTIA,) * 3)}"/><body name="wheel{index}">{solid}</body></body>')


def _caster(caster, radius):
    ball = radius / 2
    return (f'<geom name="caster" type="sphere" size="{ball:.9g}" pos="{_numbers((caster.x, 0, ball - radius))}" '
            f'contype="0" conaffinity="0" mass="0" rgba=".6 .6 .6 1"/>')


def _chains(wheels):
    """The wheels of a motor turn together."""
    for motor in sorted({wheel.motor for wheel in wheels}):
        first, *others = [i for i, wheel in enumerate(wheels) if wheel.motor == motor]
        for other in others:
            yield f'<joint joint1="motor{other}" joint2="motor{first}" solref="0.002 1" solimp="0.98 0.999 0.0001"/>'


def model_xml(robot, ground, backlash, accelerometer_height, walls=()):
    """`backlash`: the gears' play at the wheel, rad. A rotor drives the first wheel of its motor. `walls`: more elements of
    the world."""
    chassis = robot.chassis
    box = [side / 2 for side in chassis.size]
    driven = {wheel.motor: i for i, wheel in reversed(list(enumerate(robot.wheels)))}
    wheels = "".join(_wheel(i, wheel, robot.rotor if driven[wheel.motor] == i else 0.0,
                            backlash if driven[wheel.motor] == i else 0.0) for i, wheel in enumerate(robot.wheels))
    return f"""<mujoco>
<compiler angle="radian" inertiafromgeom="false"/>
<option timestep="{TIMESTEP}" gravity="{_numbers(ground.gravity())}" integrator="Euler" cone="elliptic" impratio="{STIFFEST}"
 solver="Newton" iterations="30" tolerance="1e-10"><flag energy="enable" eulerdamp="disable"/></option>
<visual><global offwidth="960" offheight="540"/><map znear="0.01" zfar="100"/></visual>
<asset><texture name="grid" type="2d" builtin="checker" rgb1=".82 .84 .86" rgb2=".74 .77 .8" width="256" height="256"/>
<material name="floor" texture="grid" texrepeat="400 400" texuniform="false"/>
<texture type="skybox" builtin="gradient" rgb1=".95 .97 1" rgb2=".6 .7 .8" width="64" height="64"/></asset>
<worldbody><light pos="0 -2 6" dir="0 .3 -1" directional="true"/>{"".join(ground.geoms())}{"".join(walls)}
<body name="body"><freejoint/>
<inertial pos="{_numbers(chassis.centre)}" mass="{chassis.mass:.9g}" diaginertia="{_numbers(chassis.inertia)}"/>
<geom name="chassis" type="box" size="{_numbers(box)}" pos="{_numbers(chassis.centre)}" contype="0" conaffinity="0" rgba=".15 .4 .7 1"/>
<site name="board" pos="0 0 {accelerometer_height:.9g}"/>{wheels}{_caster(robot.caster, robot.radius) if robot.caster else ""}
</body></worldbody>
<contact>{"".join(_pairs(robot, ground))}</contact>
<equality>{"".join(_chains(robot.wheels))}</equality>
<sensor><gyro site="board"/><accelerometer site="board"/></sensor>
</mujoco>"""
