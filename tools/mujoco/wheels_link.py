"""Samples, scans and commands of a robot with four steered wheels as frames of hal/can/joulepath.dbc."""
import math
import zlib

from e2e.p02 import e2e_p02_protect

from tools.mujoco.lockstep import Message

WHEELS = 4
RANGES = 4            # of a ScanRanges
FRAMES_PER_TICK = 31  # of a scan: with the rest less than the half of 1 Mbit/s


def protected(message, signals):
    """The data and the counter that they bear."""
    data = message.pack(signals, ("WheelCount",))
    e2e_p02_protect(data, message.ids)
    return bytes(data), data[1] & 0x0F


class WheelsLink:
    """Four WheelFeedback, a SupplySensors and frames of a scan out; WheelTarget in, four of a counter together."""

    def __init__(self, world):
        self._world = world
        self._feedback, self._supply, self._target = map(Message, ("WheelFeedback", "SupplySensors", "WheelTarget"))
        self._begin, self._ranges, self._end = map(Message, ("ScanBegin", "ScanRanges", "ScanEnd"))
        self._counter = self._begin_counter = self._end_counter = 0
        self._scan = []      # frames that go out in the next ticks
        self._targets = {}   # by wheel, of one counter
        self._targets_counter = None

    # ---- out

    def sample(self):
        """The frames of this tick."""
        if self._world.tick % self._world.scan_ticks == 0:
            self._scan = self._scan_frames(self._world.scan())
        now, self._scan = self._scan[:FRAMES_PER_TICK], self._scan[FRAMES_PER_TICK:]
        return self._wheel_frames() + now

    def _wheel_frames(self):
        counts, angles, voltage, current = self._world.read()
        frames = [(self._feedback.id, protected(self._feedback, {"Counter": self._counter, "Wheel": i, "WheelCount": count,
                                                                 "Angle": angle})[0])
                  for i, (count, angle) in enumerate(zip(counts, angles))]
        data, counter = protected(self._supply, {"Counter": self._counter, "BusVoltage": voltage, "BusCurrent": current})
        self._counter = counter
        return frames + [(self._supply.id, data)]

    def _scan_frames(self, ranges):
        begin, self._begin_counter = protected(self._begin, {"Counter": self._begin_counter, "Beams": len(ranges)})
        frames = [(self._begin.id, begin)]
        crc = 0
        for index in range(math.ceil(len(ranges) / RANGES)):
            values = {f"Range{i}": value for i, value in enumerate(ranges[RANGES * index:][:RANGES])}
            data = bytes(self._ranges.pack({"Index": index, **values}))
            crc = zlib.crc32(data[1:], crc)
            frames.append((self._ranges.id, data))
        end, self._end_counter = protected(self._end, {"Counter": self._end_counter, "RangesCrc": crc})
        return frames + [(self._end.id, end)]

    # ---- in

    def obey(self, id, data):
        """True when it was the last part of a command, which is obeyed then."""
        signals = self._target.checked(data) if id == self._target.id else None
        if signals is None:
            return False
        if signals["Counter"] != self._targets_counter:
            self._targets, self._targets_counter = {}, signals["Counter"]
        self._targets[signals["Wheel"]] = signals
        if len(self._targets) < WHEELS:
            return False
        wheels = [self._targets.pop(wheel) for wheel in range(WHEELS)]
        self._world.command(all(wheel["Enabled"] for wheel in wheels), [wheel["Speed"] for wheel in wheels],
                            [math.tau * wheel["Angle"] for wheel in wheels])
        return True

    def switch_off(self):
        self._world.command(False, [0.0] * WHEELS, [0.0] * WHEELS)
