"""The robot with four steered wheels in MuJoCo, among the walls of a map, with its laser scanner."""
import math

import mujoco
import numpy as np

from tools.mujoco.articulation import STEERED_INERTIA, STEERING_TORQUE, WALL_GROUP
from tools.mujoco.drives import SteeredDrive
from tools.mujoco.instruments import sensed
from tools.mujoco.world import Articulated
from tools.operate.map_stream import FREE

RATE = 100  # ticks in a second, FOUR_WHEEL_RATE_HZ

WALL_HEIGHT = 1.0    # m
SCANNER_HEIGHT = 0.5  # m, within the walls

CURRENT_STEP = 0.005  # A, of the sensor


def rectangles(solid):
    """(first column, first row, columns, rows) of boxes that cover the true cells of a grid and no others: runs of a row,
    joined with equal runs of the rows above."""
    boxes, open_runs = [], {}
    for y, row in enumerate([*solid, np.zeros(solid.shape[1], dtype=bool)]):
        edges = np.flatnonzero(np.diff(np.concatenate(([0], row.astype(int), [0]))))
        runs = {(int(begin), int(end)) for begin, end in zip(edges[::2], edges[1::2])}
        boxes += [(begin, first, end - begin, y - first) for (begin, end), first in open_runs.items()
                  if (begin, end) not in runs]
        open_runs = {run: open_runs.get(run, y) for run in runs}
    return boxes


def walls_of(cell_map):
    """Whatever is not free, as elements of the model."""
    cell, half = cell_map.resolution, WALL_HEIGHT / 2
    for x, y, columns, rows in rectangles(cell_map.cells != FREE):
        yield (f'<geom name="wall{x}_{y}" type="box" size="{columns * cell / 2:.9g} {rows * cell / 2:.9g} {half}" '
               f'pos="{(x + columns / 2) * cell:.9g} {(y + rows / 2) * cell:.9g} {half}" group="{WALL_GROUP}" '
               f'contype="0" conaffinity="0" rgba=".5 .54 .58 1"/>')


class SteeredWorld(Articulated):
    """At rest on a map, at a place from its south-west corner."""

    def __init__(self, robot, conditions, cell_map, place):
        self._targets, self._driven = ([0.0] * 4, [0.0] * 4), False
        self._random = np.random.default_rng(conditions.seed)
        number = robot.number
        self._counts = [int(number(f"encoder.{name}_counts_per_turn")) for name in ("wheel", "steering")]
        self._mount = np.array((number("laser.x_m"), number("laser.y_m")))
        self._range, self._noise = number("laser.range_m"), number("laser.noise_m")
        self.scan_ticks = round(RATE / number("laser.rate_hz"))
        self._bearings = bearings(int(number("laser.beams")), math.radians(number("laser.field_deg")))
        drive = SteeredDrive(robot, STEERED_INERTIA, STEERING_TORQUE * number("steering.friction_nm"))
        super().__init__(robot, conditions, drive, RATE, (place.x, place.y, math.radians(place.heading)), walls_of(cell_map))
        self._chassis = self.model.geom("chassis").id
        self._walls = np.flatnonzero(self.model.geom_group == WALL_GROUP)
        self._paid, self._current = 0.0, self.drive.power / self.drive.bus_voltage
        self.touched = False

    def _find_parts(self):
        super()._find_parts()
        joints = [self.model.joint(f"steer{i}").id for i in range(len(self._robot.wheels))]
        self._steer_dofs = [int(self.model.jnt_dofadr[joint]) for joint in joints]
        self._steer_angles = [int(self.model.jnt_qposadr[joint]) for joint in joints]
        self._blocked_dofs += self._steer_dofs

    # ---- what acts

    def command(self, enabled, speeds, angles):
        """Of the treads in m/s, of steering in rad. Drives that are off are braked, and keep their angles."""
        limit = self.drive.limit
        if enabled:
            self._targets = list(speeds), [min(max(angle, -limit), limit) for angle in angles]
        elif self._driven:
            self._targets = [0.0] * 4, self._angles()
        self._driven = bool(enabled)

    def _angles(self):
        return [float(self.data.qpos[address]) for address in self._steer_angles]

    def _act(self, speeds, seconds):
        self._follow_loads(seconds)
        drives, steers, rolling = self.drive.step(
            self._targets, [speeds[dof] for dof in self._motor_dofs], self._angles(),
            [speeds[dof] for dof in self._steer_dofs], self._loads, seconds)
        self.data.qfrc_applied[self._motor_dofs] = drives
        self.data.qfrc_applied[self._steer_dofs] = steers
        self.model.dof_frictionloss[self._motor_dofs] = rolling

    def step(self):
        super().step()
        watts = (self.drive.battery - self._paid) * self.rate
        self._paid = self.drive.battery
        self._current = CURRENT_STEP * round(watts / self.drive.bus_voltage / CURRENT_STEP)
        self.touched = self.touched or self.clearance(0.0) < 0

    def clearance(self, farthest):
        """From the nearest wall, m, at most `farthest`."""
        away = np.abs(self.model.geom_pos[self._walls, :2] - self.pose()[:2]) - self.model.geom_size[self._walls, :2]
        near = np.hypot(*np.maximum(away, 0.0).T) < farthest + self.model.geom_rbound[self._chassis]
        return min((mujoco.mj_geomDistance(self.model, self.data, self._chassis, wall, farthest, None)
                    for wall in self._walls[near].tolist()), default=farthest)

    # ---- what is seen

    def read(self):
        """Counts of the wheels, angles in turns, V and A."""
        wheel, steering = self._counts
        turns = [self.data.qpos[address] / math.tau for address in self._motor_angles]
        return ([math.floor(turn * wheel) for turn in turns],
                [round(angle / math.tau * steering) / steering for angle in self._angles()],
                self.drive.bus_voltage, self._current)

    def scan(self):
        """Ranges in m; 0: the beam saw nothing."""
        x, y, heading = self.pose()
        mount = np.array(((math.cos(heading), -math.sin(heading)), (math.sin(heading), math.cos(heading)))) @ self._mount
        ahead = heading + self._bearings
        rays = np.column_stack((np.cos(ahead), np.sin(ahead), np.zeros_like(ahead)))
        geoms, ranges = np.zeros(len(ahead), dtype=np.int32), np.zeros(len(ahead))
        groups = np.array([int(group == WALL_GROUP) for group in range(6)], dtype=np.uint8)
        mujoco.mj_multiRay(self.model, self.data, (x + mount[0], y + mount[1], SCANNER_HEIGHT), rays.ravel(), groups, True, -1,
                           geoms, ranges, None, len(ahead), self._range)
        seen = [sensed(value, self._noise, 0.0, 0.0, self._random) if value > 0 else 0.0 for value in ranges.tolist()]
        return [value if 0 < value <= self._range else 0.0 for value in seen]


def bearings(beams, field):
    """Of the beams from the scanner's heading, counterclockwise."""
    if field >= math.tau * (1 - 1e-9):
        return -math.pi + math.tau / beams * np.arange(beams)
    return np.linspace(-field / 2, field / 2, beams)
