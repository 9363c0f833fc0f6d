"""A short drive in MuJoCo with the controller's program on the bus: over a step on hard tyres, with its page and film."""
import json
import subprocess
import sys

import pytest

from programs import ROOT, assert_one_line_error

SCENARIO = """name = "step";
robot = "{robot}";
energy_model = "identified";
seed = 1;
waypoints = ( [0.0, 0.0], [1.5, 0.0], [1.9, 0.7] );
"""
FORECAST = 15.0  # % of a segment's energy: the step takes some
LEDGER = 0.005  # of what left the cells


def run(module, *arguments):
    return subprocess.run([sys.executable, "-m", f"tools.{module}", *map(str, arguments)], cwd=ROOT, capture_output=True,
                          text=True, check=False, timeout=600)


def scenario(folder, robot="courier24"):
    path = folder / "step.cfg"
    path.write_text(SCENARIO.format(robot=ROOT / f"sim/robots/{robot}.cfg"))
    return path


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    folder = tmp_path_factory.mktemp("mujoco")
    result = run("mujoco.mission", scenario(folder), "--output", folder / "out", "--step", "0.8,5", "--hard-tyres", "0.1",
                 "--backlash", "0.3")
    assert (result.returncode, result.stderr) == (0, "")
    return folder / "out"


def test_the_impact_of_a_step_is_no_fault_and_the_forecast_holds(drive):
    """An IMU that jumps with the wheels was taken for one that fails, and the robot fell."""
    summary = json.loads((drive / "summary.json").read_text())
    segments = summary["strategies"][0]["segments"]
    assert len(segments) == 2
    assert all(abs(segment["error_percent"]) < FORECAST for segment in segments)
    assert summary["robot"] == "courier24" and "tyres sink in by 0.1 mm" in summary["world"]["conditions"]


def test_the_ledger_closes(drive):
    ledger = json.loads((drive / "summary.json").read_text())["world"]["ledger_j"]
    assert abs(ledger["open"]) < LEDGER * ledger["cells"]
    assert ledger["normal contact"] > 0  # what the step took


def test_the_robot_is_where_it_was_sent(drive):
    x, y = [[float(value) for value in line.split(",")[1:3]] for line in (drive / "world.csv").read_text().splitlines()[-1:]][0]
    assert abs(x - 1.9) < 0.5 and abs(y - 0.7) < 0.5  # it rolls on by up to 0.3 m


def test_the_page_has_the_film_and_the_ledger(drive):
    result = run("report.report", drive)
    assert (result.returncode, result.stderr) == (0, "")
    page = (drive / "report.html").read_text()
    assert "In MuJoCo" in page and "normal contact" in page and page.count("data:image/png") > 6


def test_who_falls_is_told(tmp_path):
    result = run("mujoco.mission", scenario(tmp_path), "--output", tmp_path / "out", "--step", "0.8,80")
    assert result.returncode == 1 and len(result.stderr.splitlines()) == 1, result.stderr


def test_a_robot_that_no_ecu_drives_is_refused(tmp_path):
    assert_one_line_error(run("mujoco.mission", scenario(tmp_path, "nxtway"), "--output", tmp_path / "out"), "nxtway")
