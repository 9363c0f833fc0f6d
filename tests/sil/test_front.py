"""The front of a route by jp-front: foretold over the cruise, and driven."""
import json

import pytest
from conftest import assert_one_line_error, run
from programs import with_battery_energy, write_scenario


def write_route(folder, robot="gao2018"):
    return write_scenario(folder / "short.cfg", (3.0, 0.5), (4.0, 3.0), robot=robot)


def front_of(folder, scenario):
    result = run("jp-front", scenario, "--output", folder / "out")
    assert (result.returncode, result.stderr) == (0, "")
    return json.loads((folder / "out/front.json").read_text()), result.stdout


@pytest.fixture(scope="module", params=["gao2018", "courier24"])
def made(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp(request.param)
    return front_of(folder, write_route(folder, request.param))


@pytest.fixture(scope="module")
def front(made):
    return made[0]


def drives_of(front, request):
    return [drive for drive in front["drives"] if drive["request"] == request]


def test_energy_is_least_where_it_says(front):
    least, = drives_of(front, "least_energy")
    assert least["forecast"]["energy_j"] <= min(forecast["energy_j"] for forecast in front["forecasts"]) * 1.0001
    assert least["plant_energy_j"] == min(drive["plant_energy_j"] for drive in front["drives"])


def test_faster_takes_more(front):
    drives = sorted(front["drives"], key=lambda drive: drive["duration_s"])
    energies = [drive["plant_energy_j"] for drive in drives]
    assert energies == sorted(energies, reverse=True)
    times = [forecast["duration_s"] for forecast in front["forecasts"]]
    assert times == sorted(times, reverse=True)


def test_what_was_asked_is_kept(front):
    least, = drives_of(front, "least_energy")
    in_time, = drives_of(front, "within_seconds")
    in_energy, = drives_of(front, "within_joules")
    assert in_time["limit"] == pytest.approx(0.8 * least["forecast"]["duration_s"])
    assert in_energy["limit"] == pytest.approx(1.1 * least["forecast"]["energy_j"])
    assert in_energy["forecast"]["energy_j"] <= in_energy["limit"]
    for drive in [in_time, *drives_of(front, "share")]:
        assert 0.99 * drive["limit"] < drive["forecast"]["duration_s"] <= drive["limit"]


def test_drives_are_as_foretold(front):
    for drive in front["drives"]:
        assert drive["duration_s"] == pytest.approx(drive["forecast"]["duration_s"], abs=0.01)
        assert drive["plant_energy_j"] == pytest.approx(drive["forecast"]["energy_j"], rel=0.03)
        assert drive["passed_m"] < 0.1


def test_the_table_has_a_row_for_each_drive(made):
    front, text = made
    assert [line.split()[0] for line in text.splitlines()[2:]] == [drive["request"] for drive in front["drives"]]


def test_the_scenarios_budget_is_what_is_asked(tmp_path):
    scenario = with_battery_energy(write_route(tmp_path))
    scenario.write_text(scenario.read_text() + "within_seconds = 8.5;\n")
    front, _ = front_of(tmp_path, scenario)
    assert front["energy"] == "battery"
    assert drives_of(front, "within_seconds")[0]["limit"] == 8.5
    assert drives_of(front, "within_joules")


def test_a_budget_that_is_too_small_is_one_line(tmp_path):
    scenario = write_route(tmp_path)
    scenario.write_text(scenario.read_text() + "within_seconds = 1;\n")
    assert_one_line_error(run("jp-front", scenario, "--output", tmp_path / "out"), "within_seconds = 1", "needs")
    assert not (tmp_path / "out/front.json").exists()


def test_a_route_too_short_for_a_front_is_one_line(tmp_path):
    scenario = write_scenario(tmp_path / "short.cfg", (0.011, 0.0), (0.0, 0.02))
    assert_one_line_error(run("jp-front", scenario, "--output", tmp_path / "out"), "within_seconds", "the robot needs")
