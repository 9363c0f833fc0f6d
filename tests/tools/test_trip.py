"""jp-trip: robots that differ from their file learn on the way, predict a route and drive it."""
import json
import math
import os
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT, assert_one_line_error

from tools.campaign import campaign_task

BIN = Path(os.environ.get("JP_BUILD", ROOT / "build")).resolve() / "bin"
ROBOTS = ROOT / "sim/robots"
COURIER = ROBOTS / "courier24.cfg"
KEYS = {"seed", "robot", "variation", "fault", "change", "outcome", "segments", "seconds", "predicted_j", "std_j",
        "measured_j", "inside", "prior_predicted_j", "reserve", "learned", "charge_used", "outliers"}


def trip(*arguments, robot=COURIER):
    return subprocess.run([BIN / "jp-trip", robot, *map(str, arguments)], capture_output=True, text=True, check=False,
                          timeout=600)


def missions(*arguments, robot=COURIER):
    result = trip(*arguments, robot=robot)
    assert (result.returncode, result.stderr) == (0, "")
    return [json.loads(line) for line in result.stdout.splitlines()]


@pytest.fixture(scope="module")
def ten():
    return missions("--seed", 40, "--count", 10)


def test_a_line_for_each_seed_with_every_field(ten):
    assert [mission["seed"] for mission in ten] == list(range(40, 50))
    assert all(set(mission) == KEYS for mission in ten)
    assert all(mission["robot"] == "courier24" for mission in ten)
    assert all(mission["outcome"] == "done" for mission in ten)


def test_inside_means_within_1_96_deviations(ten):
    for mission in ten:
        error = abs(mission["measured_j"] - mission["predicted_j"])
        assert mission["inside"] == (error <= 1.96 * mission["std_j"])


def test_what_was_learned_predicts_better_than_what_is_built_in(ten):
    def mean_error(key):
        return sum(abs(m["measured_j"] / m[key] - 1) for m in ten) / len(ten)
    assert mean_error("predicted_j") < 0.01
    assert mean_error("predicted_j") < mean_error("prior_predicted_j") / 3


def test_what_was_learned_is_the_robots_own(ten):
    for mission in ten:
        # Legs hardly tell it: what is told must not leave what such robots carry.
        assert abs(mission["learned"]["payload_kg"] - mission["variation"]["payload_kg"]) < 1.2
    ground = [(m["learned"]["ground_friction"], m["variation"]["ground_friction"]) for m in ten]
    mean = [sum(column) / len(ground) for column in zip(*ground)]
    covariance = sum((a - mean[0]) * (b - mean[1]) for a, b in ground)
    spread = math.sqrt(sum((a - mean[0]) ** 2 for a, _ in ground) * sum((b - mean[1]) ** 2 for _, b in ground))
    assert covariance / spread > 0.8


def test_a_reserve_that_is_asked_for_is_answered_on_the_safe_side(ten):
    assert all(mission["reserve"]["asked"] for mission in ten)
    assert not any(mission["reserve"]["answer"] and not mission["reserve"]["true"] for mission in ten)


def test_the_same_seed_is_the_same_mission(ten):
    assert missions("--seed", 43) == [ten[3]]


def test_faults_and_changes_come_when_asked_for():
    disturbed = missions("--seed", 100, "--count", 12, "--faults")
    assert {m["fault"] for m in disturbed} > {None}
    assert {m["change"] for m in disturbed} == {None, "ground", "payload"}


def test_what_the_last_robot_learned_is_written(tmp_path):
    missions("--seed", 7, "--count", 2, "--output", tmp_path)
    parameters = json.loads((tmp_path / "parameters.json").read_text())
    assert parameters["robot"] == "courier24" and parameters["version"] > 20
    assert len(parameters["a"]) == 13 and len(parameters["b"]) == 2
    assert 0.9 < parameters["mass"] < 1.5


@pytest.mark.parametrize("arguments, named", [
    (["--count", "0"], "--count 0"),
    (["--seed", "x"], "--seed x"),
    (["--output", "/dev/null/x"], "/dev/null"),
    (["another.cfg"], "another.cfg"),
])
def test_bad_options_end_with_one_line(arguments, named):
    assert_one_line_error(trip(*arguments), named)


def test_a_robot_without_tables_is_refused(tmp_path):
    path = tmp_path / "other.cfg"
    path.write_text(COURIER.read_text().replace('"courier24"', '"other"'))
    assert_one_line_error(trip(robot=path), "other")
    assert_one_line_error(trip(robot=tmp_path / "missing.cfg"), "missing.cfg")


@pytest.fixture(scope="module")
def skid():
    return missions("--seed", 2, "--count", 2, robot=ROBOTS / "zhang2018.cfg")


def test_robots_that_their_sides_steer_do_the_same(skid):
    assert [mission["seed"] for mission in skid] == [2, 3]
    for mission in skid:
        campaign_task.check_mission(mission)
        assert set(mission) == KEYS and mission["outcome"] == "done" and mission["reserve"]["asked"]
        assert set(mission["variation"]) - {"resistance"} == set(mission["learned"])
        error = abs(mission["measured_j"] - mission["predicted_j"])
        assert mission["inside"] == (error <= 1.96 * mission["std_j"])
        assert mission["predicted_j"] == pytest.approx(mission["measured_j"], rel=0.05)
        assert abs(mission["measured_j"] - mission["prior_predicted_j"]) > error


def test_the_same_seed_of_a_robot_that_its_sides_steer_is_the_same_mission(skid):
    assert missions("--seed", 3, robot=ROBOTS / "zhang2018.cfg") == [skid[1]]


@pytest.mark.parametrize("option", ["--faults", "--legs", "--output=x"])
def test_what_is_for_balancers_is_refused(option):
    assert_one_line_error(trip(option, robot=ROBOTS / "burger.cfg"), "are for balancers")


def test_other_kinds_are_refused():
    assert_one_line_error(trip(robot=ROBOTS / "patrol.cfg"), "four_wheel robot")


def test_a_line_for_each_leg():
    result = trip("--legs", "--count", 2, "--seed", 3)
    assert result.returncode == 0, result.stderr
    head, *rows = (line.split(",") for line in result.stdout.splitlines())
    legs = [dict(zip(head, map(float, row))) for row in rows]
    assert [leg["seed"] for leg in legs] == 36 * [3] + 36 * [4]
    assert [leg["route"] for leg in legs] == 2 * (24 * [0] + 12 * [1])
    for leg in legs:
        assert leg["measured_j"] == pytest.approx(leg["expected_j"], rel=0.5)
    # Only the first and the last leg of a route of four change the speed.
    assert all((abs(leg["pushing_j"]) > 0.1) == (number % 4 in (0, 3)) for number, leg in enumerate(legs))
    # They are other robots than those of the missions.
    assert legs[0]["payload_kg"] != missions("--seed", 3)[0]["variation"]["payload_kg"]
