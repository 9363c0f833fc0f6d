"""QEMU with the image: its serial line, and its debugger's stub to break things with."""
import re
import socket
import subprocess
import time

from programs import BUILD, LIMIT, Program, wait_until

LINE = re.compile(r"char device redirected to (\S+) ")
PC = 15
NOWHERE = 0x00000000  # forbidden by the MPU
SLICE = 0.1  # s between two looks at how far it is: tens of ticks


# The boards that images are made for: where, and what QEMU calls them.
FOLDERS = {"stm32f405": "firmware", "mps2": "mps2"}
MACHINES = {"stm32f405": "netduinoplus2", "mps2": "mps2-an500"}


def image(robot, board="stm32f405"):
    return BUILD / FOLDERS[board] / robot / "emulated.elf"


def address_of(symbol, path):
    names = subprocess.run(["arm-none-eabi-nm", path], capture_output=True, text=True, check=True).stdout
    return int(re.search(rf"^(\w+) \w {symbol}$", names, re.MULTILINE)[1], 16)


class Debugger:
    """The part of GDB's remote protocol that a test needs."""

    def __init__(self, path):
        self._socket = socket.socket(socket.AF_UNIX)
        wait_until(lambda: self._socket.connect_ex(str(path)) == 0, "the stub of QEMU listens")
        self._socket.settimeout(LIMIT)
        self._unread = b""
        self._ask(b"?")
        self._ask(b"qXfer:features:read:target.xml:0,fff")  # from now on it takes single registers

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._socket.close()

    def _send(self, payload):
        self._socket.sendall(b"$" + payload + b"#%02x" % (sum(payload) % 256))

    def _receive(self):
        while not (packet := re.search(rb"\$([^#]*)#..", self._unread)):
            self._unread += self._socket.recv(4096)
        self._unread = self._unread[packet.end():]
        self._socket.sendall(b"+")
        return packet[1]

    def _ask(self, payload):
        self._send(payload)
        answer = self._receive()
        while payload != b"?" and answer.startswith((b"T", b"S")):  # that it has stopped, told late or twice
            answer = self._receive()
        return answer

    def go_on(self):
        self._send(b"c")

    def run(self, seconds):
        """At full speed, which a watched address would cost."""
        self.go_on()
        time.sleep(seconds)
        self._socket.sendall(b"\x03")
        self._receive()

    def run_to_write(self, address):
        """Until the program has written the word there."""
        watch = b"2,%x,4" % address
        assert self._ask(b"Z" + watch) == b"OK"
        self.go_on()
        self._receive()  # before the write
        assert self._ask(b"z" + watch) == b"OK"
        self._send(b"s")
        self._receive()

    def run_to(self, address):
        """Until the program comes to the instruction."""
        place = b"1,%x,2" % address
        assert self._ask(b"Z" + place) == b"OK"
        self.go_on()
        self._receive()
        assert self._ask(b"z" + place) == b"OK"

    def word(self, address):
        """None: not readable where the program is now, such as early in its start."""
        answer = self._ask(b"m%x,4" % address)
        return None if answer.startswith(b"E") else int.from_bytes(bytes.fromhex(answer.decode()), "little")

    def write_word(self, address, word):
        assert self._ask(b"M%x,4:%s" % (address, word.to_bytes(4, "little").hex().encode())) == b"OK"

    def jump(self, address):
        """The next instruction is that one."""
        assert self._ask(b"P%x=%s" % (PC, address.to_bytes(4, "little").hex().encode())) == b"OK"


class Emulator(Program):
    """An image on a board of QEMU; `line` is its first UART. Without a path it is the one of a robot for processor in the
    loop. By a counted clock (`icount`) time passes as the program goes on, not as this machine gets to it."""

    def __init__(self, folder, robot, *, board="stm32f405", machine=None, path=None, debug=False, icount=False):
        self._stub, self.path = folder / "stub", path or image(robot, board)
        machine = machine or MACHINES[board]
        options = [*(["-gdb", f"unix:{self._stub},server=on,wait=off"] if debug else []),
                   *(["-icount", "shift=3"] if icount else [])]
        super().__init__(folder, "qemu", ["qemu-system-arm", "-M", machine, "-nographic", "-monitor", "none",
                                          "-serial", "pty", "-kernel", self.path, *options])
        wait_until(lambda: LINE.search(self.out.read_text()) or not self.running, "the line of QEMU")
        wait_until(lambda: self._stub.exists() or not debug or not self.running, "the stub of QEMU")
        found = LINE.search(self.out.read_text())
        assert found, self.err.read_text()
        self.line = found[1]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()

    def debugger(self):
        """The program stands still from now on."""
        return Debugger(self._stub)

    def crash(self, tick, plant):
        """Makes the program go astray soon after so many ticks of a drive, as a corrupt return address would."""
        debugger = self.debugger()
        counter = address_of("jp_fault_tick", self.path)
        while (debugger.word(counter) or 0) < tick:
            debugger.run(SLICE)
            assert plant.running, plant.err.read_text()
        debugger.run_to_write(counter)
        debugger.jump(NOWHERE)
        debugger.go_on()
        return debugger
