#!/usr/bin/env python3
"""Drives a Joulepath robot along a route, knowing only joulepath.dbc:

    third_party_client.py --bus can:vcan0 10,10 20,15
"""
import argparse
import struct
import sys
import time
import zlib
from pathlib import Path

import can
import cantools
from e2e.p02 import e2e_p02_protect

DBC = cantools.database.load_file(Path(__file__).resolve().parents[2] / "hal/can/joulepath.dbc")


class Robot:
    def __init__(self, bus, clock=time.monotonic):
        self.bus, self.clock, self.counters, self.heard = bus, clock, {}, {}
        self.command, self.next_command = {"Mode": "Stand", "RouteId": 0}, 0.0

    def send(self, name, **signals):
        message = DBC.get_message_by_name(name)
        data = bytearray(message.encode({"Crc": 0, "Counter": self.counters.get(name, 0), **signals}))
        e2e_p02_protect(data, bytes([message.dbc.attributes["E2EDataId"].value] * 16))
        self.counters[name] = data[1] & 15
        self.bus.send(can.Message(arbitration_id=message.frame_id, data=data, is_extended_id=False))

    def wait(self, message, signal, values, seconds):
        """Go on commanding until the signal has one of the values; False: it has not."""
        end = self.clock() + seconds
        while str(self.heard.get(message, {}).get(signal)) not in values and self.clock() < end:
            if self.clock() >= self.next_command:
                self.send("OperatorCommand", **self.command)
                self.next_command = self.clock() + 0.1
            self.listen(0.01)
        return str(self.heard.get(message, {}).get(signal)) in values

    def listen(self, seconds):
        """To the next frame."""
        frame = self.bus.recv(seconds)
        if frame is not None and frame.arbitration_id in (384, 387):
            name = DBC.get_message_by_frame_id(frame.arbitration_id).name
            self.heard[name] = DBC.decode_message(name, frame.data)

    def offer(self, route_id, points):
        raw = [round(value * 65536) for point in points for value in point]
        crc = zlib.crc32(struct.pack(f"<{len(raw)}i", *raw))
        self.send("RouteOffer", RouteId=route_id, Length=len(points), RouteCrc=crc)
        for x, y in points:
            end = self.clock() + 0.002
            while self.clock() < end:
                self.listen(end - self.clock())
            self.send("Waypoint", X=x, Y=y)

    def drive(self, points):
        """What went wrong, or None."""
        # One that has lost its last operator balances, but needs a Stand of the new one.
        stands = self.wait("EcuStatus", "State", ["Standing"], 20)
        if not stands or not self.wait("EcuStatus", "OperatorState", ["Alive"], 20):
            return "the robot does not stand up"
        for _ in range(3):  # a frame may be lost
            route_id = self.heard.get("RouteStatus", {}).get("RouteId", 0) % 255 + 1
            self.offer(route_id, points)
            self.wait("RouteStatus", "RouteId", [str(route_id)], 1)
            if self.wait("RouteStatus", "State", ["Ready"], 1):
                break
        else:
            return f"the route is not taken: {self.heard.get('RouteStatus')}"
        self.command = {"Mode": "Drive", "RouteId": route_id}
        if not self.wait("RouteStatus", "State", ["Driving"], 5):
            return f"the robot does not set off: {self.heard}"
        self.wait("RouteStatus", "State", ["Done", "Stopped"], 3600)
        return None if str(self.heard["RouteStatus"]["State"]) == "Done" else f"the robot stopped: {self.heard}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--bus", required=True, help="can:vcan0, slcan:/dev/ttyACM0 …")
    parser.add_argument("points", nargs="+", metavar="X,Y", help="waypoints, m")
    options = parser.parse_args()
    kind, channel = options.bus.split(":", 1)
    points = [tuple(map(float, point.split(","))) for point in options.points]
    with can.Bus(interface={"can": "socketcan"}.get(kind, kind), channel=channel, bitrate=1000000) as bus:
        sys.exit(Robot(bus).drive(points))


if __name__ == "__main__":
    main()
