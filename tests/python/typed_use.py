"""Every public name of the package as a program uses it: for the type checker."""
from typing import assert_type

import numpy
from joulepath import (FREE, METHODS, OCCUPIED, SCENES, UNKNOWN, Answer, Error, Lattice, Learner, Mission, Navigation,
                       Patrol, Plan, Planner, Robot, Scenario, Segment, Terrain, door, drive, navigate, patrol, plan,
                       robots, tables)
from numpy.typing import NDArray

Floats = NDArray[numpy.float64]
Rows = NDArray[numpy.void]


def of_maps() -> Terrain:
    terrain = Terrain(numpy.zeros((20, 30), numpy.uint8), 0.2, elevation_m=numpy.zeros((20, 30)), origin=(1, 2, 0.5))
    assert_type(Terrain.load("map.json"), Terrain)
    assert_type((FREE, OCCUPIED, UNKNOWN), tuple[int, int, int])
    assert_type((terrain.name, terrain.shape, terrain.cell_m), tuple[str, tuple[int, int], float])
    assert_type(terrain.origin, tuple[float, float, float])
    assert_type(terrain.cells, NDArray[numpy.uint8])
    assert_type(terrain.elevation_units, NDArray[numpy.int16] | None)
    assert_type(terrain.elevation_m, Floats | None)
    assert_type(terrain.costs, NDArray[numpy.uint8] | None)
    return terrain


def of_robots() -> Robot:
    robot = Robot(robots()[0])
    assert_type((robot.name, robot.length_m, robot.width_m, robot.cell_m), tuple[str, float, float, float])
    assert_type((robot.speed_max, robot.turn_rate_max, robot.grade_max, robot.electronics_w),
                tuple[float, float, float, float])
    assert_type(robot.motion_joules(0.5, 0.0, 1.0, rise=0.1), float)
    assert_type(robot.cheapest_speed(), float)
    for lattice in (Lattice(robot), Lattice.load("lattice.json"), Lattice.for_navigation(robot)):
        assert_type((lattice.robot_name, lattice.cell_m), tuple[str, float])
    return robot


def of_plans(terrain: Terrain, robot: Robot) -> None:
    planner = Planner(terrain, robot, cost="energy", epsilon=[2, 1])
    planner.set_task((1, 1, 0), goal=(2, 2))
    planner.choose_task()
    planner.set_cell(1, 2, OCCUPIED)
    planner.set_elevation(1, 2, 0.5)
    planner.set_cost(1, 2, 3)
    assert_type(planner.is_idle, bool)
    assert_type(planner.counts["expansions"], int)
    found = planner.work(1000)
    assert_type(plan(terrain, robot, start=(1, 1, 0), goal=(2, 2), memory=1 << 20), Plan)
    assert_type((found.answer, found.arrives, found.cost, found.bound), tuple[Answer, bool, int, float | None])
    assert_type((found.joules, found.metres, found.seconds, found.climb_m), tuple[float, float, float, float])
    assert_type(found.route, Rows)
    assert_type(found.xy_m, Floats)


def of_drives(terrain: Terrain, robot: Robot) -> None:
    scenario = Scenario.of("gao2018", [(1, 0), (1, 1)], energy="motor")
    assert_type((Scenario("gao2018_short").name, scenario.robot_name, scenario.is_of_balancer), tuple[str, str, bool])
    driven = drive(scenario, "cruise")
    assert_type(driven, Mission)
    assert_type((driven.joules, driven.metered_joules, driven.seconds, driven.passed_m), tuple[float, float, float, float])
    assert_type((driven.forecast_joules, driven.forecast_deviation, driven.ticks), tuple[float | None, float | None, int])
    assert_type((driven.rows, driven.legs, driven.xy_m), tuple[Rows, Rows, Floats])
    found = navigate(terrain, robot, start=(1, 1, 0), goal=(2, 2), seed=3)
    assert_type(found, Navigation)
    assert_type((found.outcome, found.reason, found.joules, found.touched), tuple[str, str, float, bool])
    assert_type((found.seconds, found.metres, found.planned_joules, found.forecast_joules),
                tuple[float, float, float, float])
    assert_type((found.forecast_deviation, found.clearance_m, found.goal_error_m), tuple[float, float, float])
    assert_type((found.replans, found.cells_seen, found.rows), tuple[int, int, Rows])
    walked = patrol(SCENES[0], seed=1, method=METHODS[0])
    assert_type(walked, Patrol)
    assert_type((walked.outcome, walked.seconds, walked.metres, walked.joules), tuple[str, float, float, float])
    assert_type((walked.reversed_m, walked.clearance_m, walked.position_error_m, walked.heading_error_rad),
                tuple[float, float, float, float])
    assert_type(walked.rows, Rows)


def of_learners() -> None:
    learner = Learner("courier24", energy="battery")
    segments = [Segment(0.5, 0.0, 0.0, 2.0)]
    assert_type(learner.learn(segments, [3.0]), int)
    assert_type(learner.forecast(segments), tuple[float, float])
    assert_type((learner.ground, learner.payload_kg), tuple[tuple[float, float], tuple[float, float]])
    assert_type(learner.changes, tuple[int, str | None])
    assert_type((learner.parameters, learner.coordinates), tuple[Floats, Floats])
    learner.restore(learner.state)


def of_tables() -> None:
    try:
        made = tables.design("gao2018")
    except Error as error:
        print(error)
        return
    assert_type(made, tables.Balancer | tables.SkidSteered)
    assert_type((made.name, made.controller.text), tuple[str, str])
    if isinstance(made, tables.Balancer):
        assert_type((made.gains["wheel"], made.margins["yaw"], made.settling_s), tuple[float, float, float])
        assert_type(made.poles, NDArray[numpy.complex128])
        assert_type((made.a, made.b), tuple[Floats, Floats])
    fitted = tables.identify("gao2018", experiments=10)
    assert_type(fitted, tables.Identified)
    assert_type((fitted.error_percent, fitted.a, fitted.table), tuple[float, Floats, tables.Table])
    assert_type(door.main(), int)
    tables.write_lattice("zhang2018", "lattice.json")
