"""jp-plan on small maps: tables, files and sums, every answer, every wrong input, and the balancer's drive."""
import csv
import json
import math
import re
import shutil

import pytest
from conftest import ROOT, assert_one_line_error, fill_disk, run

ROVER = ROOT / "sim/robots/zhang2018.cfg"
BALANCER = ROOT / "sim/robots/gao2018.cfg"
CELL = 0.2
FILES = ["distance_route.csv", "energy_route.csv", "summary.json"]
DRIVE_FILES = sorted([*FILES, "drive.csv", "scenario.cfg"])


# ---- maps ----------------------------------------------------------------------------------------------------------

def room(width=60, height=40, walls=()):
    """Rows of a map, the northern one first, with walls (x, y, columns, rows) counted from the south-west corner."""
    cells = [["."] * width for _ in range(height)]
    for x, y, columns, rows in [(0, 0, width, 1), (0, height - 1, width, 1), (0, 0, 1, height),
                                (width - 1, 0, 1, height), *walls]:
        for row in range(y, y + rows):
            cells[height - 1 - row][x:x + columns] = "#" * columns
    return ["".join(row) for row in cells]


def hill(width, height):
    """1.2 m high between start and goal, so that the way round it saves energy."""
    return [[round(1.2 * math.exp(-((x - width / 2)**2 + (height / 2 - y)**2) / 150), 3) for x in range(width)]
            for y in range(height)]


def write_map(path, rows, origin=(0.0, 0.0, 0.0), elevation=None, resolution=CELL):
    data = {"format": "joulepath-map-1", "name": path.stem, "width": len(rows[0]), "height": len(rows),
            "resolution_m": resolution, "origin_m": list(origin), "rows": rows}
    if elevation is not None:
        data["elevation_m"] = elevation
    path.write_text(json.dumps(data))
    return path


@pytest.fixture
def level(tmp_path):
    return write_map(tmp_path / "level.json", room(walls=[(25, 0, 3, 28)]))


@pytest.fixture
def hills(tmp_path):
    return write_map(tmp_path / "hills.json", room(), elevation=hill(60, 40))


def plan(path, output, *options, robot=ROVER, **more):
    return run("jp-plan", path, "--robot", robot, "--output", output, *options, **more)


def places(start, goal):
    return [f"--start={start}", f"--goal={goal}"]


def summary_of(output):
    return json.loads((output / "summary.json").read_text())


def rows_of(path):
    with path.open() as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def names_in(folder):
    return sorted(path.name for path in folder.iterdir())


def planned(path, output, *options, **more):
    result = plan(path, output, *options, **more)
    assert result.returncode == 0, result.stdout + result.stderr
    assert result.stderr == ""
    return summary_of(output), result.stdout


# ---- plans ---------------------------------------------------------------------------------------------------------

TASK = places("2,4,0", "10,4")


def test_energy_and_distance_over_a_hill(hills, tmp_path):
    summary, _ = planned(hills, tmp_path / "out", *TASK)
    energy, distance = summary["routes"]
    assert (energy["name"], distance["name"]) == ("energy", "distance")
    assert energy["answer"] == distance["answer"] == "optimal"
    assert energy["bound"] == distance["bound"] == 1
    assert energy["energy_j"] < 0.95 * distance["energy_j"]
    assert energy["length_m"] > distance["length_m"]
    assert energy["climb_m"] < distance["climb_m"]
    comparison = summary["comparison"]
    for key, name in (("energy_percent", "energy_j"), ("length_percent", "length_m"), ("time_percent", "time_s")):
        assert comparison[key] == pytest.approx(100 * (energy[name] / distance[name] - 1), abs=1e-6)
    assert names_in(tmp_path / "out") == sorted([*FILES, "drive.csv"])


