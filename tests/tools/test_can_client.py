"""can_messages.py and can_client.py: golden frames, end-to-end protection, an operator against a stand-in of the
ECU with every way in which the robot can fail it."""
import os
import re
import struct
import zlib

import can
import pytest
from can_drive import sample
from fake_ecu import DATA_IDS, DATABASE, FakeEcu, crc_8h2f, is_protected, telemetry

from tools.common import ROOT, ToolError
from tools.operate import can_messages
from tools.operate.can_client import Operator, RobotError, check_waypoints, open_bus, route_crc

LIMIT = 300  # s, for what takes milliseconds on an idle machine
ROUTE = [(1.0, 2.0), (-3.5, 0.25), (4.0, -4.0)]


@pytest.fixture
def channel(request):
    return f"virtual:{request.node.name}"


def operator_of(ecu):
    return Operator(ecu, "bus", clock=ecu.clock)


def drive(trouble=None, act=lambda operator: operator.drive_route(ROUTE)):
    """The stand-in after the operator's work."""
    ecu = FakeEcu(trouble)
    operator = operator_of(ecu)
    ecu.seen = operator.state
    operator.stand()
    act(operator)
    operator.stand()
    return ecu


# ---- messages ------------------------------------------------------------------------------------------------------

def packed(fields):
    """Data bytes from (start bit, bits, raw value), little-endian."""
    return sum((value & (1 << bits) - 1) << start for start, bits, value in fields).to_bytes(8, "little")


@pytest.mark.parametrize("name, signals, fields", [
    ("Waypoint", {"X": 1.0, "Y": -2.5}, [(12, 26, 65536), (38, 26, -163840)]),
    ("Goal", {"X": -512.0, "Y": 511.9999847412109375}, [(12, 26, -2**25), (38, 26, 2**25 - 1)]),
    ("RouteOffer", {"RouteId": 255, "Length": 32, "RouteCrc": 0xDEADBEEF},
     [(16, 8, 255), (24, 8, 32), (32, 32, 0xDEADBEEF)]),
])
def test_golden_frames(name, signals, fields):
    codec = can_messages.Codec()
    for counter in [*range(1, 16), 0, 1]:
        frame = codec.encode(name, **signals)
        data = packed([*fields, (8, 4, counter)])
        data = bytes([crc_8h2f(data[1:] + bytes([DATA_IDS[frame.arbitration_id]]))]) + data[1:]
        assert bytes(frame.data) == data
        assert not frame.is_extended_id
        assert codec.decode(frame) == (name, pytest.approx({**signals, "Counter": counter, "Crc": data[0]}))


def test_crc_of_the_profile():
    assert crc_8h2f(b"123456789") == 0xDF


def test_the_shortest_message_is_protected():
    frame = can_messages.Codec().encode("OperatorCommand", Mode="Drive", RouteId=7)
    assert len(frame.data) == 4 and is_protected(frame)
    assert frame.data[1] == 0x21 and frame.data[2] == 7


