"""jp-patrol --round: hours of patrol by itself, and over a bus by the firmware's application; wrong input."""
import csv
import json

import pytest
from conftest import assert_one_line_error, run
from programs import BIN, LIMIT, ROOT, Programs, wait_until

CELL = 0.05
ROUND = {"charger": "[1.0, 1.0, 0.0]", "stops": "( [5.5, 1.5, 90.0, 4.0], [4.5, 3.5, 180.0, 2.0] )",
         "battery": "{ full_j = 5000.0; reserve_j = 100.0; charger_w = 400.0; }", "deviations": "1.645"}
FILES = ["log_round.csv", "summary.json"]
OUTCOMES = {"arrived", "turned home", "left out", "no way", "cut short"}


def write_map(path, origin=(0.0, 0.0, 0.0), width=140, height=100):
    def is_wall(x, y):
        return x in (0, width - 1) or y in (0, height - 1) or (x == 60 and y < 40)

    rows = [["#" if is_wall(x, y) else "." for x in range(width)] for y in reversed(range(height))]
    path.write_text(json.dumps({"format": "joulepath-map-1", "name": path.stem, "width": width, "height": height,
                                "resolution_m": CELL, "origin_m": list(origin),
                                "rows": ["".join(row) for row in rows]}))
    return path


def write_round(path, **changes):
    path.write_text("".join(f"{key} = {value};\n" for key, value in {**ROUND, **changes}.items() if value is not None))
    return path


def patrol(folder, *options, changes=None, **more):
    world, rounds = write_map(folder / "room.json"), write_round(folder / "round.cfg", **(changes or {}))
    return run("jp-patrol", f"--map={world}", f"--round={rounds}", "--output", folder / "out", *options, **more)


def driven(folder, *options, status=0, changes=None):
    result = patrol(folder, *options, changes=changes)
    assert (result.returncode, result.stderr) == (status, ""), result.stdout
    return json.loads((folder / "out/summary.json").read_text()), result.stdout


def log_of(folder):
    with (folder / "out/log_round.csv").open() as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


@pytest.fixture(name="both", scope="module")
def fixture_both(tmp_path_factory):
    folders = [tmp_path_factory.mktemp(name) for name in ("alone", "bus")]
    return [(folder, *driven(folder, "--hours=0.1", *options))
            for folder, options in zip(folders, ((), ("--bus", "in-process")))]


def test_it_goes_round_and_is_home_while_the_energy_lasts(both):
    for _, summary, _ in both:
        assert (summary["kind"], summary["outcome"], summary["reason"]) == ("round", "went on", "")
        assert summary["visits"] >= 8 and summary["charges"] >= 2 and summary["skipped"] == 0
        battery = summary["battery"]
        assert battery["below_reserve"] == 0 and battery["least_left_j"] >= battery["reserve_j"] == 100
        assert abs(summary["time_s"] - 360) < 0.1 and summary["commands_late"] == 0


def test_the_journeys_join_and_their_sums_are_the_rounds(both):
    for _, summary, _ in both:
        journeys = summary["journeys"]
        assert journeys[0]["from"] == len(summary["stops"]) == 2
        for before, after in zip(journeys, journeys[1:]):
            assert after["from"] == before["to"] or before["outcome"] != "arrived"
            assert after["start_s"] >= before["start_s"] + before["time_s"] - 0.01
        arrived = [journey for journey in journeys if journey["outcome"] == "arrived"]
        assert sum(journey["to"] < 2 for journey in arrived) == summary["visits"]
        assert sum(journey["to"] == 2 for journey in arrived) == summary["charges"]
        assert {journey["outcome"] for journey in journeys} <= OUTCOMES
        assert sum(journey["length_m"] for journey in journeys) == pytest.approx(summary["length_m"], abs=2)


def test_what_is_foretold_is_about_what_is_taken(both):
    for _, summary, _ in both:
        arrived = [journey for journey in summary["journeys"] if journey["outcome"] == "arrived"]
        assert all(journey["foretold_j"] > 0 and journey["deviation_j"] > 0 for journey in arrived)
        foretold, taken = (sum(journey[key] for journey in arrived) for key in ("foretold_j", "taken_j"))
        assert foretold == pytest.approx(taken, rel=0.2)


