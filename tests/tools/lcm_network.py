"""What the LCM tests share in their network namespace: the address, and the line of jp-lcm, which acknowledges each
frame that it reads."""
import os
import time
import tty
from pathlib import Path

GROUP, PORT = "239.255.76.67", 7667
URL = f"udpm://{GROUP}:{PORT}?ttl=0"
PATIENCE = 600  # s, for what takes a moment on an idle machine
OPEN, OPENED = b"S8\rO\r", b"\r\r"
FRAME, ACKNOWLEDGED = b"t7FF0", b"z"  # a frame that means nothing to anybody


def wait_until_taken():
    """No datagram waits in a socket of this namespace."""
    end = time.monotonic() + PATIENCE
    while any(line.split()[4].split(":")[1] != "00000000" for line in
              Path("/proc/self/net/udp").read_text().splitlines()[1:]):
        assert time.monotonic() < end, "datagrams are not taken"
        time.sleep(0.001)


def open_line(path):
    """The channel is open."""
    line = os.open(path, os.O_RDWR | os.O_NOCTTY)
    tty.setraw(line)
    os.write(line, OPEN)
    heard = b""
    while OPENED not in heard:
        heard += os.read(line, 4096)
    return line, heard.replace(OPENED, b"", 1)
