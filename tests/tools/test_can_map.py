"""can_map.py: a drive on a map from frames, with what gets lost, another map, lockstep's time, and logs that hold none."""
import json
import zlib

import can
import numpy as np
import pytest
from conftest import assert_one_line_error, run_tool
from fake_ecu import telemetry

from tools.operate import can_map, map_stream
from tools.operate.can_messages import Codec

CELLS = np.zeros((12, 9), dtype=int)
CELLS[3, 4] = map_stream.OCCUPIED
ORIGIN = map_stream.Place(0.5, 0.25, 90.0)


class Log:
    """Frames 10 ms apart."""

    def __init__(self):
        self.frames, self._codec = [], Codec()

    def add(self, frame):
        frame.timestamp = 100 + 0.01 * len(self.frames)
        self.frames.append(frame)

    def send(self, name, **signals):
        self.add(self._codec.encode(name, **signals))

    def tell(self, name, **signals):
        self.add(telemetry(name, **signals))

    def send_map(self, cells=CELLS, map_id=1, order=None, damage=0):
        stream = map_stream.encode(map_stream.CellMap(cells, 0.1, map_stream.Place(0, 0)), ORIGIN)
        self.send("MapOffer", MapId=map_id, Bytes=len(stream), MapCrc=zlib.crc32(stream) ^ damage)
        for index in order or range(-(-len(stream) // 5)):
            self.send("MapData", Index=index, Data=int.from_bytes(stream[5 * index:][:5], "little"))

    def write(self, path):
        with can.Logger(str(path)) as logger:
            for frame in self.frames:
                logger(frame)
        return path


def drive(log):
    log.tell("EnergySpent", Energy=2.5)
    log.tell("NavigationStatus", State="Driving", Course=7, LegsLeft=2, HasCourse=1)
    log.tell("CourseLeg", Course=7, After=1, X=1.5, Y=0.25)
    log.tell("CourseLeg", Course=7, After=0, X=2.0, Y=0.75)
    log.tell("NavigationProgress", Distance=1.5, Duration=4.0, Energy=8.0, Deviation=0.5)
    log.tell("HomeStatus", HomeState="Seeking")
    log.tell("HomeStatus", HomeState="Suffices", Probability=0.75, Way=6.5, WayDeviation=1.5)
    log.tell("Pose", X=0.25, Y=0.0)
    log.send("CellChanges", MapId=1, Column=7, Row=2, Cells=0xFFFFFC | 1)
    log.tell("Pose", X=0.5, Y=0.125)
    log.tell("NavigationStatus", State="Arrived")


@pytest.fixture
def log():
    return Log()


def converted(log, tmp_path):
    return can_map.convert(log.write(tmp_path / "drive.log"))


def test_map_way_and_courses(log, tmp_path):
    log.send_map()
    drive(log)
    cell_map, origin, found = converted(log, tmp_path)
    assert (cell_map.cells == CELLS).all() and origin == ORIGIN
    assert [point[1:] for point in found.way] == [pytest.approx((0.5, 0.5)), pytest.approx((0.375, 0.75))]
    assert can_map.courses_of(found) == [[(1.5, 0.25), (2.0, 0.75)]]
    assert [change[1:] for change in found.changes] == [(7, 2, map_stream.OCCUPIED)]
    assert [state[1:] for state in found.states] == [("Driving", "None"), ("Arrived", "None")]
    assert found.left[0][1:] == (1.5, 4.0, 8.0, 0.5) and found.energy[0][1] == 2.5
    assert [told[1:] for told in found.home] == [(0.75, 6.5, 1.5)]


def test_what_is_sent_again_counts_once(log, tmp_path):
    count = -(-len(map_stream.encode(map_stream.CellMap(CELLS, 0.1, None), ORIGIN)) // 5)
    log.send_map(order=[0, 1, 3, 4, 2, 2, *range(1, count)])
    drive(log)
    assert (converted(log, tmp_path)[0].cells == CELLS).all()


def test_another_map_begins_anew(log, tmp_path):
    log.send_map()
    drive(log)
    other = 1 - np.minimum(CELLS, 1)
    log.send_map(other, map_id=2)
    log.tell("Pose", X=0.0, Y=0.0)
    cell_map, _, found = converted(log, tmp_path)
    assert (cell_map.cells == other).all()
    assert len(found.way) == 1 and not found.courses and not found.changes


@pytest.mark.parametrize("rate", (1000, 100))
def test_time_is_that_of_the_simulation(log, tmp_path, rate):
    log.tell("SimTime", Tick=5 * rate, Rate=rate)
    log.send_map()
    log.tell("SimTime", Tick=7 * rate, Rate=rate)
    log.tell("SimTime", Tick=9 * rate)  # who does not say how long a tick lasts is no clock
    drive(log)
    assert converted(log, tmp_path)[2].way[0][0] == pytest.approx(2.0)


@pytest.mark.parametrize("make", [drive, lambda log: log.send_map(damage=1), lambda log: log.send_map(order=[0, 2, 3])])
def test_a_log_without_a_map(log, tmp_path, make):
    make(log)
    result = run_tool("operate.can_map", log.write(tmp_path / "drive.log"), tmp_path / "out")
    assert_one_line_error(result, "no whole map")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("make", [lambda log: None, drive])
def test_writes_picture_and_numbers(log, tmp_path, make):
    log.send_map()
    make(log)
    result = run_tool("operate.can_map", log.write(tmp_path / "drive.log"), tmp_path / "out")
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "out/map.png").read_bytes().startswith(b"\x89PNG")
    written = json.loads((tmp_path / "out/map.json").read_text())
    assert (written["width"], written["height"], written["origin"]) == (9, 12, [0.5, 0.25, 90.0])


def test_input_that_is_no_log(tmp_path):
    assert_one_line_error(run_tool("operate.can_map", tmp_path / "no.log", tmp_path / "out"), "no.log")
    assert_one_line_error(run_tool("operate.can_map", tmp_path / "no.txt", tmp_path / "out"), "must end in")
