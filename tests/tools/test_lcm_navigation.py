"""LCM: a map, cells and a goal on it, from a command to the robot's arrival; the picture of it; and what is wrong with
either."""
import json
import math
import sys

import numpy as np
import pytest
from conftest import ROOT, assert_one_line_error, run_tool, sketched
from test_lcm import MULTICAST, URL, in_namespace, jp, messages, write_log

from tools.operate import lcm_map, lcm_navigate, map_stream

WIDTH, HEIGHT, CELL = 60, 40, 0.1
GOAL = (4.5, 2.0)
START = (1.0, 1.0, 0.0)


def write_hall(path, resolution=CELL, width=WIDTH, height=HEIGHT, origin=(0.0, 0.0, 0.0)):
    rows = ["".join("#" if x in (0, width - 1) or y in (0, height - 1) else "." for x in range(width))
            for y in range(height)]
    path.write_text(json.dumps({"format": "joulepath-map-1", "name": "hall", "width": width, "height": height,
                                "resolution_m": resolution, "origin_m": list(origin), "rows": rows}))
    return path


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    """The folder of a drive that was watched, and how its processes ended."""
    folder = tmp_path_factory.mktemp("navigation")
    result = in_namespace(MULTICAST, sys.executable, ROOT / "tests" / "tools" / "lcm_navigation.py", folder,
                          write_hall(folder / "hall.json"), ",".join(map(str, START)), ",".join(map(str, GOAL)))
    said = "".join(f"--- {path.name}\n{path.read_text()}" for path in sorted(folder.glob("*.err")))
    assert result.returncode == 0, result.stdout + result.stderr + said
    return folder


def test_all_programs_end_well(drive):
    codes = json.loads((drive / "drive.json").read_text())
    assert codes == dict.fromkeys(("navigate", "jp-lcm", "lcm-logger", "jp-plant", "jp-ecu"), 0)


def test_the_robot_arrives_round_the_box(drive):
    states = list(messages(drive / "drive.lcm", "JP_STATE", jp.state_t))
    tasks = [state.task for state in states]
    done = states[tasks.index(jp.state_t.TASK_DONE)]
    assert math.hypot(START[0] + done.x - GOAL[0], START[1] + done.y - GOAL[1]) < 0.2
    told = list(messages(drive / "drive.lcm", "JP_NAVIGATION", jp.navigation_t))
    assert told[-1].replans >= 1 and told[-1].map_state == 2
    assert "Blocked" in (drive / "navigate.out").read_text()


def test_each_phase_is_told(drive):
    lines = (drive / "navigate.out").read_text().splitlines()
    sent = [line for line in lines if line.startswith("sent map ")]
    assert len(sent) == 1 and sent[0].endswith(f"{WIDTH} x {HEIGHT} cells"), lines
    assert set(lines[:lines.index(sent[0])]) <= {"navigator: Idle"}, lines
    for state in ("Driving", "Braking", "Arrived"):
        assert any(line.startswith(f"navigator: {state}") for line in lines), lines
    assert lines[-1].startswith("arrived at 3.")
    said = (drive / "jp-lcm.out").read_text()
    for text in ("standing up for a goal on map", "uploading a goal on map", "jp-lcm: driving", "jp-lcm: done"):
        assert said.count(text) == 1, said


def test_rubbish_is_named_and_disturbs_nothing(drive):
    errors = (drive / "jp-lcm.err").read_text().splitlines()
    for channel, part in (("JP_MAP_GOAL", "there is no map yet"), ("JP_MAP", "fingerprint"),
                          ("JP_MAP_GOAL", "a place is not on the map"), ("JP_MAP_GOAL", "not that of the last JP_MAP"),
                          ("JP_CELLS", "a cell is not 0 (free)"), ("JP_CELLS", "1 to 4096 cells"),
                          ("JP_CELLS", "cut off")):
        assert sum(line.startswith(f"{channel}: ") and part in line for line in errors) == 1, errors
    assert "LCM packets dropped                         8" in (drive / "jp-lcm.out").read_text()


