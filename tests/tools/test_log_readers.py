"""tools/identify: the readers of logs, what they make of damaged ones, and the robot file with other numbers."""
import log_data
import numpy as np
import pytest
from can_drive import candump, frames
from conftest import assert_one_line_error, robot_text, run_tool

from tools.common import ToolError
from tools.design import robot_json
from tools.identify import log_can, log_csv, log_identify, log_lcm, regression, robot_text as texts

CSV = "time_s,wheel_left_rad,wheel_right_rad,pitch_rate_rad_s,voltage_left_v,voltage_right_v"


@pytest.fixture(scope="module", name="courier")
def fixture_courier():
    return robot_json.specification.completed(robot_json.from_text("courier24", robot_text("courier24")))


@pytest.fixture(scope="module", name="drive")
def fixture_drive(tmp_path_factory):
    return log_data.drive("courier24", log_data.STRAIGHT, tmp_path_factory.mktemp("drive"))


@pytest.fixture(scope="module", name="log")
def fixture_log(drive, courier):
    return log_can.read(drive, courier)


def channels(log):
    return {name: (series.times, series.values) for name, series in log.channels.items()}


def assert_same(log, other):
    assert set(log.channels) == set(other.channels)
    for name, (times, values) in channels(log).items():
        assert times == pytest.approx(channels(other)[name][0], abs=2e-6), name
        assert np.array_equal(values, channels(other)[name][1]), name
    assert len(log.segments) == len(other.segments)


# ---- the bus -------------------------------------------------------------------------------------------------------

def test_samples_are_those_of_the_robot(log, drive):
    angle, turned = log["wheel_left"].values[-1], log["wheel_right"].values[-1] - log["wheel_left"].values[-1]
    assert angle * 0.09 == pytest.approx(log_data.length_of(drive.parent), rel=0.01)
    assert abs(turned) < 0.1
    assert log["wheel_left"].period == pytest.approx(0.001) and log.left_out == 0
    assert log["bus_voltage"].values.mean() == pytest.approx(24, abs=0.1)
    counted = log.segments[0].drawn
    times = log["voltage_left"].times
    inside = (times >= log.segments[0].begin) & (times <= log.segments[0].end)
    power = sum(log[f"voltage_{side}"].values * log[f"current_{side}"].values for side in ("left", "right"))[inside]
    assert np.trapz(power + 4.0, times[inside]) == pytest.approx(counted, rel=0.01)


def as_text(line):
    """As candump -ta prints it."""
    time, interface, frame = line.split()
    identifier, data = frame.split("#")
    octets = " ".join(data[i:i + 2] for i in range(0, len(data), 2))
    return f" {time}  {interface}  {identifier}   [{len(data) // 2}]  {octets}"


def test_the_text_of_candump_tells_the_same(log, drive, courier, tmp_path):
    path = tmp_path / "text.log"
    path.write_text("\n".join(map(as_text, drive.read_text().splitlines())) + "\n")
    assert_same(log_can.read(path, courier), log)


def test_other_formats_of_logs_tell_the_same(drive, courier, tmp_path):
    import can
    short = tmp_path / "short.log"
    short.write_text("".join(drive.read_text().splitlines(keepends=True)[:20000]))
    path = tmp_path / "log.blf"
    with can.LogReader(short) as reader, can.BLFWriter(path) as writer:
        for frame in reader:
            writer(frame)
    assert_same(log_can.read(path, courier), log_can.read(short, courier))


def test_a_damaged_sample_is_left_out(log, drive, courier, tmp_path):
    lines = drive.read_text().splitlines()
    places = [index for index, line in enumerate(lines) if " 021#" in line][2000:2003]
    for place in places:
        lines[place] = lines[place][:-1] + ("0" if lines[place][-1] != "0" else "1")
    path = tmp_path / "damaged.log"
    path.write_text("\n".join(lines) + "\n")
    damaged = log_can.read(path, courier)
    assert damaged.left_out == 3
    assert len(damaged["wheel_left"].times) == len(log["wheel_left"].times) - 3
    assert damaged["wheel_left"].values[-1] == log["wheel_left"].values[-1]


