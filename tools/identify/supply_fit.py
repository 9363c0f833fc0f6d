"""What a log says about battery and electronics: V = V0 − R I with a V0 that falls evenly, and Ps = V I − Σ u i."""
from dataclasses import dataclass

import numpy as np

from tools.identify import regression

BLOCK = 1.0  # s: residuals that are as far apart are independent
VOLTAGE_STEP, CURRENT_STEP = 1 / 128, 1 / 256  # V, A, of the messages on the bus
# Share of each value: steps of what measures them, and a battery that is no plain resistance.
MODEL_ERROR = {"voltage": 0.0005, "resistance": 0.01, "electronics": 0.003}


@dataclass(frozen=True)
class SupplyFit:
    """(value, deviation) each; None: not told by the log."""
    voltage: tuple | None      # V, without load
    resistance: tuple | None   # Ω
    electronics: tuple | None  # W


def blocks_of(times):
    return np.unique(((times - times[0]) / BLOCK).astype(int), return_inverse=True)[1]


def block_means(values, blocks):
    """Within a tick currents change beside what the voltage tells; their means do not."""
    return np.bincount(blocks, values) / np.bincount(blocks)


def loads(log, electronics):
    """Times, voltage and current of the supply, by the battery's messages or else by the bridges' currents."""
    if log.has("battery_voltage", "battery_current"):
        voltage = log["battery_voltage"]
        return voltage.times, voltage.values, np.interp(voltage.times, log["battery_current"].times,
                                                        log["battery_current"].values)
    if log.has("bus_voltage", "motors_current"):
        voltage = log["bus_voltage"]
        motors = np.interp(voltage.times, log["motors_current"].times, log["motors_current"].values)
        return voltage.times, voltage.values, motors + electronics / voltage.values
    return None


def fit_battery(log, electronics):
    """Voltage and resistance. Without a load that shows, the mean voltage alone."""
    found = loads(log, electronics)
    if found is None:
        return None, None
    times, voltage, current = found
    if not regression.is_enough(blocks_of(times)):
        return None, None
    if np.ptp(current) == 0 or np.ptp(voltage) == 0:
        return (float(voltage.mean()), 0.0), None
    times, voltage, current = (block_means(values, blocks_of(times)) for values in (times, voltage, current))
    drift = (times - times.mean()) / max(np.ptp(times), 1e-9)
    matrix = np.column_stack([np.ones(len(times)), -current, drift])
    fitted = regression.fit(log.source, matrix, voltage, np.arange(len(times)), ("voltage", "resistance", "drift"))
    by_steps = VOLTAGE_STEP / 2 / np.ptp(current)
    resistance = float(fitted.values[1]), float(np.hypot(fitted.deviation(1), by_steps))
    return (float(fitted.values[0]), fitted.deviation(0)), resistance


def motor_power(log, times, electronics):
    """W at these times: by the currents, or by the counter of what was drawn, which holds the file's electronics."""
    if log.has("current_left", "current_right"):
        base = log["voltage_left"].times
        power = sum(log[f"voltage_{side}"].values_at(base) * log[f"current_{side}"].values_at(base)
                    for side in ("left", "right"))
        return np.interp(times, base, power)
    if log.has("drawn"):
        return np.gradient(log["drawn"].values_at(times), times) - electronics
    return None


def fit_electronics(log, electronics):
    if not log.has("battery_voltage", "battery_current"):
        return None
    voltage = log["battery_voltage"]
    begin, end = log.span
    inside = (voltage.times > begin) & (voltage.times < end)
    times = voltage.times[inside]
    power = motor_power(log, times, electronics)
    if power is None or not regression.is_enough(blocks_of(times)):
        return None
    left = voltage.values[inside] * log["battery_current"].values_at(times) - power
    fitted = regression.fit(log.source, np.ones((len(left), 1)), left, blocks_of(times), ("electronics",))
    by_steps = CURRENT_STEP / np.sqrt(12) * voltage.values.mean()
    return float(fitted.values[0]), float(np.hypot(fitted.deviation(0), by_steps))


def fit(log, robot):
    electronics = robot.positive("electronics.power_w")
    power = fit_electronics(log, electronics)
    return SupplyFit(*fit_battery(log, power[0] if power else electronics), power)


def joined(fits):
    """Of several logs: means by their deviations."""
    def mean(name):
        told = [getattr(fit, name) for fit in fits if getattr(fit, name) is not None]
        if not told:
            return None
        weights = np.array([1 / max(deviation, 1e-9)**2 for _, deviation in told])
        value = float(weights @ [value for value, _ in told] / weights.sum())
        return value, float(np.hypot(weights.sum()**-0.5, MODEL_ERROR[name] * value))
    return SupplyFit(*(mean(name) for name in ("voltage", "resistance", "electronics")))
