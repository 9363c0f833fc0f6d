"""Calls of the library in C: errors as exceptions, memory as arrays."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import Any

import numpy
from numpy.typing import NDArray

from ._native import ffi, lib


class Error(ValueError):
    """What is wrong, where, why and what to do, in one line."""


def check(is_good: object) -> None:
    """Raises Error with the line that a call has left, if it says that it failed."""
    if not is_good:
        raise Error(ffi.string(lib.errors_last()).decode() or "failed without a reason")


def text(string: Any) -> str:
    return ffi.string(string).decode()


def encoded(path: str | PathLike[str]) -> bytes:
    return str(path).encode()


def array_over(pointer: Any, count: int, dtype: Any, owner: object) -> NDArray[Any]:
    """A read-only array over memory of C, which it keeps alive by its owner."""
    kept = ffi.gc(pointer, lambda _, owner=owner: None)
    array: NDArray[Any] = numpy.frombuffer(ffi.buffer(kept, count * numpy.dtype(dtype).itemsize), dtype=dtype)
    array.flags.writeable = False
    return array


def record(struct: str, names: Mapping[str, tuple[str, ...]]) -> numpy.dtype[numpy.void]:
    """The dtype of an array of structs: {name in Python: (path of the member in C)}."""
    formats: list[Any] = []
    offsets: list[int] = []
    for path in names.values():
        kind = ffi.typeof(struct)
        for member in path:
            kind = dict(kind.fields)[member].type
        formats.append(_scalar(kind))
        offsets.append(ffi.offsetof(struct, *path))
    return numpy.dtype({"names": list(names), "formats": formats, "offsets": offsets, "itemsize": ffi.sizeof(struct)})


def _scalar(kind: Any) -> Any:
    if kind.cname == "double":
        return numpy.float64
    signed = int(ffi.cast(kind, -1)) < 0
    return numpy.dtype(f"{'i' if signed else 'u'}{ffi.sizeof(kind)}")
