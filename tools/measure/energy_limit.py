"""The least energy that a balancing robot can spend on a mission: what no planner and no controller goes below.

Direct collocation of the non-linear plant over its two motor voltages, solved by IPOPT from several starts. The robot
begins upright and at rest in the first waypoint, looks along x, and passes the waypoints in their order, at times,
headings and speeds of its choice; it ends in settled motion at a given speed, after a given time or one of its choice. The plant's equations follow from its
energies (Lagrange), so they are not those of the simulator written again.
"""
import math
from dataclasses import dataclass

import casadi as ca
import numpy as np
from scipy import linalg

GRAVITY = 9.81  # m/s²
MOTOR, BATTERY = "motor", "battery"

X, Y, YAW, SPEED, PITCH, PITCH_RATE, YAW_RATE = range(7)
STATES = 7

# Radau points: the last of each element is its end, and the method is of order 5.
POINTS = 3

FINEST, COARSEST, GROWTH = 0.05, 0.6, 1.15  # s, s, from element to element away from a waypoint
YAW_RATE_MAX = 4.0                          # rad/s, far beyond what pays
LEG_MAX = 1e4                               # s
ITERATIONS = 1000
CHECK_STEP = 1e-3                           # s, Runge-Kutta


class Plant:
    """State [x y φ v ψ ψ̇ φ̇], v = R θ̇; inputs the mean voltage and half the difference, right less left."""

    def __init__(self, robot, energy=MOTOR):
        self.electronics = robot.positive("electronics.power_w")
        self.voltage_max = robot.positive("supply.voltage_v")
        self.speed_max = robot.positive("limits.speed_m_s")
        self.pitch_max = math.radians(robot.positive("control.tilt_limit_deg"))
        self.radius, self.half_width = robot.positive("wheel.radius_m"), robot.positive("body.width_m") / 2
        self._resistance = robot.positive("motor.resistance_ohm")
        self._friction = robot.number("motor.friction_nm_s_per_rad"), robot.number("ground.friction_nm_s_per_rad")
        ratio = robot.positive("motor.gear_ratio")
        self._torque, self._back_emf = (ratio * robot.positive(f"motor.{name}")
                                        for name in ("torque_constant_nm_per_a", "back_emf_v_s_per_rad"))
        self._rotor = ratio**2 * robot.positive("motor.rotor_inertia_kg_m2")
        self._robot, self._energy = robot, energy
        self.step = self._function()

    def _energies(self, yaw_rate, wheel_rate, pitch, pitch_rate):
        """Kinetic and potential, as Yamamoto (2008) has them: the body's centre, its rotations, wheels, rotors."""
        mass, width, depth, height = (self._robot.positive(f"body.{name}")
                                      for name in ("mass_kg", "width_m", "depth_m", "centre_height_m"))
        wheel_mass = self._robot.positive("wheel.mass_kg")
        wheel_inertia = wheel_mass * self.radius**2 / 2
        along = self.radius * wheel_rate + height * pitch_rate * ca.cos(pitch)
        upward = -height * pitch_rate * ca.sin(pitch)
        outward = height * yaw_rate * ca.sin(pitch)
        moving = mass * (along**2 + upward**2 + outward**2)
        turning = mass * height**2 / 3 * pitch_rate**2 + mass * (width**2 + depth**2) / 12 * yaw_rate**2
        for side in (-1, 1):
            rate = wheel_rate + side * self.half_width / self.radius * yaw_rate
            moving += wheel_mass * (self.radius * rate)**2
            turning += wheel_inertia * rate**2 + self._rotor * (rate - pitch_rate)**2
        return (moving + turning) / 2, mass * GRAVITY * height * ca.cos(pitch)

    def _function(self):
        """(state, voltages) → its rate, the power that counts, the power at the motors' terminals, that lost, and the
        energy held."""
        state, volts = ca.SX.sym("state", STATES), ca.SX.sym("volts", 2)
        yaw, speed, pitch, pitch_rate, yaw_rate = (state[i] for i in (YAW, SPEED, PITCH, PITCH_RATE, YAW_RATE))
        rates = ca.vertcat(speed / self.radius, pitch_rate, yaw_rate)
        free = ca.SX.sym("rates", 3)
        kinetic, potential = self._energies(free[2], free[0], pitch, free[1])

        motor_friction, ground_friction = self._friction
        forces, counted, terminal, lost = ca.SX.zeros(3), self.electronics, 0, 0
        for side in (-1, 1):
            voltage = volts[0] + side * volts[1]
            wheel = rates[0] + side * self.half_width / self.radius * yaw_rate
            shaft = wheel - pitch_rate
            current = (voltage - self._back_emf * shaft) / self._resistance
            torque = self._torque * current - motor_friction * shaft
            push = torque - ground_friction * wheel
            forces += ca.vertcat(push, -torque, side * self.half_width / self.radius * push)
            terminal += voltage * current
            counted += voltage * current if self._energy == BATTERY else voltage**2 / self._resistance
            lost += (self._resistance * current**2 + motor_friction * shaft**2 + ground_friction * wheel**2
                     + (self._back_emf - self._torque) * current * shaft)

        momenta = ca.gradient(kinetic, free)
        mass = ca.jacobian(momenta, free)
        place = ca.gradient(kinetic - potential, pitch)
        drift = ca.jacobian(momenta, pitch) * pitch_rate - ca.vertcat(0, place, 0)
        mass, drift, held = (ca.substitute(part, free, rates) for part in (mass, drift, kinetic + potential))
        bends = ca.solve(mass, forces - drift)
        rate = ca.vertcat(speed * ca.cos(yaw), speed * ca.sin(yaw), yaw_rate, self.radius * bends[0], pitch_rate,
                          bends[1], bends[2])
        return ca.Function("plant", [state, volts], [rate, counted, terminal, lost, held])

    def steady_volts(self, speed, yaw_rate=0.0):
        """On level ground."""
        motor_friction, ground_friction = self._friction
        per_rate = (self._back_emf * self._torque / self._resistance + motor_friction + ground_friction) / (
            self._torque / self._resistance) / self.radius
        return np.array([per_rate * speed, per_rate * self.half_width * yaw_rate])

    def cruise(self):
        """The speed of least energy a metre on a straight way."""
        def power(speed):
            state = np.zeros(STATES)
            state[SPEED] = speed
            return float(self.step(state, self.steady_volts(speed))[1]) - self.electronics
        return min(math.sqrt(self.electronics / power(1.0)), self.speed_max)


