"""Logs of a simulated robot, of every kind, and robot files that are wrong."""
import csv
import io
import math
import sys

import lcm
import numpy as np
from conftest import ROOT
from programs import BIN, BUILD

from tools.common import read_text, write_whole
from tools.design import robot_json, robot_trials
from tools.identify import log_can, robot_fit, robot_text

sys.path.insert(0, str(BUILD / "lcm"))
import jp  # noqa: E402

WRONG = 0.2
TURNS = ((1.5, 0), (1.5, 1), (0, 1), (-1, 0), (-1, -1), (1, -1), (1.5, 0), (0, 0), (0.5, 0), (0.5, 0.5), (0, 0))
STRAIGHT = ((2.0, 0.0),)
US = 1e6


def robot_file(name):
    return ROOT / f"sim/robots/{name}.cfg"


def drive(name, points, folder):
    """The frames of a drive, in one process."""
    folder.mkdir(parents=True, exist_ok=True)
    route = ", ".join(f"[{x}, {y}]" for x, y in ((0.0, 0.0), *points))
    write_whole(folder / "route.cfg", f'name = "log";\nrobot = "{robot_file(name)}";\nenergy_model = "identified";\n'
                                      f'seed = 1;\nwaypoints = ( {route} );\nend = "stand";\n')
    robot_trials.called([BIN / "jp-plant", folder / "route.cfg", "--bus", "in-process", "--frames", "--output", folder],
                        "drive")
    return folder / "frames.log"


def length_of(folder):
    """m, between begin and end of the drive."""
    x, y = map(float, read_text(folder / "log_cruise.csv").splitlines()[-1].split(",")[1:3])
    return math.hypot(x, y)


def write_wrong(name, folder, seed, right=()):
    """A file of the same name, wrong in all its constants but some."""
    true, generator = robot_json.load(robot_file(name)), np.random.default_rng(seed)
    values = {key: true.number(key) * (1 + WRONG * generator.choice([-1, 1]))
              for key in robot_fit.UNITS if true.number(key) > 0}
    voltage = values["supply.voltage_v"]
    if not true.number("control.voltage_min_v") < voltage < true.number("control.voltage_max_v"):
        values["supply.voltage_v"] = 2 * true.number("supply.voltage_v") - voltage
    path = folder / f"{name}.cfg"
    write_whole(path, robot_text.rewritten(path, read_text(robot_file(name)),
                                           {key: value for key, value in values.items() if key not in right}))
    return path


def as_csv(frames, robot, path):
    """Samples and counters as somebody else might log them."""
    log = log_can.read(frames, robot)
    names = {"wheel_left_rad": "wheel_left", "wheel_right_rad": "wheel_right", "pitch_rate_rad_s": "pitch_rate",
             "yaw_rate_rad_s": "yaw_rate", "voltage_left_v": "voltage_left", "voltage_right_v": "voltage_right",
             "current_left_a": "current_left", "current_right_a": "current_right", "bus_voltage_v": "bus_voltage",
             "battery_voltage_v": "battery_voltage", "battery_current_a": "battery_current",
             "reference_speed_m_s": "reference_speed", "reference_turn_rate_rad_s": "reference_turn_rate",
             "drawn_j": "drawn"}
    times = log["wheel_left"].times
    columns = [log[name].values_at(times) for name in names.values()]
    for column, name in zip(columns, names.values()):
        if name.startswith("battery"):  # comes ten times a second; between its rows are empty cells
            heard = np.searchsorted(times, log[name].times - 1e-6)
            column[np.setdiff1d(np.arange(len(times)), heard)] = math.nan
    begin, end = log.active[0]
    on = ((times >= begin) & (times <= end)).astype(int)
    numbers = np.zeros(len(times), int)
    for index, segment in enumerate(log.segments, start=1):
        numbers[(times >= segment.begin) & (times < segment.end)] = index
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(["time_s", *names, "motors_on", "segment"])
    for row in zip(times, *columns, on, numbers):
        writer.writerow(["" if math.isnan(value) else f"{value:.9g}" for value in row])
    write_whole(path, text.getvalue())
    return path


class Gateway:
    """What jp-lcm makes of telemetry: a message of each kind with each Motors."""

    def __init__(self, frames, rate):
        messages = log_can.in_simulated_time(log_can.read_messages(frames), rate)
        self._messages = messages
        self._signals = {name: log_can.decoded(name, messages[name]) for name in messages}

    def _last(self, name, signal, places, factor=1.0):
        frames = self._messages[name]
        index = log_can.last_before(frames, places)
        return np.where(index >= 0, self._signals[name][signal][index] * factor, 0.0)

    def write(self, path):
        motors = self._messages["Motors"]
        places, turn = motors.places, 2 * math.pi
        state = {"speed": self._last("Motion", "Speed", places),
                 "turn_rate": self._last("Motion", "YawRate", places, turn),
                 "pitch": self._last("Motion", "Pitch", places, turn),
                 "pitch_rate": self._last("Motion", "PitchRate", places, turn),
                 "reference_speed": self._last("Reference", "Speed", places),
                 "reference_turn_rate": self._last("Reference", "YawRate", places, turn),
                 "voltage_left": self._signals["Motors"]["VoltageLeft"],
                 "voltage_right": self._signals["Motors"]["VoltageRight"],
                 "current_left": self._last("CurrentSensors", "CurrentLeft", places),
                 "current_right": self._last("CurrentSensors", "CurrentRight", places),
                 "robot_state": self._last("EcuStatus", "State", places)}
        energy = {"spent": self._last("EnergySpent", "Energy", places),
                  "drawn": self._last("EnergyDrawn", "Energy", places),
                  "battery_voltage": self._last("BatteryStatus", "Voltage", places),
                  "battery_current": self._last("BatteryStatus", "Current", places),
                  "segment": self._last("SegmentResult", "Segment", places),
                  "segment_forecast": self._last("SegmentForecast", "Energy", places),
                  "segment_spent": self._last("SegmentResult", "Spent", places),
                  "segment_drawn": self._last("SegmentResult", "Drawn", places)}
        log = lcm.EventLog(str(path), "w", overwrite=True)
        self._write_plans(log, places)
        for index, time in enumerate(motors.times):
            for channel, kind, values in (("JP_STATE", jp.state_t, state), ("JP_ENERGY", jp.energy_t, energy)):
                self._publish(log, channel, kind, time, {name: column[index] for name, column in values.items()})
        log.close()
        return path

    def _publish(self, log, channel, kind, time, values):
        message = kind()
        message.utime = round(time * US)
        for name, value in values.items():
            whole = name in ("robot_state", "segment")
            setattr(message, name, int(value) if whole else float(value))
        log.write_event(message.utime, channel, message.encode())

    def _write_plans(self, log, places):
        shapes, signals = self._messages["SegmentShape"], self._signals["SegmentShape"]
        for time, index, duration in zip(shapes.times, signals["Segment"], signals["Duration"]):
            plan, segment = jp.plan_t(), jp.segment_t()
            plan.utime, plan.segment_count = round(time * US), 1
            segment.index, segment.duration = int(index), float(duration)
            plan.segments = [segment]
            log.write_event(plan.utime, "JP_PLAN", plan.encode())
