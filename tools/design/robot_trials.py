"""A robot in the making, tried out: programs that know its tables alone, on the non-linear plant."""
import json
import math
import os
import subprocess
import sys
from dataclasses import dataclass

import numpy as np

from tools.common import ROOT, ToolError, read_text, write_whole
from tools.design import closed_loop

# Routes: five legs of 1 to 15 m, each turned by up to 120° from the one before it.
LEGS = 5
LENGTHS = (1.0, 15.0)     # m
TURN = math.radians(120)
TIMEOUT = 900             # s, of a program
ROUTES_DRIVEN = f"Random routes of {LEGS} legs that nothing was fitted to, before anything was learned."
NOT_ARRIVED = 1           # exit status of jp-patrol, which says why in its results

# Segments of experiments are as long as in the paper, or as this robot takes to settle.
SEGMENT_S, SEGMENT_MARGIN = 10.0, 1.25
SETTLED_SHARE, SETTLING_STEP_S, SETTLING_MAX_S = 0.002, 0.02, 120.0
# Voltages are settled that change by less than so much from one window to the next.
SETTLED_V, SETTLED_SUPPLY_SHARE = 0.01, 1 / 2400


def called(command, what, accepted=(0,)):
    """Output of a program that must end with an accepted status; its last line says why it did not."""
    # A make that calls this has its own jobs and targets.
    environment = {name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")}
    try:
        result = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False, cwd=ROOT,
                                timeout=TIMEOUT, env=environment)
    except OSError as error:
        raise ToolError(f"{what}: {command[0]}: {error.strerror}") from None
    except subprocess.TimeoutExpired:
        raise ToolError(f"{what}: {command[0]} takes more than {TIMEOUT} s") from None
    if result.returncode not in accepted:
        lines = [line for line in (result.stderr or result.stdout).splitlines() if line.strip()] or ["no reason given"]
        raise ToolError(f"{what}: {lines[-1]}")
    return result.stdout


def tool(name, *arguments):
    """Another tool of this folder."""
    return called([sys.executable, "-m", f"tools.design.{name}", *arguments], name)


def clear_tables(folder):
    """Those of an earlier attempt."""
    for path in folder.glob("*.c"):
        path.unlink()


def build(folder, *programs):
    """With the tables of folder/tables. Paths: of the programs."""
    paths = [folder / program for program in programs]
    called([os.environ.get("MAKE", "make"), f"CANDIDATE={folder}", *paths], "build")
    return paths


def balance(program, robot_file):
    """What jp-balance says."""
    return json.loads(called([program, robot_file, "--json=-"], "balance"))


def settled_after(robot):
    """s until a step of the speed or of the turn rate leaves of the voltage but SETTLED_SHARE of what it comes to."""
    latest = 0.0
    for axis in closed_loop.axes(robot):
        stride = round(SETTLING_STEP_S * axis.rate_hz)
        ticks, state = np.linalg.matrix_power(axis.matrix, stride), axis.jump(1, 0)
        for step in range(round(SETTLING_MAX_S / SETTLING_STEP_S)):
            if abs(axis.voltage @ state) > SETTLED_SHARE * abs(axis.volts_per_unit):
                latest = max(latest, step * SETTLING_STEP_S)
            state = ticks @ state
    return latest


def experiment(program, robot_file, robot, shaking, folder, count, least):
    """Experiments for identify(); as many as count where they are as short as in the paper, else fewer. shaking: V of noise
    at the motors, which never settles."""
    seconds = math.ceil(max(SEGMENT_S, SEGMENT_MARGIN * settled_after(robot)))
    volts = max(SETTLED_V, SETTLED_SUPPLY_SHARE * robot.positive("supply.voltage_v"), shaking)
    called([program, robot_file, "--output", folder, f"--count={max(least, round(count * SEGMENT_S / seconds))}",
            f"--seconds={seconds}", f"--threshold={volts:.6g}"], "jp-identify")


def identify(robot_file, energy, experiments, tables):
    """The energy model, into tables."""
    tool("identify", robot_file, "--energy", energy, "--experiments", experiments, "--tables", tables)


def draw_points(generator):
    """Of a random route."""
    directions = np.cumsum(generator.uniform(-TURN, TURN, LEGS))
    legs = generator.uniform(*LENGTHS, LEGS)[:, None] * np.column_stack([np.cos(directions), np.sin(directions)])
    return np.vstack([np.zeros(2), np.cumsum(legs, axis=0)])


@dataclass(frozen=True)
class Drive:
    """What was foretold, and what it took."""
    forecast: float  # J, before the start
    driven: float    # J
    seconds: float

    @property
    def error(self):
        """Share of what was driven."""
        return self.forecast / self.driven - 1


@dataclass(frozen=True)
class RouteDrive(Drive):
    """By the first strategy."""
    length: float    # m, straight from point to point
    miss: float      # m, from the waypoint that it passed worst
    end_miss: float  # m, from the last one as it stood


def drive(program, robot_file, folder, seed, energy="motor"):
    """A random route."""
    drawn = draw_points(np.random.default_rng(seed))
    points = ", ".join(f"[{x:.3f}, {y:.3f}]" for x, y in drawn)
    scenario = folder / "route.cfg"
    write_whole(scenario, f'name = "route_{seed}";\nrobot = "{robot_file.resolve()}";\nenergy_model = "identified";\n'
                          f'energy = "{energy}";\nseed = {seed};\nwaypoints = ( {points} );\n')
    called([program, scenario, "--alone", "--output", folder / "route"], f"route {seed}")
    row = json.loads(read_text(folder / "route" / "summary.json"))["strategies"][0]
    return RouteDrive(row["forecast"]["energy_j"], row["total"]["measured_energy_j"], row["total"]["duration_s"],
                      float(np.hypot(*np.diff(drawn, axis=0).T).sum()), max(leg["passed_m"] for leg in row["segments"]),
                      row["segments"][-1]["end_error_m"])


def drive_trips(folder, robot_file, count, seed):
    """What jp-trip says of each: of robots that differ from their file, and have learned a little."""
    program, = build(folder, "jp-trip")
    lines = called([program, robot_file, f"--count={count}", f"--seed={seed}"], "jp-trip")
    return [json.loads(line) for line in lines.splitlines()]


@dataclass(frozen=True)
class SceneDrive(Drive):
    """Of a robot with four steered wheels, by the improved band."""
    arrived: bool
    clearance: float  # m, the least to anything
    miss: float       # m, from the goal as it stood


def drive_scene(program, robot_file, folder, scene, seed):
    """Whether it arrives is for the caller to judge."""
    called([program, scene, "--robot", robot_file, f"--seed={seed}", "--method=improved", "--output", folder / "scene"],
           f"{scene}, seed {seed}", accepted=(0, NOT_ARRIVED))
    row, = json.loads(read_text(folder / "scene" / "summary.json"))["methods"]
    return SceneDrive(row["energy"]["forecast_j"], row["energy_j"], row["time_s"], row["outcome"] == "arrived",
                      row["clearance_min_m"], row["position_error_m"])
