"""Maps of the ground."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import Any, TypeVar

import numpy
from numpy.typing import ArrayLike, NDArray

from ._call import array_over, check, encoded, text
from ._native import ffi, lib

FREE: int = lib.JP_CELL_FREE
OCCUPIED: int = lib.JP_CELL_OCCUPIED
UNKNOWN: int = lib.JP_CELL_UNKNOWN


Scalar = TypeVar("Scalar", bound=numpy.generic)


class Terrain:
    """Cells, their elevation and their costs, row by row from the south: [y, x]."""

    def __init__(self, cells: ArrayLike, cell_m: float, elevation_m: ArrayLike | None = None,
                 costs: ArrayLike | None = None, cost_shift: int = 0, origin: Sequence[float] = (0, 0, 0),
                 unknown_is_free: bool = False) -> None:
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
        prices = None if costs is None else _bytes(_like(cells, "costs", costs))
        arrays = {"cells": ffi.from_buffer("uint8_t[]", cells),
                  "elevation": ffi.NULL if elevation is None else ffi.from_buffer("jp_elevation[]", elevation),
                  "costs": ffi.NULL if prices is None else ffi.from_buffer("uint8_t[]", prices)}
        self._map = ffi.new("struct map_file *")
        check(lib.map_arrays_make(self._map, ffi.new("struct jp_terrain_config *", config),
                                  ffi.new("struct map_arrays *", arrays)))
        self._own()
        self._map.origin = list(origin)

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Terrain:
        """The map of a JSON file, as tools/design/import_map.py writes it."""
        terrain = cls.__new__(cls)
        terrain._map = ffi.new("struct map_file *")
        check(lib.map_file_load(encoded(path), terrain._map))
        terrain._own()
        return terrain

    def _own(self) -> None:
        self._map = ffi.gc(self._map, lib.map_file_free)
        self._terrain = ffi.addressof(self._map, "terrain")

    @property
    def name(self) -> str:
        """Of the map; empty where it was made of arrays."""
        return text(self._map.name)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return int(self._terrain.config.height), int(self._terrain.config.width)

    @property
    def cell_m(self) -> float:
        """Side of a cell, m."""
        return float(self._terrain.config.resolution / lib.JP_Q16_ONE)

    @property
    def origin(self) -> tuple[float, float, float]:
        """x, y, m, and direction, rad, of the south-west corner in the map's frame."""
        x, y, direction = self._map.origin
        return float(x), float(y), float(direction)

    @property
    def cells(self) -> NDArray[numpy.uint8]:
        """FREE, OCCUPIED or UNKNOWN, a copy."""
        cells = numpy.empty(self.shape, dtype=numpy.uint8)
        lib.map_arrays_cells(self._map, ffi.from_buffer("uint8_t[]", cells, require_writable=True))
        return cells

    @property
    def elevation_units(self) -> NDArray[numpy.int16] | None:
        """In units of 1/1024 m, over the map's own memory; None: level."""
        return self._over(self._terrain.elevation, numpy.int16)

    @property
    def elevation_m(self) -> NDArray[numpy.float64] | None:
        """m, a copy; None: level."""
        units = self.elevation_units
        return None if units is None else units / float(lib.JP_ELEVATION_ONE)

    @property
    def costs(self) -> NDArray[numpy.uint8] | None:
        """0 to 255, over the map's own memory; None: everywhere the same."""
        return self._over(self._terrain.costs, numpy.uint8)

    def _over(self, pointer: Any, dtype: type[Scalar]) -> NDArray[Scalar] | None:
        if pointer == ffi.NULL:
            return None
        height, width = self.shape
        return array_over(pointer, height * width, dtype, self._map).reshape(height, width)


def _like(cells: NDArray[Any], name: str, values: ArrayLike) -> NDArray[Any]:
    array = numpy.asarray(values)
    if array.shape != cells.shape:
        raise ValueError(f"{name}: is an array of {array.shape}; the cells' is {cells.shape}")
    return array


def _units(elevation_m: NDArray[Any]) -> NDArray[numpy.int16]:
    units = numpy.rint(numpy.asarray(elevation_m, dtype=float) * lib.JP_ELEVATION_ONE)
    most = numpy.iinfo(numpy.int16).max
    if not numpy.all(numpy.abs(units) <= most):
        raise ValueError(f"elevation_m: must be within ±{most / lib.JP_ELEVATION_ONE:.3f} m")
    return numpy.ascontiguousarray(units, dtype=numpy.int16)


def _bytes(costs: NDArray[Any]) -> NDArray[numpy.uint8]:
    if not numpy.all((costs >= 0) & (costs <= 255) & (costs == numpy.floor(costs))):
        raise ValueError("costs: must be whole numbers from 0 to 255")
    return numpy.ascontiguousarray(costs, dtype=numpy.uint8)
