"""Routes of least energy over a map, in a block of memory of a given size."""

from __future__ import annotations

import enum
from collections.abc import Sequence
from typing import Any, Literal, TypedDict

import numpy
from numpy.typing import NDArray

from ._call import Error, array_over, check, encoded, record, text
from ._native import ffi, lib
from .robot import Lattice, Robot
from .terrain import Terrain

Cost = Literal["energy", "paper", "distance"]
COSTS: dict[Cost, int] = {"energy": lib.JP_COST_PHYSICAL, "paper": lib.JP_COST_PAPER, "distance": lib.JP_COST_DISTANCE}

_STEP = record("struct plan_step", {"x": ("pose", "x"), "y": ("pose", "y"), "heading": ("pose", "heading"),
                                    "length_m": ("length",), "joules": ("energy",), "seconds": ("time",)})


class Answer(enum.Enum):
    """What is known of a route."""
    NONE_YET = lib.JP_ANSWER_OUT_OF_BUDGET
    OPTIMAL = lib.JP_ANSWER_OPTIMAL
    WITHIN_BOUND = lib.JP_ANSWER_WITHIN_BOUND
    PARTIAL = lib.JP_ANSWER_PARTIAL
    UNREACHABLE = lib.JP_ANSWER_UNREACHABLE
    STALE = lib.JP_ANSWER_STALE


class Plan:
    """A route as it was found.

    answer      what is known of it
    joules      energy of the route; metres: its length; seconds: its duration
    cost        of the route in the planner's units: J/16 where energy is what costs
    bound       no route of the lattice costs less than this one's cost over `bound`; None: nothing is proved
    route       a row a motion, the first is the start: x and y, cells, heading, 0 to 15, length_m, joules and seconds
                so far
    xy_m        where these are, in the map's frame
    climb_m     sum of all rises
    """

    answer: Answer
    cost: int
    bound: float | None
    route: NDArray[numpy.void]
    joules: float
    metres: float
    seconds: float
    climb_m: float
    xy_m: NDArray[numpy.float64]

    def __init__(self, planner: Planner, answer: Answer) -> None:
        """Of Planner.work()."""
        plan = lib.jp_planner_plan(planner._planner)
        route = ffi.new("struct plan_route *")
        check(lib.plan_route_read(planner._planner, planner._lattice._lattice, planner._terrain._terrain,
                                  planner._start, route))
        route = ffi.gc(route, lib.plan_route_free)
        self.answer = answer
        self.cost = plan.cost
        self.bound = None if plan.bound in (0, lib.JP_BOUND_NONE) else plan.bound / 256
        self.route = array_over(route.steps, route.count, _STEP, route)
        self.joules, self.metres, self.seconds = (float(self.route[-1][name])
                                                  for name in ("joules", "length_m", "seconds"))
        self.climb_m = route.climb
        self.xy_m = _in_map_frame(self.route, planner._terrain)

    @property
    def arrives(self) -> bool:
        """Whether the route leads to the goal."""
        return self.answer in (Answer.OPTIMAL, Answer.WITHIN_BOUND)

    def __repr__(self) -> str:
        return f"<Plan {self.answer.name}: {self.joules:.1f} J, {self.metres:.2f} m, {self.seconds:.1f} s>"


def _in_map_frame(route: NDArray[Any], terrain: Terrain) -> NDArray[numpy.float64]:
    x, y, direction = terrain.origin
    grid = (numpy.column_stack([route["x"], route["y"]]) + 0.5) * terrain.cell_m
    cosine, sine = numpy.cos(direction), numpy.sin(direction)
    placed: NDArray[numpy.float64] = grid @ numpy.array([[cosine, sine], [-sine, cosine]]) + (x, y)
    return placed


class Counts(TypedDict):
    """What a planner's block holds and what its search has done."""
    states_max: int    # states that fit
    states: int        # in use
    expansions: int    # since the beginning
    restarts: int      # searches begun anew since
    guide_bytes: int   # of the block, for the guide field
    field_bytes: int   # of the block, for the energy field; 0: it does not fit
    search_bytes: int  # of the block, for states, their hash and queue


