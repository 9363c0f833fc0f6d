"""Missions of robots that their sides steer, driven in closed loop by jp-mission."""
import json

import pytest
from conftest import ROOT, assert_one_line_error, run
from programs import write_scenario

SPEEDS = {"zhang2018": 0.5, "burger": 0.15}  # m/s, of their lattices
SECONDS = 8  # that a straight line of the short route takes
STRATEGIES = ["rounded", "turn_and_go", "rounded_again"]


def short(path, robot):
    """Two corners, at the scale of the robot."""
    line = SPEEDS[robot] * SECONDS
    return write_scenario(path, (line, 0.0), (line, line), (2 * line, 2 * line), robot=robot)


def drive(output, scenario, *options):
    result = run("jp-mission", scenario, "--output", output, *options)
    assert (result.returncode, result.stderr) == (0, "")
    return json.loads((output / "summary.json").read_text())


@pytest.fixture(scope="module", params=SPEEDS)
def driven(request, tmp_path_factory):
    """Where its results are, and their summary."""
    folder = tmp_path_factory.mktemp(request.param)
    return folder / "out", drive(folder / "out", short(folder / "short.cfg", request.param))


@pytest.fixture
def strategies(driven):
    return {strategy["name"]: strategy for strategy in driven[1]["strategies"]}


def test_what_is_compared(driven):
    summary = driven[1]
    assert [strategy["name"] for strategy in summary["strategies"]] == STRATEGIES
    assert summary["energy"] == "battery" and summary["robot"] in SPEEDS


def test_planned_energy_is_what_is_driven(strategies):
    for strategy in strategies.values():
        total = strategy["total"]
        assert total["planned_energy_j"] == pytest.approx(total["measured_energy_j"], rel=0.1)
        assert strategy["forecast"]["energy_j"] == pytest.approx(total["measured_energy_j"], rel=0.05)
        assert strategy["saturated_ticks"] == 0


def test_meter_of_the_robot_agrees_with_the_plant(strategies):
    """What bridges burn of what a braking side generates included."""
    for strategy in strategies.values():
        for segment in strategy["segments"]:
            assert segment["measured_energy_j"] == pytest.approx(segment["plant_energy_j"], rel=0.01)
            assert segment["battery_energy_j"] == segment["measured_energy_j"]


def test_a_route_again_is_forecast_more_surely(strategies):
    first, again = strategies["rounded"]["forecast"], strategies["rounded_again"]["forecast"]
    assert again["deviation_j"] < first["deviation_j"] / 2


def test_rounded_corners_take_less_and_keep_the_waypoint_between_the_wheels(driven, strategies):
    width = {"zhang2018": 0.7, "burger": 0.16}[driven[1]["robot"]]
    rounded, turns = strategies["rounded"], strategies["turn_and_go"]
    # Of the mission of zhang2018 hardly a corner has room for an arc on which all its wheels drive on.
    most = {"zhang2018": 1.01, "burger": 1.0}[driven[1]["robot"]]
    assert rounded["total"]["measured_energy_j"] < most * turns["total"]["measured_energy_j"]
    for strategy, off in ((rounded, width / 2), (turns, 0)):
        length = 0
        for segment in strategy["segments"]:
            length += SPEEDS[driven[1]["robot"]] * segment["duration_s"]
            assert segment["passed_m"] <= segment["end_error_m"] + 1e-3 <= off + 0.03 + 0.01 * length + 1e-3


def test_sums_targets_and_logs(driven, strategies):
    output, summary = driven
    for strategy in strategies.values():
        segments, total = strategy["segments"], strategy["total"]
        assert [segment["target_m"] for segment in segments] == summary["waypoints_m"][1:]
        for key in ("measured_energy_j", "plant_energy_j", "battery_energy_j", "duration_s"):
            assert total[key] == pytest.approx(sum(segment[key] for segment in segments))
        header, *rows = (output / strategy["log"]).read_text().splitlines()
        last = dict(zip(header.split(","), map(float, rows[-1].split(",")), strict=True))
        assert last["t_s"] == pytest.approx(total["duration_s"], abs=0.1)
        assert last["energy_j"] == pytest.approx(total["measured_energy_j"], rel=0.01)
        assert abs(last["speed_m_s"]) < 0.05 and last["pitch_deg"] == 0
        assert len(rows) == pytest.approx(total["duration_s"] * 50, rel=0.02)


