"""jp-patrol: every scene, tables, files and sums, faults, maps of others, every wrong input."""
import csv
import json
import math
import re
import resource

import pytest
from conftest import ROOT, assert_one_line_error, fill_disk, run

ROBOT = ROOT / "sim/robots/patrol.cfg"
SCENES = ["beside-obstacle", "l-passage", "corridor", "doorway", "pedestrian", "warehouse"]
METHODS = ["improved", "plain", "pursuit"]
TITLES = {"improved": "improved TEB", "plain": "plain TEB", "pursuit": "pure pursuit"}
FILES = sorted([*(f"log_{method}.csv" for method in METHODS), "summary.json"])
CELL = 0.05
COLUMNS = {"time_s": 0, "length_m": 1, "energy_j": 2, "reversed_m": 3, "direction_changes": 4, "clearance_min_m": 5,
           "position_error_m": 6, "heading_error_deg": 7, "odometry_error_m": 8}


# ---- runs ----------------------------------------------------------------------------------------------------------

def patrol(output, *arguments, **more):
    return run("jp-patrol", *arguments, f"--robot={ROBOT}", "--output", output, **more)


def driven(output, *arguments, status=0):
    """Summary and table of a run that ends with a status."""
    result = patrol(output, *arguments)
    assert result.returncode == status, result.stdout + result.stderr
    assert result.stderr == ""
    return json.loads((output / "summary.json").read_text()), result.stdout


def rows_of(path):
    with path.open() as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def names_in(folder):
    return sorted(path.name for path in folder.iterdir())


def by_name(summary):
    return {method["name"]: method for method in summary["methods"]}


def room(width=160, height=120, walls=()):
    """Rows of a map, the northern one first, with walls (x, y, columns, rows) counted from the south-west corner."""
    cells = [["."] * width for _ in range(height)]
    for x, y, columns, rows in [(0, 0, width, 2), (0, height - 2, width, 2), (0, 0, 2, height),
                                (width - 2, 0, 2, height), (40, 2, 10, 8), (100, height - 12, 12, 10), *walls]:
        for row in range(y, y + rows):
            cells[height - 1 - row][x:x + columns] = "#" * columns
    return ["".join(row) for row in cells]


def write_map(path, rows, origin=(0.0, 0.0, 0.0), resolution=CELL):
    path.write_text(json.dumps({"format": "joulepath-map-1", "name": path.stem, "width": len(rows[0]),
                                "height": len(rows), "resolution_m": resolution, "origin_m": list(origin),
                                "rows": rows}))
    return path


def on_map(path, start, goal):
    return [f"--map={path}", f"--start={start}", f"--goal={goal}"]


@pytest.fixture(scope="module")
def passage(tmp_path_factory):
    folder = tmp_path_factory.mktemp("passage") / "new" / "out"
    return (folder, *driven(folder, "l-passage"))


# ---- drives --------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("scene", SCENES)
def test_every_scene(scene, tmp_path):
    summary, _ = driven(tmp_path / "out", scene, "--seed=2")
    methods = by_name(summary)
    assert list(methods) == METHODS
    assert methods["improved"]["outcome"] == "arrived"
    assert (summary["scene"], summary["seed"], summary["robot"]) == (scene, 2, "patrol")
    assert names_in(tmp_path / "out") == FILES


@pytest.mark.parametrize("scene", ["beside-obstacle", "l-passage", "corridor", "doorway"])
def test_improved_method_arrives_forwards(scene, tmp_path):
    """But for a step into the goal."""
    summary, _ = driven(tmp_path / "out", scene, "--method=improved")
    [method] = summary["methods"]
    assert (method["outcome"], method["reason"]) == ("arrived", "")
    assert method["reversed_m"] < 0.15
    assert method["clearance_min_m"] > 0
    assert method["position_error_m"] < 0.15 and method["heading_error_deg"] < 10
    assert names_in(tmp_path / "out") == ["log_improved.csv", "summary.json"]


def test_table_says_what_the_summary_says(passage):
    _, summary, table = passage
    for method in summary["methods"]:
        line = next(line for line in table.splitlines() if line.startswith(TITLES[method["name"]]))
        outcome = method["outcome"] + (f": {method['reason']}" if method["reason"] else "")
        rest = line.removeprefix(TITLES[method["name"]]).strip()
        assert rest.startswith(outcome)
        numbers = [float(cell) for cell in rest.removeprefix(outcome).split()]
        for key, place in COLUMNS.items():
            assert numbers[place] == pytest.approx(method[key], abs=0.06), key
        assert numbers[9:] == [method["counts"][key] for key in ("turns", "waits", "replans")]
    assert f"path: {summary['methods'][0]['planner']['turning_points']} turning points" in table
    assert "fault" not in table


