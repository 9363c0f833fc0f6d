"""Robots of which nothing but the data sheet is given: designed, leant, and driven over their scenario; robots of other kinds
that no table knows, from file to drive; programs that fail."""
import json
from pathlib import Path

import pytest
from conftest import ROOT

from tools.common import ToolError
from tools.design import balancer_design, four_wheel_design, robot_design, robot_json, robot_trials, skid_design
from tools.design.robot_findings import Finding, Made, Making

# Their files give no setting of the controller.
DATA_SHEETS = ("hoverbot", "nxtway")


@pytest.fixture(scope="module", params=DATA_SHEETS)
def making(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp(request.param)
    (folder / "tables").mkdir()
    made = Making(ROOT / f"sim/robots/{request.param}.cfg", folder)
    balancer_design.design_controller(made)
    return made


@pytest.mark.parametrize("name", DATA_SHEETS)
def test_their_files_give_data_sheets_alone(name):
    control = (ROOT / f"sim/robots/{name}.cfg").read_text().split("control: {")[1].split("}")[0]
    assert [line.split("=")[0].strip() for line in control.splitlines() if "=" in line] == ["rate_hz"]


def test_it_comes_back_from_a_lean_and_stands(making):
    found = balancer_design.try_balance(making)
    assert found["lean_deg"] >= 10
    assert found["standing_lean_rms_deg"] < 0.2 and found["standing_wander_m"] < 0.01


def test_it_drives_its_scenario_as_foretold(making):
    program, = robot_trials.build(making.folder, "jp-mission")
    scenario = ROOT / f"sim/scenarios/{making.robot_file.stem}_mission.cfg"
    robot_trials.called([program, scenario, "--alone", "--output", making.folder / "out"], "mission")
    row, = json.loads((making.folder / "out/summary.json").read_text())["strategies"]
    assert row["forecast"]["energy_j"] == pytest.approx(row["total"]["measured_energy_j"], rel=0.01)
    assert max(leg["passed_m"] for leg in row["segments"]) < 0.01


def test_a_random_route_is_that_of_its_seed(making):
    program, = robot_trials.build(making.folder, "jp-mission")
    drives = [robot_trials.drive(program, making.robot_file, making.folder, seed) for seed in (1, 1, 2)]
    assert drives[0] == drives[1] != drives[2]
    assert all(abs(drive.error) < 0.02 for drive in drives)


@pytest.mark.parametrize("command, reason", [
    (["/nowhere/at-all"], "trial: /nowhere/at-all: No such file or directory"),
    (["sh", "-c", "echo first >&2; echo the reason >&2; exit 2"], "trial: the reason"),
    (["sh", "-c", "exit 1"], "trial: no reason given"),
])
def test_a_program_that_fails_is_told_with_its_reason(command, reason):
    with pytest.raises(ToolError, match=f"^{reason}$"):
        robot_trials.called(command, "trial")


def finding(value, met):
    return Finding("lean", value, "°", "≥ 10", met, "stronger motors")


def made_of(findings):
    """A stand-in for all that takes minutes."""
    class Robot:
        name = "mine"

    trip = {"outcome": "done", "measured_j": 10.0, "predicted_j": 9.0, "std_j": 1.0, "inside": True}
    return lambda making: Made(Robot(), findings, "Drives.", [robot_trials.Drive(10.0, 10.1, 5.0)] * 3, trips=[trip],
                               pictures=[("Step", "What it shows.", making.folder / "step.png")])


@pytest.mark.parametrize("met", [True, False])
def test_tables_are_installed_only_when_the_robot_is_good(met, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("JP_BUILD", str(tmp_path))
    monkeypatch.setattr(robot_design, "make", made_of([finding(12.0, True), finding(9.0, met)]))
    monkeypatch.setattr("sys.argv", ["robot_design", str(tmp_path / "mine.cfg"), "--tables", str(tmp_path / "tables")])
    made = tmp_path / "robot/mine"
    (made / "tables").mkdir(parents=True)
    (made / "tables/robot_mine.c").write_text("a table")
    (made / "step.png").write_bytes(b"a picture")
    assert robot_design.main() == (0 if met else 1)
    said = capsys.readouterr().out
    page = Path(made / "report.html").read_text()
    assert ("yes; its tables are installed" in page) == met and "stronger motors" in page
    assert [row["is_met"] for row in json.loads((made / "robot.json").read_text())] == [True, met]
    if met:
        assert (tmp_path / "tables/robot_mine.c").read_text() == "a table" and "mine: good" in said
    else:
        assert not (tmp_path / "tables").exists()
        assert said.strip().endswith("mine: lean 9 °, must be ≥ 10: stronger motors")


# ---- Other kinds ----

def robot_file_of(kind, folder):
    """The file of a robot of its own name."""
    if kind == "amr":
        return Path(__file__).with_name("amr.cfg")
    text = (ROOT / "sim/robots/patrol.cfg").read_text()
    for number, other in {'name = "patrol"': 'name = "wheels"', "mass_kg = 45.0": "mass_kg = 64.5", "length_m = 0.80": "length_m = 0.738",
                          "inertia_kg_m2 = 3.75": "inertia_kg_m2 = 4.27", "width_m = 0.60": "width_m = 0.50"}.items():
        assert text.count(number) == 1
        text = text.replace(number, other)
    path = folder / "wheels.cfg"
    path.write_text(text)
    return path


def making_of(kind, folder):
    (folder / "tables").mkdir()
    return Making(robot_file_of(kind, folder), folder)


def identified_with(monkeypatch, options):
    """Identifies with fewer drives than a user would."""
    called = robot_trials.called
    monkeypatch.setattr(robot_trials, "called", lambda command, what, **more: called(
        [*command, *options] if what.endswith("-identify") else command, what, **more))


def test_a_robot_that_its_sides_steer_from_its_file_drives_as_foretold(tmp_path, monkeypatch):
    making = making_of("amr", tmp_path)
    skid_design.design_controller(making)
    identified_with(monkeypatch, ["--count=10", "--robots=22"])
    assert skid_design.identify(making)["random_percent"]["mean"] < 10
    program, = robot_trials.build(making.folder, "jp-mission")
    found = robot_trials.drive(program, making.robot_file, making.folder, 2001, "battery")
    assert abs(found.error) < 0.03 and found.end_miss < 0.02 * found.length
    trips = robot_trials.drive_trips(making.folder, making.robot_file, 2, 7001)
    assert [trip["outcome"] for trip in trips] == ["done"] * 2
    assert all(abs(trip["predicted_j"] / trip["measured_j"] - 1) < 0.05 for trip in trips)


def test_a_robot_with_four_steered_wheels_from_its_file_arrives(tmp_path):
    making = making_of("wheels", tmp_path)
    four_wheel_design.design_controller(making)
    assert four_wheel_design.identify(making)["random_percent"]["mean"] < 3
    program, = robot_trials.build(making.folder, "jp-patrol")
    found = robot_trials.drive_scene(program, making.robot_file, making.folder, "doorway", 2001)
    assert found.arrived and found.clearance > 0.01 and found.miss < 0.05


def test_each_kind_of_robot_has_its_design():
    for robot, design in (("courier24", balancer_design), ("burger", skid_design), ("zhang2018", skid_design),
                          ("patrol", four_wheel_design)):
        assert robot_design.KINDS[robot_json.load_any(robot_json.robot_path(robot)).type] is design
