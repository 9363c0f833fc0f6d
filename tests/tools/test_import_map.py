"""tools/design/import_map.py: every format, every error, and files with random mutations."""
import io
import json
import math
import random

import numpy as np
import pytest
from conftest import assert_one_line_error, run_tool
from PIL import Image

from tools.design import import_map

SEED = 20180900
MUTATIONS = 150  # of each format

YAML = """image: yard.pgm
mode: trinary
resolution: 0.05
origin: [-1.5, 2.0, 0.25]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.25
"""
# 254 free, 0 occupied, 205 (0.196 dark) free here, 128 unknown.
PIXELS = np.array([[254, 254, 0, 128], [0, 205, 254, 254], [128, 254, 254, 0]], dtype=np.uint8)
ROWS = ["..#?", "#...", "?..#"]

MOVING_AI = "type octile\nheight 3\nwidth 5\nmap\n.GS@.\nOTW..\n.....\n"

# 3 wide, 2 high; the first row is y = 0.
SBPL = """discretization(cells): 3 2
obsthresh: 254
cost_inscribed_thresh: 253
cost_possibly_circumscribed_thresh: 128
cellsize(meters): 0.025
nominalvel(mpersecs): 1.0
timetoturn45degsinplace(secs): 2.0
start(meters,rads): 0.01 0.01 0
end(meters,rads): 0.06 0.03 1.5707963
environment:
0 100 254
0 253 255
"""
SBPL_FLAT = "discretization(cells): 3 2\nobsthresh: 1\nstart(cells): 0 0\nend(cells): 2 1\nenvironment:\n0 0 1\n1 0 0\n"

ASC = """ncols 4
nrows 3
xllcorner 100
yllcorner 200.5
cellsize 2
NODATA_value -9999
1.0 1.1 1.2 1.3
1.0 1.1 1.2 -9999
1.0 1.1 1.2 3.2
"""


def pgm(pixels, maximum=255):
    return b"P5\n%d %d\n%d\n" % (pixels.shape[1], pixels.shape[0], maximum) + pixels.tobytes()


def png(image):
    data = io.BytesIO()
    image.save(data, "PNG")
    return data.getvalue()


def hill(rows=40, columns=50):
    """A cone of 30 m, 12° steep, on 20 m cells and a plain."""
    y, x = np.mgrid[:rows, :columns]
    return np.maximum(0, 30 - np.tan(np.radians(12)) * 20 * np.hypot(x - 25, y - 20))


def npz(**changes):
    values = {"elevation": hill().astype(np.int16), "dx": 20 / 111200, "dy": 20 / 111200, "xmin": 0.0, "xmax": 1.0,
              "ymin": 0.001, "ymax": -0.001}
    values.update(changes)
    data = io.BytesIO()
    np.savez(data, **{key: value for key, value in values.items() if value is not None})
    return data.getvalue()


@pytest.fixture
def place(tmp_path):
    """A directory with one sound file of each format."""
    (tmp_path / "yard.yaml").write_text(YAML)
    (tmp_path / "yard.pgm").write_bytes(pgm(PIXELS))
    (tmp_path / "grid.map").write_text(MOVING_AI)
    (tmp_path / "env.cfg").write_text(SBPL)
    (tmp_path / "land.asc").write_text(ASC)
    (tmp_path / "dem.npz").write_bytes(npz())
    return tmp_path


def run_import(source, *options):
    output = source.parent / "out" / "map.json"
    return run_tool("design.import_map", source, output, *options), output


def imported(source, *options):
    result, output = run_import(source, *options)
    assert result.returncode == 0, result.stderr
    assert result.stderr == ""
    return check_map(json.loads(output.read_text()))


def refused(source, *parts, options=()):
    """One line that names the file, exit status 2, no output."""
    result, output = run_import(source, *options)
    assert_one_line_error(result, *parts)
    assert not output.exists()


def check_map(data):
    """What every map file promises."""
    assert data["format"] == "joulepath-map-1"
    assert 1 <= data["width"] <= 4096 and 1 <= data["height"] <= 4096
    assert len(data["rows"]) == data["height"]
    assert all(len(row) == data["width"] and set(row) <= set(".#?") for row in data["rows"])
    assert math.isfinite(data["resolution_m"]) and data["resolution_m"] > 0
    assert len(data["origin_m"]) == 3 and all(map(math.isfinite, data["origin_m"]))
    assert 1 <= len(data["name"]) <= 63
    if "elevation_m" in data:
        heights = np.array(data["elevation_m"])
        assert heights.shape == (data["height"], data["width"])
        assert np.abs(heights).max() <= 31.999
    if "cost" in data:
        costs = np.array(data["cost"])
        assert costs.shape == (data["height"], data["width"])
        assert 0 <= costs.min() <= costs.max() <= 255
    return data