def test_lost_samples_do_not_shift_the_time(log, drive, courier, tmp_path):
    samples = (" 020#", " 021#", " 022#")
    path = tmp_path / "gap.log"
    path.write_text("".join(line for line in drive.read_text().splitlines(keepends=True)
                            if not (4 <= float(line[1:18]) < 4.04 and line[24:29] in samples)))
    short = log_can.read(path, courier)
    assert short["wheel_left"].times[-1] == pytest.approx(log["wheel_left"].times[-1], abs=1e-4)
    assert short["wheel_left"].values[-1] == log["wheel_left"].values[-1]


def test_jitter_of_the_recorder_is_taken_off(log, drive, courier, tmp_path):
    generator = np.random.default_rng(1)
    lines = [line for line in drive.read_text().splitlines() if not line.split()[2].startswith(("7F0", "7F1"))]
    late = np.maximum.accumulate([float(line[1:18]) * 1.001 + 1000 + generator.uniform(0, 3e-4) for line in lines])
    path = tmp_path / "jitter.log"
    path.write_text("".join(f"({time:.6f}) {line.split(' ', 1)[1]}\n" for time, line in zip(late, lines)))
    times = log_can.read(path, courier)["wheel_left"].times
    assert np.diff(times) == pytest.approx(0.001001, rel=1e-4)


def test_telemetry_alone(courier, tmp_path):
    path = tmp_path / "telemetry.log"
    path.write_text(candump(frame for frame in frames() if frame.arbitration_id not in (32, 33, 34)))
    log = log_can.read(path, courier)
    assert log.is_estimated and not log.counts_wheels
    assert log["speed"].values.max() == pytest.approx(0.5, abs=0.001)
    assert [(round(one.end - one.begin, 3), one.planned, one.spent, one.drawn) for one in log.segments] == [
        (4.0, 23.5, 24.0, 20.0), (4.0, 24.5, 24.25, 21.0)]


@pytest.mark.parametrize(("content", "parts"), [
    ("", ("is empty",)),
    ("what is this\nindeed\n", ("line 1", "candump -l")),
    ("(1.0) can0 555#00\n", ("no frame of joulepath.dbc",)),
    ("  can0  185   [8]  00 00 00 00 00 00 00 00\n", ("line 1", "no time", "candump -ta")),
    ("(1.0) can0 185#00000000000000ZZ\n", ("line 1", "damaged")),
    ("(soon) can0 185#0000000000000000\n", ("line 1", "damaged")),
    ("(1.0) can0 185#0000000000000000\n(1.1) can0 185#0000000000000000\n", ("voltage_left is missing",)),
])
def test_bad_logs_of_the_bus(tmp_path, content, parts):
    path = tmp_path / "bad.log"
    path.write_text(content)
    assert_one_line_error(run_tool("identify.log_identify", "courier24", path), path, *parts)


def test_a_log_that_is_not_there(tmp_path):
    assert_one_line_error(run_tool("identify.log_identify", "courier24", tmp_path / "no.log"), "no.log", "No such file")


# ---- CSV -----------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize(("content", "parts"), [
    ("a,b,c\n1,2,3\n", ("line 1", "time_s")),
    ("time_s,speed_kmh,x\n1,2,3\n", ("line 1", "'speed_kmh'", "speed_m_s")),
    (CSV + "\n1,2,3\n", ("line 2", "3 values, expected 6")),
    (CSV + "\n0,0,0,0,0,0\n1,x,0,0,0,0\n", ("line 3", "wheel_left_rad", "'x'")),
    (CSV + "\n0,inf,0,0,0,0\n", ("line 2", "infinite")),
    (CSV + "\n0,0,0,0,0,0\n", ("1 rows",)),
    (CSV + "\n1,0,0,0,0,0\n0.5,0,0,0,0,0\n", ("line 3", "time_s")),
    (CSV + "\n0,0,0,0,0,0\n1,0,0,0,0,0\n", ("1.0 s of motion", "5 s")),
    ("time_s,pitch_rate_rad_s,voltage_left_v\n0,0,0\n9,0,0\n", ("neither wheel angles nor speed",)),
])
def test_bad_csv(tmp_path, content, parts):
    path = tmp_path / "log.csv"
    path.write_text(content)
    assert_one_line_error(run_tool("identify.log_identify", "courier24", path), path, *parts)


