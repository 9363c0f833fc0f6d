"""The page as a person uses it: clicks, drags, keys, links, on a screen and on a phone."""
import gzip
import re
import time

import pytest
from conftest import BUILD, open_page

SIZE_MAX = 700_000      # bytes over the wire, compressed
FIRST_FRAME_MAX = 2.0   # s
REAL_TIME_LEAST = 50    # of the balancer's simulation


def message(page):
    return page.ask("document.querySelector('#message').textContent")


def gauge(page, name):
    """The first number of a gauge."""
    return float(re.match(r"-?[0-9.]+", page.ask(f"document.querySelector('#gauge-{name}').textContent"))[0])


def on_screen(page, x, y):
    """A place on the plane, m, in pixels."""
    page.ask("document.querySelector('#plane').scrollIntoView({block: 'center'}), 0")
    return page.ask(f"""(() => {{ const box = page.plane.getBoundingClientRect(); const plane = page.scene.plane;
        return [box.left + plane.x({x}), box.top + plane.y({y})]; }})()""")


def frames(page, count=3):
    page.ask(f"new Promise((done) => {{ let left = {count}; const next = () => (left-- ? requestAnimationFrame(next) : done(0)); next(); }})")


# ---- Bars ----


def test_the_page_is_small():
    files = sorted((BUILD / "page").iterdir())
    assert {"index.html", "core.wasm.js", "style.css"} <= {path.name for path in files}
    assert sum(len(gzip.compress(path.read_bytes(), 9, mtime=0)) for path in files) <= SIZE_MAX


def test_the_first_frame_takes_the_processor_little_time(browser):
    """By the clock `make bench-page` measures it: here others work on the machine, too."""
    browser.open("about:blank")
    before = browser.busy()
    open_page(browser)
    browser.wait("performance.getEntriesByName('first frame').length === 1")
    assert 0 < browser.busy() - before <= FIRST_FRAME_MAX


def test_the_balancer_is_simulated_much_faster_than_real_time(page):
    page.click("#pause")
    page.click("#drive")
    before = page.busy()
    page.ask("page.core.exports.balancer_run(20000)")
    assert 20 / (page.busy() - before) >= REAL_TIME_LEAST


def test_it_asks_nothing_of_the_network(page):
    assert page.ask("performance.getEntriesByType('resource').every((entry) => entry.name.startsWith('file:'))")


# ---- The balancer ----


def test_the_balancer_drives_its_waypoints(page):
    page.choose("#speed", "50")
    page.click("#drive")
    page.wait("document.querySelector('#message').textContent.startsWith('There:')", 20)
    view = page.ask("page.scene.view")
    assert view["leg"] == view["leg_count"] == 4
    assert gauge(page, "driven") == pytest.approx(view["driven_j"], abs=0.006)
    assert gauge(page, "forecast") == pytest.approx(view["forecast_j"], abs=0.06)
    assert 0 < gauge(page, "battery") < 100
    assert abs(view["driven_j"] - view["forecast_j"]) < 1.96 * view["deviation_j"]
    rows = page.ask("[...document.querySelectorAll('#legs tbody tr')].map((row) => row.textContent)")
    assert len(rows) == 4 and all("–" not in row for row in rows)


def test_a_dragged_waypoint_moves_and_the_front_with_it(page):
    before = page.ask("page.scene.points")
    page.drag(on_screen(page, 7, 3), on_screen(page, 8, 1))
    assert page.ask("page.scene.waypoints[1]") == pytest.approx({"x": 8, "y": 1}, abs=0.11)
    assert page.ask("page.scene.points") != before
    assert page.ask("document.querySelectorAll('.places input')[2].valueAsNumber") == pytest.approx(8, abs=0.11)


def test_a_waypoint_that_is_dragged_while_it_drives_is_driven_to(page):
    page.choose("#speed", "10")
    page.click("#drive")
    page.wait("page.scene.view.leg >= 1", 10)
    page.drag(on_screen(page, 0, 4), on_screen(page, 1, 6))
    page.choose("#speed", "50")
    page.wait("document.querySelector('#message').textContent.startsWith('There:')", 20)
    end = page.ask("[page.scene.view.x_m - page.scene.waypoints[3].x, page.scene.view.y_m - page.scene.waypoints[3].y]")
    assert end == pytest.approx([0, 0], abs=0.05)


def test_a_route_is_driven_within_a_time_or_says_what_it_takes(page):
    page.ask("document.querySelector('#within').value = 3, 0")
    page.click("#drive-within")
    needed = float(re.fullmatch(r"It takes ([0-9.]+) s at least.", message(page))[1])
    page.ask(f"document.querySelector('#within').value = {needed + 1}, 0")
    page.choose("#speed", "50")
    page.click("#drive-within")
    page.wait("document.querySelector('#message').textContent.startsWith('There:')", 20)
    view = page.ask("page.scene.view")
    assert view["driven_s"] <= needed + 1.1
    assert view["driven_j"] == pytest.approx(gauge(page, "forecast"), rel=0.05)


