"""jp-patrol over a bus: the firmware's application gets map and goal, sees and drives in frames; wrong input."""
import json

import pytest
from conftest import assert_one_line_error, run
from programs import BIN, LIMIT, ROOT, Programs, wait_until

SCENES = ["beside-obstacle", "l-passage", "corridor", "doorway", "pedestrian", "warehouse"]
OF_THE_CLOCK = ("7F0#", "7F1#")  # lockstep's frames, sent again when the computer is slow


def drive(scene, output, *options):
    return run("jp-patrol", scene, "--bus", "in-process", "--output", output, *options)


def frames(output):
    return [line for line in (output / "frames.log").read_text().splitlines()
            if not any(frame in line for frame in OF_THE_CLOCK)]


@pytest.mark.parametrize("scene", SCENES)
def test_it_arrives_and_touches_nothing(scene, tmp_path):
    result = drive(scene, tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["outcome"] == "arrived" and summary["clearance_min_m"] > 0.05
    assert summary["position_error_m"] < 0.15 and summary["heading_error_deg"] < 10
    assert summary["odometry_error_m"] < 0.1 and summary["commands_late"] == 0
    # What the ECU metered of the leg is most of what the plant took from the first command on.
    assert 0.85 * summary["energy_j"] < summary["metered_j"] < summary["energy_j"]
    assert 0 < summary["forecast_j"] and 0 < summary["deviation_j"]


# In a hall with nothing in the way: round corners, across, back, on the spot, and a step to a goal beside it.
HALL_TASKS = [("2,2,0", "5,3.5,90"), ("1.5,2.4,314", "6.3,1.5,151"), ("3.3,4.2,313", "7,3.4,67"), ("5.8,2,110", "3.8,3.9,247"),
              ("4,3,0", "4,3,135"), ("2.5,4.3,118", "3.1,3.2,94")]


@pytest.mark.parametrize("start, goal", HALL_TASKS)
def test_an_undisturbed_drive_takes_what_was_foretold(start, goal, tmp_path):
    wall, floor = "#" * 160, "#" + "." * 158 + "#"
    (tmp_path / "hall.json").write_text(json.dumps({
        "format": "joulepath-map-1", "name": "hall", "width": 160, "height": 120, "resolution_m": 0.05,
        "origin_m": [0.0, 0.0, 0.0], "rows": [wall, *[floor] * 118, wall]}))
    result = run("jp-patrol", f"--map={tmp_path / 'hall.json'}", f"--start={start}", f"--goal={goal}", "--bus=in-process",
                 "--output", tmp_path / "out")
    assert (result.returncode, result.stderr) == (0, "")
    summary = json.loads((tmp_path / "out/summary.json").read_text())
    # It steers about its path for the noise of its place, some per cent, and a turn that ends a little off is another one.
    assert summary["metered_j"] == pytest.approx(summary["forecast_j"], rel=0.15)


def test_equal_drives_send_equal_frames(tmp_path):
    for name in ("a", "b"):
        assert drive("l-passage", tmp_path / name).returncode == 0
    assert frames(tmp_path / "a") == frames(tmp_path / "b")
    assert drive("l-passage", tmp_path / "c", "--seed=2").returncode == 0
    assert frames(tmp_path / "a") != frames(tmp_path / "c")


def test_two_programs_drive_as_one(tmp_path):
    assert drive("l-passage", tmp_path / "one").returncode == 0
    with Programs(tmp_path) as programs:
        line = tmp_path / "line"
        plant = programs.start(BIN / "jp-patrol", "l-passage", "--bus", f"pty:{line}", "--output", tmp_path / "two",
                               "--patience", str(LIMIT))
        wait_until(line.exists, "the line")
        programs.start(BIN / "jp-ecu", "--bus", f"slcan:{line}", "--robot", "patrol")
        assert plant.process.wait(LIMIT) == 0, plant.err.read_text()
    assert frames(tmp_path / "two") == frames(tmp_path / "one")
    assert (tmp_path / "two/summary.json").read_bytes() == (tmp_path / "one/summary.json").read_bytes()


@pytest.mark.parametrize("options, text", [
    (("--method=plain",), "--method plain"),
    (("--slip",), "neither faults"),
    (("--patience=0",), "--patience"),
])
def test_what_does_not_go_over_a_bus_is_refused(options, text, tmp_path):
    result = drive("l-passage", tmp_path / "out", *options)
    assert result.returncode == 2
    assert text in result.stderr
    assert not (tmp_path / "out").exists()


def test_a_robot_without_tables_is_refused(tmp_path):
    robot = tmp_path / "other.cfg"
    text = (ROOT / "sim/robots/patrol.cfg").read_text()
    robot.write_text(text.replace('name = "patrol"', 'name = "other"'))
    result = drive("l-passage", tmp_path / "out", "--robot", robot)
    assert result.returncode == 2
    assert_one_line_error(result, "make robot")