# ---- ROS map_server ----

def test_ros_map(place):
    data = imported(place / "yard.yaml")
    assert data["rows"] == ROWS
    assert data["resolution_m"] == 0.05
    assert data["origin_m"] == [-1.5, 2.0, 0.25]
    assert data["name"] == "yard"
    assert "yard.yaml" in data["note"]
    assert "elevation_m" not in data


def test_ros_thresholds_are_exclusive(place):
    # 51 is 0.8 dark, 204 is 0.2 dark.
    (place / "yard.pgm").write_bytes(pgm(np.array([[51, 50, 204, 205]], dtype=np.uint8)))
    (place / "yard.yaml").write_text(YAML.replace("0.65", "0.8").replace("0.25\n", "0.2\n"))
    assert imported(place / "yard.yaml")["rows"] == ["?#?."]


@pytest.mark.parametrize("negate", ["1", "true"])
def test_ros_negate(place, negate):
    (place / "yard.pgm").write_bytes(pgm(255 - PIXELS))
    (place / "yard.yaml").write_text(YAML.replace("negate: 0", f"negate: {negate}"))
    assert imported(place / "yard.yaml")["rows"] == ROWS


@pytest.mark.parametrize("make", [
    lambda: Image.fromarray(PIXELS),
    lambda: Image.fromarray(np.stack([PIXELS] * 3, axis=2)),
    lambda: Image.fromarray(PIXELS).convert("P"),
    lambda: Image.fromarray(PIXELS.astype(np.uint16) * 257),
])
def test_ros_png_of_every_depth(place, make):
    (place / "yard.png").write_bytes(png(make()))
    (place / "yard.yaml").write_text(YAML.replace("yard.pgm", "yard.png"))
    assert imported(place / "yard.yaml")["rows"] == ROWS


def test_ros_black_and_white_png(place):
    (place / "yard.png").write_bytes(png(Image.fromarray(np.array([[255, 0], [0, 255]], dtype=np.uint8)).convert("1")))
    (place / "yard.yaml").write_text(YAML.replace("yard.pgm", "yard.png"))
    assert imported(place / "yard.yaml")["rows"] == [".#", "#."]


def test_ros_colours_are_averaged(place):
    # Their mean is 0.667 dark; by luminance green would be 0.41.
    colours = np.array([[[255, 0, 0], [0, 255, 0], [0, 0, 255]]], dtype=np.uint8)
    (place / "yard.png").write_bytes(png(Image.fromarray(colours)))
    (place / "yard.yaml").write_text(YAML.replace("yard.pgm", "yard.png"))
    assert imported(place / "yard.yaml")["rows"] == ["###"]


def test_ros_plain_and_deep_pgm(place):
    text = "P2\n# a comment\n4 3\n255\n" + " ".join(map(str, PIXELS.flat)) + "\n"
    (place / "yard.pgm").write_text(text)
    assert imported(place / "yard.yaml")["rows"] == ROWS
    (place / "yard.pgm").write_bytes(pgm((PIXELS.astype(">u2") * 257), 65535))
    assert imported(place / "yard.yaml")["rows"] == ROWS


def test_ros_resampled_to_coarse_cells(place):
    pixels = np.full((8, 12), 254, dtype=np.uint8)
    pixels[7, 0] = 128  # south-west: unknown
    pixels[4, 4], pixels[7, 7] = 0, 128  # occupied wins over unknown
    pixels[0, 11] = 0  # north-east
    (place / "yard.pgm").write_bytes(pgm(pixels))
    data = imported(place / "yard.yaml", "--resolution", "0.2")
    assert data["rows"] == ["..#", "?#."]
    assert data["resolution_m"] == 0.2
    assert data["origin_m"] == [-1.5, 2.0, 0.25]


def test_ros_coarse_cells_beyond_the_map_are_unknown(place):
    (place / "yard.pgm").write_bytes(pgm(np.full((5, 6), 254, dtype=np.uint8)))
    assert imported(place / "yard.yaml", "--resolution", "0.2")["rows"] == ["??", ".?"]


@pytest.mark.parametrize("ratio", [1, 1.5, 2, 2.7, 4, 0.5, 1 / 3])
def test_resampling_against_areas(ratio):
    """Each coarse cell against the overlap of its area with every fine cell."""
    generator = np.random.default_rng(SEED)
    cells = generator.choice([import_map.FREE, import_map.UNKNOWN, import_map.OCCUPIED], (11, 17), p=[0.8, 0.1, 0.1])
    coarse = import_map.resampled_cells("x", cells, ratio, import_map.UNKNOWN)[::-1]
    fine = cells[::-1]
    for y, x in np.ndindex(coarse.shape):
        worst = import_map.UNKNOWN if (x + 1) * ratio > 17 + 1e-6 or (y + 1) * ratio > 11 + 1e-6 else import_map.FREE
        for v, u in np.ndindex(fine.shape):
            wide = min(u + 1, (x + 1) * ratio) - max(u, x * ratio)
            high = min(v + 1, (y + 1) * ratio) - max(v, y * ratio)
            if min(wide, high) > 1e-5:
                worst = max(worst, fine[v, u])
        assert coarse[y, x] == worst


