"""jp-ecu and jp-plant as two processes on pseudo-terminals: the same drive as in one process, whatever comes, goes or
cuts in on the bus, and what each says when it cannot go on."""
import os
import subprocess
import sys
import termios
import time
import tty
from contextlib import suppress

import pytest
from conftest import run
from programs import (CLIENT_LATE, LIMIT, LOG, ROOT, SILENCES, THIRD_PARTY_CLIENT, Programs, assert_client_drives,
                      assert_done, assert_one_line_error, assert_same_drive, assert_stopped, drive_in_process, summary,
                      wait_until, with_battery_energy, write_scenario)

ROUTE = [(2.0, 0.5), (3.0, 2.0)]
WAY = 0.3  # m
NEXT = (2.0, 1.0)  # after a restart on the way to the first
PATIENCE = 10  # s that jp-plant waits for an ECU, of the wall's clock
ATTEMPTS = 5   # for what depends on how soon a busy machine starts a process
NOTHING_WRONG = ("ticks without a sample", "frames with a wrong CRC", "frames out of sequence", "frames malformed",
                 "frames unknown", "frames of another controller", "frames that the bus did not take",
                 "commands rejected", "operator timeouts", "bus-offs")

# As SLCAN writes them.
ECU_STATUS, POSE = b"t1808", b"t1848"
FOREIGN = b"t55581122334455667788\r"
BUS_FRAMES = 9000  # a second, of 8 bytes, at 1 Mbit/s
STRANGE = {"unknown": [(b"t5551AB\r", 10), (b"t7F11AB\r", 5)], "remote": [(b"r1004\r", 7)],
           "extended": [(b"T000000100\r", 3), (b"R1FFFFFFF8\r", 2)],
           "too short": [(b"t100300A0B0\r", 4), (b"t0220\r", 1)], "too long": [(b"t10080000000000000000\r", 6)]}
MALFORMED = ("too short", "too long")
IDLE, BALANCING, DRIVING = range(3)


@pytest.fixture(name="programs")
def fixture_programs(tmp_path):
    with Programs(tmp_path) as programs:
        yield programs


@pytest.fixture(name="short")
def fixture_short(tmp_path):
    return write_scenario(tmp_path / "short.cfg", *ROUTE)


@pytest.fixture(name="in_process")
def fixture_in_process(tmp_path, short):
    """The short drive within one process, which all others must equal."""
    return drive_in_process(short, tmp_path / "in-process")


def plant_with_lines(programs, scenario, count, *options):
    """jp-plant as the adapter of `count` serial lines, once they are there."""
    lines = [programs.folder / f"line{number}" for number in range(count)]
    plant = programs.plant(scenario, *(part for line in lines for part in ("--bus", f"pty:{line}")), *options)
    wait_until(lambda: all(line.is_symlink() for line in lines) or not plant.running, "the lines of jp-plant")
    return plant, *lines


