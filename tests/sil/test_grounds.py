"""A robot that goes again and again over grounds that its map tells apart: jp-grounds, and the picture of it."""
import json
import subprocess
import sys

import pytest
from conftest import ROOT, assert_one_line_error, run

ROBOT = ROOT / "sim/robots/zhang2018.cfg"
WIDTH, HEIGHT = 80, 40


def run_tool(name, *arguments):
    return subprocess.run([sys.executable, "-m", f"tools.{name}", *map(str, arguments)], capture_output=True, text=True,
                          check=False, cwd=ROOT, timeout=120)


def write_map(folder, *options, mud="S"):
    """Mud from side to side between start and goal."""
    rows = ["".join(mud if 30 <= x < 50 else "." for x in range(WIDTH))] * HEIGHT
    (folder / "yard.map").write_text("\n".join(["type octile", f"height {HEIGHT}", f"width {WIDTH}", "map", *rows]) + "\n")
    result = run_tool("design.import_map", folder / "yard.map", folder / "map.json", "--resolution", "0.2", *options)
    assert result.returncode == 0, result.stderr
    return folder / "map.json"


def go(folder, path, *options):
    return run("jp-grounds", path, "--robot", ROBOT, "--start=2,4,0", "--goal=14,4", "--output", folder / "out", *options)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("grounds")
    result = go(folder, write_map(folder, "--grounds", "asphalt=1,1", "mud=2.5,0.8"), "--trips", "3")
    assert (result.returncode, result.stderr) == (0, "")
    return folder / "out"


@pytest.fixture(scope="module")
def summary(made):
    return json.loads((made / "summary.json").read_text())


def test_it_learns_what_the_mud_takes(summary):
    truth = summary["grounds"][1]["straight_j_per_m"]
    learned = [trip["known"][1]["straight_j_per_m"] for trip in summary["kept"]]
    assert truth > 1.5 * summary["grounds"][0]["straight_j_per_m"]
    assert abs(learned[-1] / truth - 1) < 0.05
    assert all(trip["known"][1]["legs"] == 0 for trip in summary["not_kept"])
    assert all(trip["known"][2]["legs"] == 0 for trip in summary["kept"])


def test_its_forecasts_come_true(summary):
    first, *_, last = summary["kept"]
    assert abs(last["forecast_j"] / last["energy_j"] - 1) < 0.05 < abs(first["forecast_j"] / first["energy_j"] - 1)


def test_picture(made):
    result = run_tool("report.grounds_picture", made)
    assert result.returncode == 0, result.stderr
    assert (made / "grounds.png").read_bytes().startswith(b"\x89PNG")


def test_picture_of_nothing(tmp_path):
    assert_one_line_error(run_tool("report.grounds_picture", tmp_path), "summary.json", "No such file")


def test_a_map_without_grounds(tmp_path):
    assert_one_line_error(go(tmp_path, write_map(tmp_path, mud=".")), "tells no grounds apart")


def test_a_balancer(tmp_path):
    path = write_map(tmp_path)
    assert_one_line_error(run("jp-grounds", path, "--robot", ROOT / "sim/robots/courier24.cfg"), "courier24", "skid steer")
