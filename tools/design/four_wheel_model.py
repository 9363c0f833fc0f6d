"""The energy model of include/joulepath/four_wheel_energy.h in floating point, of many pieces at once."""
from dataclasses import dataclass, fields, replace

import numpy as np

ROLLING, WEIGHT, STEERING, ELECTRONICS = range(4)  # JP_FOUR_WHEEL_ROLLING and so on
FACTORS = 4
WHEELS = 4


@dataclass(frozen=True)
class Model:
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

    def with_values(self, names, values):
        return replace(self, **dict(zip(names, values)))

    def scaled(self, factors):
        """The same of a robot that differs by factors, as jp_four_wheel_energy_scale()."""
        square = factors[WEIGHT]**2
        return replace(self, rolling=self.rolling * factors[ROLLING], drag=self.drag / factors[WEIGHT],
                       weight=self.weight * factors[WEIGHT], copper_driving=self.copper_driving * square,
                       copper_braking=self.copper_braking * square, steering=self.steering * factors[STEERING],
                       electronics_power=self.electronics_power * factors[ELECTRONICS])


NAMES = tuple(field.name for field in fields(Model))


@dataclass(frozen=True)
class Pieces:
    """Arrays, an element a piece; `group` numbers what is summed up."""
    x: np.ndarray          # at the start and at the end
    y: np.ndarray
    turn_rate: np.ndarray
    grade: np.ndarray
    bank: np.ndarray
    travel: np.ndarray
    seconds: np.ndarray
    energy: np.ndarray     # measured, J
    group: np.ndarray

    def chosen(self, which):
        """The pieces that are chosen, their groups numbered anew."""
        group = np.unique(self.group[which], return_inverse=True)[1]
        return Pieces(self.x[:, which], self.y[:, which], self.turn_rate[:, which], self.grade[which], self.bank[which],
                      self.travel[which], self.seconds[which], self.energy[which], group)

    def by_group(self, values):
        return np.bincount(self.group, values)


def ratio(a, b):
    """0 where b is."""
    return np.divide(a, b, out=np.zeros_like(a), where=b > 0)


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