def test_logs_add_up_to_the_summary(passage):
    folder, summary, _ = passage
    for method in summary["methods"]:
        rows = rows_of(folder / method["log"])
        assert rows[0]["t_s"] == 0 and rows[-1]["t_s"] == pytest.approx(method["time_s"], abs=0.15)
        assert all(b["t_s"] - a["t_s"] == pytest.approx(0.1, abs=1e-6) for a, b in zip(rows, rows[1:]))
        assert rows[-1]["energy_j"] == pytest.approx(method["energy_j"], rel=0.05)
        chords = sum(math.dist((a["x_m"], a["y_m"]), (b["x_m"], b["y_m"])) for a, b in zip(rows, rows[1:]))
        assert chords == pytest.approx(method["length_m"], abs=0.15)
        assert min(row["clearance_m"] for row in rows) >= method["clearance_min_m"] - 1e-3
        for row in rows:
            assert all(abs(row[f"angle_{end}_{side}_deg"]) <= 100.5 for end in ("front", "rear")
                       for side in ("left", "right"))
            assert 0 <= row["state"] < len(summary["states"]) and 0 <= row["reason"] < len(summary["reasons"])


def test_log_begins_at_the_start_and_ends_at_the_goal(passage):
    folder, summary, _ = passage
    rows = rows_of(folder / "log_improved.csv")
    for row, place, tolerance in ((rows[0], summary["start"], 0.02), (rows[-1], summary["goal"], 0.15)):
        assert math.dist((row["x_m"], row["y_m"]), place[:2]) < tolerance
        assert abs(math.remainder(row["heading_deg"] - place[2], 360)) < 10
        assert math.dist((row["x_m"], row["y_m"]), (row["believed_x_m"], row["believed_y_m"])) < 0.15


def test_true_shape_stays_on_free_cells(passage):
    """The footprint's points of the improved method's log against the map in the summary."""
    folder, summary, _ = passage
    cells, resolution = summary["map"]["rows"][::-1], summary["map"]["resolution_m"]
    length, width = summary["robot_size_m"]
    for row in rows_of(folder / "log_improved.csv"):
        heading = math.radians(row["heading_deg"])
        for u in (-length / 2, -length / 4, 0, length / 4, length / 2):
            for v in (-width / 2, 0, width / 2):
                x = row["x_m"] + u * math.cos(heading) - v * math.sin(heading)
                y = row["y_m"] + u * math.sin(heading) + v * math.cos(heading)
                assert cells[int(y / resolution)][int(x / resolution)] == ".", row


def test_plans_lead_from_start_to_goal(passage):
    _, summary, _ = passage
    for method in summary["methods"]:
        plan = method["plans"][0]
        assert len(plan["way_m"]) == method["planner"]["turning_points"] >= 3  # round the corner
        for points in (plan["way_m"], plan["path_m"]):
            assert math.dist(points[0], summary["start"][:2]) < 0.1
            assert math.dist(points[-1], summary["goal"][:2]) < 2.1
        path = plan["path_m"]
        length = sum(math.dist(a, b) for a, b in zip(path, path[1:]))
        assert length == pytest.approx(method["planner"]["path_length_m"], rel=0.02)


def test_snapshots_are_taken_once_a_second(passage):
    _, summary, _ = passage
    for method in summary["methods"]:
        times = [snapshot["time_s"] for snapshot in method["snapshots"]]
        assert times == pytest.approx(list(range(len(times))), abs=0.11)
        assert len(times) == pytest.approx(method["time_s"], abs=1.2)
    bands = [len(snapshot["band_m"]) for snapshot in by_name(summary)["improved"]["snapshots"]]
    assert max(bands) >= 3
    assert all(not snapshot["band_m"] for snapshot in by_name(summary)["pursuit"]["snapshots"])


def test_pedestrian_walks_through_the_snapshots(tmp_path):
    [method] = driven(tmp_path / "out", "pedestrian", "--seed=2", "--method=improved")[0]["methods"]
    places = [(snapshot["time_s"], *(snapshot["obstacles"][0][key] for key in ("x_m", "y_m")))
              for snapshot in method["snapshots"]]
    speeds = [math.dist(a[1:], b[1:]) / (b[0] - a[0]) for a, b in zip(places, places[1:])]
    assert 0.5 < max(speeds) <= 1.31
    assert {snapshot["obstacles"][0]["radius_m"] for snapshot in method["snapshots"]} == {0.25}