def test_a_push_is_balanced_and_a_hard_one_is_not(page):
    page.click("#push-forward")
    page.wait("Math.abs(page.scene.view.pitch_rad) > 0.005")
    page.choose("#speed", "10")
    page.wait("page.scene.view.time_s > 3")
    assert not page.ask("page.scene.view.has_fallen")
    page.ask("page.core.exports.balancer_push(400, 300), 0")
    page.wait("document.querySelector('#message').textContent.includes('Reset')")
    page.click("#reset")
    page.wait("page.scene.view.time_s > 0.1")
    assert not page.ask("page.scene.view.has_fallen")


def test_pause_stops_time_and_speed_multiplies_it(page):
    page.click("#pause")
    frames(page)
    before = page.ask("page.scene.view.time_s")
    frames(page, 5)
    assert page.ask("page.scene.view.time_s") == before
    page.click("#pause")
    page.choose("#speed", "20")
    begin = page.ask("[performance.now() / 1000, page.scene.view.time_s]")
    time.sleep(0.5)
    end = page.ask("[performance.now() / 1000, page.scene.view.time_s]")
    assert (end[1] - begin[1]) / (end[0] - begin[0]) > 10


# ---- The planner ----


@pytest.fixture
def planner(page):
    page.click("#tab-planner")
    page.wait("page.name === 'planner' && Number.isFinite(page.scene.view.time_s)")
    return page


def test_the_planner_finds_its_way_over_the_hills(planner):
    planner.choose("#speed", "50")
    planner.wait("document.querySelector('#message').textContent.startsWith('There:')", 30)
    view = planner.ask("page.scene.view")
    assert not view["is_touched"] and view["plan_j"] > 0 and view["expansions"] > 100
    assert planner.ask("page.scene.route.length") > 20 and planner.ask("page.scene.improved.length") > 0


def cells_searched(planner):
    """How many wait at the frontier, and how many are expanded."""
    return planner.ask("[1, 2].map((kind) => page.scene.searched.filter((found) => found === kind).length)")


def shares_in_colour(planner):
    """Of the cells at the frontier and of those expanded, how many have the colour of the legend: on others lie lines and
    the robot."""
    return planner.ask("""(() => { const { scene, plane } = page, ratio = devicePixelRatio;
        const pixels = plane.getContext("2d").getImageData(0, 0, plane.width, plane.height).data;
        const pixel = (i) => {
            const x = scene.plane.x((i % scene.width + 0.35) * scene.cell), y = scene.plane.y((Math.floor(i / scene.width) + 0.65) * scene.cell);
            const first = 4 * (Math.round(y * ratio) * plane.width + Math.round(x * ratio));
            return [...pixels.slice(first, first + 3)]; };
        return ["frontier", "expanded"].map((name, kind) => {
            const colour = getComputedStyle(document.querySelector(`.legend .${name}`)).backgroundColor.match(/\\d+/g).map(Number);
            const cells = [...scene.searched.keys()].filter((i) => scene.searched[i] === kind + 1);
            return cells.filter((i) => pixel(i).every((part, at) => Math.abs(part - colour[at]) < 8)).length / cells.length; }); })()""")


def test_the_search_is_seen_as_it_proceeds(planner):
    planner.click("#reset")
    planner.wait("page.scene.view.expansions > 200", 10)
    planner.click("#pause")
    frames(planner)
    early = cells_searched(planner)
    assert planner.ask("page.scene.isSearching") and min(early) > 20
    assert min(shares_in_colour(planner)) > 0.5
    planner.click("#pause")
    planner.wait("!page.scene.isSearching", 30)
    late = cells_searched(planner)
    assert late[1] > 2 * early[1]
    shown = dict(planner.ask("[...document.querySelectorAll('#search tbody tr')].map((row) => [...row.cells].map((cell) => cell.textContent))"))
    assert int(shown["cells expanded"]) > early[1] and int(shown["states expanded"]) >= int(shown["cells expanded"])


def test_the_search_is_slow_only_where_it_is_to_be_watched(planner):
    took = []
    for _ in range(2):
        planner.click("#reset")
        begin = planner.ask("performance.now()")
        planner.wait("!page.scene.isSearching", 30)
        took.append(planner.ask("performance.now()") - begin)
        planner.click("#watch")
    assert took[1] < took[0]


