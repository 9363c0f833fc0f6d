"""What test_vcan.py has left, outside the emulated kernel: the drive over vcan is that in one process and that over a
serial line, bit for bit, and its candump log becomes a report."""
import subprocess
import sys

import pytest
from programs import (CANDUMP, ROOT, VCAN_RESULTS, Programs, assert_done, assert_same_drive, assert_stopped,
                      drive_in_process, summary, wait_until, write_vcan_scenario)


@pytest.fixture(name="short")
def fixture_short(tmp_path):
    return write_vcan_scenario(tmp_path / "short.cfg")


def run_tool(name, *arguments):
    result = subprocess.run([sys.executable, "-m", f"tools.{name}", *arguments], cwd=ROOT, capture_output=True,
                            text=True, check=False)
    assert (result.returncode, result.stderr) == (0, "")


def test_the_drive_is_that_in_one_process(short, tmp_path):
    assert_same_drive(VCAN_RESULTS, drive_in_process(short, tmp_path / "drive"))


def test_the_drive_is_that_over_a_serial_line(short, tmp_path):
    with Programs(tmp_path) as programs:
        line = tmp_path / "line"
        plant = programs.plant(short, "--bus", f"pty:{line}", "--output", tmp_path / "drive")
        wait_until(line.is_symlink, "the line of jp-plant")
        ecu = programs.ecu(f"slcan:{line}")
        assert_done(plant)
        assert_stopped(ecu)
    assert_same_drive(VCAN_RESULTS, tmp_path / "drive")


def test_the_candump_log_becomes_a_report(tmp_path):
    run_tool("operate.can_report", VCAN_RESULTS / CANDUMP, tmp_path)
    told, = summary(tmp_path)["strategies"][0]["segments"]
    known, = summary(VCAN_RESULTS)["strategies"][0]["segments"]
    for key in ("planned_energy_j", "measured_energy_j", "battery_energy_j"):
        assert told[key] == pytest.approx(known[key], abs=1e-4)
    run_tool("report.report", tmp_path)
    assert f"{known['measured_energy_j']:.2f}" in (tmp_path / "report.html").read_text()
