"""jp-ecu and jp-plant as two processes on pseudo-terminals: the same drive as in one process, whatever comes, goes or
cuts in on the bus, and what each says when it cannot go on."""
import os
import subprocess
import sys
import termios
import tty
from contextlib import suppress

import pytest
from conftest import run
from programs import (LOG, ROOT, Programs, assert_done, assert_one_line_error, assert_same_drive,
                      assert_stopped, drive_in_process, summary, wait_until, with_battery_energy, write_scenario)
from simulated_time import Host, SimulatedTime

from tools.operate.can_client import RobotError

ROUTE = [(2.0, 0.5), (3.0, 2.0)]
FAR = (200.0, 0.0)
WAY = 0.3  # m
NEXT = (1.0, 0.4)  # after a restart on the way to the first
PATIENCE = 10  # s that jp-plant waits for an ECU, of the wall's clock
NOTHING_WRONG = ("samples_lost", "crc_errors", "sequence_errors", "malformed", "unknown", "conflicts", "send_errors",
                 "rejected", "operator_timeouts", "bus_offs")

# As SLCAN writes them.
ECU_STATUS, LOSSES, POSE = b"t1808", b"t1828", b"t1848"
FOREIGN = b"t55581122334455667788\r"
CROWD = 90  # a tick: ten times what CAN carries at 1 Mbit/s
STRANGE = {"too short": [(b"t100300A0B0\r", 4), (b"t0220\r", 1)], "too long": [(b"t10080000000000000000\r", 6)],
           "unknown": [(b"t5551AB\r", 10), (b"t7F11AB\r", 5)], "remote": [(b"r1004\r", 7)],
           "extended": [(b"T000000100\r", 3), (b"R1FFFFFFF8\r", 2)]}
MALFORMED = ("too short", "too long")


@pytest.fixture(name="programs")
def fixture_programs(tmp_path):
    with Programs(tmp_path) as programs:
        yield programs


@pytest.fixture(name="short")
def fixture_short(tmp_path):
    return write_scenario(tmp_path / "short.cfg", *ROUTE)


@pytest.fixture(name="far")
def fixture_far(tmp_path):
    """A drive that does not end before the test."""
    return write_scenario(tmp_path / "far.cfg", FAR)


@pytest.fixture(name="in_process")
def fixture_in_process(tmp_path, short):
    """The short drive within one process, which all others must equal."""
    return drive_in_process(short, tmp_path / "in-process")


def plant_with_lines(programs, scenario, count, *options, **others):
    """jp-plant as the adapter of `count` serial lines, once they are there."""
    lines = [programs.folder / f"line{number}" for number in range(count)]
    plant = programs.plant(scenario, *(part for line in lines for part in ("--bus", f"pty:{line}")), *options,
                           **others)
    wait_until(lambda: all(line.is_symlink() for line in lines) or not plant.running, "the lines of jp-plant")
    return plant, *lines


def wait_until_on_the_way(plant, line):
    """By what an onlooker hears."""
    onlooker = Stranger(line)
    wait_until(lambda: not plant.running or onlooker.x() > WAY, "the robot is on its way")
    assert plant.running, plant.err.read_text()


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

    def unknown_frames(self):
        """That the ECU has counted."""
        return self.next(LOSSES) >> 16 & 0xFFFF

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
    assert counts["commands_late"] == 0
    counts = assert_stopped(ecu)
    assert [counts[name] for name in NOTHING_WRONG] == [0] * len(NOTHING_WRONG)
    assert counts["ticks"] > 5000


