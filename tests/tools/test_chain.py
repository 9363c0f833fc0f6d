"""jp-chain: rows, back-to-back segments, energies against the plant's ledger, variation and change, bad input."""
import csv
import json
import math
import os
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT, assert_one_line_error

JP_CHAIN = Path(os.environ.get("JP_BUILD", ROOT / "build")).resolve() / "bin" / "jp-chain"
FILES = ["chain.csv", "chain.json"]
VARIATION = ["ground_friction", "payload_kg", "motor_resistance", "motor_friction", "capacity"]
COLUMNS = ["chain", "segment", "v_m_s", "w_rad_s", "turn_rad", "duration_s", "ticks", "end", "faults", "e_model_j",
           "e_battery_j", "plant_motor_j", "plant_electrical_j", "bus_v", "charge_as", "saturated_ticks", *VARIATION,
           "x_m", "y_m", "yaw_rad", "pitch_rad", "wheel_rate_rad_s", "pitch_rate_rad_s", "yaw_rate_rad_s", "u_left_v",
           "u_right_v", "wheel_error_rad", "yaw_error_rad", "wheel_integral_rad_s", "yaw_integral_rad_s",
           "reference_wheel_rate_rad_s", "reference_yaw_rate_rad_s", "wheel_lag_rad", "yaw_lag_rad"]
COMMAND = ["chain", "segment", "v_m_s", "w_rad_s", "turn_rad", "duration_s"]
RATE = 1000  # Hz, of both robots
OLD = "from an earlier run\n"


def chain(output, *arguments, robot="courier24"):
    path = ROOT / "sim" / "robots" / f"{robot}.cfg"
    return subprocess.run([JP_CHAIN, path, "--output", output, *map(str, arguments)], capture_output=True, text=True,
                          check=False, timeout=60)


def drive(folder, *arguments, robot="courier24"):
    """The rows, numbers as floats, and the summary."""
    result = chain(folder, *arguments, robot=robot)
    assert (result.returncode, result.stderr) == (0, "")
    with (folder / "chain.csv").open() as table:
        rows = [{name: text if name == "end" else float(text) for name, text in row.items()}
                for row in csv.DictReader(table)]
    return rows, json.loads((folder / "chain.json").read_text())


def total(rows, column):
    return math.fsum(row[column] for row in rows)


def part(rows, columns):
    return [[row[name] for name in columns] for row in rows]


# ---- Rows ----------------------------------------------------------------------------------------------------------

def test_a_row_for_each_segment(tmp_path):
    rows, about = drive(tmp_path, "--chains", 3, "--segments", 4)
    assert list(rows[0]) == COLUMNS
    assert [(row["chain"], row["segment"]) for row in rows] == [(i, j) for i in range(3) for j in range(4)]
    assert all(row["end"] == "driven" and row["faults"] == 0 for row in rows)
    assert part(rows, VARIATION) == [[1, 0, 1, 1, 1]] * len(rows)
    assert about["robot"] == "courier24" and about["vary"] is False and about["change"] is None
    assert about["totals"] == {
        "segments": 12, "falls": 0, "faults": 0, "simulated_s": pytest.approx(total(rows, "duration_s")),
        "saturated_ticks": total(rows, "saturated_ticks"), "e_model_j": pytest.approx(total(rows, "e_model_j")),
        "e_battery_j": pytest.approx(total(rows, "e_battery_j"))}


def test_commands_fill_the_limits(tmp_path):
    rows, about = drive(tmp_path, "--chains", 10, "--segments", 40, "--shortest", 0.5, "--longest", 1)
    for column, low, high in [("v_m_s", 0, about["nominal"]["speed_limit_m_s"]),
                              ("w_rad_s", *(sign * about["nominal"]["turn_rate_limit_rad_s"] for sign in (-1, 1))),
                              ("turn_rad", *(sign * math.radians(about["nominal"]["turn_limit_deg"])
                                             for sign in (-1, 1))),
                              ("duration_s", 0.5, 1)]:
        values = [row[column] for row in rows]
        width = high - low
        assert low <= min(values) < low + 0.05 * width, column
        assert high - 0.05 * width < max(values) <= high, column
        assert sum(values) / len(values) == pytest.approx((low + high) / 2, abs=0.06 * width), column


