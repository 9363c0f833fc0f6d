"""tools/report/front_picture.py: the picture of the front page from a plan and the committed figures."""
import io
from unittest import mock

import pytest
from conftest import assert_one_line_error, run_tool
from PIL import Image
from test_plan_report import write_plan
from tools.report import front_picture


def picture(folder):
    return run_tool("report.front_picture", folder, folder / "picture.png")


@pytest.fixture
def plan(tmp_path):
    write_plan(tmp_path)
    return tmp_path


def test_it_is_a_wide_picture_and_repeats(plan):
    result = picture(plan)
    assert result.returncode == 0, result.stderr
    first = (plan / "picture.png").read_bytes()
    width, height = Image.open(io.BytesIO(first)).size
    assert width > 2 * height > 800
    assert picture(plan).returncode == 0
    assert (plan / "picture.png").read_bytes() == first


def test_its_bars_are_the_figures(plan):
    with mock.patch.object(front_picture, "fill_bars") as fill_bars:
        assert picture(plan).returncode == 0
    saved, error, flash = ([*call.args[2].values()] for call in fill_bars.call_args_list)
    assert saved[0] == 100 and 0 < saved[1] < 100
    assert error[0] > error[1] > 0
    assert len(flash) == len(front_picture.MODULES)


@pytest.mark.parametrize("name, value", [("SAVED", "gone"), ("MODULES", {"planner": "flash: gone"})])
def test_a_figure_that_is_gone_is_one_line(plan, name, value):
    with mock.patch.object(front_picture, name, value):
        assert_one_line_error(picture(plan), "gone")
    assert not (plan / "picture.png").exists()


def test_a_folder_without_a_plan_is_one_line(tmp_path):
    assert_one_line_error(picture(tmp_path), "summary.json")
