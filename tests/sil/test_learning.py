"""What jp-ecu learns while it drives a robot on a bus: told there, kept over restarts, refused where it does not fit,
and noticed when the ground changes."""
import random
import re

import pytest
from conftest import run
from programs import ROOT, Programs, assert_done, assert_one_line_error, assert_stopped, write_scenario
from simulated_time import Host
from test_bus import plant_with_lines

from tools.operate import can_report

ROUTE = [(2.0, 0.5), (3.0, 2.0), (2.0, 3.0)]
NOTHING, TAKEN, OTHER_VERSION, OTHER_ROBOT, OTHER_TABLES, DAMAGED = range(6)
LEARNED_FROM, LEFT_OUT = "learned_from", "left_out"
RECORD_LENGTH = 120  # B


@pytest.fixture(name="programs")
def fixture_programs(tmp_path):
    with Programs(tmp_path) as programs:
        yield programs


@pytest.fixture(name="drive")
def fixture_drive(programs, tmp_path):
    """Drives a route; gives what the ECU counted, and what it said."""
    def drive(*options, robot="courier24", route=ROUTE):
        scenario = write_scenario(tmp_path / "route.cfg", *route, robot=robot)
        plant, line = plant_with_lines(programs, scenario, 1, "--output", tmp_path / "out", "--frames")
        ecu = programs.ecu(f"slcan:{line}", "--robot", robot, *options)
        assert_done(plant)
        return assert_stopped(ecu), ecu.out.read_text()
    return drive


def told(tmp_path):
    """(Version, Stored) of each LearnerStatus in the last drive."""
    frames = re.findall(r" 193#(\w{16})\n", (tmp_path / "out/frames.log").read_text())
    numbers = [int.from_bytes(bytes.fromhex(frame), "little") for frame in frames]
    return [(number & 0xFFFF, number >> 45 & 7) for number in numbers]


def versions(tmp_path):
    """That the bus told, in their order."""
    return list(dict.fromkeys(version for version, _ in told(tmp_path)))


# ---- learning ------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize(("robot", "options"), [("courier24", ()), ("gao2018", ()),
                                                ("courier24", ("--energy", "battery"))])
def test_each_segment_of_a_route_is_learned_from(drive, tmp_path, robot, options):
    counts, _ = drive(*options, robot=robot)
    assert versions(tmp_path) == [0, 1, 2, 3]
    assert {stored for _, stored in told(tmp_path)} == {NOTHING}
    assert (counts[LEARNED_FROM], counts[LEFT_OUT]) == (len(ROUTE), 0)


def test_a_model_without_tables_is_not_learned(drive, tmp_path):
    counts, _ = drive("--model", "published", "--parameters", tmp_path / "parameters")
    assert told(tmp_path) == []
    assert counts[LEARNED_FROM] == counts[LEFT_OUT] == 0


# ---- persistence ---------------------------------------------------------------------------------------------------

def test_a_restart_goes_on_from_what_was_learned(drive, tmp_path):
    kept = tmp_path / "parameters"
    _, said = drive("--parameters", kept)
    assert f"{kept}: nothing learned yet" in said
    assert kept.stat().st_size == RECORD_LENGTH
    _, said = drive("--parameters", kept)
    assert f"{kept}: learned from 3 segments" in said
    assert told(tmp_path)[0] == (3, TAKEN)
    assert versions(tmp_path) == [3, 4, 5, 6]
    assert [path.name for path in tmp_path.glob("parameters*")] == ["parameters"]


def scale_of(record):
    """The gyro's scale and its deviation that are kept, shares."""
    words = record.read_bytes()[-8:]
    return tuple(int.from_bytes(words[i:i + 4], "little", signed=True) / 2**30 for i in (0, 4))


def test_a_restart_knows_the_scale_of_the_gyro_better(drive, tmp_path):
    """Its file says: 1 %, which is the truth, too."""
    kept = tmp_path / "parameters"
    drive("--parameters", kept, robot="burger", route=[(1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)])
    error, deviation = scale_of(kept)
    assert error == pytest.approx(0.01, abs=3 * deviation)
    drive("--parameters", kept, robot="burger", route=[(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)])
    again, surer = scale_of(kept)
    assert 0 < surer < deviation < 0.01
    assert again == pytest.approx(0.01, abs=3 * surer)
    assert 0.005 < again