def test_the_rover_drives_over_the_hill(hills, tmp_path):
    summary, table = planned(hills, tmp_path / "out", *TASK)
    drive, route = summary["drive"], summary["routes"][0]
    assert drive["scenario"] is None and drive["clear"] is True and drive["level_ground_assumed"] is False
    assert drive["planned"]["energy_j"] == pytest.approx(route["energy_j"], abs=1e-6)
    for what in ("predicted", "driven"):
        assert drive[what]["length_m"] == pytest.approx(route["length_m"], rel=0.1)
    assert drive["predicted"]["energy_j"] == pytest.approx(drive["driven"]["energy_j"], rel=1 / 3)  # it slides in turns
    assert drive["waypoints_m"][0] == pytest.approx([2.1, 4.1], abs=1e-2)
    assert drive["waypoints_m"][-1] == pytest.approx([10.1, 4.1], abs=1e-2)
    log = rows_of(tmp_path / "out" / drive["log"])
    assert log[-1]["energy_j"] == pytest.approx(drive["driven"]["energy_j"], rel=0.02)
    assert "planned: lattice " in table and "leave the map's climbs out" not in table


def test_files_add_up_to_the_summary(hills, tmp_path):
    summary, _ = planned(hills, tmp_path / "out", *TASK)
    for route in summary["routes"]:
        rows = rows_of(tmp_path / "out" / route["file"])
        assert len(rows) == route["steps"] + 1
        assert [rows[0][key] for key in ("length_m", "energy_j", "time_s")] == [0, 0, 0]
        for key in ("length_m", "energy_j", "time_s"):
            values = [row[key] for row in rows]
            assert values == sorted(values)
            assert values[-1] == pytest.approx(route[key], abs=1e-3)
        chords = sum(math.dist((a["x_m"], a["y_m"]), (b["x_m"], b["y_m"])) for a, b in zip(rows, rows[1:]))
        assert 0.97 * route["length_m"] <= chords <= 1.001 * route["length_m"]
        climbs = sum(max(0, b["z_m"] - a["z_m"]) for a, b in zip(rows, rows[1:]))
        assert climbs <= route["climb_m"] + 1e-3


def test_route_leads_from_start_to_goal_over_free_cells(level, tmp_path):
    summary, _ = planned(level, tmp_path / "out", *TASK)
    cells = json.loads(level.read_text())["rows"][::-1]
    for route in summary["routes"]:
        rows = rows_of(tmp_path / "out" / route["file"])
        assert (rows[0]["x_m"], rows[0]["y_m"], rows[0]["heading_deg"]) == pytest.approx((2.1, 4.1, 0), abs=1e-2)
        assert (rows[-1]["x_m"], rows[-1]["y_m"]) == pytest.approx((10.1, 4.1), abs=1e-2)
        assert all(cells[int(row["y_m"] / CELL)][int(row["x_m"] / CELL)] == "." for row in rows)
        assert max(row["y_m"] for row in rows) > 28 * CELL  # round the wall


def test_table_says_what_the_summary_says(level, tmp_path):
    summary, table = planned(level, tmp_path / "out", *TASK)
    for route in summary["routes"]:
        line = next(line for line in table.splitlines() if line.startswith(route["title"]))
        numbers = [float(cell) for cell in line.split()[1:6]]
        assert numbers == pytest.approx([route["length_m"], route["energy_j"], route["time_s"], route["climb_m"],
                                         route["turning_energy_j"]], abs=0.06)
        assert line.split()[6:8] == ["optimal", "1.000"]
    difference = next(line for line in table.splitlines() if line.startswith("difference")).split()[2:5]
    assert float(difference[1]) == pytest.approx(summary["comparison"]["energy_percent"], abs=0.006)
    assert "as given" in table
    assert re.search(r"^memory: planner's block 8192 KiB", table, re.MULTILINE)
    memory = summary["memory"]
    assert memory["guide_bytes"] + memory["field_bytes"] + memory["search_bytes"] <= memory["block_bytes"] == 8 << 20


def test_places_are_chosen_far_apart(level, tmp_path):
    """The plan between them has no margin to the wall's end, so that a drive along it may touch it: status 1."""
    first, again = (plan(level, tmp_path / name) for name in ("out", "again"))
    summary = summary_of(tmp_path / "out")
    assert first.returncode == again.returncode <= 1 and first.stderr == ""
    assert summary["task_chosen"] and all(route["answer"] == "optimal" for route in summary["routes"])
    assert "chosen" in first.stdout
    assert math.dist(summary["start"][:2], summary["goal_m"]) > 8
    assert summary_of(tmp_path / "again")["start"] == summary["start"]


