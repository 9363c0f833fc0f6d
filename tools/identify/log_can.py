"""Logs of the CAN bus: candump's files and its text with times, or .asc and .blf; decoded as joulepath.dbc says.

A bus that carries the samples tells of encoders, gyros and currents a thousand times a second. A robot whose sensors
are on its board tells what it has made of them, 50 times a second. Frames are decoded by the column: a log holds a
million.
"""
import re
from dataclasses import dataclass

import numpy as np

from tools.common import ToolError, read_text
from tools.identify.samples import Log, Segment, spans_where
from tools.operate.can_messages import GROUPS, data_ids, database
from tools.operate.can_report import read_frames

BINARY = (".asc", ".blf")
DRIVES = ("Standing", "Driving")  # states in which the motors are on
COUNTER_VALUES = 16

# `(1436509052.249713) can0 044#2A36` and `(1436509052.249713)  can0  044   [2]  2A 36`.
LINE = re.compile(r"\s*(?:\((?P<time>[\d.]+)\)\s+)?\S+\s+(?P<id>[0-9A-Fa-f]{3})"
                  r"(?:#(?P<data>[0-9A-Fa-f]*)|\s+\[\d\]\s+(?P<bytes>(?:[0-9A-Fa-f]{2} ?)*))\s*(?:[RT]x?|'.*)?\s*$")
CRC_POLYNOMIAL = 0x2F


@dataclass(frozen=True)
class Frames:
    """Those of one message, in the order of the log."""
    places: np.ndarray  # in the log
    times: np.ndarray   # s
    data: np.ndarray    # a row of bytes each

    def chosen(self, which):
        return Frames(self.places[which], self.times[which], self.data[which])

    def __len__(self):
        return len(self.places)


# ---- reading -------------------------------------------------------------------------------------------------------

def lines_of(path):
    """(time or None, id, bytes) of each frame of candump's files. ToolError names the line."""
    for number, line in enumerate(read_text(path).splitlines(), start=1):
        if not line.strip():
            continue
        parts = line.split()
        if len(parts) >= 3 and line[0] == "(" and parts[2][3:4] == "#":
            yield number, parts[0][1:-1], parts[2][:3], parts[2][4:]
            continue
        found = LINE.match(line)
        if found:
            yield number, found["time"], found["id"], (found["data"] or found["bytes"] or "").replace(" ", "")
        elif "#" not in line and "[" not in line:
            raise ToolError(f"{path}: line {number}: no frame as candump writes it; record with candump -l can0")


def text_frames(path):
    known = {f"{message.frame_id:03X}": message for message in database().messages}
    gathered = {message.name: ([], [], []) for message in known.values()}
    for number, time, identifier, data in lines_of(path):
        message = known.get(identifier.upper())
        if message is None or len(data) != 2 * message.length:
            continue
        if time is None:
            raise ToolError(f"{path}: line {number}: no time; record with candump -l can0, or candump -ta can0")
        places, times, octets = gathered[message.name]
        places.append(number)
        times.append(time)
        octets.append(data)
    return {name: (places, numbers_of(path, places, times, float),
                   b"".join(numbers_of(path, places, octets, bytes.fromhex)))
            for name, (places, times, octets) in gathered.items()}


def numbers_of(path, places, texts, convert):
    """ToolError names the line of the first that is none."""
    try:
        return [convert(text) for text in texts]
    except ValueError:
        for place, text in zip(places, texts):
            try:
                convert(text)
            except ValueError:
                raise ToolError(f"{path}: line {place}: {text!r} is damaged; leave the line out, or record again with "
                                "candump -l can0") from None
        raise


def binary_frames(path):
    names = {message.frame_id: message for message in database().messages}
    gathered = {message.name: ([], [], bytearray()) for message in names.values()}
    for place, frame in enumerate(read_frames(path)):
        message = names.get(frame.arbitration_id)
        if message is None or frame.is_extended_id or len(frame.data) != message.length:
            continue
        places, times, octets = gathered[message.name]
        places.append(place)
        times.append(frame.timestamp)
        octets += frame.data
    return gathered


def read_messages(path):
    """Frames by the name of their message."""
    gathered = binary_frames(path) if path.suffix in BINARY else text_frames(path)
    messages = {name: Frames(np.array(places), np.array(times),
                             np.frombuffer(bytes(octets), np.uint8).reshape(len(places), -1))
                for name, (places, times, octets) in gathered.items() if places}
    if not messages:
        raise ToolError(f"{path}: no frame of joulepath.dbc; is this the log of the robot's bus?")
    return messages


# ---- protection ----------------------------------------------------------------------------------------------------