def test_window_moves_the_origin(place):
    data = imported(place / "yard.yaml", "--window", 1, 0, 3, 2)
    assert data["rows"] == [".#?", "..."]
    assert data["origin_m"] == pytest.approx([-1.45, 2.05, 0.25])


@pytest.mark.parametrize("line, replacement, culprit", [
    ("image: yard.pgm\n", "", "image"), ("resolution: 0.05\n", "", "resolution"),
    ("origin: [-1.5, 2.0, 0.25]\n", "", "origin"), ("negate: 0\n", "", "negate"),
    ("occupied_thresh: 0.65\n", "", "occupied_thresh"), ("free_thresh: 0.25\n", "", "free_thresh"),
    ("mode: trinary", "mode: scale", "scale"), ("mode: trinary", "mode: [1]", "mode"),
    ("image: yard.pgm", "image: 5", "image"), ("image: yard.pgm", "image: ''", "image"),
    ("image: yard.pgm", "image: gone.pgm", "gone.pgm: No such file"),
    ("image: yard.pgm", "image: yard.bmp", "PGM or PNG"), ("image: yard.pgm", 'image: "a\\nb.pgm"', "image"),
    ("resolution: 0.05", "resolution: .nan", "resolution"), ("resolution: 0.05", "resolution: .inf", "resolution"),
    ("resolution: 0.05", "resolution: 0", "resolution"), ("resolution: 0.05", "resolution: -0.05", "resolution"),
    ("resolution: 0.05", "resolution: fine", "resolution"), ("resolution: 0.05", "resolution: yes", "resolution"),
    ("[-1.5, 2.0, 0.25]", "[-1.5, 2.0]", "origin"), ("[-1.5, 2.0, 0.25]", "7", "origin"),
    ("[-1.5, 2.0, 0.25]", "[-1.5, .nan, 0]", "origin"), ("negate: 0", "negate: 2", "negate"),
    ("occupied_thresh: 0.65", "occupied_thresh: 1.5", "occupied_thresh"),
    ("free_thresh: 0.25", "free_thresh: 0.7", "free_thresh"), ("free_thresh: 0.25", "free_thresh: -1", "free_thresh"),
    ("mode: trinary", "mode: [", "YAML"), ("mode: trinary", "when: 2024-13-45", "YAML"),
    ("mode: trinary", "mode: !!python/object:os.system x", "YAML"),
])
def test_ros_wrong_keys(place, line, replacement, culprit):
    assert line in YAML
    (place / "yard.yaml").write_text(YAML.replace(line, replacement))
    refused(place / "yard.yaml", culprit)


@pytest.mark.parametrize("text", ["[1, 2]\n", "just words\n", "\n", "- a\n- b\n"])
def test_ros_yaml_without_keys(place, text):
    (place / "yard.yaml").write_text(text)
    refused(place / "yard.yaml", "yard.yaml", "no keys")


@pytest.mark.parametrize("data", [
    b"", b"P5\n", b"P5\n4 3\n255\n", pgm(PIXELS)[:-1], b"P5\n-4 3\n255\nxxxx", b"P5\n0 0\n255\n", b"P5\nfour 3\n255\n",
    b"P5\n4 3\n0\n" + bytes(12), b"P5\n4 3\n70000\n" + bytes(24), b"\x7fELF" + bytes(60), b"P5" + bytes(300),
    b"P5\n9000 1\n255\n" + bytes(9000), b"P5\n99999999 99999999\n255\n", png(Image.fromarray(PIXELS)),
])
def test_truncated_and_mislabelled_pgm(place, data):
    (place / "yard.pgm").write_bytes(data)
    refused(place / "yard.yaml", "yard.pgm")


def test_truncated_and_mislabelled_png(place):
    (place / "yard.yaml").write_text(YAML.replace("yard.pgm", "yard.png"))
    sound = png(Image.fromarray(PIXELS))
    for data in (b"", sound[:20], sound[:-30], sound[:33], pgm(PIXELS), sound[:40] + b"\xff" + sound[41:]):
        (place / "yard.png").write_bytes(data)
        refused(place / "yard.yaml", "yard.png")


def test_transparent_png_is_refused(place):
    (place / "yard.yaml").write_text(YAML.replace("yard.pgm", "yard.png"))
    (place / "yard.png").write_bytes(png(Image.fromarray(PIXELS).convert("LA")))
    refused(place / "yard.yaml", "transparent")


