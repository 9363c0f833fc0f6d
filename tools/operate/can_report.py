#!/usr/bin/env python3
"""Turn a log of the CAN bus into what report.py makes a page of.

LOG is one of candump (-l, -L), .asc or .blf, begun before the route was sent. Writes DIR/summary.json and the log of
the last drive in it. Where the log was taken in lockstep, time is that of the simulation. Exit status 2: bad input;
nothing was written.
"""
import math
import struct
from pathlib import Path

import can

from tools.common import ArgumentParser, ToolError, run, shown_path
from tools.operate.can_messages import Codec, SimClock, message_of
from tools.report.mission_record import LOG_NAME, SUMMARY_NAME, MissionRecord

SUFFIXES = (".log", ".asc", ".blf")
SAMPLE = ("WheelSensors", "BalanceSensors", "CurrentSensors")
TURN = math.tau


def read_frames(path):
    """The frames of a log. ToolError: it cannot be read."""
    if path.suffix not in SUFFIXES:
        raise ToolError(f"{path}: the name must end in {', '.join(SUFFIXES)}")
    count = 0
    try:
        with can.LogReader(path) as reader:
            for frame in reader:
                count += 1
                yield frame
    except OSError as error:
        raise ToolError(f"{path}: {error.strerror}") from None
    except (ValueError, IndexError, struct.error, can.CanError, can.io.blf.BLFParseError):
        raise ToolError(f"{path}: damaged after frame {count}, or not a log of the kind that its name says") from None


class Routes:
    """What the operator has sent: routes by id, the last goal, and which of them is driven."""

    def __init__(self):
        self._offer, self._counter, self._points = None, None, []
        self._routes, self._goal = {}, None
        self._driven = None

    def offer(self, signals):
        self._offer, self._counter, self._points = signals, None, []
        self._routes.pop(signals["RouteId"], None)
        if self._driven is not None and self._driven[0] == signals["RouteId"]:
            self._driven = None

    def waypoint(self, signals):
        if self._offer is None or signals["Counter"] == self._counter:
            return
        self._counter = signals["Counter"]
        self._points.append((signals["X"], signals["Y"]))
        if len(self._points) == self._offer["Length"]:
            self._routes[self._offer["RouteId"]] = self._points
            self._offer = None

    def goal(self, signals):
        self._goal = [(signals["X"], signals["Y"])]

    def command(self, signals):
        """The route, if this command begins to drive one."""
        route_id = signals["RouteId"]
        route = self._routes.get(route_id) if route_id else self._goal
        if str(signals["Mode"]) != "Drive" or route is None or self._driven == (route_id, route):
            return None
        self._driven = (route_id, route)
        return route


class Changes:
    """What the ECU has learned: a line for each change of robot or ground that it noticed, and what is said there."""

    CAUSES = {"None": "surface or robot changed, learning anew",
              "Ground": "surface changed, friction {Friction:.2f} ± {FrictionDeviation:.2f} of the robot file's",
              "Payload": "payload changed, {Payload:+.2f} ± {PayloadDeviation:.2f} kg of the robot file's",
              "Other": "robot changed, neither surface nor payload"}

    def __init__(self):
        self.lines, self.noticed = [], []
        self._learned, self._told = None, (0, "None")

    def learned(self, signals):
        self._learned = signals

    def status(self, t, signals):
        """It follows Learned."""
        told = (signals["Changes"], str(signals["Cause"]))
        if told != self._told and signals["Changes"] > 0 and self._learned is not None:
            self.lines.append(f"{t:.1f} s: {self.CAUSES[told[1]].format(**self._learned)}")
            self.noticed.append({"t_s": t, "cause": told[1].lower(), "friction": self._learned["Friction"],
                                 "friction_deviation": self._learned["FrictionDeviation"]})
        self._told = told


