"""The paper's mission, driven in closed loop by jp-mission, for either energy."""
import json
import re
import subprocess
import sys

import pytest
from conftest import ROOT, run
from programs import assert_one_line_error, write_scenario

SCENARIOS = ROOT / "sim/scenarios"
SCENARIO = SCENARIOS / "gao2018_mission.cfg"


FORECAST = 0.005  # how far the energy driven may be from what was said before the start


def drive(output, scenario=SCENARIO):
    result = run("jp-mission", scenario, "--output", output)
    assert result.returncode == 0, result.stderr
    assert result.stderr == ""
    return output


def by_name(folder):
    """{strategy: its part of the summary}."""
    return {strategy["name"]: strategy for strategy in json.loads((folder / "summary.json").read_text())["strategies"]}


@pytest.fixture(scope="module")
def output(tmp_path_factory):
    return drive(tmp_path_factory.mktemp("mission"))


@pytest.fixture(scope="module")
def summary(output):
    return json.loads((output / "summary.json").read_text())


@pytest.fixture(scope="module")
def strategies(output):
    return by_name(output)


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


@pytest.mark.parametrize("robot", ["gao2018", "courier24"])
def test_a_mission_that_ends_at_a_stand_counts_the_braking(tmp_path, robot):
    scenario = write_scenario(tmp_path / "short.cfg", (2.0, 0.5), (3.0, 2.0), robot=robot)
    before = by_name(drive(tmp_path / "moving", scenario))
    scenario.write_text(scenario.read_text() + 'end = "stand";\n')
    stood = drive(tmp_path / "stood", scenario)
    after = by_name(stood)
    for name, about in after.items():
        braking, total = about["braking"], about["total"]
        assert "braking" not in before[name]
        # Cruise plans its stand, and chords have its times; nothing else knows of the stand before it brakes.
        assert (before[name]["segments"] == about["segments"]) == (name not in ("cruise", "straight_cruise"))
        for key in ("measured_energy_j", "plant_energy_j", "battery_energy_j", "duration_s"):
            assert total[key] == pytest.approx(sum(segment[key] for segment in about["segments"]) + braking[key])
        assert braking["measured_energy_j"] == pytest.approx(braking["plant_energy_j"], rel=1e-2)
        rows = (stood / about["log"]).read_text().splitlines()
        last = dict(zip(rows[0].split(","), map(float, rows[-1].split(",")), strict=True))
        assert abs(last["speed_m_s"]) < 0.01 and last["energy_j"] == pytest.approx(total["measured_energy_j"], abs=1)
    # It is over when the last leg is.
    cruise = after["cruise"]
    assert cruise["braking"]["duration_s"] < 5 and cruise["braking"]["end_error_m"] < 0.01
    assert cruise["forecast"]["energy_j"] == \
        pytest.approx(sum(segment["measured_energy_j"] for segment in cruise["segments"]), rel=FORECAST)


def test_an_end_that_is_not_known_is_refused(tmp_path):
    scenario = write_scenario(tmp_path / "short.cfg", (2.0, 0.5))
    scenario.write_text(scenario.read_text() + 'end = "wall";\n')
    assert_one_line_error(run("jp-mission", scenario, "--output", tmp_path / "out"), "short.cfg", 'end = "wall"')


def cruise_within(folder, budget=""):
    """What the strategy of cruise and transients says of a short route within a budget."""
    scenario = write_scenario(folder / "short.cfg", (3.0, 0.5), (4.0, 3.0))
    scenario.write_text(scenario.read_text() + budget)
    strategies = json.loads((drive(folder / "out", scenario) / "summary.json").read_text())["strategies"]
    return {strategy["name"]: strategy for strategy in strategies}["cruise"]


def test_cruise_within_a_budget(tmp_path):
    free = cruise_within(tmp_path)
    seconds, joules = free["total"]["duration_s"], free["forecast"]["energy_j"]
    in_time = cruise_within(tmp_path, f"within_seconds = {0.8 * seconds};\n")
    assert 0.79 * seconds < in_time["total"]["duration_s"] <= 0.8 * seconds
    assert in_time["forecast"]["energy_j"] > joules
    assert in_time["total"]["plant_energy_j"] == pytest.approx(in_time["forecast"]["energy_j"], rel=2e-3)
    in_energy = cruise_within(tmp_path, f"within_joules = {1.1 * joules};\n")
    assert 1.09 * joules < in_energy["forecast"]["energy_j"] <= 1.1 * joules
    assert in_energy["total"]["duration_s"] < 0.9 * seconds


@pytest.mark.parametrize(("key", "unit"), [("within_seconds", "s"), ("within_joules", "J")])
def test_a_budget_that_is_too_small_says_what_is_needed(tmp_path, key, unit):
    """And with that it is enough."""
    scenario = write_scenario(tmp_path / "short.cfg", (3.0, 0.5), (4.0, 3.0))
    scenario.write_text(scenario.read_text() + f"{key} = 3;\n")
    result = run("jp-mission", scenario, "--output", tmp_path / "none")
    assert_one_line_error(result, "the robot needs")
    needed = re.search(rf"{key} = 3: the robot needs ([\d.]+) {unit}; raise it", result.stderr).group(1)
    assert "total" in cruise_within(tmp_path, f"{key} = {needed};\n")