# ---- Mesh ----------------------------------------------------------------------------------------------------------

def shares_of(seconds, finest):
    """Elements of a leg, fine at both ends, as shares of its duration."""
    sizes, left, size = [], seconds / 2, finest
    while left > 0:
        sizes.append(size)
        left -= size
        size = min(size * GROWTH, COARSEST)
    half = np.array(sizes) / sum(sizes) / 2
    return np.concatenate([half, half[::-1]])


# ---- Problem -------------------------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Task:
    """From rest in the first point, looking along x, through the others."""
    plant: Plant
    points: np.ndarray  # m, a row each

    @property
    def chords(self):
        return np.hypot(*np.diff(self.points, axis=0).T)


@dataclass(frozen=True)
class Solution:
    """Of a task: the states at all points of the mesh, the voltages at all but the first."""
    task: Task
    energy: float  # J
    durations: np.ndarray
    shares: list
    states: np.ndarray
    volts: np.ndarray
    end_volts: np.ndarray

    def times(self):
        sizes = np.concatenate([leg * duration for leg, duration in zip(self.shares, self.durations)])
        starts = np.concatenate([[0.0], np.cumsum(sizes)])[:-1]
        return np.concatenate([[0.0], (starts[:, None] + sizes[:, None] * collocation()[0]).ravel()])

    def at_waypoints(self):
        ends = POINTS * np.cumsum([0] + [len(leg) for leg in self.shares])
        return self.states[:, ends]


def collocation():
    """Places in an element; the derivatives there of the polynomial through its start and them; the weights."""
    places = np.array(ca.collocation_points(POINTS, "radau"))
    nodes = np.concatenate([[0.0], places])
    slopes, weights = np.zeros((POINTS + 1, POINTS)), np.zeros(POINTS)
    for j in range(POINTS + 1):
        basis = np.poly1d(np.delete(nodes, j), r=True) / np.prod(nodes[j] - np.delete(nodes, j))
        slopes[j] = basis.deriv()(places)
    for k in range(POINTS):
        basis = np.poly1d(np.delete(places, k), r=True) / np.prod(places[k] - np.delete(places, k))
        weights[k] = basis.integ()(1.0)
    return places, slopes, weights


