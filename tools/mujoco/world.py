"""A robot in MuJoCo: what the bridges do goes in, what the sensors see comes out, and a ledger says where the joules went.

The ledger: cells = losses of the drive + losses in contacts, stops and dry friction + change of mechanical energy + work
of pushes, of the other sign. MuJoCo's own energy and forces are on one side of it, the drive's equations on the other: what does not
close is the error of the integration.
"""
import math
from dataclasses import dataclass, field

import mujoco
import numpy as np

from tools.design import robot_json
from tools.mujoco.articulation import (CONTACT_ROWS, IMPEDANCE, SCRUB_ROWS, STICKING, STIFFEST, TIMESTEP, articulated,
                                       model_xml, spring)
from tools.mujoco.drives import SIDES, BalancerDrive, SkidDrive
from tools.mujoco.ground import GRAVITY, Ground
from tools.mujoco.instruments import Instruments, duty

FALLEN = 1.0       # rad of pitch or roll against the vertical
LOAD_TIME = 0.02   # s in which dry friction follows the loads
SETTLING_RATE = 20.0  # 1/s, of tyres that creep: what treads of such robots take at their speeds, 7 to 22
SETTLING = 0.5     # s in which a robot that needs no balance sinks into its tyres


@dataclass(frozen=True)
class Conditions:
    """Where and how the robot is, besides its file."""
    ground: Ground = field(default_factory=Ground)
    backlash: float = 0.0  # of the gears at the wheel, rad
    delay: int = 0         # ticks of the inertial sensors
    payload: float = 0.0   # kg at the body's centre of mass
    sinking: float | None = None  # of the tyres, m, instead of what the robot's file says
    seed: int = 1