@pytest.mark.parametrize("bit", range(64))
def test_a_flipped_bit_is_found(bit):
    frame = can_messages.Codec().encode("Waypoint", X=10.0, Y=20.0)
    frame.data[bit // 8] ^= 1 << bit % 8
    assert can_messages.Codec().decode(frame) is None


def test_a_sample_is_right_as_a_whole():
    codec = can_messages.Codec()
    names = [codec.decode(frame)[0] for frame in sample(3)]
    assert names == ["WheelSensors", "BalanceSensors", "CurrentSensors"]


@pytest.mark.parametrize("part", range(3))
def test_a_sample_with_a_part_of_another_is_not_right(part):
    codec = can_messages.Codec()
    frames = sample(3)
    for frame in sample(4):
        codec.decode(frame)
    results = [codec.decode(frame) for i, frame in enumerate(frames) if i != part]
    assert results[-1] is None if part < 2 else codec.decode(sample(4)[2]) is None


@pytest.mark.parametrize("frame", [
    can.Message(arbitration_id=388, data=bytes(7), is_extended_id=False),
    can.Message(arbitration_id=388, data=bytes(8), is_extended_id=True),
    can.Message(arbitration_id=388, dlc=8, is_remote_frame=True, is_extended_id=False),
    can.Message(arbitration_id=389 + 100, data=bytes(8), is_extended_id=False),
    can.Message(arbitration_id=388, data=bytes(8), is_error_frame=True, is_extended_id=False),
    can.Message(arbitration_id=388, data=bytes(8), is_fd=True, is_extended_id=False),
])
def test_frames_of_others_are_not_decoded(frame):
    assert can_messages.Codec().decode(frame) is None


def test_any_bytes_can_be_decoded():
    codec = can_messages.Codec()
    for message in DATABASE.messages:
        for fill in (0x00, 0x55, 0xAA, 0xFF):
            data = bytes([fill] * message.length)
            codec.decode(can.Message(arbitration_id=message.frame_id, data=data, is_extended_id=False))


def test_fault_names_are_those_of_the_firmware():
    assert can_messages.fault_names(0) == []
    assert can_messages.fault_names(1 + 16 + 512) == ["IMU range", "left encoder", "overspeed"]
    assert can_messages.fault_names(8 + 0x4000 + 0x8000) == ["encoder jump", "slope", "bits 0x8000"]
    header = (ROOT / "include/joulepath/monitor.h").read_text()
    bits = [1 << int(shift) for shift in re.findall(r"JP_FAULT_\w+ = 1 << (\d+)", header)]
    assert sorted(can_messages.fault_bits()) == bits


# ---- waypoints -----------------------------------------------------------------------------------------------------

def test_route_crc():
    raw = [(65536, 131072), (-229376, 16384), (262144, -262144)]
    assert route_crc(ROUTE) == zlib.crc32(b"".join(struct.pack("<ii", *point) for point in raw))


@pytest.mark.parametrize("waypoints, part", [
    ([], "0 waypoints"), ([(1, 1)] * 33, "33 waypoints"), ([(1, 1), (600, 0)], "waypoint 2: x = 600 m"),
    ([(0, -512.1)], "waypoint 1: y"), ([(float("nan"), 0)], "x = nan"), ([(0, float("inf"))], "y = inf"),
])
def test_routes_that_no_frame_holds(waypoints, part):
    with pytest.raises(ToolError, match=part):
        check_waypoints("--route", waypoints)


# ---- operator ------------------------------------------------------------------------------------------------------

def test_a_route_is_uploaded_and_driven():
    ecu = drive()
    assert ecu.violations == []
    assert ecu.driven == [(65536, 131072), (-229376, 16384), (262144, -262144)]
    assert ecu.commands == [("Stand", 0), ("Drive", 1), ("Stand", 1)]
    assert ecu.route_state == "Done"
    assert [(s.predicted, s.spent, s.drawn) for s in ecu.seen.segments.values()] == [(10.0, 10.5, 8.25)] * 3


def test_32_waypoints():
    ecu = drive(act=lambda operator: operator.drive_route([(i, -i) for i in range(1, 33)]))
    assert ecu.violations == [] and len(ecu.driven) == 32 and ecu.ended == 32


def test_the_next_route_has_another_id():
    def twice(operator):
        operator.drive_route(ROUTE)
        operator.drive_route(ROUTE[:1])
    ecu = drive(act=twice)
    assert ("Drive", 1) in ecu.commands and ("Drive", 2) in ecu.commands
    assert ecu.violations == []


def test_a_route_rejected_once_is_sent_again():
    ecu = drive("reject once", act=lambda operator: operator._upload(ROUTE))
    assert ecu.route_id == 2 and ecu.route_state == "Ready" and ecu.violations == []


def test_a_goal_is_driven_to():
    ecu = drive(act=lambda operator: operator.drive_goal((7.0, -1.0)))
    assert ecu.driven == [(7 * 65536, -65536)]
    assert ("Drive", 0) in ecu.commands and ecu.violations == []


def test_off():
    ecu = drive(act=lambda operator: operator.off())
    assert "Off" in dict(ecu.commands)


def test_off_clears_a_fault():
    ecu = FakeEcu("fault")
    operator_of(ecu).off()
    assert ecu.state == "Idle"


@pytest.mark.parametrize("trouble, part", [
    ("silent", "no EcuStatus"), ("deaf", "does not stand within"), ("stays down", "refused: NotUpright"),
    ("fallen", "has fallen"), ("fault", "reports a fault (left encoder, overspeed)"),
    ("reject", "does not take the route: Sequence"), ("falls", "has fallen"),
    ("restarts", "the ECU restarted (restart 1)"), ("conflict", "another controller"),
    ("loses operator", "lost the operator"), ("stops", "stopped on the way: Plan"), ("goes silent", "no EcuStatus"),
    ("other operator", "another operator"),
])
def test_every_failure_is_named(trouble, part):
    with pytest.raises(RobotError) as failure:
        drive(trouble)
    assert part in str(failure.value)
    assert len(str(failure.value).splitlines()) == 1
    assert str(failure.value).startswith("bus: ")


def test_a_goal_that_is_not_taken():
    def again(operator):
        operator.drive_goal((1.0, 1.0))
        operator.stand()
        operator.drive_goal((1.0, 1.0))
    with pytest.raises(RobotError, match="does not take the goal"):
        drive(act=again)


def test_commands_cease_when_the_loop_hangs():
    ecu = FakeEcu()
    operator_of(ecu).step()
    sent = ecu.frames
    while ecu.clock() < 1:
        ecu.recv(0.1)
    assert ecu.frames == sent == 1


def test_a_bus_that_vanishes(channel):
    bus = open_bus(channel)
    operator = Operator(bus, channel)
    operator.step()
    bus.shutdown()
    with pytest.raises(RobotError):
        for _ in range(10):
            operator.step()


def test_a_listener_takes_no_frames_of_the_control_loop(channel):
    with open_bus(channel) as bus, can.Bus(interface="virtual", channel=channel.split(":", 1)[1]) as other:
        for frame in sample(3):
            other.send(frame)
        other.send(telemetry("Pose", X=1.0))
        assert bus.recv(LIMIT).arbitration_id == 388
        assert bus.recv(0) is None


@pytest.fixture
def line():
    """A bus at one end of a serial line, and the descriptor of the other."""
    ours, theirs = os.openpty()
    with open_bus(f"slcan:{os.ttyname(theirs)}") as bus:
        yield bus, ours
    os.close(ours)
    os.close(theirs)


def read_line_with(descriptor, start):
    """The first line that begins so: a read ends where the writer was interrupted, not where a line ends."""
    heard = b""
    while not (found := re.search(rb"(?:^|\r)(" + start + rb"[^\r]*)\r", heard)):
        heard += os.read(descriptor, 100)
    return found[1]


def test_a_serial_line_carries_frames_both_ways(line):
    bus, other = line
    assert read_line_with(other, b"S") == b"S8"
    bus.send(can_messages.Codec().encode("OperatorCommand", Mode="Stand", RouteId=0))
    assert re.fullmatch(rb"t1004[0-9A-F]{2}110000", read_line_with(other, b"t"))
    os.write(other, b"z\rt18480001020304050607\rt0228" + b"00" * 8 + b"\rt1818FF")
    assert bus.recv(LIMIT).data == bytes(range(8))
    assert bus.recv(0.05) is None
    os.write(other, b"00000000000000\r")
    assert bus.recv(LIMIT).arbitration_id == 0x181


@pytest.mark.parametrize("garbage", [b"t", b"tXYZ8", b"t1849", b"t184", b"t18480", b"T1", b"\xff\x00\xfe", b"t1848t",
                                     b"r18G8", b"\x07", b"z", b"t184800112233445566GG"])
def test_garbage_on_a_serial_line_is_passed_over(line, garbage):
    bus, other = line
    os.write(other, garbage + b"\rt18480001020304050607\r")
    heard = iter(lambda: bus.recv(LIMIT), None)
    assert any(frame.data == bytes(range(8)) for frame in heard)


@pytest.mark.parametrize("name, part", [
    ("can", "KIND:CHANNEL"), ("", "KIND:CHANNEL"), ("can:", "KIND:CHANNEL"), (":vcan0", "KIND:CHANNEL"),
    ("can:nosuchbus0", "ip link set nosuchbus0 up"), ("slcan:/nonexistent/tty", "/nonexistent/tty"),
    ("carrier-pigeon:1", "carrier-pigeon"),
])
def test_a_bus_that_cannot_be_opened(name, part):
    with pytest.raises(ToolError) as failure:
        open_bus(name)
    assert part in str(failure.value) and len(str(failure.value).splitlines()) == 1