def test_shares_scale_the_ranges(tmp_path):
    options = ("--chains", 2, "--segments", 20, "--longest", 1)
    whole, _ = drive(tmp_path / "whole", *options)
    scaled, _ = drive(tmp_path / "scaled", *options, "--speed-share", 0.5, "--turn-rate-share", 0.25, "--turn-share", 0)
    for row, other in zip(whole, scaled):
        assert other["v_m_s"] == pytest.approx(0.5 * row["v_m_s"], abs=1e-8)
        assert other["w_rad_s"] == pytest.approx(0.25 * row["w_rad_s"], abs=1e-8)
        assert other["turn_rad"] == 0
        assert other["duration_s"] == row["duration_s"]


def test_segments_are_whole_ticks_back_to_back(tmp_path):
    rows, _ = drive(tmp_path, "--chains", 4, "--segments", 60, "--shortest", 0.05, "--longest", 1, robot="gao2018")
    for row in rows:
        assert row["ticks"] == pytest.approx(row["duration_s"] * RATE, abs=1e-6)
    # References that are not shaped follow the commands: a tick too few or too many would sum up in the heading.
    for number in range(4):
        mine = [row for row in rows if row["chain"] == number]
        yaw = math.fsum(row["turn_rad"] + row["w_rad_s"] * row["duration_s"] for row in mine)
        last = mine[-1]
        measured = last["yaw_rad"] - last["yaw_rate_rad_s"] / RATE
        assert measured + last["yaw_error_rad"] == pytest.approx(yaw, abs=1e-4)


def test_a_segment_does_not_know_what_follows(tmp_path):
    """Each row is of its own segment's ticks alone: a chain that is cut short begins with the same rows."""
    whole, _ = drive(tmp_path / "whole", "--chains", 1, "--segments", 6)
    for count in (1, 2, 5):
        cut, _ = drive(tmp_path / str(count), "--chains", 1, "--segments", count)
        assert cut == whole[:count]


@pytest.mark.parametrize("robot", ["gao2018", "courier24"])
def test_meter_agrees_with_the_ledger(tmp_path, robot):
    rows, about = drive(tmp_path, "--chains", 4, "--segments", 15, robot=robot)
    electronics = about["nominal"]["electronics_w"] * total(rows, "duration_s")
    assert total(rows, "e_model_j") == pytest.approx(total(rows, "plant_motor_j") + electronics, rel=1e-3)
    drawn = total(rows, "plant_electrical_j") + electronics
    assert total(rows, "e_battery_j") == pytest.approx(drawn, rel=1e-3)
    assert math.fsum(row["charge_as"] * row["bus_v"] for row in rows) == pytest.approx(drawn, rel=2e-3)


def test_bus_voltage_sags(tmp_path):
    rows, _ = drive(tmp_path, "--chains", 1, "--segments", 10)
    assert all(23 < row["bus_v"] < 24 for row in rows)


# ---- Seeds ---------------------------------------------------------------------------------------------------------

def test_same_seed_same_bytes(tmp_path):
    options = ("--chains", 3, "--segments", 5, "--vary", "--seed")
    for name, seed in [("one", 5), ("same", 5), ("other", 6)]:
        drive(tmp_path / name, *options, seed)
    for file in FILES:
        one, same, other = ((tmp_path / name / file).read_bytes() for name in ("one", "same", "other"))
        assert one == same and one != other