def _crc_table():
    table = np.arange(256, dtype=np.uint16)
    for _ in range(8):
        table = np.where(table & 0x80, table << 1 ^ CRC_POLYNOMIAL, table << 1) & 0xFF
    return table.astype(np.uint8)


CRC_TABLE = _crc_table()


def crc_of(octets):
    """CRC-8H2F of each row."""
    crc = np.full(len(octets), 0xFF, np.uint8)
    for column in octets.T:
        crc = CRC_TABLE[crc ^ column]
    return crc ^ 0xFF


def are_right(name, frames, others=()):
    """Which frames are as they were sent; all of those that are not protected."""
    ids = data_ids(database().get_message_by_name(name))
    if ids is None:
        return np.ones(len(frames), bool)
    identifier = np.full((len(frames), 1), ids[0], np.uint8)
    return crc_of(np.hstack([frames.data[:, 1:], *others, identifier])) == frames.data[:, 0]


# ---- signals -------------------------------------------------------------------------------------------------------

def raw_of(frames, signal):
    """Little-endian, as all of the DBC."""
    padded = np.zeros((len(frames), 8), np.uint8)
    padded[:, :frames.data.shape[1]] = frames.data
    word = padded.view("<u8")[:, 0]
    raw = (word >> np.uint64(signal.start)) & np.uint64((1 << signal.length) - 1)
    if not signal.is_signed:
        return raw.astype(np.int64)
    shift = np.uint64(64 - signal.length)
    return (raw << shift).view(np.int64) >> np.int64(shift)


def decoded(name, frames):
    """Raw numbers by signal, and scaled ones."""
    message = database().get_message_by_name(name)
    return {signal.name: raw_of(frames, signal) * signal.scale + signal.offset for signal in message.signals}


def state_is(frames, names):
    choices = database().get_message_by_name("EcuStatus").get_signal_by_name("State").choices
    wanted = [value for value, name in choices.items() if str(name) in names]
    return np.isin(decoded("EcuStatus", frames)["State"], wanted)


def last_before(frames, places):
    """Index of the last frame before each place; -1: none."""
    return np.searchsorted(frames.places, places) - 1


# ---- samples at the control rate -----------------------------------------------------------------------------------

def samples(messages):
    """Three Frames of equal length, of whole and undamaged samples; and how many were damaged."""
    names = (*GROUPS["CurrentSensors"], "CurrentSensors")
    if any(name not in messages for name in names):
        return None, 0
    wheel, balance, current = (messages[name] for name in names)
    before = [last_before(part, current.places) for part in (wheel, balance)]
    whole = (before[0] >= 0) & (before[1] >= 0)
    wheel, balance, current = wheel.chosen(before[0][whole]), balance.chosen(before[1][whole]), current.chosen(whole)
    right = are_right("CurrentSensors", current, (wheel.data, balance.data))
    if not right.any():
        return None, len(right)
    return [part.chosen(right) for part in (wheel, balance, current)], int(np.count_nonzero(~right))


def sample_times(times, counters, rate):
    """Without the jitter of who wrote them down: samples come evenly, and their counter tells how many were lost."""
    counted = np.diff(counters).astype(int) % COUNTER_VALUES
    rounds = np.round((np.diff(times) * rate - counted) / COUNTER_VALUES)
    ticks = np.concatenate([[0], np.cumsum(np.maximum(counted + COUNTER_VALUES * rounds, 1))])
    return np.polyval(np.polyfit(ticks, times, 1), ticks)


def unwrapped(counts, bits, per_turn):
    """rad."""
    half = 1 << (bits - 1)
    steps = (np.diff(counts).astype(np.int64) + half) % (2 * half) - half
    return np.concatenate([[0], np.cumsum(steps)]) * (2 * np.pi / per_turn)


def rounded_duty(duty, bits):
    """As the timer of the bridges makes it."""
    return np.round(duty * (1 << bits)) / (1 << bits) if bits > 0 else duty


def add_samples(log, parts, commands, robot):
    """The voltage between two samples is the duty that was commanded after the first by the bus voltage that the second
    tells, and its current that of the second."""
    wheel, balance, current = (decoded(name, frames) for name, frames in
                               zip((*GROUPS["CurrentSensors"], "CurrentSensors"), parts))
    rate = robot.positive("control.rate_hz")
    times = sample_times(parts[2].times, current["Counter"], rate)
    bits = database().get_message_by_name("WheelSensors").get_signal_by_name("EncoderLeft").length
    for side, name in (("left", "Left"), ("right", "Right")):
        log.add(f"wheel_{side}", times, unwrapped(wheel[f"Encoder{name}"], bits,
                                                  robot.positive("encoder.counts_per_turn")))
        log.add(f"current_{side}", times, current[f"Current{name}"])
    log.add("pitch_rate", times, balance["PitchRate"] * 2 * np.pi)
    log.add("yaw_rate", times, current["YawRate"] * 2 * np.pi)
    log.add("bus_voltage", times, wheel["BusVoltage"])
    if commands is not None:
        bits = int(robot.given("pwm.bits", 0))
        add_commands(log, times, parts[2].places, commands, wheel["BusVoltage"], current, bits)