class Articulated:
    """A robot of a file on its wheels, its contacts and its ledger; `start` is its pose on the plane. What drives and what
    measures are those of its kind."""

    ROWS_MAX = 1000  # of constraints

    balances = held = touched = False  # a balancer is held upright until its bridges first drive

    def __init__(self, robot, conditions, drive, rate, start=(0.0, 0.0, 0.0), walls=()):
        self.rate, self.drive, self.start = rate, drive, start
        self.conditions, self.tick, self.fallen = conditions, 0, False
        self._robot = articulated(robot, conditions.sinking)
        self.xml = model_xml(self._robot, conditions.ground, conditions.backlash,
                             robot.given("accelerometer.height_m", 0.0), walls)
        self.model = mujoco.MjModel.from_xml_string(self.xml)
        self.data = mujoco.MjData(self.model)
        self._substeps = math.ceil(1 / self.rate / TIMESTEP - 1e-9)
        self.model.opt.timestep = 1 / self.rate / self._substeps
        self._find_parts()
        self._load_body(conditions.payload)
        self._push = (0.0, 0.0, 0)
        self.contact = {"normal": 0.0, "slip": 0.0, "gear": 0.0, "stops": 0.0}
        self.pushed = 0.0
        self._place()

    # ---- setting up

    def _find_parts(self):
        model, wheels = self.model, self._robot.wheels
        self._body = model.body("body").id
        self._wheel_bodies = [model.body(f"wheel{i}").id for i in range(len(wheels))]
        self._tyres = [model.geom(f"tyre{i}").id for i in range(len(wheels))]
        self._wheel_of = {geom: i for i, geom in enumerate(self._tyres)}
        joints = [model.joint(f"motor{i}").id for i in range(len(wheels))]
        self._wheel_dofs = [int(model.jnt_dofadr[joint]) for joint in joints]
        motors = sorted({wheel.motor for wheel in wheels})
        first = [next(i for i, wheel in enumerate(wheels) if wheel.motor == motor) for motor in motors]
        self._motor_dofs = [self._wheel_dofs[i] for i in first]
        self._blocked_dofs = list(self._wheel_dofs)  # while it settles
        self._motor_angles = [int(model.jnt_qposadr[joints[i]]) for i in first]
        self._contact_rows = CONTACT_ROWS if wheels[0].scrub is None else SCRUB_ROWS
        self._play = [int(model.jnt_dofadr[model.joint(f"play{i}").id]) if self.conditions.backlash and i in first else None
                      for i in range(len(wheels))]
        first_wheel = [self._wheel_dofs[i] for i in first]
        self._spins = [[dof] + ([self._play[i]] if self._play[i] is not None else []) for i, dof in zip(first, first_wheel)]
        self._loads = [0.0] * len(wheels)
        self._softness = [0.0] * len(wheels)  # of their friction
        self._axes = self.data.xmat[self._body].reshape(3, 3)  # of the body, by column, in the world
        self._power = np.zeros(self.ROWS_MAX)
        self._is_pushed = False

    def _load_body(self, payload):
        """More mass at the same centre, with the inertia of as much more of the body."""
        scale = 1 + payload / self.model.body_mass[self._body]
        self.model.body_mass[self._body] *= scale
        self.model.body_inertia[self._body] *= scale
        mujoco.mj_setConst(self.model, self.data)

    def _place(self):
        """On its wheels."""
        self.data.qpos[2] = self._robot.radius - self._robot.wheels[0].sinking
        self._stand()
        self.data.time = 0.0
        self._start = None

    def _stand(self):
        """As it sinks in."""
        half = self.start[2] / 2
        self.data.qpos[3:7] = (math.cos(half), 0, 0, math.sin(half))
        for _ in range(2):  # the loads, then the springs that are right under them
            self._settle()
            self._set_springs(self._loads)
        self._settle()

    def _set_springs(self, loads):
        """Of the tyres, each by its load; the caster's is the first tyre's."""
        parts = len(self.conditions.ground.names())
        softness = dict(zip((max(pair) for pair in self.data.contact.geom.tolist()),
                           self.data.efc_R[self.data.contact.efc_address].tolist()))
        for i, (geom, load) in enumerate(zip(self._tyres, loads)):
            self.model.pair_solref[i * parts:(i + 1) * parts] = spring(self._robot.wheels[i].sinking, load, softness[geom])
        self.model.pair_solref[len(self._tyres) * parts:] = self.model.pair_solref[0]
        mujoco.mj_forward(self.model, self.data)

    def _settle(self):
        """With its wheels blocked, so that it stays where it is on a slope."""
        self.model.dof_damping[self._blocked_dofs] = 1e3
        self.model.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP)
        for _ in range(int(SETTLING / self.model.opt.timestep)):
            mujoco.mj_step(self.model, self.data)
            self._follow_loads(self.model.opt.timestep)
        self.model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP)
        self.model.dof_damping[self._blocked_dofs] = 0.0
        self.data.qvel[:] = 0.0
        self.data.qpos[0:2] = self.start[0:2]
        mujoco.mj_forward(self.model, self.data)

    # ---- what acts

    def push(self, newton, turning, ticks):
        """A force at the body's centre of mass along its heading, and a torque to the left, N·m."""
        self._push = (newton, turning, self.tick + ticks)

    def step(self):
        """One tick."""
        if self._start is None and not self.held:
            self._start = self.mechanical
        self._set_push()
        self._set_grip()
        for _ in range(self._substeps):
            self._substep()
        self.tick += 1
        self.fallen = self.fallen or self._tilt() > FALLEN

    def _substep(self):
        data, seconds = self.data, self.model.opt.timestep
        before = data.qvel.copy()
        self._act(before.tolist(), seconds)
        mujoco.mj_step(self.model, data)
        self._book((before + data.qvel) / 2, seconds)

    def _act(self, speeds, seconds):
        """The torques of this step, at the speeds of all joints."""
        raise NotImplementedError

    def _follow_loads(self, seconds):
        """N; dry friction follows them within LOAD_TIME."""
        data, share = self.data, seconds / LOAD_TIME
        now = [0.0] * len(self._loads)
        forces = data.efc_force
        for address, geoms in zip(data.contact.efc_address.tolist(), data.contact.geom.tolist()):
            wheel = self._wheel_of.get(geoms[0], self._wheel_of.get(geoms[1]))
            if address >= 0 and wheel is not None:
                now[wheel] += float(forces[address])
                self._softness[wheel] = float(data.efc_R[address + 1]) * self.model.opt.impratio
        self._loads = [old + share * (new - old) for old, new in zip(self._loads, now)]

    def _set_grip(self):
        """Of each tyre: friction by the patch on which it is; how it creeps by how fast it rolls."""
        patches, parts = self.conditions.ground.patches, len(self.conditions.ground.names())
        creeps = self._robot.wheels[0].creeps
        if creeps:
            rates = self._creep_rates()
        for i, wheel in enumerate(self._robot.wheels):
            pairs = slice(i * parts, (i + 1) * parts)
            if patches:
                x, y, _ = self.data.xpos[self._wheel_bodies[i]]
                self.model.pair_friction[pairs, 0:2] = self.conditions.ground.friction_at(x, y, wheel.friction)
            if creeps:
                self.model.pair_solreffriction[pairs, 1] = -IMPEDANCE * rates[i]

    def _creep_rates(self):
        """MuJoCo's friction is force = rate/R · slip below the cone, and settles with the rate; the tyre's is creep ·
        slip. R is one of all contacts: by it the mean of the tyres settles with SETTLING_RATE."""
        fastest, option = -STICKING[1] / IMPEDANCE, self.model.opt
        speeds = [max(abs(float(self.data.qvel[dof])) * wheel.radius, 1e-6)
                  for dof, wheel in zip(self._wheel_dofs, self._robot.wheels)]
        wanted = [softness * wheel.creep(load, speed) for softness, load, wheel, speed in
                  zip(self._softness, self._loads, self._robot.wheels, speeds)]
        option.impratio = min(max(sum(wanted) / len(wanted) / SETTLING_RATE, 1.0), STIFFEST)
        return [min(rate / option.impratio, fastest) for rate in wanted]

    def _set_push(self):
        """Of this tick."""
        newton, turning, until = self._push
        self._is_pushed = self.tick < until
        self.data.xfrc_applied[self._body] = 0.0
        if self._is_pushed:
            ahead = self._axes[0:2, 0] / np.linalg.norm(self._axes[0:2, 0])
            self.data.xfrc_applied[self._body] = (*(newton * ahead), 0, 0, 0, turning)

    # ---- the ledger

    def _book(self, velocity, seconds):
        """Constraints come as equalities, dry friction, limits, and contacts of some rows each."""
        data, contact = self.data, self.contact
        power = self._power[:data.nefc]
        mujoco.mj_mulJacVec(self.model, data, power, velocity)
        power *= data.efc_force
        friction = data.ne + data.nf
        points = friction + data.nl
        if points > 0:
            contact["gear"] -= seconds * float(power[data.ne:friction].sum())
            contact["stops"] -= seconds * float(power[:data.ne].sum() + power[friction:points].sum())
        total, normal = float(power[points:].sum()), float(power[points::self._contact_rows].sum())
        contact["normal"] -= seconds * normal
        contact["slip"] -= seconds * (total - normal)
        if self._is_pushed:
            self.pushed += seconds * float(self._push_power(velocity))

    def _push_power(self, velocity):
        jacobian, turning = np.zeros((3, self.model.nv)), np.zeros((3, self.model.nv))
        mujoco.mj_jacBodyCom(self.model, self.data, jacobian, turning, self._body)
        force = self.data.xfrc_applied[self._body]
        return force[:3] @ (jacobian @ velocity) + force[3:] @ (turning @ velocity)

    @property
    def mechanical(self):
        """Kinetic and potential energy, J."""
        mujoco.mj_energyPos(self.model, self.data)
        mujoco.mj_energyVel(self.model, self.data)
        return float(self.data.energy[0] + self.data.energy[1])

    def ledger(self):
        """J since the start, by name; what remains is `open`."""
        stored = 0.0 if self._start is None else self.mechanical - self._start
        parts = {**self.drive.energies, **{f"{name} contact" if name in ("normal", "slip") else f"{name} dry": value
                                           for name, value in self.contact.items()}}
        return {"cells": self.drive.battery, **parts, "mechanical": stored, "push": -self.pushed,
                "open": self.drive.battery - sum(parts.values()) - stored + self.pushed}

    # ---- what is seen

    def _tilt(self):
        """Of the body against the vertical; of a robot that needs no balance against the ground."""
        up = self.conditions.ground.up() if self.balances else (0.0, 0.0, 1.0)
        return math.acos(min(max(float(np.dot(self._axes[:, 2], up)), -1.0), 1.0))

    def pose(self):
        """x, y in m, heading in rad, on the plane."""
        frame = self._axes
        return float(self.data.qpos[0]), float(self.data.qpos[1]), math.atan2(-frame[0, 1], frame[1, 1])

    def pitch(self):
        """Of the body against the vertical, forward positive."""
        frame, up = self._axes, np.array(self.conditions.ground.up())
        return math.atan2(-float(up @ frame[:, 0]), float(up @ frame[:, 2]))