def test_a_wall_across_its_way_is_driven_round(planner):
    planner.choose("#speed", "10")
    planner.wait("page.scene.view.state === 5", 10)
    cell = planner.ask("page.scene.cell")
    planner.drag(on_screen(planner, 62.5 * cell, 14.5 * cell), on_screen(planner, 62.5 * cell, 26.5 * cell))
    assert planner.ask("page.scene.walls[20 * page.scene.width + 62]") == 1
    planner.choose("#speed", "50")
    planner.wait("page.scene.view.state >= 7", 30)
    view = planner.ask("page.scene.view")
    assert (view["state"], view["is_touched"]) == (7, 0)
    assert view["replans"] >= 1 and view["repair_expansions"] > 0


def test_what_is_walled_in_is_proved_and_opened_again(planner):
    planner.click("#tool-goal")
    cell = planner.ask("page.scene.cell")
    planner.drag(*2 * [on_screen(planner, 70.5 * cell, 10.5 * cell)])
    assert planner.ask("page.scene.goal") == {"x": 70, "y": 10}
    planner.click("#tool-wall")
    planner.drag(on_screen(planner, 57.5 * cell, 21.5 * cell), on_screen(planner, 57.5 * cell, 0.5 * cell), 8)
    planner.choose("#speed", "50")
    planner.wait("document.querySelector('#message').textContent.includes('proved')", 20)
    planner.click("#tool-erase")
    planner.drag(on_screen(planner, 57.5 * cell, 21.5 * cell), on_screen(planner, 57.5 * cell, 0.5 * cell), 8)
    planner.wait("page.scene.view.state === 7", 30)


def test_hills_begin_anew_and_what_is_too_steep_is_marked(planner):
    cell = planner.ask("page.scene.cell")
    planner.click("#tool-hill")
    for _ in range(6):
        planner.drag(*2 * [on_screen(planner, 14.5 * cell, 40.5 * cell)])
    assert planner.ask("page.scene.view.time_s") < 3
    assert planner.ask("page.scene.elevations[40 * page.scene.width + 14]") > 100
    assert planner.ask("page.scene.walls.includes(2)")


def test_the_block_of_memory_is_chosen(planner):
    states = {}
    for kib in (8, 1024):
        planner.choose("#memory", str(kib))
        frames(planner)
        states[kib] = planner.ask("page.scene.view.states_max")
    assert states[8] * 20 < states[1024]
    planner.choose("#robot", "2")
    frames(planner)
    assert planner.ask("page.scene.cell") == pytest.approx(0.1, rel=1e-4)


# ---- The patrol robot ----


@pytest.fixture
def patrol(page):
    page.click("#tab-patrol")
    page.wait("page.name === 'patrol' && page.scene.view.time_s > 0")
    return page


def test_the_patrol_robot_arrives(patrol):
    patrol.choose("#speed", "20")
    patrol.wait("page.scene.view.is_over === 1", 20)
    assert message(patrol).startswith("Arrived: ")
    assert gauge(patrol, "driven") == pytest.approx(patrol.ask("page.scene.view.driven_j"), abs=0.06)
    assert gauge(patrol, "forecast") > 0


def test_a_person_is_added_sent_and_met(patrol):
    patrol.click("#add-person")
    patrol.choose("#speed", "5")
    at = patrol.ask("page.scene.shapes[0]")
    patrol.drag(on_screen(patrol, at["x"], at["y"]), on_screen(patrol, at["x"] - 0.5, at["y"] - 1))
    patrol.wait("Math.hypot(page.scene.shapes[0].x - page.scene.targets.get(0).x, page.scene.shapes[0].y - page.scene.targets.get(0).y) < 0.01", 10)
    assert patrol.ask("page.scene.shapes[0].y") < at["y"] - 0.5
    patrol.choose("#speed", "20")
    patrol.wait("page.scene.view.is_over === 1", 30)


def test_nobody_is_sent_through_a_wall(patrol):
    patrol.click("#add-person")
    patrol.ask("page.scene.send(0, {x: 50, y: 7}), 0")
    target = patrol.ask("page.scene.targets.get(0)")
    assert target["x"] < 20 and patrol.ask(f"page.scene.before(page.scene.shapes[0], {{x: {target['x']}, y: {target['y']}}}).x") == target["x"]


def test_every_scene_of_the_patrol_robot_begins(patrol):
    for kind in range(6):
        patrol.choose("#kind", str(kind))
        frames(patrol)
        assert patrol.ask("page.scene.hasBegun && page.scene.path.length > 1")


# ---- Links, keys, phones ----


@pytest.mark.parametrize("scene, change", [
    ("balancer", "page.scene.waypoints.push({x: 2, y: 2})"),
    ("planner", "page.scene.brush(30, 50, true), page.scene.heap(20, 20, 1), page.scene.goal = {x: 60, y: 5}"),
    ("patrol", "page.scene.kind = 3, page.scene.seed = 4, page.scene.people = [{x: 3, y: 2}]")])