@pytest.mark.parametrize("robot", ["zhang2018", "burger"])
def test_robots_that_their_sides_steer(programs, tmp_path, robot):
    """The corner is a turn, and the leg's energy what it takes."""
    scenario = write_scenario(tmp_path / "short.cfg", (0.6, 0.0), (0.6, 0.3), robot=robot)
    expected = drive_in_process(scenario, tmp_path / "in-process")
    plant, line = plant_with_lines(programs, scenario, 1, "--output", tmp_path / "serial")
    ecu = programs.ecu(f"slcan:{line}", "--robot", robot)
    counts = assert_done(plant).counts
    assert_same_drive(tmp_path / "serial", expected)
    assert counts["ecu_faults"] == counts["bridge_silences"] == 0
    counts = assert_stopped(ecu)
    assert [counts[name] for name in NOTHING_WRONG] == [0] * len(NOTHING_WRONG)
    assert counts["learned_from"] + counts["left_out"] == 2
    for segment in summary(expected)["strategies"][0]["segments"]:
        assert segment["measured_energy_j"] == segment["battery_energy_j"] > 0
        assert segment["measured_energy_j"] == pytest.approx(segment["plant_energy_j"], rel=0.1)
        assert segment["end_error_m"] < 0.4  # inside the corner


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


@pytest.mark.parametrize(("robot", "of_battery"), [("gao2018", False), ("courier24", True)])
def test_a_scenario_that_ends_at_a_stand_counts_the_braking(tmp_path, robot, of_battery):
    scenario = write_scenario(tmp_path / "short.cfg", *ROUTE, robot=robot)
    if of_battery:
        with_battery_energy(scenario)
    before = summary(drive_in_process(scenario, tmp_path / "moving"))["strategies"][0]
    scenario.write_text(scenario.read_text() + 'end = "stand";\n')
    stood = drive_in_process(scenario, tmp_path / "stood")
    after = summary(stood)["strategies"][0]
    braking, total = after["braking"], after["total"]
    assert "braking" not in before and before["segments"] == after["segments"]
    for key in ("measured_energy_j", "plant_energy_j", "battery_energy_j", "duration_s"):
        assert total[key] == pytest.approx(sum(segment[key] for segment in after["segments"]) + braking[key])
    assert braking["measured_energy_j"] == pytest.approx(braking["plant_energy_j"], rel=2e-2)
    assert (braking["measured_energy_j"] == braking["battery_energy_j"]) == of_battery
    assert 0.5 < braking["duration_s"] < 10 and braking["end_error_m"] < 0.3
    rows = (stood / LOG).read_text().splitlines()
    last = dict(zip(rows[0].split(","), map(float, rows[-1].split(",")), strict=True))
    assert last["t_s"] == pytest.approx(total["duration_s"], abs=0.03)
    assert abs(last["speed_m_s"]) < 0.01 and last["energy_j"] == pytest.approx(total["measured_energy_j"], abs=1)


def test_the_report_takes_it(in_process):
    result = subprocess.run([sys.executable, "-m", "tools.report.report", in_process], cwd=ROOT, capture_output=True,
                            text=True, check=False)
    assert (result.returncode, result.stderr) == (0, "")
    page = (in_process / "report.html").read_text()
    energy = summary(in_process)["strategies"][0]["total"]["measured_energy_j"]
    assert f"{energy:.2f}" in page


def test_an_ecu_says_that_its_line_is_gone_and_that_it_is_back(programs, tmp_path):
    scenario = write_scenario(tmp_path / "short.cfg", (0.2, 0.0))
    plant, line = plant_with_lines(programs, scenario, 1, "--output", tmp_path / "first")
    ecu = programs.ecu(f"slcan:{line}")
    assert_done(plant)
    ecu.says(f"slcan:{line} is down or gone; waiting for it")
    plant, line = plant_with_lines(programs, scenario, 1, "--output", tmp_path / "second")
    ecu.says(f"slcan:{line} is back")
    assert_done(plant)
    assert_stopped(ecu)