@sketched
def test_a_log_gives_a_picture(drive, tmp_path):
    result = run_tool("operate.lcm_map", drive / "drive.lcm", tmp_path)
    assert not result.returncode, result.stderr
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")
    found = json.loads((tmp_path / "map.json").read_text())
    assert (found["width"], found["height"], found["resolution_m"]) == (WIDTH, HEIGHT, CELL)
    assert found["origin"] == list(START)
    assert [goal[1:3] for goal in found["goals"]] == [pytest.approx(GOAL), [100, 1]]
    assert [change[3] for change in found["changes"]][:16] == [map_stream.OCCUPIED] * 16
    assert found["way"][-1][1:] == pytest.approx(GOAL, abs=0.2)
    assert [state for _, state, _ in found["states"]][-1] == "Arrived"
    assert len(found["courses"]) >= 2


# ---- logs made by hand ---------------------------------------------------------------------------------------------

def map_message(cells=((0, 1, 2), (0, 0, 0)), map_id=3, utime=1, **changed):
    message = jp.map_t()
    message.utime, message.map_id = utime, map_id
    message.height, message.width, message.resolution = len(cells), len(cells[0]), 0.5
    message.origin.x, message.origin.y, message.origin_heading = 1.0, 0.25, math.pi / 2
    message.cells = [bytes(row) for row in cells]
    for name, value in changed.items():
        setattr(message, name, value)
    return message


def cells_message(map_id, *cells):
    message = jp.cells_t()
    message.map_id, message.count = map_id, len(cells)
    for x, y, value in cells:
        cell = jp.cell_t()
        cell.x, cell.y, cell.cell = x, y, value
        message.cells.append(cell)
    return message


def goal_message(map_id, x, y, heading=None):
    message = jp.map_goal_t()
    message.map_id, message.point.x, message.point.y = map_id, x, y
    message.has_heading, message.heading = heading is not None, heading or 0.0
    return message


def state_message(t, x=0.0, y=0.0):
    state = jp.state_t()
    state.utime, state.x, state.y = round(t * 1e6), x, y
    return state


def navigation_message(t, state, course, *legs):
    told = jp.navigation_t()
    told.utime, told.state, told.course, told.leg_count = round(t * 1e6), state, course, len(legs)
    for x, y in legs:
        point = jp.point_t()
        point.x, point.y = x, y
        told.legs.append(point)
    told.distance, told.duration, told.energy, told.deviation = 2.0, 4.0, 8.0, 0.5
    return told


def listened(*entries):
    listener = lcm_map.Listener()
    for channel, message in entries:
        listener.take(channel, message if isinstance(message, bytes) else message.encode())
    return listener


def test_a_map_by_hand():
    listener = listened(("JP_MAP", map_message()), ("JP_STATE", state_message(2, 0.5, 0.25)),
                        ("JP_CELLS", cells_message(3, (0, 0, 1), (2, 1, 2))), ("JP_MAP_GOAL", goal_message(3, 1, 0.5)),
                        ("JP_MAP_GOAL", goal_message(3, 0.5, 0.5, math.pi)),
                        ("JP_NAVIGATION", navigation_message(3, 4, 9, (1, 0.5), (1.25, 0.5))),
                        ("JP_NAVIGATION", navigation_message(4, 4, 9, (1.25, 0.5))))
    cell_map, origin = listener.found
    assert cell_map.cells.tolist() == [[0, 1, 2], [0, 0, 0]] and cell_map.resolution == 0.5
    assert (origin.x, origin.y, origin.heading) == (1.0, 0.25, 90)
    assert listener.drive.way == [(2, pytest.approx(0.75), pytest.approx(0.75))]
    assert listener.drive.changes == [(2, 0, 0, 1), (2, 2, 1, 2)]
    assert listener.drive.goals == [(2, 1, 0.5, None), (2, 0.5, 0.5, 180)]
    assert listener.drive.courses == {9: {1: (1, 0.5), 0: (1.25, 0.5)}}
    assert len(listener.drive.states) == 1 and listener.drive.left[0] == (3, 2, 4, 8, 0.5)
    assert listener.bad == 0