def optimised(output, scenario):
    return run("jp-mission", scenario, "--optimised", "--output", output)


@pytest.mark.parametrize("scenario", ["gao2018_short", "courier24_short"])
def test_headings_and_speeds_for_the_whole_route(tmp_path, scenario):
    """Less energy than by the rule, and as near to the waypoints."""
    result = optimised(tmp_path, SCENARIOS / f"{scenario}.cfg")
    assert result.returncode == 0, result.stderr
    found, = by_name(tmp_path).values()
    assert run("jp-mission", SCENARIOS / f"{scenario}.cfg", "--alone", "--output", tmp_path / "rule").returncode == 0
    rule, = by_name(tmp_path / "rule").values()
    assert found["name"] == "optimised_cruise"
    assert found["total"]["plant_energy_j"] < 0.9995 * rule["total"]["plant_energy_j"]
    assert max(segment["passed_m"] for segment in found["segments"]) < 0.01
    assert found["total"]["plant_energy_j"] == pytest.approx(found["forecast"]["energy_j"], rel=FORECAST)


def test_short_legs_are_optimised_at_the_cruise_that_they_have_room_for(tmp_path):
    scenario = write_scenario(tmp_path / "short.cfg", (0.2, 0.1), (0.3, 0.3), (2.0, 0.5))
    assert optimised(tmp_path / "out", scenario).returncode == 0


@pytest.mark.parametrize(("waypoints", "budget", "reason"), [
    ("[2.0, 0.5], [2.0, 2.0]", "within_seconds = 9;\n", "leave within_seconds and within_joules out"),
    ("[1.0, 0.0, 90.0, 0.9], [1.03, 0.0, 270.0, 0.02], [1.06, 0.0, 90.0, 0.9]", "",
     "no headings and speeds are found for its waypoints (status -3)")])
def test_routes_that_are_not_optimised(tmp_path, waypoints, budget, reason):
    scenario = write_scenario(tmp_path / "route.cfg", (2.0, 0.5))
    scenario.write_text(scenario.read_text().replace("[2.0, 0.5]", waypoints) + budget)
    assert_one_line_error(optimised(tmp_path / "out", scenario), reason)


def test_a_budget_is_not_for_the_bus(tmp_path):
    scenario = write_scenario(tmp_path / "short.cfg", (2.0, 0.5))
    scenario.write_text(scenario.read_text() + "within_seconds = 9;\n")
    assert_one_line_error(run("jp-plant", scenario, "--bus", "in-process", "--output", tmp_path / "out"),
                          "short.cfg", "within_seconds")


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
    result = subprocess.run([sys.executable, "-m", "tools.report.report", output], cwd=ROOT, capture_output=True,
                            text=True, check=False)
    assert result.returncode == 0, result.stderr
    page = (output / "report.html").read_text()
    loaded = re.findall(r'(?:src|href)\s*=\s*"([^"]*)"', page) + re.findall(r"url\(([^)]*)\)", page)
    assert loaded
    assert all(address.startswith(("data:", "#")) for address in loaded)
    assert "<script" not in page
    assert "@import" not in page


# ---- cruise and transients, and short segments ----------------------------------------------------------------------

ROBOTS = ("gao2018", "courier24")
STRATEGIES = ["optimal", "straight", "bezier", "cruise", "straight_cruise", "bezier_route"]


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    """{robot: {strategy: its part of the summary}} of the scenarios with short segments."""
    return {robot: by_name(drive(tmp_path_factory.mktemp(robot), SCENARIOS / f"{robot}_short.cfg")) for robot in ROBOTS}


def energy(strategies, name):
    return strategies[name]["total"]["measured_energy_j"]


def test_every_strategy_is_driven_and_logged(output, strategies):
    assert list(strategies) == STRATEGIES
    assert {path.name for path in output.glob("log_*.csv")} == {f"log_{name}.csv" for name in STRATEGIES}


def assert_cruise_is_best(strategies):
    """It takes the least, passes its waypoints, and said before what it would take; nobody else says that."""
    cruise = strategies["cruise"]
    assert all(energy(strategies, "cruise") < energy(strategies, name) for name in strategies if name != "cruise")
    assert max(segment["passed_m"] for segment in cruise["segments"]) < 0.03
    assert cruise["forecast"]["energy_j"] == pytest.approx(energy(strategies, "cruise"), rel=FORECAST)
    assert abs(cruise["forecast"]["energy_j"] - energy(strategies, "cruise")) < 2 * cruise["forecast"]["deviation_j"]
    assert [name for name, strategy in strategies.items() if strategy["forecast"] is not None] == ["cruise"]


def test_cruise_on_the_mission(strategies):
    assert_cruise_is_best(strategies)
    assert energy(strategies, "cruise") < 0.97 * energy(strategies, "optimal")
    assert max(segment["passed_m"] for segment in strategies["cruise"]["segments"]) < 0.01
    assert strategies["cruise"]["forecast"]["energy_j"] == pytest.approx(energy(strategies, "cruise"), rel=1e-3)