@pytest.mark.parametrize("first", ["ecu", "plant"])
def test_whoever_starts_first(programs, short, in_process, tmp_path, first):
    line = tmp_path / "line"
    start = {"ecu": lambda bus: programs.ecu(bus),
             "plant": lambda bus: programs.plant(short, "--bus", bus, "--output", tmp_path / "out")}
    second = "plant" if first == "ecu" else "ecu"
    started = {first: start[first](f"pty:{line}")}
    started[first].opens(line)
    started[second] = start[second](f"slcan:{line}")
    assert_done(started["plant"])
    assert_same_drive(tmp_path / "out", in_process)
    assert_stopped(started["ecu"])


def test_the_plant_goes_and_comes_back(programs, short, far, in_process, tmp_path):
    """The ECU stays, finds the line again, and begins afresh when its power does."""
    plant, line, other = plant_with_lines(programs, far, 2, "--output", tmp_path / "out")
    ecu = programs.ecu(f"slcan:{line}", "--retained", tmp_path / "record")
    wait_until_on_the_way(plant, other)
    plant.process.kill()
    plant.wait()
    assert not (tmp_path / "out" / LOG).exists()
    plant, line = plant_with_lines(programs, short, 1, "--output", tmp_path / "out")
    assert_done(plant)
    assert_same_drive(tmp_path / "out", in_process)
    assert_stopped(ecu)


# ---- an ECU that ends ----------------------------------------------------------------------------------------------

@pytest.fixture(name="host")
def fixture_host(programs, short):
    with Host(programs, short) as host:
        yield host


def x_of(state):
    """Where the ECU thinks to be, m."""
    return state.get("Pose", "X") or 0.0


def test_an_ecu_killed_while_driving(host, tmp_path):
    """The robot goes on standing, and knows where it is. Whether an ECU is back in real time before the bridges switch
    off depends on the machine."""
    ecus = [host.start_ecu("--retained", tmp_path / "record")]

    def kill_on_the_way(state):
        if x_of(state) > WAY and len(ecus) == 1:
            ecus[0].process.kill()
            ecus[0].process.wait()
            ecus.append(host.start_ecu("--retained", tmp_path / "record"))
    with pytest.raises(RobotError, match=r"the ECU restarted \(restart 1\)"):
        host.drive(*ROUTE, watch=kill_on_the_way)
    state = host.listen_until(lambda state: state.state == "Standing" and "Pose" in state.latest)
    assert WAY < x_of(state) < ROUTE[0][0]
    host.drive(NEXT)
    assert host.stop()["bridge_silences"] == 0
    assert assert_stopped(ecus[1])["resets"] == 1


def test_an_ecu_that_does_not_come_back(programs, far, tmp_path):
    plant, line, other = plant_with_lines(programs, far, 2, "--output", tmp_path / "out", patience=PATIENCE)
    ecu = programs.ecu(f"slcan:{line}")
    wait_until_on_the_way(plant, other)
    ecu.process.kill()
    assert_one_line_error(plant.wait(), f"no ECU answered for {PATIENCE} s", "start jp-ecu")
    assert list((tmp_path / "out").iterdir()) == []
    assert not line.is_symlink()


# ---- others on the bus ---------------------------------------------------------------------------------------------

def test_a_flood(programs, tmp_path):
    """The robot drives as always."""
    scenario = write_scenario(tmp_path / "one.cfg", (0.5, 0.2))
    plant, line = plant_with_lines(programs, scenario, 1, "--output", tmp_path / "out")
    with SimulatedTime(line, crowd=FOREIGN * CROWD) as passing:
        ecu = programs.ecu(f"slcan:{passing.new_line()}")
        passing.run_until_hang_up()
        counts = assert_done(plant).counts
        assert counts["ecu_faults"] == counts["bridge_silences"] == 0
        segments = summary(tmp_path / "out")["strategies"][0]["segments"]
        assert max(segment["end_error_m"] for segment in segments) < 0.1
        counts = assert_stopped(ecu)
    assert counts["unknown"] == 0xFFFF
    assert counts["malformed"] == counts["conflicts"] == 0


