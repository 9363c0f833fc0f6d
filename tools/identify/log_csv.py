"""Logs as CSV: a column for the time and one for each channel, with its unit in its name. An empty cell was not
measured at that time."""
import csv
import io
import math

import numpy as np

from tools.common import ToolError, read_text
from tools.identify.samples import UNITS, Log, Segment, spans_where

TIME = "time_s"
SUFFIXES = {"rad": "rad", "m/s": "m_s", "rad/s": "rad_s", "V": "v", "A": "a", "J": "j"}
COLUMNS = {f"{name}_{SUFFIXES[unit]}": name for name, unit in UNITS.items()}
DUTIES = ("duty_left", "duty_right")      # of the bus voltage, in place of voltages
ACTIVE = "motors_on"                      # 1 or 0; without it they are on all the time
SEGMENT, PLANNED = "segment", "planned_j"  # number of the segment, 0: none; the energy that was foretold
OTHERS = (TIME, *DUTIES, ACTIVE, SEGMENT, PLANNED)


def number(path, line, name, cell):
    if not cell.strip():
        return math.nan
    try:
        value = float(cell)
    except ValueError:
        raise ToolError(f"{path}: line {line}: {name}: {cell!r} is not a number") from None
    if math.isinf(value):
        raise ToolError(f"{path}: line {line}: {name}: is infinite")
    return value


def read_columns(path):
    reader = csv.reader(io.StringIO(read_text(path)))
    header = [name.strip() for name in next(reader, [])]
    if TIME not in header:
        raise ToolError(f"{path}: line 1: column {TIME} is missing")
    unknown = [name for name in header if name not in COLUMNS and name not in OTHERS]
    if unknown:
        raise ToolError(f"{path}: line 1: column {unknown[0]!r} is not known; those are: "
                        f"{', '.join((*OTHERS, *COLUMNS))}")
    rows = []
    for row in reader:
        if not row:
            continue
        if len(row) != len(header):
            raise ToolError(f"{path}: line {reader.line_num}: {len(row)} values, expected {len(header)}")
        rows.append([number(path, reader.line_num, name, cell) for name, cell in zip(header, row)])
    if len(rows) < 2:
        raise ToolError(f"{path}: {len(rows)} rows; a log holds more")
    columns = dict(zip(header, np.array(rows).T))
    times = columns[TIME]
    wrong = np.flatnonzero(~(np.diff(times) > 0))
    if len(wrong):
        raise ToolError(f"{path}: line {wrong[0] + 3}: {TIME}: must be given, and above that of the line before")
    return columns


def add_segments(log, columns):
    """Energies between the first row of a segment and the first of the next."""
    number_of, times = np.nan_to_num(columns[SEGMENT]), columns[TIME]
    for begin, end in spans_where(times, number_of > 0):
        inside = (times >= begin) & (times <= end)
        for value in np.unique(number_of[inside]):
            own = np.flatnonzero(inside & (number_of == value))
            last = min(own[-1] + 1, len(times) - 1)
            planned = columns[PLANNED][own] if PLANNED in columns else np.array([math.nan])
            told = planned[np.isfinite(planned)]

            def counted(name, first=own[0], last=last):
                return float(np.diff(log[name].values_at(times[[first, last]]))[0]) if log.has(name) else None
            log.segments.append(Segment(float(times[own[0]]), float(times[last]),
                                        float(told[-1]) if len(told) else None, counted("spent"), counted("drawn")))


def read(path, robot):
    columns = read_columns(path)
    log = Log(str(path))
    for column, name in COLUMNS.items():
        if column in columns:
            log.add(name, columns[TIME], columns[column])
    if all(name in columns for name in DUTIES) and log.has("bus_voltage"):
        for side, name in zip(("left", "right"), DUTIES):
            log.add(f"voltage_{side}", columns[TIME], columns[name] * log["bus_voltage"].values_at(columns[TIME]))
    if ACTIVE in columns:
        log.active = spans_where(columns[TIME], columns[ACTIVE] > 0)
    if SEGMENT in columns:
        add_segments(log, columns)
    return log