def test_heading_of_the_goal(level, tmp_path):
    for heading in (0, 90, 181):
        planned(level, tmp_path / "out", *places("2,4,0", f"10,4,{heading}"))
        last = rows_of(tmp_path / "out" / "energy_route.csv")[-1]
        assert abs(math.remainder(last["heading_deg"] - heading, 360)) < 14


def test_costs_have_their_own_optimum(hills, tmp_path):
    physical, _ = planned(hills, tmp_path / "physical", *TASK)
    paper, table = planned(hills, tmp_path / "paper", *TASK, "--cost=paper")
    assert paper["routes"][0]["cost"] == "paper"
    assert "paper cost" in table
    assert physical["routes"][0]["energy_j"] <= paper["routes"][0]["energy_j"]
    assert physical["routes"][1]["energy_j"] == paper["routes"][1]["energy_j"]


def test_frame_of_the_map(tmp_path):
    """The same task in a frame that is moved and turned gives the same route there."""
    rows, yaw = room(walls=[(25, 0, 3, 28)]), math.radians(30)

    def moved(x, y):
        return 100 + x * math.cos(yaw) - y * math.sin(yaw), -50 + x * math.sin(yaw) + y * math.cos(yaw)

    planned(write_map(tmp_path / "plain.json", rows), tmp_path / "plain", *places("2.1,4.1,0", "10.1,4.1"))
    start, goal = moved(2.1, 4.1), moved(10.1, 4.1)
    planned(write_map(tmp_path / "turned.json", rows, origin=(100, -50, yaw)), tmp_path / "turned",
            *places(f"{start[0]},{start[1]},30", f"{goal[0]},{goal[1]}"))
    plain, turned = (rows_of(tmp_path / name / "energy_route.csv") for name in ("plain", "turned"))
    assert len(plain) == len(turned)
    for a, b in zip(plain, turned):
        assert (b["x_m"], b["y_m"]) == pytest.approx(moved(a["x_m"], a["y_m"]), abs=1e-3)
        assert b["heading_deg"] == pytest.approx(a["heading_deg"] + 30, abs=1e-2)
        assert b["energy_j"] == a["energy_j"]


def test_goal_where_the_robot_is(level, tmp_path):
    summary, _ = planned(level, tmp_path / "out", *places("2,4,0", "2,4"))
    assert [route["length_m"] for route in summary["routes"]] == [0, 0]
    assert summary["comparison"]["energy_percent"] is None


def without_times(path):
    return re.sub(r'"(planning|whole)_s": [^,\n]+', r'"\1_s": 0', path.read_text())


def test_same_bytes_again(level, tmp_path):
    planned(level, tmp_path / "one", *TASK, robot=BALANCER)
    planned(level, tmp_path / "two", *TASK, robot=BALANCER)
    for name in DRIVE_FILES:
        assert without_times(tmp_path / "one" / name) == without_times(tmp_path / "two" / name), name


# ---- honest answers ------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("robot", [ROVER, BALANCER])
def test_unreachable_goal(tmp_path, robot):
    path = write_map(tmp_path / "shut.json", room(walls=[(25, 0, 3, 40)]))
    result = plan(path, tmp_path / "out", *TASK, robot=robot)
    assert result.returncode == 1
    assert "unreachable" in result.stdout
    summary = summary_of(tmp_path / "out")
    assert [route["answer"] for route in summary["routes"]] == ["unreachable", "unreachable"]
    assert summary["comparison"] is None and summary["drive"] is None
    assert names_in(tmp_path / "out") == FILES


def test_partial_plan_in_little_memory(tmp_path):
    walls = [(x, 0 if x % 20 else 3, 2, 97) for x in range(10, 290, 10)]
    path = write_map(tmp_path / "maze.json", room(300, 100, walls))
    result = plan(path, tmp_path / "out", *places("1,10,90", "58,10"), "--memory=14")
    assert result.returncode == 1, result.stdout
    for route in summary_of(tmp_path / "out")["routes"]:
        assert route["answer"] == "partial"
        assert route["bound"] is None
        last = rows_of(tmp_path / "out" / route["file"])[-1]
        assert route["distance_left_m"] == pytest.approx(math.dist((last["x_m"], last["y_m"]), (58.1, 10.1)), abs=0.02)
        assert f"ends {route['distance_left_m']:.1f} m before the goal" in result.stdout