def test_chains_and_seeds_share_no_commands(tmp_path):
    commands = {row["v_m_s"] for seed in range(3)
                for row in drive(tmp_path, "--chains", 4, "--segments", 3, "--longest", 1, "--seed", seed)[0]}
    assert len(commands) == 3 * 4 * 3


# ---- Variation and change ------------------------------------------------------------------------------------------

@pytest.mark.parametrize("name, value, column, sign", [
    ("friction", 1.5, "e_model_j", 1), ("friction", 1.5, "e_battery_j", 1), ("friction", 0.7, "e_battery_j", -1),
    ("motor-friction", 1.5, "e_battery_j", 1), ("payload", 1, "e_battery_j", 1),
])
def test_variation_has_its_direction(tmp_path, name, value, column, sign):
    options = ("--chains", 3, "--segments", 20)
    nominal, _ = drive(tmp_path / "nominal", *options)
    varied, about = drive(tmp_path / "varied", *options, "--variation", f"{name}={value}")
    assert part(varied, COMMAND) == part(nominal, COMMAND)
    assert about["variation"] == f"{name}={value}"
    assert sign * (total(varied, column) / total(nominal, column) - 1) > 0.002


def test_resistance_shows_in_the_plant_alone(tmp_path):
    """The robot's meter divides by the resistance of its file."""
    rows, about = drive(tmp_path, "--segments", 10, "--chains", 2, "--variation", "resistance=1.1", robot="gao2018")
    motors = total(rows, "e_model_j") - about["nominal"]["electronics_w"] * total(rows, "duration_s")
    assert motors / total(rows, "plant_motor_j") == pytest.approx(1.1, rel=1e-4)


def test_vary_draws_a_robot_for_each_chain(tmp_path):
    options = ("--chains", 30, "--segments", 2, "--longest", 1)
    rows, about = drive(tmp_path / "varied", *options, "--vary")
    nominal, _ = drive(tmp_path / "nominal", *options)
    assert about["vary"] is True
    assert part(rows, COMMAND) == part(nominal, COMMAND)
    robots = {tuple(row[name] for name in VARIATION): row["chain"] for row in rows}
    assert len(robots) == 30 and sorted(robots.values()) == list(range(30))
    for values, (low, high) in zip(zip(*robots), [(0.6, 1.6), (-0.3, 1.2), (0.92, 1.12), (0.8, 1.25), (0.7, 1)]):
        assert low <= min(values) < low + (high - low) / 4 and high - (high - low) / 4 < max(values) <= high


def test_change_in_mid_drive(tmp_path):
    options = ("--chains", 2, "--segments", 12, "--vary")
    before, _ = drive(tmp_path / "before", *options)
    after, about = drive(tmp_path / "after", *options, "--change", "friction=3,payload=0", "--change-at", 4)
    assert (about["change"], about["change_at"]) == ("friction=3,payload=0", 4)
    # The meter's last sample of segment 3 is taken after the change.
    earlier = [(row, other) for row, other in zip(before, after) if row["segment"] < 3]
    assert len(earlier) == 6 and all(row == other for row, other in earlier)
    later = [(row, other) for row, other in zip(before, after) if row["segment"] >= 4]
    for row, other in later:
        assert (other["ground_friction"], other["payload_kg"]) == (3, 0)
        assert part([other], VARIATION[2:]) == part([row], VARIATION[2:])
        assert part([other], COMMAND) == part([row], COMMAND)
    assert total([other for _, other in later], "e_battery_j") > total([row for row, _ in later], "e_battery_j")


def test_fall_ends_its_chain_only(tmp_path):
    rows, about = drive(tmp_path, "--chains", 3, "--segments", 10, "--change", "payload=20", "--change-at", 2)
    assert about["totals"]["falls"] == 3
    for number in range(3):
        mine = [row for row in rows if row["chain"] == number]
        assert [row["end"] for row in mine] == ["driven"] * (len(mine) - 1) + ["fell"]
        assert 3 <= len(mine) < 10
        assert 0 < mine[-1]["ticks"] < mine[-1]["duration_s"] * RATE
        assert mine[-1]["e_model_j"] > 0 and mine[-1]["saturated_ticks"] > 0


