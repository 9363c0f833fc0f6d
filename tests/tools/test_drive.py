"""drive.py: routes, goals, scenarios, both views, Ctrl-C and every failure, against a stand-in of the ECU."""
import functools
import io
import json

import pytest
from conftest import ROOT, assert_one_line_error, run_tool
from fake_ecu import FakeEcu
from rich.console import Console

from tools.operate import can_client, drive, map_stream
from tools.operate.can_client import RobotState, SegmentEnergy

SCENARIO = ROOT / "sim/scenarios/gao2018_mission.cfg"


@pytest.fixture
def robot(monkeypatch, tmp_path):
    """Runs the tool beside a stand-in of the ECU; ecu and outcome are kept."""
    def run(*arguments, trouble=None):
        run.ecu = FakeEcu(trouble)
        monkeypatch.setattr(drive, "open_bus", lambda name: run.ecu)
        for actor in ("Listener", "Operator"):
            monkeypatch.setattr(drive, actor, functools.partial(getattr(can_client, actor), clock=run.ecu.clock))
        result = run_tool("operate.drive", "--bus", "fake:ecu", "--json", tmp_path / "out.json", *arguments)
        run.outcome = json.loads((tmp_path / "out.json").read_text()) if (tmp_path / "out.json").exists() else None
        return result
    return run


def interrupt_while_driving(monkeypatch):
    """Ctrl-C as soon as the robot drives."""
    progress, pressed = can_client.Operator._progress, []

    def press(operator):
        if progress(operator) == "Driving" and not pressed:
            pressed.append(True)
            raise KeyboardInterrupt
        return progress(operator)
    monkeypatch.setattr(can_client.Operator, "_progress", press)


@pytest.fixture
def hall(tmp_path):
    """Of 40 × 30 cells of 0.1 m; its south-west corner is at (-1, 2)."""
    rows = ["".join("#" if x in (0, 39) or y in (0, 29) else "." for x in range(40)) for y in range(30)]
    path = tmp_path / "hall.json"
    path.write_text(json.dumps({"format": "joulepath-map-1", "name": "hall", "width": 40, "height": 30,
                                "resolution_m": 0.1, "origin_m": [-1.0, 2.0, 0.0], "rows": rows}))
    return ["--map", path, "--start=0,3,90"]


# ---- on a map ------------------------------------------------------------------------------------------------------

def test_a_goal_on_a_map_is_driven_to(robot, hall):
    result = robot(*hall, "--goal=1.25,3.5,-90")
    assert result.returncode == 0, result.stderr
    assert robot.ecu.violations == [] and robot.ecu.map_offers == 1
    cell_map, origin = map_stream.decode(robot.ecu.stream)
    assert cell_map.cells.shape == (30, 40) and cell_map.cells.sum() == 2 * 40 + 2 * 28
    assert (origin.x, origin.y, origin.heading) == (1.0, 1.0, 90.0)
    goal = robot.ecu.goal
    assert (goal["Column"], goal["Row"], goal["HasHeading"], goal["Heading"]) == (22, 15, 1, -1024)
    assert goal["MapId"] == robot.ecu.map["MapId"]
    assert [mode for mode, _ in robot.ecu.commands] == ["Stand", "Navigate", "Stand"]
    assert robot.ecu.commands[1] == ("Navigate", goal["GoalId"])
    lines = result.stdout.splitlines()
    for state in ("Planning", "Turning", "Driving", "Arrived"):
        assert lines.count(f"navigator: {state}") == 1
    assert robot.outcome["arrived"] is True


def test_a_point_has_no_heading(robot, hall):
    assert robot(*hall, "--goal=1.25,3.5").returncode == 0
    assert robot.ecu.goal["HasHeading"] == 0


@pytest.mark.parametrize("trouble", ["loses data", "damaged once"])
def test_what_is_lost_of_a_map_is_sent_again(robot, hall, trouble):
    result = robot(*hall, "--goal=1.25,3.5", trouble=trouble)
    assert result.returncode == 0, result.stderr
    assert map_stream.decode(robot.ecu.stream) is not None


