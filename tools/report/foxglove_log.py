#!/usr/bin/env python3
"""Make a log that Foxglove and PlotJuggler open from the results of a program.

Reads DIR/summary.json of jp-mission, jp-plan, jp-navigate or jp-patrol, the logs and the map that it names; of a drive
on CAN or LCM after tools.operate.can_report or lcm_report. Writes DIR/joulepath.mcap: a pose, what was
driven so far and all numbers of each drive, planned ways and the map; and DIR/foxglove_layout.json, which shows them
(Foxglove: Layout, Import from file). Exit status 2: bad input; nothing was written.

Topics: /map, /ways/NAME, and of each drive /NAME/pose, /NAME/way, /NAME/numbers. The first frame is map.
"""
import io
import json
from dataclasses import dataclass, field
from pathlib import Path

import foxglove
import numpy as np
from foxglove import channels, messages

from tools.common import ArgumentParser, ToolError, run, shown_path, write_whole
from tools.report.ground import FREE, UNKNOWN, Map, read_map
from tools.report.plan_report import driven_path
from tools.report.results import need, need_points, read_columns, read_json

LOG, LAYOUT = "joulepath.mcap", "foxglove_layout.json"
FRAME = "map"
NANOSECONDS = 1_000_000_000
WAYS_A_SECOND = 1  # how often what was driven so far is shown
POSITION = ("x_m", "y_m")
TEXTS = ("state", "reason")
CELLS = {FREE: 0, UNKNOWN: -1}  # and 100: as ROS has it


@dataclass
class Recording:
    """What a folder of results holds."""
    drives: dict = field(default_factory=dict)  # name: columns
    ways: dict = field(default_factory=dict)    # name: points, m
    ground: Map | None = None


# ---- input ---------------------------------------------------------------------------------------------------------

def read_log(path, texts=()):
    return read_columns(path, ("t_s", *POSITION), rows_min=1, texts=texts)


def of_mission(folder, summary):
    drives = {each["name"]: read_log(folder / each["log"]) for each in summary["strategies"] if "impossible" not in each}
    return Recording(drives, {"waypoints": summary["waypoints_m"]})


def in_map_frame(columns, start):
    """Of a drive that counts from its start: x, y in m and the heading in degrees."""
    heading = np.radians(start[2])
    path = driven_path(columns, start)
    return {**columns, "x_m": path[:, 0], "y_m": path[:, 1], "heading_rad": columns["heading_rad"] + heading}


def of_plan(folder, summary):
    ways = {}
    for route in summary["routes"]:
        steps = read_columns(folder / route["file"], POSITION, rows_min=1)
        ways[route["name"]] = np.column_stack([steps[name] for name in POSITION])
    drive = summary["drive"]
    drives = {} if drive is None else {"drive": in_map_frame(read_log(folder / drive["log"]), summary["start"])}
    return Recording(drives, ways, read_map(Path(summary["map"]["file"])))


def of_navigation(folder, summary):
    ways = {f"course {i + 1}": course["points_m"] for i, course in enumerate(summary["courses"])}
    return Recording({"drive": read_log(folder / summary["log"], ("state",))}, ways, read_map(Path(summary["map"]["file"])))


def of_patrol(folder, summary):
    about = summary["map"]
    need("summary.json", "map", about, ("rows", "resolution_m"))
    cells = np.array([list(row) for row in about["rows"]])[::-1]
    drives = {each["name"]: read_log(folder / each["log"]) for each in summary["methods"]}
    return Recording(drives, {}, Map(cells, None, about["resolution_m"], (0, 0, 0)))


# By a key that the summary of no other program has.
KINDS = {"strategies": of_mission, "routes": of_plan, "courses": of_navigation, "methods": of_patrol}


def read(folder):
    path = folder / "summary.json"
    summary = read_json(path)
    for key, reader in KINDS.items():
        if key in summary:
            try:
                recording = reader(folder, summary)
            except (KeyError, TypeError) as error:
                raise ToolError(f"{path}: {key}: {error} is missing or of another kind; run the program again") from None
            for name, points in recording.ways.items():
                need_points(path, name, np.asarray(points, dtype=float).tolist())
            return recording
    raise ToolError(f"{path}: is of none of jp-mission, jp-plan, jp-navigate and jp-patrol; give one of their folders")


# ---- log -----------------------------------------------------------------------------------------------------------

def stamp(seconds):
    nanoseconds = round(float(seconds) * NANOSECONDS)
    return {"log_time": nanoseconds}, messages.Timestamp(*divmod(nanoseconds, NANOSECONDS))


def pose(x, y, heading=0.0):
    half = float(heading) / 2
    return messages.Pose(position=messages.Vector3(x=float(x), y=float(y)),
                         orientation=messages.Quaternion(z=np.sin(half), w=np.cos(half)))


def headings(columns):
    """rad; where a log has none, the direction of motion."""
    if "heading_rad" in columns:
        return columns["heading_rad"]
    if "heading_deg" in columns:
        return np.radians(columns["heading_deg"])
    steps = [np.gradient(columns[name]) if columns[name].size > 1 else np.zeros(1) for name in POSITION]
    return np.arctan2(steps[1], steps[0])


