"""Logs of lcm-logger: JP_STATE, JP_PLAN and JP_ENERGY, as jp-lcm publishes them."""
import math
import struct

import lcm
import numpy as np

from tools.common import ToolError
from tools.identify.samples import Log, Segment, spans_where
from tools.operate.lcm_report import US_PER_S, load_types

SYNC = bytes.fromhex("eda1da01")  # with which each event begins
STATES_ON = (1, 2)                # Standing, Driving

# s: JP_STATE goes out with Motors, and hal/app/telemetry.c sends Motion and Reference so much before.
AGES = dict.fromkeys(("speed", "turn_rate", "pitch", "pitch_rate"), 0.008) | dict.fromkeys(
    ("reference_speed", "reference_turn_rate"), 0.004)

STATE = {"speed": "speed", "turn_rate": "turn_rate", "pitch": "pitch", "pitch_rate": "pitch_rate",
         "voltage_left": "voltage_left", "voltage_right": "voltage_right", "current_left": "current_left",
         "current_right": "current_right", "reference_speed": "reference_speed",
         "reference_turn_rate": "reference_turn_rate"}
ENERGY = {"spent": "spent", "drawn": "drawn", "battery_voltage": "battery_voltage",
          "battery_current": "battery_current"}


def messages_of(path, channels):
    """Decoded messages by channel, and how many were not of their type."""
    try:
        log = lcm.EventLog(str(path), "r")
    except (OSError, ValueError) as error:
        raise ToolError(f"{path}: {getattr(error, 'strerror', None) or error}") from None
    found, bad = {channel: [] for channel in channels}, 0
    for event in log:
        if event.channel not in channels:
            continue
        try:
            found[event.channel].append(channels[event.channel].decode(event.data))
        except (ValueError, struct.error, IndexError):
            bad += 1
    log.close()
    return found, bad


def add_channels(log, messages, channels):
    times = np.array([message.utime / US_PER_S for message in messages])
    for name, member in channels.items():
        values = [getattr(message, member) for message in messages]
        if any(values):  # what was not heard is 0
            log.add(name, times - AGES.get(name, 0.0), values)


def add_segments(log, plans, energies):
    """A segment's result comes when it ends; the plan tells how long it took."""
    ended, place = 0, 0
    latest = {}
    for energy in energies:
        while place < len(plans) and plans[place].utime <= energy.utime:
            if plans[place].segment_count <= 1:
                latest = {}
            latest |= {segment.index: segment for segment in plans[place].segments}
            place += 1
        if energy.segment not in (0, ended) and energy.segment in latest:
            end, duration = energy.utime / US_PER_S, latest[energy.segment].duration
            if not math.isnan(duration):
                forecast = energy.segment_forecast
                log.segments.append(Segment(end - duration, end, None if math.isnan(forecast) else forecast,
                                            energy.segment_spent, energy.segment_drawn))
        ended = energy.segment


def read(path, robot):
    types = load_types()
    messages, bad = messages_of(path, {"JP_STATE": types.state_t, "JP_PLAN": types.plan_t, "JP_ENERGY": types.energy_t})
    states = messages["JP_STATE"]
    if not states:
        raise ToolError(f"{path}: no message on JP_STATE; is this a log of lcm-logger, taken beside jp-lcm?")
    log = Log(str(path), is_estimated=True, left_out=bad)
    add_channels(log, states, STATE)
    add_channels(log, messages["JP_ENERGY"], ENERGY)
    log.active = spans_where([state.utime / US_PER_S for state in states],
                             [state.robot_state in STATES_ON for state in states])
    add_segments(log, messages["JP_PLAN"], messages["JP_ENERGY"])
    return log
