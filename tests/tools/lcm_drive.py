"""A drive over LCM, each program a process: jp-plant and jp-ecu on pseudo-terminals, jp-lcm, lcm-logger and
lcm_report.py --live beside them. Then a goal far away, on the way to which jp-lcm is told to stop. Simulated time waits
for jp-lcm and for whoever hears LCM. To be run in a network namespace of its own; says in DIR/drive.json how all ended.

    lcm_drive.py DIR X,Y ...
"""
import contextlib
import json
import os
import select
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import lcm
from lcm_network import ACKNOWLEDGED, FRAME, GROUP, PATIENCE, PORT, URL, open_line, wait_until_taken

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("JP_BUILD", ROOT / "build")).resolve()

sys.path[:0] = [str(ROOT / "tests"), str(BUILD / "lcm")]
import jp  # noqa: E402
from simulated_time import HangUp, SimulatedTime, tick_of  # noqa: E402

LOOK_TICKS = 20  # between two looks at the processes and at LCM
DRIVING = 2     # JP_STATE.robot_state


class LcmTime(SimulatedTime):
    """A tick begins when jp-lcm, on a line of its own, has dealt with its time, and what it sent to LCM was taken. jp-lcm
    opens the channel of its line when it hears LCM."""

    def __init__(self, plant_line, gateway_line):
        super().__init__(plant_line)
        self._gateway, _ = open_line(gateway_line)
        self._parts[self._gateway] = b""
        self._told, self._unanswered = [], 0

    def _overhear(self, text):
        self._told.append(text)

    def _begin(self):
        if self._begun != tick_of(self._next):
            self._tell_gateway(self._next)
            wait_until_taken()
        super()._begin()

    def _tell_gateway(self, sim_time):
        """With a frame behind the time: when that is acknowledged, the time has been dealt with."""
        texts, self._told = [*self._told, sim_time, FRAME], []
        self._unanswered += len(texts)
        try:
            self._send([self._gateway], b"".join(text + b"\r" for text in texts))
            while self._unanswered:
                self._hear_gateway()
        except HangUp:
            self._unanswered = 0  # it was stopped

    def _hear_gateway(self):
        assert select.select([self._gateway], [], [], PATIENCE)[0], f"jp-lcm does not read within {PATIENCE} s"
        *texts, self._parts[self._gateway] = (self._parts[self._gateway] + self._read(self._gateway)).split(b"\r")
        for text in texts:
            if text == ACKNOWLEDGED:
                self._unanswered -= 1
            else:
                self._send([self._plant, *self._ecus], text + b"\r")

    def run_until(self, what, condition):
        """Let ticks pass until a condition, looked at now and then, holds."""
        end = time.monotonic() + PATIENCE
        while not condition():
            if time.monotonic() > end:
                raise SystemExit(f"lcm_drive: no {what} within {PATIENCE} s")
            for _ in range(LOOK_TICKS):
                self.tick()


