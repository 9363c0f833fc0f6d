"""What the page computes is what this machine computes, bit by bit: the same C compiled for it, its programs, whose
files hold all bits of their numbers, and the Python package."""
import ctypes
import json
import shlex
import struct
import subprocess

import joulepath
import pytest
from conftest import BUILD, ROOT

ROUTE = [(4.0, 0.0), (7.0, 3.0), (4.0, 6.0), (0.0, 4.0)]
# In the order of the module.
BALANCERS = ["courier24", "gao2018"]
NAVIGATORS = ["burger", "zhang2018", "courier24"]
SCENES = ["beside-obstacle", "l-passage", "corridor", "doorway", "pedestrian", "warehouse"]
WIDTH, HEIGHT = 80, 56


def bits(view):
    return {name: struct.pack(">d", value).hex() for name, value in view.items()}


def both(wasm, native, name, *arguments):
    """Called here and there, with the same answer, if it gives one."""
    ours, theirs = native.call(name, *arguments), wasm.call(name, *arguments)
    assert theirs in (None, ours), name
    return ours


def assert_same_bits(wasm, native, scene):
    """NaN is no bits that anybody computed: its sign may differ."""
    here, there = native.view(scene), wasm.view(scene)
    assert {name: "nan" if here[name] != here[name] else value for name, value in there.items()} == \
           {name: "nan" if value != value else bits({name: value})[name] for name, value in here.items()}
    return here


def run_program(name, *arguments):
    result = subprocess.run([BUILD / "bin" / name, *map(str, arguments)], capture_output=True, text=True, check=False,
                            timeout=600, cwd=ROOT)
    assert result.returncode == 0, result.stderr
    return result.stdout


# ---- The balancer ----


def drive_balancer(call, robot):
    call("balancer_reset", robot, 1.0)
    for x, y in ROUTE:
        call("balancer_add", x, y)
    call("balancer_follow")
    call("balancer_run", 9000)


@pytest.mark.parametrize("robot", range(2), ids=BALANCERS)
def test_a_balancer_drives_and_is_pushed_bit_by_bit(wasm, native, robot):
    drive_balancer(lambda *arguments: both(wasm, native, *arguments), robot)
    both(wasm, native, "balancer_push", 8.0, 200)
    both(wasm, native, "balancer_run", 40000)
    view = assert_same_bits(wasm, native, "balancer")
    assert view["leg"] == 4 and not view["has_fallen"]


@pytest.mark.parametrize("robot", range(2), ids=BALANCERS)
def test_the_front_is_the_same_bit_by_bit(wasm, native, robot):
    both(wasm, native, "balancer_reset", robot, 1.0)
    for x, y in ROUTE:
        both(wasm, native, "balancer_add", x, y)
    count = both(wasm, native, "balancer_front")
    assert count > 30
    assert wasm.doubles("balancer_front_points", 3 * count) == native.doubles("balancer_front_points", 3 * count)


def write_scenario(path, robot, budget=""):
    points = ", ".join(f"[{x}, {y}]" for x, y in [(0.0, 0.0), *ROUTE])
    path.write_text(f'name = "page";\nrobot = "{ROOT}/sim/robots/{BALANCERS[robot]}.cfg";\nseed = 1;\nend = "stand";\n'
                    f'energy_model = "identified";\nenergy = "battery";\nwaypoints = ( {points} );\n{budget}')
    return path


def driven_mission(folder):
    lists = [value for value in json.loads((folder / "summary.json").read_text()).values() if isinstance(value, list)]
    return next(value[0] for value in lists if isinstance(value[0], dict) and "segments" in value[0])


def legs_of(called):
    return called.doubles("balancer_legs", 12)


@pytest.mark.parametrize("robot", range(2), ids=BALANCERS)
def test_a_balancer_takes_what_jp_mission_and_python_say(wasm, native, tmp_path, robot):
    scenario = write_scenario(tmp_path / "page.cfg", robot)
    run_program("jp-mission", scenario, "--alone", "--output", tmp_path)
    mission, in_python = driven_mission(tmp_path), joulepath.drive(joulepath.Scenario(scenario))
    drive_balancer(lambda *arguments: both(wasm, native, *arguments), robot)
    both(wasm, native, "balancer_run", 40000)
    view, legs = assert_same_bits(wasm, native, "balancer"), legs_of(native)
    assert legs == legs_of(wasm)
    assert legs[1::3] == [leg["battery_energy_j"] for leg in mission["segments"]]
    assert legs[2::3] == [leg["duration_s"] for leg in mission["segments"]] == in_python.legs["seconds"].tolist()
    assert view["forecast_j"] == mission["forecast"]["energy_j"] == in_python.forecast_joules
    assert view["deviation_j"] == mission["forecast"]["deviation_j"] == in_python.forecast_deviation
    assert in_python.legs["metered_joules"].tolist() == [leg["measured_energy_j"] for leg in mission["segments"]]
    assert in_python.joules == mission["total"]["plant_energy_j"]


