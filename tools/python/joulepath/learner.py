"""What a balancer learns of its energy while it drives: learner.h."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy
from numpy.typing import NDArray

from ._call import Error, encoded, text
from ._native import ffi, lib

MOTORS: Literal["motor"] = "motor"
BATTERY: Literal["battery"] = "battery"
CAUSES: dict[int, str | None] = {lib.JP_CAUSE_NONE: None, lib.JP_CAUSE_GROUND: "ground", lib.JP_CAUSE_PAYLOAD: "payload",
          lib.JP_CAUSE_OTHER: "other"}


class Segment(NamedTuple):
    """A step of the references, which is kept up for so long: the paper's segment."""
    speed: float      # m/s
    turn_rate: float  # rad/s
    turn: float       # rad, towards the new direction, before
    seconds: float    # s, that it is kept up


AnySegment: TypeAlias = Segment | tuple[float, float, float, float]


class Learner:
    """Forecasts segments with their uncertainty, and learns from what they took.

    learner = Learner("courier24")
    learner.learn(segments, joules)           # as they were driven, one after the other from a stand
    joules, deviation = learner.forecast(segments)
    """

    def __init__(self, robot: str, energy: Literal["motor", "battery"] = MOTORS) -> None:
        """By the name of a balancer that is built in; energy: "motor" or "battery"."""
        if energy not in (MOTORS, BATTERY):
            raise ValueError(f"energy: {energy!r} is none of {MOTORS}, {BATTERY}")
        entry = lib.rig_find_robot(encoded(robot))
        suffix = "" if energy == MOTORS else "_battery"
        tables = [ffi.NULL] * 3 if entry == ffi.NULL else [
            getattr(entry, name + suffix) for name in ("learning", "energy", "horizon")]
        if ffi.NULL in tables:
            raise Error(f"{robot}: no tables to learn with are built in; give a balancer that has them")
        self._tables = tables
        self._unit: float = 2.0 ** tables[1].unit_exponent / lib.JP_Q16_ONE
        self._learner = ffi.new("struct jp_learner *")
        lib.jp_learner_start(self._learner, *tables)

    def learn(self, segments: Iterable[AnySegment], joules: Iterable[float]) -> int:
        """Takes what segments took, J, electronics included. How many of them counted as outliers."""
        outliers, start = 0, ffi.new("struct jp_energy_start *")
        learned = ffi.new("enum jp_learned *")
        for segment, energy in zip(segments, joules, strict=True):
            command = self._command(segment)
            self._accept(lib.jp_learner_update(self._learner, start, command, self._units(energy), learned))
            outliers += learned[0] in (lib.JP_LEARNED_OUTLIER, lib.JP_LEARNED_CHANGE)
            self._accept(lib.jp_forecast_add(self._learner, ffi.new("struct jp_forecast_sum *"), start, command))
        return outliers

    def forecast(self, segments: Iterable[AnySegment]) -> tuple[float, float]:
        """J that segments will take, one after the other from a stand, and the standard deviation."""
        total, start = ffi.new("struct jp_forecast_sum *"), ffi.new("struct jp_energy_start *")
        for segment in segments:
            self._accept(lib.jp_forecast_add(self._learner, total, start, self._command(segment)))
        forecast = ffi.new("struct jp_forecast *")
        self._accept(lib.jp_forecast_total(self._learner, total, forecast))
        return float(forecast.energy * self._unit), float(forecast.deviation * self._unit)

    @property
    def parameters(self) -> NDArray[numpy.float64]:
        """a1 to a13, b1 and b2 of the model as learned, in J per products of m/s, rad/s, rad and V."""
        model = ffi.new("struct jp_energy_model *")
        lib.jp_learner_model(self._learner, model)
        return numpy.array([*model.a, *model.b], dtype=numpy.float64) * float(self._unit)

    @property
    def coordinates(self) -> NDArray[numpy.float64]:
        """x along the directions in which robots of this kind differ; 0 is the robot of the file."""
        return numpy.array(list(self._learner.state.x), dtype=numpy.float64) / float(lib.JP_Q24_ONE)

    @property
    def ground(self) -> tuple[float, float]:
        """Friction of the ground, as a share of that of the robot file, and its standard deviation."""
        return self._causes(0)

    @property
    def payload_kg(self) -> tuple[float, float]:
        """Mass beside that of the robot file, kg, and its standard deviation."""
        return self._causes(1)

    @property
    def changes(self) -> tuple[int, str | None]:
        """How often robot or ground have changed, and the cause of the last time, if it is known."""
        return int(self._learner.changes), CAUSES[self._learner.cause]

    @property
    def state(self) -> bytes:
        """What is known, as bytes to be kept for restore()."""
        return bytes(ffi.buffer(ffi.addressof(self._learner, "state")))

    def restore(self, state: bytes) -> None:
        """Goes on from a state that was learned with the same tables."""
        if len(state) != ffi.sizeof("struct jp_learned_state"):
            raise Error(f"state: {len(state)} bytes; a state has {ffi.sizeof('struct jp_learned_state')}")
        given, field = ffi.new("struct jp_learned_state *"), ffi.new("const char **")
        ffi.memmove(given, state, len(state))
        if lib.jp_learner_restore(self._learner, given, field) != lib.JP_OK:
            raise Error(f"state: {text(field[0])} is out of range, or of other tables")

    def _causes(self, which: int) -> tuple[float, float]:
        value, deviation = ffi.new("jp_q16[2]"), ffi.new("jp_q16[2]")
        lib.jp_learner_causes(self._learner, value, value + 1)
        lib.jp_learner_cause_deviations(self._learner, deviation, deviation + 1)
        return float(value[which] / lib.JP_Q16_ONE), float(deviation[which] / lib.JP_Q16_ONE)

    def _units(self, energy: float) -> int:
        units = round(energy / self._unit)
        if not -2**31 <= units < 2**31:
            raise Error(f"joules: {energy:g} is more than the robot's format holds")
        return units

    @staticmethod
    def _command(segment: AnySegment) -> Any:
        speed, turn_rate, turn, seconds = Segment(*segment)
        try:
            return ffi.new("struct jp_segment_command *", {
                "motion": {"speed": round(speed * lib.JP_Q24_ONE), "turn_rate": round(turn_rate * lib.JP_Q24_ONE)},
                "turn": round(turn * lib.JP_Q24_ONE), "duration": round(seconds * lib.JP_Q16_ONE)})
        except OverflowError:
            raise Error(f"segment: {tuple(segment)} is out of range") from None

    @staticmethod
    def _accept(status: int) -> None:
        if status != lib.JP_OK:
            raise Error("segment: out of range, shorter than the model holds for, or more joules than can be counted")