def test_image_that_is_a_directory(place):
    (place / "yard.pgm").unlink()
    (place / "yard.pgm").mkdir()
    refused(place / "yard.yaml", "yard.pgm", "directory")


def test_map_over_the_limit_fits_when_resampled(place):
    (place / "yard.pgm").write_bytes(pgm(np.full((2, 4097), 254, dtype=np.uint8)))
    refused(place / "yard.yaml", "4097", "4096")
    assert imported(place / "yard.yaml", "--resolution", "0.2")["width"] == 1025
    assert imported(place / "yard.yaml", "--window", 1, 0, 4096, 2)["width"] == 4096


# ---- MovingAI ----

def test_moving_ai(place):
    data = imported(place / "grid.map")
    assert data["rows"] == ["...#.", "###..", "....."]
    assert data["resolution_m"] == 0.2
    assert imported(place / "grid.map", "--cell-size", "0.5")["resolution_m"] == 0.5


def test_moving_ai_tells_grounds_apart(place):
    data = imported(place / "grid.map", "--grounds", "asphalt=1,1", "mud=2.5,0.8")
    assert data["class"] == ["02100", "00000", "00000"]
    assert data["grounds"] == [{"name": "asphalt", "rolling": 1.0, "friction": 1.0},
                               {"name": "mud", "rolling": 2.5, "friction": 0.8}]
    assert "grounds" not in imported(place / "grid.map")
    assert imported(place / "grid.map", "--window", "1", "0", "4", "2")["class"] == ["2100", "0000"]
    (place / "grid.map").write_text(MOVING_AI.replace(".GS@.", "...@."))
    assert "class" not in imported(place / "grid.map")


@pytest.mark.parametrize("ground, culprit", [("mud", "NAME=ROLLING,FRICTION"), ("mud=2,3", "3"), ("mud=0,1", "0")])
def test_grounds_that_are_refused(place, ground, culprit):
    assert_one_line_error(run_tool("design.import_map", place / "grid.map", place / "out.json", "--grounds", ground), culprit)


def test_moving_ai_split_into_the_lattices_cells(place):
    data = imported(place / "grid.map", "--cell-size", "1", "--resolution", "0.2")
    assert (data["width"], data["height"]) == (25, 15)
    assert data["rows"][0] == "." * 15 + "#" * 5 + "." * 5
    assert data["rows"][5] == "#" * 15 + "." * 10


def test_moving_ai_with_carriage_returns_and_blank_end(place):
    (place / "grid.map").write_bytes(MOVING_AI.replace("\n", "\r\n").encode() + b"\r\n\r\n")
    assert imported(place / "grid.map")["rows"] == ["...#.", "###..", "....."]


@pytest.mark.parametrize("part, replacement, culprit", [
    ("height 3\n", "", "height"), ("width 5\n", "", "width"), ("map\n", "", "header"),
    ("type octile\nheight 3\nwidth 5\nmap\n.GS@.\nOTW..\n.....\n", "type octile\n", "map"),
    ("height 3", "height 4", "3 rows"), ("height 3", "height 2", "3 rows"), ("width 5", "width 6", "line 5"),
    ("OTW..", "OTW...", "line 6"), ("OTW..", "OTW.", "line 6"), ("OTW..", "OTX..", "'X'"),
    ("OTW..", "OT\tW.", "line 6"), ("OTW..", "OT…W.", "'…'"), ("height 3", "height three", "height"),
    ("height 3", "height -3", "height"), ("height 3", "height 0", "height"), ("height 3", "height 2.5", "height"),
    ("height 3", "height nan", "height"), ("height 3", "height 9999", "height"), ("height 3", "depth 3", "header"),
    ("type octile", "\x00\x01", "header"),
])
def test_moving_ai_errors(place, part, replacement, culprit):
    assert part in MOVING_AI
    (place / "grid.map").write_text(MOVING_AI.replace(part, replacement))
    refused(place / "grid.map", "grid.map", culprit)


# ---- SBPL ----

def test_sbpl_environment(place):
    result, output = run_import(place / "env.cfg")
    assert result.returncode == 0, result.stderr
    data = check_map(json.loads(output.read_text()))
    assert data["rows"] == ["..#", "..#"]
    assert data["resolution_m"] == 0.025
    assert data["origin_m"] == [0, 0, 0]
    assert data["note"] == "SBPL environment env.cfg; 2 cells cost 101 to 254 times as much"
    assert (data["cost"], data["cost_shift"]) == ([[0, 253, 0], [0, 100, 0]], 0)
    assert "its task for jp-plan: --start=0.01,0.01,0 --goal=0.06,0.03,90\n" in result.stdout


