"""The robot's body on CAN in lockstep, in the place of jp-plant: samples and SimTime out, MotorCommand and SimDone in.

The bus is an SLCAN adapter on a pseudo-terminal, made here. An operator uses it as a bus of python-can: while it waits
for frames, simulated time passes.
"""
import ctypes
import os
import pty
import select
import signal
import subprocess
import tty
from collections import deque

import can
from e2e.p02 import e2e_p02_check, e2e_p02_protect

from tools.common import ToolError
from tools.operate.can_messages import GROUPS, data_ids, database

PATIENCE = 30.0    # s without an answer of the ECU
ASK_AGAIN = 0.5    # s
HOLD = 0.040       # s that the bridges hold their duty without commands, as joulepath.dbc says
POWER_OFF = 0xFFFFFFFF  # the tick before the first: the ECU begins afresh
BUFFER = 1 << 16
PR_SET_PDEATHSIG = 1  # of Linux


class Message:
    """Packs raw integers; signals' places and scales are the DBC's."""

    def __init__(self, name):
        message = database().get_message_by_name(name)
        self.id, self.length = message.frame_id, message.length
        self.ids = data_ids(message)
        self._signals = [(signal.name, signal.start, (1 << signal.length) - 1, 1 / signal.scale,
                          *self._range(signal), signal.is_signed) for signal in message.signals]
        self._heads = {}

    @staticmethod
    def _range(signal):
        """Of the raw value."""
        bits = signal.length
        return (-(1 << bits - 1), (1 << bits - 1) - 1) if signal.is_signed else (0, (1 << bits) - 1)

    def pack(self, signals, wrapping=()):
        """The bytes; values beyond the range are its ends, but counts wrap."""
        word = 0
        for name, start, mask, ones, low, high, _ in self._signals:
            value = signals.get(name)
            if value is None:
                continue
            raw = round(value * ones)
            if name not in wrapping:
                raw = min(max(raw, low), high)
            word |= (raw & mask) << start
        return bytearray(word.to_bytes(self.length, "little"))

    def checked(self, data):
        """Its signals; None where the data are not what was sent."""
        if len(data) != self.length or not e2e_p02_check(data, self.ids, length=len(data)):
            return None
        return self.unpack(data)

    def unpack(self, data):
        word = int.from_bytes(data, "little")
        result = {}
        for name, start, mask, ones, _, high, signed in self._signals:
            raw = word >> start & mask
            result[name] = (raw - mask - 1 if signed and raw > high else raw) / ones
        return result


class SidesLink:
    """The samples and commands of a robot with two bridges."""

    def __init__(self, world):
        self._world, self._counter = world, 0
        self._wheels, self._balance, self._currents = map(Message, (*GROUPS["CurrentSensors"], "CurrentSensors"))
        self._command = Message("MotorCommand")

    def sample(self):
        """The frames of this tick."""
        signals = self._world.read()
        signals["SampleCounter"] = signals["Counter"] = self._counter
        parts = [message.pack(signals, ("EncoderLeft", "EncoderRight")) for message in
                 (self._currents, self._wheels, self._balance)]
        whole = parts[0] + parts[1] + parts[2]
        # Protecting counts on: the parts bear the number that the whole is given.
        self._counter = (self._counter + 1) % 16
        whole[8] = whole[8] & 0xF0 | self._counter
        whole[16] = whole[16] & 0xF0 | self._counter
        e2e_p02_protect(whole, self._currents.ids)
        return [(self._wheels.id, bytes(whole[8:16])), (self._balance.id, bytes(whole[16:24])),
                (self._currents.id, bytes(whole[0:8]))]

    def obey(self, id, data):
        """True when it was a command and is obeyed."""
        signals = self._command.checked(data) if id == self._command.id else None
        if signals is None:
            return False
        self._world.command(signals["Enabled"], signals["DutyLeft"], signals["DutyRight"])
        return True

    def switch_off(self):
        self._world.command(False, 0.0, 0.0)


class Line:
    """An SLCAN adapter whose host opens the far end of a pseudo-terminal."""

    def __init__(self):
        self._own, self._far = pty.openpty()
        for end in (self._own, self._far):
            tty.setraw(end)
        self.name = os.ttyname(self._far)
        self._received = b""

    def close(self):
        os.close(self._own)
        os.close(self._far)

    def send(self, frames):
        os.write(self._own, "".join(f"t{id:03X}{len(data):X}{data.hex().upper()}\r" for id, data in frames).encode())

    def receive(self, seconds):
        """Frames that have come; [] after so long without any."""
        if not select.select([self._own], [], [], seconds)[0]:
            return []
        *lines, self._received = (self._received + os.read(self._own, BUFFER)).split(b"\r")
        frames = []
        for line in lines:
            if line[:1] == b"t":
                frames.append((int(line[1:4], 16), bytes.fromhex(line[5:].decode())))
            else:  # a command of the host
                os.write(self._own, b"\r")
        return frames