class Problem:
    """A task on a mesh; one that is timed takes a given time."""

    def __init__(self, task, shares, timed=False):
        self.task, self.shares, self._timed = task, shares, timed
        self._count = sum(len(leg) for leg in shares)
        self._build()

    def _element(self):
        _, slopes, weights = collocation()
        start, states = ca.MX.sym("start", STATES), ca.MX.sym("states", STATES, POINTS)
        volts, size = ca.MX.sym("volts", 2, POINTS), ca.MX.sym("size")
        rates, energy = [], 0
        for k in range(POINTS):
            rate, power = self.task.plant.step(states[:, k], volts[:, k])[:2]
            rates.append(size * rate)
            energy += size * weights[k] * power
        return ca.Function("element", [start, states, volts, size],
                           [ca.vec(ca.horzcat(start, states) @ slopes - ca.horzcat(*rates)), energy])

    def _build(self):
        count, plant = self._count, self.task.plant
        states = ca.MX.sym("states", STATES, POINTS * count + 1)
        volts, durations = ca.MX.sym("volts", 2, POINTS * count), ca.MX.sym("durations", len(self.shares))
        end_volts = ca.MX.sym("end", 2)
        sizes = durations.T @ linalg.block_diag(*(leg[None, :] for leg in self.shares))
        starts = states[:, 0:POINTS * count:POINTS]
        defects, energies = self._element().map(count)(starts, states[:, 1:], volts, sizes)
        settled = plant.step(states[:, -1], end_volts)[0][[SPEED, PITCH_RATE, YAW_RATE]]
        sides = ca.horzcat(volts[0, :] - volts[1, :], volts[0, :] + volts[1, :])
        still = STATES * POINTS * count + 3
        limit, time = np.full(2 * POINTS * count, plant.voltage_max), np.zeros(int(self._timed))
        self._bounds = {"lbg": np.concatenate([np.zeros(still), -limit, time]),
                        "ubg": np.concatenate([np.zeros(still), limit, time]), **self._variable_bounds()}
        self._solver = ca.nlpsol("limit", "ipopt", {
            "x": ca.vertcat(ca.vec(states), ca.vec(volts), durations, end_volts), "f": ca.sum2(energies),
            "g": ca.vertcat(ca.vec(defects), settled, ca.vec(sides), *([ca.sum1(durations)] if self._timed else []))}, {
                "print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-8,
                "ipopt.constr_viol_tol": 1e-9, "ipopt.max_iter": ITERATIONS, "ipopt.mu_strategy": "adaptive"})

    def _variable_bounds(self):
        task, count = self.task, self._count
        low, high = np.full((2, STATES, POINTS * count + 1), np.inf)
        for place, bound in ((SPEED, task.plant.speed_max), (PITCH, task.plant.pitch_max), (YAW_RATE, YAW_RATE_MAX)):
            high[place] = bound
        low = -high
        low[:, 0] = high[:, 0] = [*task.points[0], 0, 0, 0, 0, 0]
        ends = POINTS * np.cumsum([len(leg) for leg in self.shares])
        low[:2, ends] = high[:2, ends] = task.points[1:].T
        low[PITCH_RATE, -1] = high[PITCH_RATE, -1] = 0
        volts = np.full(2 * POINTS * count, 2 * task.plant.voltage_max)
        ends = np.full(2, task.plant.voltage_max)
        shortest = task.chords / task.plant.speed_max
        return {"lbx": np.concatenate([low.ravel(order="F"), -volts, shortest, -ends]),
                "ubx": np.concatenate([high.ravel(order="F"), volts, np.full(len(shortest), LEG_MAX), ends])}

    def solve(self, guess, end_speed, seconds=None):
        """From a guess of times, states and voltages there, durations of the legs and voltages at the end, to an end in
        settled motion; None where IPOPT does not converge."""
        times, states, volts, durations, end_volts = guess
        place = STATES * POINTS * self._count + SPEED
        self._bounds["lbx"][place] = self._bounds["ubx"][place] = end_speed
        if self._timed:
            self._bounds["lbg"][-1] = self._bounds["ubg"][-1] = seconds
        mesh = Solution(self.task, 0.0, durations, self.shares, None, None, None).times()
        first = [[np.interp(mesh, times, row) for row in states],
                 [np.interp(mesh[1:], times, row) for row in volts]]
        found = self._solver(x0=np.concatenate([*(np.array(part).ravel(order="F") for part in first), durations,
                                                end_volts]), **self._bounds)
        if not self._solver.stats()["success"]:
            return None
        return self._unpacked(np.array(found["x"]).ravel(), float(found["f"]))

    def _unpacked(self, numbers, energy):
        parts = np.cumsum([STATES * (POINTS * self._count + 1), 2 * POINTS * self._count, len(self.shares)])
        states, volts, durations, end_volts = np.split(numbers, parts)
        return Solution(self.task, energy, durations, self.shares, states.reshape(STATES, -1, order="F"),
                        volts.reshape(2, -1, order="F"), end_volts)


