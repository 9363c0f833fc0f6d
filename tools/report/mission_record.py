"""The record of a drive, from the telemetry of a robot: what tools/report/report.py makes a page of.

    record = MissionRecord("yard.log")
    record.route([(10, 10), (20, 15)])                  # before the plan of its first segment
    record.segment_plan(12.401, 1, 335.9, 0.5, 0.011, 0.63, 28.6)
    record.pose(12.421, 0.0, 0.0, 0.63)                 # and motion(), reference(), motors() … as they come
    record.segment_result(41.0, 1, 336.9, 270.1)
    record.write(directory)

Where the telemetry came from does not matter. All units are SI: m, rad, s, V, A, J; turns are converted before. Times
are those of one clock, whatever its zero, and never fall within one kind of message. Headings may wrap. Segments are
numbered from 1 since the robot last stood. The record is of the last drive in which a segment ended; a drive begins
with the plan of segment 1, unless the route before has waypoints left.
"""
import json
import math
from dataclasses import dataclass, field

import numpy as np

from tools.common import ToolError, write_whole

STRATEGY = "cruise"
LOG_NAME = f"log_{STRATEGY}.csv"
SUMMARY_NAME = "summary.json"

# Columns of the log and how they are written, as jp-mission does.
LOG_FORMAT = {"t_s": ".3f", "x_m": ".5f", "y_m": ".5f", "ref_x_m": ".5f", "ref_y_m": ".5f", "heading_rad": ".6f",
              "speed_m_s": ".5f", "turn_rate_rad_s": ".6f", "ref_speed_m_s": ".5f", "ref_turn_rate_rad_s": ".6f",
              "pitch_deg": ".4f", "u_left_v": ".4f", "u_right_v": ".4f", "i_left_a": ".4f", "i_right_a": ".4f",
              "power_w": ".4f", "energy_j": ".4f", "segment": ".0f"}

SAMPLES_MIN = 2

# Shortest time over which power is a mean, s: samples that were held up come in a bunch.
POWER_TIME_MIN = 0.001


@dataclass
class Segment:
    """A plan, of which any part may be unknown, and its result once the segment has ended."""
    ahead: list  # the targets of this segment and the next ones
    begun: float
    energy: float | None
    speed: float | None
    turn_rate: float | None
    turn: float | None
    duration: float | None
    ended: float | None = None
    spent: float | None = None
    drawn: float | None = None


@dataclass
class Drive:
    """From stand to stand: the segments by number."""
    segments: dict = field(default_factory=dict)

    def ended(self):
        """The numbers of the segments that have ended."""
        return [index for index, segment in self.segments.items() if segment.ended is not None]


