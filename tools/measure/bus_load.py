#!/usr/bin/env python3
"""The load of the CAN bus: the worst case by the DBC, and what a log measures.

Worst case: every cyclic message in its period, with as many stuff bits as its length allows. Measured: the bits of
every frame of a candump log with its own stuffing, over the time of the log. Frames of the lockstep simulation do not
count; where they are in a log, they give its time.
"""
import json
from collections import defaultdict
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tools.common import ArgumentParser, ToolError, print_aligned, run, shown_path, write_whole
from tools.operate.can_messages import SimClock, database, message_of
from tools.operate.can_report import read_frames

SIMULATION = ("SimTime", "SimDone")
# Of one bus either these messages, or those, by the kind of its robot.
OF_FOUR_WHEELS = ("WheelTarget", "WheelFeedback", "SupplySensors", "ScanBegin", "ScanRanges", "ScanEnd", "MapPose",
                  "PatrolStatus", "RoundStatus", "RoundBattery", "BatteryCharge")
OF_TWO_SIDES = ("MotorCommand", "WheelSensors", "BalanceSensors", "CurrentSensors")
# Frames of a message in its period, where there are several.
SEVERAL = {"WheelTarget": (4, 10), "WheelFeedback": (4, 10), "ScanRanges": (90, 100)}

FIXED_BITS = 34    # SOF, id, RTR, IDE, r0, DLC, CRC: stuffed, as is the data
TRAILER_BITS = 13  # CRC delimiter, ACK, ACK delimiter, end of frame, space to the next frame: not stuffed
STUFF_RUN = 5      # equal bits after which one is stuffed
CRC_BITS, CRC_POLYNOMIAL = 15, 0x4599

BAR_PERCENT = 60
COMMAND = "make figures"


# ---- worst case ----------------------------------------------------------------------------------------------------

def worst_bits(length):
    """Most bits of a frame with an 11-bit id and `length` bytes, with the space to the next frame."""
    stuffed = FIXED_BITS + 8 * length
    return stuffed + (stuffed - 1) // (STUFF_RUN - 1) + TRAILER_BITS


def bitrate():
    return database().dbc.attributes["Baudrate"].value


def worst_case():
    """A dict for each message of the real bus; cycle_ms and load_percent are None for one sent on an event."""
    messages = []
    for message in sorted(database().messages, key=lambda message: message.frame_id):
        if message.name in SIMULATION:
            continue
        bits, cycle = worst_bits(message.length), message.cycle_time or None
        frames, period = SEVERAL.get(message.name, (1, cycle))
        messages.append({"name": message.name, "id": message.frame_id, "bytes": message.length, "cycle_ms": cycle,
                         "worst_bits": bits,
                         "load_percent": None if cycle is None else 100 * bits * frames * 1000 / period / bitrate()})
    return messages


def load_without(messages, left_out):
    """%"""
    return sum(message["load_percent"] or 0 for message in messages if message["name"] not in left_out)


# ---- measured ------------------------------------------------------------------------------------------------------

class Kind(NamedTuple):
    """What frames must share to be counted together."""
    extended: bool
    remote: bool
    length: int


def _bits_of(value, width):
    return (value[:, None] >> np.arange(width - 1, -1, -1)) & 1


def _arbitration(kind, ids):
    """SOF to DLC, a row of bits for each id."""
    zero, one = np.zeros_like(ids), np.ones_like(ids)
    remote, length = np.full_like(ids, kind.remote), np.full_like(ids, kind.length)
    if kind.extended:
        parts = [(zero, 1), (ids >> 18, 11), (one, 1), (one, 1), (ids & 0x3FFFF, 18), (remote, 1), (zero, 2),
                 (length, 4)]
    else:
        parts = [(zero, 1), (ids, 11), (remote, 1), (zero, 2), (length, 4)]
    return np.hstack([_bits_of(value, width) for value, width in parts])


def crc15(bits):
    """The CRC of each row of bits."""
    crc = np.zeros(len(bits), dtype=np.int64)
    for column in bits.T:
        top = (crc >> (CRC_BITS - 1)) & 1
        crc = ((crc << 1) & ((1 << CRC_BITS) - 1)) ^ np.where(top ^ column, CRC_POLYNOMIAL, 0)
    return crc


def stuff_bits(bits):
    """How many bits are stuffed into each row."""
    count, run = np.zeros(len(bits), dtype=np.int64), np.zeros(len(bits), dtype=np.int64)
    last = np.full(len(bits), -1)
    for column in bits.T:
        run = np.where(column == last, run + 1, 1)
        full = run == STUFF_RUN
        count += full
        last = np.where(full, 1 - column, column)
        run = np.where(full, 1, run)
    return count