class World(Articulated):
    """A balancer, or a robot that its sides steer, at rest at the origin; a balancer is held upright until its bridges
    first drive."""

    def __init__(self, robot, conditions):
        self.balances = self.held = robot.type == robot_json.BALANCER
        self._bits = int(robot.number("pwm.bits"))
        self._instruments = Instruments(robot, conditions.seed, conditions.delay)
        self._duties, self._driven = [0.0, 0.0], False
        drive = BalancerDrive if self.balances else SkidDrive
        super().__init__(robot, conditions, drive(robot), robot.number("control.rate_hz"))

    def _stand(self):
        if not self.balances:
            super()._stand()
            return
        up = self.conditions.ground.up()
        pitch = math.atan2(up[0], up[2])
        self.data.qpos[3:7] = (math.cos(pitch / 2), 0, math.sin(pitch / 2), 0)
        mujoco.mj_forward(self.model, self.data)
        weight = float(self.model.body_subtreemass[0]) * GRAVITY * up[2]
        self._set_springs([weight / len(self._tyres)] * len(self._tyres))

    def command(self, enabled, left, right):
        """Duties from −1 to 1 of the bus voltage."""
        self._driven = bool(enabled)
        self._duties = [duty(left, self._bits), duty(right, self._bits)] if enabled else [0.0, 0.0]
        self.held = self.held and not enabled

    def _substep(self):
        if self.held:
            self._drive_balancer([0.0, 0.0], [0.0, 0.0], self.model.opt.timestep)
        else:
            super()._substep()

    def _act(self, speeds, seconds):
        rates = [speeds[dof] for dof in self._motor_dofs]
        if self.balances:
            self._drive_balancer(rates, [speeds[4] + sum(speeds[dof] for dof in dofs) for dofs in self._spins], seconds)
        else:
            self._drive_skid(rates, seconds)

    def _drive_balancer(self, rates, wheels, seconds):
        torques, rolling = self.drive.step(self._duties, self._driven, rates, wheels, seconds)
        axle = self._axes[:, 1]
        for side in SIDES:
            self.data.qfrc_applied[self._motor_dofs[side]] = torques[side]
            self.data.xfrc_applied[self._wheel_bodies[side], 3:6] = rolling[side] * axle

    def _drive_skid(self, rates, seconds):
        self._follow_loads(seconds)
        loads = [sum(load for load, wheel in zip(self._loads, self._robot.wheels) if wheel.motor == side) for side in SIDES]
        torques, gears, rolling = self.drive.step(self._duties, self._driven, rates, loads, seconds)
        for side in SIDES:
            self.data.qfrc_applied[self._motor_dofs[side]] = torques[side]
            self.model.dof_frictionloss[self._motor_dofs[side]] = gears[side] + rolling[side]

    def read(self):
        """The signals of a sample."""
        if self.held:
            up = self.conditions.ground.up()
            inertial = (0.0, 0.0, 0.0, 9.81) if self.balances else (0.0, 0.0, 9.81 * up[0], 9.81 * up[2])
        else:
            gyro, force = self.data.sensordata[0:3], self.data.sensordata[3:6]
            inertial = (gyro[1], gyro[2], force[0], force[2])
        angles = [self.data.qpos[address] for address in self._motor_angles]
        return self._instruments.read(angles, inertial, self.drive.currents, self.drive.bus_voltage)
