"""map_stream.py: the stream as the firmware codes it, every kind of row, streams that are none, places on a map."""
import json

import numpy as np
import pytest

from tools.common import ToolError
from tools.operate.map_stream import HEAD, CellMap, Place, decode, encode, read_cells

ORIGIN = Place(1.0, -2.0, 90.0)
# The golden stream of tests/unit/can/test_map_code.c, but for cells that unknown ones block.
GOLDEN = bytes([5, 0, 4, 0, 0x9A, 0x19, 0, 0, 0, 0, 1, 0, 0, 0, 0xFE, 0xFF, 0, 0, 0, 0x40, 0,
                0, 128, 0x04, 0x00, 0, 129, 0x84])


def cell_map(rows, frame=Place(0, 0)):
    return CellMap(np.array(rows), 0.1, frame)


def golden_map():
    return cell_map([[2] * 5, [0, 1, 0, 0, 0], [0, 1, 0, 0, 0], [2] * 5])


def test_golden_stream():
    assert encode(golden_map(), ORIGIN) == GOLDEN


def test_comes_back_as_it_went():
    random = np.random.default_rng(1)
    for _ in range(200):
        shape = random.integers(1, 150), random.integers(1, 140)
        density = random.choice([0.0, 0.02, 0.5])
        cells = np.where(random.random(shape) < density, random.integers(0, 3, shape), random.integers(0, 3))
        back, origin = decode(encode(cell_map(cells), ORIGIN))
        assert (back.cells == cells).all() and back.resolution == pytest.approx(0.1, abs=1e-5)
        assert (origin.x, origin.y, origin.heading) == (1.0, -2.0, 90.0)


def test_rows_as_before_are_short():
    assert len(encode(cell_map(np.zeros((200, 100), dtype=int)), ORIGIN)) == HEAD.size + 3 + 2
    assert len(encode(cell_map(np.full((129, 7), 2)), ORIGIN)) == HEAD.size + 2


def test_too_long_for_the_bus():
    with pytest.raises(ToolError, match="65535"):
        encode(cell_map(np.arange(1000 * 301).reshape(1000, 301) % 3), ORIGIN)


@pytest.mark.parametrize("stream", [
    b"", GOLDEN[:20], GOLDEN[:-1], GOLDEN + b"\0", GOLDEN[:21] + bytes([4]), GOLDEN[:25] + bytes([5])])
def test_what_is_no_map(stream):
    assert decode(stream) is None


def write(path, **more):
    path.write_text(json.dumps({"format": "joulepath-map-1", "name": "m", "width": 3, "height": 2,
                                "resolution_m": 0.5, "origin_m": [10.0, 20.0, np.pi / 2], "rows": [".#?", "..."],
                                **more}))
    return path


def test_reads_an_imported_map(tmp_path):
    found = read_cells(write(tmp_path / "map.json"))
    assert found.cells.tolist() == [[0, 0, 0], [0, 1, 2]]
    assert (found.frame.x, found.frame.y, found.frame.heading) == (10.0, 20.0, pytest.approx(90))


def test_places_from_the_corner(tmp_path):
    """The map's frame is turned by 90 degrees."""
    found = read_cells(write(tmp_path / "map.json"))
    place = found.from_corner(Place(9.4, 21.2, 135.0))
    assert (place.x, place.y, place.heading) == (pytest.approx(1.2), pytest.approx(0.6), pytest.approx(45.0))
    assert found.cell("--goal", Place(9.4, 21.2)) == (2, 1)
    with pytest.raises(ToolError, match="--goal 9.4,22: is outside the map"):
        found.cell("--goal", Place(9.4, 22.0))
