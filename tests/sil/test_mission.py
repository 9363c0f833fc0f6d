"""The paper's mission, driven in closed loop by jp-mission, for either energy."""
import json
import re
import subprocess
import sys

import pytest
from conftest import ROOT, run

SCENARIOS = ROOT / "sim/scenarios"
SCENARIO = SCENARIOS / "gao2018_mission.cfg"


def drive(output, scenario=SCENARIO):
    result = run("jp-mission", scenario, "--output", output)
    assert result.returncode == 0, result.stderr
    assert result.stderr == ""
    return output


@pytest.fixture(scope="module")
def output(tmp_path_factory):
    return drive(tmp_path_factory.mktemp("mission"))


@pytest.fixture(scope="module")
def summary(output):
    return json.loads((output / "summary.json").read_text())


@pytest.fixture(scope="module")
def strategies(summary):
    return {strategy["name"]: strategy for strategy in summary["strategies"]}


def test_planned_energy_is_what_is_driven(strategies):
    for segment in strategies["optimal"]["segments"]:
        assert segment["planned_energy_j"] == pytest.approx(segment["measured_energy_j"], rel=0.01), segment["index"]


def test_meter_of_the_robot_agrees_with_the_plant(strategies):
    for strategy in strategies.values():
        for segment in strategy["segments"]:
            assert segment["measured_energy_j"] == pytest.approx(segment["plant_energy_j"], rel=1e-3)


def test_energy_driven_is_that_of_the_paper(strategies):
    assert strategies["optimal"]["total"]["measured_energy_j"] == pytest.approx(1115.71, rel=0.01)


def test_optimum_takes_less_than_straight_chords_and_these_less_than_curves(strategies):
    energy = {name: strategy["total"]["measured_energy_j"] for name, strategy in strategies.items()}
    assert energy["optimal"] < energy["straight"] < energy["bezier"]


def test_sums_and_targets(summary, strategies):
    for strategy in strategies.values():
        segments, total = strategy["segments"], strategy["total"]
        assert [segment["target_m"] for segment in segments] == summary["waypoints_m"][1:]
        assert max(segment["end_error_m"] for segment in segments) < 0.2
        for key in ("measured_energy_j", "plant_energy_j", "battery_energy_j", "duration_s"):
            assert total[key] == pytest.approx(sum(segment[key] for segment in segments))
        assert strategy["saturated_ticks"] == 0


def test_log_ends_where_the_summary_does(output, strategies):
    for strategy in strategies.values():
        rows = (output / strategy["log"]).read_text().splitlines()
        header, last = rows[0].split(","), [float(cell) for cell in rows[-1].split(",")]
        log = dict(zip(header, last))
        assert log["t_s"] == pytest.approx(strategy["total"]["duration_s"], abs=0.03)
        assert log["energy_j"] == pytest.approx(strategy["total"]["measured_energy_j"], abs=1)


def without_wall_time(path):
    return re.sub(r'"(wall_s|real_time_factor)": [^,\n]+', r'"\1": 0', path.read_text())


def test_same_bytes_again(output, tmp_path):
    again = drive(tmp_path / "again")
    names = sorted(path.name for path in output.glob("*.csv"))
    assert len(names) >= 3
    assert sorted(path.name for path in again.glob("*.csv")) == names
    for name in names:
        assert (again / name).read_bytes() == (output / name).read_bytes(), name
    text = without_wall_time(output / "summary.json")
    assert without_wall_time(again / "summary.json") == text
    assert text.count(": 0") >= 2


def test_report_stands_alone(output):
    result = subprocess.run([sys.executable, ROOT / "tools/report.py", output], capture_output=True, text=True,
                            check=False)
    assert result.returncode == 0, result.stderr
    page = (output / "report.html").read_text()
    loaded = re.findall(r'(?:src|href)\s*=\s*"([^"]*)"', page) + re.findall(r"url\(([^)]*)\)", page)
    assert loaded
    assert all(address.startswith(("data:", "#")) for address in loaded)
    assert "<script" not in page
    assert "@import" not in page


# ---- energy of the battery -----------------------------------------------------------------------------------------

@pytest.fixture(scope="module")
def courier(tmp_path_factory):
    """{energy: its summary} of the courier's mission, and where the battery's logs are."""
    folders = {energy: drive(tmp_path_factory.mktemp(energy), SCENARIOS / f"courier24_{name}.cfg")
               for energy, name in (("motor", "mission"), ("battery", "battery"))}
    return {energy: json.loads((folder / "summary.json").read_text()) for energy, folder in folders.items()}, folders


def test_summary_names_the_energy(summary, courier):
    assert summary["energy"] == "motor"
    assert [courier[0][energy]["energy"] for energy in ("motor", "battery")] == ["motor", "battery"]


def test_battery_energy_is_planned_and_measured_alike(courier):
    for strategy in courier[0]["battery"]["strategies"]:
        for segment in strategy["segments"]:
            assert segment["measured_energy_j"] == segment["battery_energy_j"]
            # What the plant's exact currents say of the noisy ones that the robot measured.
            assert segment["measured_energy_j"] == pytest.approx(segment["plant_energy_j"], rel=2e-3)
            if segment["planned_energy_j"] is not None:
                assert segment["planned_energy_j"] == pytest.approx(segment["measured_energy_j"], rel=0.01)


def test_optimising_for_the_battery_saves_its_energy(courier):
    motor, battery = (courier[0][energy]["strategies"][0]["total"]["battery_energy_j"] for energy in ("motor", "battery"))
    assert battery < 0.75 * motor


def test_log_of_the_battery_holds_its_power_and_energy(courier):
    summaries, folders = courier
    strategy = summaries["battery"]["strategies"][0]
    lines = (folders["battery"] / strategy["log"]).read_text().splitlines()
    rows = [dict(zip(lines[0].split(","), map(float, line.split(",")))) for line in lines[1:]]
    assert rows[-1]["energy_j"] == pytest.approx(strategy["total"]["measured_energy_j"], abs=1)
    for row in rows[1:]:
        drawn = row["u_left_v"] * row["i_left_a"] + row["u_right_v"] * row["i_right_a"] + 4
        assert row["power_w"] == pytest.approx(drawn, abs=0.01)
