"""The tools as programs: help, and the exit status of a wrong command line."""
import subprocess
import sys

import pytest
from conftest import TOOLS

PROGRAMS = ["bench_plan.py", "bench_route.py", "figures.py", "gain_design.py", "identify.py", "import_map.py", "lattice.py",
            "patrol_report.py", "plan_report.py", "report.py"]


@pytest.mark.parametrize("name", PROGRAMS)
def test_help_and_wrong_options(name, tmp_path):
    def run(option):
        return subprocess.run([sys.executable, TOOLS / name, option], capture_output=True, text=True, check=False,
                              cwd=tmp_path)
    assert run("--help").stdout.startswith("usage:")
    assert run("--nonsense").returncode == 2
