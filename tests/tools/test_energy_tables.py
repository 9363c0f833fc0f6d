"""The committed energy models are those that `make identify` makes."""
import os
import re
import subprocess
from pathlib import Path

import pytest
from conftest import ROBOTS, ROOT, run_tool

JP_IDENTIFY = Path(os.environ.get("JP_BUILD", ROOT / "build")).resolve() / "bin" / "jp-identify"

# Another libm may round the simulated robot's sines differently; the fit moves by less than this share.
TOLERANCE = 1e-4


def integers(text):
    body = text[text.index("= {"):]
    return [int(number) for number in re.findall(r"(-?\d+),\s*/\*", body)]


@pytest.mark.parametrize("robot", ROBOTS)
def test_model_is_fresh(robot, tmp_path):
    subprocess.run([JP_IDENTIFY, ROOT / "sim" / "robots" / f"{robot}.cfg", "--output", tmp_path], check=True,
                   capture_output=True)
    result = run_tool("identify.py", ROOT / "sim" / "robots" / f"{robot}.cfg", "--jp-robot",
                      JP_IDENTIFY.with_name("jp-robot"), "--experiments", tmp_path, "--tables", tmp_path)
    assert result.returncode == 0, result.stderr
    made = integers((tmp_path / f"energy_{robot}.c").read_text(encoding="utf-8"))
    committed = integers((ROOT / "src" / "tables" / f"energy_{robot}.c").read_text(encoding="utf-8"))
    assert len(committed) == 20
    largest = max(map(abs, committed))
    assert made == pytest.approx(committed, rel=TOLERANCE, abs=TOLERANCE * largest), "run make identify"
