"""What the tests of the host programs share: where they are, a short scenario, and how a failure must look."""
import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BIN = Path(os.environ.get("JP_BUILD", ROOT / "build")).resolve() / "bin"

SCENARIO = """\
name = "short";
robot = "robot.cfg";
energy_model = "identified";
seed = 1;
waypoints = ( [0.0, 0.0], [2.0, 0.5], [3.0, 2.0] );
"""


def run(program, *arguments, **options):
    return subprocess.run([BIN / program, *map(str, arguments)], capture_output=True, text=True, check=False,
                          timeout=120, **options)


def assert_one_line_error(result, *parts):
    """Exit status 2 and a single line on stderr that holds all parts."""
    assert result.returncode == 2, result.stdout + result.stderr
    lines = result.stderr.splitlines()
    assert len(lines) == 1, result.stderr
    for part in parts:
        assert str(part) in lines[0], lines[0]


@pytest.fixture
def scenario(tmp_path):
    """A short scenario and its robot file in a folder of their own."""
    folder = tmp_path / "in"
    folder.mkdir()
    shutil.copy(ROOT / "sim" / "robots" / "gao2018.cfg", folder / "robot.cfg")
    path = folder / "short.cfg"
    path.write_text(SCENARIO)
    return path
