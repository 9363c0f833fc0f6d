"""What the tests of the host programs share: where they are, a short scenario, and how a failure must look."""
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from programs import BIN, LIMIT, ROOT, assert_one_line_error, stay_on_one_cpu  # noqa: E402, F401 - for the tests

SCENARIO = """\
name = "short";
robot = "robot.cfg";
energy_model = "identified";
seed = 1;
waypoints = ( [0.0, 0.0], [2.0, 0.5], [3.0, 2.0] );
"""


@pytest.fixture(scope="session", autouse=True)
def fixture_one_cpu():
    stay_on_one_cpu()


def run(program, *arguments, **options):
    return subprocess.run([BIN / program, *map(str, arguments)], capture_output=True, text=True, check=False,
                          timeout=LIMIT, **options)


def fill_disk(path):
    """From now on the disk is full for whoever writes there."""
    path.unlink(missing_ok=True)
    path.symlink_to("/dev/full")


@pytest.fixture
def scenario(tmp_path):
    """A short scenario and its robot file in a folder of their own."""
    folder = tmp_path / "in"
    folder.mkdir()
    shutil.copy(ROOT / "sim" / "robots" / "gao2018.cfg", folder / "robot.cfg")
    path = folder / "short.cfg"
    path.write_text(SCENARIO)
    return path
