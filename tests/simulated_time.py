"""Simulated time that a test holds: a tick passes only while somebody waits for a frame or an event. So no client on the
bus is too late, however busy the machine is."""
import contextlib
import errno
import os
import select
import sys
import time
import tty

from programs import ROOT

sys.path += [str(ROOT), str(ROOT / "tests/sil")]

import third_party_client  # noqa: E402
from tools.operate.can_client import Listener, Operator, open_bus, operator_filters  # noqa: E402

OPERATOR_HEARS = {heard["can_id"] for heard in operator_filters()}
SIM_TIME, SIM_DONE, FRAME = b"t7F08", b"t7F14", b"t"  # as SLCAN writes them
POWER_OFF = 0xFFFFFFFF  # the tick before the first
RATE = 1000             # ticks a second
LIMIT = 300             # s of the wall's clock without a tick: something hangs
LOOK = 0.1              # s


class HangUp(Exception):
    """The plant closed its line."""


class SimulatedTime:
    """The bus between jp-plant, whose line it opens, and jp-ecu, which is given one. It passes on what they send, but
    lets a tick begin only when a test wants it to. `crowd` are frames of others that come with each."""

    def __init__(self, plant_line, crowd=b""):
        self._plant = os.open(plant_line, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self._plant)
        self._ecus, self._slaves = [], []
        self._crowd, self._parts = crowd, {self._plant: b""}
        self._next = None  # the SimTime that is held back
        self._begun = self._done = POWER_OFF

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for line in (self._plant, *self._ecus, *self._slaves):
            os.close(line)

    def new_line(self):
        """For an ECU."""
        ecu, slave = os.openpty()
        tty.setraw(slave)
        self._ecus.append(ecu)
        self._slaves.append(slave)
        self._parts[ecu] = b""
        return os.ttyname(slave)

    def clock(self):
        """Simulated s."""
        return 0.0 if self._begun == POWER_OFF else self._begun / RATE

    def tick(self, given_up=lambda: False):
        """Let one tick pass, unless it is given up."""
        end, begun = time.monotonic() + LIMIT, False
        while not given_up():
            assert time.monotonic() < end, f"no tick within {LIMIT} s"
            if self._next is not None and (not begun or tick_of(self._next) == self._begun):
                begun = True
                self._begin()
            if begun and self._done == self._begun:
                return
            for line in select.select([self._plant, *self._ecus], [], [], LOOK)[0]:
                self._pass_on(line)

    def run(self, until):
        """Let ticks pass until a condition holds."""
        while not until():
            self.tick(given_up=until)

    def run_until_hang_up(self):
        """Let ticks pass until the plant closes its line, which it does before its process ends."""
        with contextlib.suppress(HangUp):
            while True:
                self.tick()

    def _begin(self):
        """The tick that was held back, or the one that goes on once more."""
        if self._begun != tick_of(self._next):
            self._send([self._plant, *self._ecus], self._crowd)
        self._begun = tick_of(self._next)
        self._send(self._ecus, self._next + b"\r")
        self._next = None

    def _pass_on(self, line):
        *texts, self._parts[line] = (self._parts[line] + self._read(line)).split(b"\r")
        for text in texts:
            if line == self._plant and text.startswith(SIM_TIME):
                self._next = text
                continue
            if text.startswith(FRAME):
                self._overhear(text)
            # Another ECU answers, too, until it hears the first.
            if line == self._ecus[0] and text.startswith(SIM_DONE):
                self._done = tick_of(text)
            hearers = self._ecus if line == self._plant else [self._plant]
            if line in self._ecus and text.startswith(FRAME):
                hearers = [self._plant, *(ecu for ecu in self._ecus if ecu != line)]
            self._send(hearers, text + b"\r")

    def _overhear(self, text):
        """Of a frame that is passed on."""

    @staticmethod
    def _read(line):
        with hang_up_named():
            data = os.read(line, 1 << 16)
        if not data:
            raise HangUp
        return data

    @staticmethod
    def _send(lines, data):
        for line in lines:
            left = data
            while left:
                with hang_up_named():
                    left = left[os.write(line, left):]


@contextlib.contextmanager
def hang_up_named():
    """A pseudo-terminal whose other end was closed gives EIO, or the end of the file to who reads later."""
    try:
        yield
    except OSError as error:
        if error.errno != errno.EIO:
            raise
        raise HangUp from error


def tick_of(text):
    """Of a SimTime or a SimDone: the first four bytes, little-endian."""
    return int.from_bytes(bytes.fromhex(text[len(SIM_TIME):][:8].decode()), "little")


class TimedBus:
    """An operator's bus of python-can, on which simulated time passes while one waits for a frame. With filters of its
    own, python-can does not tell a frame that it leaves out from none."""

    def __init__(self, bus, passing):
        self._bus, self._passing, self._may_hold_more = bus, passing, False
        bus.set_filters(None)

    def send(self, frame):
        self._bus.send(frame)

    def shutdown(self):
        self._bus.shutdown()

    def recv(self, timeout):
        end = self._passing.clock() + timeout
        frame = self._heard()
        while frame is None and self._passing.clock() < end:
            self._passing.tick()
            frame = self._heard()
        return frame

    def _heard(self):
        while self._may_hold_more or select.select([self._bus.fileno()], [], [], 0)[0]:
            frame = self._bus.recv(0)
            self._may_hold_more = frame is not None
            if frame is not None and frame.arbitration_id in OPERATOR_HEARS:
                return frame
        return None


class ThirdParty(third_party_client.Robot):
    """Tells of what it has heard."""

    def __init__(self, bus, clock, watch):
        super().__init__(bus, clock)
        self._watch = watch

    def listen(self, seconds):
        super().listen(seconds)
        self._watch(self.heard)


class Host:
    """A robot for operators on a bus, a serial line by default, whose time passes while they listen."""

    def __init__(self, programs, scenario, bus=None):
        lines = [programs.folder / "ecu-line", programs.folder / "operators-line"]
        self._programs = programs
        self.plant = programs.plant(scenario, "--bus", f"pty:{lines[0]}", "--bus", bus or f"pty:{lines[1]}", "--host",
                                     patience=LIMIT)
        self.plant.opens(*lines[:1 if bus else 2])
        self.time = SimulatedTime(lines[0])
        self.ecu_line = self.time.new_line()
        self.bus = TimedBus(open_bus(bus or f"slcan:{lines[1]}"), self.time)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.time.__exit__()

    def start_ecu(self, *options, line=None):
        return self._programs.ecu(f"slcan:{line or self.ecu_line}", *options)

    def drive(self, *route, watch=lambda state: None):
        """As tools.operate.drive does it."""
        operator = Operator(self.bus, "robot", watch, self.time.clock)
        operator.stand()
        operator.drive_route(route)
        operator.stand()

    def stand(self):
        Operator(self.bus, "robot", clock=self.time.clock).stand()

    def off(self):
        Operator(self.bus, "robot", clock=self.time.clock).off()

    def third_party_drive(self, *route, watch=lambda heard: None):
        failure = ThirdParty(self.bus, self.time.clock, watch).drive(route)
        assert failure is None, failure

    def listen_until(self, condition):
        """The state of the robot in which it holds."""
        listener = Listener(self.bus, "robot", clock=self.time.clock)
        while not condition(listener.state):
            listener.step()
        return listener.state

    def stop(self):
        """The plant's counts."""
        self.bus.shutdown()
        self.plant.process.terminate()
        self.time.run_until_hang_up()
        result = self.plant.wait()
        assert (result.returncode, result.stderr) == (0, "")
        return result.counts