def test_a_corner_of_hardly_any_angle_leads_on_to_the_next_target(tmp_path):
    scenario = write_scenario(tmp_path / "slight.cfg", (1.5, 0.0), (3.0, 0.0008), (4.5, 0.0), robot="zhang2018")
    for strategy in drive(tmp_path / "out", scenario)["strategies"]:
        for segment in strategy["segments"]:
            assert segment["end_error_m"] < 0.1
            assert segment["planned_energy_j"] > 80


def test_alone_it_drives_as_the_robot_does(tmp_path):
    summary = drive(tmp_path / "out", short(tmp_path / "short.cfg", "burger"), "--alone")
    assert [strategy["name"] for strategy in summary["strategies"]] == ["rounded"]


def test_same_bytes_again(driven, tmp_path):
    output, summary = driven
    again = tmp_path / "again"
    drive(again, short(tmp_path / "short.cfg", summary["robot"]))
    for name in STRATEGIES:
        assert (again / f"log_{name}.csv").read_bytes() == (output / f"log_{name}.csv").read_bytes()


@pytest.mark.parametrize(("line", "part"), [
    ('energy = "motor";', 'energy = "motor"'), ('end = "segment";', 'end = "segment"'),
    ("within_seconds = 60;", "a budget"), ("within_joules = 60.0;", "a budget")])
def test_what_only_balancers_do_is_refused(tmp_path, line, part):
    scenario = short(tmp_path / "short.cfg", "burger")
    scenario.write_text(f"{scenario.read_text()}{line}\n")
    assert_one_line_error(run("jp-mission", scenario, "--output", tmp_path / "out"), "short.cfg", part, "burger is none")
    assert not (tmp_path / "out").exists()


def test_published_models_headings_and_optimised_are_refused(tmp_path):
    scenario = short(tmp_path / "short.cfg", "burger")
    text = scenario.read_text()
    scenario.write_text(text.replace("identified", "published"))
    assert_one_line_error(run("jp-mission", scenario), 'energy_model = "published"', "burger is none")
    scenario.write_text(text.replace("[1.2, 0.0]", "[1.2, 0.0, 30.0]"))
    assert_one_line_error(run("jp-mission", scenario), "a heading at a waypoint", "burger is none")
    scenario.write_text(text)
    assert_one_line_error(run("jp-mission", scenario, "--optimised"), "--optimised", "burger is none")


def test_a_line_that_is_too_long_says_how_long_it_may_be(tmp_path):
    scenario = write_scenario(tmp_path / "far.cfg", (1.0, 0.0), (70.0, 0.0), robot="zhang2018")
    assert_one_line_error(run("jp-mission", scenario, "--output", tmp_path / "out"), "short", "at most 64 m")


def test_programs_for_balancers_say_so(tmp_path):
    scenario = short(tmp_path / "short.cfg", "zhang2018")
    assert_one_line_error(run("jp-front", scenario, "--output", tmp_path / "out"), "zhang2018 is no balancer", "jp-mission")


def test_other_kinds_are_refused(tmp_path):
    scenario = write_scenario(tmp_path / "short.cfg", (1.0, 0.0), robot="patrol")
    assert_one_line_error(run("jp-mission", scenario), "patrol.cfg", "four_wheel robot")


def test_missions_of_the_repository_are_for_their_robots_speeds():
    """The paper's waypoints, which its robot drives at 0.5 m/s."""
    for robot, speed in SPEEDS.items():
        text = (ROOT / f"sim/scenarios/{robot}_mission.cfg").read_text()
        points = [(speed / 0.5 * x, speed / 0.5 * y) for x, y in ((0, 0), (10, 10), (20, 15), (25, 25), (15, 30))]
        assert ", ".join(f"[{x:.1f}, {y:.1f}]" for x, y in points) in text
