"""Drives in the simulator: those of the programs, bit by bit; arrays; what is wrong is said."""
import json
import os
import subprocess
import sys

import libconf
import numpy
import pytest
from conftest import BUILD, ROOT, SITE
from joulepath import METHODS, SCENES, Error, Scenario, door, drive, patrol, robots

SCENARIO = ROOT / "sim/scenarios/gao2018_short.cfg"


def test_a_mission_is_that_of_the_program(run):
    folder = run("jp-mission", SCENARIO, "--alone")
    summary, ours = json.loads((folder / "summary.json").read_text()), drive(Scenario(SCENARIO))
    theirs = summary["strategies"][0]
    assert ours.ticks == summary["simulation"]["ticks"]
    assert ours.joules == theirs["total"]["plant_energy_j"]
    assert ours.metered_joules == theirs["total"]["measured_energy_j"]
    assert ours.forecast_joules == theirs["forecast"]["energy_j"]
    for leg, other in zip(ours.legs, theirs["segments"], strict=True):
        assert leg["plant_joules"] == other["plant_energy_j"] and leg["passed_m"] == other["passed_m"]
    log = numpy.genfromtxt(folder / theirs["log"], delimiter=",", names=True)
    assert len(log) == len(ours.rows)
    for name in ("x_m", "y_m", "u_left_v", "i_right_a", "energy_j"):
        assert numpy.abs(log[name] - ours.rows[name]).max() <= 0.5001e-4


def test_a_patrol_is_that_of_the_program(run):
    theirs = json.loads((run("jp-patrol", "doorway", "--seed", 7) / "summary.json").read_text())["methods"][0]
    ours = patrol("doorway", 7)
    assert ours.outcome == theirs["outcome"]
    assert ours.joules == theirs["energy_j"] and ours.seconds == theirs["time_s"]
    assert ours.clearance_m == theirs["clearance_min_m"]


def test_a_scenario_of_waypoints_is_that_of_a_file():
    by_file = Scenario(SCENARIO)
    with SCENARIO.open() as file:
        keys = libconf.load(file)
    made = Scenario.of("gao2018", keys["waypoints"], name=keys["name"], end="segment", seed=keys["seed"])
    assert (made.name, made.robot_name, made.is_of_balancer) == (by_file.name, "gao2018", True)
    assert drive(made).joules == drive(by_file).joules


@pytest.fixture(scope="module")
def burger():
    return drive(Scenario.of("burger", [(0, 0), (0.6, 0), (0.6, 0.4)]))


def test_a_robot_that_its_sides_steer_drives_with_a_forecast(burger):
    assert burger.forecast_joules == pytest.approx(burger.joules, rel=0.05) and burger.forecast_deviation > 0
    assert numpy.linalg.norm(burger.xy_m[-1] - (0.6, 0.4)) < 0.02
    assert burger.legs["x_m"].tolist() == [0.6, 0.6] and "Mission" in repr(burger)


def test_rows_are_a_fiftieth_of_a_second_apart_and_outlive_the_mission(burger):
    assert numpy.allclose(numpy.diff(burger.rows["t_s"]), 0.02)
    rows = drive(Scenario.of("burger", [(0, 0), (0.3, 0)])).rows
    assert not rows.flags.owndata and rows["x_m"][-1] == pytest.approx(0.3, abs=0.02)


def test_a_seed_repeats_a_patrol():
    first, again, other = patrol("corridor", 3), patrol("corridor", 3), patrol("corridor", 4)
    assert first.joules == again.joules != other.joules
    assert first.rows["clearance_m"].min() == pytest.approx(first.clearance_m, abs=0.05)
    assert set(SCENES) >= {"corridor", "doorway"}


@pytest.mark.parametrize("make, says", [
    (lambda: Scenario("no/file.cfg"), "no/file.cfg"),
    (lambda: Scenario.of("burger", [(0, 0)]), "waypoints: must be a list of 2"),
    (lambda: Scenario.of("burger", [(0, 0), (1, 0)], energy="motor"), "is for balancers"),
    (lambda: Scenario.of("burger", [(1, 0), (2, 0)]), "odometry starts at"),
    (lambda: Scenario.of("patrol", [(0, 0), (1, 0)]), "four_wheel"),
    (lambda: drive(Scenario(SCENARIO), "fly"), "strategy: 'fly' is none of"),
    (lambda: patrol("forest"), "scene: 'forest' is none of"),
    (lambda: patrol("doorway", method="best"), "method: 'best' is none of"),
    (lambda: patrol("doorway", robot="burger"), "burger.cfg")])
def test_what_is_wrong_is_said(make, says):
    with pytest.raises(ValueError, match=says):
        make()


def test_errors_are_one_line():
    with pytest.raises(Error) as caught:
        Scenario.of("burger", [(0, 0), (1e6, 0)])
    assert len(str(caught.value).splitlines()) == 1


# ---- The command joulepath ----

def joulepath(*arguments, cwd):
    return subprocess.run([sys.executable, "-c", "from joulepath.door import main; raise SystemExit(main())", *arguments],
                          env={**os.environ, "PYTHONPATH": str(SITE)}, cwd=cwd, capture_output=True, text=True,
                          check=False, timeout=600)


def test_the_command_runs_the_programs_anywhere(tmp_path):
    result = joulepath("robot", "burger", "--json", "-", cwd=tmp_path)
    assert result.returncode == 0 and json.loads(result.stdout)["name"] == "burger"
    assert joulepath("--help", cwd=tmp_path).stdout.startswith("usage: joulepath NAME")


def test_the_command_has_every_program_but_the_gateway():
    built = {path.name.removeprefix("jp-") for path in (BUILD / "bin").glob("jp-*")}
    assert set(door.programs()) == built - {"lcm"}
    assert robots() and not set(door.programs()) & (set(door.TOOLS) | set(door.RECIPES))


def test_the_command_has_every_tool(tmp_path):
    """In one process: most of their time is for what they import."""
    modules = [f"joulepath.tools.{module}" for module in door.TOOLS.values()]
    subprocess.run([sys.executable, "-c", f"import importlib\nfor name in {modules}: assert importlib.import_module(name).main"],
                   env={**os.environ, "PYTHONPATH": str(SITE)}, cwd=tmp_path, check=True, timeout=600)
    assert joulepath("gains", "--help", cwd=tmp_path).stdout.startswith("usage:")


def test_a_drive_and_its_report_in_one_command(tmp_path):
    result = joulepath("sil", SCENARIO, "--alone", "--output", "out", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "out/report.html").exists() and (tmp_path / "out/summary.json").exists()
    assert "--output DIR is needed" in joulepath("sil", SCENARIO, cwd=tmp_path).stderr


def test_what_is_not_there_is_refused(tmp_path):
    result = joulepath("fly", cwd=tmp_path)
    assert result.returncode == 2 and "fly: no such program or tool" in result.stderr