def framed(seconds, id, data):
    return can.Message(timestamp=seconds, arbitration_id=id, data=data, is_extended_id=False)


class Lockstep:
    """A world, its link and its ECU. `log` is called with seconds, id and bytes of every frame, `each_tick` after each tick,
    `listen` with
    what an operator sends or hears, and the last sample before it, as frames of python-can. `trouble` tells why the ECU
    cannot answer."""

    def __init__(self, world, link, line, log=None, each_tick=None, listen=None, trouble=lambda: None):
        self.world, self._line, self._log, self._each_tick, self._listen = world, line, log, each_tick, listen
        self._link, self._trouble = link, trouble
        self._last_sample = []
        self._time, self._done = map(Message, ("SimTime", "SimDone"))
        self._silence = 0
        self._outbox, self._inbox = [], deque()
        self._heard = {message.frame_id for message in database().messages if "OPERATOR" in message.receivers}
        self._began = False

    # ---- as a bus of python-can, for an operator

    def send(self, frame, timeout=None):
        self._outbox.append((frame.arbitration_id, bytes(frame.data)))
        if self._listen is not None:
            self._listen(framed(self.seconds, *self._outbox[-1]))

    def recv(self, timeout=None):
        end = self.seconds + (timeout or 0)
        while not self._inbox and self.seconds < end:
            self.tick()
        return self._inbox.popleft() if self._inbox else None

    @property
    def seconds(self):
        """Simulated."""
        return self.world.tick / self.world.rate

    # ---- ticks

    def tick(self):
        if not self._began:
            self._exchange([], POWER_OFF)
            self._began = True
        frames, self._outbox = self._outbox, []
        self._last_sample = self._link.sample()
        self._exchange(frames + self._last_sample, self.world.tick & 0x7FFFFFFF)
        self._watch_silence()
        self.world.step()
        if self._each_tick is not None:
            self._each_tick()

    def _exchange(self, frames, tick):
        frames = frames + [(self._time.id, self._time_of(tick))]
        self._note(frames)
        self._line.send(frames)
        waited = 0.0
        while not self._take(tick):
            waited += ASK_AGAIN
            reason = self._trouble()
            if reason is None and waited > PATIENCE:
                reason = f"no answer for {PATIENCE:g} s"
            if reason is not None:
                raise ToolError(f"ECU: {reason}")

    def _time_of(self, tick):
        return bytes(self._time.pack({"Tick": tick, "Power": int(tick != POWER_OFF), "Rate": self.world.rate}))

    def _take(self, tick):
        """What has come; True when the ECU is done with the tick. It may not have been there when it was asked."""
        frames = self._line.receive(ASK_AGAIN)
        if not frames:
            self._line.send([(self._time.id, self._time_of(tick))])
        self._note(frames)
        done = False
        for id, data in frames:
            if self._link.obey(id, data):
                self._silence = -1
            elif id == self._done.id:
                done = done or self._done.unpack(data)["Tick"] == tick
            elif id in self._heard:
                self._hear(id, data)
        return done

    def _hear(self, id, data):
        frame = framed(self.seconds, id, data)
        self._inbox.append(frame)
        if self._listen is not None:
            for part in self._last_sample:
                self._listen(framed(self.seconds, *part))
            self._listen(frame)

    def _watch_silence(self):
        self._silence += 1
        if self._silence > HOLD * self.world.rate:
            self._link.switch_off()

    def _note(self, frames):
        if self._log is not None:
            for id, data in frames:
                self._log(self.seconds, id, data)


def end_with_parent():
    """A program that outlives a drive would speak on the next terminal of the same name."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


class Ecu:
    """The controller's program on a line, until the block ends."""

    def error(self):
        """Why it has ended, one line; None: it runs."""
        if self._process.poll() is None:
            return None
        lines = self._output.read_text(errors="replace").strip().splitlines()
        return lines[-1] if self._process.returncode > 0 and lines else f"ended with status {self._process.returncode}"

    def __init__(self, program, line, options, output):
        self._arguments = [str(program), "--bus", f"slcan:{line.name}", *options]
        self._output = output

    def __enter__(self):
        with open(self._output, "wb") as output:
            self._process = subprocess.Popen(self._arguments, stdout=output, stderr=subprocess.STDOUT,
                                             preexec_fn=end_with_parent)
        return self

    def __exit__(self, *_):
        self._process.terminate()
        self._process.wait()