def test_a_link_carries_a_scene(page, scene, change):
    page.click(f"#tab-{scene}")
    page.choose("#speed", "5")
    page.ask(f"({change}, 0)")
    page.click("#link")
    address, link = page.ask("[location.href, JSON.stringify(page.scene.link())]")
    page.open("about:blank")
    page.open(address)
    page.wait("!!window.page && page.time > 0")
    assert page.ask("[page.name, JSON.stringify(page.scene.link()), document.querySelector('#speed').value]") == [scene, link, "5"]


@pytest.mark.parametrize("link", ["scene=nothing", "scene=balancer&way=1,2;x,y&robot=none&seed=-1&speed=7", "scene=balancer&way=",
                                  "scene=planner&walls=zz.1&hills=1,2;a,b,c&memory=none&start=900,1", "scene=patrol&kind=7&people=1;2,x"])
def test_a_broken_link_opens_a_scene_all_the_same(page, link):
    address = page.ask("location.href")
    page.open("about:blank")
    page.open(f"{address}#{link}")
    page.wait("!!window.page && page.time > 0")
    assert message(page) != ""


@pytest.mark.parametrize("scene", ["balancer", "planner", "patrol"])
def test_the_keyboard_reaches_everything_and_everything_has_a_name(page, scene):
    page.click(f"#tab-{scene}")
    page.ask("document.activeElement.blur(), 0")
    wanted = page.ask("""(() => { window.seen = new Set(); return [...document.querySelectorAll('button, select, input, #plane')]
        .filter((e) => !e.disabled && !(e.role === 'tab' && e.tabIndex < 0)).length; })()""")
    for _ in range(wanted + 3):
        page.press("Tab", 9)
        page.ask("window.seen.add(document.activeElement), 0")
    assert page.ask("[...window.seen].filter((e) => e.matches('button, select, input, #plane')).length") == wanted
    nodes = page.send("Accessibility.getFullAXTree")["nodes"]
    nameless = [node["role"]["value"] for node in nodes if not node.get("ignored")
                and node["role"]["value"] in ("button", "combobox", "spinbutton", "slider", "tab", "image", "Canvas", "textbox")
                and not node.get("name", {}).get("value")]
    assert nameless == []


def test_keys_move_waypoints_walls_and_people(page):
    page.ask("page.plane.focus(), 0")
    page.press("ArrowRight", 39)
    assert page.ask("page.scene.waypoints[0]") == {"x": 4.5, "y": 0}
    assert message(page) == "Waypoint 1 at 4.5, 0.0 m."
    page.press(" ", 32, " ")
    assert page.ask("page.isPaused")
    page.click("#tab-planner")
    page.ask("page.plane.focus(), 0")
    page.press("ArrowUp", 38)
    assert message(page).startswith("Cell 40, 29: ")
    page.press("Enter", 13)
    assert page.ask("page.scene.walls[29 * page.scene.width + 40]") == 1
    page.click("#tab-patrol")
    page.click("#add-person")
    page.ask("page.plane.focus(), 0")
    page.press("ArrowDown", 40)
    assert message(page).startswith("Person 1: goes to ")


def test_tabs_are_changed_by_arrows(page):
    page.ask("document.querySelector('#tab-balancer').focus(), 0")
    page.press("ArrowRight", 39)
    assert page.ask("[page.name, document.activeElement.id]") == ["planner", "tab-planner"]


@pytest.mark.parametrize("scene", ["balancer", "planner", "patrol"])
def test_a_phone_shows_it_without_scrolling_sideways(page, scene):
    page.resize(360, 740, 2, phone=True)
    page.click(f"#tab-{scene}")
    frames(page)
    assert page.ask("document.scrollingElement.scrollWidth") <= 360
    small = page.ask("""[...document.querySelectorAll('button, select')].filter((e) => e.getBoundingClientRect().height < 36).map((e) => e.id)""")
    assert small == []


def test_a_finger_moves_a_waypoint_and_draws_a_wall(page):
    page.resize(390, 844, 2, phone=True)
    page.touch_drag(on_screen(page, 7, 3), on_screen(page, 6, 2))
    assert page.ask("page.scene.waypoints[1]") == pytest.approx({"x": 6, "y": 2}, abs=0.15)
    page.click("#tab-planner")
    frames(page)
    cell = page.ask("page.scene.cell")
    page.touch_drag(on_screen(page, 10.5 * cell, 40.5 * cell), on_screen(page, 20.5 * cell, 50.5 * cell))
    assert page.ask("page.scene.walls[45 * page.scene.width + 15]") == 1
