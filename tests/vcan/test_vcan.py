"""jp-ecu and jp-plant on virtual CAN interfaces, beside the tools of others.

For with_vcan.sh --interfaces 2: vcan0 stays as it is, vcan1 is switched off and removed. An emulated kernel is
slow, so the drives are short, and the first one's results are examined outside by test_vcan_results.py.
"""
import shutil
import subprocess

import pytest
from programs import (BUILD, CANDUMP, LIMIT, LOG, VCAN_RESULTS, Programs, assert_done, assert_one_line_error,
                      assert_stopped, summary, wait_until, write_vcan_scenario)
from simulated_time import Host

# Every 4 ms, which is the clock of an emulated kernel.
FLOOD = ["cangen", "vcan0", "-g", "4", "-c", "48", "-I", "555", "-L", "8"]
FRAMES = 100  # of a drive that is under way
FLOOD_MIN = 5  # frames a simulated ms: half of what CAN carries, and the robot's own take the other half
BEFORE, AFTER = "7FF#", "7FE#"  # frames of no message


@pytest.fixture(name="programs")
def fixture_programs(tmp_path):
    with Programs(tmp_path) as programs:
        yield programs


@pytest.fixture(name="short")
def fixture_short(tmp_path):
    return write_vcan_scenario(tmp_path / "short.cfg")


@pytest.fixture(name="vcan1")
def fixture_vcan1():
    """An interface that a test may switch off and remove."""
    yield "vcan1"
    subprocess.run(["ip", "link", "add", "vcan1", "type", "vcan"], stderr=subprocess.DEVNULL, check=False)
    ip_link("set", "vcan1", "up")


def ip_link(*arguments):
    subprocess.run(["ip", "link", *arguments], check=True)


def start_dump(programs, interface):
    """candump, which hears all from now on: it is sent to until it has said so."""
    dump = programs.start("candump", "-L", interface)
    wait_until(lambda: subprocess.run(["cansend", interface, BEFORE], check=True) and BEFORE in dump.out.read_text(),
               "candump hears")
    return dump


def stop_dump(dump, interface):
    """What it has heard meanwhile, to the end."""
    subprocess.run(["cansend", interface, AFTER], check=True)
    dump.says(AFTER)
    dump.stop()
    return [line for line in dump.out.read_text().splitlines() if not line.endswith((BEFORE, AFTER))]


def drive(programs, scenario, output, pace="lockstep"):
    """The counts of the plant and of the ECU."""
    ecu = programs.ecu("can:vcan0")
    plant = assert_done(programs.plant(scenario, "--bus", "can:vcan0", "--output", output, "--pace", pace))
    return plant.counts, assert_stopped(ecu)


def test_a_drive_is_dumped(programs, short, tmp_path):
    shutil.rmtree(VCAN_RESULTS, ignore_errors=True)
    dump = start_dump(programs, "vcan0")
    plant, ecu = drive(programs, short, tmp_path / "drive")
    lines = stop_dump(dump, "vcan0")
    assert plant["commands_late"] == ecu["samples_lost"] == 0
    shutil.copytree(tmp_path / "drive", VCAN_RESULTS)
    (VCAN_RESULTS / CANDUMP).write_text("".join(f"{line}\n" for line in lines))


def test_a_full_bus(programs, short, tmp_path):
    programs.start(*FLOOD)
    plant, ecu = drive(programs, short, tmp_path / "drive", "paced")
    assert ecu["unknown"] > FLOOD_MIN * ecu["ticks"]
    assert plant["bridge_silences"] == plant["ecu_faults"] == 0
    assert summary(tmp_path / "drive")["strategies"][0]["segments"][0]["end_error_m"] < 0.1


def test_random_frames_end_a_mission(programs, short, tmp_path):
    """As many as the kernel takes, those of the robot's own ids among them."""
    programs.ecu("can:vcan0")
    programs.start("cangen", "vcan0", "-g", "0", "-i")
    assert_one_line_error(programs.plant(short, "--bus", "can:vcan0", "--output", tmp_path / "drive",
                                          patience=10).wait())
    assert not (tmp_path / "drive" / LOG).exists()


def test_a_second_controller_ends_a_mission(programs, short, tmp_path):
    ecus = [programs.ecu("can:vcan0") for _ in range(2)]
    plant = programs.plant(short, "--bus", "can:vcan0", "--output", tmp_path / "drive")
    assert_one_line_error(plant.wait(), "another controller", "take it off the bus")
    for ecu in ecus:
        assert assert_stopped(ecu)["conflicts"] > 0


class SetOff(Exception):
    """The robot is on its way."""


def raise_when_driving(heard):
    if str(heard.get("RouteStatus", {}).get("State")) == "Driving":
        raise SetOff


def test_clients_command_it(programs, short):
    """One makes it set off, the project's stops it. Whole drives of both are on serial lines, in tests/sil."""
    with Host(programs, short, bus="can:vcan0") as host:
        ecu = host.start_ecu()
        with pytest.raises(SetOff):
            host.third_party_drive((0.5, 0.2), watch=raise_when_driving)
        host.stand()
        assert host.stop()["bridge_silences"] == 0
        assert assert_stopped(ecu)["crc_errors"] == 0


def wait_for_frames(dump):
    wait_until(lambda: len(dump.out.read_text().splitlines()) > FRAMES, "frames")


def assert_runs_on(program):
    with pytest.raises(subprocess.TimeoutExpired):
        program.process.wait(0.5)


def test_an_interface_goes_down_and_up(programs, short, vcan1):
    """Simulated time waits for it."""
    dump = start_dump(programs, vcan1)
    ecu = programs.ecu(f"can:{vcan1}")
    plant = programs.plant(short, "--bus", f"can:{vcan1}", "--host=2", "--pace", "paced")
    wait_for_frames(dump)
    ip_link("set", vcan1, "down")
    assert_runs_on(plant)
    assert_runs_on(ecu)
    ip_link("set", vcan1, "up")
    assert_done(plant)
    assert assert_stopped(ecu)["ticks"] >= 2000


def test_an_interface_that_does_not_come_back(programs, short, vcan1):
    """The plant gives up; the ECU goes on when there is an interface of that name again."""
    dump = start_dump(programs, vcan1)
    ecu = programs.ecu(f"can:{vcan1}")
    plant = programs.plant(short, "--bus", f"can:{vcan1}", "--host", "--pace", "paced", patience=10)
    wait_for_frames(dump)
    ip_link("del", vcan1)
    result = plant.wait()
    assert_one_line_error(result, "no ECU answered for 10 s", "the bus is down")
    ip_link("add", vcan1, "type", "vcan")
    ip_link("set", vcan1, "up")
    assert_done(programs.plant(short, "--bus", f"can:{vcan1}", "--host=0.1"))
    assert_stopped(ecu)


def test_the_link_itself():
    """In C, a program of its own."""
    result = subprocess.run([BUILD / "host-gcc/vcan_socketcan"], capture_output=True, text=True, check=False,
                            timeout=LIMIT)
    assert result.returncode == 0 and " 0 Failures 0 Ignored" in result.stdout, result.stdout + result.stderr
