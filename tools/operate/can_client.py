"""A robot's operator on CAN: sends a route, a goal, or a map and a goal on it, has it driven, and hears what the ECU
tells.

One loop sends and listens: when it hangs, the commands stop and the ECU brakes the robot to a stand.
"""
import struct
import time
import zlib
from dataclasses import dataclass, field

import can
from can.interfaces.slcan import slcanBus

from tools.common import ToolError
from tools.operate.can_messages import Codec, database, fault_names

# Names that --bus knows besides python-can's own.
INTERFACES = {"can": "socketcan"}

COMMAND_PERIOD = 0.1  # s, GenMsgCycleTime of OperatorCommand and Goal

# Between waypoints, s: the ECU's queue is short.
WAYPOINT_PERIOD = 0.002

HEARTBEAT_TIMEOUT = 1.0  # s without EcuStatus; ten of them were lost then
ANSWER_TIMEOUT = 3.0     # s for an answer to a command
STAND_TIMEOUT = 20.0     # s to stand up, or to brake to a stand
UPLOADS_MAX = 3          # a frame may be lost, or an offer taken for the last client's repeated one
UPLOAD_TIMEOUT = 1.0     # s for RouteStatus to tell of an upload

MAP_DATA = 5            # bytes of a MapData
MAP_WINDOW = 128        # of them on their way: what is sent between two MapStatus, twice
MAP_TIMEOUT = 120.0     # s for a map to arrive
MAP_INDEX_MASK = 0xFFF  # of MapData
MAP_ID_MAX = 15

GOAL = 0  # the RouteId of the last Goal
ROUTE_ID_MAX = 255  # and of GoalId

DOWN = ("Fallen", "Fault")  # states that only Off leads out of


class RobotError(ToolError):
    """The robot did not do what it was told; the message is one line."""


# ---- bus -----------------------------------------------------------------------------------------------------------

def add_bus_argument(parser):
    parser.add_argument("--bus", metavar="KIND:CHANNEL", required=True,
                        help="can:vcan0, slcan:/dev/ttyACM0, or any interface of python-can and its channel")


class SerialBus(slcanBus):
    """python-can's, but reads what has arrived at once: byte by byte it falls behind this bus and loses frames."""

    def _read(self, timeout):
        deadline = time.monotonic() + (timeout or 0)
        while True:
            end = min((place for place in map(self._buffer.find, b"\r\a") if place >= 0), default=-1)
            if end >= 0:
                line = self._buffer[:end + 1].decode(errors="replace")
                del self._buffer[:end + 1]
                return line
            self._buffer += self.serialPortOrig.read(max(self.serialPortOrig.in_waiting, 1))
            if time.monotonic() > deadline:
                return None

    def _recv_internal(self, timeout):
        try:
            return super()._recv_internal(timeout)
        except (ValueError, IndexError):  # a garbled line, as when bytes were lost
            return None, False


def open_bus(name):
    """The bus of --bus; it takes in only what is meant for an operator."""
    kind, _, channel = name.partition(":")
    if not kind or not channel:
        raise ToolError(f"--bus {name}: must be KIND:CHANNEL, such as can:vcan0")
    bitrate = database().dbc.attributes["Baudrate"].value
    try:
        if kind == "slcan":
            return SerialBus(channel, bitrate=bitrate, sleep_after_open=0, can_filters=operator_filters())
        return can.Bus(interface=INTERFACES.get(kind, kind), channel=channel, bitrate=bitrate,
                       can_filters=operator_filters())
    except (can.CanError, OSError, ValueError, ImportError) as error:
        hint = f"; is the interface up? ip link set {channel} up" if kind == "can" else ""
        raise ToolError(f"--bus {name}: {' '.join(str(error).split())}{hint}") from None


def operator_filters():
    """What an operator hears: what is meant for it, and other operators."""
    heard = [message for message in database().messages
             if "OPERATOR" in message.receivers or "OPERATOR" in message.senders]
    return [{"can_id": message.frame_id, "can_mask": 0x7FF, "extended": False} for message in heard]


