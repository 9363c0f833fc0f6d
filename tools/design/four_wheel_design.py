"""A robot with four steered wheels from its file: the tables of its controller are made, its energy and what it can learn are
identified, and it finds its way through scenes that nothing was fitted to."""
import json

import numpy as np

from tools.common import read_text
from tools.design import robot_json, robot_trials
from tools.design.robot_findings import Made, Steps, at_least, at_most, information

# People are left out: whether they let a robot pass is not the robot's to say.
SCENES = ("beside-obstacle", "l-passage", "corridor", "doorway", "warehouse")
SEEDS = range(2001, 2005)  # no development used them

# What a robot must do.
LEARNED_MEAN = 1.5  # %, of routes of robots that differ, after ten legs


def design_controller(making):
    robot_trials.clear_tables(making.tables)
    robot_trials.tool("patrol_table", making.robot_file, "--tables", making.tables)


def identify(making):
    """The energy model, and what the robot can learn of it."""
    robot_trials.called([robot_json.build_directory() / "bin" / "jp-four-wheel-identify", making.robot_file, "--output",
                         making.experiments], "jp-four-wheel-identify")
    robot_trials.tool("four_wheel_identify", making.robot_file, "--experiments", making.experiments, "--tables",
                      making.tables)
    return json.loads(read_text(making.experiments / "identification.json"))


def drive_scenes(making):
    program, = robot_trials.build(making.folder, "jp-patrol")
    return [robot_trials.drive_scene(program, making.robot_file, making.folder, scene, seed)
            for scene in SCENES for seed in SEEDS]


def findings_of(robot, identified, drives):
    arrived = [drive for drive in drives if drive.arrived]
    errors = 100 * np.abs([drive.error for drive in arrived])
    tolerance_cm = 100 * robot.positive("patrol.position_tolerance_m")
    return [
        information("energy model, mean error on random drives", identified["random_percent"]["mean"], "%"),
        at_most("routes of robots that differ, learned, mean error", identified["taught_percent"]["mean"], "%", LEARNED_MEAN,
                "nothing in the robot file: it differs in more than it learns"),
        at_least(f"arrives, of {len(drives)} drives through scenes", 100 * len(arrived) / len(drives), "%", 100,
                 "a smaller body, a smaller band.clearance_m, or a better laser"),
        at_least("least clearance on the way", 100 * min(drive.clearance for drive in drives), "cm", 0.1,
                 "a larger band.clearance_m, or a lower band.speed_m_s"),
        at_most("stands off its goal by at most", 100 * max((drive.miss for drive in arrived), default=np.inf), "cm",
                tolerance_cm, "a finer laser, or a larger patrol.position_tolerance_m"),
        information("forecast before the start against these, mean error", np.mean(errors) if arrived else np.nan, "%"),
    ]


def make(making):
    """Every step."""
    steps = Steps(4)
    robot = steps.do("robot file", lambda: robot_json.load_four_wheel(making.robot_file))
    steps.do("controller", lambda: design_controller(making))
    identified = steps.do("energy, and what it can learn, identified in drives", lambda: identify(making))
    drives = steps.do(f"{len(SCENES)} scenes, {len(SEEDS)} times each", lambda: drive_scenes(making))
    return Made(robot, findings_of(robot, identified, drives),
                "Scenes that nothing was fitted to, before anything was learned.", drives)
