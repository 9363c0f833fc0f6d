"""A stand-in for the ECU and its bus: says what a test wants said. Its time goes on only while somebody waits for a
frame, so that no machine is too slow or too busy for it."""
import struct
import zlib
from collections import deque

import can
import cantools
from conftest import ROOT

DATABASE = cantools.database.load_file(ROOT / "hal/can/joulepath.dbc", strict=True)
DATA_IDS = {256: 79, 257: 82, 258: 87, 259: 71, 260: 65, 261: 68, 262: 67, 263: 78}

MAP_DATA = 5  # bytes of a MapData

STATUS_PERIOD = 0.1    # s
SEGMENT_TIME = 0.5     # s
CONFIRMATIONS = 3


def crc_8h2f(data):
    """Bit by bit: polynomial 0x2F, start and final inversion 0xFF."""
    crc = 0xFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ (0x2F if crc & 0x80 else 0)) & 0xFF
    return crc ^ 0xFF


def is_protected(frame):
    return frame.data[0] == crc_8h2f(bytes(frame.data[1:]) + bytes([DATA_IDS[frame.arbitration_id]]))


def telemetry(name, **signals):
    """A frame of an unprotected message; signals left out are 0, values are raw but for those with a fraction."""
    message = DATABASE.get_message_by_name(name)
    data = message.encode({signal.name: 0 for signal in message.signals} | signals, strict=False)
    return can.Message(arbitration_id=message.frame_id, data=data, is_extended_id=False)