class Stranger:
    """Someone on a line of its own who sends what it likes, as text of SLCAN."""

    def __init__(self, line):
        self._line = os.open(line, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        tty.setraw(self._line)
        termios.tcflush(self._line, termios.TCIFLUSH)  # what the one before has left
        self.send(b"S8\rO\r")
        self._heard = b""

    def send(self, text):
        """The bytes that the line took. It is full, or the plant has ended: none."""
        try:
            return os.write(self._line, text)
        except OSError:
            return 0

    def listen(self):
        with suppress(OSError):
            self._heard = self._heard[-1000:] + os.read(self._line, 1 << 16)

    def hears(self, text):
        self.listen()
        return text in self._heard

    def next(self, message):
        """Its data, as a little-endian number."""
        self._heard = b""
        wait_until(lambda: self.hears(message) and len(self._heard.split(message)[1]) > 16, message)
        return int.from_bytes(bytes.fromhex(self._heard.split(message)[1][:16].decode()), "little")

    def ecu_state(self):
        return self.next(ECU_STATUS) & 7

    def x(self):
        """Where the ECU thinks to be, m."""
        raw = self.next(POSE) & 0x3FFFFFF
        return (raw - (raw >> 25 << 26)) / 65536


# ---- the same drive ------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("robot", ["gao2018", "courier24"])
def test_over_a_serial_line_as_in_one_process(programs, tmp_path, robot):
    scenario = write_scenario(tmp_path / "short.cfg", *ROUTE, robot=robot)
    expected = drive_in_process(scenario, tmp_path / "in-process")
    plant, line = plant_with_lines(programs, scenario, 1, "--output", tmp_path / "serial")
    ecu = programs.ecu(f"slcan:{line}", "--robot", robot)
    counts = assert_done(plant).counts
    assert_same_drive(tmp_path / "serial", expected)
    assert counts["of those, commands that missed their deadline"] == 0
    counts = assert_stopped(ecu)
    assert [counts[name] for name in NOTHING_WRONG] == [0] * len(NOTHING_WRONG)
    assert counts["ticks"] > 5000


def test_an_ecu_that_predicts_the_energy_of_the_battery(programs, tmp_path):
    scenario = with_battery_energy(write_scenario(tmp_path / "short.cfg", *ROUTE, robot="courier24"))
    expected = drive_in_process(scenario, tmp_path / "in-process")
    plant, line = plant_with_lines(programs, scenario, 1, "--output", tmp_path / "serial")
    programs.ecu(f"slcan:{line}", "--robot", "courier24", "--energy", "battery")
    assert_done(plant)
    assert_same_drive(tmp_path / "serial", expected)
    for segment in summary(expected)["strategies"][0]["segments"]:
        assert segment["measured_energy_j"] == segment["battery_energy_j"]
        assert segment["planned_energy_j"] == pytest.approx(segment["measured_energy_j"], rel=0.02)


def test_the_report_takes_it(in_process):
    result = subprocess.run([sys.executable, ROOT / "tools/report.py", in_process], capture_output=True, text=True,
                            check=False)
    assert (result.returncode, result.stderr) == (0, "")
    page = (in_process / "report.html").read_text()
    energy = summary(in_process)["strategies"][0]["total"]["measured_energy_j"]
    assert f"{energy:.2f}" in page


@pytest.mark.parametrize("first", ["ecu", "plant"])
def test_whoever_starts_first(programs, short, in_process, tmp_path, first):
    line = tmp_path / "line"
    start = {"ecu": lambda bus: programs.ecu(bus),
             "plant": lambda bus: programs.plant(short, "--bus", bus, "--output", tmp_path / "out")}
    second = "plant" if first == "ecu" else "ecu"
    started = {first: start[first](f"pty:{line}")}
    started[first].says(first)
    time.sleep(0.5)
    started[second] = start[second](f"slcan:{line}")
    assert_done(started["plant"])
    assert_same_drive(tmp_path / "out", in_process)
    assert_stopped(started["ecu"])


def test_the_plant_goes_and_comes_back(programs, short, in_process, tmp_path):
    """The ECU stays, finds the line again, and begins afresh when its power does."""
    plant, line = plant_with_lines(programs, short, 1, "--output", tmp_path / "out", "--pace", "paced")
    ecu = programs.ecu(f"slcan:{line}", "--retained", tmp_path / "record")
    time.sleep(2)
    plant.process.kill()
    plant.wait()
    assert not (tmp_path / "out" / LOG).exists()
    plant, line = plant_with_lines(programs, short, 1, "--output", tmp_path / "out")
    assert_done(plant)
    assert_same_drive(tmp_path / "out", in_process)
    assert_stopped(ecu)


# ---- an ECU that ends ----------------------------------------------------------------------------------------------

class Host:
    """A robot on three serial lines: for its ECU, for an operator, and for one who looks on."""

    def __init__(self, programs, scenario, *ecu_options):
        self._programs, self._ecu_options = programs, ecu_options
        self.plant, *lines = plant_with_lines(programs, scenario, 3, "--host", "--pace", "paced")
        self._ecu_line, self.line = lines[:2]
        self.onlooker = Stranger(lines[2])

    def start_ecu(self):
        return self._programs.ecu(f"slcan:{self._ecu_line}", *self._ecu_options)

    def drive(self, *route):
        points = " ".join(f"{x},{y}" for x, y in route)
        return self._programs.tool("tools/drive.py", "--bus", f"slcan:{self.line}", "--route", points)

    def stop(self):
        result = self.plant.stop()
        assert (result.returncode, result.stderr) == (0, "")
        return result.counts


def test_an_ecu_killed_while_driving(programs, short, tmp_path):
    """The robot goes on standing, and knows where it is."""
    host = Host(programs, short, "--retained", tmp_path / "record")
    ecu = host.start_ecu()
    drive = host.drive(*ROUTE)
    wait_until(lambda: host.onlooker.x() > WAY, "the robot is on its way")
    ecu.process.kill()
    ecu.process.wait()
    ecu = host.start_ecu()
    result = drive.wait()
    assert result.returncode == 1
    assert any(text in result.stderr for text in ("the ECU restarted (restart 1)", *CLIENT_LATE))
    wait_until(lambda: host.onlooker.ecu_state() == BALANCING, "the robot stands")
    assert WAY < host.onlooker.x() < ROUTE[0][0]
    assert_client_drives(lambda: host.drive(NEXT))
    assert host.stop()[SILENCES] == 0
    assert assert_stopped(ecu)["resets survived"] == 1


def killed_in_real_time(programs, scenario):
    """What the operator in jp-plant says to it, how often the bridges fell silent, and the resets survived."""
    plant, line = plant_with_lines(programs, scenario, 1, "--output", programs.folder, "--pace", "real-time")
    options = (f"slcan:{line}", "--real-time", "--retained", programs.folder / "record")
    ecu = programs.ecu(*options)
    time.sleep(3)
    ecu.process.kill()
    ecu.process.wait()
    ecu = programs.ecu(*options)
    result = plant.wait()
    return result.stderr, result.counts[SILENCES], assert_stopped(ecu)["resets survived"]


def test_an_ecu_killed_while_driving_in_real_time(tmp_path, short):
    """It is back before the bridges switch off, if the machine starts it soon enough."""
    outcomes = []
    for attempt in range(ATTEMPTS):
        folder = tmp_path / str(attempt)
        folder.mkdir()
        with Programs(folder) as programs:
            outcomes.append(killed_in_real_time(programs, short))
        if outcomes[-1] == ("leg 1: the ECU has restarted and knows no route\n", 0, 1):
            return
    pytest.fail(str(outcomes))


def test_an_ecu_that_does_not_come_back(programs, short, tmp_path):
    plant, line = plant_with_lines(programs, short, 1, "--output", tmp_path / "out", "--pace", "paced")
    ecu = programs.ecu(f"slcan:{line}")
    time.sleep(0.5)
    ecu.process.kill()
    assert_one_line_error(plant.wait(), f"no ECU answered for {PATIENCE} s", "start jp-ecu")
    assert list((tmp_path / "out").iterdir()) == []
    assert not line.is_symlink()


# ---- others on the bus ---------------------------------------------------------------------------------------------

def test_a_flood(programs, short, tmp_path):
    """Ten times what CAN can carry: the robot drives as always."""
    plant, ecu_line, line = plant_with_lines(programs, short, 2, "--output", tmp_path / "out")
    stranger = Stranger(line)
    ecu = programs.ecu(f"slcan:{ecu_line}")
    start, sent = time.monotonic(), 0
    while plant.running and time.monotonic() < start + LIMIT:
        sent += stranger.send(FOREIGN * 100)
        stranger.listen()
    seconds = time.monotonic() - start
    counts = assert_done(plant).counts
    assert sent / len(FOREIGN) / seconds > BUS_FRAMES
    assert counts["faults that the ECU reports, enum jp_fault"] == counts[SILENCES] == 0
    segments = summary(tmp_path / "out")["strategies"][0]["segments"]
    assert max(segment["end_error_m"] for segment in segments) < 0.1
    counts = assert_stopped(ecu)
    assert counts["frames unknown"] == 0xFFFF
    assert counts["frames malformed"] == counts["frames of another controller"] == 0


def test_strange_frames_are_counted(programs, short):
    plant, ecu_line, line = plant_with_lines(programs, short, 2, "--host=3", "--pace", "paced")
    stranger = Stranger(line)
    ecu = programs.ecu(f"slcan:{ecu_line}")
    wait_until(lambda: stranger.hears(ECU_STATUS), "an EcuStatus")
    for text, times in sum(STRANGE.values(), []):
        stranger.send(text * times)
    assert_done(plant)
    counts = assert_stopped(ecu)
    sent = {kind: sum(times for _, times in frames) for kind, frames in STRANGE.items()}
    assert counts["frames malformed"] == sum(sent[kind] for kind in MALFORMED)
    assert counts["frames unknown"] == sum(sent.values()) - counts["frames malformed"]
    assert counts["ticks without a sample"] == counts["commands rejected"] == 0


def test_a_second_controller_ends_a_mission(programs, short, tmp_path):
    plant, *lines = plant_with_lines(programs, short, 2, "--output", tmp_path / "out")
    ecus = [programs.ecu(f"slcan:{line}") for line in lines]
    assert_one_line_error(plant.wait(), "leg 1", "another controller", "take it off the bus")
    for ecu in ecus:
        assert assert_stopped(ecu)["frames of another controller"] > 0


def test_a_second_controller_does_not_disturb_the_first(programs, short):
    """It hears another one, and leaves the motors alone."""
    plant, *lines = plant_with_lines(programs, short, 4, "--host", "--pace", "paced")
    stranger = Stranger(lines[3])
    first = programs.ecu(f"slcan:{lines[0]}")
    client = programs.tool(THIRD_PARTY_CLIENT, "--bus", f"slcan:{lines[2]}", "2,0.5")
    wait_until(lambda: stranger.ecu_state() == DRIVING, "the robot drives")
    second = programs.ecu(f"slcan:{lines[1]}")
    result = client.wait()
    assert result.returncode == 0 or CLIENT_LATE[0] in result.stderr, result.stderr
    wait_until(lambda: stranger.ecu_state() == IDLE, "the second one is heard")
    counts = plant.stop().counts
    assert counts[SILENCES] == 0
    assert counts["motor commands out of sequence"] <= 1  # a first one, before it heard any
    for ecu in (first, second):
        assert assert_stopped(ecu)["frames of another controller"] == 0xFF


@pytest.mark.parametrize("tool", [["tools/drive.py", "--route", "0.5,0.1 1,0.5"],
                                  [THIRD_PARTY_CLIENT, "0.5,0.1", "1,0.5"]], ids=["drive", "third party"])
def test_a_client_drives_it(programs, short, tool):
    host = Host(programs, short)
    ecu = host.start_ecu()
    assert_client_drives(lambda: programs.tool(tool[0], "--bus", f"slcan:{host.line}", *tool[1:]))
    wait_until(lambda: host.onlooker.ecu_state() == BALANCING, "the robot stands")
    assert host.stop()["of those, commands that missed their deadline"] == 0
    assert assert_stopped(ecu)["frames with a wrong CRC"] == 0


# ---- bad input -----------------------------------------------------------------------------------------------------

@pytest.mark.parametrize(("bus", "parts"), [
    ("vcan0", ("vcan0: not a CAN bus",)),
    ("can:nowhere0", ("can:nowhere0",)),
    ("can:", ("1 to 15 characters",)),
    ("slcan:/dev/null", ("slcan:/dev/null: not a serial line",)),
    ("slcan:/nowhere/tty", ("slcan:/nowhere/tty", "No such file or directory", "plug in the adapter")),
    ("pty:/nowhere/plant", ("pty:/nowhere/plant", "No such file or directory")),
])
def test_a_bus_that_cannot_be_opened(short, tmp_path, bus, parts):
    other = tmp_path / "line"
    result = run("jp-plant", short, "--bus", f"pty:{other}", "--bus", bus, "--output", tmp_path / "out")
    assert_one_line_error(result, *parts)
    assert not other.is_symlink()
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("program", "arguments", "part"), [
    ("jp-plant", [], "a scenario and --bus are needed"),
    ("jp-plant", ["SCENARIO"], "a scenario and --bus are needed"),
    ("jp-plant", ["--bus", "pty:line"], "a scenario and --bus are needed"),
    ("jp-plant", ["SCENARIO", "SCENARIO", "--bus", "pty:line"], "one scenario only"),
    ("jp-plant", ["SCENARIO", "--bus", "pty:line"], "--output is needed, or --host"),
    ("jp-plant", ["SCENARIO", *["--bus", "pty:line"] * 5], "at most 4 buses"),
    ("jp-plant", ["SCENARIO", "--pace", "slow"], "not slow"),
    ("jp-plant", ["SCENARIO", "--host=0"], "seconds above 0, not 0"),
    ("jp-plant", ["SCENARIO", "--host=soon"], "seconds above 0, not soon"),
    ("jp-plant", ["SCENARIO", "--host=nan"], "seconds above 0, not nan"),
    ("jp-plant", ["SCENARIO", "--bus", "in-process", "--bus", "pty:line", "--output", "out"], "stands alone"),
    ("jp-plant", ["SCENARIO", "--bus", "pty:line", "--bus", "in-process", "--output", "out"], "stands alone"),
    ("jp-plant", ["SCENARIO", "--bus", "in-process", "--host"], "stands alone"),
    ("jp-plant", ["SCENARIO", "--bus", "in-process", "--pace", "real-time", "--output", "out"], "stands alone"),
    ("jp-ecu", [], "--bus is needed"),
    ("jp-ecu", ["--bus", "pty:line", "--model", "guessed"], "not guessed"),
    ("jp-ecu", ["--bus", "pty:line", "--energy", "heat"], "not heat"),
    ("jp-ecu", ["--bus", "pty:line", "--energy", "battery", "--model", "published"], "of the motors' energy"),
    ("jp-ecu", ["--bus", "pty:line", "--robot", "nobody"], "nobody"),
    ("jp-ecu", ["--bus", "pty:line", "more"], "arguments"),
])
def test_wrong_command_lines(short, tmp_path, program, arguments, part):
    before = sorted(tmp_path.iterdir())
    result = run(program, *(short if argument == "SCENARIO" else argument for argument in arguments), cwd=tmp_path)
    assert result.returncode == 2
    assert part in result.stderr.splitlines()[0]
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(("waypoints", "parts"), [
    ([(0.1 * number, 0.0) for number in range(1, 34)], ("33 after the start", "at most 32")),
    ([(0.0, 0.0)], ("waypoints[1]", "coincides")),
    ([(600.0, 0.0)], ("512",)),
])
def test_a_route_that_the_bus_does_not_carry(tmp_path, waypoints, parts):
    scenario = write_scenario(tmp_path / "short.cfg", *waypoints)
    result = run("jp-plant", scenario, "--bus", "in-process", "--output", tmp_path / "out")
    assert_one_line_error(result, *parts)
    assert not list(tmp_path.glob("out/*"))


