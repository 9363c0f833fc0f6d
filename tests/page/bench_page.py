#!/usr/bin/env python3
"""The page in a browser without a window: its size over the wire, its first frame, how fast it simulates, and how far
what it drives is from what this machine's mathematics give. Writes figures for tools/measure/figures.py."""
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


def main():
    browser = Browser()
    first = statistics.median(first_frames(browser))
    open_page(browser)
    browser.click("#pause")
    same_libm, host_libm = Native(BUILD / "page-native/libpage-musl.so"), Native(BUILD / "page-native/libpage.so")
    factors, differences, unequal = {}, [], 0
    for scene, drives in DRIVES.items():
        for calls in drives:
            view, factor = driven_there(browser, scene, calls)
            factors.setdefault(scene, []).append(factor)
            same = driven_here(same_libm, scene, calls)
            unequal += sum(value == value and value != view[name] for name, value in same.items())
            differences.append(abs(view["driven_j"] / driven_here(host_libm, scene, calls)["driven_j"] - 1))
    assert len(differences) == 11
    browser.close()
    figures = [
        figure("over the wire, compressed", compressed(), "kB", ("<=", 700)),
        figure(f"first frame, median of {OPENINGS}", first, "s", ("<=", 2)),
        figure("simulation of the balancer, times real time, least of 2 robots", min(factors["balancer"]), "", (">=", 50)),
        figure("simulation of robots that find their way, times real time, least of 3", min(factors["planner"]), ""),
        figure("simulation of the patrol robot, times real time, least of 6 scenes", min(factors["patrol"]), ""),
        figure("11 drives: numbers other than those of this machine with the same mathematics", unequal, "", ("==", 0)),
        figure("11 drives: energy against this machine's own mathematics, largest difference", 100 * max(differences), "%", ("<=", 0.1)),
    ]
    path = BUILD / "bench/page.json"
    path.parent.mkdir(exist_ok=True)
    path.write_text(json.dumps(figures, indent=2, ensure_ascii=False) + "\n")
    for one in figures:
        print(f"{one['name']}: {one['value']:.6g} {one['unit']}")


if __name__ == "__main__":
    main()
