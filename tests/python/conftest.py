import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("JP_BUILD", ROOT / "build")).resolve()
SITE = BUILD / "python/site"

# The package as a wheel installs it, not its sources.
sys.path.insert(0, str(SITE))


@pytest.fixture
def run(tmp_path):
    """Runs a program of the project; its folder of results and what it printed."""
    def run_program(name, *arguments):
        folder = tmp_path / name
        result = subprocess.run([BUILD / "bin" / name, *map(str, arguments), "--output", folder], cwd=ROOT,
                                capture_output=True, text=True, check=False, timeout=600)
        assert result.stderr == "", result.stderr
        return folder
    return run_program
