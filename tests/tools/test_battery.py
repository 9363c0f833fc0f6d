"""battery.py: the committed tables are fresh, what they are made of, and what is refused."""
import re

import pytest
from conftest import ROOT, assert_one_line_error, run_tool

ROBOTS = ("burger", "courier24", "patrol", "zhang2018")
PACK = (ROOT / "sim/robots/packs/courier24.cfg").read_text()


def make(*arguments):
    return run_tool("design.battery", *arguments)


def numbers(text, member):
    """Values of a member of a table, as the comments say them."""
    block = re.search(rf"\.{member} =(.*?)\n    [.}}]|\.{member} =(.*)", text, re.S)
    return [float(value) for value in re.findall(r"/\* ([-+.\de]+)", block.group(0))]


@pytest.mark.parametrize("robot", ROBOTS)
def test_committed_tables_are_fresh(robot, tmp_path):
    result = make(robot, "--tables", tmp_path)
    assert result.returncode == 0, result.stderr
    for made in (tmp_path / f"battery_{robot}.c", tmp_path / f"pack_{robot}.c"):
        assert made.read_bytes() == (ROOT / "src" / "tables" / made.name).read_bytes(), f"run make battery ROBOT={robot}"


def test_every_pack_has_its_table():
    packs = sorted(path.stem for path in (ROOT / "sim/robots/packs").glob("*.cfg"))
    assert packs == sorted(ROBOTS)
    for prefix in ("battery_", "pack_"):
        assert packs == sorted(path.stem.removeprefix(prefix) for path in (ROOT / "src/tables").glob(f"{prefix}*.c"))


def test_a_pack_is_believed_as_its_cells_are():
    cell = (ROOT / "sim/robots/cells/inr18650_p28a.cfg").read_text()
    capacity = float(re.search(r"capacity_ah = ([\d.]+)", cell).group(1))
    text = (ROOT / "src/tables/pack_zhang2018.c").read_text()
    values = {name: int(value) for name, value in re.findall(r"\.(\w+) = (\d+)", text)}
    assert values["capacity"] == round(18 * 3600 * capacity)
    assert values["voltage_min"] == pytest.approx(values["voltage_empty"] / 2, abs=1)
    assert values["voltage_empty"] < values["voltage_nominal"] < values["voltage_full"] < values["voltage_max"]
    assert "&jp_battery_cells_zhang2018" in text
    assert values["voltage_designed"] == round(46.2 * 65536)


def test_a_pack_without_a_robot_is_refused(tmp_path):
    path = write_pack(tmp_path, "alone", PACK)
    (tmp_path / "alone.cfg").unlink()
    assert_one_line_error(make(path, "--tables", tmp_path), "alone.cfg")


def write_pack(folder, name, text, robot="courier24"):
    """The file of a pack, and beside its folder that of its robot."""
    (folder / f"{name}.cfg").write_bytes((ROOT / f"sim/robots/{robot}.cfg").read_bytes())
    path = folder / "packs" / f"{name}.cfg"
    path.parent.mkdir()
    path.write_text(text)
    return path


def test_cells_in_parallel_share_the_current(tmp_path):
    path = write_pack(tmp_path, "double",
                      PACK.replace("parallel = 1", "parallel = 2").replace("wiring_ohm = 0.04", "wiring_ohm = 0.0"))
    assert make(path, "--tables", tmp_path).returncode == 0
    double = (tmp_path / "battery_double.c").read_text()
    single = (ROOT / "src/tables/battery_courier24.c").read_text()
    wiring = 0.04 / 6
    for half, whole in zip(numbers(double, "resistance"), numbers(single, "resistance")):
        assert half == pytest.approx((whole - wiring) / 2, rel=1e-5)
    assert numbers(double, "polarisation") == [pytest.approx(0.0043)]


@pytest.mark.parametrize("old, new, culprit", [
    ("series = 6", "series = 0", "series"),
    ("series = 6", "series = many", "series"),
    ("parallel = 1", "parallels = 1", "parallel"),
    ('"inr18650_p28a"', "3", "cell"),
    ('"inr18650_p28a"', '"nothing"', "nothing.cfg"),
    ("wiring_ohm = 0.04", "wiring_ohm = nan", "wiring_ohm"),
    ("wiring_ohm = 0.04", "wiring_ohm = 100.0", "resistance"),
])
def test_what_is_refused(old, new, culprit, tmp_path):
    assert old in PACK
    path = write_pack(tmp_path, "bad", PACK.replace(old, new))
    assert_one_line_error(make(path, "--tables", tmp_path), culprit)
    assert [made.name for made in tmp_path.iterdir()] == ["bad.cfg", "packs"]