class MissionRecord:
    """Takes a drive's telemetry in the order in which it comes. `source` names it to people, in errors too."""

    def __init__(self, source):
        self.source = source
        self._samples = {name: [] for name in ("pose", "speed", "reference", "voltages", "currents", "energy spent")}
        self._route, self._route_first = [], None
        self._drives, self._before = [Drive()], 0

    # ---- telemetry -------------------------------------------------------------------------------------------------

    def route(self, targets):
        """The segments planned from now on lead to these points (x, y), m, one after the other. A goal is a route of
        one point. Called once for each new route."""
        self._route, self._route_first = [tuple(map(float, target)) for target in targets], None

    def pose(self, t, x, y, heading):
        """Where odometry has the robot: m, rad."""
        self._samples["pose"].append((t, x, y, heading))

    def motion(self, t, speed, turn_rate, pitch):
        """As measured: m/s, rad/s, rad."""
        self._samples["speed"].append((t, speed, turn_rate, pitch))

    def reference(self, t, speed, turn_rate, heading):
        """What the controller follows: m/s, rad/s, rad."""
        self._samples["reference"].append((t, speed, turn_rate, heading))

    def motors(self, t, left, right):
        """Voltages, V."""
        self._samples["voltages"].append((t, left, right))

    def currents(self, t, left, right):
        """A; about as often as motors()."""
        self._samples["currents"].append((t, left, right))

    def energy_spent(self, t, energy):
        """Motors' losses and electronics since any fixed moment, J."""
        self._samples["energy spent"].append((t, energy))

    def segment_plan(self, t, index, energy=None, speed=None, turn_rate=None, turn=None, duration=None):
        """Segment `index` has been planned: J, m/s, rad/s, rad, s; None is unknown. The first one begins at once, a
        later one when the one before ends. A plan of the same index replaces the earlier one."""
        if index == 1:
            self._count_anew()
        number = self._before + index
        if self._route_first is None or number < self._route_first:
            self._route_first = number
        ahead = self._route[number - self._route_first:]
        self._drives[-1].segments[number] = Segment(ahead, t, energy, speed, turn_rate, turn, duration)

    def segment_result(self, t, index, spent, drawn=None):
        """Segment `index` has ended: J as energy_spent() counts, J from the battery or None."""
        segment = self._drives[-1].segments.setdefault(self._before + index, Segment([], t, *[None] * 5))
        segment.ended, segment.spent, segment.drawn = t, spent, drawn

    def _count_anew(self):
        """A new drive; or the robot stood in the midst of its route, because the next plan was late."""
        ended = self._drives[-1].ended()
        goes_on = ended and self._route_first is not None and self._drives[-1].segments[max(ended)].ahead[1:]
        if goes_on:
            self._before = max(ended)
        elif ended:
            self._drives.append(Drive())
            self._before = 0

    # ---- results ---------------------------------------------------------------------------------------------------

    def write(self, directory, about=None):
        """Write summary.json, with what else is known `about` the drive by its keys, and the log. ToolError: no drive, or
        parts of it are missing; nothing was written."""
        summary, log = self.results()
        summary.update(about or {})
        lines = [",".join(LOG_FORMAT)]
        lines += [",".join(format(value, form) for value, form in zip(row, LOG_FORMAT.values())) for row in log.T]
        write_whole(directory / LOG_NAME, "\n".join(lines) + "\n")
        write_whole(directory / SUMMARY_NAME, json.dumps(summary, indent=1) + "\n")

    def results(self):
        """The summary as a dict, and the log, an array with a row for each column of LOG_FORMAT. ToolError as write().
        """
        segments = self._driven()
        start, end = segments[0].begun, segments[-1].ended
        samples = {name: self._columns(name, start, end) for name in self._samples}
        for name in ("pose", "reference"):
            samples[name][3] = np.unwrap(samples[name][3])
        return _summary(self.source, segments, samples["pose"]), _log(segments, samples)

    def _driven(self):
        """The segments of the last drive up to the last one that ended, each of them whole."""
        drives = [drive for drive in self._drives if drive.ended()]
        if not drives:
            raise ToolError(f"{self.source}: no segment was driven to its end")
        segments = []
        for index in range(1, max(drives[-1].ended()) + 1):
            segment = drives[-1].segments.get(index)
            if segment is None or segment.ended is None or segment.begun >= segment.ended:
                raise ToolError(f"{self.source}: segment {index}: its plan or its end is missing; record from before "
                                f"the route is sent until the robot stands")
            if not segment.ahead:
                raise ToolError(f"{self.source}: segment {index}: its waypoint is missing; record from before the "
                                f"route is sent")
            segments.append(segment)
        return segments

    def _columns(self, name, start, end):
        """The samples from start to end and those next to them, by column; the first is time."""
        samples = self._samples[name]
        if sum(start <= sample[0] <= end for sample in samples) < SAMPLES_MIN:
            raise ToolError(f"{self.source}: {name}: not in the record of the drive")
        table = np.array(samples, dtype=float)
        t = table[:, 0]
        if not np.isfinite(table).all() or np.any(np.diff(t) < 0):
            raise ToolError(f"{self.source}: {name}: time runs backwards, or a value is not finite")
        first = max(int(np.searchsorted(t, start, side="right")) - 1, 0)
        last = int(np.searchsorted(t, end, side="left")) + 1
        return table[first:last].T


def _at(columns, t):
    """Each column but time at the time or times t."""
    return [np.interp(t, columns[0], column) for column in columns[1:]]