@pytest.mark.parametrize(("trouble", "part"), [
    ("no navigator", "built with a navigator"), ("too large", "does not take the map: TooLarge"),
    ("blocked goal", "does not take the goal: Blocked"), ("deaf to goals", "no answer to the goal"),
    ("unreachable", "no way leads to the goal"), ("gives up", "stopped on the way: Memory"),
    ("turns back", "came home"), ("no way home", "no way home: NoWay"),
    ("other goal", "the goal is not driven to"), ("loses operator", "lost the operator's commands")])
def test_why_it_did_not_arrive_on_a_map(robot, hall, trouble, part):
    result = robot(*hall, "--goal=1.25,3.5", trouble=trouble)
    assert_one_line_error(result, part, status=1)
    assert robot.outcome["arrived"] is False and part in robot.outcome["failure"]


def test_the_picture_tells_of_the_navigator(hall):
    state = RobotState()
    assert drive.navigator_line(state) is None
    state.latest = {"MapStatus": {"State": "Ready"},
                    "NavigationStatus": {"State": "Driving", "Reason": "Blocked", "HasCourse": 1, "Replans": 2},
                    "NavigationProgress": {"Distance": 4.5, "Duration": 21.0, "Energy": 33.5, "Deviation": 1.25}}
    assert drive.navigator_line(state) == ("map Ready · Driving (Blocked) · 4.5 m, 21 s, 34 ± 1 J left · "
                                           "planned anew 2 times")


def test_the_picture_tells_of_the_way_home():
    state = RobotState()
    assert drive.home_line(state) is None
    state.latest = {"HomeStatus": {"HomeState": "Seeking", "Probability": 0.0, "Way": 0.0, "WayDeviation": 0.0}}
    assert drive.home_line(state) == "Seeking"
    state.latest = {"HomeStatus": {"HomeState": "Suffices", "Probability": 0.9995, "Way": 40.5, "WayDeviation": 2.5},
                    "HomeBattery": {"Left": 2000.0, "LeftDeviation": 100.5}}
    assert drive.home_line(state) == "Suffices, 99.95 % · 40 ± 2 J of 2000 ± 100 J"


@pytest.mark.parametrize(("arguments", "part"), [
    (["--goal=1,3,90"], "--map"), (["--goal=1"], "X,Y"), (["--goal=1,2", "--start=1,2,3"], "go together"),
    (["--route=1,2", "--map=m.json", "--start=1,2,3"], "also give --goal"),
    (["--goal=1,2", "--map=m.json", "--start=1,2"], "X,Y,DEG"), (["--goal=1,2", "--map=no.json", "--start=1,2,3"], "no.json")])
def test_options_of_a_map(arguments, part):
    assert_one_line_error(run_tool("operate.drive", "--bus", "virtual:bad", *arguments), part)


def test_places_off_the_map(hall):
    assert_one_line_error(run_tool("operate.drive", "--bus", "virtual:bad", *hall, "--goal=9,3"), "--goal 9,3", "outside")
    assert_one_line_error(run_tool("operate.drive", "--bus", "virtual:bad", *hall[:2], "--start=9,3,0", "--goal=0,3"),
                          "--start 9,3", "outside")


# ---- drives --------------------------------------------------------------------------------------------------------

def test_a_route_is_driven_and_told_in_lines(robot):
    result = robot("--route", "1,2 -3.5,0.25")
    assert result.returncode == 0, result.stderr
    assert robot.ecu.driven == [(65536, 131072), (-229376, 16384)] and robot.ecu.violations == []
    lines = result.stdout.splitlines()
    assert "state: Standing, operator Alive" in lines
    assert "segment 1: predicted 10.00 J" in lines
    assert sum(line.startswith("segment 2: predicted 10.00 J, used 10.50 J; spent") for line in lines) == 1
    assert "battery 75.0 %, 72.50 Wh, 24.5 V" in result.stdout
    assert "route: 1 Done" in lines
    assert lines.count("route: 1 Driving") == 1


