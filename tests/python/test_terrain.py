"""Maps as arrays: what goes in comes out, over the library's own memory, and what is wrong is said."""
import gc
import json

import numpy
import pytest
from joulepath import FREE, OCCUPIED, UNKNOWN, Error, Terrain

RANDOM = numpy.random.default_rng(22)


def random_terrain(height=7, width=11):
    cells = RANDOM.integers(0, 3, (height, width))
    elevation = RANDOM.uniform(-31, 31, (height, width))
    costs = RANDOM.integers(0, 256, (height, width))
    return cells, elevation, costs, Terrain(cells, 0.25, elevation, costs, cost_shift=4, origin=(1, -2, 0.5))


def test_arrays_come_back():
    cells, elevation, costs, terrain = random_terrain()
    assert terrain.shape == cells.shape and terrain.cell_m == 0.25 and terrain.origin == (1, -2, 0.5)
    assert (terrain.cells == cells).all() and (terrain.costs == costs).all()
    assert numpy.abs(terrain.elevation_m - elevation).max() <= 0.5 / 1024


def test_a_plain_map_has_no_elevation_and_no_costs():
    terrain = Terrain(numpy.zeros((3, 4), bool), 0.1)
    assert terrain.elevation_m is None and terrain.elevation_units is None and terrain.costs is None
    assert (terrain.cells == FREE).all()


def test_true_is_occupied_and_any_layout_will_do():
    cells = numpy.zeros((6, 8), bool)
    cells[1, 2] = True
    assert (Terrain(numpy.asfortranarray(cells), 0.1).cells == Terrain(cells, 0.1).cells).all()
    assert Terrain(cells[::2, ::-1], 0.1).shape == (3, 8)
    assert Terrain(cells, 0.1).cells[1, 2] == OCCUPIED


def test_views_are_of_the_map_and_outlive_it():
    *_, terrain = random_terrain()
    view, before = terrain.elevation_units, terrain.elevation_units.copy()
    assert not view.flags.owndata and not view.flags.writeable
    with pytest.raises(ValueError):
        view[0, 0] = 1
    del terrain
    gc.collect()
    random_terrain()
    assert (view == before).all()


def test_a_file_says_the_same(tmp_path):
    path = tmp_path / "map.json"
    path.write_text(json.dumps({"format": "joulepath-map-1", "name": "corner", "width": 3, "height": 2,
                                "resolution_m": 0.5, "origin_m": [1, 2, 0], "rows": ["#.?", "..."],
                                "elevation_m": [[0, 0, 1], [0, 0, 0]]}))
    terrain = Terrain.load(path)
    assert terrain.name == "corner" and terrain.shape == (2, 3) and terrain.origin == (1, 2, 0)
    assert terrain.cells.tolist() == [[FREE] * 3, [OCCUPIED, FREE, UNKNOWN]]
    assert terrain.elevation_m[1, 2] == 1


@pytest.mark.parametrize("arguments, says", [
    (dict(cells=numpy.zeros(4)), "rows and columns"),
    (dict(cells=numpy.zeros((0, 4))), "rows and columns"),
    (dict(cells=numpy.zeros((1, 4097))), "4096"),
    (dict(cells=numpy.full((2, 2), 3)), "none of FREE"),
    (dict(cell_m=0), "resolution"),
    (dict(elevation_m=numpy.zeros((3, 3))), "elevation_m"),
    (dict(elevation_m=numpy.full((2, 2), 32.5)), "elevation_m"),
    (dict(elevation_m=numpy.full((2, 2), numpy.nan)), "elevation_m"),
    (dict(costs=numpy.full((2, 2), 256)), "costs"),
    (dict(costs=numpy.full((2, 2), 0.5)), "costs"),
    (dict(costs=numpy.zeros((2, 2)), cost_shift=9), "cost_shift")])
def test_what_is_wrong_is_said(arguments, says):
    with pytest.raises(ValueError, match=says):
        Terrain(**{"cells": numpy.zeros((2, 2)), "cell_m": 0.1, **arguments})


def test_a_file_that_is_not_there_is_said():
    with pytest.raises(Error, match="^no/map.json: No such file.*give the path of a map$"):
        Terrain.load("no/map.json")
