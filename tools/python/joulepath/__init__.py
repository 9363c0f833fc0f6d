"""Joulepath: plans, trajectories, forecasts and simulated robots by joules.

    import joulepath
    terrain = joulepath.Terrain.load("map.json")
    plan = joulepath.plan(terrain, joulepath.Robot("zhang2018"), start=(1, 1, 0), goal=(40, 30))
    print(plan.joules, plan.route["x_m"])

Lengths are in m, angles in rad where a name does not say degrees, times in s, energies in J. What is wrong with an input
is said by Error, in one line.
"""

from . import tables
from ._call import Error
from .learner import Learner, Segment
from .mission import Mission, Scenario, drive
from .navigator import Navigation, navigate
from .patrol import METHODS, SCENES, Patrol, patrol
from .planner import Answer, Plan, Planner, plan
from .robot import Lattice, Robot, robots
from .terrain import FREE, OCCUPIED, UNKNOWN, Terrain

__all__ = ["FREE", "METHODS", "OCCUPIED", "SCENES", "UNKNOWN", "Answer", "Error", "Lattice", "Learner", "Mission",
           "Navigation", "Patrol", "Plan", "Planner", "Robot", "Scenario", "Segment", "Terrain", "drive", "navigate",
           "patrol", "plan", "robots", "tables"]