@pytest.mark.parametrize("robot", ROBOTS)
def test_cruise_on_short_segments(short, robot):
    strategies = short[robot]
    assert_cruise_is_best(strategies)
    for name, more in (("straight_cruise", 1.05), ("bezier", 1.12), ("bezier_route", 1.07), ("optimal", 1.07)):
        assert energy(strategies, "cruise") < energy(strategies, name) / more, name


@pytest.mark.parametrize("robot", ROBOTS)
def test_short_segments_are_as_short_as_the_papers(short, robot):
    durations = [segment["duration_s"] for segment in short[robot]["cruise"]["segments"]]
    assert len(durations) == 7
    assert 2.2 < sum(durations) / 7 < 3.3


@pytest.mark.parametrize("robot", ROBOTS)
def test_chords_keep_the_times_of_what_they_are_compared_with(short, robot):
    for chords, like in (("straight", "optimal"), ("straight_cruise", "cruise")):
        for one, other in zip(short[robot][chords]["segments"], short[robot][like]["segments"], strict=True):
            assert one["duration_s"] == pytest.approx(other["duration_s"], abs=0.0011)


@pytest.mark.parametrize("robot", ROBOTS)
def test_short_segments_end_near_their_targets(short, robot):
    for name, most in (("optimal", 0.1), ("straight", 0.25), ("cruise", 0.05), ("straight_cruise", 0.3)):
        assert max(segment["end_error_m"] for segment in short[robot][name]["segments"]) < most, name


def test_chords_begin_where_a_lagging_turn_ends(short):
    """The courier's turns lag: chords from waypoint to waypoint would pass them by half a metre."""
    after_a_right_angle = short["courier24"]["straight_cruise"]["segments"][3]
    assert after_a_right_angle["end_error_m"] < 0.2


@pytest.mark.parametrize("robot", ROBOTS)
def test_there_and_back(tmp_path, robot):
    """A Bézier curve from one leg to the next is too sharp: a row that says so, and the report says it too."""
    output = drive(tmp_path / "out", write_scenario(tmp_path / "back.cfg", (3.0, 0.0), (0.0, 0.0), robot=robot))
    strategies = by_name(output)
    assert list(strategies) == STRATEGIES
    assert [name for name, about in strategies.items() if "impossible" in about] == ["bezier", "bezier_route"]
    assert strategies["bezier"]["impossible"].startswith("leg 2: ")
    for name, most in (("optimal", 0.5), ("straight", 0.5), ("cruise", 0.05), ("straight_cruise", 0.7)):
        assert max(segment["end_error_m"] for segment in strategies[name]["segments"]) < most, name
    rows = run("jp-mission", tmp_path / "back.cfg", "--output", tmp_path / "again").stdout.splitlines()
    assert re.fullmatch(r"bezier +- +- +-  cannot drive this route", next(row for row in rows if row.startswith("bezier ")))
    subprocess.run([sys.executable, "-m", "tools.report.report", output], check=True, cwd=ROOT, stdout=subprocess.DEVNULL)
    assert "cannot drive this route: leg 2" in (output / "report.html").read_text()


def test_the_published_model(tmp_path):
    """Nothing is learned: a forecast without a deviation."""
    text = SCENARIO.read_text().replace("identified", "published").replace("../robots", str(ROOT / "sim/robots"))
    scenario = tmp_path / "published.cfg"
    scenario.write_text(text)
    strategies = by_name(drive(tmp_path / "out", scenario))
    # What the paper's own segments take by it, and what they took when driven.
    assert strategies["optimal"]["total"]["planned_energy_j"] == pytest.approx(1115.13, abs=0.2)
    assert energy(strategies, "optimal") == pytest.approx(1115.71, rel=0.005)
    forecast = strategies["cruise"]["forecast"]
    assert forecast["energy_j"] == pytest.approx(energy(strategies, "cruise"), rel=1e-3) and forecast["deviation_j"] == 0


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
    strategies = courier[0]["battery"]["strategies"]
    # Cruise is at the limit of speed; chords begin beside their waypoints and are too long for its times.
    assert [strategy["name"] for strategy in strategies if "impossible" in strategy] == ["straight_cruise"]
    for strategy in strategies:
        for segment in strategy.get("segments", []):
            assert segment["measured_energy_j"] == segment["battery_energy_j"]
            # What the plant's exact currents say of the noisy ones that the robot measured.
            assert segment["measured_energy_j"] == pytest.approx(segment["plant_energy_j"], rel=2e-3)
            if segment["planned_energy_j"] is not None:
                assert segment["planned_energy_j"] == pytest.approx(segment["measured_energy_j"], rel=0.01)
    (cruise,) = (strategy for strategy in strategies if strategy["name"] == "cruise")
    assert cruise["forecast"]["energy_j"] == pytest.approx(cruise["total"]["measured_energy_j"], rel=FORECAST)


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