def guess_of(solution):
    """For another mesh or another end."""
    volts = np.column_stack([solution.volts[:, 0], solution.volts])
    return solution.times(), solution.states, volts, solution.durations, solution.end_volts


# ---- Starts --------------------------------------------------------------------------------------------------------

def curve(task, speed, bend, tilts):
    """Hermite curves through the points; a tangent lies along its neighbours' chord, turned by its tilt."""
    points, chords = task.points, task.chords
    across = np.vstack([[1.0, 0.0], points[2:] - points[:-2], points[-1] - points[-2]])
    angles = np.unwrap(np.arctan2(across[:, 1], across[:, 0]) + tilts)
    tangents = np.column_stack([np.cos(angles), np.sin(angles)])
    durations = 1.02 * chords / speed
    share = np.linspace(0, 1, 200, endpoint=False)
    rows, times = [], []
    for k, (chord, duration) in enumerate(zip(chords, durations)):
        s = share[:, None]
        rows.append((2 * s**3 - 3 * s**2 + 1) * points[k] + (3 * s**2 - 2 * s**3) * points[k + 1] + bend * chord * (
            (s**3 - 2 * s**2 + s) * tangents[k] + (s**3 - s**2) * tangents[k + 1]))
        times.append(durations[:k].sum() + share * duration)
    return np.append(np.concatenate(times), durations.sum()), np.vstack([*rows, points[-1:]]), durations


def guess_along(task, speed, bend, tilts):
    times, places, durations = curve(task, speed, bend, tilts)
    slopes = np.gradient(places, times, axis=0)
    yaw = np.unwrap(np.arctan2(slopes[:, 1], slopes[:, 0]))
    yaw -= math.tau * np.round(yaw[0] / math.tau)
    states = np.zeros((STATES, len(times)))
    states[:2], states[YAW] = places.T, yaw
    states[SPEED] = np.clip(np.hypot(*slopes.T), 0, task.plant.speed_max) * np.clip(times, 0, 1)
    states[YAW_RATE] = np.clip(np.gradient(yaw, times), -1, 1)
    volts = task.plant.steady_volts(states[SPEED], states[YAW_RATE])
    return times, states, volts, durations, volts[:, -1]


def starts(task, count, seed):
    """Smooth, nearly straight, and random ones."""
    cruise, generator, still = task.plant.cruise(), np.random.default_rng(seed), np.zeros(len(task.points))
    yield guess_along(task, cruise, 1.0, still)
    if count > 1:
        yield guess_along(task, cruise, 0.3, still)
    for _ in range(count - 2):
        yield guess_along(task, cruise * generator.uniform(0.8, 1.2), generator.uniform(0.2, 1.2),
                          generator.normal(0, 0.5, len(still)))


def problems(task, timed=False):
    """On a mesh, and on one twice as fine."""
    coarse = Problem(task, [shares_of(leg, FINEST) for leg in task.chords / task.plant.cruise()], timed)
    return coarse, Problem(task, [np.repeat(leg / 2, 2) for leg in coarse.shares], timed)


def best_start(coarse, end, count, seed):
    """A guess: what is best of `count` starts. None where none of them converges."""
    found = [solution for guess in starts(coarse.task, count, seed)
             if (solution := coarse.solve(guess, *end)) is not None]
    return guess_of(min(found, key=lambda solution: solution.energy)) if found else None


def least(task, end_speeds, count=4, seed=1):
    """A solution for each speed at the end: the best of `count` starts, on a mesh twice as fine. None where none of them
    converges."""
    coarse, fine = problems(task)
    best = best_start(coarse, (end_speeds[0],), count, seed)
    return [fine.solve(best, speed) if best is not None else None for speed in end_speeds]


