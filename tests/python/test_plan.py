"""Plans: those of the program, bit by bit; repaired when the map changes; in no more time."""
import csv
import json
import time

import numpy
import pytest
from conftest import ROOT
from joulepath import OCCUPIED, Answer, Error, Lattice, Planner, Robot, Terrain, plan

START, GOAL = (1.5, 4.1, 90), (10.5, 4.1)


def wall_and_hill():
    y, x = numpy.mgrid[0:40, 0:60]
    cells = numpy.zeros((40, 60), bool)
    cells[0:28, 25:28] = True
    return cells, numpy.round(1.2 * numpy.exp(-((x - 40)**2 + (y - 20)**2) / 150), 3)


@pytest.fixture(scope="module")
def terrain():
    cells, elevation = wall_and_hill()
    return Terrain(cells, 0.2, elevation)


def write_map(path):
    cells, elevation = wall_and_hill()
    path.write_text(json.dumps({
        "format": "joulepath-map-1", "name": "map", "width": 60, "height": 40, "resolution_m": 0.2,
        "origin_m": [0, 0, 0], "rows": ["".join(".#"[int(cell)] for cell in row) for row in cells[::-1]],
        "elevation_m": elevation[::-1].tolist()}))
    return path


def text_of(place):
    return ",".join(map(str, place))


