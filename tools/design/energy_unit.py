"""The unit of energy of a robot's tables, 2^exponent J (include/joulepath/energy.h): it follows from the robot file alone,
so that the tables of all tools have the same.

An hour at twice the power of the electronics is about the greatest energy that a table's format holds. Where what the
motion takes would not fit then, the unit is greater.
"""
import math

import numpy as np

from tools.design import linear_model

EXPONENT_MAX = 15     # JP_ENERGY_UNIT_EXPONENT_MAX
FORMAT_MAX = 32768    # units, of an energy in Q16
PARAMETER_MAX = 4096  # units, of a1…b2 and of the directions in which they are learned
HOUR = 3600

# The linear plant knows the parameters roughly, and a robot with payload and ground of its own learns greater ones.
RESERVE = 4

# In units of the resistance: with fewer digits V²/Rm would be wrong by more than 0.05 %.
RESISTANCE_MIN = 2**-6


def exponent(robot, model=None):
    """model: linear_model.linear_energy_model(robot), if the caller has it."""
    model = model or linear_model.linear_energy_model(robot)
    by_power = round(math.log2(2 * model.electronics_power * HOUR / FORMAT_MAX))
    greatest = max(np.abs([*model.a[:12], *model.b]))
    least = max(math.log2(greatest * RESERVE / PARAMETER_MAX), math.log2(RESISTANCE_MIN / model.motor_resistance))
    found = max(by_power, math.ceil(least))
    if abs(found) > EXPONENT_MAX:
        raise robot.error("electronics, motor", f"energies in units of 2^{found} J are beyond the tables")
    return found