def test_what_happened_is_written(robot):
    robot("--route", "1,2 3,4")
    assert robot.outcome["arrived"] is True and robot.outcome["failure"] is None
    assert robot.outcome["waypoints_m"] == [[1, 2], [3, 4]]
    assert robot.outcome["segments"] == [{"index": i, "predicted_j": 10.0, "spent_j": 10.5, "drawn_j": 8.25}
                                         for i in (1, 2)]
    assert robot.outcome["counters"]["CrcErrors"] == 7 and robot.outcome["counters"]["LostSamples"] == 2
    assert robot.outcome["position_m"] == [1.5, -2.5] and robot.outcome["battery_left_wh"] == 72.5


def test_a_scenario_is_driven(robot):
    assert robot("--scenario", SCENARIO).returncode == 0
    assert robot.ecu.driven == [(x * 65536, y * 65536) for x, y in ((10, 10), (20, 15), (25, 25), (15, 30))]


def test_a_goal_is_driven_to(robot):
    assert robot("--goal=-3,4.5").returncode == 0
    assert robot.ecu.driven == [(-3 * 65536, 9 * 32768)]


def test_off_switches_the_motors_off(robot):
    assert robot("--off", trouble="fault").returncode == 0
    assert robot.ecu.state == "Idle"


def test_watching_sends_nothing(robot, monkeypatch):
    def press(listener, steps=[]):
        steps.append(listener)
        if len(steps) > 10:
            raise KeyboardInterrupt
    monkeypatch.setattr(can_client.Listener, "check_heartbeat", press)
    assert robot("--watch").returncode == 0
    assert robot.ecu.commands == [] and robot.outcome["state"] == "Idle"


def test_ctrl_c_brakes_to_a_stand(robot, monkeypatch):
    interrupt_while_driving(monkeypatch)
    result = robot("--route", "1,2 3,4")
    assert result.returncode == 1
    assert result.stderr.splitlines()[-1].endswith("stopped by Ctrl-C; the robot stands")
    assert robot.ecu.state == "Standing" and robot.ecu.reason == "Command"
    assert robot.outcome["arrived"] is False


@pytest.mark.parametrize("trouble, part", [
    ("silent", "no EcuStatus"), ("fallen", "has fallen"), ("fault", "left encoder, overspeed"), ("reject", "Sequence"),
    ("falls", "has fallen"), ("restarts", "restarted"), ("stops", "Plan"), ("other operator", "another operator")])
def test_a_robot_that_does_not_arrive(robot, trouble, part):
    result = robot("--route", "1,2 3,4", trouble=trouble)
    assert result.returncode == 1
    assert len(result.stderr.splitlines()) == 1 and part in result.stderr
    assert robot.outcome["arrived"] is False and part in robot.outcome["failure"]


# ---- the live view -------------------------------------------------------------------------------------------------

def driving_state():
    """In the second of three segments."""
    state = RobotState()
    state.segments = {1: SegmentEnergy(10.0, 10.5, 9.0), 2: SegmentEnergy(20.0)}
    state.latest = {
        "EcuStatus": {"State": "Driving", "OperatorState": "Alive", "VersionMajor": 1, "VersionMinor": 2, "VersionPatch": 3,
                      "Resets": 0},
        "RouteStatus": {"State": "Driving", "Segment": 2, "SegmentsEnded": 1, "Length": 3},
        "SegmentShape": {"Segment": 2, "Duration": 8.0}, "Reference": {"SegmentTimeLeft": 2.0},
        "EnergySpent": {"Energy": 100.0}, "EnergyDrawn": {"Energy": 80.0}, "Pose": {"X": 1.0, "Y": -2.0},
        "Motion": {"Speed": 0.5}, "BatteryStatus": {"StateOfCharge": 0.5, "EnergyLeft": 30.0, "Voltage": 24.0},
        "EcuErrors": {"Faults": 2, "CrcErrors": 3, "SequenceErrors": 0}, "EcuLosses": {"LostSamples": 5}}
    return state


