"""Routes of least energy over a map, in a block of memory of a given size."""

from __future__ import annotations

import enum
from collections.abc import Sequence
from functools import cached_property
from typing import Any, Literal, TypedDict

import numpy
from numpy.typing import NDArray

from ._call import Error, array_over, check, record
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
    climb_m     sum of all rises
    """

    answer: Answer
    cost: int
    bound: float | None
    joules: float
    metres: float
    seconds: float
    climb_m: float

    def __init__(self, planner: Planner) -> None:
        """Of Planner.work()."""
        route = ffi.new("struct plan_route *")
        check(lib.planning_read(planner._planning, route))
        self._route, self._terrain = ffi.gc(route, lib.plan_route_free), planner._terrain
        plan, end = lib.jp_planner_plan(planner._planner), route.steps[route.count - 1]
        self.answer = Answer(planner._planning.answer)
        self.cost = plan.cost
        self.bound = None if plan.bound in (0, lib.JP_BOUND_NONE) else plan.bound / 256
        self.joules, self.metres, self.seconds, self.climb_m = end.energy, end.length, end.time, route.climb

    @cached_property
    def route(self) -> NDArray[numpy.void]:
        """A row a motion, the first is the start: x and y, cells, heading, 0 to 15, length_m, joules and seconds so far."""
        return array_over(self._route.steps, self._route.count, _STEP, self._route)

    @cached_property
    def xy_m(self) -> NDArray[numpy.float64]:
        """Where these are, in the map's frame."""
        return _in_map_frame(self.route, self._terrain)

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
        if not 0 < len(epsilon) <= lib.JP_EPSILON_LEVELS:
            raise ValueError(f"epsilon: {len(epsilon)} values; give 1 to {lib.JP_EPSILON_LEVELS}")
        self._planning = ffi.gc(ffi.new("struct planning *"), lib.planning_free)
        self._planner = ffi.addressof(self._planning, "planner")
        self._has_task = False
        check(lib.planning_begin(self._planning, terrain._map, self._lattice._lattice, COSTS[cost], tuple(epsilon),
                                 len(epsilon), memory))

    def set_task(self, start: Sequence[float], goal: Sequence[float]) -> None:
        """start: x, y in m of the map's frame and a heading in degrees; goal: the same, or without a heading."""
        _count("start", start, (3,))
        _count("goal", goal, (2, 3))
        check(lib.planning_set_task(self._planning, tuple(start), tuple(goal), len(goal)))
        self._has_task = True

    def choose_task(self) -> None:
        """Two places far apart on the map, every time the same."""
        check(lib.planning_choose_task(self._planning))
        self._has_task = True

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
        if not self._has_task:
            raise Error("planner: there is no task; call set_task() before")
        is_idle = lib.planning_work(self._planning, 1000 if expansions is None else expansions)
        while expansions is None and not is_idle:
            is_idle = lib.planning_work(self._planning, 1000)
        return Plan(self)

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


def _count(what: str, place: Sequence[float], counts: tuple[int, ...]) -> None:
    if len(place) not in counts:
        raise ValueError(f"{what}: {len(place)} numbers; give x and y in m and a heading in degrees")


def _place(what: str, place: Sequence[float], lengths: tuple[int, ...]) -> Any:
    _count(what, place, lengths)
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
