#!/usr/bin/env python3
"""Print the polynomial coefficients of src/base/fixed.c and src/base/power_of_half.c.

Minimax fits by the Remez exchange, in exact rational arithmetic; the standard
library is enough. Usage: python3 -m tools.design.fixed_polynomials
"""
import math
from dataclasses import dataclass
from fractions import Fraction

GRID = 8000


def solve(matrix, right):
    """Solve a linear system of fractions by Gauss-Jordan elimination."""
    rows = [row + [value] for row, value in zip(matrix, right)]
    n = len(rows)
    for i in range(n):
        pivot = max(range(i, n), key=lambda r: abs(rows[r][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        rows[i] = [value / rows[i][i] for value in rows[i]]
        for r in range(n):
            if r != i:
                factor = rows[r][i]
                rows[r] = [a - factor * b for a, b in zip(rows[r], rows[i])]
    return [row[n] for row in rows]


def alternation(error, count):
    """Abscissae in [0, 1] of the `count` largest adjacent extrema of alternating sign."""
    points = []
    for i in range(1, GRID + 1):
        x = i / GRID
        e = error(x)
        if points and (points[-1][1] > 0) == (e > 0):
            if abs(e) > abs(points[-1][1]):
                points[-1] = (x, e)
        else:
            points.append((x, e))
    while len(points) > count:
        points.pop(0 if abs(points[0][1]) < abs(points[-1][1]) else -1)
    return [x for x, _ in points]


def remez(target, basis, count):
    """Coefficients of basis(x, 0 … count-1) nearest to target(x) on [0, 1], and the largest error."""
    def error(x):
        return sum(float(c) * basis(x, k) for k, c in enumerate(coefficients)) - target(x)

    points = [(1 - math.cos(math.pi * (i + 0.5) / (count + 1))) / 2 for i in range(count + 1)]
    for _ in range(12):
        rows = [[Fraction(basis(x, k)) for k in range(count)] + [Fraction((-1) ** i)]
                for i, x in enumerate(points)]
        coefficients = solve(rows, [Fraction(target(x)) for x in points])[:count]
        points = alternation(error, count + 1)
    return coefficients, max(abs(error(i / GRID)) for i in range(GRID + 1))


@dataclass(frozen=True)
class Polynomial:
    title: str
    coefficients: list
    fraction_bits: list
    worst: float  # error, in unit
    unit: str

    def raw(self):
        """The coefficients as the core has them."""
        return [round(c * 2**bits) for c, bits in zip(self.coefficients, self.fraction_bits)]

    def show(self):
        print(f"{self.title}: largest error {self.worst:.3f} {self.unit}")
        for raw, bits, c in zip(self.raw(), self.fraction_bits, self.coefficients):
            print(f"  {raw:12d}  Q{bits}  {float(c):+.12f}")


def polynomials():
    # sin(πx/2) = x + x(1 − x²)R(x²): the form makes the quarter turns exact.
    r, worst = remez(lambda x: math.sin(math.pi * x / 2) - x,
                     lambda x, k: x * (1 - x * x) * x ** (2 * k), 5)
    yield Polynomial("sine, R", r, list(range(32, 37)), worst * 2**31, "ulp of Q31")

    # atan(x) = x·P(x²), in turns.
    p, worst = remez(lambda x: math.atan(x) / (2 * math.pi), lambda x, k: x ** (2 * k + 1), 10)
    yield Polynomial("arctangent, P", p, [34] * 10, worst * 2**32, "units of 2^-32 turn")

    # 2^-x = 1 − x·P(x).
    p, worst = remez(lambda x: 1 - 2**-x, lambda x, k: x ** (k + 1), 6)
    yield Polynomial("power of 1/2, P", p, [32] * 6, worst * 2**30, "units of 2^-30")


def main():
    for polynomial in polynomials():
        polynomial.show()


if __name__ == "__main__":
    main()