# ---- the drive -----------------------------------------------------------------------------------------------------

@pytest.fixture(scope="module")
def driven(tmp_path_factory):
    folder = tmp_path_factory.mktemp("drive")
    path = write_map(folder / "level.json", room(walls=[(25, 0, 3, 28), (40, 12, 3, 28)]))
    summary, table = planned(path, folder / "out", *places("2,2,90", "10,6"), robot=BALANCER)
    return path, folder / "out", summary, table


def test_balancer_reaches_the_goal(driven):
    _, output, summary, table = driven
    assert names_in(output) == DRIVE_FILES
    drive = summary["drive"]
    assert drive["clear"] is True
    assert drive["end_error_m"] < 0.1
    assert len(drive["waypoints_m"]) >= 4  # round two walls
    assert drive["waypoints_m"][0] == pytest.approx([2.1, 2.1], abs=1e-2)
    assert drive["waypoints_m"][-1] == pytest.approx([10.1, 6.1], abs=1e-2)
    assert "touched no obstacle" in table
    assert "level: these energies leave" not in table


def test_energies_side_by_side(driven):
    drive = driven[2]["drive"]
    assert drive["predicted"]["energy_j"] == pytest.approx(drive["driven"]["energy_j"], rel=0.01)
    assert drive["planned"]["energy_j"] == pytest.approx(driven[2]["routes"][0]["energy_j"], abs=1e-6)
    assert drive["driven"]["length_m"] == pytest.approx(drive["predicted"]["length_m"], rel=0.02)


def footprint_points(x, y, heading):
    for u in (-0.15, -0.075, 0, 0.075, 0.15):
        for v in (-0.175, -0.0875, 0, 0.0875, 0.175):
            yield (x + u * math.cos(heading) - v * math.sin(heading), y + u * math.sin(heading) + v * math.cos(heading))


def test_logged_path_touches_no_obstacle(driven):
    path, output, summary, _ = driven
    cells = json.loads(path.read_text())["rows"][::-1]
    x0, y0, degrees = summary["start"]
    start = math.radians(degrees)
    for row in rows_of(output / summary["drive"]["log"]):
        x = x0 + row["x_m"] * math.cos(start) - row["y_m"] * math.sin(start)
        y = y0 + row["x_m"] * math.sin(start) + row["y_m"] * math.cos(start)
        for px, py in footprint_points(x, y, start + row["heading_rad"]):
            assert cells[int(py / CELL)][int(px / CELL)] == ".", (px, py)


def test_scenario_drives_alike_in_jp_mission(driven, tmp_path):
    _, output, summary, _ = driven
    result = run("jp-mission", output / "scenario.cfg", "--output", tmp_path)
    assert result.returncode == 0, result.stderr
    optimal = summary_of(tmp_path)["strategies"][0]
    assert optimal["total"]["measured_energy_j"] == pytest.approx(summary["drive"]["driven"]["energy_j"], abs=1e-6)
    assert len(optimal["segments"]) == len(summary["drive"]["waypoints_m"]) - 1


def test_simulator_is_level_and_says_so(hills, tmp_path):
    summary, table = planned(hills, tmp_path / "out", *TASK, robot=BALANCER)
    drive = summary["drive"]
    assert drive["level_ground_assumed"] is True
    assert "the simulator's ground is level" in table
    assert drive["planned"]["energy_j"] != summary["routes"][0]["energy_j"]
    assert drive["planned"]["energy_j"] == pytest.approx(drive["driven"]["energy_j"], rel=0.15)


def test_route_that_arcs_cannot_follow(tmp_path):
    """Out of a dead end backwards: the lattice turns on the spot, the segments cannot."""
    path = write_map(tmp_path / "alley.json", room(30, 20, [(1, 1, 18, 8), (1, 12, 18, 7)]))
    result = plan(path, tmp_path / "out", *places("0.5,2.1,180", "5,2.1"), robot=BALANCER)
    assert result.returncode == 1
    assert "cannot be driven" in result.stderr
    summary = summary_of(tmp_path / "out")
    assert summary["routes"][0]["answer"] == "optimal"
    assert summary["drive"] is None
    assert names_in(tmp_path / "out") == FILES