def test_sbpl_first_row_is_the_southern_one(place):
    (place / "env.cfg").write_text(SBPL.replace("0 100 254\n", "254 254 0\n"))
    assert imported(place / "env.cfg")["rows"] == ["..#", "##."]
    (place / "env.cfg").write_text(SBPL.replace("obsthresh: 254", "obsthresh: 100"))
    assert imported(place / "env.cfg")["rows"] == [".##", ".##"]


def test_sbpl_costs_follow_window_and_resolution(place):
    data = imported(place / "env.cfg", "--window", "1", "0", "2", "2")
    assert (data["rows"], data["cost"], data["origin_m"]) == ([".#", ".#"], [[253, 0], [100, 0]], [0.025, 0, 0])
    data = imported(place / "env.cfg", "--resolution", "0.05")
    assert (data["rows"], data["cost"]) == ([".#"], [[253, 0]])
    (place / "env.cfg").write_text(SBPL.replace("253 255", "0 255").replace("0 100", "0 0"))
    assert "cost" not in imported(place / "env.cfg")


def test_sbpl_environment_of_cells(place):
    """nav2D: places are cells, whose size is an option."""
    (place / "env.cfg").write_text(SBPL_FLAT)
    result, output = run_import(place / "env.cfg", "--cell-size", "0.5")
    data = json.loads(output.read_text())
    assert (data["rows"], data["resolution_m"], data["note"]) == (["#..", "..#"], 0.5, "SBPL environment env.cfg")
    assert "its task for jp-plan: --start=0.25,0.25,0 --goal=1.25,0.75\n" in result.stdout


def test_sbpl_environment_without_a_task(place):
    (place / "env.cfg").write_text(SBPL_FLAT.replace("end(cells): 2 1\n", "NumThetaDirs: 16\n"))
    result, _ = run_import(place / "env.cfg")
    assert result.returncode == 0
    assert "task" not in result.stdout


@pytest.mark.parametrize("part, replacement, culprit", [
    ("discretization(cells): 3 2\n", "", "the key discretization(cells) is missing"),
    ("obsthresh: 254\n", "", "the key obsthresh is missing"), ("environment:\n", "", "'0' is not a key"),
    ("environment:\n0 100 254\n0 253 255\n", "", "the key environment is missing"),
    ("3 2", "3 2 4", "'4' is not a key"), ("3 2", "3", "'obsthresh:' is not a number"), ("3 2", "3 0", "is not in 1…"),
    ("3 2", "3 2.5", "not a whole number"), ("3 2", "3 3", "6 cells, but discretization says 3 × 3"),
    ("obsthresh: 254", "obsthresh: 0", "obsthresh"), ("obsthresh: 254", "obsthresh: x", "obsthresh"),
    ("obsthresh: 254", "obsthresh: 254\nobsthresh: 1", "obsthresh: needs one number, once"),
    ("(meters): 0.025", "(meters): 0", "cellsize(meters)"), ("0.01 0.01 0", "0.01 -0.01 0", "start: 0.01, -0.01 m is"),
    ("0.06 0.03", "0.08 0.03", "end: 0.08, 0.03 m is outside the map of 3 × 2 cells of 0.025 m"),
    ("0 253", "0 256", "environment: row 2, cell 2: 256 is not in 0…255"), ("0 253", "-1 253", "row 2, cell 1"),
    ("0 253", "0 25.3", "row 2, cell 2: 25.3 is not a whole number"), ("0 253", "a 253", "row 2, cell 1: 'a' is not a number"), ("0 253 255", "0 253", "5 cells"),
    (SBPL, "type = \"skid_steer\";\n", "'type' is not a key of an SBPL environment"),
])
def test_sbpl_errors(place, part, replacement, culprit):
    assert part in SBPL
    (place / "env.cfg").write_text(SBPL.replace(part, replacement))
    refused(place / "env.cfg", "env.cfg", culprit)


# ---- ESRI ASCII grid ----

def test_asc(place):
    data = imported(place / "land.asc")
    # Every unit step to the 3.2 m is steep; the unknown neighbour does not count.
    assert data["rows"] == ["..#.", ".##?", "..##"]
    assert data["resolution_m"] == 2
    assert data["origin_m"] == [100, 200.5, 0]
    middle = (1.0 + 3.2) / 2
    assert data["elevation_m"][0] == pytest.approx([1.0 - middle, 1.1 - middle, 1.2 - middle, 1.3 - middle])
    assert data["elevation_m"][1][3] == 0


def test_asc_keys_in_capitals_and_corner_by_centre(place):
    text = ASC.replace("ncols", "NCOLS").replace("xllcorner 100", "XLLCENTER 101").replace("yllcorner 200.5",
                                                                                           "yllCenter 201.5")
    (place / "land.asc").write_text(text)
    assert imported(place / "land.asc")["origin_m"] == [100, 200.5, 0]


