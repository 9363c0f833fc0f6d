"""can_report.py and mission_record.py: logs of a synthetic drive become a page; every damage is one line."""
import csv
import json
import math
import re

import can
import can_drive
import numpy as np
import pytest
from can_drive import DRAWN, DURATION, END, PLANNED, POWER, SPENT, TARGETS, candump
from conftest import assert_one_line_error, run_tool, sketched
from fake_ecu import telemetry

from tools.common import ToolError
from tools.operate.can_messages import Codec
from tools.report import report
from tools.report.mission_record import LOG_FORMAT, MissionRecord


@pytest.fixture(scope="module")
def drive():
    return list(can_drive.frames())


@pytest.fixture
def converted(tmp_path):
    """The tool's result for frames or the text of a candump log."""
    def convert(frames, name="yard.log"):
        path = tmp_path / name
        path.write_text(frames if isinstance(frames, str) else candump(frames))
        return run_tool("operate.can_report", path, tmp_path / "out")
    convert.out = tmp_path / "out"
    return convert


def summary_of(folder):
    return json.loads((folder / "summary.json").read_text())


def log_of(folder):
    with open(folder / "log_cruise.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def moved(frame, **change):
    copy = frame.__copy__()
    for key, value in change.items():
        setattr(copy, key, value)
    return copy


# ---- the record ----------------------------------------------------------------------------------------------------

def test_the_summary(drive, converted):
    result = converted(drive)
    assert result.returncode == 0, result.stderr
    summary = summary_of(converted.out)
    assert summary["scenario"] == "yard.log" and summary["simulation"] is None
    assert summary["waypoints_m"] == [[0, 0], *map(list, TARGETS)]
    about, = summary["strategies"]
    assert about["title"] == "recorded drive"
    for i, segment in enumerate(about["segments"]):
        assert segment["index"] == i + 1 and segment["target_m"] == list(TARGETS[i])
        assert segment["planned_energy_j"] == PLANNED[i] and segment["measured_energy_j"] == SPENT[i]
        assert segment["battery_energy_j"] == DRAWN[i] and segment["plant_energy_j"] is None
        assert segment["error_percent"] == pytest.approx(100 * (PLANNED[i] / SPENT[i] - 1))
        assert segment["duration_s"] == pytest.approx(DURATION, abs=1e-6)
        assert segment["speed_m_s"] == 0.5 and segment["turn_deg"] == pytest.approx(math.degrees(0.125))
        assert segment["arc_rad"] == pytest.approx(i * 1.0)
    assert about["segments"][0]["end_m"] == pytest.approx([2, 0], abs=1e-3)
    assert about["segments"][1]["end_m"] == pytest.approx(END, abs=1e-3)
    assert about["segments"][1]["end_error_m"] == pytest.approx(math.dist(END, TARGETS[1]), abs=1e-3)
    assert about["total"] == {
        "planned_energy_j": sum(PLANNED), "measured_energy_j": sum(SPENT), "plant_energy_j": None,
        "battery_energy_j": sum(DRAWN), "duration_s": pytest.approx(2 * DURATION, abs=1e-6), "relative_percent": 100}


def test_the_log(drive, converted):
    converted(drive)
    log = log_of(converted.out)
    assert tuple(log) == report.LOG_COLUMNS == tuple(LOG_FORMAT)
    t = log["t_s"]
    assert np.allclose(np.diff(t), 0.02, atol=0.0015) and 0 <= t[0] < 0.02 and 8 - 0.02 < t[-1] <= 8
    x, y, heading, speed, turn_rate = np.transpose([can_drive.motion(value) for value in t])
    for name, wanted in (("x_m", x), ("y_m", y), ("heading_rad", heading)):
        assert np.allclose(log[name], wanted, atol=2e-3), name
    # The reference follows by dead reckoning, blurred by a sample where it steps.
    assert np.allclose(log["ref_x_m"], x, atol=0.01) and np.allclose(log["ref_y_m"], y, atol=0.01)
    inside = (t > 0.03) & (np.abs(t - DURATION) > 0.03) & (t < 2 * DURATION - 0.03)
    for prefix in ("", "ref_"):
        assert np.allclose(log[f"{prefix}speed_m_s"][inside], speed[inside], atol=1e-3)
        assert np.allclose(log[f"{prefix}turn_rate_rad_s"][inside], turn_rate[inside], atol=2e-3)
    assert np.allclose(log["power_w"], POWER, atol=1e-3)
    assert np.allclose(log["energy_j"], POWER * t, atol=POWER * 0.02)
    assert np.array_equal(log["segment"], np.where(t <= DURATION, 1, 2))
    for name, value in (("pitch_deg", 22.5), ("u_left_v", 3.5), ("u_right_v", -2.25), ("i_left_a", 0.5),
                        ("i_right_a", -0.25)):
        assert np.allclose(log[name], value), name


@sketched
def test_report_makes_a_page_of_it(drive, converted):
    converted(drive)
    result = run_tool("report.report", converted.out)
    assert result.returncode == 0, result.stderr
    text = re.sub(r"data:image[^\"]*", "", (converted.out / "report.html").read_text())
    assert "yard.log" in text and "None" not in text and "Simulated" not in text and "real time" not in text


@pytest.mark.parametrize("name", ["yard.asc", "yard.blf"])
def test_logs_of_other_tools(drive, converted, tmp_path, name):
    converted(drive)
    with can.Logger(tmp_path / name) as logger:
        for frame in drive:
            logger(moved(frame, channel=0))
    result = run_tool("operate.can_report", tmp_path / name, tmp_path / "other")
    assert result.returncode == 0, result.stderr
    ours, theirs = (summary_of(folder)["strategies"] for folder in (converted.out, tmp_path / "other"))
    assert json.dumps(ours)[:200] == json.dumps(theirs)[:200]


def test_a_goal(converted):
    assert converted(can_drive.frames(goal=True)).returncode == 0
    summary = summary_of(converted.out)
    assert summary["waypoints_m"] == [[0, 0], list(TARGETS[0])] and len(summary["strategies"][0]["segments"]) == 1


def test_frames_of_others_do_not_matter(drive, converted):
    converted(drive)
    before = (converted.out / "summary.json").read_bytes()
    text = "".join(f"{line}\n({1000 + i / 1e4:.6f}) vcan0 {kind}\n" for i, (line, kind) in enumerate(zip(
        candump(drive).splitlines(), ["7AB#00", "12345678#00", "184#R", "20000080#0000000000000000"] * 2000)))
    assert converted(text).returncode == 0
    assert (converted.out / "summary.json").read_bytes() == before


def test_in_lockstep_the_simulation_tells_the_time(drive, converted):
    """A hundred times faster than real time, after a wait for the ECU."""
    converted(drive)
    before = summary_of(converted.out)["strategies"]
    frames, last = [telemetry("SimTime", Tick=0xFFFFFFFF, Rate=1000)], None
    for frame in drive:
        tick = round((frame.timestamp - 1000) * 1000)
        if tick != last:
            frames.append(telemetry("SimTime", Tick=tick, Power=1, Rate=1000))
        frames.append(frame)
        last = tick
    frames = [moved(frame, timestamp=5e8 + i * 1e-5) for i, frame in enumerate(frames)]
    assert converted(frames).returncode == 0
    after = summary_of(converted.out)["strategies"]
    assert after[0]["total"]["duration_s"] == pytest.approx(before[0]["total"]["duration_s"])
    assert after[0]["segments"][1]["end_m"] == pytest.approx(before[0]["segments"][1]["end_m"])


def test_a_drive_that_was_stopped(drive, converted):
    frames = [frame for frame in drive if frame.arbitration_id != 397 or frame.data[0] == 1]
    assert converted(frames).returncode == 0
    about, = summary_of(converted.out)["strategies"]
    assert about["title"] == "recorded drive, 1 of 2 segments" and len(about["segments"]) == 1
    assert summary_of(converted.out)["waypoints_m"] == [[0, 0], *map(list, TARGETS)]
    assert log_of(converted.out)["t_s"][-1] <= DURATION


def test_the_last_drive_counts(drive, converted):
    again = [moved(frame, timestamp=frame.timestamp + 100) for frame in can_drive.frames(goal=True)]
    assert converted([*drive, *again]).returncode == 0
    assert summary_of(converted.out)["waypoints_m"][1:] == [list(TARGETS[0])]


def test_a_plan_may_miss_parts(drive, converted):
    frames = [frame for frame in drive if frame.arbitration_id not in (394, 395)]
    assert converted(frames).returncode == 0
    segment = summary_of(converted.out)["strategies"][0]["segments"][0]
    assert segment["speed_m_s"] is segment["turn_deg"] is segment["arc_rad"] is None
    assert segment["planned_energy_j"] == PLANNED[0]
    summary, _ = report.load(converted.out)
    assert report.table4(summary)[0] == ("segment 1", ["24.00"])


def test_a_corrupt_waypoint_is_not_taken_for_one(drive, converted):
    """The sender repeats it; the ECU judged by its CRC too."""
    place = next(i for i, frame in enumerate(drive) if frame.arbitration_id == 258)
    broken = moved(drive[place], data=bytearray(drive[place].data))
    broken.data[5] ^= 4
    assert converted([*drive[:place], broken, *drive[place:], ]).returncode == 0
    assert summary_of(converted.out)["waypoints_m"] == [[0, 0], *map(list, TARGETS)]


def test_a_repeated_waypoint_is_one(drive, converted):
    place = next(i for i, frame in enumerate(drive) if frame.arbitration_id == 258)
    assert converted([*drive[:place], drive[place], *drive[place:]]).returncode == 0
    assert summary_of(converted.out)["waypoints_m"] == [[0, 0], *map(list, TARGETS)]


def test_equal_logs_give_equal_files(drive, converted):
    converted(drive)
    first = [path.read_bytes() for path in sorted(converted.out.iterdir())]
    converted(drive)
    assert [path.read_bytes() for path in sorted(converted.out.iterdir())] == first


# ---- what the ECU learned ------------------------------------------------------------------------------------------

def learner(ms, changes, cause, friction=1.0, payload=0.0):
    frames = [telemetry("Learned", Friction=friction, FrictionDeviation=0.03125, Payload=payload,
                        PayloadDeviation=0.25),
              telemetry("LearnerStatus", Version=20, Changes=changes, Cause=cause)]
    return [moved(frame, timestamp=1000 + ms / 1000) for frame in frames]


def lines_of(result):
    assert result.returncode == 0, result.stderr
    return [line for line in result.stdout.splitlines() if not line.startswith("wrote ")]


def with_learner(drive, *frames):
    return sorted([*drive, *sum(frames, [])], key=lambda frame: frame.timestamp)


def test_changes_are_one_line_each(drive, converted):
    result = converted(with_learner(
        drive, learner(100, 0, "None"), learner(2000, 1, "None"), learner(3000, 1, "None"),
        learner(4340, 1, "Ground", friction=1.5), learner(5000, 1, "Ground", friction=1.75),
        learner(6000, 2, "Payload", payload=2.5), learner(7000, 2, "Other"), learner(8000, 3, "Payload", payload=-1)))
    assert lines_of(result) == ["2.0 s: surface or robot changed, learning anew",
                                "4.3 s: surface changed, friction 1.50 ± 0.03 of the robot file's",
                                "6.0 s: payload changed, +2.50 ± 0.25 kg of the robot file's",
                                "7.0 s: robot changed, neither surface nor payload",
                                "8.0 s: payload changed, -1.00 ± 0.25 kg of the robot file's"]


def test_without_a_change_there_is_no_line(drive, converted):
    restart = [learner(2000, 1, "Ground", friction=1.5), learner(3000, 0, "None"), learner(4000, 1, "Ground")]
    assert lines_of(converted(with_learner(drive, learner(100, 0, "None")))) == []
    assert len(lines_of(converted(with_learner(drive, *restart)))) == 2
    assert lines_of(converted(with_learner(drive, learner(2000, 1, "Ground")[1:]))) == []  # Learned was lost


# ---- damage --------------------------------------------------------------------------------------------------------

def without(*identifiers):
    return lambda frames: [frame for frame in frames if frame.arbitration_id not in identifiers]


def cut_text(frames):
    text = candump(frames)
    return text[:len(text) // 2 + 7]


def shorter(frames):
    return [moved(frame, data=frame.data[:5]) if frame.arbitration_id == 389 else frame for frame in frames]


def back_in_time(frames):
    return [moved(frame, timestamp=frame.timestamp - 3) if i > len(frames) // 2 else frame
            for i, frame in enumerate(frames)]


def not_finite(frames):
    return candump(frames).replace("(1004.", "(nan.")


@pytest.mark.parametrize("damage, part", [
    (lambda frames: "", "no frame of joulepath.dbc"), (lambda frames: "(1.0) vcan0 7AB#00\n", "no frame of joulepath"),
    (cut_text, "damaged after frame"), (not_finite, "damaged"), (shorter, "Motion has 5 bytes instead of 8"),
    (without(397), "no segment was driven"), (without(396), "segment 1: its plan"), (without(258), "its waypoint"),
    (without(256), "its waypoint"), (without(388), "pose"), (without(389), "speed"), (without(390), "reference"),
    (without(391), "voltages"), (without(32), "currents"), (without(392), "energy spent"),
    (back_in_time, "backwards"), (lambda frames: frames[len(frames) // 4:], "segment 1: its plan"),
    (lambda frames: "\x00\x01\x02", "damaged after frame 0"),
])
def test_damaged_logs(drive, converted, damage, part):
    assert_one_line_error(converted(damage(drive)), "yard.log", part)
    assert not converted.out.exists()


@pytest.mark.parametrize("name, content", [("yard.blf", b"LOGG" + bytes(300)), ("yard.blf", b""), ("yard.asc", b"\xff"),
                                           ("yard.asc", b"date Xyz\n"), ("yard.log", b"\xff\xfe\x00(")])
def test_files_that_are_no_logs(tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    assert_one_line_error(run_tool("operate.can_report", tmp_path / name, tmp_path / "out"), name)
    assert not (tmp_path / "out").exists()


def test_files_that_cannot_be_read_or_written(drive, converted, tmp_path):
    assert_one_line_error(run_tool("operate.can_report", tmp_path / "none.log", tmp_path), "none.log", "No such file")
    assert_one_line_error(run_tool("operate.can_report", tmp_path, tmp_path), "must end in")
    converted.out.write_text("a file\n")
    assert_one_line_error(converted(drive), "out")


# ---- the record without a bus ----------------------------------------------------------------------------------------

def feed(record, start, end, step=0.02):
    for t in np.arange(start, end, step):
        record.pose(t, t, 0.0, 3.0 + t / 4 if 3 + t / 4 < math.pi else 3.0 + t / 4 - math.tau)
        record.motion(t, 1.0, 0.25, 0.0)
        record.reference(t, 1.0, 0.25, 0.0)
        record.motors(t, 1.0, 1.0)
        record.currents(t, 0.5, 0.5)
        record.energy_spent(t, 5 * t)


def test_headings_that_wrap_are_unwrapped():
    record = MissionRecord("test")
    record.route([(2, 0)])
    record.segment_plan(0.0, 1, 10.0)
    feed(record, 0.0, 2.2)
    record.segment_result(2.0, 1, 10.0)
    _, log = record.results()
    heading = dict(zip(LOG_FORMAT, log))["heading_rad"]
    assert np.all(np.abs(np.diff(heading)) < 0.1) and heading[-1] == pytest.approx(3.5, abs=0.01)


def test_a_segment_that_is_planned_anew_keeps_its_place():
    record = MissionRecord("test")
    record.route([(1, 0), (2, 0), (3, 0)])
    record.segment_plan(0.0, 1, 1.0)
    feed(record, 0.0, 3.2)
    record.segment_plan(0.9, 2, 2.0)
    record.segment_plan(0.95, 2, 2.5)
    record.segment_result(1.0, 1, 1.0)
    record.route([(9, 9)])
    record.segment_plan(1.5, 2, 4.0)
    record.segment_result(2.0, 2, 2.0)
    summary, _ = record.results()
    segments = summary["strategies"][0]["segments"]
    assert [segment["target_m"] for segment in segments] == [[1, 0], [9, 9]]
    assert [segment["planned_energy_j"] for segment in segments] == [1.0, 4.0]
    assert segments[1]["battery_energy_j"] is None and summary["strategies"][0]["total"]["battery_energy_j"] is None


def test_a_longer_drive_than_the_route_is_an_error():
    record = MissionRecord("test")
    record.route([(1, 0)])
    for index in (1, 2):
        record.segment_plan(index - 1.0, index, 1.0)
        record.segment_result(float(index), index, 1.0)
    feed(record, 0.0, 2.2)
    with pytest.raises(ToolError, match="segment 2: its waypoint"):
        record.results()


def test_a_stand_in_the_midst_of_a_route_goes_on_with_it():
    """The next plan was late: the robot stood for half a second, and counts its segments anew."""
    record = MissionRecord("test")
    record.route([(1, 0), (2, 0)])
    record.segment_plan(0.0, 1, 1.0)
    feed(record, 0.0, 3.2)
    record.segment_result(1.0, 1, 1.0)
    record.segment_plan(1.5, 1, 2.0)
    record.segment_result(2.5, 1, 2.0)
    summary, _ = record.results()
    assert [segment["target_m"] for segment in summary["strategies"][0]["segments"]] == [[1, 0], [2, 0]]
    assert [segment["measured_energy_j"] for segment in summary["strategies"][0]["segments"]] == [1.0, 2.0]


@pytest.mark.parametrize("anew", [True, False])
def test_the_same_goal_twice_is_two_drives(anew):
    record = MissionRecord("test")
    feed(record, 0.0, 3.2)
    record.route([(1, 0)])
    for begin in (0.0, 1.5):
        record.segment_plan(begin, 1, 1.0 + begin)
        record.segment_result(begin + 1, 1, 1.0)
        if anew:
            record.route([(1, 0)])
    summary, _ = record.results()
    assert [segment["planned_energy_j"] for segment in summary["strategies"][0]["segments"]] == [2.5]


def test_samples_in_a_bunch_give_no_infinite_power():
    record = MissionRecord("test")
    record.route([(1, 0)])
    record.segment_plan(0.0, 1, 1.0)
    feed(record, 0.0, 1.2)
    record.energy_spent(1.2, 6.1)
    record.energy_spent(1.2, 6.2)
    record.segment_result(1.2, 1, 6.0)
    _, log = record.results()
    assert np.isfinite(log).all()


def test_codec_is_not_needed_for_the_record():
    """The interface knows neither frames nor turns; that is what other transports build on."""
    assert not any(isinstance(value, Codec) for value in vars(MissionRecord("test")).values())