class Planner:
    """Anytime and incremental search: planner.h. The map may be changed through it; the search is then repaired."""

    def __init__(self, terrain: Terrain, robot: Robot, lattice: Lattice | None = None, cost: Cost = "energy",
                 memory: int = 8 << 20, epsilon: Sequence[float] = (2.0, 1.0)) -> None:
        """cost: "energy", "paper" or "distance"; memory: of the block, bytes; epsilon: descending, from 1 to 16."""
        if cost not in COSTS:
            raise ValueError(f"cost: {cost!r} is none of {', '.join(COSTS)}")
        self._terrain = terrain
        self._lattice = Lattice(robot) if lattice is None else lattice
        if self._lattice.robot_name != robot.name:
            raise Error(f"lattice: is of {self._lattice.robot_name}, not of {robot.name}; make one for that robot")
        check(lib.plan_lattice_fits(encoded(terrain.name or "map"), terrain._map, self._lattice._lattice))
        self._block = numpy.zeros((memory + 7) // 8, dtype=numpy.uint64)
        self._planner = ffi.new("struct jp_planner *")
        self._start: Any = None
        self._begin(cost, epsilon)

    def _begin(self, cost: Cost, epsilon: Sequence[float]) -> None:
        levels = [round(256 * level) for level in epsilon]
        if not 0 < len(levels) <= lib.JP_EPSILON_LEVELS:
            raise ValueError(f"epsilon: {len(levels)} values; give 1 to {lib.JP_EPSILON_LEVELS}")
        config = ffi.new("struct jp_planner_config *", {"lattice": self._lattice._lattice, "cost": COSTS[cost]})
        for i, level in enumerate(levels):
            config.epsilon[i] = level
        field = ffi.new("const char **")
        least = lib.jp_planner_size(ffi.addressof(self._terrain._terrain, "config"))
        if self._block.nbytes < least:
            raise Error(f"memory: {self._block.nbytes} B are too little for this map; give at least {least} B")
        if lib.jp_planner_init(self._planner, config, self._terrain._terrain, ffi.from_buffer(self._block),
                               self._block.nbytes, field) != lib.JP_OK:
            raise Error(f"planner: {text(field[0]) if field[0] else 'an argument'} is out of range")

    def set_task(self, start: Sequence[float], goal: Sequence[float]) -> None:
        """start: x, y in m of the map's frame and a heading in degrees; goal: the same, or without a heading."""
        task = ffi.new("struct plan_task *")
        check(lib.plan_task_set(self._terrain._map, self._lattice._lattice, _place("start", start, (3,)),
                                _place("goal", goal, (2, 3)), task))
        self._accept("start", lib.jp_planner_set_start(self._planner, ffi.addressof(task, "start")))
        self._accept("goal", lib.jp_planner_set_goal(self._planner, ffi.addressof(task, "goal")))
        self._start = ffi.new("struct jp_lattice_pose *", task.start)

    def choose_task(self) -> None:
        """Two places far apart on the map, every time the same."""
        task = ffi.new("struct plan_task *")
        check(lib.plan_task_choose(self._terrain._map, self._lattice._lattice, task))
        self._accept("start", lib.jp_planner_set_start(self._planner, ffi.addressof(task, "start")))
        self._accept("goal", lib.jp_planner_set_goal(self._planner, ffi.addressof(task, "goal")))
        self._start = ffi.new("struct jp_lattice_pose *", task.start)

    @staticmethod
    def _accept(what: str, status: int) -> None:
        if status != lib.JP_OK:
            raise Error(f"{what}: the robot does not fit there: obstacles or unknown ground; give another place")

    def set_cell(self, x: int, y: int, cell: int) -> None:
        """Changes a cell of the map, by its column and row."""
        self._change("cell", lib.jp_planner_set_cell(self._planner, x, y, cell))

    def set_elevation(self, x: int, y: int, elevation_m: float) -> None:
        """Changes the height of a cell's middle, m within ±32, by its column and row."""
        self._change("elevation", lib.jp_planner_set_elevation(self._planner, x, y,
                                                               round(elevation_m * lib.JP_ELEVATION_ONE)))

    def set_cost(self, x: int, y: int, cost: int) -> None:
        """Changes what driving over a cell costs, 0 to 255 as of Terrain, by its column and row."""
        self._change("cost", lib.jp_planner_set_cost(self._planner, x, y, cost))

    @staticmethod
    def _change(what: str, status: int) -> None:
        if status != lib.JP_OK:
            reason = "off the map" if status == lib.JP_ERR_OUTSIDE else "the map has none, or it is out of range"
            raise Error(f"{what}: {reason}")

    def work(self, expansions: int | None = None) -> Plan:
        """Searches on, by so many expansions or until nothing better can be found, and says what is known."""
        if self._start is None:
            raise Error("planner: there is no task; call set_task() before")
        answer = lib.jp_planner_work(self._planner, 1000 if expansions is None else expansions)
        while expansions is None and not self.is_idle:
            answer = lib.jp_planner_work(self._planner, 1000)
        return Plan(self, Answer(answer))

    @property
    def is_idle(self) -> bool:
        """True when more work cannot improve the answer."""
        return bool(lib.jp_planner_is_idle(self._planner))

    @property
    def counts(self) -> Counts:
        """What the block holds and what the search has done."""
        counts = lib.jp_planner_statistics(self._planner)
        return Counts(states_max=counts.states_max, states=counts.states, expansions=counts.expansions,
                      restarts=counts.restarts, guide_bytes=counts.guide_bytes, field_bytes=counts.field_bytes,
                      search_bytes=counts.search_bytes)


def _place(what: str, place: Sequence[float], lengths: tuple[int, ...]) -> Any:
    if len(place) not in lengths:
        raise ValueError(f"{what}: {len(place)} numbers; give x and y in m and a heading in degrees")
    x, y, *heading = place
    return ffi.new("struct plan_place *", {"x": x, "y": y, "heading_deg": heading[0] if heading else 0,
                                           "has_heading": bool(heading)})


def plan(terrain: Terrain, robot: Robot, start: Sequence[float] | None = None, goal: Sequence[float] | None = None,
         **options: Any) -> Plan:
    """The best route that a planner finds, with the options of Planner; without places, between two that it chooses."""
    planner = Planner(terrain, robot, **options)
    if start is None or goal is None:
        if start is not goal:
            raise Error("start, goal: give both or neither")
        planner.choose_task()
    else:
        planner.set_task(start, goal)
    return planner.work()