@pytest.mark.parametrize("scene", ["beside-obstacle", "warehouse"])
def test_map_tells_the_hidden_from_the_shown(scene, tmp_path):
    """Pallets, or in one seed of two the obstacle beside the goal; the others appear as shapes."""
    for seed in range(1, 9):
        patrol(tmp_path / "out", scene, f"--seed={seed}", "--method=pursuit")
        summary = json.loads((tmp_path / "out/summary.json").read_text())
        ground = summary["map"]
        hidden = sum(row.count("o") for row in ground["rows"])
        appeared = any(snapshot["obstacles"] for snapshot in summary["methods"][0]["snapshots"])
        assert (hidden > 0) != appeared
        assert len(ground["rows"]) == ground["height"]
        assert {len(row) for row in ground["rows"]} == {ground["width"]}
        assert set("".join(ground["rows"])) <= set(".#o")


def test_seeds_and_methods(tmp_path):
    one, _ = driven(tmp_path / "one", "doorway", "--seed=1", "--method=improved")
    two, _ = driven(tmp_path / "two", "doorway", "--seed=3", "--method=improved")
    assert one["start"] != two["start"] and one["map"]["rows"] != two["map"]["rows"]
    assert by_name(driven(tmp_path / "all", "doorway", "--method=all")[0])["improved"] == one["methods"][0]


def test_same_bytes_again(passage, tmp_path):
    folder, _, table = passage
    assert driven(tmp_path / "again", "l-passage")[1] == table
    for name in FILES:
        assert (tmp_path / "again" / name).read_bytes() == (folder / name).read_bytes(), name


# ---- maps of others ------------------------------------------------------------------------------------------------

def test_drive_over_a_map(tmp_path):
    path = write_map(tmp_path / "hall.json", room(walls=[(70, 0, 4, 80)]))
    summary, table = driven(tmp_path / "out", *on_map(path, "2,2,0", "6,2,90"), "--method=improved")
    assert summary["scene"] == "hall" and summary["map"]["file"] == str(path)
    assert summary["start"] == pytest.approx([2, 2, 0]) and summary["goal"] == pytest.approx([6, 2, 90])
    assert max(row["y_m"] for row in rows_of(tmp_path / "out/log_improved.csv")) > 80 * CELL  # round the wall
    assert table.startswith("hall, seed 1: 8.0 × 6.0 m")


def test_frame_of_the_map(tmp_path):
    """The same task in a frame that is moved and turned is the same drive."""
    rows, yaw = room(), math.radians(30)

    def moved(x, y):
        return 100 + x * math.cos(yaw) - y * math.sin(yaw), -50 + x * math.sin(yaw) + y * math.cos(yaw)

    start, goal = moved(2, 2), moved(6, 4)
    plain, _ = driven(tmp_path / "plain", *on_map(write_map(tmp_path / "plain.json", rows), "2,2,0", "6,4,90"))
    turned, _ = driven(tmp_path / "turned", *on_map(write_map(tmp_path / "turned.json", rows, (100, -50, yaw)),
                                                    f"{start[0]:.9f},{start[1]:.9f},30",
                                                    f"{goal[0]:.9f},{goal[1]:.9f},120"))
    assert turned["start"] == pytest.approx(plain["start"], abs=1e-4)
    assert turned["goal"] == pytest.approx(plain["goal"], abs=1e-4)


def test_goal_behind_a_wall_without_a_door(tmp_path):
    path = write_map(tmp_path / "shut.json", room(walls=[(78, 0, 4, 120)]))
    summary, table = driven(tmp_path / "out", *on_map(path, "2,2,0", "6,2,90"), status=1)
    assert [method["outcome"] for method in summary["methods"]] == ["no path"] * 3
    assert all(method["plans"] == method["snapshots"] == [] for method in summary["methods"])
    assert rows_of(tmp_path / "out/log_improved.csv") == []
    assert "no path" in table and "path: 0 turning points" in table


@pytest.mark.parametrize(("goal", "turns"), [("4,3,0", 0), ("4,3,180", 1), ("4,3,-90", 1), ("4.1,3.1,0", None)])
@pytest.mark.parametrize("resolution", [CELL, 0.1])
def test_goal_where_the_robot_stands(goal, turns, resolution, tmp_path):
    """There already, a pure turn, and a place in the next cell."""
    side = round(6 / resolution)
    path = write_map(tmp_path / "hall.json", ["." * side] * side, resolution=resolution)
    summary, table = driven(tmp_path / "out", *on_map(path, "4,3,0", goal))
    methods = by_name(summary)
    assert methods["improved"]["outcome"] == methods["pursuit"]["outcome"] == "arrived"
    assert methods["improved"]["heading_error_deg"] < 10
    assert "no path" not in table and "nan" not in table
    if turns is not None:
        assert methods["improved"]["counts"]["turns"] == turns
        assert methods["improved"]["length_m"] < 0.1


