#!/usr/bin/env -S python3 -IS
"""A stand-in for jp-trip: fake_trip.py ROBOT.cfg --seed S --count N [--faults].

A mission depends on its seed alone. The robot file tells what else it is to do, a line each:
    fail SEED [FILE]      exit status 1 at that seed; with FILE, only while it does not exist, and makes it
    die SEED              by a signal
    hang SEED [FILE]      without end; with FILE, while it exists
    print SEED TEXT       in place of the mission's line
ROBOT.log names the seeds of each start.
"""
import json
import os
import random
import signal
import sys
import time
from pathlib import Path

FAULTS = None, "imu", "encoder"
CHANGES = None, "payload", "friction"


def mission(robot, seed, faults):
    chance = random.Random(f"{robot}/{seed}/{faults}")
    predicted = chance.uniform(50, 150)
    std = predicted * chance.uniform(0.01, 0.04)
    measured = predicted + chance.gauss(0, std)
    friction, payload = chance.uniform(0.01, 0.03), chance.uniform(0, 3)
    return {"seed": seed, "robot": robot,
            "variation": {"ground_friction": friction, "payload_kg": payload, "motor_resistance": 0.5,
                          "motor_friction": 0.01, "capacity": 0.9},
            "fault": chance.choice(FAULTS) if faults else None, "change": chance.choice(CHANGES),
            "outcome": chance.choices(("done", "fell", "stopped"), (90, 6, 4))[0], "segments": 8, "seconds": 61.5,
            "predicted_j": predicted, "std_j": std, "measured_j": measured,
            "inside": abs(measured - predicted) <= 1.96 * std, "prior_predicted_j": measured * chance.uniform(0.6, 1),
            "reserve": {"asked": seed % 2 == 0, "answer": seed % 3 != 0, "true": seed % 10 != 0},
            "learned": {"ground_friction": friction, "payload_kg": payload}, "charge_used": 0.01}


def orders_of(robot_file):
    """Words after the verb and the seed by both."""
    lines = [line.split() for line in robot_file.read_text().splitlines() if not line.startswith("#")]
    return {(words[0], words[1]): words[2:] for words in lines if words}


def fail_at(seed, flag):
    if flag and Path(flag[0]).exists():
        return
    if flag:
        Path(flag[0]).touch()
    sys.exit(f"fake_trip: no such seed: {seed}")


def hang(flag):
    while not flag or Path(flag[0]).exists():
        time.sleep(0.01)


def run_mission(robot_file, orders, seed, faults):
    key = str(seed)
    if ("fail", key) in orders:
        fail_at(seed, orders["fail", key])
    if ("die", key) in orders:
        os.kill(os.getpid(), signal.SIGSEGV)
    if ("hang", key) in orders:
        hang(orders["hang", key])
    line = json.dumps(mission(robot_file.stem, seed, faults))
    print(" ".join(orders["print", key]) if ("print", key) in orders else line, flush=True)


def main():
    robot_file, options = Path(sys.argv[1]), sys.argv[2:]
    first, count = (int(options[options.index(name) + 1]) for name in ("--seed", "--count"))
    with open(robot_file.with_suffix(".log"), "a", encoding="utf-8") as log:
        log.write(f"{first} {count}\n")
    orders = orders_of(robot_file)
    for seed in range(first, first + count):
        run_mission(robot_file, orders, seed, "--faults" in options)


if __name__ == "__main__":
    main()