def log_way(context, topic, points, seconds=0):
    when, timestamp = stamp(seconds)
    channels.PosesInFrameChannel(topic, context=context).log(
        messages.PosesInFrame(timestamp=timestamp, frame_id=FRAME, poses=[pose(x, y) for x, y in points]), **when)


def log_map(context, ground):
    """Occupancy in per cent, −1 where it is not known, and the elevation in m."""
    levels = np.vectorize(lambda cell: CELLS.get(cell, 100), otypes=[np.int8])(ground.cells)
    cells = np.zeros(levels.shape, dtype=[("occupied", "<i1"), ("elevation", "<f4")])
    cells["occupied"] = levels
    cells["elevation"] = 0 if ground.elevation is None else ground.elevation
    number = messages.PackedElementFieldNumericType
    when, timestamp = stamp(0)
    channels.GridChannel("/map", context=context).log(messages.Grid(
        timestamp=timestamp, frame_id=FRAME, pose=pose(*ground.origin), column_count=cells.shape[1],
        cell_size=messages.Vector2(x=ground.resolution, y=ground.resolution), cell_stride=cells.itemsize,
        row_stride=cells.itemsize * cells.shape[1], data=cells.tobytes(),
        fields=[messages.PackedElementField(name="occupied", offset=0, type=number.Int8),
                messages.PackedElementField(name="elevation", offset=1, type=number.Float32)]), **when)


def log_drive(context, name, columns):
    numbers = {key: values for key, values in columns.items() if key != "t_s" and values.dtype.kind == "f"}
    schema = {"type": "object", "title": "joulepath.Numbers", "properties": {key: {"type": "number"} for key in numbers}}
    row_channel = foxglove.Channel(f"/{name}/numbers", schema=schema, context=context)
    pose_channel = channels.PoseInFrameChannel(f"/{name}/pose", context=context)
    way_channel = channels.PosesInFrameChannel(f"/{name}/way", context=context)
    poses = [pose(*row) for row in zip(columns["x_m"], columns["y_m"], headings(columns))]
    shown = -1.0
    for i, time in enumerate(columns["t_s"]):
        when, timestamp = stamp(time)
        row_channel.log({key: float(values[i]) for key, values in numbers.items()}, **when)
        pose_channel.log(messages.PoseInFrame(timestamp=timestamp, frame_id=FRAME, pose=poses[i]), **when)
        if time >= shown + 1 / WAYS_A_SECOND or i + 1 == len(poses):
            shown = time
            way_channel.log(messages.PosesInFrame(timestamp=timestamp, frame_id=FRAME, poses=poses[:i + 1]), **when)


def mcap_bytes(recording):
    context, log = foxglove.Context(), io.BytesIO()
    with foxglove.open_mcap(log, context=context):
        if recording.ground is not None:
            log_map(context, recording.ground)
        for name, points in recording.ways.items():
            log_way(context, f"/ways/{name.replace(' ', '_')}", points)
        for name, columns in recording.drives.items():
            log_drive(context, name, columns)
    return log.getvalue()


# ---- layout --------------------------------------------------------------------------------------------------------

def plot_panel(recording, column, title):
    drives = [name for name, columns in recording.drives.items() if column in columns]
    return {"title": title, "paths": [{"value": f"/{name}/numbers.{column}", "label": name, "enabled": True,
                                       "timestampMethod": "receiveTime"} for name in drives],
            "isSynced": True, "xAxisVal": "timestamp", "showLegend": True}


def layout(recording):
    topics = {"/map": {"visible": True, "colorField": "occupied"}} if recording.ground is not None else {}
    for name in recording.ways:
        topics[f"/ways/{name.replace(' ', '_')}"] = {"visible": True, "type": "line"}
    for name in recording.drives:
        topics[f"/{name}/pose"] = {"visible": True}
        topics[f"/{name}/way"] = {"visible": True, "type": "line"}
    panels = {"3D!way": {"followTf": FRAME, "followMode": "follow-none", "topics": topics,
                         "cameraState": {"perspective": False, "distance": 40, "phi": 0, "thetaOffset": 0}}}
    plots = [("Plot!energy", "energy_j", "Energy, J"), ("Plot!speed", "speed_m_s", "Speed, m/s")]
    shown = [key for key, column, title in plots if plot_panel(recording, column, title)["paths"]]
    panels.update({key: plot_panel(recording, column, title) for key, column, title in plots if key in shown})
    side = shown[0] if len(shown) == 1 else {"direction": "column", "first": shown[0], "second": shown[-1]} if shown else None
    return {"configById": panels, "globalVariables": {}, "userNodes": {}, "playbackConfig": {"speed": 1},
            "layout": {"direction": "row", "first": "3D!way", "second": side, "splitPercentage": 60} if side else "3D!way"}


# ---- program -------------------------------------------------------------------------------------------------------

def main():
    parser = ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", metavar="DIR", help="results of a program, such as build/sil")
    folder = Path(parser.parse_args().folder)
    recording = read(folder)
    write_whole(folder / LOG, mcap_bytes(recording))
    write_whole(folder / LAYOUT, json.dumps(layout(recording), indent=1) + "\n")
    print(f"wrote {shown_path(folder / LOG)} and {shown_path(folder / LAYOUT)}")
    return 0


if __name__ == "__main__":
    run(main)