def test_strange_frames_are_counted(programs, short):
    sent = {kind: sum(times for _, times in frames) for kind, frames in STRANGE.items()}
    malformed = sum(sent[kind] for kind in MALFORMED)
    unknown = sum(sent.values()) - malformed
    plant, ecu_line, line = plant_with_lines(programs, short, 2, "--host")
    stranger = Stranger(line)
    ecu = programs.ecu(f"slcan:{ecu_line}")
    wait_until(lambda: stranger.hears(ECU_STATUS), "an EcuStatus")
    for text, times in sum(STRANGE.values(), []):
        stranger.send(text * times)
    wait_until(lambda: stranger.unknown_frames() == unknown, "all of them have arrived")
    plant.stop()
    counts = assert_stopped(ecu)
    assert (counts["malformed"], counts["unknown"]) == (malformed, unknown)
    assert counts["samples_lost"] == counts["rejected"] == 0


def test_a_second_controller_ends_a_mission(programs, short, tmp_path):
    plant, *lines = plant_with_lines(programs, short, 2, "--output", tmp_path / "out")
    ecus = [programs.ecu(f"slcan:{line}") for line in lines]
    assert_one_line_error(plant.wait(), "leg 1", "another controller", "take it off the bus")
    for ecu in ecus:
        assert assert_stopped(ecu)["conflicts"] > 0


def test_a_second_controller_does_not_disturb_the_first(host):
    """It hears another one, and leaves the motors alone."""
    ecus = [host.start_ecu()]

    def start_another(heard):
        if len(ecus) == 1 and str(heard.get("RouteStatus", {}).get("State")) == "Driving":
            ecus.append(host.start_ecu(line=host.time.new_line()))
    host.third_party_drive((0.8, 0.2), watch=start_another)
    host.listen_until(lambda state: state.state == "Idle")
    counts = host.stop()
    assert counts["bridge_silences"] == 0
    assert counts["motor_sequence_errors"] <= 1  # a first one, before it heard any
    for ecu in ecus:
        assert assert_stopped(ecu)["conflicts"] == 0xFF


@pytest.mark.parametrize("drive", [Host.drive, Host.third_party_drive], ids=["drive", "third party"])
def test_a_client_drives_it(host, drive):
    ecu = host.start_ecu()
    drive(host, (0.5, 0.1), (1.0, 0.5))
    assert x_of(host.listen_until(lambda state: state.state == "Standing" and x_of(state) > 0)) > 0.8
    assert host.stop()["commands_late"] == 0
    assert assert_stopped(ecu)["crc_errors"] == 0


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
    ("jp-plant", ["SCENARIO", *["--bus", "pty:line"] * 5], "at most 4 buses"),
    ("jp-plant", ["SCENARIO", "--pace", "slow"], "not slow"),
    ("jp-plant", ["SCENARIO", "--host=0"], "--host 0: must be a number from 0.001"),
    ("jp-plant", ["SCENARIO", "--host=soon"], "--host soon: must be a number from 0.001"),
    ("jp-plant", ["SCENARIO", "--host=nan"], "--host nan: must be a number from 0.001"),
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


@pytest.mark.parametrize("waypoint", ["[1.0, 0.5, 30.0]", "[1.0, 0.5, 30.0, 0.4]"])
def test_a_heading_or_speed_is_not_left_out(tmp_path, waypoint):
    scenario = write_scenario(tmp_path / "short.cfg", (0.5, 0.2), (1.0, 0.5), (2.0, 0.5))
    scenario.write_text(scenario.read_text().replace("[1.0, 0.5]", waypoint))
    result = run("jp-plant", scenario, "--bus", "in-process", "--output", tmp_path / "out")
    assert_one_line_error(result, scenario, "waypoints[2]", "heading or speed", "carries points alone", "write [x, y]")
    assert not (tmp_path / "out").exists()


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
    ecu.opens(tmp_path / "line")
    assert_one_line_error(run("jp-ecu", "--bus", f"pty:{tmp_path / 'other'}", "--retained", record), record,
                          "another process")
    assert_stopped(ecu)
