#!/usr/bin/env python3
"""Print the table of src/learn/normal_quantile.c: quantiles of the normal distribution, and the error of going straight
between them."""
from statistics import NormalDist

OCTAVES = 13     # of the tail probability, from 1/2 down to below 1 - 0.9999
STEPS = 8        # an octave
FRACTION_BITS = 14
COLUMNS = 12
CHECKS = 64      # between two entries


def tail(entry):
    """The tail probability of an entry; STEPS of them in each octave, evenly."""
    octave, step = divmod(entry + STEPS - 1, STEPS)
    return (2 * STEPS - 1 - step) / STEPS * 2.0**-(octave + 1) if entry else 0.5


def quantile(probability):
    return -NormalDist().inv_cdf(probability)


def largest_error(entries):
    worst = 0.0
    for k in range(len(entries) - 1):
        for i in range(CHECKS + 1):
            share = i / CHECKS
            straight = (entries[k] * (1 - share) + entries[k + 1] * share) * 2.0**-FRACTION_BITS
            worst = max(worst, abs(straight - quantile(tail(k) * (1 - share) + tail(k + 1) * share)))
    return worst


def table():
    return [round(quantile(tail(k)) * 2**FRACTION_BITS) for k in range(OCTAVES * STEPS + 1)]


def main():
    entries = table()
    print(f"largest error {largest_error(entries):.6f}")
    for row in range(0, len(entries), COLUMNS):
        print("    " + ", ".join(str(entry) for entry in entries[row:row + COLUMNS]) + ",")


if __name__ == "__main__":
    main()