def test_long_path_of_the_robot(level, tmp_path):
    folder = tmp_path / ("long" * 30)
    folder.mkdir()
    shutil.copy(BALANCER, folder / "robot.cfg")
    planned(level, tmp_path / "out", *TASK, robot=folder / "robot.cfg")
    assert str(folder / "robot.cfg") in (tmp_path / "out" / "scenario.cfg").read_text()
    assert run("jp-mission", tmp_path / "out" / "scenario.cfg", "--output", tmp_path / "again").returncode == 0


# ---- wrong input ---------------------------------------------------------------------------------------------------

@pytest.mark.parametrize(("options", "parts"), [
    (places("-5,4,0", "10,4"), ["--start", "outside"]),
    (places("2,4,0", "10,400"), ["--goal", "outside"]),
    (places("5.2,1,0", "10,4"), ["--start", "does not fit"]),
    (places("2,4,0", "5.2,1"), ["--goal", "does not fit"]),
    (["--memory=1"], ["--memory 1", "too little", "KiB"]),
])
def test_places_and_memory(level, tmp_path, options, parts):
    assert_one_line_error(plan(level, tmp_path / "out", *options), *parts)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("options", [
    ["--start=2,4,0"], ["--goal=2,4"], places("2,4", "10,4"), places("2", "10,4"), places("2,4,0,1", "10,4"),
    places("2,x,0", "10,4"), places("2,nan,0", "10,4"), places("2,4,0", "inf,4"), places("2,4,0", ""),
    places("2,4,0,", "10,4"), ["--cost=distance"], ["--cost="], ["--memory=0"], ["--memory=-1"], ["--memory=x"],
    ["--memory=1e3"], ["--memory=99999999999"], ["--nonsense"], ["second.json"]])
def test_wrong_command_lines(level, tmp_path, options):
    result = plan(level, tmp_path / "out", *options)
    assert result.returncode == 2
    assert result.stderr != ""
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("arguments", [[], ["map.json"], ["--robot", "a.cfg"]])
def test_what_is_needed(tmp_path, arguments):
    result = run("jp-plan", *arguments, cwd=tmp_path)
    assert result.returncode == 2
    assert "needed" in result.stderr


def test_map_of_another_resolution(tmp_path):
    path = write_map(tmp_path / "fine.json", room(), resolution=0.05)
    assert_one_line_error(plan(path, tmp_path / "out"), path, "0.05 m", "tools.design.import_map", "--resolution 0.2")


def test_map_and_robot_that_cannot_be_read(level, tmp_path):
    assert_one_line_error(plan(tmp_path / "none.json", tmp_path / "out"), "none.json")
    assert_one_line_error(plan(level, tmp_path / "out", robot=tmp_path / "none.cfg"), "none.cfg")
    level.write_text("{}")
    assert_one_line_error(plan(level, tmp_path / "out"), level)


def test_robot_with_a_lattice_of_finer_cells(level, tmp_path):
    courier = ROOT / "sim/robots/courier24.cfg"
    assert_one_line_error(plan(level, tmp_path / "out", robot=courier), "cells of 0.2 m", "courier24 has 0.1 m")
    fine = write_map(tmp_path / "fine.json", room(60, 40), resolution=0.1)
    assert plan(fine, tmp_path / "out", *places("1,1,0", "5,3"), robot=courier).returncode == 0


def test_map_without_room(tmp_path):
    path = write_map(tmp_path / "full.json", ["#" * 10] * 10)
    assert_one_line_error(plan(path, tmp_path / "out"), "full", "turn round", "--start")


def test_output_that_is_a_file(level, tmp_path):
    (tmp_path / "place").write_text("old")
    assert_one_line_error(plan(level, tmp_path / "place", *TASK), "place", "--output")
    assert (tmp_path / "place").read_text() == "old"


@pytest.mark.parametrize("name", DRIVE_FILES)
def test_disk_is_full_for_one_file(level, tmp_path, name):
    output = tmp_path / "out"
    output.mkdir()
    for file in DRIVE_FILES:
        (output / file).write_text("old")
    fill_disk(output / name)
    result = plan(level, output, *TASK, robot=BALANCER)
    assert_one_line_error(result, output / name, "No space left on device")
    assert names_in(output) == DRIVE_FILES
    assert all((output / file).read_text() == "old" for file in DRIVE_FILES if file != name)