@pytest.mark.parametrize("memory", [64, 8192])
@pytest.mark.parametrize("name", ["zhang2018"])
def test_it_is_the_plan_of_the_program(terrain, run, tmp_path, name, memory):
    folder = run("jp-plan", write_map(tmp_path / "map.json"), "--robot", name, "--memory", memory,
                 f"--start={text_of(START)}", f"--goal={text_of(GOAL)}")
    ours = plan(terrain, Robot(name), START, GOAL, memory=memory << 10)
    route = next(route for route in json.loads((folder / "summary.json").read_text())["routes"] if route["name"] == "energy")
    assert (ours.joules, ours.metres, ours.seconds) == (route["energy_j"], route["length_m"], route["time_s"])
    with (folder / "energy_route.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(ours.route)
    for key, values, digits in [("x_m", ours.xy_m[:, 0], 4), ("y_m", ours.xy_m[:, 1], 4),
                                ("length_m", ours.route["length_m"], 3), ("energy_j", ours.route["joules"], 4),
                                ("time_s", ours.route["seconds"], 3)]:
        assert [row[key] for row in rows] == [f"{value:.{digits}f}" for value in values]
    loaded = plan(Terrain.load(tmp_path / "map.json"), Robot(name), START, GOAL, memory=memory << 10)
    assert (loaded.route == ours.route).all() and loaded.cost == ours.cost


def test_energy_and_distance_differ_as_they_should(terrain):
    robot = Robot("zhang2018")
    energy, distance = (plan(terrain, robot, START, GOAL, cost=cost) for cost in ("energy", "distance"))
    assert energy.answer is distance.answer is Answer.OPTIMAL
    assert energy.bound == 1 and energy.arrives
    assert energy.joules < distance.joules and energy.metres > distance.metres
    assert energy.climb_m < distance.climb_m


def test_a_route_is_the_way_of_its_steps(terrain):
    route = plan(terrain, Robot("zhang2018"), START, GOAL).route
    assert (numpy.diff(route["joules"]) > 0).all() and (numpy.diff(route["length_m"]) >= 0).all()
    assert not terrain.cells[route["y"], route["x"]].any()
    assert not route.flags.owndata


def test_changes_are_repaired_to_the_plan_of_a_new_search():
    cells, elevation = wall_and_hill()
    terrain, robot = Terrain(cells, 0.2, elevation), Robot("zhang2018")
    planner = Planner(terrain, robot)
    planner.set_task(START, GOAL)
    first = planner.work()
    for y in range(28, 33):
        planner.set_cell(26, y, OCCUPIED)
    planner.set_elevation(10, 30, 0.4)
    repaired = planner.work()
    assert terrain.cells[30, 26] == OCCUPIED and terrain.elevation_m[30, 10] == pytest.approx(0.4, abs=1e-3)
    assert repaired.cost > first.cost
    assert repaired.cost == plan(terrain, robot, START, GOAL).cost


def test_work_in_slices_ends_in_the_same_plan(terrain):
    planner = Planner(terrain, Robot("zhang2018"))
    planner.set_task(START, GOAL)
    assert planner.work(1).answer is Answer.NONE_YET
    while not planner.is_idle:
        sliced = planner.work(50)
    assert sliced.cost == plan(terrain, Robot("zhang2018"), START, GOAL).cost
    assert planner.counts["expansions"] > 0 and planner.counts["states"] <= planner.counts["states_max"]


def test_without_places_it_chooses_some(terrain):
    assert plan(terrain, Robot("zhang2018")).arrives


def test_no_way_is_proved(terrain):
    cells, elevation = wall_and_hill()
    cells[:, 26] = True
    closed = plan(Terrain(cells, 0.2, elevation), Robot("zhang2018"), START, GOAL)
    assert closed.answer is Answer.UNREACHABLE and not closed.arrives and len(closed.route) == 1


def test_a_call_takes_the_time_of_its_search(terrain):
    """The planner's own work, in C, is more than 10/11 of a call from Python: of the thread's time on a processor."""
    planner = Planner(terrain, Robot("zhang2018"), memory=32 << 20)
    planner.set_task(START, GOAL)
    inside, begin = 0.0, time.thread_time()
    from joulepath._native import lib
    while not planner.is_idle:
        before = time.thread_time()
        lib.jp_planner_work(planner._planner, 1000)
        inside += time.thread_time() - before
    planner.work()
    assert time.thread_time() - begin <= 1.1 * inside + 0.002


@pytest.mark.parametrize("start, goal, says", [
    ((1.5, 4.1), GOAL, "start: 2 numbers"), (START, (1,), "goal: 1 numbers"), (START, (99, 1), "outside the map"),
    (START, (5.3, 1.1), "goal: the robot does not fit there")])
def test_places_that_will_not_do_are_said(terrain, start, goal, says):
    with pytest.raises(ValueError, match=says):
        plan(terrain, Robot("zhang2018"), start, goal)


@pytest.mark.parametrize("options, says", [
    (dict(cost="time"), "energy, paper, distance"), (dict(memory=100), "give at least"),
    (dict(epsilon=()), "0 values"), (dict(epsilon=(1, 2)), "epsilon"), (dict(epsilon=(2,) * 9), "9 values")])
def test_options_that_will_not_do_are_said(terrain, options, says):
    with pytest.raises(ValueError, match=says):
        Planner(terrain, Robot("zhang2018"), **options)


def test_robots_maps_and_lattices_that_do_not_fit_are_said(terrain, tmp_path):
    text = Robot("zhang2018").path.read_text().replace('name = "zhang2018"', 'name = "mine"')
    (tmp_path / "mine.cfg").write_text(text)
    with pytest.raises(Error, match="mine: no lattice is built in"):
        Lattice(Robot(tmp_path / "mine.cfg"))
    with pytest.raises(Error, match="of zhang2018, not of burger"):
        Planner(terrain, Robot("burger"), lattice=Lattice(Robot("zhang2018")))
    with pytest.raises(Error, match="cells"):
        Planner(terrain, Robot("burger"))
    with pytest.raises(Error, match="no task"):
        Planner(terrain, Robot("zhang2018")).work()
    with pytest.raises(Error, match="off the map"):
        Planner(terrain, Robot("zhang2018")).set_cell(-1, 0, OCCUPIED)
    with pytest.raises(Error, match="no/lattice.json"):
        Lattice.load("no/lattice.json")


def test_robots_say_what_a_planner_must_know():
    robot = Robot("zhang2018")
    assert robot.name == "zhang2018" and robot.path.exists() and robot.cell_m == 0.2
    assert Robot(ROOT / "sim/robots/zhang2018.cfg").length_m == robot.length_m > robot.width_m > 0
    assert 0 < robot.cheapest_speed() <= robot.speed_max
    level, uphill = (robot.motion_joules(0.5, 0, 2, rise) for rise in (0, 0.1))
    assert robot.electronics_w * 2 < level < uphill
    with pytest.raises(Error, match="four_wheel"):
        Robot("patrol")
    with pytest.raises(Error, match="nobody.cfg: No such file"):
        Robot("nobody")