def add_commands(log, times, places, commands, bus, current, bits):
    signals = decoded("MotorCommand", commands)
    last = last_before(commands, places)
    duties = {side: np.where(last >= 0, rounded_duty(signals[f"Duty{side}"], bits)[last], 0)
              for side in ("Left", "Right")}
    for side, duty in duties.items():
        log.add(f"voltage_{side.lower()}", times, duty * bus)
    log.add("motors_current", times, sum(duty * current[f"Current{side}"] for side, duty in duties.items()))
    log.active = spans_where(times, (last >= 0) & (signals["Enabled"][last] == 1))


# ---- telemetry -----------------------------------------------------------------------------------------------------

# Channel, signal and factor of each message.
TELEMETRY = {
    "Motion": (("speed", "Speed", 1), ("turn_rate", "YawRate", 2 * np.pi), ("pitch", "Pitch", 2 * np.pi),
               ("pitch_rate", "PitchRate", 2 * np.pi)),
    "Motors": (("voltage_left", "VoltageLeft", 1), ("voltage_right", "VoltageRight", 1)),
    "Reference": (("reference_speed", "Speed", 1), ("reference_turn_rate", "YawRate", 2 * np.pi)),
    "EnergySpent": (("spent", "Energy", 1),),
    "EnergyDrawn": (("drawn", "Energy", 1),),
    "BatteryStatus": (("battery_voltage", "Voltage", 1), ("battery_current", "Current", 1)),
}


def add_telemetry(log, messages):
    for name, channels in TELEMETRY.items():
        if name not in messages:
            continue
        signals = decoded(name, messages[name])
        for channel, signal, factor in channels:
            if not log.has(channel):
                log.add(channel, messages[name].times, signals[signal] * factor)
    if not log.active and "EcuStatus" in messages:
        status = messages["EcuStatus"]
        log.active = spans_where(status.times, state_is(status, DRIVES))


def add_segments(log, messages):
    """A result follows the forecast and the shape of its segment, which begins as long before it as it lasts."""
    if any(name not in messages for name in ("SegmentResult", "SegmentShape", "SegmentForecast")):
        return
    results, shapes, forecasts = (messages[name] for name in ("SegmentResult", "SegmentShape", "SegmentForecast"))
    result, shape, forecast = (decoded(name, frames) for name, frames in
                               (("SegmentResult", results), ("SegmentShape", shapes), ("SegmentForecast", forecasts)))
    for i, place in enumerate(results.places):
        number = result["Segment"][i]
        told = np.flatnonzero((shapes.places < place) & (shape["Segment"] == number))
        planned = np.flatnonzero((forecasts.places < place) & (forecast["Segment"] == number))
        if len(told):
            end = float(results.times[i])
            log.segments.append(Segment(end - float(shape["Duration"][told[-1]]), end,
                                        float(forecast["Energy"][planned[-1]]) if len(planned) else None,
                                        float(result["Spent"][i]), float(result["Drawn"][i])))


def in_simulated_time(messages, rate):
    """Where a simulation went in lockstep, its own time."""
    if "SimTime" not in messages:
        return messages
    clock = messages["SimTime"]
    ticks = decoded("SimTime", clock)["Tick"]
    begun = np.flatnonzero(ticks < 1 << 31)
    clock, ticks = clock.chosen(begun), ticks[begun]
    timed = {}
    for name, frames in messages.items():
        last = last_before(clock, frames.places)
        frames = frames.chosen(last >= 0)
        if len(frames):
            timed[name] = Frames(frames.places, ticks[last[last >= 0]] / rate, frames.data)
    return timed


def read(path, robot):
    log = Log(str(path))
    messages = in_simulated_time(read_messages(path), robot.positive("control.rate_hz"))
    parts, log.left_out = samples(messages)
    commands = messages.get("MotorCommand")
    if commands is not None:
        right = are_right("MotorCommand", commands)
        log.left_out += int(np.count_nonzero(~right))
        commands = commands.chosen(right) if right.any() else None
    log.is_estimated = parts is None
    if parts is not None:
        add_samples(log, parts, commands, robot)
    add_telemetry(log, messages)
    add_segments(log, messages)
    return log
