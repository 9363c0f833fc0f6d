"""tools/measure/bench_mujoco.py: cases that follow from robots' files, and figures of rows."""
import math

import pytest
from conftest import ROOT  # noqa: F401 - paths

from tools.measure import bench_mujoco
from tools.mujoco.drive import load_robot


def row(kind, robot="courier24", failure=None, segments=(), open_j=0.0, courses=(), fell=False):
    return {"kind": kind, "robot": robot, "case": "x", "failure": failure, "segments": list(segments), "fell": fell,
            "courses": list(courses), "ledger": {"cells": 100.0, "open": open_j}, "seconds": 1.0, "pitch_deg": 0.0}


def values(rows):
    figures = [*bench_mujoco.drive_figures(rows), *bench_mujoco.learning_figures(rows)]
    return {figure["name"].removeprefix("in MuJoCo, "): figure["value"] for figure in figures}


@pytest.mark.parametrize("name", bench_mujoco.ROBOTS)
def test_cases_are_of_the_robot(name):
    robot = load_robot(name)
    cases, route = bench_mujoco.conditions(robot), bench_mujoco.short_route(robot)
    steps = {step.x for case in cases.values() for step in case.ground.steps}
    assert all(0 < x < route[0][0] for x in steps)
    steepest = max(abs(case.ground.slope) for case in cases.values())
    balances = robot.type == "balancer"
    assert steepest == pytest.approx(math.radians(10 if balances else robot.number("limits.slope_deg")))
    heights = {step.height for case in cases.values() for step in case.ground.steps}
    assert len(heights) == 1 and (heights == {0.005} or not balances)


def test_random_routes_repeat_and_keep_to_what_the_robot_turns():
    robot = load_robot("courier24")
    assert bench_mujoco.random_route(robot, 1) == bench_mujoco.random_route(robot, 1)
    assert bench_mujoco.random_route(robot, 1) != bench_mujoco.random_route(robot, 2)
    points = [(0.0, 0.0), *bench_mujoco.random_route(robot, 3)]
    assert len(points) == bench_mujoco.SEGMENTS + 1
    headings = [math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in zip(points, points[1:])]
    assert all(abs(math.remainder(b - a, math.tau)) <= math.radians(80) + 1e-9 for a, b in zip(headings, headings[1:]))


def test_what_was_not_driven_counts():
    found = values([row("mission"), row("mission", failure="fell", fell=True), row("case", failure="a fault", open_j=-0.7),
                    row("push", failure="fell", fell=True)])
    assert found["reference missions of four robots: not driven"] == 1
    assert found["of those, not driven"] == 1 and found["falls in all drives"] == 1
    assert found["pushes that our world's robots take, and these do not"] == 1
    assert found["share of the cells' energy that a ledger misses, most"] == pytest.approx(0.7)


def test_errors_before_and_after_learning():
    segments = [(110.0, 100.0)] + [(150.0, 100.0)] * 19 + [(101.0, 100.0), (98.0, 100.0)]
    found = values([row("learn", segments=segments)])
    assert found["courier24: forecast of a first segment against spent, mean"] == pytest.approx(10)
    assert found["courier24: the same after 20 segments"] == pytest.approx(1.5)


def test_courses_in_their_interval():
    early = [(0.0, 1.0, 50.0)] * bench_mujoco.LEARNED_COURSES
    late = [(100.0, 10.0, 119.0), (100.0, 10.0, 120.0), (100.0, 10.0, 100.0), (100.0, 10.0, 95.0)]
    found = values([row("navigate", courses=early + late)])
    assert found["courses over a map, after learning"] == 4
    assert found["courses over a map: in the 95 % interval, off 95 % by"] == pytest.approx(20)


def test_forecasts_of_the_patrol_robot_before_and_after_learning():
    courses = [(70.0, 10.0, 100.0)] + [(150.0, 10.0, 100.0)] * 19 + [(101.0, 10.0, 100.0), (97.0, 1.0, 100.0)]
    found = values([row("patrol", robot="patrol", courses=courses)])
    assert found["patrol robot, x: forecast of a first course against spent"] == pytest.approx(30)
    assert found["patrol robot, x: forecast of a course after 20, mean error"] == pytest.approx(2)
    assert found["patrol robot: courses, after learning"] == 2
    assert found["patrol robot: courses: in the 95 % interval, off 95 % by"] == pytest.approx(45)


class State:
    def __init__(self, **energies):
        self.latest = {}
        self.energies = energies

    def get(self, message, signal):
        return {"NavigationProgress": {"Energy": self.energies.get("ahead"), "Deviation": 3.0},
                "EnergySpent": {"Energy": self.energies["spent"]}}[message][signal]


def test_a_forecast_is_the_first_of_its_course():
    forecasts = bench_mujoco.Forecasts("EnergySpent")
    forecasts.begin(State(spent=10.0))
    for state in (State(spent=10.0), State(spent=10.0, ahead=0.0), State(spent=11.0, ahead=80.0), State(spent=50.0, ahead=40.0)):
        forecasts(state)
    forecasts.end(State(spent=93.0))
    assert forecasts.courses == [(80.0, 3.0, 82.0)]
    forecasts.begin(State(spent=93.0))
    forecasts.end(State(spent=93.0))
    assert len(forecasts.courses) == 1


def test_terms_of_either_world_have_one_name():
    ours, theirs = {"slip_along_j": 1.0, "slip_across_j": 2.0, "caster_j": 3.0}, {"slip contact": 4.0, "normal contact": 5.0}
    _, our_terms, their_terms = next(terms for terms in bench_mujoco.BOTH_WORLDS if terms[0] == "tyres and caster")
    assert bench_mujoco.joules_of(ours, our_terms) == 6 and bench_mujoco.joules_of(theirs, their_terms) == 9
