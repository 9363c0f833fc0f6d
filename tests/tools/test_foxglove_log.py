"""Logs for Foxglove and PlotJuggler: read back with the format's own reader, they say what the programs wrote."""
import json
import math
import subprocess

import numpy as np
import pytest
from conftest import ROOT, assert_one_line_error, run_tool
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory as ProtobufDecoder
from programs import BIN
from tools.report import foxglove_log
from tools.report.results import read_columns

CELL = 0.2


def program(name, folder, *arguments):
    result = subprocess.run([BIN / name, *map(str, arguments), "--output", folder], cwd=ROOT, capture_output=True,
                            text=True, check=False, timeout=600)
    assert result.returncode <= 1 and result.stderr == "", result.stderr
    return folder


def write_map(folder):
    height, width = 40, 60
    rows = ["#" * width] + ["#" + "." * (width - 2) + "#"] * (height - 2) + ["#" * width]
    elevation = [[round(0.4 * math.sin(x / 9), 3) for x in range(width)] for _ in range(height)]
    path = folder / "map.json"
    path.write_text(json.dumps({"format": "joulepath-map-1", "name": "map", "width": width, "height": height,
                                "resolution_m": CELL, "origin_m": [1, 2, 0.5], "rows": rows, "elevation_m": elevation}))
    return path


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    made = {"mission": program("jp-mission", folder / "mission", "sim/scenarios/gao2018_short.cfg", "--alone"),
            "patrol": program("jp-patrol", folder / "patrol", "doorway", "--seed", 7),
            "plan": program("jp-plan", folder / "plan", write_map(folder), "--robot", "zhang2018")}
    for each in made.values():
        assert "wrote" in run_tool("report.foxglove_log", each).stdout
    return made


def read(folder):
    """{topic: [(seconds, message)]} and {topic: name of its schema}."""
    messages, schemas = {}, {}
    with (folder / foxglove_log.LOG).open("rb") as file:
        reader = make_reader(file, decoder_factories=[ProtobufDecoder()])
        for schema, channel, message in reader.iter_messages():
            value = json.loads(message.data) if channel.message_encoding == "json" else \
                ProtobufDecoder().decoder_for(channel.message_encoding, schema)(message.data)
            messages.setdefault(channel.topic, []).append((message.log_time / 1e9, value))
            schemas[channel.topic] = schema.name
    return messages, schemas


@pytest.mark.parametrize("kind, drive", [("mission", "cruise"), ("patrol", "improved"), ("plan", "drive")])
def test_numbers_and_poses_are_those_of_the_program(folders, kind, drive):
    folder = folders[kind]
    summary = json.loads((folder / "summary.json").read_text())
    log = {"mission": lambda: summary["strategies"][0]["log"], "patrol": lambda: summary["methods"][0]["log"],
           "plan": lambda: summary["drive"]["log"]}[kind]()
    columns = read_columns(folder / log, ("t_s", "x_m", "y_m"))
    if kind == "plan":
        columns = foxglove_log.in_map_frame(columns, summary["start"])
    messages, schemas = read(folder)
    rows = messages[f"/{drive}/numbers"]
    assert np.allclose([time for time, _ in rows], columns["t_s"], atol=1e-9)
    for name in rows[0][1]:
        assert [value[name] for _, value in rows] == columns[name].tolist()
    poses = [value.pose for _, value in messages[f"/{drive}/pose"]]
    assert [(pose.position.x, pose.position.y) for pose in poses] == list(zip(columns["x_m"], columns["y_m"]))
    turned = [2 * math.atan2(pose.orientation.z, pose.orientation.w) for pose in poses]
    assert np.allclose(np.exp(1j * np.array(turned)), np.exp(1j * foxglove_log.headings(columns)))
    assert schemas[f"/{drive}/pose"] == "foxglove.PoseInFrame" and schemas[f"/{drive}/way"] == "foxglove.PosesInFrame"
    assert len(messages[f"/{drive}/way"][-1][1].poses) == len(rows)


def test_the_map_is_a_grid(folders):
    messages, schemas = read(folders["plan"])
    [(time, grid)] = messages["/map"]
    assert schemas["/map"] == "foxglove.Grid" and time == 0
    cells = np.frombuffer(grid.data, dtype=[("occupied", "<i1"), ("elevation", "<f4")]).reshape(-1, grid.column_count)
    assert cells.shape == (40, 60) and grid.cell_stride == 5 and grid.row_stride == 300
    assert grid.cell_size.x == pytest.approx(CELL) and (grid.pose.position.x, grid.pose.position.y) == (1, 2)
    assert (cells["occupied"][0] == 100).all() and (cells["occupied"][1:-1, 1:-1] == 0).all()
    assert cells["elevation"][5, 9] == pytest.approx(0.4 * math.sin(1), abs=1e-3)
    assert [(each.name, each.offset) for each in grid.fields] == [("occupied", 0), ("elevation", 1)]


def test_a_drive_along_a_plan_is_on_its_way(folders):
    messages, _ = read(folders["plan"])
    way = np.array([(pose.position.x, pose.position.y) for pose in messages["/ways/energy"][0][1].poses])
    for i in (0, -1):
        position = messages["/drive/pose"][i][1].pose.position
        assert np.hypot(*(way[i] - (position.x, position.y))) < 0.3


def test_planned_ways_and_waypoints_are_there(folders):
    assert {"/ways/energy", "/ways/distance"} <= set(read(folders["plan"])[0])
    waypoints = read(folders["mission"])[0]["/ways/waypoints"][0][1].poses
    assert [waypoints[1].position.x, waypoints[1].position.y] == [0.99, 0.99]


@pytest.mark.parametrize("kind", ["mission", "patrol", "plan"])
def test_the_layout_names_what_is_there(folders, kind):
    messages, _ = read(folders[kind])
    layout = json.loads((folders[kind] / foxglove_log.LAYOUT).read_text())
    assert set(layout["configById"]["3D!way"]["topics"]) <= set(messages)
    paths = [path["value"] for panel in layout["configById"].values() for path in panel.get("paths", ())]
    assert paths and all(path.split(".")[0] in messages and path.split(".")[1] in messages[path.split(".")[0]][0][1]
                         for path in paths)

    def panels(node):
        return {node} if isinstance(node, str) else panels(node["first"]) | panels(node["second"])
    assert panels(layout["layout"]) == set(layout["configById"])


def test_the_same_results_give_the_same_messages(folders):
    recording = foxglove_log.read(folders["patrol"])
    assert foxglove_log.mcap_bytes(recording) == foxglove_log.mcap_bytes(recording)


@pytest.mark.parametrize("summary, says", [
    (None, "No such file"), ("{", "no JSON"), ("{}", "is of none of"), ('{"strategies": [{"name": "a"}]}', "'log'"),
    ('{"strategies": [], "waypoints_m": [[1]]}', "waypoints[0]"), ('{"methods": [], "map": {}}', "key rows")])
def test_what_is_wrong_is_one_line(tmp_path, summary, says):
    if summary is not None:
        (tmp_path / "summary.json").write_text(summary)
    assert_one_line_error(run_tool("report.foxglove_log", tmp_path), says)
    assert not (tmp_path / foxglove_log.LOG).exists()
