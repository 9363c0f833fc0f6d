"""tools/operate/show_frames.py: frames of a log as candump and cantools show them; those that are committed."""
import json
import re

import pytest
from conftest import ROOT, assert_one_line_error, run_tool

from tools.measure.figure_store import STORE, read_store

COMMITTED = read_store(ROOT / STORE)["tables"]["frames"]["lines"]


def log_of(lines):
    """As candump -L writes what candump shows."""
    frames = [re.fullmatch(r"  (\w+)  (\w+)   \[\d\]  ([\w ]+)", line) for line in lines]
    return "".join(f"(0.000000) {bus} {identifier}#{data.replace(' ', '')}\n"
                   for bus, identifier, data in (frame.groups() for frame in frames if frame))


@pytest.fixture
def log(tmp_path):
    path = tmp_path / "frames.log"
    path.write_text(log_of(COMMITTED))
    return path


def test_the_committed_frames_are_what_the_dbc_says(log):
    result = run_tool("operate.show_frames", log)
    assert result.returncode == 0, result.stderr
    assert result.stdout.splitlines() == COMMITTED


def test_they_can_be_kept_as_a_table(log, tmp_path):
    assert run_tool("operate.show_frames", log, "--tables", tmp_path / "frames.tables.json").returncode == 0
    assert json.loads((tmp_path / "frames.tables.json").read_text("utf-8")) == {"frames": {"lines": COMMITTED}}


def test_a_log_of_others_is_one_line(tmp_path):
    (tmp_path / "frames.log").write_text("(0.000000) can0 7FF#00\n")
    assert_one_line_error(run_tool("operate.show_frames", tmp_path / "frames.log"), "joulepath.dbc")