def test_a_robot_without_gains(tmp_path, short):
    robot = tmp_path / "robot.cfg"
    robot.write_text((ROOT / "sim/robots/gao2018.cfg").read_text().replace('"gao2018"', '"nobody"'))
    short.write_text(short.read_text().replace(f"{ROOT}/sim/robots/gao2018.cfg", "robot.cfg"))
    assert_one_line_error(run("jp-plant", short, "--bus", "in-process", "--output", tmp_path / "out"), "nobody",
                          "make gains ROBOT=nobody")


def test_a_scenario_that_cannot_be_read(tmp_path):
    assert_one_line_error(run("jp-plant", "none.cfg", "--bus", f"pty:{tmp_path / 'line'}", "--host"), "none.cfg",
                          "No such file")
    assert list(tmp_path.iterdir()) == []


def test_output_that_cannot_be_written(short, tmp_path):
    place = tmp_path / "place"
    place.write_text("mine")
    assert_one_line_error(run("jp-plant", short, "--bus", "in-process", "--output", place), place, "--output")
    assert place.read_text() == "mine"


def test_a_record_that_is_none(tmp_path):
    other = tmp_path / "other"
    other.write_text("mine")
    for record, part in [(other, "4 bytes"), (tmp_path, "Is a directory"), ("/dev/null", "not a regular file"),
                         ("/proc/none", "No such file")]:
        result = run("jp-ecu", "--bus", f"pty:{tmp_path / 'line'}", "--retained", record)
        assert_one_line_error(result, record, part)
    assert other.read_text() == "mine"
    assert not (tmp_path / "line").is_symlink()


def test_a_record_of_another_ecu(programs, tmp_path):
    record = tmp_path / "record"
    ecu = programs.ecu(f"pty:{tmp_path / 'line'}", "--retained", record)
    ecu.says("jp-ecu")
    assert_one_line_error(run("jp-ecu", "--bus", f"pty:{tmp_path / 'other'}", "--retained", record), record,
                          "another process")
    assert_stopped(ecu)