def test_asc_without_nodata(place):
    (place / "land.asc").write_text(ASC.replace("NODATA_value -9999\n", "").replace("-9999", "1.3"))
    assert "?" not in "".join(imported(place / "land.asc")["rows"])


def test_asc_without_nodata_has_that_of_the_format(place):
    expected = imported(place / "land.asc")
    (place / "land.asc").write_text(ASC.replace("NODATA_value -9999\n", ""))
    assert imported(place / "land.asc") == expected


def test_asc_scaled_and_resampled_keeps_slopes(place):
    y, x = np.mgrid[:30, :30]
    land = 500 + 20 * x * math.tan(math.radians(10))
    rows = "\n".join(" ".join(f"{z:.6f}" for z in row) for row in land)
    (place / "land.asc").write_text(f"ncols 30\nnrows 30\nxllcorner 0\nyllcorner 0\ncellsize 20\n{rows}\n")
    refused(place / "land.asc", "--scale 2")
    data = imported(place / "land.asc", "--scale", "100", "--resolution", "0.1")
    assert (data["width"], data["height"]) == (60, 60)
    heights = np.array(data["elevation_m"])
    slopes = np.degrees(np.arctan(np.diff(heights, axis=1) / 0.1))
    assert np.median(slopes) == pytest.approx(10, abs=0.5)
    assert "1:100" in data["note"]
    assert set("".join(data["rows"])) == {"."}


def test_the_scale_that_is_named_fits(place):
    rng = np.random.default_rng(SEED)
    for spread in (64, 65, 200, 8000):
        land = rng.uniform(0, spread, (5, 5))
        land[0, 0], land[4, 4] = 0, spread
        rows = "\n".join(" ".join(f"{z:.6f}" for z in row) for row in land)
        (place / "land.asc").write_text(f"ncols 5\nnrows 5\nxllcorner 0\nyllcorner 0\ncellsize 20\n{rows}\n")
        result, _ = run_import(place / "land.asc")
        assert_one_line_error(result, "--scale")
        scale = result.stderr.split("--scale ")[1].split()[0]
        assert imported(place / "land.asc", "--scale", scale)


@pytest.mark.parametrize("direction", range(0, 360, 15))
def test_steep_ground_is_occupied(direction):
    y, x = np.mgrid[:20, :20]
    along = 0.2 * (x * math.cos(math.radians(direction)) + y * math.sin(math.radians(direction)))
    assert not import_map.steep_cells(along * math.tan(math.radians(14.9)), 0.2).any()
    # The unit step nearest to the gradient is up to 13.3° off it. At the edge some steps have no end.
    steep = import_map.steep_cells(along * math.tan(math.radians(15.1)) / math.cos(math.radians(13.3)), 0.2)
    assert steep[2:-2, 2:-2].all()


def test_how_steep_it_may_be_is_said(place):
    flat, gentle, usual = (imported(place / "dem.npz", "--resolution", 20, "--scale", 1, *options)
                           for options in (["--steep", 89], ["--steep", 10], []))
    occupied = [sum(row.count("#") for row in data["rows"]) for data in (flat, gentle, usual)]
    assert occupied[0] == 0 and occupied[1] > occupied[2] == 0
    assert "steeper than 10°" in gentle["note"] and "steeper than 15°" in usual["note"]
    assert_one_line_error(run_import(place / "dem.npz", "--steep", 90)[0], "--steep")


@pytest.mark.parametrize("part, replacement, culprit", [
    ("ncols 4\n", "", "ncols"), ("nrows 3\n", "", "nrows"), ("cellsize 2\n", "", "cellsize"),
    ("xllcorner 100\n", "", "xllcorner"), ("yllcorner 200.5\n", "", "yllcorner"), ("ncols 4", "ncols 5", "line 7"),
    ("nrows 3", "nrows 4", "3 rows"), ("nrows 3", "nrows 2", "3 rows"), ("ncols 4", "ncols four", "ncols"),
    ("ncols 4", "ncols 4.5", "ncols"), ("ncols 4", "ncols 0", "ncols"), ("ncols 4", "ncols 99999", "ncols"),
    ("cellsize 2", "cellsize nan", "cellsize"), ("cellsize 2", "cellsize 0", "cellsize"),
    ("cellsize 2", "cellsize -2", "cellsize"), ("cellsize 2", "cellsize 2 2", "line 5"),
    ("cellsize 2", "cellsize 1e5", "--resolution"), ("xllcorner 100", "xllcorner inf", "xllcorner"),
    ("1.1 1.2 1.3", "1.1 1.2", "line 7"), ("1.1 1.2 1.3", "1.1 1.2 1.3 1.4", "line 7"),
    ("1.1 1.2 1.3", "1.1 1.2 abc", "abc"), ("1.1 1.2 1.3", "1.1 1.2 nan", "line 7"),
    ("1.1 1.2 1.3", "1.1 1.2 inf", "line 7"), ("1.1 1.2 1.3", "1.1 1.2 1e999", "line 7"),
    ("1.1 1.2 1.3", "1.1 1.2 1e30", "not of this Earth"), ("NODATA_value -9999\n", "NODATA_value -1\n", "-9999"),
    ("NODATA_value -9999\n", "projection utm\n", "line 6"), ("1.1 1.2 3.2", "1.1 1.2 100", "--scale 2"),
])
def test_asc_errors(place, part, replacement, culprit):
    assert part in ASC
    options = ("--resolution", "2000") if culprit == "--resolution" else ()
    (place / "land.asc").write_text(ASC.replace(part, replacement, 1))
    refused(place / "land.asc", culprit, options=options)


