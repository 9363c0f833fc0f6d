"""Synthetic results of a mission: the paper's route, driven by arcs with plausible transients."""
import json
import math

import numpy as np

WAYPOINTS = [[0, 0], [10, 10], [20, 15], [25, 25], [15, 30]]
ENERGIES = {"optimal": (335.96, 252.74, 255.80, 269.56), "straight": (338.15, 252.03, 255.89, 283.82),
            "bezier": (345.5, 265.72, 290.72, 301.36), "cruise": (326.11, 250.53, 252.10, 251.07)}
TIMES = {"optimal": (28.6, 21.58, 21.54, 21.78), "straight": (28.6, 21.58, 21.54, 21.78),
         "bezier": (24.0, 18.5, 19.0, 19.82), "cruise": (27.24, 20.86, 20.92, 20.91)}
TITLES = {"optimal": "Energy-optimal", "straight": "Straight chords", "bezier": "Cubic Bézier",
          "cruise": "Cruise and transients"}
ARCS = {"optimal": 0.35, "straight": 0.0, "bezier": 0.9, "cruise": 0.1}
FORECAST = {"energy_j": 1079.78, "deviation_j": 24.69}
COLUMNS = ("t_s,x_m,y_m,ref_x_m,ref_y_m,heading_rad,speed_m_s,turn_rate_rad_s,ref_speed_m_s,ref_turn_rate_rad_s,"
           "pitch_deg,u_left_v,u_right_v,i_left_a,i_right_a,power_w,energy_j,segment")
RATE = 50


def _segment(start, target, arc, seconds):
    """Samples of an arc from start to target: x, y, heading, speed, turn rate."""
    chord = np.subtract(target, start)
    length, bearing = math.hypot(*chord), math.atan2(chord[1], chord[0])
    arc_length = length if arc == 0 else length * (arc / 2) / math.sin(arc / 2)
    share = np.arange(round(seconds * RATE)) / round(seconds * RATE)
    heading = bearing - arc / 2 + arc * share
    steps = arc_length / len(share) * np.exp(1j * heading)
    position = complex(*start) + np.concatenate([[0], np.cumsum(steps)[:-1]])
    return position, heading, arc_length / seconds, arc / seconds


def _log(name, noise):
    rows, t0, energy = [], 0.0, 0.0
    for i, (start, target) in enumerate(zip(WAYPOINTS, WAYPOINTS[1:])):
        seconds = TIMES[name][i]
        arc = ARCS[name] * (1 if i % 2 == 0 else -1)
        position, heading, speed, turn_rate = _segment(start, target, arc, seconds)
        t = np.arange(len(position)) / RATE
        lag = np.exp(-t / 1.5)
        power = 40 * np.exp(-t / 0.2) + ENERGIES[name][i] / seconds + 2 * lag
        power *= ENERGIES[name][i] / (power.sum() / RATE)
        drift = 0.15 * (1 - lag) * np.exp(-t / 8)
        rise = speed * (1 - (lag if i == 0 else 0.1 * lag))
        for k in range(len(t)):
            energy += power[k] / RATE
            rows.append((t0 + t[k], position[k].real - drift[k], position[k].imag + 0.6 * drift[k], position[k].real,
                         position[k].imag, heading[k], rise[k] + noise.normal(0, 0.003),
                         turn_rate + 0.6 * lag[k] * math.exp(-t[k]), speed, turn_rate, 3 * lag[k] * math.sin(2 * t[k]),
                         4.2 - 8 * lag[k]**3, 4.2 + 8 * lag[k]**3, 0.25 - lag[k]**3, 0.25 + lag[k]**3, power[k], energy,
                         i + 1))
        t0 += seconds
    return COLUMNS + "\n" + "\n".join(",".join(f"{value:.6g}" for value in row) for row in rows) + "\n"


def _strategy(name):
    segments = []
    for i, (energy, seconds) in enumerate(zip(ENERGIES[name], TIMES[name])):
        planned = energy * 1.003 if name == "optimal" else None
        segments.append({
            "index": i + 1, "target_m": WAYPOINTS[i + 1], "planned_energy_j": planned, "measured_energy_j": energy,
            "plant_energy_j": energy + 0.01, "battery_energy_j": energy * 0.83, "duration_s": seconds,
            "speed_m_s": 0.5, "turn_rate_rad_s": 0.011, "turn_deg": 36.3, "arc_rad": ARCS[name],
            "end_m": [WAYPOINTS[i + 1][0] - 0.02, WAYPOINTS[i + 1][1] + 0.01], "end_error_m": 0.022,
            "error_percent": 0.3 if planned else None})
    total = sum(ENERGIES[name])
    planned = sum(s["planned_energy_j"] for s in segments) if name == "optimal" else None
    return {"name": name, "title": TITLES[name], "log": f"log_{name}.csv",
            "forecast": FORECAST if name == "cruise" else None, "segments": segments,
            "total": {"planned_energy_j": planned, "measured_energy_j": total, "plant_energy_j": total + 0.04,
                      "battery_energy_j": total * 0.83,
                      "duration_s": sum(TIMES[name]), "relative_percent": 100 * total / sum(ENERGIES["optimal"])}}


def write_mission(directory):
    """summary.json and the logs, equal on each call."""
    noise = np.random.default_rng(11)
    summary = {
        "robot": "gao2018", "scenario": "gao2018_table3", "energy_model": "gao2018", "energy": "motor", "seed": 11,
        "waypoints_m": WAYPOINTS, "strategies": [_strategy(name) for name in ENERGIES],
        "simulation": {"ticks": 268340, "wall_s": 0.81, "real_time_factor": 331.3}}
    (directory / "summary.json").write_text(json.dumps(summary, indent=1))
    for name in ENERGIES:
        (directory / f"log_{name}.csv").write_text(_log(name, noise))
