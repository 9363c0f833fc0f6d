"""A drive over LCM, each program a process: jp-plant and jp-ecu on pseudo-terminals, jp-lcm, lcm-logger and
lcm_report.py --live beside them. Then a goal far away, on the way to which jp-lcm is told to stop. To be run in a
network namespace of its own; says in DIR/drive.json how all ended.

    lcm_drive.py DIR X,Y ...
"""
import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import lcm

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("JP_BUILD", ROOT / "build")).resolve()
GROUP, PORT = "239.255.76.67", 7667
URL = f"udpm://{GROUP}:{PORT}?ttl=0"
PATIENCE = 600  # s, for what takes seconds on an idle machine

sys.path.insert(0, str(BUILD / "lcm"))
import jp  # noqa: E402


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

    def said(self, name, text, times=1):
        return (self.directory / f"{name}.out").read_text().count(text) >= times

    def wait(self, name):
        return self.processes[name].wait(PATIENCE)

    def stop(self, name):
        if self.processes[name].poll() is None:
            self.processes[name].send_signal(signal.SIGTERM)
        return self.wait(name)

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


def speed_heard(link):
    """Of the next JP_STATE, m/s."""
    heard = []
    subscription = link.subscribe("JP_STATE", lambda _, data: heard.append(jp.state_t.decode(data).speed))
    link.handle_timeout(1000)
    link.unsubscribe(subscription)
    return heard[-1] if heard else 0


def drive(stage, points):
    plant, gateway = stage.directory / "plant", stage.directory / "gateway"
    log = stage.directory / "drive.lcm"
    stage.start("jp-plant", BUILD / "bin" / "jp-plant", ROOT / "sim" / "scenarios" / "gao2018_mission.cfg", "--bus",
                f"pty:{plant}", "--bus", f"pty:{gateway}", "--pace", "paced", "--host")
    wait_for("pseudo-terminals", lambda: plant.exists() and gateway.exists())
    stage.start("jp-ecu", BUILD / "bin" / "jp-ecu", "--bus", f"slcan:{plant}")
    stage.start("jp-lcm", BUILD / "bin" / "jp-lcm", "--bus", f"slcan:{gateway}", "--lcm", URL)
    stage.start("lcm-logger", "lcm-logger", "--quiet", "--force", f"--lcm-url={URL}", log)
    stage.start("live", sys.executable, "-m", "tools.operate.lcm_report", "--live", URL, stage.directory / "live")
    wait_for("gateway", lambda: stage.said("jp-lcm", "jp-lcm: slcan:"))
    wait_for("listener", lambda: stage.said("live", "listening"))
    wait_for("log", log.exists)
    link = lcm.LCM(URL)
    send_rubbish(link)
    link.publish("JP_ROUTE", route_message(points))
    codes = {"live": stage.wait("live")}
    link.publish("JP_GOAL", goal_message(30, 0))
    # After the route the robot still moves a little before it stands.
    wait_for("motion towards the goal", lambda: stage.said("jp-lcm", "driving", 2) and speed_heard(link) > 0.1)
    # The order in which people stop them: the gateway bids the robot farewell while it is still there.
    for name in ("jp-lcm", "lcm-logger", "jp-plant", "jp-ecu"):
        codes[name] = stage.stop(name)
    return codes


def main():
    stage = Stage(Path(sys.argv[1]))
    try:
        codes = drive(stage, [tuple(map(float, point.split(","))) for point in sys.argv[2:]])
    finally:
        stage.kill_all()
    (stage.directory / "drive.json").write_text(json.dumps(codes))


main()
