"""Robot files as the tools read them: of which type they must be."""
import pytest
from conftest import JP_ROBOT, ROOT

from tools.common import ToolError
from tools.design import robot_json

ROBOTS = ROOT / "sim" / "robots"


@pytest.mark.parametrize("name", ["zhang2018", "burger", "patrol"])
def test_a_balancer_is_needed(name):
    with pytest.raises(ToolError, match=r"cfg: type: \w+ robot; needs a balancer; give the file of one$"):
        robot_json.load(ROBOTS / f"{name}.cfg", JP_ROBOT)


@pytest.mark.parametrize("name", ["zhang2018", "burger"])
def test_robots_that_their_sides_steer(name):
    robot = robot_json.load_skid_steer(ROBOTS / f"{name}.cfg", JP_ROBOT)
    assert robot.name == name
    assert robot.number("body.overall_width_m") >= robot.number("body.width_m") > 0


@pytest.mark.parametrize("name", ["courier24", "patrol"])
def test_a_robot_that_its_sides_steer_is_needed(name):
    with pytest.raises(ToolError, match="needs a skid_steer or a differential_drive; give the file of one$"):
        robot_json.load_skid_steer(ROBOTS / f"{name}.cfg", JP_ROBOT)


def test_a_file_that_bears_another_name(tmp_path):
    copy = tmp_path / "other.cfg"
    copy.write_bytes((ROBOTS / "burger.cfg").read_bytes())
    with pytest.raises(ToolError, match="name: is 'burger'"):
        robot_json.load_skid_steer(copy, JP_ROBOT)


def test_a_text_without_a_type_is_a_balancer(gao2018):
    assert gao2018.type == robot_json.BALANCER
    assert robot_json.from_text("old", '{"name": "gao2018", ' + ", ".join(
        f'"{group}": {{}}' for group in robot_json.GROUPS) + "}").type == robot_json.BALANCER
