"""What the tests of the tools share: paths, the programs, synthetic data."""
import contextlib
import importlib
import io
import subprocess
import sys
import warnings
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests")]

from programs import (BIN, assert_one_line_error, assert_verdict,  # noqa: E402, F401 - some for the tests
                      stay_on_one_cpu)
from tools import common  # noqa: E402
from tools.design import robot_json  # noqa: E402
from tools.report import plots  # noqa: E402

JP_ROBOT = BIN / "jp-robot"
# The balancers: those with a controller.
ROBOTS = sorted(path.stem.removeprefix("robot_") for path in (ROOT / "src" / "tables").glob("robot_*.c"))


@pytest.fixture(scope="session", autouse=True)
def fixture_one_cpu():
    stay_on_one_cpu()


def run_tool(name, *arguments, input=""):
    """Run a tool with a command line, in this process because its imports take a second; a numerical warning fails."""
    main = importlib.import_module(f"tools.{name}").main
    command = [name.rpartition(".")[2] + ".py", *map(str, arguments)]
    out, err = io.StringIO(), io.StringIO()
    with (mock.patch("sys.argv", command), mock.patch("sys.stdin", io.StringIO(input)),
          contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), warnings.catch_warnings()):
        warnings.simplefilter("error", RuntimeWarning)
        with pytest.raises(SystemExit) as end:
            common.run(main)
    return SimpleNamespace(returncode=end.value.code, stdout=out.getvalue(), stderr=err.getvalue())


def robot_text(name):
    """Output of jp-robot --json=- for a robot of the project."""
    path = ROOT / "sim" / "robots" / f"{name}.cfg"
    return subprocess.run([JP_ROBOT, path, "--json=-"], capture_output=True, text=True, check=True).stdout


@pytest.fixture(scope="session")
def gao2018():
    return robot_json.from_text("gao2018", robot_text("gao2018"))


@pytest.fixture
def sketched_pictures(monkeypatch):
    """Small and without a layout, which takes longest; for tests that look at something else."""
    draw = plots.png_bytes
    monkeypatch.setattr(plots, "png_bytes", lambda figure, dpi=0: draw(figure, 20))
    monkeypatch.setitem(plots.plt.rcParams, "figure.constrained_layout.use", False)


sketched = pytest.mark.usefixtures("sketched_pictures")
