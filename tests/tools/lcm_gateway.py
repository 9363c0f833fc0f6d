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
from pathlib import Path

import lcm
from lcm_network import ACKNOWLEDGED, FRAME, GROUP, PATIENCE, PORT, URL, open_line, wait_until_taken

BUILD = Path(os.environ.get("JP_BUILD", Path(__file__).resolve().parents[2] / "build")).resolve()
PASSES = 500


class Gateway:
    """jp-lcm, and its line, whose channel it opens when it hears LCM."""

    def __init__(self, folder):
        path = folder / "bus"
        self.process = subprocess.Popen([BUILD / "bin" / "jp-lcm", "--bus", f"pty:{path}", "--lcm", URL],
                                        stdout=subprocess.PIPE, text=True)
        while not path.exists():
            assert self.process.poll() is None, "jp-lcm has ended"
            time.sleep(0.01)
        self._line, self.heard = open_line(path)

    def let_pass(self):
        """It looks after its bus and then after LCM: what is there before the first frame has been taken by the second."""
        answer = ACKNOWLEDGED + b"\r"
        for _ in range(2):
            os.write(self._line, FRAME + b"\r")
            heard = b""
            while answer not in heard:
                heard += os.read(self._line, 4096)
            self.heard += heard.replace(answer, b"", 1)

    def stop(self):
        self.process.send_signal(signal.SIGINT)
        self.said, _ = self.process.communicate(timeout=PATIENCE)
        os.set_blocking(self._line, False)
        try:
            self.heard += os.read(self._line, 4096)
        except OSError:
            pass  # the line has hung up, and nothing is left
        return self.process.returncode


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