# ---- what the robot tells ------------------------------------------------------------------------------------------

@dataclass
class SegmentEnergy:
    """J; None is not known yet."""
    predicted: float | None = None
    spent: float | None = None
    drawn: float | None = None


@dataclass
class RobotState:
    """The last of each message, and the segments since the robot last stood."""
    latest: dict = field(default_factory=dict)
    segments: dict = field(default_factory=dict)
    heard: float | None = None  # time of the last EcuStatus, s

    def take(self, name, signals, now):
        self.latest[name] = signals
        if name == "EcuStatus":
            self.heard = now
        elif name == "SegmentForecast":
            if signals["Segment"] == 1:
                self.segments.clear()
            self.segments[signals["Segment"]] = SegmentEnergy(predicted=signals["Energy"])
        elif name == "SegmentResult":
            segment = self.segments.setdefault(signals["Segment"], SegmentEnergy())
            segment.spent, segment.drawn = signals["Spent"], signals["Drawn"]

    def get(self, name, signal):
        """The last value of a signal; a text where the DBC names the values; None before the first."""
        value = self.latest.get(name, {}).get(signal)
        return value if value is None or isinstance(value, (int, float)) else str(value)

    @property
    def state(self):
        return self.get("EcuStatus", "State")

    @property
    def faults(self):
        return fault_names(self.get("EcuErrors", "Faults") or 0)

    def route(self, route_id):
        """RouteStatus.State of this route; None while the ECU speaks of another one."""
        return self.get("RouteStatus", "State") if self.get("RouteStatus", "RouteId") == route_id else None


# ---- operator ------------------------------------------------------------------------------------------------------

class Listener:
    """Hears the robot; sends nothing."""

    def __init__(self, bus, name, watch=lambda state: None, clock=time.monotonic):
        """`watch` is called with the state after each step; `clock` tells the bus's time, s."""
        self.state = RobotState()
        self._bus, self._name, self._watch, self._clock = bus, name, watch, clock
        self._codec = Codec()
        self._started = clock()

    def step(self, timeout=0.02):
        """Take what arrives within the time, s."""
        self._receive(self._clock() + timeout)
        self._watch(self.state)

    def _receive(self, deadline):
        while True:
            left = deadline - self._clock()
            try:
                frame = self._bus.recv(max(left, 0))
            except (can.CanError, OSError, ValueError) as error:
                raise self.error(f"the bus has gone: {error}") from None
            if frame is not None:
                self._take(frame)
            if left <= 0:
                return

    def _take(self, frame):
        decoded = self._codec.decode(frame)
        if decoded is not None:
            self.state.take(*decoded, self._clock())

    def check_heartbeat(self):
        """RobotError when the ECU is silent."""
        heard = self.state.heard or self._started
        if self._clock() - heard > HEARTBEAT_TIMEOUT:
            raise self.error(f"no EcuStatus for {HEARTBEAT_TIMEOUT:g} s; is the ECU running on this bus, at "
                             f"{database().dbc.attributes['Baudrate'].value} bit/s?")

    def error(self, reason):
        return RobotError(f"{self._name}: {reason}")


