"""The energy model of include/joulepath/four_wheel_energy.h in floating point, of many pieces at once."""
from dataclasses import dataclass, fields, replace

import numpy as np

from tools.design.energy_model import Parameters, Pieces as EnergyPieces, ratio

ROLLING, WEIGHT, STEERING, ELECTRONICS = range(4)  # JP_FOUR_WHEEL_ROLLING and so on
FACTORS = 4
WHEELS = 4


@dataclass(frozen=True)
class Model(Parameters):
    """struct jp_four_wheel_energy_model in SI units, without the unit of energy."""
    wheelbase: float
    track: float
    weight: float
    rolling: float
    drag: float
    cornering: float
    inertia: float
    turn_inertia: float
    driving: float
    braking: float
    copper_driving: float
    copper_braking: float
    steering: float
    contact: float
    electronics_power: float

    def scaled(self, factors):
        """The same of a robot that differs by factors, as jp_four_wheel_energy_scale()."""
        square = factors[WEIGHT]**2
        return replace(self, rolling=self.rolling * factors[ROLLING], drag=self.drag / factors[WEIGHT],
                       weight=self.weight * factors[WEIGHT], copper_driving=self.copper_driving * square,
                       copper_braking=self.copper_braking * square, steering=self.steering * factors[STEERING],
                       electronics_power=self.electronics_power * factors[ELECTRONICS])


NAMES = tuple(field.name for field in fields(Model))


@dataclass(frozen=True)
class Pieces(EnergyPieces):
    x: np.ndarray          # at the start and at the end
    y: np.ndarray
    turn_rate: np.ndarray
    grade: np.ndarray
    bank: np.ndarray
    travel: np.ndarray


def energies(model, pieces):
    """J of each piece."""
    x, y, w = pieces.x.mean(axis=0), pieces.y.mean(axis=0), pieces.turn_rate.mean(axis=0)
    ax, ay, around = (np.diff(ends, axis=0)[0] / pieces.seconds for ends in (pieces.x, pieces.y, pieces.turn_rate))
    across, along = w * model.track / 2, w * model.wheelbase / 2
    wheels = [np.hypot(x - side * across, y + end * along) for end in (1, -1) for side in (1, -1)]
    rolling = sum(wheels) / WHEELS
    effort = (pieces.grade * x + pieces.bank * y + model.inertia * (x * ax + y * ay) + model.turn_inertia * w * around)
    power = model.driving * model.weight * model.cornering * (x**2 + y**2) * w**2
    for speed in wheels:
        force = model.rolling / WHEELS + model.drag * speed + ratio(effort, WHEELS * rolling)
        power += np.where(force >= 0, model.driving, model.braking) * model.weight * force * speed
        power += np.where(force >= 0, model.copper_driving, model.copper_braking) * force**2
    scrubbing = model.contact * pieces.travel / (WHEELS * pieces.seconds)
    steering = model.steering * pieces.travel * np.where(rolling > 0, ratio(scrubbing, np.hypot(scrubbing, rolling)), 1)
    return (model.electronics_power + np.where(rolling > 0, power, 0)) * pieces.seconds + steering
