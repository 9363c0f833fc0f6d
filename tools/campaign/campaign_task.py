"""What a worker of a campaign does: run the program for some seeds and check what it prints.

Also sent to workers that have no copy of the project: uses only Python's own modules. A complaint is a RuntimeError of
one line.
"""
import hashlib
import json
import math
import signal
import subprocess
from pathlib import Path

OUTCOMES = ("done", "fell", "stopped")

# Keys of a mission by their kinds; a dotted one is inside an object.
FACTORS = ("variation", "learned")  # what the robot is, and what it has learned of that: each kind has its own
NUMBERS = ("seconds", "predicted_j", "std_j", "measured_j", "prior_predicted_j", "charge_used")
COUNTS = ("seed", "segments")
BOOLEANS = ("inside", "reserve.asked", "reserve.answer", "reserve.true")
NAMES = ("robot",)
NAMES_OR_NULL = ("fault", "change")


# ---- what the program prints ---------------------------------------------------------------------------------------

def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def is_count(value):
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def is_factors(value):
    return isinstance(value, dict) and value and all(map(is_number, value.values()))


KINDS = (
    (FACTORS, is_factors, "numbers with names"),
    (NUMBERS, is_number, "a number"),
    (COUNTS, is_count, "a whole number from 0"),
    (BOOLEANS, lambda value: isinstance(value, bool), "true or false"),
    (NAMES, lambda value: isinstance(value, str), "a name"),
    (NAMES_OR_NULL, lambda value: value is None or isinstance(value, str), "a name or null"),
    (("outcome",), lambda value: value in OUTCOMES, f"one of {', '.join(OUTCOMES)}"),
)


def value_of(mission, key):
    for part in key.split("."):
        if not isinstance(mission, dict) or part not in mission:
            raise RuntimeError(f"{key} is missing")
        mission = mission[part]
    return mission


def check_mission(mission):
    for keys, is_right, kind in KINDS:
        for key in keys:
            value = value_of(mission, key)
            if not is_right(value):
                raise RuntimeError(f"{key} is {value!r:.40}, not {kind}")
    if mission["outcome"] == "done" and min(mission["measured_j"], mission["std_j"]) <= 0:
        raise RuntimeError("measured_j and std_j must be above 0 where the mission is done")


def parse_missions(text, first, count):
    """The missions of the seeds from `first`, of which each has its line of JSON."""
    lines = text.splitlines()
    missions = []
    for number, line in enumerate(lines, start=1):
        try:
            missions.append(json.loads(line))
            check_mission(missions[-1])
        except ValueError:
            raise RuntimeError(f"line {number} is no JSON: {line!r:.60}") from None
        except RuntimeError as error:
            raise RuntimeError(f"line {number}: {error}") from None
    seeds = [mission["seed"] for mission in missions]
    if seeds != list(range(first, first + count)):
        raise RuntimeError(f"{len(lines)} lines that are not those of the seeds {first}…{first + count - 1} in turn")
    return missions


# ---- the program ---------------------------------------------------------------------------------------------------

def fingerprint(path):
    """SHA-256 of a file."""
    try:
        return hashlib.sha256(Path(path).read_bytes()).hexdigest()
    except OSError as error:
        raise RuntimeError(f"{path}: {error.strerror}") from None


def check_files(fingerprints):
    """Complains about files, given by their paths, that are not those that the campaign began with."""
    for path, expected in fingerprints.items():
        if fingerprint(path) != expected:
            raise RuntimeError(f"{path}: is not the file that the campaign began with")


def complaint_about_files(fingerprints):
    try:
        check_files(fingerprints)
    except RuntimeError as error:
        return str(error)
    return None


def failure_of(status, stderr):
    how = f"died of {signal.Signals(-status).name}" if status < 0 else f"ended with exit status {status}"
    last = stderr.strip().splitlines()[-1:]
    return ": ".join([how, *last])


def run_batch(command, fingerprints, first, count, limit):
    """What `command` prints for the missions of the seeds from `first`, checked. `limit`: s, for all of them."""
    check_files(fingerprints)
    command = [*command, "--seed", str(first), "--count", str(count)]
    try:
        result = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace",
                                timeout=limit, check=False)
    except subprocess.TimeoutExpired:
        raise RuntimeError(f"took longer than {limit:g} s") from None
    except OSError as error:
        raise RuntimeError(f"{command[0]}: {error.strerror}") from None
    if result.returncode != 0:
        raise RuntimeError(failure_of(result.returncode, result.stderr))
    parse_missions(result.stdout, first, count)
    return result.stdout
