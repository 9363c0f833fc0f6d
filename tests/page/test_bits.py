"""What the page computes is what this machine computes: bit by bit with the same sines, and as the programs say.

The page has musl's mathematics, this machine's programs have glibc's, whose sines differ in the last place now and then.
So the bits are compared with the same C compiled for this machine with musl's mathematics, and with the programs' own
what does not depend on them: plans and forecasts, of integers alone, are equal; what is driven is within LIBM of it."""
import ctypes
import json
import re
import shlex
import struct
import subprocess

import pytest
from conftest import BUILD, ROOT

LIBM = 1e-3  # of an energy, a time or a length that is driven: some thousand times what was seen

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


def assert_as_printed(value, printed):
    """To the twelve digits that the programs' files have."""
    assert value == pytest.approx(printed, rel=1e-11, abs=1e-11)


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
    there = wasm.browser.ask(f"[...page.core.doubles(page.core.exports.balancer_front_points(), {3 * count})]")
    assert there == native.doubles("balancer_front_points", 3 * count)


def write_scenario(path, robot, budget=""):
    points = ", ".join(f"[{x}, {y}]" for x, y in [(0.0, 0.0), *ROUTE])
    path.write_text(f'name = "page";\nrobot = "{ROOT}/sim/robots/{BALANCERS[robot]}.cfg";\nseed = 1;\nend = "stand";\n'
                    f'energy_model = "identified";\nenergy = "battery";\nwaypoints = ( {points} );\n{budget}')
    return path


def driven_mission(folder):
    lists = [value for value in json.loads((folder / "summary.json").read_text()).values() if isinstance(value, list)]
    return next(value[0] for value in lists if isinstance(value[0], dict) and "segments" in value[0])


@pytest.mark.parametrize("robot", range(2), ids=BALANCERS)
def test_a_balancer_takes_what_jp_mission_says(wasm, with_host_libm, tmp_path, robot):
    scenario = write_scenario(tmp_path / "page.cfg", robot)
    run_program("jp-mission", scenario, "--alone", "--output", tmp_path)
    mission = driven_mission(tmp_path)
    for called in (wasm, with_host_libm):
        drive_balancer(called.call, robot)
        called.call("balancer_run", 40000)
    legs = with_host_libm.doubles("balancer_legs", 12)
    here, there = with_host_libm.view("balancer"), wasm.view("balancer")
    for i, leg in enumerate(mission["segments"]):
        assert_as_printed(legs[3 * i + 1], leg["battery_energy_j"])
        assert_as_printed(legs[3 * i + 2], leg["duration_s"])
    assert_as_printed(here["forecast_j"], mission["forecast"]["energy_j"])
    assert_as_printed(here["deviation_j"], mission["forecast"]["deviation_j"])
    assert {name: there[name] for name in ("forecast_j", "deviation_j")} == \
        bits({name: here[name] for name in ("forecast_j", "deviation_j")})
    driven = struct.unpack(">d", bytes.fromhex(there["driven_j"]))[0]
    assert driven == pytest.approx(sum(leg["battery_energy_j"] for leg in mission["segments"]), rel=LIBM)


