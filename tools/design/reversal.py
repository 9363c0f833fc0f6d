"""Forward and back: how long a robot rests between the two, and how fast its wheels turn at most.

The closed loop overshoots each step of the speed. Steps within 0 to the limit, whenever they come, swing it by no more
than the sum of what its impulse response adds in their favour. Steps from full speed forward to full speed back, at the
worst moments, swing it by up to twice as much, so that it would fall. After a rest between the directions that is long
enough the worst moments do no more than without reversals.
"""
import math
from dataclasses import dataclass

import numpy as np

from tools.design import closed_loop

STEP_S = 0.01
# A response is over after this, or so many times the reference's shaping.
SECONDS, SHAPINGS = 20.0, 10.0
REST_STEP_S = 0.25
# What an earlier direction may still add to the worst case.
EXCESS = 1.01
# Voltages are limited and gravity is not linear.
REST_MARGIN = 1.25


@dataclass(frozen=True)
class Reversal:
    rest_s: float            # between forward and back
    wheel_rate_share: float  # highest wheel rate of the linear loop, of that at the limit of speed

    def rest_ticks(self, robot):
        return math.ceil(self.rest_s * robot.positive("control.rate_hz"))


def worst_case(impulse, rest):
    """Most that a response can reach: the input is within 0 and 1 or within −1 and 0, and 0 for `rest` steps between."""
    if rest == 0:
        return np.abs(impulse).sum()
    count = len(impulse)
    forward, back = np.zeros(count + rest + 1), np.zeros(count + rest + 1)
    for step in range(count - 1, -1, -1):
        on = max(impulse[step], 0) + forward[step + 1], max(-impulse[step], 0) + back[step + 1]
        forward[step], back[step] = max(on[0], back[step + rest]), max(on[1], forward[step + rest])
    return max(forward[0], back[0])


def design(robot, gains):
    """The rest and the wheel rate of a robot under these gains."""
    rate = robot.positive("control.rate_hz")
    stride = round(STEP_S * rate)
    seconds = max(SECONDS, SHAPINGS * robot.number("control.travel_shaping_s"))
    responses = [np.diff(response, prepend=0.0) for response in
                 closed_loop.travel_step(robot, gains, seconds, stride)]
    for_ever = [worst_case(impulse, len(impulse)) for impulse in responses]
    rest = 0
    while any(worst_case(impulse, rest) > EXCESS * most for impulse, most in zip(responses, for_ever, strict=True)):
        rest += round(REST_STEP_S / STEP_S)
    return Reversal(REST_MARGIN * rest * stride / rate, worst_case(responses[0], rest))
