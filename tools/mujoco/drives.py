"""Motors, gears, bridges and battery by the project's equations (sim/balancer/plant.h, sim/skid_steer/skid_plant.h).

A drive is told the duties and the motors' speeds at the wheels, and gives torques; what it loses goes to the ledger.
"""
import math

SIDES = (0, 1)


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


class SteeredDrive:
    """Servos of speed and of steering (sim/four_wheel/four_wheel_plant.c): each motor has a gear with an efficiency, that of
    steering a worm, which holds its angle without current. Braking gives back what the gear and the windings leave."""

    LOSSES = ("electronics", "copper", "gear", "friction")

    INTEGRAL_TIMES = 8  # as much slower acts the speed servo's integral than its proportion

    def __init__(self, robot, steered_inertia, steering_torque):
        """`steering_torque`: of its motor, N·m."""
        number = robot.number
        self.radius, self.friction = number("wheel.radius_m"), number("drive.friction_nm_s_per_rad")
        self.rolling, self.torque = number("tyre.rolling"), number("drive.torque_nm")
        spin = number("wheel.inertia_kg_m2") / self.radius ** 2
        self._time = number("drive.time_constant_s")
        self.gain = (number("body.mass_kg") / 4 + spin) * self.radius / self._time
        self.steer_time, self.steer_rate = number("steering.time_constant_s"), number("steering.rate_rad_s")
        self.limit = math.radians(number("steering.limit_deg"))
        self._steered_inertia, self._steering_torque = steered_inertia, steering_torque
        self._motor, self._steer = ([number(f"{group}.{key}") for key in ("efficiency", "torque_constant_nm_a",
                                                                          "resistance_ohm")]
                                    for group in ("drive", "steering"))
        self.bus_voltage, self.power = number("electronics.voltage_v"), number("electronics.power_w")
        self.energies = dict.fromkeys(self.LOSSES, 0.0)
        self.battery = 0.0
        self._integrals = [0.0] * 4  # of the errors of speed, m

    def step(self, targets, rates, angles, steer_rates, loads, seconds):
        """Of each wheel the torques of driving and steering, and its dry friction. `targets`: speeds of the treads in m/s and
        angles; rates of the wheels, their angles and the rates of these."""
        drives, steers = [], []
        for i, (speed, angle) in enumerate(zip(*targets)):
            drive = self._speed_servo(i, speed - self.radius * rates[i], seconds)
            steer = self._steering_servo(angle - angles[i], steer_rates[i], seconds)
            self._take(drive, rates[i], self._motor, seconds)
            # A worm is not driven from behind: what the ground turns it with is lost, and costs nothing.
            if steer * steer_rates[i] > 0:
                self._take(steer, steer_rates[i], self._steer, seconds)
            else:
                self.energies["gear"] -= seconds * steer * steer_rates[i]
            self.energies["friction"] += seconds * self.friction * rates[i] ** 2
            drives.append(drive - self.friction * rates[i])
            steers.append(steer)
        self.battery += seconds * self.power
        self.energies["electronics"] += seconds * self.power
        return drives, steers, [self.rolling * load * self.radius for load in loads]

    def _speed_servo(self, i, error, seconds):
        wanted = self.gain * (error + self._integrals[i] / (self.INTEGRAL_TIMES * self._time))
        torque = min(max(wanted, -self.torque), self.torque)
        if wanted == torque or wanted * error < 0:
            self._integrals[i] += seconds * error
        return torque

    def _steering_servo(self, error, rate, seconds):
        """As stiff as the step allows: what turns with the wheel follows the rate of the servo within a few steps."""
        wanted = min(max(error / self.steer_time, -self.steer_rate), self.steer_rate)
        torque = self._steered_inertia / (2 * seconds) * (wanted - rate)
        return min(max(torque, -self._steering_torque), self._steering_torque)

    def _take(self, torque, rate, motor, seconds):
        """Out of the battery, or back into it."""
        efficiency, constant, resistance = motor
        work = torque * rate
        shaft = work / efficiency if work > 0 else work * efficiency
        copper = (torque / constant * (efficiency ** 2 if work < 0 else 1)) ** 2 * resistance
        self.energies["gear"] += seconds * (shaft - work)
        self.energies["copper"] += seconds * copper
        self.battery += seconds * (shaft + copper)
