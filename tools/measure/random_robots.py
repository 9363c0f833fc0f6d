"""Balancers that nobody has seen: data sheets by a rule that was set before anything was measured on them.

Masses of 0.3 to 100 kg, wheels of 3 to 25 cm, 6 to 60 V, gears of 1 to 50, all evenly by their logarithm. Motors are drawn
by what they do: the robot's speed without load, and the lean at which they just hold its weight when stalled. So some are
too weak to balance, and some too slow. Sensors are those of such a robot's size. What a controller needs beyond a rate is
left to the tools.
"""
import math

import numpy as np

MASS = (0.3, 100)              # kg
WHEEL_RADIUS = (0.03, 0.25)    # m
VOLTAGE = (6, 60)              # V
GEAR = (1, 50)
HEIGHT = (0.1, 0.5)            # m, and the next two: of a body of 10 kg; they grow with the cube root of the mass
WIDTH = (0.15, 0.5)
DEPTH = (0.05, 0.3)
WHEEL_MASS = (0.02, 0.15)      # of the body's
SPEED_WITHOUT_LOAD = (0.4, 6)  # m/s
HOLDING_LEAN = (2, 60)         # °
ROTOR_S = (0.005, 0.03)        # mechanical time constant of the motor alone
EFFICIENCY = (0.75, 1.0)       # torque constant by back-EMF
MOTOR_FRICTION = (0.01, 0.1)   # of the stalled torque, at the speed without load
ROLLING = (0.005, 0.03)        # of the weight, at 1 m/s
ELECTRONICS = (0.1, 1.0)       # W by kg, beside 0.5 W
RUNTIME = (1, 10)              # h of the electronics alone
COUNTS = (360, 20000)          # a wheel turn
SPEED_SHARE = 0.4              # of that without load, at most SPEED_MAX
SPEED_MAX = 1.5                # m/s


def draw(seed):
    """Groups of a robot file, by name."""
    generator = np.random.default_rng(seed)

    def between(low, high):
        return float(np.exp(generator.uniform(math.log(low), math.log(high))))

    mass, radius, voltage, gear = between(*MASS), between(*WHEEL_RADIUS), between(*VOLTAGE), between(*GEAR)
    size = (mass / 10)**(1 / 3)
    height, width = size * between(*HEIGHT), max(size * between(*WIDTH), 1.2 * radius)
    depth, wheel_mass = size * between(*DEPTH), mass * between(*WHEEL_MASS)
    fastest = between(*SPEED_WITHOUT_LOAD)
    stalled = mass * 9.81 * height * math.sin(math.radians(between(*HOLDING_LEAN))) / 2  # N·m of one wheel
    back_emf = voltage / (fastest / radius) / gear
    torque = back_emf * generator.uniform(*EFFICIENCY)
    resistance = gear * torque * voltage / stalled
    electronics = 0.5 + mass * between(*ELECTRONICS)
    return {
        "name": f"random{seed}",
        "body": {"mass_kg": mass, "width_m": width, "depth_m": depth, "centre_height_m": height},
        "wheel": {"radius_m": radius, "mass_kg": wheel_mass},
        "motor": {"resistance_ohm": resistance, "torque_constant_nm_per_a": torque, "back_emf_v_s_per_rad": back_emf,
                  "gear_ratio": gear, "rotor_inertia_kg_m2": between(*ROTOR_S) * torque * back_emf / resistance,
                  "friction_nm_s_per_rad": stalled / (fastest / radius) * between(*MOTOR_FRICTION)},
        "ground": {"friction_nm_s_per_rad": mass * 9.81 * radius**2 * between(*ROLLING) / 2},
        "electronics": {"power_w": electronics},
        "supply": {"voltage_v": voltage, "resistance_ohm": 0.02 * resistance,
                   "capacity_wh": electronics * between(*RUNTIME)},
        "pwm": {"bits": 12},
        "encoder": {"counts_per_turn": round(between(*COUNTS))},
        "gyro": {"noise_rms_dps": 0.1, "bias_dps": 0.5, "step_dps": 500 / 2**15, "full_scale_dps": 500.0},
        "accelerometer": {"noise_rms_g": 0.005, "step_g": 4 / 2**15, "full_scale_g": 4.0,
                          "height_m": height * generator.uniform(0, 0.5)},
        "current_sense": {"bits": 12, "full_scale_a": 1.3 * voltage / resistance,
                          "noise_rms_a": 0.002 * voltage / resistance},
        "bus_sense": {"bits": 12, "full_scale_v": 1.5 * voltage},
        "control": {"rate_hz": 1000},
        "limits": {"speed_m_s": min(SPEED_MAX, SPEED_SHARE * fastest), "turn_rate_rad_s": 0.35, "turn_deg": 80.0,
                   "duration_s": 600.0},
    }


def robot_file(data):
    """Its text."""
    def group(name, members):
        return f"{name}: {{ {' '.join(f'{key} = {value};' for key, value in members.items())} }};"

    return "\n".join([f'name = "{data["name"]}";', *(group(*item) for item in data.items() if item[0] != "name")]) + "\n"
