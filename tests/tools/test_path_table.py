"""path_table.py: the committed tables are fresh, its rules, and what is refused."""
import pytest
from conftest import ROOT, assert_one_line_error, run_tool

ROBOTS = ("burger", "zhang2018")
PARTS = ("path_drive", "path_limits")


def make(*arguments):
    return run_tool("design.path_table", *arguments)


@pytest.mark.parametrize("robot", ROBOTS)
def test_committed_tables_are_fresh(robot, tmp_path):
    result = make(robot, "--tables", tmp_path)
    assert result.returncode == 0, result.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == [f"{part}_{robot}.c" for part in PARTS]
    for made in tmp_path.iterdir():
        assert made.read_bytes() == (ROOT / "src" / "tables" / made.name).read_bytes(), f"run make path ROBOT={robot}"


def test_other_robots_are_refused(tmp_path):
    assert_one_line_error(make("courier24", "--tables", tmp_path), "its sides do not steer it")
    assert not list(tmp_path.iterdir())