def test_the_same_map_again_goes_on_and_another_begins_anew():
    first = [("JP_MAP", map_message()), ("JP_CELLS", cells_message(3, (0, 0, 1)))]
    assert len(listened(*first, ("JP_MAP", map_message(utime=99))).drive.changes) == 1
    for other in (map_message(map_id=4), map_message(cells=((0, 0, 2), (0, 0, 0))), map_message(resolution=0.25)):
        listener = listened(*first, ("JP_MAP", other))
        assert listener.drive.changes == [] and listener.bad == 0


@pytest.mark.parametrize("bad", [
    ("JP_MAP", map_message(map_id=16)), ("JP_MAP", map_message(map_id=0)), ("JP_MAP", map_message(resolution=0.0)),
    ("JP_MAP", map_message(resolution=math.nan)), ("JP_MAP", map_message(origin_heading=math.inf)),
    ("JP_MAP", map_message(cells=((0, 1, 3), (0, 0, 0)))), ("JP_MAP", map_message().encode()[:-1]),
    ("JP_MAP", map_message().encode()[:40]), ("JP_MAP", b"junk"), ("JP_CELLS", cells_message(4, (0, 0, 1))),
    ("JP_CELLS", cells_message(3, (0, 0, 1)).encode()[:-1]), ("JP_MAP_GOAL", goal_message(4, 1, 1)),
    ("JP_MAP_GOAL", cells_message(3, (0, 0, 1)))])
def test_what_jp_lcm_refuses_is_left_out(bad):
    listener = listened(("JP_MAP", map_message()), bad)
    assert listener.bad == 1
    assert listener.found[0].cells.tolist() == [[0, 1, 2], [0, 0, 0]]
    assert not listener.drive.changes and not listener.drive.goals


def test_cells_without_a_map_are_left_out(tmp_path):
    entries = [("JP_CELLS", cells_message(3, (0, 0, 1))), ("JP_MAP_GOAL", goal_message(3, 1, 1)), ("OTHER", b"")]
    assert listened(*entries).bad == 2
    write_log(tmp_path / "none.lcm", entries)
    assert_one_line_error(run_tool("operate.lcm_map", tmp_path / "none.lcm", tmp_path / "out"), "no JP_MAP in it")
    assert not (tmp_path / "out").exists()


def test_a_log_that_is_not_there(tmp_path):
    assert_one_line_error(run_tool("operate.lcm_map", tmp_path / "none.lcm", tmp_path / "out"), "none.lcm")


# ---- the command ---------------------------------------------------------------------------------------------------

def test_a_message_is_the_map_of_the_file(tmp_path):
    cell_map = map_stream.read_cells(write_hall(tmp_path / "hall.json", origin=(-1.0, 2.0, math.pi / 2)))
    message = lcm_navigate.map_message(jp, cell_map, map_stream.Place(-2.0, 2.5, 120.0))
    read = jp.map_t.decode(message.encode())
    assert np.array_equal([list(row) for row in read.cells], cell_map.cells)
    assert (read.width, read.height, read.resolution) == (WIDTH, HEIGHT, CELL)
    assert (read.origin.x, read.origin.y) == pytest.approx((0.5, 1.0))
    assert read.origin_heading == pytest.approx(math.radians(30))
    assert lcm_map.is_sound_map(read)
    goal = lcm_navigate.goal_message(jp, read.map_id, cell_map, (-2.0, 2.5, 120.0))
    read = jp.map_goal_t.decode(goal.encode())
    assert (read.point.x, read.point.y) == pytest.approx((0.5, 1.0))
    assert read.has_heading and read.heading == pytest.approx(math.radians(30))
    assert not lcm_navigate.goal_message(jp, 1, cell_map, (-2.0, 2.5)).has_heading


def test_the_id_is_of_the_map(tmp_path):
    def id_of(start, **hall):
        cell_map = map_stream.read_cells(write_hall(tmp_path / "hall.json", **hall))
        return lcm_navigate.map_message(jp, cell_map, map_stream.Place(*start)).map_id
    ids = [id_of((1, 1, degrees), width=width) for degrees in range(0, 90, 10) for width in (20, 30)]
    assert len(set(ids)) > 5 and all(1 <= one <= 15 for one in ids)
    assert id_of(START) == id_of(START)


def navigate(tmp_path, *arguments, **hall):
    return run_tool("operate.lcm_navigate", "--map", write_hall(tmp_path / "hall.json", **hall), *arguments)