def _durations(segments):
    ends = [segments[0].begun, *(segment.ended for segment in segments)]
    return [after - before for before, after in zip(ends, ends[1:])]


def _sum(values):
    """None if a part is unknown."""
    values = list(values)
    return None if None in values else sum(values)


# ---- summary -------------------------------------------------------------------------------------------------------

def _about_segment(index, segment, duration, pose):
    x, y, _ = map(float, _at(pose, segment.ended))
    known = segment.energy is not None and segment.spent
    arc = None if None in (segment.turn_rate, segment.duration) else segment.turn_rate * segment.duration
    return {"index": index, "target_m": list(segment.ahead[0]), "planned_energy_j": segment.energy,
            "measured_energy_j": segment.spent, "plant_energy_j": None, "battery_energy_j": segment.drawn,
            "error_percent": 100 * (segment.energy / segment.spent - 1) if known else None, "duration_s": duration,
            "speed_m_s": segment.speed, "turn_rate_rad_s": segment.turn_rate,
            "turn_deg": None if segment.turn is None else math.degrees(segment.turn), "arc_rad": arc, "end_m": [x, y],
            "end_error_m": math.hypot(x - segment.ahead[0][0], y - segment.ahead[0][1])}


def _summary(source, segments, pose):
    durations = _durations(segments)
    start = [float(pose[1][0]), float(pose[2][0])]
    left = segments[-1].ahead[1:]
    title = "recorded drive" + (f", {len(segments)} of {len(segments) + len(left)} segments" if left else "")
    total = {"planned_energy_j": _sum(segment.energy for segment in segments),
             "measured_energy_j": _sum(segment.spent for segment in segments), "plant_energy_j": None,
             "battery_energy_j": _sum(segment.drawn for segment in segments), "duration_s": sum(durations),
             "relative_percent": 100.0}
    about = [_about_segment(index, segment, duration, pose)
             for index, (segment, duration) in enumerate(zip(segments, durations), start=1)]
    return {"robot": None, "scenario": source, "energy_model": None, "energy": None, "seed": None,
            "waypoints_m": [start, *(list(segment.ahead[0]) for segment in segments), *map(list, left)],
            "strategies": [{"name": STRATEGY, "title": title, "log": LOG_NAME, "forecast": None,
                            "segments": about, "total": total}],
            "simulation": None}


# ---- log -----------------------------------------------------------------------------------------------------------

def _reference_path(reference, start):
    """Where the reference is at each of its samples, from `start` on, by dead reckoning."""
    t, speed, _, heading = reference
    way = np.diff(t) * (speed[1:] + speed[:-1]) / 2 * np.exp(0.5j * (heading[1:] + heading[:-1]))
    return complex(*start) + np.concatenate([[0], np.cumsum(way)])


def _power(t, energy):
    """Mean power since the sample before, W; the first sample takes over that of the second."""
    power = np.diff(energy) / np.maximum(np.diff(t), POWER_TIME_MIN)
    return np.concatenate([power[:1], power])


def _log(segments, samples):
    pose, reference, spent = samples["pose"], samples["reference"], samples["energy spent"]
    start, end = segments[0].begun, segments[-1].ended
    t = pose[0][(pose[0] >= start) & (pose[0] <= end)]
    x, y, heading = _at(pose, t)
    speed, turn_rate, pitch = _at(samples["speed"], t)
    reference_speed, reference_turn_rate, _ = _at(reference, t)
    path = np.interp(t, reference[0], _reference_path(reference, (x[0], y[0])))
    power = np.interp(t, spent[0], _power(*spent))
    energy = np.interp(t, *spent) - spent[1][0]
    ends = [segment.ended for segment in segments[:-1]]
    segment = 1 + np.searchsorted(ends, t, side="left")
    return np.array([t - start, x, y, path.real, path.imag, heading, speed, turn_rate, reference_speed,
                     reference_turn_rate, np.degrees(pitch), *_at(samples["voltages"], t), *_at(samples["currents"], t),
                     power, energy, segment])
