"""Maps of the ground."""

import numpy

from ._call import array_over, check, encoded, text
from ._native import ffi, lib

FREE, OCCUPIED, UNKNOWN = lib.JP_CELL_FREE, lib.JP_CELL_OCCUPIED, lib.JP_CELL_UNKNOWN


class Terrain:
    """Cells, their elevation and their costs, row by row from the south: [y, x]."""

    def __init__(self, cells, cell_m, elevation_m=None, costs=None, cost_shift=0, origin=(0, 0, 0),
                 unknown_is_free=False):
        """A map of arrays.

        cells        FREE, OCCUPIED or UNKNOWN; or True where something stands
        cell_m       side of a cell, m
        elevation_m  m, within ±32 m; None: level
        costs        0 to 255: driving there costs 1 + cost / 2**cost_shift times as much; None: everywhere the same
        origin       x, y, m, and direction, rad, of the south-west corner in the map's frame
        """
        cells = numpy.ascontiguousarray(cells, dtype=numpy.uint8)
        if cells.ndim != 2 or not 0 < min(cells.shape) <= max(cells.shape) <= lib.JP_TERRAIN_SIDE_MAX:
            raise ValueError(f"cells: is an array of {cells.shape}; give rows and columns, 1 to {lib.JP_TERRAIN_SIDE_MAX}")
        if cells.max() > UNKNOWN:
            raise ValueError(f"cells: {cells.max()} is none of FREE, OCCUPIED and UNKNOWN")
        config = {"width": cells.shape[1], "height": cells.shape[0], "resolution": round(cell_m * lib.JP_Q16_ONE),
                  "has_elevation": elevation_m is not None, "unknown_is_free": unknown_is_free,
                  "has_costs": costs is not None, "cost_shift": cost_shift}
        elevation = None if elevation_m is None else _units(_like(cells, "elevation_m", elevation_m))
        costs = None if costs is None else _bytes(_like(cells, "costs", costs))
        arrays = {"cells": ffi.from_buffer("uint8_t[]", cells),
                  "elevation": ffi.NULL if elevation is None else ffi.from_buffer("jp_elevation[]", elevation),
                  "costs": ffi.NULL if costs is None else ffi.from_buffer("uint8_t[]", costs)}
        self._map = ffi.new("struct map_file *")
        check(lib.map_arrays_make(self._map, ffi.new("struct jp_terrain_config *", config),
                                  ffi.new("struct map_arrays *", arrays)))
        self._own()
        self._map.origin = list(origin)

    @classmethod
    def load(cls, path):
        """The map of a JSON file, as tools/design/import_map.py writes it."""
        terrain = cls.__new__(cls)
        terrain._map = ffi.new("struct map_file *")
        check(lib.map_file_load(encoded(path), terrain._map))
        terrain._own()
        return terrain

    def _own(self):
        self._map = ffi.gc(self._map, lib.map_file_free)
        self._terrain = ffi.addressof(self._map, "terrain")

    @property
    def name(self):
        return text(self._map.name)

    @property
    def shape(self):
        """Rows and columns."""
        return self._terrain.config.height, self._terrain.config.width

    @property
    def cell_m(self):
        """Side of a cell, m."""
        return self._terrain.config.resolution / lib.JP_Q16_ONE

    @property
    def origin(self):
        """x, y, m, and direction, rad, of the south-west corner in the map's frame."""
        return tuple(self._map.origin)

    @property
    def cells(self):
        """FREE, OCCUPIED or UNKNOWN, a copy."""
        cells = numpy.empty(self.shape, dtype=numpy.uint8)
        lib.map_arrays_cells(self._map, ffi.from_buffer("uint8_t[]", cells, require_writable=True))
        return cells

    @property
    def elevation_units(self):
        """In units of 1/1024 m, over the map's own memory; None: level."""
        return self._over(self._terrain.elevation, numpy.int16)

    @property
    def elevation_m(self):
        """m, a copy; None: level."""
        units = self.elevation_units
        return None if units is None else units / lib.JP_ELEVATION_ONE

    @property
    def costs(self):
        """0 to 255, over the map's own memory; None: everywhere the same."""
        return self._over(self._terrain.costs, numpy.uint8)

    def _over(self, pointer, dtype):
        if pointer == ffi.NULL:
            return None
        height, width = self.shape
        return array_over(pointer, height * width, dtype, self._map).reshape(height, width)


def _like(cells, name, values):
    values = numpy.asarray(values)
    if values.shape != cells.shape:
        raise ValueError(f"{name}: is an array of {values.shape}; the cells' is {cells.shape}")
    return values


def _units(elevation_m):
    units = numpy.rint(numpy.asarray(elevation_m, dtype=float) * lib.JP_ELEVATION_ONE)
    most = numpy.iinfo(numpy.int16).max
    if not numpy.all(numpy.abs(units) <= most):
        raise ValueError(f"elevation_m: must be within ±{most / lib.JP_ELEVATION_ONE:.3f} m")
    return numpy.ascontiguousarray(units, dtype=numpy.int16)


def _bytes(costs):
    if not numpy.all((costs >= 0) & (costs <= 255) & (costs == numpy.floor(costs))):
        raise ValueError("costs: must be whole numbers from 0 to 255")
    return numpy.ascontiguousarray(costs, dtype=numpy.uint8)
