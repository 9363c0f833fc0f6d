"""jp-plan with learned parameters: the route follows them at the cost that an exhaustive search of our own finds, the
outputs say the version, and every wrong file is refused."""
import csv
import heapq
import json
import math
import re

import pytest
from conftest import ROOT, assert_one_line_error, run
from test_plan import BALANCER, ROVER, names_in, plan, planned, room, summary_of, write_map

WIDTH, HEIGHT = 44, 30
START, GOAL = (7, 15), (36, 15)  # cells; heading 0 at both
TASK = ["--start=1.5,3,0", "--goal=7.3,3,0"]
HEADINGS = 16
ELEVATION_ONE = 1024  # units a metre
ONE = 65536  # of a factor, and of a polynomial's coefficients
STEPS = [(1, 0), (2, 1), (1, 1), (1, 2), (0, 1), (-1, 2), (-1, 1), (-2, 1), (-1, 0), (-2, -1), (-1, -1), (-1, -2),
         (0, -1), (1, -2), (1, -1), (2, -1)]
ROVER_FACTORS = {"robot": "zhang2018", "version": 3, "straight": 1.0, "turning": 2.0, "mass": 1.0}


def hill():
    """0.5 m high between start and goal."""
    return [[round(0.5 * math.exp(-((x - WIDTH / 2)**2 + (y - HEIGHT / 2 + 0.5)**2) / 60), 3) for x in range(WIDTH)]
            for y in range(HEIGHT)]


@pytest.fixture
def ground(tmp_path):
    return write_map(tmp_path / "hill.json", room(WIDTH, HEIGHT), elevation=hill())


def write_parameters(path, data):
    path.write_text(json.dumps(data))
    return path


@pytest.fixture
def learned(tmp_path):
    return write_parameters(tmp_path / "learned.json", ROVER_FACTORS)


# ---- an exhaustive search ------------------------------------------------------------------------------------------