@pytest.mark.parametrize("robot, seconds", [(0, 45.0), (1, 22.0)], ids=BALANCERS)
def test_a_route_within_a_time_takes_what_jp_mission_says(wasm, native, tmp_path, robot, seconds):
    """jp-mission plans from the origin, the page from where the robot says that it comes to a stand: that is the origin
    of gao2018, and up to rounding, of 15 µm, that of courier24, whose sensors are noisy."""
    scenario = write_scenario(tmp_path / "page.cfg", robot, f"within_seconds = {seconds};\n")
    run_program("jp-mission", scenario, "--alone", "--output", tmp_path)
    mission = driven_mission(tmp_path)
    for called in (wasm, native):
        called.call("balancer_reset", robot, 1.0)
        for x, y in ROUTE:
            called.call("balancer_add", x, y)
        assert called.call("balancer_drive_within", seconds) == 0
        called.call("balancer_run", 60000)
    assert assert_same_bits(wasm, native, "balancer")["leg"] == 4
    legs = legs_of(native)
    for column, name in ((1, "battery_energy_j"), (2, "duration_s")):
        theirs = [leg[name] for leg in mission["segments"]]
        assert legs[column::3] == (theirs if BALANCERS[robot] == "gao2018" else pytest.approx(theirs, rel=1e-3))
    assert sum(legs[2::3]) <= seconds + 0.1


# ---- The planner ----


def draw(called, robot):
    """Two walls."""
    side = called.call("planner_new", robot, WIDTH, HEIGHT)
    for y in range(36):
        called.call("planner_wall", 26, y, 1)
    for y in range(22, HEIGHT):
        called.call("planner_wall", 56, y, 1)
    return side


def ridge():
    """Between them, 2⁻¹⁰ m."""
    return [max(0, 8 - abs(x - 41)) * 6 for _ in range(HEIGHT) for x in range(WIDTH)]


def set_ridge(wasm, native):
    heights = ridge()
    ctypes.memmove(native.bytes_at("planner_elevations"), struct.pack(f"<{len(heights)}h", *heights), 2 * len(heights))
    wasm.browser.ask(f"""new Int16Array(page.core.exports.memory.buffer, page.core.exports.planner_elevations(), {len(heights)})
        .set({heights}), 0""")


@pytest.mark.parametrize("robot", range(3), ids=NAVIGATORS)
def test_a_plan_a_repair_and_a_drive_are_the_same_bit_by_bit(wasm, native, robot):
    for called in (wasm, native):
        draw(called, robot)
    if NAVIGATORS[robot] == "zhang2018":
        set_ridge(wasm, native)
    assert both(wasm, native, "planner_begin", 8, 8, 1, 70, 46, 256, 1.0) == 0
    ticks = both(wasm, native, "planner_ticks_a_second")
    both(wasm, native, "planner_run", 12 * ticks)
    assert_same_bits(wasm, native, "planner")
    for x in range(60, 70):
        both(wasm, native, "planner_wall", x, 14, 1)
    both(wasm, native, "planner_run", 8 * ticks)
    assert both(wasm, native, "planner_goal", 70, 40) == 0
    both(wasm, native, "planner_run", 400 * ticks)
    searched = bytes(wasm.browser.ask(f"[...new Uint8Array(page.core.exports.memory.buffer, page.core.exports.planner_searched(), {WIDTH * HEIGHT})]"))
    assert searched == ctypes.string_at(native.bytes_at("planner_searched"), WIDTH * HEIGHT) and {1, 2} <= set(searched)
    view = assert_same_bits(wasm, native, "planner")
    assert view["state"] == 7 and not view["is_touched"]  # arrived
    route = both(wasm, native, "planner_route")
    assert route > 10 and wasm.doubles("planner_points", 2 * route) == native.doubles("planner_points", 2 * route)