def test_what_was_learned_is_kept_when_the_motors_are_switched_off(programs, tmp_path):
    """Then power may fail."""
    kept, target = tmp_path / "parameters", ROUTE[0]
    with Host(programs, write_scenario(tmp_path / "route.cfg", target)) as host:
        ecu = host.start_ecu("--parameters", kept)
        host.drive(target)
        assert "nothing learned yet" in ecu.out.read_text()
        before = kept.read_bytes()
        host.off()
        host.time.run(until=lambda: kept.read_bytes() != before)
        ecu.process.kill()
        ecu.process.wait()
        again = host.start_ecu("--parameters", kept)
        again.says("learned from 1 segment")
        assert_stopped(again)


def test_what_another_robot_learned_is_refused_and_named(drive, tmp_path):
    kept = tmp_path / "parameters"
    drive("--parameters", kept, robot="gao2018")
    counts, said = drive("--parameters", kept)
    assert f"{kept}: not used: of another robot; the built-in model serves" in said
    assert told(tmp_path)[0] == (0, OTHER_ROBOT)
    assert counts[LEARNED_FROM] == len(ROUTE)


def test_what_was_learned_of_the_other_energy_is_refused_and_named(drive, tmp_path):
    kept = tmp_path / "parameters"
    drive("--parameters", kept)
    _, said = drive("--parameters", kept, "--energy", "battery")
    assert f"{kept}: not used: learned with other tables; the built-in model serves" in said
    assert told(tmp_path)[0] == (0, OTHER_TABLES)


@pytest.mark.parametrize(("record", "stored", "reason"), [
    (b"\x01" + bytes(99), OTHER_VERSION, "of another version of the firmware"),
    (b"\x03\x00\x00\x00" + bytes(3), DAMAGED, "damaged"),
    (b"\x03\x00\x00\x00" + bytes(RECORD_LENGTH - 4), OTHER_ROBOT, "of another robot"),
    (bytes(1000), OTHER_VERSION, "of another version"),
])
def test_a_file_that_is_no_record_of_this_robot(drive, tmp_path, record, stored, reason):
    kept = tmp_path / "parameters"
    kept.write_bytes(record)
    _, said = drive("--parameters", kept, route=[(1.0, 0.2)])
    assert f"{kept}: not used: {reason}" in said
    assert told(tmp_path)[0] == (0, stored)
    assert kept.stat().st_size == RECORD_LENGTH


def test_files_that_cannot_be_read_or_written(tmp_path):
    for path, part in [(tmp_path, "Is a directory"), (tmp_path / "none/parameters", "No such file"),
                       (tmp_path / ("long" * 100), "name too long")]:
        result = run("jp-ecu", "--bus", f"pty:{tmp_path / 'line'}", "--parameters", path)
        assert_one_line_error(result, part, "--parameters")
    assert list(tmp_path.iterdir()) == []


# ---- changes -------------------------------------------------------------------------------------------------------

def rough_robot(folder):
    """The courier on ground with three times the rolling resistance."""
    smooth = (ROOT / "sim/robots/courier24.cfg").read_text()
    rough = folder / "rough.cfg"
    rough.write_text(re.sub(r"(friction_nm_s_per_rad = )0\.004;", r"\g<1>0.012;", smooth))
    assert rough.read_text() != smooth
    return rough


def test_a_change_of_surface_is_noticed_and_told(programs, drive, tmp_path):
    generator = random.Random(1)
    route = [(1.2 * i, generator.uniform(-0.6, 0.6)) for i in range(1, 15)]
    drive("--parameters", tmp_path / "parameters", route=route)
    scenario = write_scenario(tmp_path / "route.cfg", *route, robot="courier24")
    rough_robot(tmp_path)
    scenario.write_text(re.sub(r'robot = ".*"', 'robot = "rough.cfg"', scenario.read_text()))
    plant, line = plant_with_lines(programs, scenario, 1, "--output", tmp_path / "out", "--frames")
    ecu = programs.ecu(f"slcan:{line}", "--robot", "courier24", "--parameters", tmp_path / "parameters")
    assert_done(plant)
    changes = assert_stopped(ecu)["changes"]
    assert [change["cause"] for change in changes[:2]] == ["none", "ground"]
    assert 1.5 < changes[1]["friction"] < 3.5 and 0 < changes[1]["friction_deviation"] < 0.5
    said = ecu.out.read_text()
    assert said.count(" s: surface or robot changed, learning anew\n") == 1
    assert f" s: surface changed, friction {changes[1]['friction']:.2f} ± {changes[1]['friction_deviation']:.2f} " \
           "of the robot file's\n" in said
    # The log of the bus tells the same, as far as its signals resolve it.
    _, heard = can_report.convert(tmp_path / "out/frames.log")
    assert [change["cause"] for change in heard.noticed] == [change["cause"] for change in changes]
    assert heard.noticed[1]["friction"] == pytest.approx(changes[1]["friction"], abs=0.01)