def test_memory_that_runs_out_at_any_place(tmp_path):
    """Each limit lets the program go a little farther than the one before."""
    side = 400
    path = write_map(tmp_path / "hall.json", ["." * side] * side)
    ends = set()
    for limit in range(5 << 20, 16 << 20, 128 << 10):  # from what starts the program
        result = patrol(tmp_path / "out", *on_map(path, "4,3,0", "4,3,0"), "--method=improved",
                        preexec_fn=lambda limit=limit: resource.setrlimit(resource.RLIMIT_DATA, (limit, limit)))
        if result.returncode == 0:
            break
        assert_one_line_error(result)
        ends.add(re.sub(".*: no memory", "no memory", result.stderr))
    assert result.returncode == 0
    assert any("drive over it" in end for end in ends), ends


# ---- faults --------------------------------------------------------------------------------------------------------

def test_no_scans_stop_the_robot(tmp_path):
    summary, table = driven(tmp_path / "out", "l-passage", "--method=improved", "--scan-dropout=2,1000", status=1)
    [method] = summary["methods"]
    assert (method["outcome"], method["reason"]) == ("gave up", "no scan")
    assert method["counts"]["scans_missing"] > 3
    last = rows_of(tmp_path / "out/log_improved.csv")[-1]
    assert summary["states"][int(last["state"])] == "stopped"
    assert abs(last["speed_m_s"]) < 0.02
    assert "fault: no scans from 2.0 s to 1000.0 s" in table
    assert f"improved TEB: {method['counts']['scans_missing']} scans missing" in table
    assert summary["faults"]["scan_dropout_s"] == [2, 1000]


def test_some_dropouts_do_no_harm(tmp_path):
    summary, table = driven(tmp_path / "out", "l-passage", "--method=improved", "--beam-dropout=0.2",
                            "--scan-dropout=3,3.15")
    assert summary["faults"]["beam_dropout"] == 0.2
    assert summary["methods"][0]["counts"]["scans_missing"] == 2
    assert "fault: 20 % of the beams" in table


def test_beams_that_drop_out(tmp_path):
    summary, table = driven(tmp_path / "out", "l-passage", "--method=improved", "--beam-dropout=0.9", status=1)
    [method] = summary["methods"]
    assert (method["outcome"], method["reason"]) == ("gave up", "no scan")
    assert "gave up: no scan" in table and "fault: 90 % of the beams drop out" in table
    assert method["clearance_min_m"] > 0 and method["length_m"] < 1


def test_jump_of_the_laser_is_rejected(tmp_path):
    summary, table = driven(tmp_path / "out", "l-passage", "--method=improved", "--jump=3,0.8", status=1)
    [method] = summary["methods"]
    assert method["counts"]["laser_rejected"] > 0
    assert f", {method['counts']['laser_rejected']} rejected" in table
    assert (method["outcome"], method["reason"]) == ("gave up", "lost")
    assert summary["faults"]["jump_s_m"] == [3, 0.8]
    assert "fault: the laser's pose jumps by 0.80 m at 3.0 s" in table


def test_on_slippery_ground_the_laser_knows_where_the_robot_is(tmp_path):
    result = patrol(tmp_path / "out", "l-passage", "--slip")
    assert result.returncode == 0, result.stderr
    summary = json.loads((tmp_path / "out/summary.json").read_text())
    improved, plain, _ = summary["methods"]
    assert improved["odometry_error_m"] < 0.05
    assert plain["odometry_error_m"] > 2 * improved["odometry_error_m"]
    assert summary["faults"]["slip"] is True
    assert "fault: slippery ground" in result.stdout


