"""jp-navigate on a small map: arrives among boxes that the map does not show, says what is unreachable, wrong input."""
import csv
import json
import math

import pytest
from conftest import ROOT, assert_one_line_error, run
from test_plan import fill_disk, names_in, room, write_map

BALANCER = ROOT / "sim/robots/courier24.cfg"
ROVER = ROOT / "sim/robots/zhang2018.cfg"
CELL = 0.1
FILES = ["drive.csv", "summary.json"]
TASK = ["--start=1.5,1.5,0", "--goal=8.55,4.55"]


@pytest.fixture
def hall(tmp_path):
    return write_map(tmp_path / "hall.json", room(100, 60, [(45, 0, 2, 35)]), resolution=CELL)


def navigate(path, output, *options, robot=BALANCER):
    return run("jp-navigate", path, "--robot", robot, "--output", output, *options)


def summary_of(output):
    return json.loads((output / "summary.json").read_text())


def test_arrives_and_touches_nothing(hall, tmp_path):
    result = navigate(hall, tmp_path / "out", *TASK, "--hidden=4")
    assert (result.returncode, result.stderr) == (0, "")
    assert names_in(tmp_path / "out") == FILES
    summary = summary_of(tmp_path / "out")
    drive = summary["result"]
    assert (drive["state"], drive["touched"]) == ("arrived", False)
    assert drive["goal_error_m"] < 0.1
    assert drive["length_m"] > 7
    assert drive["clearance_m"] > 0
    assert drive["replans"] == len(summary["courses"]) - 1 or drive["replans"] >= len(summary["courses"])
    assert summary["seen"] and summary["hidden_boxes"] == 4
    assert f"{drive['energy_j']:.1f} J" in result.stdout

    with (tmp_path / "out" / "drive.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert rows[0]["state"] == "planning" and rows[-1]["state"] == "arrived"
    energies = [float(row["energy_j"]) for row in rows]
    assert energies == sorted(energies)
    assert float(rows[-1]["x_m"]) == pytest.approx(8.55, abs=0.1)
    assert float(rows[-1]["y_m"]) == pytest.approx(4.55, abs=0.1)


def drive_home(hall, folder, joules, *options):
    result = navigate(hall, folder, *TASK, "--hidden=0", f"--battery={joules}", *options)
    assert (result.returncode, result.stderr) == (0, "")
    home = summary_of(folder)["home"]
    assert (home["state"], home["stranded"]) == ("home", False)
    assert home["given_j"] < joules
    return home


def test_comes_home_from_its_goal_on_a_full_battery(hall, tmp_path):
    home = drive_home(hall, tmp_path / "out", 5000)
    assert not home["turned_back"]
    assert abs(home["given_j"] / home["trip_j"] - 1) < 0.4
    reach = home["reach_percent"]
    assert (len(reach), {len(row) for row in reach}) == (60, {100})
    assert reach[15][15] == reach[45][85] == 100 and reach[0][0] == -1


def test_turns_back_on_a_battery_that_does_not_last(hall, tmp_path):
    full = drive_home(hall, tmp_path / "full", 5000)
    home = drive_home(hall, tmp_path / "out", round(0.7 * full["given_j"]))
    assert home["turned_back"]
    assert home["given_j"] < 0.7 * full["given_j"]
    assert home["reach_percent"][45][85] < 50 < home["reach_percent"][15][15]


def test_a_battery_is_not_for_the_bus(hall, tmp_path):
    assert_one_line_error(navigate(hall, tmp_path / "out", *TASK, "--battery=500", "--bus=in-process"), "--battery")
    assert_one_line_error(navigate(hall, tmp_path / "out", *TASK, "--battery=0"), "--battery")
    assert_one_line_error(navigate(hall, tmp_path / "out", *TASK, "--battery=500", "--home=40"), "--home")


def burger_hall(folder):
    return write_map(folder / "burger.json", room(100, 60, [(45, 0, 2, 35)]), resolution=0.05)


def rover_hall(folder):
    return write_map(folder / "rover.json", room(80, 40), resolution=0.2)


def balancer_hall(folder):
    return write_map(folder / "balancer.json", room(100, 60, [(45, 0, 2, 35)]), resolution=CELL)


# Hall, task, and cells in series and parallel, of 2.8 Ah and up to 4.2 V.
FED = {"burger": (burger_hall, ["--start=0.75,0.75,0", "--goal=4.25,2.25"], 3, 1),
       "zhang2018": (rover_hall, ["--start=2.1,2.1,0", "--goal=12.1,5.1"], 13, 18),
       "courier24": (balancer_hall, TASK, 6, 1)}


def drive_on_cells(folder, robot, charge, *options):
    hall, task = FED[robot][:2]
    folder.mkdir(exist_ok=True)
    return navigate(hall(folder), folder / "out", *task, "--hidden=0", f"--charge={charge}", *options,
                    robot=ROOT / f"sim/robots/{robot}.cfg")


def assert_is_known(charge):
    assert abs(charge["known"] - charge["true"]) < 3 * charge["deviation"]
    assert abs(charge["left_known_j"] - charge["left_j"]) < 3 * charge["left_deviation_j"]


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("percent", [60, 25])
@pytest.mark.parametrize("robot", FED)
def test_comes_home_on_its_cells_and_knows_their_charge(tmp_path, robot, percent, seed):
    result = drive_on_cells(tmp_path, robot, percent, f"--seed={seed}")
    assert (result.returncode, result.stderr) == (0, "")
    summary = summary_of(tmp_path / "out")
    home, cells = summary["home"], summary["cells"]
    before, after = cells["before"], cells["after"]
    assert (home["state"], home["stranded"], home["turned_back"]) == ("home", False, False)
    assert 0 < after["left_j"] < before["left_j"]
    assert after["true"] < before["true"] < percent / 100
    # The voltage has told it more than the 5 % of the capacity that it began with.
    assert before["deviation"] < 0.02
    assert_is_known(before)
    assert_is_known(after)
    assert f"known as {100 * after['known']:.2f} ± {100 * after['deviation']:.2f} %" in result.stdout
    series, parallel = FED[robot][2:]
    coulombs = (before["true"] - after["true"]) * parallel * 2.8 * 3600
    assert coulombs * cells["least_bus_v"] < home["given_j"] < coulombs * series * 4.2


def test_does_not_leave_on_a_charge_that_may_not_do(tmp_path):
    result = drive_on_cells(tmp_path, "burger", 10.5)
    assert (result.returncode, result.stderr) == (0, "")
    summary = summary_of(tmp_path / "out")
    assert (summary["home"]["state"], summary["home"]["turned_back"]) == ("home", True)
    assert summary["result"]["length_m"] < 0.5
    assert_is_known(summary["cells"]["after"])


def test_cells_that_cannot_feed_it_are_refused(tmp_path):
    assert_one_line_error(drive_on_cells(tmp_path, "courier24", 0), "--charge 0", "16.17 V", "needs 18.00 V")
    assert_one_line_error(drive_on_cells(tmp_path, "burger", 0.2), "--charge 0.2", "charge the cells")
    assert names_in(tmp_path / "out") == []


def test_what_of_cells_is_refused(tmp_path):
    assert_one_line_error(drive_on_cells(tmp_path, "burger", 101), "--charge")
    assert_one_line_error(drive_on_cells(tmp_path, "burger", "full"), "--charge")
    assert_one_line_error(drive_on_cells(tmp_path, "burger", 50, "--battery=500"), "--charge", "--battery")
    assert_one_line_error(drive_on_cells(tmp_path, "burger", 50, "--bus=in-process", "--battery=9"), "--battery")


def test_motors_that_go_off_are_named(tmp_path):
    result = drive_on_cells(tmp_path, "burger", 0.7)
    text = result.stdout + result.stderr
    assert result.returncode != 0 and "motors" in text and "off" in text
    if result.returncode == 1:
        assert summary_of(tmp_path / "out")["home"]["reason"] == "motors off"


@pytest.mark.parametrize("robot, charge, turns_back", [("courier24", 60, False), ("burger", 60, False),
                                                       ("courier24", 10.5, True), ("burger", 10.5, True)])
def test_on_the_bus_the_ecu_knows_its_way_home(tmp_path, robot, charge, turns_back):
    result = drive_on_cells(tmp_path, robot, charge, "--bus=in-process")
    assert (result.returncode, result.stderr) == (0, "")
    summary = summary_of(tmp_path / "out")
    told = summary["bus"]["home"]
    assert told["turned_back"] == turns_back and told["state"] == ("too little" if turns_back else "suffices")
    assert 0 < told["probability"] < 1 and (told["probability"] > 0.999) != turns_back
    assert (summary["result"]["length_m"] < 0.5) == turns_back
    assert turns_back or 0 < told["way_deviation_j"] < told["way_j"] < told["left_deviation_j"] < told["left_j"]
    header, *lines = (tmp_path / "out" / "drive.csv").read_text().splitlines()
    shown = [float(line.split(",")[-1]) for line in lines]
    assert header.endswith(",home_percent") and max(shown) > 40 and all(-1 <= percent <= 100 for percent in shown)


def over_hills(path, height, cliff=0.0):
    """Waves of 6 m, and a step across the whole map."""
    elevation = [[round(height * math.sin(x * 0.2 * math.pi / 3) + (cliff if x > 40 else 0), 3) for x in range(80)]
                 for _ in range(40)]
    return write_map(path, room(80, 40), elevation=elevation, resolution=0.2)


def test_a_rover_over_hills_takes_what_it_forecast(tmp_path):
    ground = over_hills(tmp_path / "waves.json", 0.15)
    result = navigate(ground, tmp_path / "out", "--start=2,4,0", "--goal=14,4", "--hidden=0", robot=ROVER)
    assert (result.returncode, result.stderr) == (0, "")
    summary = summary_of(tmp_path / "out")
    drive = summary["result"]
    assert (drive["state"], drive["touched"], summary["steep_cells"]) == ("arrived", False, 0)
    assert drive["goal_error_m"] < 0.1 + 4 * drive["deviation_m"]
    assert drive["energy_j"] == pytest.approx(drive["forecast_j"], rel=0.05)
    assert drive["planned_j"] == pytest.approx(drive["forecast_j"], rel=0.2)
    level = over_hills(tmp_path / "level.json", 0)
    navigate(level, tmp_path / "level", "--start=2,4,0", "--goal=14,4", "--hidden=0", robot=ROVER)
    assert summary_of(tmp_path / "level")["result"]["forecast_j"] < 0.8 * drive["forecast_j"]


def test_what_is_too_steep_for_it_a_rover_refuses(tmp_path):
    ground = over_hills(tmp_path / "cliff.json", 0.1, cliff=0.5)
    result = navigate(ground, tmp_path / "out", "--start=2,4,0", "--goal=14,4", "--hidden=0", robot=ROVER)
    summary = summary_of(tmp_path / "out")
    assert (result.returncode, summary["result"]["state"]) == (1, "unreachable")
    assert summary["steep_cells"] == 2 * 40 - 4
    assert "cells too steep" in result.stdout


def test_over_the_bus_it_arrives_too(hall, tmp_path):
    for name in ("a", "b"):
        result = navigate(hall, tmp_path / name, *TASK, "--hidden=4", "--bus=in-process", "--frames")
        assert (result.returncode, result.stderr) == (0, "")
    assert names_in(tmp_path / "a") == ["drive.csv", "frames.log", "summary.json"]
    summary = summary_of(tmp_path / "a")
    assert (summary["result"]["state"], summary["result"]["touched"]) == ("arrived", False)
    assert summary["result"]["goal_error_m"] < 0.1 and summary["seen"]
    assert summary["bus"]["map_bytes"] > 20 and summary["bus"]["commands_late"] == 0
    assert len(summary["courses"]) > summary["result"]["replans"] > 0
    for name in ("drive.csv", "frames.log"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    assert summary["bus"]["fingerprint"] == summary_of(tmp_path / "b")["bus"]["fingerprint"]
    assert summary["bus"]["fingerprint"] in result.stdout


def test_a_robot_that_its_sides_steer_arrives_over_the_bus(tmp_path):
    hall = write_map(tmp_path / "hall.json", room(100, 80, [(48, 36, 4, 44)]), resolution=0.05)
    result = navigate(hall, tmp_path / "out", "--start=1,1,90", "--goal=4,3", "--hidden=2", "--view=1", "--seed=3",
                      "--bus=in-process", robot=ROOT / "sim/robots/burger.cfg")
    assert (result.returncode, result.stderr) == (0, "")
    drive = summary_of(tmp_path / "out")["result"]
    assert (drive["state"], drive["touched"]) == ("arrived", False)
    assert drive["goal_error_m"] < 0.1


def test_over_the_bus_a_rover_is_as_far_from_the_goal_as_its_odometry_says(tmp_path):
    hall = write_map(tmp_path / "hall.json", room(100, 80, [(48, 36, 4, 44)]), resolution=0.2)
    task = ["--start=4,4,90", "--goal=16,12", "--hidden=2", "--view=4", "--seed=3"]
    alone = navigate(hall, tmp_path / "alone", *task, robot=ROVER)
    over_the_bus = navigate(hall, tmp_path / "bus", *task, "--bus=in-process", robot=ROVER)
    assert alone.returncode == over_the_bus.returncode == 0, over_the_bus.stderr
    drive = summary_of(tmp_path / "bus")["result"]
    assert (drive["state"], drive["touched"]) == ("arrived", False) and drive["cells_seen"] > 0
    assert drive["goal_error_m"] < 0.1 + 4 * summary_of(tmp_path / "alone")["result"]["deviation_m"]


def test_over_the_bus_it_says_what_is_refused_or_unreachable(tmp_path):
    closed = write_map(tmp_path / "closed.json", room(100, 60, [(45, 0, 2, 60)]), resolution=CELL)
    result = navigate(closed, tmp_path / "out", *TASK, "--hidden=0", "--bus=in-process")
    assert result.returncode == 1 and "unreachable" in result.stdout
    large = write_map(tmp_path / "large.json", room(260, 250), resolution=CELL)
    assert_one_line_error(navigate(large, tmp_path / "none", *TASK, "--hidden=0", "--bus=in-process"), "refuses the map")
    assert not (tmp_path / "none").exists() or names_in(tmp_path / "none") == []


def test_repeats_bit_for_bit_and_follows_the_seed(hall, tmp_path):
    for name, seed in (("a", 3), ("b", 3), ("c", 4)):
        navigate(hall, tmp_path / name, *TASK, f"--seed={seed}")
    first, second, third = ((tmp_path / name / "drive.csv").read_bytes() for name in "abc")
    assert first == second != third


def test_turns_to_the_heading_of_the_goal(hall, tmp_path):
    assert navigate(hall, tmp_path / "out", "--start=1.5,1.5,0", "--goal=3,1.5,180", "--hidden=0").returncode == 0
    with (tmp_path / "out" / "drive.csv").open() as file:
        last = list(csv.DictReader(file))[-1]
    assert float(last["heading_deg"]) % 360 == pytest.approx(180, abs=3)


def test_chooses_places(hall, tmp_path):
    assert navigate(hall, tmp_path / "out").returncode == 0


def test_says_that_the_goal_cannot_be_reached(tmp_path):
    closed = write_map(tmp_path / "closed.json", room(100, 60, [(45, 0, 2, 60)]), resolution=CELL)
    result = navigate(closed, tmp_path / "out", *TASK, "--hidden=0")
    assert result.returncode == 1
    assert "unreachable" in result.stdout
    drive = summary_of(tmp_path / "out")["result"]
    assert (drive["state"], drive["length_m"] < 0.1) == ("unreachable", True)


@pytest.mark.parametrize(("options", "parts"), [
    (["--start=1.5,1.5,0"], ["both --start and --goal"]), (["--start=1.5,1.5", "--goal=8,4"], ["--start", "X,Y,DEGREES"]),
    (["--start=99,1,0", "--goal=8,4"], ["--start", "outside the map"]), ([*TASK[:1], "--goal=4.55,1"], ["--goal"]),
    (["--start=4.55,1,0", "--goal=8,4"], ["--start"]), ([*TASK, "--view=0"], ["--view"]),
    ([*TASK, "--memory=1"], ["--memory 1", "at least"]), ([*TASK, "--hidden=-1"], ["--hidden"]),
    ([*TASK, "--frames"], ["--frames", "--bus"]), ([*TASK, "--bus=slcan:/dev/none"], ["/dev/none"]),
    ([*TASK, "--bus=in-process", "--patience=0"], ["--patience"])])
def test_wrong_options_give_one_line(hall, tmp_path, options, parts):
    assert_one_line_error(navigate(hall, tmp_path / "out", *options), *parts)
    assert not (tmp_path / "out").exists() or names_in(tmp_path / "out") == []


def test_robots_and_maps_that_do_not_fit(hall, tmp_path):
    coarse = write_map(tmp_path / "coarse.json", room(60, 40), resolution=0.2)
    assert_one_line_error(navigate(coarse, tmp_path / "out", *TASK), "cells of 0.2 m", "--resolution 0.1")
    gao = ROOT / "sim/robots/gao2018.cfg"
    assert_one_line_error(navigate(hall, tmp_path / "out", *TASK, robot=gao), "gao2018", "navigation")
    assert_one_line_error(navigate(hall, tmp_path / "out", *TASK, robot=ROVER), "cells of 0.1 m", "--resolution 0.2")


def test_a_full_disk_leaves_nothing(hall, tmp_path):
    (tmp_path / "out").mkdir()
    fill_disk(tmp_path / "out" / "drive.csv")
    assert_one_line_error(navigate(hall, tmp_path / "out", *TASK), "drive.csv")
    assert names_in(tmp_path / "out") == ["drive.csv"]