class Operator(Listener):
    """Commands a robot. RobotError: it does not do it; then it brakes to a stand by itself, as commands cease."""

    def __init__(self, bus, name, watch=lambda state: None, clock=time.monotonic):
        super().__init__(bus, name, watch, clock)
        self._mode, self._route_id, self._goal, self._map_goal = "Stand", GOAL, None, None
        self._next_command = 0.0
        self._resets = self._conflicts = None

    # ---- steps

    def step(self, timeout=0.02):
        """Send what is due, take what arrives, look for what is wrong."""
        now = self._clock()
        if now >= self._next_command:
            self._send_commands()
            self._next_command = now + COMMAND_PERIOD
        super().step(timeout)
        self.check_heartbeat()
        self._check_ecu()

    def _send_commands(self):
        self._send("OperatorCommand", Mode=self._mode, RouteId=self._route_id)
        if self._goal is not None:
            self._send("Goal", X=self._goal[0], Y=self._goal[1])
        if self._map_goal is not None:
            self._send("MapGoal", **self._map_goal)

    def _send(self, name, **signals):
        try:
            self._bus.send(self._codec.encode(name, **signals))
        except (can.CanError, OSError, ValueError) as error:
            raise self.error(f"{name} was not sent: {error}") from None

    def _take(self, frame):
        super()._take(frame)
        if frame.arbitration_id == database().get_message_by_name("OperatorCommand").frame_id:
            raise self.error("another operator commands this robot; end it first")

    def _check_ecu(self):
        """A restart, and another controller on the bus."""
        resets, conflicts = self.state.get("EcuStatus", "Resets"), self.state.get("EcuErrors", "Conflicts")
        if self._resets not in (None, resets):
            raise self.error(f"the ECU restarted (restart {resets}); the robot brakes to a stand and has forgotten the "
                             f"route")
        if self._conflicts not in (None, conflicts):
            raise self.error("another controller sends with the ECU's ids; take it off the bus")
        self._resets, self._conflicts = resets, conflicts

    def _until(self, done, timeout):
        """Step until done(); False: it was not within the time, s."""
        deadline = self._clock() + timeout
        while not done():
            if self._clock() > deadline:
                return False
            self.step()
        return True

    def _wait(self, done, timeout, missing):
        """As _until(), but RobotError with what is missing."""
        if not self._until(done, timeout):
            raise self.error(f"{missing} within {timeout:g} s")

    # ---- commands

    def off(self):
        """Motors off; clears faults."""
        self._mode = "Off"
        self._wait(lambda: self.state.state == "Idle", ANSWER_TIMEOUT, "the motors are not off")

    def stand(self):
        """Stand up, or brake to a balanced stand."""
        self._mode, self._goal, self._map_goal = "Stand", None, None
        self._wait(lambda: self.state.state is not None and self.state.get("EcuErrors", "Faults") is not None,
                   ANSWER_TIMEOUT, "no EcuStatus and EcuErrors")
        if not self._until(self._stands, STAND_TIMEOUT):
            pitch = 360 * (self.state.get("Motion", "Pitch") or 0)
            raise self.error(f"the robot does not stand within {STAND_TIMEOUT:g} s (state {self.state.state}, refused: "
                             f"{self.state.get('EcuLosses', 'StandRefusal')}, pitch {pitch:.0f}°); set it upright")

    def hold(self, seconds):
        """Go on as commanded last."""
        end = self._clock() + seconds
        while self._clock() < end:
            self._check_upright()
            self.step()

    def _stands(self):
        self._check_upright()
        status = [self.state.get("EcuStatus", signal) for signal in ("State", "Mode", "OperatorState")]
        return status == ["Standing", "Stand", "Alive"]  # one that lost its operator stands too, but obeys no Drive

    def _check_upright(self):
        if self.state.state in DOWN:
            faults = ", ".join(self.state.faults)
            what = f"reports a fault ({faults or 'not named yet'})" if self.state.state == "Fault" else "has fallen"
            raise self.error(f"the robot {what}; set it upright and switch it off first (tools.operate.drive --off)")

    def drive_route(self, waypoints):
        """Upload the route and drive it to its end. The robot stands before."""
        self._route_id = self._upload(waypoints)
        self._drive()

    def drive_goal(self, goal):
        """Drive to one point. The robot stands before."""
        self._goal, self._route_id = goal, GOAL
        self._wait(lambda: self.state.route(GOAL) == "Ready", ANSWER_TIMEOUT,
                   "the ECU does not take the goal (nor one that it has just driven to)")
        self._drive()

    # ---- on a map

    def navigate(self, stream, goal):
        """Send a map, unless the ECU has it, and drive to a goal on it: signals of MapGoal. The robot stands before."""
        map_id = self._send_map(stream)
        self._route_id = self._ask(map_id, goal)
        self._mode = "Navigate"
        self._wait(lambda: self._navigation() != "Taken", ANSWER_TIMEOUT, "the robot does not set off")
        while self._navigation() != "Arrived":
            self.step()

    def _has_map(self, crc, *states):
        return self.state.get("MapStatus", "MapCrc") == crc and self.state.get("MapStatus", "State") in states

    def _send_map(self, stream):
        """Its id."""
        self._wait(lambda: "MapStatus" in self.state.latest, ANSWER_TIMEOUT,
                   "no MapStatus: is the ECU built with a navigator? None came")
        crc = zlib.crc32(stream)
        if self._has_map(crc, "Ready", "Receiving"):
            map_id = self.state.get("MapStatus", "MapId")
        else:
            map_id = self.state.get("MapStatus", "MapId") % MAP_ID_MAX + 1
        deadline, sent, heard = self._clock() + MAP_TIMEOUT, 0, None
        while not self._has_map(crc, "Ready"):
            if self._clock() > deadline:
                raise self.error(f"the map did not arrive within {MAP_TIMEOUT:g} s")
            self._check_map(crc)
            if not self._has_map(crc, "Receiving"):
                self._offer_map(map_id, stream, crc)
                sent, heard = 0, None
                continue
            status = self.state.latest["MapStatus"]
            if status is not heard:  # go back when nothing has arrived since the status before
                sent = status["Received"] if heard and heard["Received"] == status["Received"] else sent
                heard = status
            if sent * MAP_DATA < len(stream) and sent < status["Received"] + MAP_WINDOW:
                data = stream[sent * MAP_DATA:][:MAP_DATA]
                self._send("MapData", Index=sent & MAP_INDEX_MASK, Data=int.from_bytes(data, "little"))
                sent += 1
            self.step(WAYPOINT_PERIOD)
        return map_id

    def _offer_map(self, map_id, stream, crc):
        self._send("MapOffer", MapId=map_id, Bytes=len(stream), MapCrc=crc)
        self.state.latest.pop("MapStatus", None)
        self._wait(lambda: "MapStatus" in self.state.latest, ANSWER_TIMEOUT, "no MapStatus")
        if self.state.get("MapStatus", "Reason") == "UnderWay":
            raise self.error("the ECU does not take the map: it drives to a goal; let it stand first")

    def _check_map(self, crc):
        """RobotError when it is refused for what it is."""
        reason = self.state.get("MapStatus", "Reason")
        if self._has_map(crc, "Rejected") and reason in ("TooLarge", "CellSize"):
            raise self.error(f"the ECU does not take the map: {reason}")

    def _ask(self, map_id, goal):
        """The id of the goal, which waits to be driven to then."""
        self._wait(lambda: "NavigationStatus" in self.state.latest, ANSWER_TIMEOUT, "no NavigationStatus")
        goal_id = self.state.get("NavigationStatus", "GoalId") % ROUTE_ID_MAX + 1
        self._map_goal = {"MapId": map_id, "GoalId": goal_id, **goal}
        self._wait(lambda: self.state.get("NavigationStatus", "GoalId") == goal_id, ANSWER_TIMEOUT,
                   "no answer to the goal")
        self._map_goal = None
        answer = self.state.get("NavigationStatus", "Answer")
        if answer != "Taken":
            raise self.error(f"the ECU does not take the goal: {answer}")
        return goal_id

    def _navigation(self):
        """Taken, then the navigator's state; Arrived in the end."""
        self._check_upright()
        status = {signal: self.state.get("NavigationStatus", signal)
                  for signal in ("GoalId", "Answer", "State", "Reason")}
        if status["GoalId"] != self._route_id or status["Answer"] not in ("Taken", "Driven", "Home"):
            raise self.error(f"the goal is not driven to: {status['Answer']}")
        if self.state.get("EcuStatus", "OperatorState") == "Lost":
            raise self.error("the ECU has lost the operator's commands; the robot brakes to a stand")
        if status["Answer"] == "Taken":
            return "Taken"
        if status["Answer"] == "Home":
            return self._home(status)
        if status["State"] == "Unreachable":
            raise self.error("no way leads to the goal")
        if status["State"] in ("Failed", "Idle"):
            raise self.error(f"the robot stopped on the way: {status['Reason']}")
        return status["State"]

    def _home(self, status):
        """The navigator's state on the way home; RobotError when it is there, or has not left."""
        if status["State"] == "Arrived":
            raise self.error("the robot came home: its battery would not have lasted, or the goal cannot be reached")
        if status["State"] in ("Idle", "Unreachable", "Failed"):
            raise self.error(f"the robot found no way home: {self.state.get('HomeStatus', 'HomeState')}")
        return status["State"]

    # ---- routes

    def _upload(self, waypoints):
        """The id of the route, which is ready in the ECU then."""
        for _ in range(UPLOADS_MAX):
            route_id = self._free_route_id()
            self._offer(route_id, waypoints)
            self._until(lambda: self.state.route(route_id) in ("Ready", "Rejected"), UPLOAD_TIMEOUT)
            if self.state.route(route_id) == "Ready":
                return route_id
        reason = self.state.get("RouteStatus", "Reason") if self.state.route(route_id) == "Rejected" else "no answer"
        raise self.error(f"the ECU does not take the route: {reason}")

    def _free_route_id(self):
        """Another one than that of the last route."""
        self._wait(lambda: "RouteStatus" in self.state.latest, ANSWER_TIMEOUT, "no RouteStatus")
        return self.state.get("RouteStatus", "RouteId") % ROUTE_ID_MAX + 1

    def _offer(self, route_id, waypoints):
        self._send("RouteOffer", RouteId=route_id, Length=len(waypoints), RouteCrc=route_crc(waypoints))
        for x, y in waypoints:
            self.step(WAYPOINT_PERIOD)
            self._send("Waypoint", X=x, Y=y)

    def _drive(self):
        self._mode = "Drive"
        self._wait(lambda: self._progress() is not None, ANSWER_TIMEOUT, "the robot does not set off")
        while self._progress() != "Done":
            self.step()

    def _progress(self):
        """Driving or Done; None before."""
        self._check_upright()
        route = self.state.route(self._route_id)
        reason = self.state.get("RouteStatus", "Reason")
        if route in ("Stopped", "Rejected"):
            raise self.error(f"the robot stopped on the way: {reason}{self._plan_status()}")
        if self.state.get("EcuStatus", "OperatorState") == "Lost" and route == "Driving":
            raise self.error("the ECU has lost the operator's commands; the robot brakes to a stand")
        return route if route in ("Driving", "Done") else None

    def _plan_status(self):
        status = self.state.get("RouteStatus", "PlanStatus")
        return f" (status {status})" if status else ""


# ---- waypoints -----------------------------------------------------------------------------------------------------

def route_crc(waypoints):
    """CRC-32 of the raw values, as RouteOffer describes it."""
    signals = [database().get_message_by_name("Waypoint").get_signal_by_name(axis) for axis in ("X", "Y")]
    raw = [signal.scaled_to_raw(value) for point in waypoints for signal, value in zip(signals, point)]
    return zlib.crc32(struct.pack(f"<{len(raw)}i", *raw))


def check_waypoints(place, waypoints):
    """ToolError for a route that no frame can hold."""
    length = database().get_message_by_name("RouteOffer").get_signal_by_name("Length").maximum
    if not 1 <= len(waypoints) <= length:
        raise ToolError(f"{place}: {len(waypoints)} waypoints; 1 to {length:g} can be sent")
    for index, point in enumerate(waypoints, start=1):
        for axis, value in zip("XY", point):
            signal = database().get_message_by_name("Waypoint").get_signal_by_name(axis)
            if not signal.minimum <= value <= signal.maximum:
                raise ToolError(f"{place}: waypoint {index}: {axis.lower()} = {value:g} m is not within "
                                f"{signal.minimum:g} to {signal.maximum:g} m")