def least_in(task, ends, count=4, seed=1):
    """The same for each speed at the end and time in all, s: the first from the best of `count` starts, each other from
    the one before it."""
    coarse, fine = problems(task, timed=True)
    guess, found = best_start(coarse, ends[0], count, seed), []
    for speed, seconds in ends:
        found.append(fine.solve(guess, speed, seconds) if guess is not None else None)
        guess = guess_of(found[-1]) if found[-1] is not None else guess
    return found


# ---- Check ---------------------------------------------------------------------------------------------------------

def feedback(plant):
    """LQR about the straight cruise: the body falls without one."""
    state, volts = ca.SX.sym("state", STATES), ca.SX.sym("volts", 2)
    rate = plant.step(state, volts)[0]
    linear = ca.Function("linear", [state, volts], [ca.jacobian(rate, state), ca.jacobian(rate, volts)])
    cruise = np.zeros(STATES)
    cruise[SPEED] = plant.cruise()
    a, b = (np.array(part) for part in linear(cruise, [0, 0]))
    return b.T @ linalg.solve_continuous_are(a, b, np.diag([100.0, 400, 100, 50, 100, 10, 10]), np.eye(2))


@dataclass(frozen=True)
class Check:
    """A drive of the plant under given voltages and a feedback on given states."""
    energy: float         # J
    misses: list          # m, from each waypoint
    balance: float        # J: energy in less energy lost less energy held
    end_state: np.ndarray


def follow(plant, points, steps, wanted, volts, ends):
    """Runge-Kutta of the fourth order from rest: states and voltages in the middle of each step; the numbers of steps
    after which the robot should be in the next of the points."""
    gain = feedback(plant)
    state, volt, counts = ca.SX.sym("state", STATES), ca.SX.sym("volt", 2), ca.SX.sym("counts", STATES + 3)
    step = ca.SX.sym("step")

    def rate(extended):
        error = extended[:STATES] - state
        turned = ca.vertcat(ca.cos(state[YAW]) * error[X] + ca.sin(state[YAW]) * error[Y],
                            ca.cos(state[YAW]) * error[Y] - ca.sin(state[YAW]) * error[X], error[2:])
        moved, counted, terminal, lost, _ = plant.step(extended[:STATES], volt - gain @ turned)
        return ca.vertcat(moved, counted, terminal, lost)

    k1 = rate(counts)
    k2 = rate(counts + step / 2 * k1)
    k3 = rate(counts + step / 2 * k2)
    k4 = rate(counts + step * k3)
    advance = ca.Function("advance", [counts, volt, state, step], [counts + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)])

    extended, misses, begun = np.zeros(STATES + 3), [], 0
    extended[:2] = points[0]
    held = float(plant.step(extended[:STATES], [0, 0])[4])
    for point, end in zip(points[1:], ends):
        part = slice(begun, end)
        extended = np.array(advance.mapaccum(end - begun)(extended, volts[:, part], wanted[:, part], steps[part]))[:, -1]
        misses.append(float(np.hypot(*(extended[:2] - point))))
        begun = end
    energy, terminal, lost = extended[STATES:]
    balance = terminal - lost - float(plant.step(extended[:STATES], [0, 0])[4]) + held
    return Check(energy, misses, balance, extended[:STATES])


def integrate(solution):
    """Voltages and states between the points of the mesh are the element's polynomials."""
    places = collocation()[0]
    sizes = np.concatenate([leg * duration for leg, duration in zip(solution.shares, solution.durations)])
    passed = np.cumsum([len(leg) for leg in solution.shares])
    steps, states, volts, ends = [], [], [], []
    for e, size in enumerate(sizes):
        count = math.ceil(size / CHECK_STEP)
        at = (np.arange(count) + 0.5) / count
        steps.append(np.full(count, size / count))
        states.append(polynomial(np.append(0.0, places), solution.states[:, POINTS * e:POINTS * (e + 1) + 1], at))
        volts.append(polynomial(places, solution.volts[:, POINTS * e:POINTS * (e + 1)], at))
        if e + 1 in passed:
            ends.append(sum(map(len, steps)))
    task = solution.task
    return follow(task.plant, task.points, np.concatenate(steps), np.hstack(states), np.hstack(volts), ends)


def polynomial(nodes, rows, at):
    """Through `rows` at `nodes`, at other places."""
    basis = [np.prod([(at - other) / (node - other) for other in nodes if other != node], axis=0) for node in nodes]
    return rows @ np.array(basis)
