"""The processor in the loop: the image in QEMU drives the simulated robot over SLCAN as the host's program does."""
import subprocess

import pytest
from emulator import Emulator
from programs import (LIMIT, ROOT, Programs, assert_done, assert_same_drive, drive_in_process,
                      write_scenario)

ROUTE = [(0.25, 0.1)]
LONGER = [(1.0, 0.2), (1.5, 1.0)]
MID_DRIVE = 1000  # ticks; the first leg begins at 763 and lasts 2700


@pytest.fixture(name="programs")
def fixture_programs(tmp_path):
    with Programs(tmp_path) as programs:
        yield programs


@pytest.mark.parametrize(("board", "robot"), [
    ("stm32f405", "courier24"), ("stm32f405", "zhang2018"), ("stm32f405", "burger"),
    ("mps2", "courier24"), ("mps2", "burger")])
def test_the_image_drives_as_the_program_does(programs, tmp_path, board, robot):
    """The balancer whose controller uses all of its parts, and both that their sides steer."""
    scenario = write_scenario(tmp_path / "short.cfg", *ROUTE, robot=robot)
    expected = drive_in_process(scenario, tmp_path / "in-process")
    with Emulator(tmp_path, robot, board=board) as emulator:
        plant = programs.plant(scenario, "--bus", f"slcan:{emulator.line}", "--output", tmp_path / "pil", "--frames")
        assert_done(plant)
    assert_same_drive(expected, tmp_path / "pil")


@pytest.mark.parametrize("board", ["stm32f405", "mps2"])
def test_a_crash_in_mid_drive_ends_in_a_balanced_stand(programs, tmp_path, board):
    """The program goes astray: the fault handler resets, and the robot goes on from its record before the bridges fall
    silent. The operator sees that the controller has restarted."""
    scenario = write_scenario(tmp_path / "longer.cfg", *LONGER)
    with Emulator(tmp_path, "gao2018", board=board, debug=True) as emulator:
        plant = programs.plant(scenario, "--bus", f"slcan:{emulator.line}", "--output", tmp_path / "pil")
        with emulator.crash(MID_DRIVE, plant):
            result = plant.wait()
    assert result.stderr == "leg 1: the ECU has restarted and knows no route\n"
    assert result.counts["bridge_silences"] == 0
    assert result.counts["ecu_faults"] == 0
    # The counter of 4 bits begins anew: in sequence by chance, elsewhere, or just before the last one, which is then
    # repeated.
    assert result.counts["motor_sequence_errors"] <= 2


@pytest.mark.parametrize(("robot", "model", "says"), [
    ("gao2018", 'identified";\nenergy = "battery', 'energy = "battery", but the image has the model of the motors'),
    ("gao2018", "published", 'energy_model = "published", but the image has the identified one'),
    ("hoverbot", "identified", "is not there; run make firmware ROBOT=hoverbot"),
])
def test_a_scenario_that_the_image_cannot_drive_is_refused(tmp_path, robot, model, says):
    scenario = write_scenario(tmp_path / "short.cfg", *ROUTE, robot=robot)
    scenario.write_text(scenario.read_text().replace('"identified"', f'"{model}"'))
    result = subprocess.run([ROOT / "tools/operate/bus_mission.sh", "pil", scenario, tmp_path / "out"],
                            capture_output=True,
                            text=True, check=False, timeout=LIMIT)
    assert result.returncode == 2
    assert says in result.stderr
    assert len(result.stderr.splitlines()) == 1