def test_asc_where_nothing_is_known(place):
    (place / "land.asc").write_text("ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value 5\n5 5\n")
    refused(place / "land.asc", "every elevation is missing")


# ---- NumPy elevations ----

def test_npz_fits_300_cells_and_keeps_slopes(place):
    data = imported(place / "dem.npz")
    assert (data["width"], data["height"]) == (300, 240)
    assert data["resolution_m"] == 0.2
    heights = np.array(data["elevation_m"])
    scale = 50 * 20 / 60
    assert np.ptp(heights) == pytest.approx(30 / scale, rel=0.03)
    slopes = np.degrees(np.arctan(np.hypot(*np.gradient(heights, 0.2))))
    assert np.median(slopes[slopes > 5]) == pytest.approx(12, abs=1)
    assert "slopes stay" in data["note"]
    # The hill's top is where it was: a little south-east of the middle.
    top = np.unravel_index(heights.argmax(), heights.shape)
    assert top == pytest.approx((20.5 * 6, 25.5 * 6), abs=3)


def test_npz_cells_that_are_not_square(place):
    (place / "dem.npz").write_bytes(npz(dy=40 / 111200))
    data = imported(place / "dem.npz")
    assert (data["width"], data["height"]) == (187, 300)


def test_npz_window(place):
    data = imported(place / "dem.npz", "--window", 15, 10, 20, 20)
    assert (data["width"], data["height"]) == (300, 300)
    assert "window 15 10 20 20" in data["note"]


@pytest.mark.parametrize("window", [(-1, 0, 5, 5), (0, -1, 5, 5), (0, 0, 0, 5), (0, 0, 5, 0), (46, 0, 5, 5), (0, 36, 5, 5)])
def test_windows_beyond_the_source(place, window):
    refused(place / "dem.npz", "window", options=("--window", *window))


@pytest.mark.parametrize("changes, culprit", [
    ({"elevation": None}, "elevation"), ({"dx": None}, "dx"), ({"dy": None}, "dy"), ({"ymin": None}, "ymin"),
    ({"dx": math.nan}, "dx"), ({"dx": 0.0}, "dx"), ({"dy": -1e-4}, "dy"), ({"ymin": 800.0}, "latitude"),
    ({"dx": np.array([1.0, 2.0])}, "not a NumPy"), ({"dx": "wide"}, "not a NumPy"),
    ({"elevation": np.zeros(5)}, "elevation"), ({"elevation": np.zeros((0, 5))}, "elevation"),
    ({"elevation": np.zeros((2, 9000))}, "elevation"), ({"elevation": np.array([["a"]])}, "not a NumPy"),
    ({"elevation": np.full((5, 5), math.nan)}, "finite"), ({"elevation": np.full((5, 5), math.inf)}, "finite"),
    ({"elevation": np.full((5, 5), 2e4)}, "not of this Earth"),
    ({"elevation": np.array([[{}]], dtype=object)}, "not a NumPy"),
])
def test_npz_errors(place, changes, culprit):
    (place / "dem.npz").write_bytes(npz(**changes))
    refused(place / "dem.npz", "dem.npz", culprit)


def test_npz_that_is_another_file(place):
    whole = npz()
    single = io.BytesIO()
    np.save(single, hill())
    for data in (b"text\n", bytes(100), whole[:200], whole[:-30], whole[30:], single.getvalue()):
        (place / "dem.npz").write_bytes(data)
        refused(place / "dem.npz", "dem.npz")


def test_jacksboro(tmp_path):
    output = tmp_path / "map.json"
    result = run_tool("design.import_map", "jacksboro", output)
    assert result.returncode == 0, result.stderr
    data = check_map(json.loads(output.read_text()))
    assert max(data["width"], data["height"]) == 300
    rows = "".join(data["rows"])
    assert 0.1 < rows.count("#") / len(rows) < 0.4
    assert np.ptp(data["elevation_m"]) > 2


# ---- The program ----

