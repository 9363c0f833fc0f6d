"""Motors, gears, bridges and battery by the project's equations (sim/balancer/plant.h, sim/skid_steer/skid_plant.h).

A drive is told the duties and the motors' speeds at the wheels, and gives torques; what it loses goes to the ledger.
"""
import math

SIDES = (0, 1)

GRAVITY = 9.81


class BalancerDrive:
    """Linear motor and friction, a battery with a resistance; bridges give back what braking generates."""

    LOSSES = ("supply", "electronics", "copper", "conversion", "gear", "rolling")

    def __init__(self, robot):
        number = robot.number
        gear = number("motor.gear_ratio")
        self.torque_constant = gear * number("motor.torque_constant_nm_per_a")
        self.back_emf = gear * number("motor.back_emf_v_s_per_rad")
        self.resistance = number("motor.resistance_ohm")
        self.motor_friction = number("motor.friction_nm_s_per_rad")
        self.ground_friction = number("ground.friction_nm_s_per_rad")
        self.open, self.inner = number("supply.voltage_v"), number("supply.resistance_ohm")
        self.power = number("electronics.power_w")
        self.bus_voltage = self.open
        self.currents = [0.0, 0.0]
        self.energies = dict.fromkeys(self.LOSSES, 0.0)
        self.battery = self.motor = 0.0  # out of the cells; the paper's motor energy, u²/R

    def step(self, duties, driven, rates, wheel_rates, seconds):
        """The torques of the motors, and those of the ground on the wheels, at speeds against body and ground."""
        ratio, sense = self.inner / self.resistance, sum(d * w for d, w in zip(duties, rates))
        idle = self.power / self.open  # A of the electronics
        voltage = (self.open - self.inner * idle + ratio * self.back_emf * sense) / (
            1 + ratio * sum(d * d for d in duties)) if driven else self.open - self.inner * idle
        energies, bus_current, torques = self.energies, idle, []
        for side in SIDES:
            rate, u = rates[side], duties[side] * voltage
            current = (u - self.back_emf * rate) / self.resistance if driven else 0.0
            self.currents[side] = current
            bus_current += duties[side] * current if driven else 0.0
            torques.append(self.torque_constant * current - self.motor_friction * rate)
            energies["copper"] += seconds * current * current * self.resistance
            energies["conversion"] += seconds * (self.back_emf - self.torque_constant) * current * rate
            energies["gear"] += seconds * self.motor_friction * rate * rate
            energies["rolling"] += seconds * self.ground_friction * wheel_rates[side] ** 2
            self.motor += seconds * u * u / self.resistance if driven else 0.0
        self.bus_voltage = voltage
        self.battery += seconds * self.open * bus_current
        energies["supply"] += seconds * self.inner * bus_current ** 2
        energies["electronics"] += seconds * voltage * idle
        return torques, [-self.ground_friction * rate for rate in wheel_rates]


class SkidDrive:
    """A gear with an efficiency, current limits, and bridges that burn a part of what braking generates. Dry friction is
    the world's: it is told how much."""

    LOSSES = ("supply", "electronics", "bridge", "copper")

    def __init__(self, robot):
        number = robot.number
        self.constant = number("motor.gear_ratio") * number("motor.torque_constant_nm_per_a")
        self.resistance = number("motor.resistance_ohm")
        self.efficiency, self.limit = number("motor.efficiency"), number("motor.current_limit_a")
        self.recuperation, self.friction = number("motor.recuperation"), number("motor.friction_nm")
        self.rolling, self.radius = number("ground.rolling"), number("wheel.radius_m")
        self.open, self.inner = number("supply.voltage_v"), number("supply.resistance_ohm")
        self.power = number("electronics.power_w")
        self.bus_voltage = self.open
        self.currents = [0.0, 0.0]
        self.energies = dict.fromkeys(self.LOSSES, 0.0)
        self.battery = self.motor = 0.0

    def step(self, duties, driven, rates, loads, seconds):
        """The torques of the motors; dry friction of their gears, and of a side's wheels under their loads in N."""
        energies, bus, torques, gears = self.energies, self.power, [], []
        for side in SIDES:
            back_emf = self.constant * rates[side]
            wanted = (duties[side] * self.bus_voltage - back_emf) / self.resistance
            current = min(max(wanted, -self.limit), self.limit) if driven else 0.0
            self.currents[side] = current
            voltage = back_emf + current * self.resistance
            torque = self.constant * current
            share = 1 - self.efficiency if torque * rates[side] > 0 else 1 / self.efficiency - 1
            torques.append(torque)
            gears.append(abs(torque) * share + self.friction)
            power = voltage * current
            burnt = (1 - self.recuperation) * max(-back_emf * current, 0.0)
            taken = min(power + burnt, max(power, 0.0))
            bus += taken
            energies["bridge"] += seconds * (taken - power)
            energies["copper"] += seconds * current * current * self.resistance
        self.bus_voltage = (self.open + math.sqrt(max(self.open ** 2 - 4 * self.inner * bus, 0.0))) / 2
        current = bus / self.bus_voltage
        self.battery += seconds * self.open * current
        energies["supply"] += seconds * self.inner * current ** 2
        energies["electronics"] += seconds * self.power
        return torques, gears, [self.rolling * load * self.radius for load in loads]