class Oracle:
    """Dijkstra over the primitives of jp-lattice at other prices, on cells of a map file."""

    def __init__(self, lattice, map_data, factors):
        self.factors = {key: round(factors[key] * ONE) for key in ("straight", "turning", "mass")}
        self.costs = [self._move(cost) for cost in lattice["costs"][0]["moves"]]
        self.by_start = [[primitive for primitive in lattice["primitives"] if primitive["start"] == heading]
                         for heading in range(HEADINGS)]
        self.rows = map_data["rows"][::-1]
        self.elevation = [[round(z * ELEVATION_ONE) for z in row] for row in map_data["elevation_m"][::-1]]

    def _move(self, cost):
        straight, mass = self.factors["straight"], self.factors["mass"]
        scales = straight, mass, (mass * mass + ONE // 2) // ONE
        sides = {side: [value * scale // ONE for value, scale in zip(cost[side], scales)]
                 for side in ("climb", "descend")}
        return {**cost, **sides, "bend": math.trunc(cost["bend"] * straight / mass)}

    def step(self, direction, rise):
        cost = self.costs[1 if direction % 2 else 2 if direction % 4 else 0]
        if abs(rise) > cost["rise_max"]:
            return math.inf
        constant, linear, quadratic = cost["climb" if rise >= cost["bend"] else "descend"]
        return max(cost["floor"], (constant + (linear + quadratic * rise) * rise) // ONE)

    def base(self, primitive):
        moves = set(primitive["moves"])
        straight = len(moves) == 1 and primitive["start"] == primitive["end"]
        return -(-primitive["base"][0] * self.factors["straight" if straight else "turning"] // ONE)

    def is_free(self, x, y):
        return 0 <= x < WIDTH and 0 <= y < HEIGHT and self.rows[y][x] == "."

    def edge(self, primitive, x, y):
        if not all(self.is_free(x + column, y + row) for row, first, last in primitive["swept"]
                   for column in range(first, last + 1)):
            return math.inf
        cost = self.base(primitive)
        for direction in primitive["moves"]:
            to_x, to_y = x + STEPS[direction][0], y + STEPS[direction][1]
            cost += self.step(direction, self.elevation[to_y][to_x] - self.elevation[y][x])
            x, y = to_x, to_y
        return cost

    def shortest(self):
        start, goal = (*START, 0), (*GOAL, 0)
        least, queue = {start: 0}, [(0, start)]
        while queue:
            cost, (x, y, heading) = heapq.heappop(queue)
            if (x, y, heading) == goal:
                return cost
            if cost > least[x, y, heading]:
                continue
            for primitive in self.by_start[heading]:
                state = x + primitive["dx"], y + primitive["dy"], primitive["end"]
                total = cost + self.edge(primitive, x, y)
                if total < least.get(state, math.inf):
                    least[state] = total
                    heapq.heappush(queue, (total, state))
        return math.inf


@pytest.fixture(scope="module")
def lattice(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lattice")
    result = run("jp-lattice", ROVER, "--output", folder)
    assert result.returncode == 0, result.stderr
    return json.loads((folder / "lattice.json").read_text())


def optimum(lattice, path, **factors):
    """J, by an exhaustive search at these factors."""
    return Oracle(lattice, json.loads(path.read_text()), {**ROVER_FACTORS, "turning": 1.0, **factors}).shortest() / 16


def y_of_route(output):
    with (output / "energy_route.csv").open(newline="") as file:
        return [float(row["y_m"]) for row in csv.DictReader(file)]


# ---- routes --------------------------------------------------------------------------------------------------------

def test_where_turning_is_dear_the_route_goes_over_the_hill(ground, lattice, learned, tmp_path):
    before, _ = planned(ground, tmp_path / "before", *TASK)
    after, _ = planned(ground, tmp_path / "after", *TASK, f"--parameters={learned}")
    built_in, route = before["routes"][0], after["routes"][0]
    assert built_in["energy_j"] == optimum(lattice, ground)
    assert route["energy_j"] == optimum(lattice, ground, turning=2.0)
    assert route["climb_m"] > built_in["climb_m"] + 0.15
    assert max(y_of_route(tmp_path / "before")) - max(y_of_route(tmp_path / "after")) > 0.8
    # Both choices are right: the route round the hill would cost more now, the one over it did cost more.
    assert built_in["energy_j"] + built_in["turning_energy_j"] > route["energy_j"]
    assert route["energy_j"] - route["turning_energy_j"] / 2 > built_in["energy_j"]


@pytest.mark.parametrize("factors", [
    {"turning": 0.3}, {"turning": 4.0}, {"straight": 0.3}, {"straight": 4.0}, {"mass": 0.3}, {"mass": 4.0},
    {"straight": 1.7, "turning": 0.6, "mass": 1.4}])
def test_cost_is_that_of_an_exhaustive_search(ground, lattice, tmp_path, factors):
    path = write_parameters(tmp_path / "learned.json", {**ROVER_FACTORS, "turning": 1.0, **factors})
    summary, _ = planned(ground, tmp_path / "out", *TASK, f"--parameters={path}")
    assert summary["routes"][0]["answer"] == "optimal"
    assert summary["routes"][0]["energy_j"] == optimum(lattice, ground, **factors)


def test_both_routes_are_charged_alike(ground, learned, tmp_path):
    """The distance-optimal route is the same, and takes what the learned parameters say."""
    before, _ = planned(ground, tmp_path / "before", *TASK)
    after, _ = planned(ground, tmp_path / "after", *TASK, f"--parameters={learned}")
    built_in, route = before["routes"][1], after["routes"][1]
    assert route["length_m"] == built_in["length_m"]
    assert route["turning_energy_j"] == 2 * built_in["turning_energy_j"]
    assert route["energy_j"] >= after["routes"][0]["energy_j"]


def test_factors_of_one_give_the_same_plan(ground, tmp_path):
    path = write_parameters(tmp_path / "one.json", {"robot": "zhang2018", "version": 1, "straight": 1, "turning": 1})
    before, _ = planned(ground, tmp_path / "before", *TASK)
    after, _ = planned(ground, tmp_path / "after", *TASK, f"--parameters={path}")
    for name in ("energy_route.csv", "distance_route.csv"):
        assert (tmp_path / "before" / name).read_bytes() == (tmp_path / "after" / name).read_bytes()
    assert [route["expansions"] for route in before["routes"]] == [route["expansions"] for route in after["routes"]]


# ---- what says the version -----------------------------------------------------------------------------------------

def test_version_of_learned_parameters(ground, learned, tmp_path):
    summary, table = planned(ground, tmp_path / "out", *TASK, f"--parameters={learned}")
    assert summary["parameters"] == {"version": 3, "file": str(learned)}
    assert [route["parameter_version"] for route in summary["routes"]] == [3, 3]
    assert f"parameters: learned, version 3, {learned}" in table


def test_version_of_the_built_in_parameters(ground, tmp_path):
    summary, table = planned(ground, tmp_path / "out", *TASK)
    assert summary["parameters"] == {"version": 0, "file": None}
    assert [route["parameter_version"] for route in summary["routes"]] == [0, 0]
    assert "parameters: built in, version 0" in table


def test_no_route_has_no_version(tmp_path, learned):
    path = write_map(tmp_path / "shut.json", room(60, 40, [(25, 0, 3, 40)]))
    result = plan(path, tmp_path / "out", "--start=2,4,0", "--goal=10,4", f"--parameters={learned}")
    assert result.returncode == 1
    summary = summary_of(tmp_path / "out")
    assert summary["parameters"]["version"] == 3
    assert [route["parameter_version"] for route in summary["routes"]] == [None, None]


def test_largest_version(ground, tmp_path):
    path = write_parameters(tmp_path / "old.json", {**ROVER_FACTORS, "version": 2**32 - 1})
    summary, _ = planned(ground, tmp_path / "out", *TASK, f"--parameters={path}")
    assert summary["routes"][0]["parameter_version"] == 2**32 - 1


# ---- a robot with an energy model ----------------------------------------------------------------------------------

def model_of(name):
    text = (ROOT / "src/tables" / f"energy_{name}.c").read_text(encoding="utf-8")
    values = {key: float(value) for key, value in re.findall(r"/\* ([ab]\d+): (\S+) ", text)}
    return {"a": [values[f"a{i}"] for i in range(1, 14)], "b": [values["b1"], values["b2"]]}


@pytest.fixture
def model():
    return {"robot": "gao2018", "version": 5, **model_of("gao2018")}


def balancer_plan(tmp_path, data, name="out"):
    level = write_map(tmp_path / "level.json", room(60, 40, [(25, 0, 3, 28)]))
    path = write_parameters(tmp_path / f"{name}.json", data)
    return planned(level, tmp_path / name, "--start=2,4,0", "--goal=10,4", f"--parameters={path}", robot=BALANCER)[0]


def test_balancer_with_its_learned_model(tmp_path, model):
    same = balancer_plan(tmp_path, model, "same")
    model["b"][0] *= 2
    dearer = balancer_plan(tmp_path, model, "dearer")
    for summary in (same, dearer):
        assert summary["parameters"]["version"] == 5
        assert summary["drive"]["clear"] is True
    # At its cruising speed the balancer spends as much on driving as on its electronics.
    assert dearer["routes"][0]["energy_j"] == pytest.approx(1.5 * same["routes"][0]["energy_j"], rel=0.05)


def test_plans_are_charged_by_what_a_robot_learned_on_a_trip(tmp_path, model):
    trip = run("jp-trip", BALANCER, "--seed", "4", "--output", tmp_path)  # its ground has 1.6 times the friction
    assert trip.returncode == 0, trip.stderr
    learned = json.loads((tmp_path / "parameters.json").read_text())
    built_in = balancer_plan(tmp_path, model, "built_in")["routes"][0]
    charged = balancer_plan(tmp_path, learned, "charged")["routes"][0]
    assert charged["parameter_version"] == learned["version"] > 20
    assert 1.1 * built_in["energy_j"] < charged["energy_j"] < 2 * built_in["energy_j"]


def test_balancer_by_factors(tmp_path):
    summary = balancer_plan(tmp_path, {**ROVER_FACTORS, "robot": "gao2018"})
    assert summary["parameters"]["version"] == 3


# ---- wrong input ---------------------------------------------------------------------------------------------------

def without(data, key):
    return {name: value for name, value in data.items() if name != key}


@pytest.mark.parametrize(("data", "parts"), [
    (without(ROVER_FACTORS, "version"), ["version: is missing"]),
    (without(ROVER_FACTORS, "robot"), ["robot: is missing"]),
    (without(ROVER_FACTORS, "straight"), ["straight: is missing"]),
    (without(ROVER_FACTORS, "turning"), ["turning: is missing"]),
    ({**ROVER_FACTORS, "version": 0}, ["version: 0", "1…4294967295"]),
    ({**ROVER_FACTORS, "version": -1}, ["version: -1"]),
    ({**ROVER_FACTORS, "version": 2**32}, ["version: 4294967296"]),
    ({**ROVER_FACTORS, "version": 1.5}, ["version:", "nteger"]),
    ({**ROVER_FACTORS, "version": "3"}, ["version:", "nteger"]),
    ({**ROVER_FACTORS, "turning": -1.0}, ["turning", "0.25…4"]),
    ({**ROVER_FACTORS, "turning": 0}, ["turning", "0.25…4"]),
    ({**ROVER_FACTORS, "straight": 4.01}, ["straight", "0.25…4"]),
    ({**ROVER_FACTORS, "mass": 1e300}, ["mass", "0.25…4"]),
    ({**ROVER_FACTORS, "straight": "dear"}, ["straight:", "real"]),
    ({**ROVER_FACTORS, "mass": None}, ["mass:", "real"]),
    ({**ROVER_FACTORS, "robot": "gao2018"}, ["'gao2018' is not 'zhang2018'"]),
    ({**ROVER_FACTORS, "friction": 1.0}, ["friction"]),
    ({"robot": "zhang2018", "version": 3, **model_of("gao2018")}, ["zhang2018 has no such energy model"]),
    ({**ROVER_FACTORS, **model_of("gao2018")}, ["straight"]),
    ([ROVER_FACTORS], ["object"]),
])
def test_parameters_that_are_refused(ground, tmp_path, data, parts):
    path = write_parameters(tmp_path / "wrong.json", data)
    assert_one_line_error(plan(ground, tmp_path / "out", *TASK, f"--parameters={path}"), path, *parts)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("change", "parts"), [
    ({"a": [1.0] * 12}, ["a: must be a list of 13 numbers"]),
    ({"a": 1.0}, ["a: must be a list of 13 numbers"]),
    ({"b": [20.0]}, ["b: must be a list of 2 numbers"]),
    ({"b": [20.0, "x"]}, ["b2: must be a number"]),
    ({"b": [20.0, -0.1]}, ["b2: must be a number from 0 to 4096"]),
    ({"b": [4000.0, 0.6]}, ["straight", "0.25…4"]),
    ({"a": [5000.0] + [1.0] * 12}, ["a1: must be a number from -4096 to 4096"]),
])
def test_models_that_are_refused(tmp_path, model, change, parts):
    level = write_map(tmp_path / "level.json", room())
    path = write_parameters(tmp_path / "wrong.json", {**model, **change})
    result = plan(level, tmp_path / "out", "--start=2,4,0", "--goal=10,4", f"--parameters={path}", robot=BALANCER)
    assert_one_line_error(result, path, *parts)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("text", ["", "{", '{"robot": "zhang2018", "version": 1, "version": 2}', "NaN",
                                  '{"robot": "zhang2018", "version": 1, "straight": NaN, "turning": 1}',
                                  '{"robot": "zhang2018", "version": 1, "straight": 1e999, "turning": 1}'])
def test_files_that_are_no_json(ground, tmp_path, text):
    path = tmp_path / "wrong.json"
    path.write_text(text)
    assert_one_line_error(plan(ground, tmp_path / "out", *TASK, f"--parameters={path}"), path)
    assert not (tmp_path / "out").exists()


def test_file_that_is_not_there(ground, tmp_path):
    result = plan(ground, tmp_path / "out", *TASK, f"--parameters={tmp_path / 'none.json'}")
    assert_one_line_error(result, "none.json", "No such file")


def test_folder_in_place_of_a_file(ground, tmp_path):
    assert_one_line_error(plan(ground, tmp_path / "out", *TASK, f"--parameters={tmp_path}"), tmp_path)


def test_the_papers_cost_does_not_follow(ground, learned, tmp_path):
    result = plan(ground, tmp_path / "out", *TASK, f"--parameters={learned}", "--cost=paper")
    assert result.returncode == 2
    assert "--parameters" in result.stderr
    assert not (tmp_path / "out").exists()
    assert "hill.json" in names_in(tmp_path)