@pytest.mark.parametrize("robot", NAVIGATORS)
def test_the_command_that_the_page_shows_drives_the_same(page, tmp_path, robot):
    page.click("#tab-planner")
    page.choose("#robot", str(NAVIGATORS.index(robot)))
    page.click("#pause")
    page.click("#reset")
    (tmp_path / "map.json").write_text(page.ask("JSON.stringify(page.scene.mapFile())"))
    command = shlex.split(page.ask("document.querySelector('#command').textContent").replace("\\\n", " "))
    assert command[:2] == ["build/bin/jp-navigate", "map.json"]
    run_program("jp-navigate", tmp_path / "map.json", *command[2:], "--output", tmp_path)
    result = json.loads((tmp_path / "summary.json").read_text())["result"]
    first = page.ask("""(() => { const known = () => Number.isFinite(page.core.view('planner').forecast_j);
        while (!known() && page.core.exports.planner_run(1) === 1) {}
        return page.core.view('planner'); })()""")
    page.ask("page.core.exports.planner_run(1000000), 0")
    view = page.ask("page.core.view('planner')")
    assert page.ask("page.core.text(page.core.exports.planner_state_name())") == result["state"] == "arrived"
    assert view["replans"] == result["replans"]
    assert first["forecast_j"] == result["forecast_j"]
    assert first["deviation_j"] == result["forecast_deviation_j"]
    assert first["plan_j"] == result["planned_j"]
    assert view["driven_j"] == result["energy_j"]
    assert view["driven_m"] == result["length_m"]


def test_what_drift_puts_on_the_map_is_that_of_jp_navigate(native, tmp_path):
    """On its way round three walls the robot's odometry drifts, and it takes cells that it knew to be elsewhere."""
    width, height, start, goal = 240, 160, (20, 20), (220, 140)
    walls = {(x, y) for i, x in enumerate((60, 120, 180)) for y in (range(130) if i % 2 == 0 else range(30, height))}
    side = 0.05  # of burger's cells
    native.call("planner_new", NAVIGATORS.index("burger"), width, height)
    for x, y in walls:
        native.call("planner_wall", x, y, 1)
    assert native.call("planner_begin", *start, 0, *goal, 4096, 1.0) == 0
    native.call("planner_run", 10**7)
    view = native.view("planner")
    (tmp_path / "map.json").write_text(json.dumps({
        "format": "joulepath-map-1", "name": "page", "width": width, "height": height, "resolution_m": side,
        "origin_m": [0, 0, 0], "rows": ["".join(".#"[(x, y) in walls] for x in range(width)) for y in reversed(range(height))]}))
    places = [",".join(f"{(cell + 0.5) * side:.3f}" for cell in place) for place in (start, goal)]
    run_program("jp-navigate", tmp_path / "map.json", "--hidden", 0, "--memory", 4096, "--robot", "burger", "--seed", 1,
                "--start", f"{places[0]},0", "--goal", places[1], "--output", tmp_path)
    result = json.loads((tmp_path / "summary.json").read_text())["result"]
    assert result["cells_seen"] > 0 and result["state"] == "arrived" and view["state"] == 7
    assert view["replans"] == result["replans"]
    assert view["driven_j"] == result["energy_j"]
    assert view["driven_m"] == result["length_m"]


# ---- The patrol robot ----


@pytest.mark.parametrize("kind", range(6), ids=SCENES)
def test_a_patrol_drive_among_people_is_the_same_bit_by_bit(wasm, native, kind):
    both(wasm, native, "patrol_new", kind, 2.0)
    both(wasm, native, "patrol_add_person", 3.0, 4.0)
    assert both(wasm, native, "patrol_begin", 2.0) == 1
    both(wasm, native, "patrol_run", 20)
    both(wasm, native, "patrol_send", 0, 4.0, 3.0)
    both(wasm, native, "patrol_run", 3000)
    assert assert_same_bits(wasm, native, "patrol")["is_over"] == 1


@pytest.mark.parametrize("scene", ["doorway", "warehouse"])
def test_a_patrol_drive_takes_what_jp_patrol_and_python_say(wasm, native, tmp_path, scene):
    run_program("jp-patrol", scene, "--seed", 1, "--method", "improved", "--output", tmp_path)
    said, = json.loads((tmp_path / "summary.json").read_text())["methods"]
    in_python = joulepath.patrol(scene, seed=1, method="improved")
    both(wasm, native, "patrol_new", SCENES.index(scene), 1.0)
    both(wasm, native, "patrol_begin", 1.0)
    both(wasm, native, "patrol_run", 3000)
    view = assert_same_bits(wasm, native, "patrol")
    assert view["driven_j"] == said["energy_j"] == in_python.joules
    assert view["driven_m"] == said["length_m"] == in_python.metres
    assert view["position_error_m"] == said["position_error_m"] == in_python.position_error_m
