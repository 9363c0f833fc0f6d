"""Calls of the library in C: errors as exceptions, memory as arrays."""

import numpy

from ._native import ffi, lib


class Error(ValueError):
    """What is wrong, where, why and what to do, in one line."""


def check(is_good):
    """Raises Error with the line that a call has left, if it says that it failed."""
    if not is_good:
        raise Error(ffi.string(lib.errors_last()).decode() or "failed without a reason")


def text(string):
    return ffi.string(string).decode()


def encoded(path):
    return str(path).encode()


def array_over(pointer, count, dtype, owner):
    """A read-only array over memory of C, which it keeps alive by its owner."""
    kept = ffi.gc(pointer, lambda _, owner=owner: None)
    array = numpy.frombuffer(ffi.buffer(kept, count * numpy.dtype(dtype).itemsize), dtype=dtype)
    array.flags.writeable = False
    return array


def record(struct, names):
    """The dtype of an array of structs: {name in Python: (path of the member in C)}."""
    fields = {"names": list(names), "formats": [], "offsets": [], "itemsize": ffi.sizeof(struct)}
    for path in names.values():
        kind = ffi.typeof(struct)
        for member in path:
            kind = dict(kind.fields)[member].type
        fields["formats"].append(_scalar(kind))
        fields["offsets"].append(ffi.offsetof(struct, *path))
    return numpy.dtype(fields)


def _scalar(kind):
    if kind.cname == "double":
        return numpy.float64
    signed = int(ffi.cast(kind, -1)) < 0
    return numpy.dtype(f"{'i' if signed else 'u'}{ffi.sizeof(kind)}")
