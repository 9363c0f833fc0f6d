"""jp-skid: constant duties, and where the energy went; jp-skid-identify: what its drives take."""
import csv
import json
import math

import pytest
from conftest import ROOT, assert_one_line_error, run

LOST = ("supply_j", "electronics_j", "bridge_j", "copper_j", "gear_j", "slip_along_j", "slip_across_j", "rolling_j",
        "caster_j", "impact_j", "kinetic_j", "potential_j")


def skid(robot, *options):
    result = run("jp-skid", ROOT / "sim/robots" / f"{robot}.cfg", "--json=-", *options)
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


@pytest.mark.parametrize("robot", ["zhang2018", "burger"])
@pytest.mark.parametrize("duties", [(0.8, 0.8), (0.3, -0.3), (-0.2, -0.4), (0, 0)])
@pytest.mark.parametrize("slope", [0, 5])
def test_energy_is_where_the_table_says(robot, duties, slope):
    figures = skid(robot, f"--left={duties[0]}", f"--right={duties[1]}", f"--slope={slope}", "--heading=30")
    assert sum(figures[key] for key in LOST) == pytest.approx(figures["battery_j"], rel=1e-3)
    assert abs(figures["residual_j"]) < 1e-3 * figures["battery_j"]
    assert figures["tipped"] == 0


def test_options_mean_what_they_say():
    straight = skid("zhang2018", "--left=0.5", "--right=0.5", "--seconds=4", "--heading=90")
    assert straight["x_m"] == pytest.approx(0, abs=1e-9) and straight["y_m"] > 1.5
    longer = skid("zhang2018", "--left=0.5", "--right=0.5", "--seconds=8", "--heading=90")
    assert longer["y_m"] - straight["y_m"] == pytest.approx(4 * straight["speed_m_s"], rel=1e-3)
    left = skid("zhang2018", "--left=-0.3", "--right=0.3")
    assert left["turn_rate_rad_s"] > 0.1 and left["heading_deg"] > 0
    uphill = skid("zhang2018", "--left=0.5", "--right=0.5", "--seconds=4", "--slope=10")
    assert uphill["potential_j"] == pytest.approx(92 * 9.80665 * math.tan(math.radians(10)) * uphill["x_m"], rel=1e-6)
    assert uphill["battery_j"] > straight["battery_j"]


def test_what_is_wrong_is_said_in_a_line():
    assert_one_line_error(run("jp-skid", ROOT / "sim/robots/patrol.cfg"), "patrol.cfg", "four_wheel robot",
                          "skid_steer or a differential_drive")
    assert_one_line_error(run("jp-skid", ROOT / "sim/robots/courier24.cfg"), "courier24.cfg", "balancer robot")
    for option, text in (("--left", "1.1"), ("--right", "x"), ("--seconds", "0"), ("--slope", "61"), ("--heading", "200")):
        assert_one_line_error(run("jp-skid", ROOT / "sim/robots/burger.cfg", f"{option}={text}"), "jp-skid", option)


# ---- jp-skid-identify ------------------------------------------------------------------------------------------------

def identify(robot, directory, *options):
    result = run("jp-skid-identify", ROOT / "sim/robots" / f"{robot}.cfg", "--output", directory, "--count=2", "--robots=1",
                 *options)
    assert result.returncode == 0, result.stderr
    return json.loads((directory / "experiments.json").read_text())


def rows(path):
    with path.open(newline="") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def test_drives_are_chains_of_pieces(tmp_path):
    about = identify("burger", tmp_path)
    experiments, robots = rows(tmp_path / "experiments.csv"), rows(tmp_path / "robots.csv")
    assert about["robot"] == "burger" and {row["run"] for row in experiments} == set(range(int(about["design"]) + 2))
    legs = [{row["phase"] % 100 for row in robots if row["phase"] // 100 == route} for route in range(3)]
    assert all(numbers == set(range(len(numbers))) and len(numbers) >= 10 for numbers in legs)
    assert max(row["phase"] for row in robots) < 300
    for before, after in zip(robots, robots[1:]):
        assert (before["v1_m_s"], before["w1_rad_s"]) == (after["v0_m_s"], after["w0_rad_s"])
    for row in experiments + robots:
        assert abs(row["v0_m_s"]) <= 0.18 and math.hypot(row["grade"], row["bank"]) <= math.tan(math.radians(10)) + 1e-9
        assert row["seconds"] == 0.2 and row["energy_j"] > 0.5 * 7.5 * 0.2 * 0.8


def test_a_seed_repeats_its_drives(tmp_path):
    for name, seed in (("first", 5), ("again", 5), ("other", 6)):
        identify("burger", tmp_path / name, f"--seed={seed}")
    first, again, other = ((tmp_path / name / "robots.csv").read_bytes() for name in ("first", "again", "other"))
    assert first == again != other


def test_what_the_identification_refuses(tmp_path):
    assert_one_line_error(run("jp-skid-identify", ROOT / "sim/robots/patrol.cfg", "--output", tmp_path), "four_wheel robot")
    for option in ("--count=0", "--robots=0", "--robots=x"):
        assert_one_line_error(run("jp-skid-identify", ROOT / "sim/robots/burger.cfg", option), option.partition("=")[0])