class FakeEcu:
    """The ECU, as a bus with nobody else on it.

    `trouble` names what goes wrong: silent, reject, reject once, deaf, stays down, fallen, fault, falls, restarts,
    conflict, loses operator, stops, goes silent, other operator; on a map: no navigator, loses data, too large, damaged
    once, blocked goal, deaf to goals, unreachable, gives up, turns back, no way home, other goal, loses operator.
    """

    def __init__(self, trouble=None):
        self.trouble = trouble
        self.state, self.mode, self.operator = "Idle", "Off", "None"
        self.resets = self.conflicts = self.faults = 0
        self.route_id, self.route_state, self.reason = 0, "None", "None"
        self.points, self.driven, self.segment, self.ended = [], [], 0, 0
        self.energy = 100.0
        self.frames, self.commands, self.violations = 0, [], []
        self._counters, self._confirmed, self._last = {}, 0, None
        self._offer, self._offers, self._segment_end = None, 0, None
        self._now, self._next_status, self._said = 0.0, 0.0, deque()
        self.stream, self.map, self.map_offers, self.map_frames = b"", None, 0, 0
        self.map_state, self.map_reason = "None", "None"
        self.goal, self.goal_answer, self.navigator, self.navigator_reason = None, "None", "Idle", "None"
        self._steps = 0
        if trouble in ("fallen", "fault"):
            self.state = trouble.capitalize()
            self.faults = 16 + 512 if trouble == "fault" else 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    # ---- the bus

    def clock(self):
        return self._now

    def send(self, frame):
        self.frames += 1
        if self.trouble != "silent":
            self._take(frame)

    def recv(self, timeout):
        deadline = self._now + timeout
        while not self._said and self._next_status <= deadline:
            self._now = max(self._now, self._next_status)
            self._next_status += STATUS_PERIOD
            if self.trouble != "silent":
                self._work()
                self._tell()
        if self._said:
            return self._said.popleft()
        self._now = deadline
        return None

    # ---- frames in

    def _take(self, frame):
        if not is_protected(frame):
            self.violations.append(f"CRC of {frame}")
            return
        counter = frame.data[1] & 0x0F
        last = self._counters.get(frame.arbitration_id)
        if last is not None and counter != (last + 1) % 16:
            self.violations.append(f"counter {counter} after {last} of 0x{frame.arbitration_id:x}")
        self._counters[frame.arbitration_id] = counter
        signals = DATABASE.decode_message(frame.arbitration_id, frame.data, scaling=False, decode_choices=False)
        {256: self._command, 257: self._offered, 258: self._waypoint, 259: self._goal, 260: self._map_offered,
         261: self._map_data, 263: self._map_goal}[frame.arbitration_id](signals)

    def _command(self, signals):
        mode, route = ("Off", "Stand", "Drive", "Navigate")[signals["Mode"]], signals["RouteId"]
        if not self.commands or self.commands[-1] != (mode, route):
            self.commands.append((mode, route))
        self._confirmed = self._confirmed + 1 if (mode, route) == self._last else 1
        self._last = (mode, route)
        if self.trouble == "deaf":
            return
        if mode == "Stand":
            self._stand()
        elif self._confirmed >= CONFIRMATIONS:
            self._confirm(mode, route)

    def _stand(self):
        self.mode, self.operator = "Stand", "Alive"
        if self.state == "Idle" and self.trouble != "stays down":
            self.state = "Standing"
        elif self.state == "Driving":
            self.state, self.route_state, self.reason = "Standing", "Stopped", "Command"

    def _confirm(self, mode, route):
        self.mode = mode
        if mode == "Off":
            self.state, self.faults = "Idle", 0
        elif mode == "Navigate":
            self._navigate(route)
        elif route == self.route_id and self.route_state == "Ready":
            self.state, self.route_state = "Driving", "Driving"
            self.driven, self.segment, self.ended = list(self.points), 0, 0
            self._next_segment()

    def _offered(self, signals):
        self._offers += 1
        self._offer, self.points = signals, []
        self.route_id, self.route_state, self.reason = signals["RouteId"], "Receiving", "None"

    def _waypoint(self, signals):
        self.points.append((signals["X"], signals["Y"]))
        if len(self.points) < self._offer["Length"]:
            return
        crc = zlib.crc32(b"".join(struct.pack("<ii", *point) for point in self.points))
        rejected = self.trouble == "reject" or self.trouble == "reject once" and self._offers == 1
        if rejected or crc != self._offer["RouteCrc"]:
            self.route_state, self.reason = "Rejected", "Sequence" if rejected else "RouteCrc"
        else:
            self.route_state = "Ready"

    def _goal(self, signals):
        if self.route_state not in ("Driving", "Done"):
            self.route_id, self.route_state, self.points = 0, "Ready", [(signals["X"], signals["Y"])]

    # ---- on a map

    def _map_offered(self, signals):
        self.map_offers += 1
        self.map, self.stream, self.map_frames = signals, b"", 0
        self.map_state, self.map_reason = "Receiving", "None"

    def _map_data(self, signals):
        self.map_frames += 1
        lost = self.trouble == "loses data" and self.map_frames % 7 == 3
        if self.map_state != "Receiving" or lost or signals["Index"] != len(self.stream) // MAP_DATA:
            return
        if self.trouble == "too large" and signals["Index"] == 4:  # the size is known
            self.map_state, self.map_reason = "Rejected", "TooLarge"
            return
        self.stream = (self.stream + signals["Data"].to_bytes(MAP_DATA, "little"))[:self.map["Bytes"]]
        if len(self.stream) == self.map["Bytes"]:
            damaged = self.trouble == "damaged once" and self.map_offers == 1
            right = zlib.crc32(self.stream) == self.map["MapCrc"] and not damaged
            self.map_state, self.map_reason = ("Ready", "None") if right else ("Rejected", "MapCrc")

    def _map_goal(self, signals):
        if self.trouble != "deaf to goals" and (self.goal is None or signals["GoalId"] != self.goal["GoalId"]):
            self.goal, self.goal_answer = signals, "Blocked" if self.trouble == "blocked goal" else "Taken"

    def _navigate(self, goal):
        if self.goal_answer == "Taken" and goal == self.goal["GoalId"]:
            self.goal_answer, self.navigator, self.state, self._steps = "Driven", "Planning", "Driving", 0

    def _find_way(self):
        """Two statuses in each state."""
        self._steps += 1
        states = ["Planning", "Turning", "Driving"]
        end = {"unreachable": ("Unreachable", "None"), "gives up": ("Failed", "Memory"),
               "no way home": ("Idle", "None")}.get(self.trouble, ("Arrived", "None"))
        if self.trouble in ("turns back", "no way home") and self._steps >= 4:
            self.goal_answer = "Home"
        if self._steps // 2 < len(states):
            self.navigator = states[self._steps // 2]
        else:
            (self.navigator, self.navigator_reason), self.state = end, "Standing"
        if self.trouble == "other goal":
            self.goal = {**self.goal, "GoalId": 99}
        elif self.trouble == "loses operator":
            self.operator = "Lost"

    # ---- the drive

    def _next_segment(self):
        self.segment += 1
        self._segment_end = self._now + SEGMENT_TIME
        self._send("SegmentMotion", Segment=self.segment, Speed=0.5, TurnRate=0.25)
        self._send("SegmentShape", Segment=self.segment, Turn=0.5, Duration=SEGMENT_TIME)
        self._send("SegmentForecast", Segment=self.segment, Energy=10.0)

    def _work(self):
        self.energy += 0.5
        if self.goal_answer in ("Driven", "Home") and self.state == "Driving":
            self._find_way()
            return
        if self.state != "Driving" or self._now < self._segment_end:
            return
        self.ended += 1
        self._send("SegmentResult", Segment=self.ended, Spent=10.5, Drawn=8.25)
        if self.trouble is not None:
            self._go_wrong()
        elif self.ended == len(self.driven):
            self.state, self.route_state = "Standing", "Done"
        else:
            self._next_segment()

    def _go_wrong(self):
        self._segment_end = float("inf")
        if self.trouble == "falls":
            self.state, self.route_state, self.reason = "Fallen", "Stopped", "Switched off"
        elif self.trouble == "restarts":
            self.state, self.resets, self.route_state = "Standing", 1, "None"
        elif self.trouble == "conflict":
            self.conflicts = 1
        elif self.trouble == "loses operator":
            self.operator = "Lost"
        elif self.trouble == "stops":
            self.state, self.route_state, self.reason = "Standing", "Stopped", "Plan"
        elif self.trouble == "goes silent":
            self.trouble = "silent"
        elif self.trouble == "other operator":
            self._said.append(can.Message(arbitration_id=256, data=bytes(4), is_extended_id=False))

    # ---- frames out

    def _send(self, name, **signals):
        self._said.append(telemetry(name, **signals))

    def _tell(self):
        self._send("EcuStatus", State=self.state, Mode=self.mode, OperatorState=self.operator, Resets=self.resets,
                   VersionMajor=1, VersionMinor=2, VersionPatch=3)
        self._send("EcuErrors", Faults=self.faults, Conflicts=self.conflicts, CrcErrors=7)
        self._send("EcuLosses", LostSamples=2, StandRefusal="NotUpright" if self.trouble == "stays down" else "None")
        self._send("RouteStatus", RouteId=self.route_id, State=self.route_state, Reason=self.reason,
                   Length=len(self.points), Segment=self.segment, SegmentsEnded=self.ended)
        if self.trouble != "no navigator":
            self._tell_navigator()
        self._send("Pose", X=1.5, Y=-2.5, Heading=0.25)
        self._send("Motion", Speed=0.5)
        self._send("Reference", Speed=0.5, SegmentTimeLeft=0.015625)
        self._send("EnergySpent", Energy=self.energy)
        self._send("EnergyDrawn", Energy=self.energy / 2)
        self._send("BatteryStatus", Voltage=24.5, Current=1.5, StateOfCharge=0.75, EnergyLeft=72.5)

    def _tell_navigator(self):
        has_course = self.navigator in ("Turning", "Driving")
        self._send("MapStatus", MapId=self.map["MapId"] if self.map else 0, State=self.map_state,
                   Reason=self.map_reason, Received=-(-len(self.stream) // MAP_DATA),
                   MapCrc=self.map["MapCrc"] if self.map else 0)
        self._send("NavigationStatus", GoalId=self.goal["GoalId"] if self.goal else 0, State=self.navigator,
                   Reason=self.navigator_reason, Answer=self.goal_answer, HasCourse=int(has_course), Replans=3)
        self._send("NavigationProgress", Distance=4.5, Duration=21.0, Energy=33.5, Deviation=1.25)
        self._send("HomeStatus", HomeState="NoWay" if self.trouble == "no way home" else "Suffices", Probability=0.75,
                   Way=40.5, WayDeviation=2.5)
        self._send("HomeBattery", Left=2000.0, LeftDeviation=100.5)