@pytest.mark.parametrize(("arguments", "words"), [
    (("--start=1,1,0", "--goal=6.1,1"), ("--goal", "outside the map")), (("--start=1,1,0",), ("--goal",)),
    (("--start=1,1", "--goal=2,1"), ("--start",)), (("--start=1,1,0", "--goal=2"), ("--goal",)),
    (("--start=1,1,0", "--goal=nan,1"), ("--goal",)), (("--start=1,inf,0", "--goal=1,1"), ("--start",)),
    (("--start=1,1,0", "--goal=2,1", "--lcm=memq://"), ("--lcm", "udpm://"))])
def test_wrong_command_lines(tmp_path, arguments, words):
    assert_one_line_error(navigate(tmp_path, *arguments), *words)


def test_maps_that_are_none(tmp_path):
    (tmp_path / "bad.json").write_text("{}")
    for name in ("bad.json", "none.json"):
        assert_one_line_error(run_tool("operate.lcm_navigate", "--map", tmp_path / name, "--start=1,1,0", "--goal=1,1"),
                              name)


def test_a_map_with_too_long_a_side(tmp_path):
    result = navigate(tmp_path, "--start=1,1,0", "--goal=1,1", width=4097, height=3)
    assert_one_line_error(result, "4096 cells a side")


@pytest.mark.parametrize("network", ["true", "ip link set lo up"])
def test_no_multicast_route(tmp_path, network):
    result = in_namespace(network, sys.executable, "-m", "tools.operate.lcm_navigate", "--map",
                          write_hall(tmp_path / "hall.json"), "--start=1,1,0", "--goal=2,2", "--lcm", URL, timeout=60)
    assert_one_line_error(result, "ip route add 224.0.0.0/4 dev lo")


class FakeLcm:
    """jp-lcm as the command hears it: JP_STATE with these tasks, one a call; the last one goes on."""

    def __init__(self, take, tasks, reason=""):
        self._take, self._tasks, self._reason = take, list(tasks), reason
        self.sent = []

    def publish(self, channel, data):
        self.sent.append((channel, data))

    def handle_timeout(self, _):
        state = state_message(1)
        state.task = self._tasks.pop(0) if len(self._tasks) > 1 else self._tasks[0]
        state.task_reason = self._reason if state.task == state.TASK_FAILED else ""
        self._take("JP_STATE", state.encode())
        self._take("JP_STATE", b"junk")
        self._take("JP_NAVIGATION", navigation_message(1, 2, 1, (1, 1)).encode())


@pytest.fixture
def fake(tmp_path, monkeypatch):
    def start(*tasks, reason=""):
        made = []

        def open_lcm(url, take, option):
            made.append(FakeLcm(take, tasks, reason))
            return made[0]
        monkeypatch.setattr(lcm_navigate, "open_lcm", open_lcm)
        monkeypatch.setattr(lcm_navigate, "QUIET_MAX", 0.2)
        return navigate(tmp_path, "--start=1,1,0", "--goal=2,2"), made[0].sent
    return start


def test_it_follows_the_robot_until_it_arrives(fake):
    result, sent = fake(0, 0, 1, 1, 2, 3, 4)
    assert not result.returncode, result.stderr
    assert [channel for channel, _ in sent] == ["JP_MAP", "JP_MAP_GOAL"]
    assert jp.map_t.decode(sent[0][1]).map_id == jp.map_goal_t.decode(sent[1][1]).map_id
    assert result.stdout.splitlines()[-1].startswith("arrived at")
    assert sum(line.startswith("navigator: ") for line in result.stdout.splitlines()) == 1


def test_why_it_does_not_arrive_is_said(fake):
    result, _ = fake(0, 1, 2, 5, reason="no way leads to the goal: give another one")
    assert result.returncode == 1
    assert "no way leads to the goal" in result.stderr and result.stderr.count("\n") == 1
    result, _ = fake(0, 1, 3, 0)
    assert result.returncode == 1 and "another task has replaced this one" in result.stderr


def test_a_goal_that_is_not_taken(fake):
    result, _ = fake(0)
    assert_one_line_error(result, "jp-lcm has not taken the goal")
