"""A robot in MuJoCo, its controller's program and an operator, together for as long as a block lasts."""
import tempfile
from pathlib import Path

from tools.common import ToolError, build_directory
from tools.design import robot_json
from tools.mujoco.lockstep import Ecu, Line, Lockstep, SidesLink
from tools.mujoco.steered_world import SteeredWorld
from tools.mujoco.wheels_link import WheelsLink
from tools.mujoco.world import Conditions, World
from tools.operate.can_client import Operator, RobotError

TRACK_PERIOD = 0.02  # s between samples of what is so


class Fell(RobotError):
    """The robot lies on the ground."""


class Touched(RobotError):
    """The robot has touched a wall."""


def load_robot(robot):
    """By name or file."""
    path = robot_json.robot_path(robot)
    return robot_json.from_text(str(path), robot_json.printed_by(robot_json.default_jp_robot(), str(path), "--json=-"))


class Drive:
    """`track` grows while time passes: (s, x, y, heading, pitch, joules out of the cells, positions of the joints)."""

    def __init__(self, robot, conditions=Conditions(), options=(), log=None, listen=None, ecu_log=None,
                 watch=lambda state: None, place=None):
        """`options` are the controller's; `log` gets seconds, id and bytes of each frame, `listen` each python-can frame
        on its way to the operator or from it; `watch` is the operator's. `place` of a robot with four steered wheels: the
        map, and where it stands on it."""
        is_steered = robot.type == robot_json.FOUR_WHEEL
        self.world = SteeredWorld(robot, conditions, *place) if is_steered else World(robot, conditions)
        link = (WheelsLink if is_steered else SidesLink)(self.world)
        self.track = []
        self._robot, self._options, self._ecu_log = robot, options, ecu_log
        self._line = Line()
        self.bus = Lockstep(self.world, link, self._line, log, self._each_tick, listen, lambda: self._ecu.error())
        self.operator = Operator(self.bus, robot.name, watch, lambda: self.bus.seconds)
        self._period = max(round(TRACK_PERIOD * self.world.rate), 1)

    def __enter__(self):
        self._folder = tempfile.TemporaryDirectory()
        program = build_directory() / "bin" / "jp-ecu"
        if not program.exists():
            raise ToolError(f"{program}: is not there; build it with `make`")
        self._ecu = Ecu(program, self._line, ["--robot", self._robot.name, *self._options],
                        self._ecu_log or Path(self._folder.name) / "ecu.log")
        self._ecu.__enter__()
        return self

    def __exit__(self, *_):
        self._ecu.__exit__()
        self._line.close()
        self._folder.cleanup()

    def _each_tick(self):
        world = self.world
        if world.tick % self._period == 0:
            self.track.append((self.bus.seconds, *world.pose(), world.pitch(), world.drive.battery,
                               world.data.qpos.copy()))
        if world.fallen:
            raise Fell(f"{self._robot.name}: fell in MuJoCo at {self.bus.seconds:.2f} s, x {world.pose()[0]:.2f} m, "
                       f"y {world.pose()[1]:.2f} m")
        if world.touched:
            raise Touched(f"{self._robot.name}: touched a wall in MuJoCo at {self.bus.seconds:.2f} s, x "
                          f"{world.pose()[0]:.2f} m, y {world.pose()[1]:.2f} m")

    def stand(self):
        self.operator.stand()

    def route(self, waypoints):
        """Drive them to the end, and stand."""
        self.operator.drive_route(waypoints)