def picture(*states):
    screen = io.StringIO()
    with drive.LiveView(Console(file=screen, force_terminal=True, width=120, color_system=None)) as view:
        for state in states:
            view._next = 0.0
            view(state)
    return screen.getvalue()


def test_the_live_view_shows_everything():
    later = driving_state()
    later.latest["EnergySpent"] = {"Energy": 107.25}
    text = picture(driving_state(), later)
    for part in ("Driving", "1 of 3 waypoints", "operator Alive", "v1.2.3", "x 1.00, y -2.00 m", "0.50 m/s",
                 "spent 107.2 J", "drawn 80.0 J", "battery 50.0 %", "30.00 Wh", "24.0 V", "IMU jump", "CrcErrors 3",
                 "LostSamples 5", "10.50", "5.00", "20.00", "7.25"):
        assert part in text, part
    assert "SequenceErrors" not in text


def test_the_share_of_a_segment():
    state = driving_state()
    assert [drive.Progress.share(state, index) for index in (1, 2, 3)] == [1.0, 0.75, 0.0]
    state.latest["Reference"]["SegmentTimeLeft"] = 9.0
    assert drive.Progress.share(state, 2) == 0.0


def test_the_views_stand_an_ecu_that_has_said_nothing_yet():
    assert "no EcuStatus yet" in picture(RobotState())
    drive.PlainView(Console(file=io.StringIO()))(RobotState())


# ---- bad input -----------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("arguments, part", [
    (["--route", ""], "0 waypoints"), (["--route", " ".join(["1,1"] * 33)], "33 waypoints"),
    (["--route", "1,1 600,2"], "waypoint 2: x = 600 m"), (["--goal=0,nan"], "y = nan"),
    (["--scenario", "/nonexistent.cfg"], "/nonexistent.cfg: No such file"), (["--bus", "vcan0", "--off"], "--bus vcan0"),
])
def test_bad_arguments(arguments, part):
    assert_one_line_error(run_tool("operate.drive", "--bus", "virtual:bad", *arguments), part)


@pytest.mark.parametrize("arguments, part", [
    ([], "--route --scenario --goal"), (["--route", "1;2"], "--route: '1;2': must be X,Y in m"),
    (["--route", "1,2 1,2,3"], "--route: '1,2,3': must be X,Y in m"),
    (["--route", "a,b"], "--route: 'a,b': must be X,Y in m"), (["--goal", "1"], "--goal: '1': must be X,Y in m"),
    (["--goal", "1,2", "--watch"], "--watch: not allowed with"), (["--route", "1,2", "--speed", "3"], "--speed")])
def test_bad_command_lines(arguments, part):
    assert_one_line_error(run_tool("operate.drive", "--bus", "virtual:bad", *arguments), "drive.py: ", part, "--help")


@pytest.mark.parametrize("text, part", [
    ("waypoints = (", "Unexpected"), ('name = "x";', "waypoints: missing"), ("waypoints = 3;", "list of [x, y]"),
    ('waypoints = ( [0.0, 0.0], [1.0, "a"] );', "list of [x, y]"), ("waypoints = ( [0.0, 0.0], [1.0] );", "list of"),
    ("waypoints = ( [0.0, 0.0] );", "0 waypoints"), ("waypoints = ( [0.0, 0.0], [900.0, 1.0] );", "x = 900 m"),
    ("\x00", "row 1, column 1")])
def test_bad_scenarios(tmp_path, text, part):
    path = tmp_path / "bad.cfg"
    path.write_text(text)
    assert_one_line_error(run_tool("operate.drive", "--bus", "virtual:bad", "--scenario", path), "bad.cfg", part)
