"""jp-lcm on a bus without a robot: its line is opened, messages are sent to it, and it is told to stop. To be run in a
network namespace of its own; prints what jp-lcm has printed, and writes DIR/heard: what its line said but for the
acknowledgements.

    lcm_gateway.py DIR idle|cut
"""
import os
import signal
import socket
import subprocess
import sys
import time
import tty
from pathlib import Path

import lcm

BUILD = Path(os.environ.get("JP_BUILD", Path(__file__).resolve().parents[2] / "build")).resolve()
GROUP, PORT = "239.255.76.67", 7667
URL = f"udpm://{GROUP}:{PORT}?ttl=0"
PATIENCE = 600  # s, for what takes a moment on an idle machine
PASSES = 500
OPEN, OPENED = b"S8\rO\r", b"\r\r"
FRAME, ACKNOWLEDGED = b"t7FF0\r", b"z\r"


class Gateway:
    """jp-lcm that is ready for messages, and its line, which is open."""

    def __init__(self, folder):
        path = folder / "bus"
        self.process = subprocess.Popen([BUILD / "bin" / "jp-lcm", "--bus", f"pty:{path}", "--lcm", URL],
                                        stdout=subprocess.PIPE, text=True)
        self.said = self.process.stdout.readline()
        self.heard = b""
        self._line = os.open(path, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self._line)
        self._ask(OPEN, OPENED)

    def _ask(self, question, answer):
        os.write(self._line, question)
        heard = b""
        while answer not in heard:
            heard += os.read(self._line, 4096)
        self.heard += heard.replace(answer, b"", 1)

    def let_pass(self):
        """It looks after its bus and then after LCM: what is there before the first frame has been taken by the second."""
        for _ in range(2):
            self._ask(FRAME, ACKNOWLEDGED)

    def stop(self):
        self.process.send_signal(signal.SIGINT)
        status = self.process.wait(PATIENCE)
        self.said += self.process.stdout.read()
        os.set_blocking(self._line, False)
        try:
            self.heard += os.read(self._line, 4096)
        except OSError:
            pass  # the line has hung up, and nothing is left
        return status


def wait_until_taken():
    """No datagram waits in a socket of this namespace, which the gateway and this program have."""
    end = time.monotonic() + PATIENCE
    while any(line.split()[4].split(":")[1] != "00000000" for line in
              Path("/proc/self/net/udp").read_text().splitlines()[1:]):
        assert time.monotonic() < end, "datagrams are not taken"
        time.sleep(0.001)


def send_cut_datagrams(link, sender):
    """They end before their channel's name does; what comes before them may stay behind in a buffer."""
    link.publish("JP_ROUTE", b"what a datagram that is too short may leave in a buffer" * 3)
    for length in range(12):
        sender.sendto(b"LC02" + bytes(4) + b"JP_ROUTE\0"[:length], (GROUP, PORT))
    wait_until_taken()


def main():
    folder, what = Path(sys.argv[1]), sys.argv[2]
    gateway = Gateway(folder)
    try:
        link = lcm.LCM(URL)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for _ in range(PASSES):
                if what == "cut":
                    send_cut_datagrams(link, sender)
                gateway.let_pass()
        status = gateway.stop()
    finally:
        gateway.process.kill()
    (folder / "heard").write_bytes(gateway.heard)
    sys.stdout.write(gateway.said)
    sys.exit(status)


main()
