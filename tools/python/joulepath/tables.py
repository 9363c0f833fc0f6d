"""From a robot file to tables: what a robot's firmware is compiled with, as numbers and as the text of the C files.

This is the project's design tools, in this process; they need SciPy beside the package: pip install 'joulepath[tools]'.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy
from numpy.typing import NDArray

from ._call import Error
from .robot import robot_path

_PACKAGE = Path(__file__).parent


@dataclass(frozen=True)
class Table:
    """A const struct of the library.

    name      of the file, such as robot_mine.c
    struct    its type, such as jp_robot_config
    values    members by their names, integers in the formats of the struct, arrays and groups within groups
    text      of the C file
    """
    name: str
    struct: str
    values: dict[str, Any] = field(repr=False)
    text: str = field(repr=False)


@dataclass(frozen=True)
class Balancer:
    """The design of a balancer's controller.

    gains           V per rad, V·s per rad and V/s per rad of the LQR: wheel, pitch, wheel_rate, pitch_rate,
                    wheel_integral, yaw, yaw_rate, yaw_integral
    poles           of the closed loop, 1/s, complex
    margins         modulus margins of travel and yaw with the estimator and the sensors' delay, of 1
    settling_s      until the voltages of a step have settled
    a, b            energy model as the linear plant predicts it: J per product of m/s, rad/s, rad and V; 13 and 2
    controller      Table jp_robot_config
    energy          Table jp_energy_model, of the linear plant; driving experiments makes it better
    """
    name: str
    gains: dict[str, float]
    poles: NDArray[numpy.complex128]
    margins: dict[str, float]
    settling_s: float
    a: NDArray[numpy.float64] = field(repr=False)
    b: NDArray[numpy.float64] = field(repr=False)
    controller: Table
    energy: Table


@dataclass(frozen=True)
class SkidSteered:
    """The design of a robot that its sides steer: the Table jp_skid_robot_config."""
    name: str
    controller: Table


def design(robot: str | PathLike[str]) -> Balancer | SkidSteered:
    """The controller of a robot, by its name or the path of its file: Balancer or SkidSteered. What physics or formats
    forbid is an Error."""
    linear_model, robot_json, gain_design, skid_robot = _tools("linear_model", "robot_json", "gain_design", "skid_robot")
    with _errors():
        data = robot_json.load_any(robot_path(robot), _program("jp-robot"))
        if data.type != robot_json.BALANCER:
            return SkidSteered(data.name, _table(f"skid_robot_{data.name}.c", skid_robot.robot_table(robot_json.skid_steer(data))))
        data = robot_json.balancer(data)
        loop = linear_model.design(data)
        model = linear_model.linear_energy_model(data, loop)
        return Balancer(data.name, vars(loop.gains).copy(), numpy.array(loop.poles), gain_design.margins(data, loop),
                        model.settling_time, numpy.array(model.a), numpy.array(model.b),
                        _table(f"robot_{data.name}.c", gain_design.robot_table(data, loop)),
                        _table(f"energy_{data.name}.c", gain_design.initial_energy_table(data, model)))


@dataclass(frozen=True)
class Identified:
    """The energy model of a balancer by experiments in the simulator: a and b as of Balancer, and by how much it misses
    experiments that it was not fitted to, % of what they took, on average."""
    a: NDArray[numpy.float64]
    b: NDArray[numpy.float64]
    error_percent: float
    table: Table


def identify(robot: str | PathLike[str], experiments: int = 1000, seed: int = 1) -> Identified:
    """Drives experiments with a balancer whose controller is built in, and fits its energy model (Identified)."""
    robot_json, tool, c_tables, energy_unit = _tools("robot_json", "identify", "c_tables", "energy_unit")
    path = robot_path(robot)
    with _errors(), tempfile.TemporaryDirectory() as folder:
        data = robot_json.load(path, _program("jp-robot"))
        robot_json.printed_by(_program("jp-identify"), str(path), "--output", folder, f"--count={experiments}", f"--seed={seed}")
        driven = tool.read_experiments(Path(folder), data.name)
        result = tool.identify(data, driven)
        tool.check_validation(data, driven, result)
        table = c_tables.energy_table(data.name, result.model, energy_unit.exponent(data), f"make identify ROBOT={data.name}",
                                      f"{driven.count} experiments of jp-identify, seed {driven.seed}", "")
        error = result.validation.summary()["mean_relative_error_percent"]
        return Identified(numpy.array(result.model.a), numpy.array(result.model.b), error,
                          _table(f"energy_{data.name}.c", table))


def write_lattice(robot: str | PathLike[str], path: str | PathLike[str]) -> None:
    """Writes the state lattice that fits a robot as JSON, for Lattice.load()."""
    lattice, = _tools("lattice")
    with _errors():
        tables, *_ = lattice.generated(Path(robot_path(robot)).resolve())
        Path(path).write_text(lattice.file_text(tables), encoding="utf-8")


# ---- The project's tools ----

def _tools(*names: str) -> list[Any]:
    import importlib
    try:
        return [importlib.import_module(f"joulepath.tools.design.{name}") for name in names]
    except ModuleNotFoundError as error:
        raise Error(f"tables need the Python package of {error.name}; pip install 'joulepath[tools]' has all") from None


def _program(name: str) -> str:
    return str(_PACKAGE / "build" / "bin" / name)


class _errors:
    """What the tools complain about, as Error."""

    def __enter__(self) -> _errors:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None) -> None:
        from .tools.common import ToolError
        if isinstance(error, ToolError):
            raise Error(str(error)) from None


def _table(name: str, table: Any) -> Table:
    c_tables, = _tools("c_tables")
    return Table(name, table.type, _values(table.members), c_tables.render(table))


def _values(members: Any) -> dict[str, Any]:
    return {member.name: _value(member) for member in members}


def _value(member: Any) -> Any:
    if hasattr(member, "members"):
        return _values(member.members)
    if hasattr(member, "values"):
        return numpy.array([_number(value) for value in member.values])
    return _number(member.value)


def _number(text: object) -> int | bool | str:
    """Of C: an integer, true or false, or what has a name."""
    word = str(text)
    if word in ("true", "false"):
        return word == "true"
    try:
        return int(word.rstrip("U"))
    except ValueError:
        return word.strip('"')