@pytest.mark.parametrize("source, output", [("grid.map", "grid.map"), ("grid.map", "link"), ("yard.yaml", "yard.pgm")])
def test_a_source_is_not_overwritten(place, source, output):
    (place / "link").symlink_to("grid.map")
    before = {path.name: path.read_bytes() for path in place.iterdir()}
    result = run_tool("design.import_map", place / source, place / output)
    assert_one_line_error(result, f"{output}: ", "another file")
    assert {path.name: path.read_bytes() for path in place.iterdir()} == before


def test_a_device_is_written_to_and_stays(place):
    assert_one_line_error(run_tool("design.import_map", place / "grid.map", "/dev/full"), "/dev/full: No space left")


def test_help_says_that_slopes_stay():
    result = run_tool("design.import_map", "--help")
    assert result.returncode == 0
    assert "slopes stay" in result.stdout


@pytest.mark.parametrize("option, value", [
    ("--resolution", "nan"), ("--resolution", "0"), ("--resolution", "-1"), ("--resolution", "inf"),
    ("--resolution", "x"), ("--cell-size", "nan"), ("--scale", "0"), ("--window", "1"), ("--nonsense", "1"),
])
def test_wrong_options(place, option, value):
    result, output = run_import(place / "yard.yaml", option, value)
    assert_one_line_error(result, option)
    assert not output.exists()


def test_scale_is_for_elevations(place):
    for name in ("yard.yaml", "grid.map"):
        refused(place / name, "--scale", options=("--scale", "2"))


@pytest.mark.parametrize("suffix", [".yaml", ".map", ".asc", ".npz", ".cfg"])
def test_files_of_every_kind_that_are_none(tmp_path, suffix):
    path = tmp_path / f"file{suffix}"
    refused(path, "no such file")
    path.write_bytes(b"")
    refused(path, "empty")
    path.write_bytes(bytes(range(256)) * 8)
    refused(path, path.name)
    path.unlink()
    path.mkdir()
    refused(path, "directory")


def test_other_extensions(tmp_path):
    for name in ("map.tif", "map", "jacksboro.json"):
        (tmp_path / name).write_text("x")
        refused(tmp_path / name, name, ".yaml")


def test_extensions_in_capitals(place):
    (place / "grid.map").rename(place / "GRID.MAP")
    assert imported(place / "GRID.MAP")["name"] == "GRID"


def test_output_that_cannot_be_written(place):
    (place / "out").write_text("a file")
    result, _ = run_import(place / "grid.map")
    assert_one_line_error(result, "out")


def test_names_become_plain(place):
    path = place / ("größe & more " + "x" * 80 + ".map")
    path.write_text(MOVING_AI)
    name = imported(path)["name"]
    assert len(name) == 63
    assert name.startswith("gr-e-more-xxx")


# ---- Mutations ----

TOKENS = [b"nan", b"-1", b"0", b"1e999", b"99999999999", b"\n", b" ", b":", b"[", b"\x00", b"\xff\xfe", b"width", b"."]


def mutated(data, generator):
    """A piece cut off, taken out, doubled, or replaced."""
    for _ in range(generator.randint(1, 3)):
        at = generator.randrange(len(data) + 1)
        end = min(len(data), at + generator.randint(1, 8))
        data = generator.choice([
            lambda d=data: d[:at],
            lambda d=data: d[:at] + d[end:],
            lambda d=data: d[:end] + d[at:],
            lambda d=data: d[:at] + bytes(generator.randrange(256) for _ in range(end - at)) + d[end:],
            lambda d=data: d[:at] + generator.choice(TOKENS) + d[end:],
        ])()
    return data


@pytest.mark.parametrize("source, changed", [
    ("yard.yaml", "yard.yaml"), ("yard.yaml", "yard.pgm"), ("flat.yaml", "flat.png"), ("grid.map", "grid.map"),
    ("env.cfg", "env.cfg"), ("land.asc", "land.asc"), ("small.npz", "small.npz"),
])
def test_mutations_give_a_map_or_one_line(place, source, changed):
    (place / "flat.yaml").write_text(YAML.replace("yard.pgm", "flat.png"))
    (place / "flat.png").write_bytes(png(Image.fromarray(PIXELS)))
    (place / "small.npz").write_bytes(npz(elevation=np.arange(12, dtype=np.int16).reshape(3, 4)))
    sound = (place / changed).read_bytes()
    generator = random.Random(f"{SEED} {changed}")
    kinds = {0: 0, 2: 0}
    for count in range(MUTATIONS):
        data = mutated(sound, generator)
        (place / changed).write_bytes(data)
        result, output = run_import(place / source)
        kinds[result.returncode] += 1
        if result.returncode == 0:
            assert result.stderr == "", (count, data)
            check_map(json.loads(output.read_text()))
            output.unlink()
        else:
            assert_one_line_error(result, "import_map.py: ")
            assert not output.exists()
    assert kinds[2] > MUTATIONS / 10, kinds
