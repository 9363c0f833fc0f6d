"""tools/measure/bench_route.py: the oracle's energies, gradients and optima; figures of a short run; bad input."""
import json
import math

import numpy as np
import pytest
from conftest import JP_ROBOT, ROOT, assert_one_line_error, run_tool

from tools.design import robot_json
from tools.measure import bench_route
from tools.measure.route_oracle import Limits, Route

LEGS = 5
MODES = [None, "transients"]


@pytest.fixture(scope="module")
def robot():
    return robot_json.load(ROOT / "sim/robots/gao2018.cfg", JP_ROBOT)


@pytest.fixture(scope="module")
def modes(robot):
    return bench_route.transients(robot)


@pytest.fixture(scope="module")
def tasks(robot, modes):
    """Routes with transients or, by None, settled."""
    kinds = {None: bench_route.KINDS[1], "transients": bench_route.KINDS[2]}
    return {name: bench_route.tasks_of(kind, robot, modes, 7, 4) for name, kind in kinds.items()}


# ---- Oracle --------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("kind", MODES)
def test_energies_are_those_of_jp_route(tasks, kind):
    """But for what the last segment leaves to be spent."""
    for task in tasks[kind]:
        for name in ("greedy", "joint"):
            energy = bench_route.energy_of(task.route, task.plan[name])
            assert task.plan[f"{name}_j"] == pytest.approx(energy, abs=0.02 if kind is None else 1.5)
            if kind is not None and task.plan[name][-1]["duration_s"] > 15:
                assert task.plan[f"{name}_j"] == pytest.approx(energy, abs=0.02)


@pytest.mark.parametrize("kind", MODES)
def test_gradients_are_those_of_finite_differences(tasks, kind):
    generator = np.random.default_rng(3)
    for task in tasks[kind]:
        arc, pace = task.route.random_start(generator)
        _, *gradients = task.route.energy(arc, pace)
        for values, gradient in zip((arc, pace), gradients):
            for k in range(task.route.count):
                step = 1e-5
                ends = []
                for sign in (1, -1):
                    values[k] += sign * step
                    ends.append(task.route.energy(arc, pace)[0])
                    values[k] -= sign * step
                assert (ends[0] - ends[1]) / (2 * step) == pytest.approx(gradient[k], rel=1e-4, abs=1e-3)


def test_small_arcs_have_no_step(tasks):
    route = tasks[None][0].route
    pace = np.full(route.count, 0.1)
    energies = [route.energy(np.full(route.count, arc), pace)[0] for arc in (0, 1e-5, 1.999e-4, 2.001e-4)]
    assert energies == pytest.approx([energies[0]] * 4, rel=1e-3)


@pytest.mark.parametrize("kind", MODES)
def test_no_change_of_an_optimum_spends_less(tasks, kind):
    generator = np.random.default_rng(5)
    for task in tasks[kind]:
        route = task.route
        least, arc, pace = route.optimum_from(*route.random_start(generator))
        assert least == pytest.approx(route.energy(arc, pace)[0])
        for _ in range(300):
            other = arc + 1e-2 * generator.uniform(-1, 1, route.count)
            quicker = pace * np.exp(1e-2 * generator.uniform(-1, 1, route.count))
            stretch = np.where(other == 0, 1, other / 2 / np.sin(other / 2))
            slowest = np.minimum(np.minimum(quicker, 1 / route.limits.shortest),
                                 np.minimum(route.limits.speed / route.length / stretch,
                                            route.limits.turn_rate / np.abs(other)))
            if np.abs(route.sigma(other)).max() <= route.limits.turn:
                assert route.energy(other, slowest)[0] > least * (1 - 1e-6)


def test_no_optimum_where_there_is_no_way(tasks):
    """Turns of half a circle in a row, without a turn on the spot and with hardly any turn rate."""
    route = tasks[None][0].route
    tight = Route(route.model, Limits(1, 1e-6, 1e-6, 5, 600), np.full(LEGS, 10.0), np.full(LEGS, 3.0))
    assert tight.optimum_from(np.zeros(LEGS), np.full(LEGS, 0.05))[0] == math.inf


def test_plan_may_go_the_other_way_round(tasks):
    route = tasks[None][0].route
    arc, turn = np.full(route.count, 0.1), None
    turn = route.sigma(arc) + math.tau * np.arange(route.count)
    other = route.turned_as(arc, turn)
    assert other.sigma(arc) == pytest.approx(turn)
    assert route.turned_as(arc, route.sigma(arc) + 0.01).turn == pytest.approx(route.turn)


# ---- Figures -------------------------------------------------------------------------------------------------------

def test_a_short_run(tmp_path):
    path = tmp_path / "route.json"
    result = run_tool("measure.bench_route", "--routes", 6, "--seed", 3, "--bench", path)
    assert result.returncode == 0, result.stderr
    figures = {figure["name"]: figure for figure in json.loads(path.read_text())}
    assert all(name.startswith("route optimiser: ") and figure["command"] == "make figures"
               for name, figure in figures.items())
    paper = "route optimiser: the paper's four segments, steady voltages "
    joint = [figures[f"{paper}{which}"] for which in ("of its Table 1", "that b of its Table 2 implies")]
    assert [figure["value"] for figure in joint] == pytest.approx([1110.262, 1110.12], abs=0.01)
    assert all(figure["bound"] == {"op": "<=", "value": 1110.2} for figure in joint)
    assert all(abs(figure["value"]) < 0.05 for name, figure in figures.items() if name.startswith(paper)
               and name.endswith("above the best of scipy"))
    shares = [figure for name, figure in figures.items() if "within 0.05 %" in name]
    assert [figure["bound"] for figure in shares] == 3 * [None] + [{"op": ">=", "value": 99}]
    assert all(0 <= figure["value"] <= 100 for figure in shares)
    assert all(figure["value"] > 0 for name, figure in figures.items() if "saved of the greedy plan" in name)
    for text in ("3 routes, seed 3", "3 routes, seed 9", "1 routes, seed 15", "1110.26"):
        assert text in result.stdout


def test_equal_seeds_draw_equal_routes():
    kind = bench_route.KINDS[0]
    points = [bench_route.draw_points(np.random.default_rng(seed), kind.lengths) for seed in (4, 4, 5)]
    assert np.array_equal(points[0], points[1]) and not np.array_equal(points[0], points[2])
    chords = np.hypot(*np.diff(points[0], axis=0).T)
    assert len(chords) == bench_route.LEGS and 1 <= chords.min() and chords.max() <= 15


def test_missing_program_is_named(monkeypatch, tmp_path):
    robot = robot_json.load(ROOT / "sim/robots/gao2018.cfg", JP_ROBOT)
    monkeypatch.setattr(robot_json, "load", lambda *_: robot)
    monkeypatch.setenv("JP_BUILD", str(tmp_path))
    result = run_tool("measure.bench_route", "--bench", tmp_path / "route.json")
    assert_one_line_error(result, "jp-route", "build it with `make`")
    assert not (tmp_path / "route.json").exists()


@pytest.mark.parametrize("routes", ["1", "x"])
def test_bad_number_of_routes(routes):
    assert_one_line_error(run_tool("measure.bench_route", "--routes", routes), f"--routes: {routes}: must be a whole number")