# ---- wrong input ---------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("arguments", [
    [], ["nowhere"], ["corridor", "doorway"], ["corridor", "--map=m.json"], ["--map=m.json"],
    ["--map=m.json", "--start=1,1,0"], ["corridor", "--start=1,1,0"], ["corridor", "--goal=1,1,0"],
    ["--map=m.json", "--start=1,1", "--goal=2,2,0"], ["--map=m.json", "--start=1,1,x", "--goal=2,2,0"],
    ["--map=m.json", "--start=1,1,0,0", "--goal=2,2,0"], ["--map=m.json", "--start=1,inf,0", "--goal=2,2,0"],
    ["corridor", "--seed=-1"], ["corridor", "--seed=1.5"], ["corridor", "--seed="], ["corridor", "--seed=x"],
    ["corridor", "--seed=99999999999999999999"], ["corridor", "--method=best"], ["corridor", "--method="],
    ["corridor", "--beam-dropout=1.1"], ["corridor", "--beam-dropout=-0.1"], ["corridor", "--beam-dropout=nan"],
    ["corridor", "--scan-dropout=3"], ["corridor", "--scan-dropout=3,2"], ["corridor", "--scan-dropout=-1,2"],
    ["corridor", "--strategy=best"], ["corridor", "--jump=3"], ["corridor", "--jump=-1,2"], ["corridor", "--jump=1,2,3"], ["corridor", "--nonsense"]])
def test_wrong_command_lines(arguments, tmp_path):
    result = patrol(tmp_path / "out", *arguments)
    assert result.returncode == 2
    assert result.stderr != "" and result.stdout == ""
    assert not (tmp_path / "out").exists()


def test_default_output(tmp_path):
    assert run("jp-patrol", "corridor", f"--robot={ROBOT}", "--method=pursuit", cwd=tmp_path).returncode == 0
    assert names_in(tmp_path / "build/patrol") == ["log_pursuit.csv", "summary.json"]


@pytest.mark.parametrize(("start", "goal", "parts"), [
    ("-1,2,0", "6,2,0", ["--start", "outside"]), ("2,2,0", "6,600,0", ["--goal", "outside"]),
    ("1e30,2,0", "6,2,0", ["--start", "outside"]), ("0.3,2,0", "6,2,0", ["--start", "does not fit"]),
    ("2,2,0", "2.2,0.7,0", ["--goal", "does not fit"])])
def test_places_that_are_not_free(start, goal, parts, tmp_path):
    path = write_map(tmp_path / "hall.json", room())
    assert_one_line_error(patrol(tmp_path / "out", *on_map(path, start, goal)), *parts)
    assert not (tmp_path / "out").exists()


def test_robot_fits_lengthwise_but_not_across(tmp_path):
    """A slot of 0.7 m: the true shape decides, not its circle."""
    path = write_map(tmp_path / "slot.json", room(walls=[(20, 2, 40, 49), (20, 65, 40, 53)]))
    assert_one_line_error(patrol(tmp_path / "out", *on_map(path, "6,2,0", "2,2.9,90")), "--goal", "does not fit")
    driven(tmp_path / "out", *on_map(path, "6,2,0", "2,2.9,180"), "--method=pursuit")


def test_maps_and_robots_that_cannot_be_used(tmp_path):
    task = ("2,2,0", "6,2,0")
    assert_one_line_error(patrol(tmp_path / "out", *on_map(tmp_path / "none.json", *task)), "none.json")
    coarse = write_map(tmp_path / "coarse.json", room(), resolution=0.5)
    assert_one_line_error(patrol(tmp_path / "out", *on_map(coarse, *task)), "coarse.json", "0.5 m", "--resolution")
    result = run("jp-patrol", "corridor", "--robot", tmp_path / "none.cfg", "--output", tmp_path / "out")
    assert_one_line_error(result, "none.cfg")
    result = run("jp-patrol", "corridor", "--robot", ROOT / "sim/robots/gao2018.cfg", "--output", tmp_path / "out")
    assert_one_line_error(result, "gao2018.cfg")
    assert not (tmp_path / "out").exists()


def test_output_that_is_a_file(tmp_path):
    (tmp_path / "place").write_text("old")
    assert_one_line_error(patrol(tmp_path / "place", "doorway"), "place", "--output")
    assert (tmp_path / "place").read_text() == "old"


@pytest.mark.parametrize("name", FILES)
def test_disk_is_full_for_one_file(name, tmp_path):
    output = tmp_path / "out"
    output.mkdir()
    for file in FILES:
        (output / file).write_text("old")
    fill_disk(output / name)
    assert_one_line_error(patrol(output, "doorway"), output / name, "cannot write")
    assert names_in(output) == FILES
    assert all((output / file).read_text() == "old" for file in FILES if file != name)


def test_help_names_the_scenes():
    text = re.sub(r"\s+", " ", run("jp-patrol", "--help").stdout)
    assert "Scenes: " + ", ".join(SCENES) + "." in text
