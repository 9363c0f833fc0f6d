"""A drive on a map over LCM, each program a process, in simulated time: lcm_navigate.py sends map and goal, and a team's
sensor, here, a box that the map does not show. Before and after it what jp-lcm refuses. To be run in a network namespace
of its own; says in DIR/drive.json how all ended.

    lcm_navigation.py DIR MAP START GOAL
"""
import contextlib
import math
import sys
from pathlib import Path

import lcm
from lcm_drive import jp, run, start_all, stop_all, wait_until_taken
from lcm_network import URL

ORIGIN, CELL = 1.0, 0.1  # m: where the robot was switched on, as START says; of the map
AHEAD = 1.2              # m


class Motion:
    """The last JP_STATE, and what its task has been."""

    def __init__(self, link):
        self.state, self.tasks, self.map_id = None, [], None
        self._link = link
        link.subscribe("JP_STATE", self._hear)
        link.subscribe("JP_MAP", self._hear_map)

    def _hear_map(self, _, data):
        with contextlib.suppress(ValueError):  # rubbish
            self.map_id = jp.map_t.decode(data).map_id

    def _hear(self, _, data):
        self.state = jp.state_t.decode(data)
        if self.tasks[-1:] != [self.state.task]:
            self.tasks.append(self.state.task)

    def hear_all(self):
        while self._link.handle_timeout(0):
            pass

    def rolls(self):
        self.hear_all()
        return self.state is not None and self.state.task == jp.state_t.TASK_DRIVING and self.state.speed > 0.2


def cells_message(map_id, cells):
    message = jp.cells_t()
    message.map_id, message.count = map_id, len(cells)
    for x, y, value in cells:
        cell = jp.cell_t()
        cell.x, cell.y, cell.cell = x, y, value
        message.cells.append(cell)
    return message.encode()


def goal_message(map_id, x, y):
    message = jp.map_goal_t()
    message.map_id, message.point.x, message.point.y = map_id, x, y
    return message.encode()


def box_ahead(state):
    x = round((ORIGIN + state.x + AHEAD * math.cos(state.heading)) / CELL)
    y = round((ORIGIN + state.y + AHEAD * math.sin(state.heading)) / CELL)
    return [(u, v, 1) for v in range(y - 2, y + 2) for u in range(x - 2, x + 2)]


def send_rubbish_before(link):
    link.publish("JP_MAP_GOAL", goal_message(1, 1, 1))
    link.publish("JP_CELLS", cells_message(1, [(1, 1, 1)]))
    link.publish("JP_MAP", b"no map")


def send_rubbish_after(link, map_id):
    link.publish("JP_MAP_GOAL", goal_message(map_id, 100, 1))
    link.publish("JP_MAP_GOAL", goal_message(map_id % 15 + 1, 1, 1))
    link.publish("JP_CELLS", cells_message(map_id, [(1, 1, 7)]))
    link.publish("JP_CELLS", cells_message(map_id, []))
    link.publish("JP_CELLS", cells_message(map_id, [(1, 1, 1)])[:-1])


def play(stage, the_map, start, goal):
    passing = start_all(stage, "courier24", ("navigate", sys.executable, "-m", "tools.operate.lcm_navigate", "--lcm", URL,
                                             "--map", the_map, f"--start={start}", f"--goal={goal}"))
    link = lcm.LCM(URL)
    motion = Motion(link)
    send_rubbish_before(link)
    passing.run_until("motion", lambda: motion.rolls() or stage.has_ended("navigate"))
    if motion.map_id is not None:
        link.publish("JP_CELLS", cells_message(motion.map_id, box_ahead(motion.state)))
        send_rubbish_after(link, motion.map_id)
        wait_until_taken()
    passing.run_until("arrival", lambda: motion.hear_all() or stage.has_ended("navigate"))
    return stop_all(stage, passing)


if __name__ == "__main__":
    run(Path(sys.argv[1]), lambda stage: play(stage, *sys.argv[2:5]))