class Converter:
    """Frames to the record of a drive."""

    def __init__(self, source):
        self.record = MissionRecord(source)
        self.known = 0
        self.changes = Changes()
        self._first = None
        self._source = source
        self._codec, self._routes = Codec(), Routes()
        self._sample, self._plan = {}, {}
        self._clock = SimClock()
        self._takers = {
            "SimTime": self._sim_time, "RouteOffer": self._offer, "Waypoint": self._waypoint, "Goal": self._goal,
            "OperatorCommand": self._command, "Pose": self._pose, "Motion": self._motion,
            "Reference": self._reference, "Motors": self._motors, "EnergySpent": self._energy_spent,
            "SegmentMotion": self._segment_motion, "SegmentShape": self._segment_shape,
            "SegmentForecast": self._segment_forecast, "SegmentResult": self._segment_result,
            "Learned": self._learned, "LearnedFactors": self._learned, "LearnerStatus": self._learner_status}

    def take(self, frame):
        message = message_of(frame)
        if message is None:
            return
        if len(frame.data) != message.length:
            raise ToolError(f"{self._source}: at {frame.timestamp:.6f} s: {message.name} has {len(frame.data)} bytes "
                            f"instead of {message.length}; damaged, or not a log of joulepath.dbc")
        self.known += 1
        self._first = frame.timestamp if self._first is None else self._first
        if message.name in SAMPLE:
            self._sample[message.name] = frame
        elif message.name in self._takers:
            self._decode(frame)

    def _decode(self, frame):
        decoded = self._codec.decode(frame)
        if decoded is not None:
            name, signals = decoded
            self._takers[name](frame.timestamp if self._clock.seconds is None else self._clock.seconds, signals)

    # ---- time and routes

    def _sim_time(self, _, signals):
        if self._clock.seconds is None:
            self.record = MissionRecord(self._source)  # what came before has other times
        self._clock.take(signals)

    def _offer(self, _, signals):
        self._routes.offer(signals)

    def _waypoint(self, _, signals):
        self._routes.waypoint(signals)

    def _goal(self, _, signals):
        self._routes.goal(signals)

    def _command(self, _, signals):
        route = self._routes.command(signals)
        if route is not None:
            self.record.route(route)

    # ---- telemetry

    def _pose(self, t, signals):
        self.record.pose(t, signals["X"], signals["Y"], signals["Heading"] * TURN)

    def _motion(self, t, signals):
        self.record.motion(t, signals["Speed"], signals["YawRate"] * TURN, signals["Pitch"] * TURN)

    def _reference(self, t, signals):
        self.record.reference(t, signals["Speed"], signals["YawRate"] * TURN, signals["Heading"] * TURN)

    def _motors(self, t, signals):
        """The currents come far oftener; those of now go with the voltages."""
        self.record.motors(t, signals["VoltageLeft"], signals["VoltageRight"])
        for name in SAMPLE:
            decoded = self._codec.decode(self._sample[name]) if name in self._sample else None
        if decoded is not None:
            self.record.currents(t, decoded[1]["CurrentLeft"], decoded[1]["CurrentRight"])

    def _energy_spent(self, t, signals):
        self.record.energy_spent(t, signals["Energy"])

    def _segment_motion(self, t, signals):
        self._plan = {"t": t, **signals}

    def _segment_shape(self, _, signals):
        if self._plan.get("Segment") == signals["Segment"]:
            self._plan.update(signals)

    def _segment_forecast(self, t, signals):
        """The last of three; one before may be lost."""
        plan = self._plan if self._plan.get("Segment") == signals["Segment"] else {}
        self.record.segment_plan(plan.get("t", t), signals["Segment"], signals["Energy"], plan.get("Speed"),
                                 plan.get("TurnRate"), plan.get("Turn"), plan.get("Duration"))

    def _segment_result(self, t, signals):
        self.record.segment_result(t, signals["Segment"], signals["Spent"], signals["Drawn"])


    def _learned(self, _, signals):
        self.changes.learned(signals)

    def _learner_status(self, t, signals):
        self.changes.status(t if self._clock.seconds is not None else t - self._first, signals)


def convert(path):
    """The record of the log's drive, and what the ECU noticed in the whole log."""
    converter = Converter(path.name)
    for frame in read_frames(path):
        converter.take(frame)
    if converter.known == 0:
        raise ToolError(f"{path}: no frame of joulepath.dbc")
    return converter.record, converter.changes


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("log", metavar="LOG", type=Path, help="of candump, or .asc or .blf")
    parser.add_argument("directory", metavar="DIR", type=Path, help="where the results go")
    options = parser.parse_args()
    record, changes = convert(options.log)
    record.write(options.directory)
    for line in changes.lines:
        print(line)
    for name in (LOG_NAME, SUMMARY_NAME):
        print(f"wrote {shown_path(options.directory / name)}")
    return 0


if __name__ == "__main__":
    run(main)
