"""The messages of hal/can/joulepath.dbc, with their end-to-end protection (AUTOSAR E2E profile 2)."""
import functools
import re

import can
import cantools
from e2e.p02 import e2e_p02_check, e2e_p02_protect

from tools.common import ROOT

DBC = ROOT / "hal/can/joulepath.dbc"
DATA_ID_LIST_LENGTH = 16  # of the profile

# A message whose CRC goes on over others that came before it.
GROUPS = {"CurrentSensors": ("WheelSensors", "BalanceSensors")}

# Bits in the comment of EcuErrors.Faults.
FAULT = re.compile(r"(\d+) ([^,.]+)")


@functools.cache
def database():
    return cantools.database.load_file(DBC)


@functools.cache
def fault_bits():
    """What each bit of EcuErrors.Faults means."""
    comment = database().get_message_by_name("EcuErrors").get_signal_by_name("Faults").comment
    return {int(bit): name for bit, name in FAULT.findall(comment)}


def fault_names(faults):
    names = [name for bit, name in fault_bits().items() if faults & bit]
    unknown = faults & ~sum(fault_bits())
    return names + ([f"bits 0x{unknown:x}"] if unknown else [])


def data_ids(message):
    """The profile's data id list; None for a message without protection."""
    data_id = message.dbc.attributes.get("E2EDataId")
    return bytes([data_id.value] * DATA_ID_LIST_LENGTH) if data_id is not None else None


class Codec:
    """Between signals and frames; counts the messages that it encodes, and remembers parts of those of several frames.
    """

    def __init__(self):
        self._counters = {}
        self._parts = {}

    def encode(self, name, **signals):
        """The frame of a message; those that are protected are counted on. Values are scaled and in range."""
        message = database().get_message_by_name(name)
        ids = data_ids(message)
        if ids is None:
            data = message.encode(signals)
        else:
            data = bytearray(message.encode({"Crc": 0, "Counter": self._counters.get(name, 0), **signals}))
            e2e_p02_protect(data, ids)
            self._counters[name] = data[1] & 0x0F
        return can.Message(arbitration_id=message.frame_id, is_extended_id=False, data=data)

    def decode(self, frame):
        """(name, signals) of a frame; None for one that the DBC does not know, of a wrong length, or corrupt."""
        message = message_of(frame)
        if message is None or message.length != len(frame.data):
            return None
        if message.name in sum(GROUPS.values(), ()):
            self._parts[message.name] = bytes(frame.data)
        if not self._is_right(message, frame):
            return None
        return message.name, message.decode(frame.data)

    def _is_right(self, message, frame):
        ids = data_ids(message)
        if ids is None:
            return True
        rest = b"".join(self._parts.get(part, b"") for part in GROUPS.get(message.name, ()))
        data = bytes(frame.data) + rest
        return e2e_p02_check(data, ids, length=len(data))


@functools.cache
def _messages_by_id():
    return {message.frame_id: message for message in database().messages}


def message_of(frame):
    """The DBC's message with the id of this frame; None if there is none or the frame is of another kind."""
    if frame.is_extended_id or frame.is_remote_frame or frame.is_error_frame or frame.is_fd:
        return None
    return _messages_by_id().get(frame.arbitration_id)


class SimClock:
    """Time of the lockstep simulation, from SimTime.Tick, which wraps. It begins with the first one, at 0."""

    def __init__(self):
        self._ticks, self._last, self._rate = None, None, None

    def take(self, signals):
        """Of a SimTime; who does not say how long its ticks last is no clock."""
        if not signals["Rate"]:
            return
        tick, self._rate = signals["Tick"], signals["Rate"]
        half = 1 << 31
        step = 0 if self._last is None else (tick - self._last + half) % (2 * half) - half
        self._ticks, self._last = (self._ticks or 0) + step, tick

    @property
    def seconds(self):
        """None before the first tick: there is no simulation, then, or not yet."""
        return None if self._ticks is None else self._ticks / self._rate