# ---- Bad input -----------------------------------------------------------------------------------------------------

@pytest.fixture
def output(tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    for name in FILES:
        (folder / name).write_text(OLD)
    return folder


def assert_untouched(folder):
    assert sorted(path.name for path in folder.iterdir()) == FILES
    assert all(path.read_text() == OLD for path in folder.iterdir())


@pytest.mark.parametrize("arguments, reason", [
    (["--chains", "0"], "1 to"), (["--chains", "1.5"], "whole"), (["--chains", ""], "whole"),
    (["--chains", "1e9"], "whole"), (["--segments", "0"], "1 to"), (["--segments", "99999999999999999999"], "1 to"),
    (["--seed", "-1"], "0 to"), (["--seed", "x"], "whole"), (["--shortest", "0"], "0.05"),
    (["--shortest", "11"], "--longest"), (["--longest", "601"], "600"), (["--longest", "nan"], "600"),
    (["--speed-share", "1.1"], "0 to 1"), (["--turn-rate-share", "-0.1"], "0 to 1"), (["--turn-share", "x"], "0 to 1"),
    (["--variation", "mass=1"], "mass=1"), (["--variation", "friction"], "NAME=NUMBER"),
    (["--variation", "friction=0"], "0.1 to 10"), (["--variation", "payload=-4"], "body.mass_kg"),
    (["--change", "friction=2"], "--change-at"), (["--change-at", "2"], "--change"),
    (["--change", "friction=2", "--change-at", "20"], "--segments"),
    (["--change", "friction=2", "--change-at", "0"], "1 to"), (["--change", "payload=-4", "--change-at", "2"], "body"),
    (["--change", "frixion=2", "--change-at", "2"], "frixion"),
    (["--vary", "--variation", "friction=1.5"], "not both"), (["another.cfg"], "another.cfg"),
])
def test_bad_options(output, arguments, reason):
    result = chain(output, *arguments)
    assert_one_line_error(result, arguments[0], reason)
    assert result.stdout == ""
    assert_untouched(output)


def test_missing_and_unknown_options(tmp_path):
    for arguments in ([], ["a.cfg"], ["--output", "out"], ["a.cfg", "--output", "out", "--nonsense"]):
        result = subprocess.run([JP_CHAIN, *arguments], capture_output=True, text=True, check=False, cwd=tmp_path)
        assert result.returncode == 2 and result.stderr != ""
    assert list(tmp_path.iterdir()) == []


def test_bad_robots(tmp_path, output):
    path = tmp_path / "robot.cfg"
    text = (ROOT / "sim" / "robots" / "courier24.cfg").read_text()
    for name, content, reason in [("none.cfg", None, "No such file"), ("robot.cfg", "name = ", "robot.cfg"),
                                  ("robot.cfg", text.replace("courier24", "nobody"), "make gains ROBOT=nobody")]:
        if content is not None:
            path.write_text(content)
        result = subprocess.run([JP_CHAIN, tmp_path / name, "--output", output], capture_output=True, text=True,
                                check=False)
        assert_one_line_error(result, reason)
    assert_untouched(output)


@pytest.mark.parametrize("name", FILES)
def test_full_disk(output, name):
    (output / f"{name}.part").symlink_to("/dev/full")
    assert_one_line_error(chain(output, "--chains", 1, "--segments", 2), str(output / name), "No space left on device")
    assert_untouched(output)


def test_places_that_cannot_be_written(tmp_path):
    place = tmp_path / "place"
    place.write_text(OLD)
    assert_one_line_error(chain(place), str(place), "--output")
    assert_one_line_error(chain("/proc/none"), "/proc/none")
    assert place.read_text() == OLD