def test_duties_stand_for_voltages(courier, tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("time_s,duty_left,duty_right,bus_voltage_v,motors_on\n"
                    "0,0.5,-0.25,24,1\n1,0.5,0.5,20,1\n2,0,0,20,0\n")
    log = log_csv.read(path, courier)
    assert log["voltage_left"].values.tolist() == [12, 10, 0] and log["voltage_right"].values.tolist() == [-6, 10, 0]
    assert log.active == [(0.0, 1.0)]


# ---- LCM -----------------------------------------------------------------------------------------------------------

def test_messages_of_lcm_are_those_of_the_bus(log, drive, courier, tmp_path):
    lcm = log_lcm.read(log_data.Gateway(drive, 1000).write(tmp_path / "drive.lcm"), courier)
    assert lcm.is_estimated
    for name in ("speed", "pitch", "spent", "battery_voltage", "reference_speed"):
        inside = slice(20, -20)
        assert lcm[name].values[inside] == pytest.approx(log[name].values_at(lcm[name].times[inside]), abs=0.2), name
    assert lcm["speed"].values == pytest.approx(log["speed"].values[:len(lcm["speed"].values)])
    assert [one.spent for one in lcm.segments] == pytest.approx([one.spent for one in log.segments])
    assert [one.begin for one in lcm.segments] == pytest.approx([one.begin for one in log.segments], abs=0.05)


def test_a_log_without_the_robot(tmp_path):
    import lcm
    path = tmp_path / "other.lcm"
    log = lcm.EventLog(str(path), "w")
    log.write_event(1, "OTHER", b"123")
    log.close()
    assert_one_line_error(run_tool("identify.log_identify", "courier24", path), path, "JP_STATE", "lcm-logger")


# ---- robot files ---------------------------------------------------------------------------------------------------

FILE = """name = "x";  # mass_kg = 9
body: { mass_kg = 3.5; width_m = 0.3; };
wheel: {
    mass_kg = .25;      # mass_kg = 7
    radius_m : 9e-2;
};
"""


def test_numbers_are_replaced_and_nothing_else():
    written = texts.rewritten("x", FILE, {"wheel.mass_kg": 0.123456, "body.width_m": 2, "wheel.radius_m": 1.5e-7})
    assert written == FILE.replace(".25;", "0.12346;").replace("0.3;", "2.0;").replace("9e-2", "1.5e-07")


def test_a_key_that_is_not_there_is_named():
    with pytest.raises(ToolError, match="x: ground.friction: not found"):
        texts.rewritten("x", FILE, {"ground.friction": 1.0})


# ---- least squares -------------------------------------------------------------------------------------------------

def test_deviations_hold_and_instruments_take_off_the_noise(record_property):
    """Columns with noise make the result too small; instruments that are the motion without it do not."""
    seed = 3
    record_property("seed", seed)
    generator = np.random.default_rng(seed)
    inside, plain = [], []
    for _ in range(150):
        blocks = np.repeat(np.arange(40), 25)
        motion = np.convolve(generator.normal(size=1020), np.ones(21), "valid") / 4
        noise = np.convolve(generator.normal(size=1009), np.ones(10), "valid")
        column, target = motion + generator.normal(size=1000), 2 * motion + 0.3 * noise
        told = regression.fit("x", column[:, None], target, blocks, ("a",), [motion[:, None]])
        inside.append(abs(told.values[0] - 2) < 1.96 * told.deviation(0))
        plain.append(regression.fit("x", column[:, None], target, blocks, ("a",)).values[0])
    assert np.mean(plain) < 1.5
    assert 0.88 <= np.mean(inside) <= 0.99


@pytest.mark.parametrize(("matrix", "part"), [
    (np.zeros((100, 1)), "nothing in it tells a"), (np.ones((100, 2)), "does not tell a, b apart")])
def test_what_is_not_told_is_named(matrix, part):
    with pytest.raises(ToolError, match=part):
        regression.fit("x", matrix, np.ones(100), np.repeat(np.arange(10), 10), ("a", "b")[:matrix.shape[1]])


def test_too_short_a_log():
    with pytest.raises(ToolError, match="too short"):
        regression.fit("x", np.ones((100, 1)), np.ones(100), np.zeros(100, int), ("a",))


def test_digits_are_those_that_are_certain():
    assert log_identify.significant(3.49123, 0.02) == "3.491" and log_identify.significant(5.0, 0) == "5"
