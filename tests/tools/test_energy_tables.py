"""The committed energy models are those that `make identify` makes."""
import dataclasses
import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import ROBOTS, ROOT, robot_text, run_tool

from tools.design import identify, robot_json

JP_IDENTIFY = Path(os.environ.get("JP_BUILD", ROOT / "build")).resolve() / "bin" / "jp-identify"

# Another libm may round the simulated robot's sines differently; the fit moves by less than this share.
TOLERANCE = 1e-4

# J, of predictions around 60 J, for settling times from 3 s to 9 s.
SETTLING_TIME_MATTERS = 0.02


def integers(text):
    body = text[text.index("= {"):]
    return [int(number) for number in re.findall(r"(-?\d+),\s*/\*", body)]


def spread_over_settling_times(robot, energy, directory):
    """Largest change of a prediction, J: Ts only says where the line of steady energy starts."""
    about = robot_json.from_text(robot, robot_text(robot))
    experiments = identify.read_experiments(directory, robot, energy)
    predictions = [identify.identify(about, dataclasses.replace(experiments, settling_time=seconds)).validation.absolute
                   for seconds in (3.0, experiments.settling_time, 9.0)]
    return np.ptp(predictions, axis=0).max()


def check_model(robot, energy, name, directory, tables):
    result = run_tool("design.identify", ROOT / "sim" / "robots" / f"{robot}.cfg", "--energy", energy, "--jp-robot",
                      JP_IDENTIFY.with_name("jp-robot"), "--experiments", directory, "--tables", tables)
    assert result.returncode == 0, result.stderr
    made = integers((tables / f"{name}.c").read_text(encoding="utf-8"))
    committed = integers((ROOT / "src" / "tables" / f"{name}.c").read_text(encoding="utf-8"))
    assert len(committed) == 21
    largest = max(map(abs, committed))
    assert made == pytest.approx(committed, rel=TOLERANCE, abs=TOLERANCE * largest), "run make identify"
    assert spread_over_settling_times(robot, energy, directory) <= SETTLING_TIME_MATTERS


@pytest.mark.parametrize("robot", ROBOTS)
def test_models_are_fresh_and_do_not_hang_on_the_settling_time(robot, tmp_path):
    subprocess.run([JP_IDENTIFY, ROOT / "sim" / "robots" / f"{robot}.cfg", "--output", tmp_path], check=True,
                   capture_output=True)
    check_model(robot, "motor", f"energy_{robot}", tmp_path, tmp_path)
    check_model(robot, "battery", f"energy_{robot}_battery", tmp_path, tmp_path)
