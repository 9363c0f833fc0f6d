"""A synthetic drive as frames on the bus: 2 m straight on, then an arc to the left, with all telemetry."""
import math

import can
from fake_ecu import DATABASE, crc_8h2f, telemetry

from tools.operate.can_messages import Codec

SPEED, TURN_RATE, DURATION = 0.5, 0.25, 4.0  # m/s, rad/s in the second segment, s
POWER = 6.0          # W
BEGIN = 1.0          # s from the first frame to the drive
ARC = TURN_RATE * DURATION
END = (2 + SPEED / TURN_RATE * math.sin(ARC), SPEED / TURN_RATE * (1 - math.cos(ARC)))
TARGETS = [(2.0, 0.0), (3.75, 1.0)]
PLANNED, SPENT, DRAWN = (23.5, 24.5), (24.0, 24.25), (20.0, 21.0)


def motion(t):
    """x, y, heading, speed and turn rate t seconds into the drive."""
    if t < 0 or t > 2 * DURATION:
        x, y, heading = (0, 0, 0) if t < 0 else (*END, ARC)
        return x, y, heading, 0.0, 0.0
    if t < DURATION:
        return SPEED * t, 0.0, 0.0, SPEED, 0.0
    heading = TURN_RATE * (t - DURATION)
    radius = SPEED / TURN_RATE
    return 2 + radius * math.sin(heading), radius * (1 - math.cos(heading)), heading, SPEED, TURN_RATE


def sample(counter, left=0.5, right=-0.25):
    """The three frames of a sample, protected together."""
    parts = [
        DATABASE.encode_message("WheelSensors", {"SampleCounter": counter, "EncoderLeft": 5, "EncoderRight": 6,
                                                 "BusVoltage": 24.0}),
        DATABASE.encode_message("BalanceSensors", {"SampleCounter": counter, "PitchRate": 0.5, "AccelX": 0.0,
                                                   "AccelZ": 1.0}),
        DATABASE.encode_message("CurrentSensors", {"Crc": 0, "Counter": counter, "CurrentLeft": left,
                                                   "CurrentRight": right, "YawRate": 0.25})]
    crc = crc_8h2f(parts[2][1:] + parts[0] + parts[1] + bytes([83]))
    parts[2] = bytes([crc]) + parts[2][1:]
    return [can.Message(arbitration_id=32 + i, data=data, is_extended_id=False) for i, data in enumerate(parts)]


def upload(codec, goal):
    if goal:
        return [codec.encode("Goal", X=TARGETS[0][0], Y=TARGETS[0][1])]
    return [codec.encode("RouteOffer", RouteId=9, Length=len(TARGETS), RouteCrc=0),
            *(codec.encode("Waypoint", X=x, Y=y) for x, y in TARGETS)]


def plan(index):
    turn_rate = 0.0 if index == 1 else TURN_RATE
    return [telemetry("SegmentMotion", Segment=index, Speed=SPEED, TurnRate=turn_rate),
            telemetry("SegmentShape", Segment=index, Turn=0.125, Duration=DURATION),
            telemetry("SegmentForecast", Segment=index, Energy=PLANNED[index - 1])]


def result(index):
    return [telemetry("SegmentResult", Segment=index, Spent=SPENT[index - 1], Drawn=DRAWN[index - 1])]


def cyclic(ms):
    """What the ECU and the plant tell in this millisecond."""
    t = ms / 1000 - BEGIN
    x, y, heading, speed, turn_rate = motion(t)
    told = {
        1: ("Pose", {"X": x, "Y": y, "Heading": heading / math.tau}),
        5: ("Motion", {"Speed": speed, "YawRate": turn_rate / math.tau, "Pitch": 0.0625}),
        9: ("Reference", {"Speed": speed, "YawRate": turn_rate / math.tau, "Heading": heading / math.tau}),
        13: ("Motors", {"VoltageLeft": 3.5, "VoltageRight": -2.25}),
        17: ("EnergySpent", {"Energy": 1000 + POWER * (t + BEGIN)})}
    frames = [telemetry(name, **signals) for phase, (name, signals) in told.items() if ms % 20 == phase]
    return sample(ms // 20 % 16) + frames if ms % 20 == 13 else frames


def events(goal):
    """Frames by the millisecond in which they are sent."""
    codec = Codec()
    begin, segment = int(1000 * BEGIN), int(1000 * DURATION)
    drive = {"Mode": "Drive", "RouteId": 0 if goal else 9}
    planned = {200: upload(codec, goal), begin - 1: [codec.encode("OperatorCommand", **drive)], begin: plan(1),
               begin + segment: result(1)}
    if not goal:
        planned[begin + segment - 100] = plan(2)
        planned[begin + 2 * segment] = result(2)
    return planned


def frames(goal=False):
    """The whole drive; timestamps from 1000 s on."""
    planned = events(goal)
    for ms in range(int(1000 * (BEGIN + 2 * DURATION)) + 500):
        for frame in cyclic(ms) + planned.get(ms, []):
            frame.timestamp = 1000 + ms / 1000
            yield frame


def candump(messages):
    """The lines of `candump -L`."""
    return "".join(f"({m.timestamp:.6f}) vcan0 {m.arbitration_id:03X}#{bytes(m.data).hex().upper()}\n" for m in messages)
