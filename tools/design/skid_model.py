"""The energy model of include/joulepath/skid_energy.h in floating point, of many pieces at once."""
from dataclasses import dataclass, fields, replace

import numpy as np

from tools.design.energy_model import Parameters, Pieces as EnergyPieces, ratio

ROLLING, FRICTION, WEIGHT, ELECTRONICS = range(4)  # JP_SKID_ROLLING and so on
FACTORS = 4


@dataclass(frozen=True)
class Model(Parameters):
    """struct jp_skid_energy_model in SI units, without the unit of energy."""
    half_track: float
    weight: float
    rolling: float
    friction: float
    turning: float
    yielding: float
    scrub: float
    easing: float
    bank_easing: float
    tilting: float
    inertia: float
    turn_inertia: float
    driving: float
    braking: float
    copper_driving: float
    copper_braking: float
    electronics_power: float

    def scaled(self, factors):
        """The same of a robot that differs by factors, as jp_skid_energy_scale()."""
        square = factors[WEIGHT]**2
        return replace(self, rolling=self.rolling * factors[ROLLING], friction=self.friction * factors[FRICTION],
                       weight=self.weight * factors[WEIGHT], copper_driving=self.copper_driving * square,
                       copper_braking=self.copper_braking * square,
                       electronics_power=self.electronics_power * factors[ELECTRONICS])


NAMES = tuple(field.name for field in fields(Model))


@dataclass(frozen=True)
class Pieces(EnergyPieces):
    speed: np.ndarray      # at the start and at the end
    turn_rate: np.ndarray
    grade: np.ndarray
    bank: np.ndarray


def energies(model, pieces):
    """J of each piece."""
    v, w = pieces.speed.mean(axis=0), pieces.turn_rate.mean(axis=0)
    effort = pieces.grade + model.inertia * (pieces.speed[1] - pieces.speed[0]) / pieces.seconds
    swinging = model.turn_inertia * (pieces.turn_rate[1] - pieces.turn_rate[0]) / pieces.seconds
    across = model.half_track * w
    rolling = np.maximum(np.abs(v), np.abs(across))
    stiffness = model.friction * model.yielding
    eased = (model.easing * effort**2 + model.bank_easing * pieces.bank**2) / model.friction**2
    level = ratio(model.turning * model.friction * w, np.abs(w) + stiffness * rolling)
    turning = level * np.maximum(1 - eased, 0) + model.tilting * effort * pieces.bank + swinging
    grip = np.maximum(model.friction - np.abs(effort), model.friction / 4)
    slip = effort**2 * model.scrub * (np.abs(w) + stiffness * np.abs(v)) / (2 * grip)
    power = np.zeros_like(v)
    for side in (-1, 1):
        speed = v + side * across
        force = np.sign(speed) * model.rolling / 2 + effort / 2 + side * turning
        work = force * speed + slip
        power += np.where(work < 0, model.braking, model.driving) * model.weight * work
        power += (np.where(force * speed <= 0, model.copper_braking, model.copper_driving) * force**2 / (1 + pieces.grade**2))
    stands = (v == 0) & (w == 0)
    return (model.electronics_power + np.where(stands, 0, power)) * pieces.seconds


def slope_works(model, pieces):
    """J against the slopes of each piece, without their signs."""
    v, w = pieces.speed.mean(axis=0), pieces.turn_rate.mean(axis=0)
    way = np.maximum(np.abs(v), np.abs(model.half_track * w)) * pieces.seconds
    return model.weight * (np.abs(pieces.grade) + np.abs(pieces.bank)) * way
