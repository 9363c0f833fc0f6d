#!/usr/bin/env python3
"""The page in a browser without a window: its size over the wire, its first frame, how fast it simulates, and how many
of its numbers are not those of this machine, bit by bit. Writes figures for tools/measure/figures.py."""
import gzip
import json
import statistics

from browser import Browser
from conftest import BUILD, INDEX, Native, open_page

COMMAND = "make bench-page"
OPENINGS = 9

# A drive of each scene to its end, and what is asked of it then: functions of the module with their arguments.
BALANCER = [("balancer_add", 10.0, 10.0), ("balancer_add", 20.0, 15.0), ("balancer_add", 25.0, 25.0), ("balancer_add", 15.0, 30.0),
            ("balancer_follow",), ("balancer_run", 75000)]
DRIVES = {
    "balancer": [[("balancer_reset", robot, 1.0), *BALANCER] for robot in range(2)],
    "planner": [[("planner_new", robot, 80, 56), *(("planner_wall", 30, y, 1) for y in range(36)),
                 ("planner_begin", 8, 8, 0, 70, 46, 1024, 1.0), ("planner_run", 1000000)] for robot in range(3)],
    "patrol": [[("patrol_new", kind, 1.0), ("patrol_begin", 1.0), ("patrol_run", 6000)] for kind in range(6)],
}


def figure(name, value, unit, bound=None):
    return {"name": f"page in the browser: {name}", "value": value, "unit": unit,
            "bound": bound and dict(zip(("op", "value"), bound)), "command": COMMAND}


def compressed():
    """kB of all files, one by one as a server sends them."""
    return sum(len(gzip.compress(path.read_bytes(), 9, mtime=0)) for path in (BUILD / "page").iterdir()) / 1000


def first_frames(browser):
    for _ in range(OPENINGS):
        browser.open("about:blank")
        browser.open(INDEX)
        browser.wait("!!window.page && page.time > 0")
        yield browser.ask("performance.getEntriesByName('first frame')[0].startTime / 1000")


def driven_there(browser, scene, calls):
    """The view at the end, and simulated seconds a second of the processor."""
    *prepared, last = [f"page.core.exports.{name}({', '.join(map(repr, arguments))})" for name, *arguments in calls]
    return browser.ask(f"""(() => {{ {'; '.join(prepared)}; const begin = performance.now(); {last};
        const seconds = (performance.now() - begin) / 1000; const view = page.core.view("{scene}");
        return [view, view.time_s / seconds]; }})()""")


def driven_here(native, scene, calls):
    for call in calls:
        native.call(*call)
    return native.view(scene)


def is_same(here, there):
    """What is no number here, because it is unknown, is null in what the browser answers."""
    return here == there or (here != here and there is None)


def main():
    browser = Browser()
    first = statistics.median(first_frames(browser))
    open_page(browser)
    browser.click("#pause")
    native = Native(BUILD / "page-native/libpage.so")
    factors, unequal, count = {}, 0, 0
    for scene, drives in DRIVES.items():
        for calls in drives:
            view, factor = driven_there(browser, scene, calls)
            factors.setdefault(scene, []).append(factor)
            here = driven_here(native, scene, calls)
            unequal += sum(not is_same(value, view[name]) for name, value in here.items())
            count += len(here)
    browser.close()
    figures = [
        figure("over the wire, compressed", compressed(), "kB", ("<=", 700)),
        figure(f"first frame, median of {OPENINGS}", first, "s", ("<=", 2)),
        figure("simulation of the balancer, times real time, least of 2 robots", min(factors["balancer"]), "", (">=", 50)),
        figure("simulation of robots that find their way, times real time, least of 3", min(factors["planner"]), ""),
        figure("simulation of the patrol robot, times real time, least of 6 scenes", min(factors["patrol"]), ""),
        figure("11 drives: numbers that are compared with this machine's", count, ""),
        figure("11 drives: numbers other than this machine's", unequal, "", ("==", 0)),
    ]
    path = BUILD / "bench/page.json"
    path.parent.mkdir(exist_ok=True)
    path.write_text(json.dumps(figures, indent=2, ensure_ascii=False) + "\n")
    for one in figures:
        print(f"{one['name']}: {one['value']:.6g} {one['unit']}")


if __name__ == "__main__":
    main()