@pytest.mark.parametrize("robot, seconds", [(0, 45.0), (1, 22.0)], ids=BALANCERS)
def test_a_route_within_a_time_takes_what_jp_mission_says(wasm, native, with_host_libm, tmp_path, robot, seconds):
    """jp-mission plans from the origin, the page from where the robot says that it stands: with the noise of courier24's
    sensors that is not quite the same."""
    scenario = write_scenario(tmp_path / "page.cfg", robot, f"within_seconds = {seconds};\n")
    run_program("jp-mission", scenario, "--alone", "--output", tmp_path)
    mission = driven_mission(tmp_path)
    for called in (wasm, native, with_host_libm):
        called.call("balancer_reset", robot, 1.0)
        for x, y in ROUTE:
            called.call("balancer_add", x, y)
        assert called.call("balancer_drive_within", seconds) == 0
        called.call("balancer_run", 60000)
    assert assert_same_bits(wasm, native, "balancer")["leg"] == 4
    legs = with_host_libm.doubles("balancer_legs", 12)
    for i, leg in enumerate(mission["segments"]):
        for value, name in zip(legs[3 * i + 1:3 * i + 3], ("battery_energy_j", "duration_s")):
            assert value == pytest.approx(leg[name], rel=1e-11 if BALANCERS[robot] == "gao2018" else LIBM)
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
    there = wasm.browser.ask(f"[...page.core.doubles(page.core.exports.planner_points(), {2 * route})]")
    assert route > 10 and there == native.doubles("planner_points", 2 * route)


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
    assert_as_printed(first["forecast_j"], result["forecast_j"])
    assert_as_printed(first["deviation_j"], result["forecast_deviation_j"])
    assert_as_printed(first["plan_j"], result["planned_j"])
    assert view["driven_j"] == pytest.approx(result["energy_j"], rel=LIBM)
    assert view["driven_m"] == pytest.approx(result["length_m"], rel=LIBM)


def test_what_drift_puts_on_the_map_is_that_of_jp_navigate(with_host_libm, tmp_path):
    """On its way round three walls the robot's odometry drifts, and it takes cells that it knew to be elsewhere."""
    width, height, start, goal = 240, 160, (20, 20), (220, 140)
    walls = {(x, y) for i, x in enumerate((60, 120, 180)) for y in (range(130) if i % 2 == 0 else range(30, height))}
    side = 0.05  # of burger's cells
    with_host_libm.call("planner_new", NAVIGATORS.index("burger"), width, height)
    for x, y in walls:
        with_host_libm.call("planner_wall", x, y, 1)
    assert with_host_libm.call("planner_begin", *start, 0, *goal, 4096, 1.0) == 0
    with_host_libm.call("planner_run", 10**7)
    view = with_host_libm.view("planner")
    (tmp_path / "map.json").write_text(json.dumps({
        "format": "joulepath-map-1", "name": "page", "width": width, "height": height, "resolution_m": side,
        "origin_m": [0, 0, 0], "rows": ["".join(".#"[(x, y) in walls] for x in range(width)) for y in reversed(range(height))]}))
    places = [",".join(f"{(cell + 0.5) * side:.3f}" for cell in place) for place in (start, goal)]
    run_program("jp-navigate", tmp_path / "map.json", "--hidden", 0, "--memory", 4096, "--robot", "burger", "--seed", 1,
                "--start", f"{places[0]},0", "--goal", places[1], "--output", tmp_path)
    result = json.loads((tmp_path / "summary.json").read_text())["result"]
    assert result["cells_seen"] > 0 and result["state"] == "arrived" and view["state"] == 7
    assert view["replans"] == result["replans"]
    assert_as_printed(view["driven_j"], result["energy_j"])
    assert_as_printed(view["driven_m"], result["length_m"])


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
def test_a_patrol_drive_takes_what_jp_patrol_says(wasm, with_host_libm, tmp_path, scene):
    run_program("jp-patrol", scene, "--method", "improved", "--output", tmp_path)
    text = (tmp_path / "summary.json").read_text()
    for called in (wasm, with_host_libm):
        called.call("patrol_new", SCENES.index(scene), 1.0)
        called.call("patrol_begin", 1.0)
        called.call("patrol_run", 3000)
    here = with_host_libm.view("patrol")
    there = {name: struct.unpack(">d", bytes.fromhex(value))[0] for name, value in wasm.view("patrol").items()}
    for name, printed in (("driven_j", "energy_j"), ("driven_m", "length_m"), ("position_error_m", "position_error_m")):
        said = float(re.search(rf'"{printed}": ([0-9.e-]+)', text)[1])
        assert_as_printed(here[name], said)
        assert there[name] == pytest.approx(said, rel=LIBM, abs=1e-6)
