"""Drives of the navigator: those of jp-navigate, bit by bit."""
import csv
import json

import numpy
import pytest
from joulepath import Error, Robot, Terrain, navigate
from joulepath.navigator import STATES

START, GOAL = (1.0, 1.0, 0), (5.0, 3.0)
ROBOTS = {"courier24": 0.1, "burger": 0.05}  # m, of a cell


def room(cell):
    """6 × 4 m, with a wall that is open at one end."""
    cells = numpy.zeros((round(4 / cell), round(6 / cell)), bool)
    cells[[0, -1], :] = cells[:, [0, -1]] = True
    cells[0:round(2.5 / cell), round(3 / cell)] = True
    return cells


def terrain_for(robot):
    return Terrain(room(ROBOTS[robot]), ROBOTS[robot])


def write_map(path, cell):
    cells = room(cell)
    rows = ["".join(".#"[int(cell)] for cell in row) for row in cells[::-1]]
    path.write_text(json.dumps({"format": "joulepath-map-1", "name": "room", "width": cells.shape[1],
                                "height": cells.shape[0], "resolution_m": cell, "origin_m": [0, 0, 0], "rows": rows}))
    return path


@pytest.mark.parametrize("name", ROBOTS)
def test_it_is_the_drive_of_the_program(run, tmp_path, name):
    path = write_map(tmp_path / "map.json", ROBOTS[name])
    robot = Robot(name)
    folder = run("jp-navigate", path, "--robot", robot.path, "--start", "1,1,0", "--goal", "5,3", "--hidden", 3, "--seed", 2)
    expected = json.loads((folder / "summary.json").read_text())["result"]
    ours = navigate(Terrain.load(path), robot, START, GOAL, hidden=3, seed=2)
    assert ours.outcome == expected["state"] == "arrived" and not ours.touched
    for key, value in {"energy_j": ours.joules, "time_s": ours.seconds, "length_m": ours.metres,
                       "planned_j": ours.planned_joules, "forecast_j": ours.forecast_joules,
                       "forecast_deviation_j": ours.forecast_deviation, "clearance_m": ours.clearance_m,
                       "goal_error_m": ours.goal_error_m, "replans": ours.replans, "cells_seen": ours.cells_seen}.items():
        assert value == expected[key], key
    with (folder / "drive.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) <= len(ours.rows) and STATES[ours.rows["state"][-1]] == "arrived"
    assert ours.rows["x_m"][-1] == pytest.approx(float(rows[-1]["x_m"]), abs=1e-3)


def test_a_seed_hides_other_boxes_and_what_it_saw_is_in_the_map():
    terrains = [terrain_for("burger") for _ in range(2)]
    first, other = (navigate(terrain, Robot("burger"), START, GOAL, seed=seed)
                    for terrain, seed in zip(terrains, (1, 2)))
    assert first.joules != other.joules
    for drive, terrain in zip((first, other), terrains):
        # A wall moves on the map with what odometry is wrong by: its cells are told more than once.
        assert drive.cells_seen >= (terrain.cells != terrain_for("burger").cells).sum() > 0
    assert "Navigation arrived" in repr(first)


@pytest.mark.parametrize("robot, start, goal, says", [
    ("gao2018", START, GOAL, "gao2018: no lattice for finding its way"), ("burger", (0, 0, 0), GOAL, "does not fit"),
    ("burger", START, None, "give both or neither"), ("burger", START, (99, 1), "outside the map")])
def test_what_is_wrong_is_said(robot, start, goal, says):
    with pytest.raises(ValueError, match=says):
        navigate(terrain_for("burger"), Robot(robot), start, goal)


def test_a_map_of_other_cells_is_refused():
    with pytest.raises(Error, match="cells"):
        navigate(terrain_for("courier24"), Robot("burger"), START, GOAL)