def frame_bits(kind, ids, data):
    """Bits on the wire of each frame of a kind, with its stuffing and the space to the next; data end to end."""
    bits = _arbitration(kind, np.array(ids, dtype=np.int64))
    if data:
        octets = np.frombuffer(data, dtype=np.uint8).reshape(len(ids), -1)
        bits = np.hstack([bits, np.unpackbits(octets, axis=1)])
    bits = np.hstack([bits, _bits_of(crc15(bits), CRC_BITS)])
    return bits.shape[1] + stuff_bits(bits) + TRAILER_BITS


def measure(path):
    """Seconds, and frames and bits of each message by name; a frame that the DBC does not know goes by its id."""
    kinds, times, clock = defaultdict(lambda: ([], bytearray())), [], SimClock()
    for frame in read_frames(path):
        message = message_of(frame)
        times = [*times[:1], frame.timestamp]
        if message is not None and message.name == "SimTime":
            clock.take(message.decode(frame.data))
        name = f"id 0x{frame.arbitration_id:x}" if message is None else message.name
        if not frame.is_error_frame and name not in SIMULATION:
            ids, data = kinds[name, Kind(frame.is_extended_id, frame.is_remote_frame, frame.dlc)]
            ids.append(frame.arbitration_id)
            data += frame.data
    seconds = clock.seconds if clock.seconds is not None else times[-1] - times[0] if times else 0
    if not seconds > 0:
        raise ToolError(f"{path}: no time passes in it")
    measured = defaultdict(lambda: {"frames": 0, "bits": 0})
    for (name, kind), (ids, data) in kinds.items():
        measured[name]["frames"] += len(ids)
        measured[name]["bits"] += int(frame_bits(kind, ids, bytes(data)).sum())
    return seconds, dict(measured)


# ---- output --------------------------------------------------------------------------------------------------------

def result(path):
    messages = worst_case()
    about = {"bitrate": bitrate(), "messages": messages,
             "worst_percent": max(load_without(messages, left_out) for left_out in (OF_FOUR_WHEELS, OF_TWO_SIDES))}
    if path is not None:
        seconds, measured = measure(path)
        for message in messages:
            message.update(measured.pop(message["name"], {"frames": 0, "bits": 0}))
        messages += [{"name": name, "id": None, "bytes": None, "cycle_ms": None, "worst_bits": None,
                      "load_percent": None, **counts} for name, counts in sorted(measured.items())]
        for message in messages:
            message["measured_percent"] = 100 * message["bits"] / seconds / bitrate()
        about.update(log_s=seconds, measured_percent=sum(message["measured_percent"] for message in messages))
    return about


def _cell(value, digits=None):
    return "–" if value is None else str(value) if digits is None else f"{value:.{digits}f}"


def print_result(about):
    measured = "measured_percent" in about
    rows = [("message", "id", "bytes", "cycle ms", "worst bits", "worst %", *(("frames", "measured %") * measured))]
    for message in about["messages"]:
        row = [message["name"], _cell(message["id"]), _cell(message["bytes"]), _cell(message["cycle_ms"]),
               _cell(message["worst_bits"]), _cell(message["load_percent"], 3)]
        if measured:
            row += [str(message["frames"]), _cell(message["measured_percent"], 3)]
        rows.append(row)
    total = ["sum", "", "", "", "", _cell(about["worst_percent"], 3)]
    if measured:
        total += [str(sum(message["frames"] for message in about["messages"])), _cell(about["measured_percent"], 3)]
    print_aligned([*rows, total])


def figures(about):
    bar = {"op": "<=", "value": BAR_PERCENT}
    shown = [("CAN bus load, worst case by the DBC", about["worst_percent"])]
    if "measured_percent" in about:
        shown.append(("CAN bus load, measured", about["measured_percent"]))
    return [{"name": name, "value": value, "unit": "%", "bound": bar, "command": COMMAND} for name, value in shown]


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--log", metavar="FILE", type=Path, help="of candump, or .asc or .blf")
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the table as JSON too")
    parser.add_argument("--bench", metavar="FILE", type=Path, help="write the sums for `make figures`")
    options = parser.parse_args()
    about = result(options.log)
    print_result(about)
    for path, content in ((options.json, about), (options.bench, figures(about))):
        if path is not None:
            write_whole(path, json.dumps(content, indent=1) + "\n")
            print(f"wrote {shown_path(path)}")
    return 0


if __name__ == "__main__":
    run(main)