def test_the_robot_counts_what_its_battery_holds(both):
    for folder, summary, _ in both:
        assert summary["battery"]["account_error_j"] < 30
        log = log_of(folder)
        assert all(0 < row["held_j"] <= 5000 for row in log)
        assert max(row["held_j"] for row in log[len(log) // 2:]) > 4900, "it was charged"


def test_both_ways_take_about_the_same(both):
    alone, bus = (summary for _, summary, _ in both)
    assert alone["energy_j"] == pytest.approx(bus["energy_j"], rel=0.1)
    assert alone["length_m"] == pytest.approx(bus["length_m"], rel=0.1)
    assert abs(alone["visits"] - bus["visits"]) <= 2


def test_the_table_has_units_and_every_journey(both):
    for folder, summary, text in both:
        lines = text.splitlines()
        head = next(i for i, line in enumerate(lines) if line.startswith("from"))
        assert lines[head].split() == "from to outcome start s time s length m foretold J ± J taken J left J".split()
        table = lines[head + 1:head + 1 + len(summary["journeys"])]
        assert all(("stop" in line or "charger" in line) and len(line) == len(lines[head]) for line in table)
        assert lines[head + 1 + len(table)] == ""
        assert sorted(path.name for path in (folder / "out").iterdir()) == FILES
        assert "went on" in text


def test_equal_rounds_are_equal_to_the_bit(both, tmp_path):
    folder, summary, _ = both[1]
    again, _ = driven(tmp_path, "--hours=0.1", "--bus", "in-process")
    assert again["fingerprint"] == summary["fingerprint"]
    assert (tmp_path / "out/log_round.csv").read_bytes() == (folder / "out/log_round.csv").read_bytes()
    other, _ = driven(tmp_path, "--hours=0.1", "--bus", "in-process", "--seed=2")
    assert other["fingerprint"] != summary["fingerprint"]


def test_two_programs_go_round_as_one(tmp_path):
    one, _ = driven(tmp_path, "--hours=0.02", "--bus", "in-process")
    with Programs(tmp_path) as programs:
        line = tmp_path / "line"
        plant = programs.start(BIN / "jp-patrol", f"--map={tmp_path / 'room.json'}",
                               f"--round={tmp_path / 'round.cfg'}", "--hours=0.02", "--bus", f"pty:{line}",
                               "--output", tmp_path / "two", "--patience", str(LIMIT))
        wait_until(line.exists, "the line")
        programs.start(BIN / "jp-ecu", "--bus", f"slcan:{line}", "--robot", "patrol")
        assert plant.process.wait(LIMIT) == 0, plant.err.read_text()
    assert json.loads((tmp_path / "two/summary.json").read_text()) == one
    assert (tmp_path / "two/log_round.csv").read_bytes() == (tmp_path / "out/log_round.csv").read_bytes()


def test_in_the_maps_own_frame(both, tmp_path):
    write_map(tmp_path / "moved.json", origin=(-2.0, 3.0, 0.0))
    write_round(tmp_path / "round.cfg", charger="[-1.0, 4.0, 0.0]",
                stops="( [3.5, 4.5, 90.0, 4.0], [2.5, 6.5, 180.0, 2.0] )")
    result = run("jp-patrol", f"--map={tmp_path / 'moved.json'}", f"--round={tmp_path / 'round.cfg'}", "--hours=0.1",
                 "--output", tmp_path / "out")
    assert result.returncode == 0
    moved = json.loads((tmp_path / "out/summary.json").read_text())
    assert all(moved[key] == both[0][1][key] for key in ("visits", "charges", "fingerprint"))


@pytest.mark.parametrize("options", [(), ("--bus", "in-process")])
def test_a_battery_that_does_not_suffice_is_told(options, tmp_path):
    changes = {"battery": "{ full_j = 300.0; reserve_j = 100.0; charger_w = 400.0; }"}
    summary, text = driven(tmp_path, *options, status=1, changes=changes)
    assert (summary["outcome"], summary["reason"]) == ("gave up", "a full battery does not suffice")
    assert "gave up: a full battery does not suffice" in text and summary["journeys"] == []


def test_among_boxes_that_the_map_does_not_show(tmp_path):
    summary, _ = driven(tmp_path, "--hours=0.05", "--hidden=1", "--bus", "in-process")
    assert summary["outcome"] == "went on" and summary["visits"] >= 2
    assert any("o" in row for row in summary["map"]["rows"])


def test_the_map_that_the_robot_gets_does_not_show_the_boxes(tmp_path):
    world = write_map(tmp_path / "room.json")
    found = {}
    for boxes in (0, 3):
        result = run("jp-patrol", f"--map={world}", "--start=1,1,0", "--goal=5.5,1.5,90", f"--hidden={boxes}",
                     "--bus", "in-process", "--output", tmp_path / "out")
        assert result.returncode == 0, result.stderr
        found[boxes] = json.loads((tmp_path / "out/summary.json").read_text())
    assert found[0]["map_bytes"] == found[3]["map_bytes"]
    assert found[0]["fingerprint"] != found[3]["fingerprint"]


# ---- wrong input ---------------------------------------------------------------------------------------------------

def refused(folder, text, *options, changes=None):
    result = patrol(folder, *options, changes=changes)
    assert result.returncode == 2
    assert_one_line_error(result, text)
    assert not (folder / "out").exists()


@pytest.mark.parametrize("changes, text", [
    ({"charger": "[1.0, 1.0]"}, "charger"),
    ({"charger": None}, "charger"),
    ({"stops": None}, "stops"),
    ({"stops": "( )"}, "list of 1 to 15 places"),
    ({"stops": "( " + ", ".join(16 * ["[5.5, 1.5, 90.0, 4.0]"]) + " )"}, "list of 1 to 15 places"),
    ({"stops": "( [5.5, 1.5, 90.0] )"}, "stops[0]"),
    ({"stops": "( [5.5, 1.5, 90.0, 4.0], [5.5, 1.5, 90.0, -1.0] )"}, "stops[1]"),
    ({"stops": "( [5.5, 1.5, 400.0, 4.0] )"}, "stops[0]"),
    ({"stops": '( [5.5, 1.5, 90.0, "long"] )'}, "stops[0]"),
    ({"stops": "( [50.0, 1.5, 90.0, 4.0] )"}, "stops[0]: outside the map"),
    ({"stops": "( [3.0, 1.0, 90.0, 4.0] )"}, "stops[0]: the robot does not fit"),
    ({"charger": "[0.2, 0.2, 0.0]"}, "charger: the robot does not fit"),
    ({"battery": "{ full_j = 50.0; reserve_j = 100.0; charger_w = 400.0; }"}, "battery.reserve_j"),
    ({"battery": "{ full_j = 0.0; reserve_j = 0.0; charger_w = 400.0; }"}, "battery.full_j"),
    ({"battery": "{ full_j = 5000.0; reserve_j = 100.0; }"}, "battery.charger_w"),
    ({"battery": "{ full_j = 5000.0; reserve_j = 100.0; charger_w = 400.0; colour = 1; }"}, "colour"),
    ({"deviations": "11.0"}, "deviations"),
    ({"deviations": '"many"'}, "deviations"),
    ({"deviations": "1.645; deviations = 2.0"}, "round.cfg"),
])
def test_a_wrong_file_is_one_line(changes, text, tmp_path):
    refused(tmp_path, text, changes=changes)


@pytest.mark.parametrize("options, text", [
    (("--start=1,1,0",), "--start and --goal"),
    (("--goal=1,1,0",), "--start and --goal"),
    (("--method=plain",), "neither a method"),
    (("--slip",), "neither a method"),
    (("--hours=0",), "--hours 0"),
    (("--hours=long",), "--hours long"),
    (("l-passage",), "--round"),
])
def test_what_does_not_go_with_a_round_is_refused(options, text, tmp_path):
    refused(tmp_path, text, *options)


def test_without_a_map_or_a_file(tmp_path):
    result = run("jp-patrol", f"--round={write_round(tmp_path / 'round.cfg')}", "--output", tmp_path / "out")
    assert result.returncode == 2
    assert_one_line_error(result, "--map")
    result = run("jp-patrol", f"--map={write_map(tmp_path / 'room.json')}", f"--round={tmp_path / 'none.cfg'}")
    assert result.returncode == 2
    assert_one_line_error(result, "none.cfg")
    result = run("jp-patrol", "l-passage", "--hours=1", "--output", tmp_path / "out")
    assert result.returncode == 2
    assert_one_line_error(result, "--hours")


def test_the_example_is_a_round():
    text = (ROOT / "sim/scenarios/depot_round.cfg").read_text()
    assert all(key in text for key in ROUND)