def wait_for(what, condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            raise SystemExit(f"lcm_drive: no {what} within {PATIENCE} s")
        time.sleep(0.02)


class Stage:
    """The processes of a drive, with what each says in a file."""

    def __init__(self, directory):
        self.directory = directory
        self.processes = {}

    def start(self, name, *command):
        with (self.directory / f"{name}.out").open("wb") as out, (self.directory / f"{name}.err").open("wb") as err:
            self.processes[name] = subprocess.Popen([str(word) for word in command], stdout=out, stderr=err)

    def has_ended(self, name):
        return self.processes[name].poll() is not None

    def tell_to_stop(self, name):
        self.processes[name].send_signal(signal.SIGTERM)

    def stop(self, name):
        self.tell_to_stop(name)
        return self.processes[name].wait(PATIENCE)

    def kill_all(self):
        for process in self.processes.values():
            with contextlib.suppress(ProcessLookupError):
                process.kill()


def goal_message(x, y):
    goal = jp.goal_t()
    goal.point.x, goal.point.y = x, y
    return goal.encode()


def route_message(points):
    route = jp.route_t()
    route.utime = int(time.time() * 1e6)
    route.count = len(points)
    for x, y in points:
        point = jp.point_t()
        point.x, point.y = x, y
        route.points.append(point)
    return route.encode()


def send_rubbish(link):
    """What must not disturb: datagrams that are not of LCM, and messages that are no route. One that ends before its
    channel's name does is sent to jp-lcm alone, in test_lcm.py: lcm 1.5.3 for Python does not survive it."""
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    for packet in (b"", b"x", b"LC02", b"LC03" + b"\xff" * 60, b"\xff" * 1400,
                   b"LC02" + bytes(4) + b"JP_ROUTE" * 100):
        sender.sendto(packet, (GROUP, PORT))
    sender.close()
    sound = route_message([(1, 2), (3, 4)])
    for bad in (b"", sound[:-1], sound + b"\0", bytes(8) + sound[8:], route_message([(float("nan"), 1)]),
                route_message([(600, 1)]), route_message([]), route_message([(1, 1)] * 33)):
        link.publish("JP_ROUTE", bad)
    link.publish("JP_GOAL", sound)
    link.publish("JP_STATE", b"not a state")


class Motion:
    """Of the last JP_STATE."""

    def __init__(self, link):
        self._link, self._heard = link, None
        link.subscribe("JP_STATE", self._hear)

    def _hear(self, _, data):
        with contextlib.suppress(ValueError):  # rubbish
            self._heard = jp.state_t.decode(data)

    def is_towards_goal(self):
        while self._link.handle_timeout(0):
            pass
        state = self._heard
        return state is not None and state.robot_state == DRIVING and state.route_length == 1 and state.speed > 0.1


def start_all(stage, robot, *listeners):
    """The time of the simulation, in which none has passed yet. A listener: (name, *command)."""
    plant, gateway = stage.directory / "plant", stage.directory / "gateway"
    log = stage.directory / "drive.lcm"
    stage.start("jp-plant", BUILD / "bin" / "jp-plant", ROOT / "sim" / "scenarios" / f"{robot}_mission.cfg", "--bus",
                f"pty:{plant}", "--host", f"--patience={PATIENCE}")
    stage.start("jp-lcm", BUILD / "bin" / "jp-lcm", "--bus", f"pty:{gateway}", "--lcm", URL)
    stage.start("lcm-logger", "lcm-logger", "--quiet", "--force", f"--lcm-url={URL}", log)
    for listener in listeners:
        stage.start(*listener)
    wait_for("pseudo-terminals", lambda: plant.exists() and gateway.exists())
    wait_for("log", log.exists)
    passing = LcmTime(plant, gateway)
    stage.start("jp-ecu", BUILD / "bin" / "jp-ecu", "--bus", f"slcan:{passing.new_line()}", "--robot", robot)
    return passing


def drive(stage, points):
    heard = stage.directory / "live"
    passing = start_all(stage, "gao2018", ("live", sys.executable, "-m", "tools.operate.lcm_report", "--live", URL, heard))
    wait_for("listener", heard.exists)
    link = lcm.LCM(URL)
    send_rubbish(link)
    motion = Motion(link)
    link.publish("JP_ROUTE", route_message(points))
    passing.run_until("end of the route", lambda: stage.has_ended("live"))
    link.publish("JP_GOAL", goal_message(30, 0))
    passing.run_until("motion towards the goal", motion.is_towards_goal)
    return stop_all(stage, passing)


def stop_all(stage, passing):
    """How each has ended. The order in which people stop them: the gateway bids the robot farewell while it is still there.
    """
    stage.tell_to_stop("jp-lcm")
    passing.run_until("end of jp-lcm", lambda: stage.has_ended("jp-lcm"))
    stage.stop("lcm-logger")
    stage.tell_to_stop("jp-plant")
    passing.run_until_hang_up()
    stage.stop("jp-ecu")
    return {name: process.wait(PATIENCE) for name, process in stage.processes.items()}


def run(directory, play):
    """Says in drive.json how the programs that play(stage) starts have ended."""
    stage = Stage(directory)
    try:
        codes = play(stage)
    finally:
        stage.kill_all()
    (stage.directory / "drive.json").write_text(json.dumps(codes))


if __name__ == "__main__":
    run(Path(sys.argv[1]), lambda stage: drive(stage, [tuple(map(float, point.split(","))) for point in sys.argv[2:]]))
