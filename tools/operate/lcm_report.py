#!/usr/bin/env python3
"""Make the results of a drive from what jp-lcm told over LCM: a log of lcm-logger, or live.

Writes DIR/summary.json and the log that it names, which report.py makes a page of. A log gives the same files as
the live run beside which it was made. Exit status 2: bad input, or the drive failed; nothing was written.
"""
import contextlib
import math
import os
import struct
import sys
import tempfile
import time
from pathlib import Path

import lcm

from tools.common import ROOT, ArgumentParser, ToolError, run, shown_path
from tools.report.mission_record import LOG_NAME, SUMMARY_NAME, MissionRecord

LCM_TYPES = Path(os.environ.get("JP_BUILD", ROOT / "build")).resolve() / "lcm"

# Of both a log and a live run, so that their files are the same.
SOURCE = "LCM"

# Values of State in RouteStatus.
ROUTE_DRIVING, ROUTE_DONE, ROUTE_STOPPED = 3, 4, 6

QUIET_MAX = 10  # s without JP_STATE after which the robot counts as gone
TAIL = 0.2      # s of a live record after the route is done: what belongs to its end comes in several messages

US_PER_S = 1e6


def load_types():
    """The message types, as lcm-gen made them from sim/lcm/."""
    sys.path.insert(0, str(LCM_TYPES))
    try:
        import jp
    except ImportError:
        raise ToolError(f"{LCM_TYPES}: no message types; `make all` makes them") from None
    return jp


def known(value):
    return None if math.isnan(value) else value


class Listener:
    """Takes the messages of jp-lcm in the order in which they come, and records the drive."""

    def __init__(self):
        types = load_types()
        self.record = MissionRecord(SOURCE)
        self.bad = 0  # messages that are not of their type
        self.state = None
        self.has_driven = False
        self.done_at = None  # s
        self._handlers = {"JP_STATE": (types.state_t, self._state), "JP_PLAN": (types.plan_t, self._plan),
                          "JP_ENERGY": (types.energy_t, self._energy)}
        self._task_failed = types.state_t.TASK_FAILED
        self._route = None
        self._segments = {}
        self._ended = 0

    def take(self, channel, data):
        if channel not in self._handlers:
            return
        message_type, handle = self._handlers[channel]
        try:
            message = message_type.decode(data)
        except (ValueError, struct.error, IndexError):
            self.bad += 1
            return
        handle(message, message.utime / US_PER_S)

    def is_over(self):
        """The route that was being driven is done, and its end recorded. ToolError: it was stopped, or the task failed."""
        if self.state is None:
            return False
        if self.state.task == self._task_failed:
            raise ToolError(f"{SOURCE}: the drive failed: {self.state.task_reason}")
        if self.has_driven and self.state.route_state == ROUTE_STOPPED:
            raise ToolError(f"{SOURCE}: the robot stopped on its route: Reason {self.state.route_reason} of RouteStatus")
        return self.done_at is not None and self.state.utime / US_PER_S >= self.done_at + TAIL

    def _state(self, state, t):
        self.state = state
        self.has_driven = self.has_driven or state.route_state == ROUTE_DRIVING
        if self.done_at is None and self.has_driven and state.route_state == ROUTE_DONE:
            self.done_at = t
        self.record.pose(t, state.x, state.y, state.heading)
        self.record.motion(t, state.speed, state.turn_rate, state.pitch)
        self.record.reference(t, state.reference_speed, state.reference_turn_rate, state.reference_heading)
        self.record.motors(t, state.voltage_left, state.voltage_right)
        self.record.currents(t, state.current_left, state.current_right)

    def _plan(self, plan, t):
        begins = plan.segment_count <= 1
        if begins:
            self._segments, self._ended = {}, 0
        route = plan.route_id, plan.route_segment, [(point.x, point.y) for point in plan.points]
        if begins or route != self._route:
            self.record.route(route[2])
            self._route = route
        for segment in plan.segments:
            values = tuple(map(known, (segment.energy, segment.speed, segment.turn_rate, segment.turn,
                                       segment.duration)))
            if self._segments.get(segment.index) != values:
                self._segments[segment.index] = values
                self.record.segment_plan(t, segment.index, *values)

    def _energy(self, energy, t):
        self.record.energy_spent(t, energy.spent)
        if energy.segment not in (0, self._ended):
            self.record.segment_result(t, energy.segment, energy.segment_spent, energy.segment_drawn)
        self._ended = energy.segment


def replay(take, path):
    try:
        log = lcm.EventLog(str(path), "r")
    except (OSError, ValueError) as error:
        raise ToolError(f"{path}: {getattr(error, 'strerror', None) or error}") from None
    events = 0
    for event in log:
        events += 1
        take(event.channel, event.data)
    log.close()
    if events == 0:
        raise ToolError(f"{path}: no events in it; lcm-logger writes such logs")


@contextlib.contextmanager
def stderr_kept():
    """LCM says in several lines what is wrong; the function that is yielded gives the first one."""
    with tempfile.TemporaryFile() as kept:
        sys.stderr.flush()
        real = os.dup(sys.__stderr__.fileno())
        os.dup2(kept.fileno(), sys.__stderr__.fileno())

        def first_line():
            kept.seek(0)
            return kept.readline().decode(errors="replace").strip()
        try:
            yield first_line
        finally:
            os.dup2(real, sys.__stderr__.fileno())
            os.close(real)


def open_lcm(url, take, option="--live"):
    """An LCM that hands every message to take(channel, data)."""
    if not url.startswith("udpm://"):
        raise ToolError(f"{option} {url}: must begin with udpm://, such as udpm://239.255.76.67:7667?ttl=0")
    with stderr_kept() as first_line:
        try:
            link = lcm.LCM(url)
            link.subscribe("JP_.*", take)
        except (RuntimeError, OSError, ValueError) as error:
            raise ToolError(f"{option} {url}: {first_line() or error}; is there a multicast route? "
                            "ip link set lo multicast on; ip route add 224.0.0.0/4 dev lo") from None
    return link


def listen(listener, url, directory):
    """Until the route is done, or until a key stops it. The folder of the results is there when it hears."""
    link = open_lcm(url, listener.take)
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ToolError(f"{directory}: {error.strerror}") from None
    print(f"listening on {url}", flush=True)
    heard, state = time.monotonic(), None
    while not listener.is_over():
        link.handle_timeout(100)
        if listener.state is not state:
            heard, state = time.monotonic(), listener.state
        if time.monotonic() - heard > QUIET_MAX:
            raise ToolError(f"--live {url}: no JP_STATE for {QUIET_MAX} s; is jp-lcm on the robot's bus and this URL?")


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("log", metavar="LOG", type=Path, nargs="?", help="a log of lcm-logger")
    parser.add_argument("directory", metavar="DIR", type=Path, help="where the results go")
    parser.add_argument("--live", metavar="URL", help="listen there until the route is done, in place of a log; begin "
                        "before the route is sent")
    arguments = parser.parse_args()
    if (arguments.log is None) == (arguments.live is None):
        parser.error("either a log or --live URL")
    listener = Listener()
    if arguments.live is None:
        replay(listener.take, arguments.log)
    else:
        with contextlib.suppress(KeyboardInterrupt):
            listen(listener, arguments.live, arguments.directory)
    if listener.bad:
        print(f"{listener.bad} messages were not of their type and are left out", file=sys.stderr)
    listener.record.write(arguments.directory)
    for name in (SUMMARY_NAME, LOG_NAME):
        print(f"wrote {shown_path(arguments.directory / name)}")


if __name__ == "__main__":
    run(main)
