#include "sim/balancer/plant.h"

#include <math.h>

#include "sim/base/strict_math.h"

/* Powers that the ledger integrates, W. */
struct powers {
    double electrical;
    double copper;
    double friction;
    double conversion;
    double push;
};

struct derivative {
    struct plant_acceleration acceleration;
    struct powers powers;
};

static double square(double a)
{
    return a * a;
}

static struct plant_constants constants_of(const struct robot_file *robot)
{
    const double body = robot->body.mass_kg;
    const double height = robot->body.centre_height_m;
    const double width = robot->body.width_m;
    const double wheel = robot->wheel.mass_kg;
    const double radius = robot->wheel.radius_m;
    const double gear = robot->motor.gear_ratio;
    const double wheel_own = wheel * square(radius) / 2.0;
    const double rotor = square(gear) * robot->motor.rotor_inertia_kg_m2;
    const double body_pitch = body * square(height) / 3.0;
    const double body_yaw = body * (square(width) + square(robot->body.depth_m)) / 12.0;

    return (struct plant_constants){
        .wheel_radius = radius,
        .body_height = height,
        .half_track = width / (2.0 * radius),
        .wheel_inertia = (2.0 * wheel + body) * square(radius) + 2.0 * wheel_own + 2.0 * rotor,
        .pitch_inertia = body * square(height) + body_pitch + 2.0 * rotor,
        .coupling = body * height * radius,
        .rotor_coupling = 2.0 * rotor,
        .yaw_inertia = wheel * square(width) / 2.0 + body_yaw + square(width / radius) / 2.0 * (wheel_own + rotor),
        .swing_inertia = body * square(height),
        .weight_moment = body * PLANT_GRAVITY * height,
        .resistance = robot->motor.resistance_ohm,
        /* Torque and back-EMF both carry the gear, so β = n² Kt Kb/Rm + fm; the paper's n Kt Kb/Rm is that of n = 1. */
        .torque_per_ampere = gear * robot->motor.torque_constant,
        .volts_per_rate = gear * robot->motor.back_emf,
        .motor_friction = robot->motor.friction,
        .ground_friction = robot->ground.friction,
    };
}

void plant_init(struct plant *plant, const struct robot_file *robot)
{
    *plant = (struct plant){.constants = constants_of(robot)};
}

void plant_change(struct plant *plant, const struct robot_file *robot)
{
    const double before = plant_mechanical_energy(plant);
    plant->constants = constants_of(robot);
    plant->ledger.change += plant_mechanical_energy(plant) - before;
}

static double current(const struct plant_constants *c, const struct plant_input *input, double voltage, double rate)
{
    return input->driven ? (voltage - c->volts_per_rate * rate) / c->resistance : 0.0;
}

static inline struct derivative derivative(const struct plant_constants *c, const struct plant_state *s,
                                           const struct plant_input *input)
{
    const struct strict_turn turn = strict_sin_cos(s->pitch);
    const double sine = turn.sine;
    const double cosine = turn.cosine;

    const double wheel_left = s->wheel_rate - c->half_track * s->yaw_rate;
    const double wheel_right = s->wheel_rate + c->half_track * s->yaw_rate;
    const double motor_left = wheel_left - s->pitch_rate;
    const double motor_right = wheel_right - s->pitch_rate;
    const double current_left = current(c, input, input->voltage_left, motor_left);
    const double current_right = current(c, input, input->voltage_right, motor_right);

    /* Between wheel and body, then what is left for the wheel. */
    const double torque_left = c->torque_per_ampere * current_left - c->motor_friction * motor_left;
    const double torque_right = c->torque_per_ampere * current_right - c->motor_friction * motor_right;
    const double drive_left = torque_left - c->ground_friction * wheel_left;
    const double drive_right = torque_right - c->ground_friction * wheel_right;

    const double wheel_force =
        drive_left + drive_right + c->wheel_radius * input->push_n + c->coupling * square(s->pitch_rate) * sine;
    const double pitch_force = -torque_left - torque_right + c->body_height * cosine * input->push_n +
                               c->weight_moment * sine + c->swing_inertia * square(s->yaw_rate) * sine * cosine;
    const double yaw_force = c->half_track * (drive_right - drive_left) + input->yaw_torque_nm -
                             2.0 * c->swing_inertia * s->pitch_rate * s->yaw_rate * sine * cosine;

    const double coupling = c->coupling * cosine - c->rotor_coupling;
    const double determinant = c->wheel_inertia * c->pitch_inertia - square(coupling);
    const double voltage_rate = current_left * motor_left + current_right * motor_right;

    return (struct derivative){
        .acceleration = {.wheel = (c->pitch_inertia * wheel_force - coupling * pitch_force) / determinant,
                         .pitch = (c->wheel_inertia * pitch_force - coupling * wheel_force) / determinant,
                         .yaw = yaw_force / (c->yaw_inertia + c->swing_inertia * square(sine))},
        .powers = {.electrical = input->voltage_left * current_left + input->voltage_right * current_right,
                   .copper = c->resistance * (square(current_left) + square(current_right)),
                   .friction = c->motor_friction * (square(motor_left) + square(motor_right)) +
                               c->ground_friction * (square(wheel_left) + square(wheel_right)),
                   .conversion = (c->volts_per_rate - c->torque_per_ampere) * voltage_rate,
                   .push = input->push_n * (c->wheel_radius * s->wheel_rate + c->body_height * cosine * s->pitch_rate) +
                           input->yaw_torque_nm * s->yaw_rate},
    };
}

/* start + h·(rates, acceleration) */
static inline struct plant_state advance(const struct plant_state *start, const struct plant_state *rates,
                                         const struct plant_acceleration *acceleration, double h)
{
    return (struct plant_state){
        .wheel = start->wheel + h * rates->wheel_rate,
        .pitch = start->pitch + h * rates->pitch_rate,
        .yaw = start->yaw + h * rates->yaw_rate,
        .wheel_rate = start->wheel_rate + h * acceleration->wheel,
        .pitch_rate = start->pitch_rate + h * acceleration->pitch,
        .yaw_rate = start->yaw_rate + h * acceleration->yaw,
    };
}

/* The Runge–Kutta mean of four values. */
static inline double mean(double a, double b, double c, double d)
{
    return (a + 2.0 * (b + c) + d) / 6.0;
}

/* The motion of a step is an arc as good as exactly: its chord lies along the mean heading. */
static void move(struct plant *plant, const struct plant_state *before)
{
    const double distance = plant->constants.wheel_radius * (plant->state.wheel - before->wheel);
    const double turn = plant->state.yaw - before->yaw;
    const double chord = distance * (1.0 - square(turn) / 24.0);
    const struct strict_turn heading = strict_sin_cos(before->yaw + turn / 2.0);
    plant->x += chord * heading.cosine;
    plant->y += chord * heading.sine;
}

/* Stops the robot at a pitch; the energy that this takes is the impact. */
static void stop(struct plant *plant, double pitch)
{
    const double before = plant_mechanical_energy(plant);
    plant->state.pitch = pitch;
    plant->state.wheel_rate = 0.0;
    plant->state.pitch_rate = 0.0;
    plant->state.yaw_rate = 0.0;
    plant->ledger.impact += before - plant_mechanical_energy(plant);
}

static void integrate(struct plant *plant, const struct plant_input *input, double h)
{
    const struct plant_constants *c = &plant->constants;
    const struct plant_state s1 = plant->state;
    const struct derivative k1 = derivative(c, &s1, input);
    const struct plant_state s2 = advance(&s1, &s1, &k1.acceleration, h / 2.0);
    const struct derivative k2 = derivative(c, &s2, input);
    const struct plant_state s3 = advance(&s1, &s2, &k2.acceleration, h / 2.0);
    const struct derivative k3 = derivative(c, &s3, input);
    const struct plant_state s4 = advance(&s1, &s3, &k3.acceleration, h);
    const struct derivative k4 = derivative(c, &s4, input);

#define MEAN_OF(member) mean(k1.member, k2.member, k3.member, k4.member)
    const struct plant_acceleration acceleration = {MEAN_OF(acceleration.wheel), MEAN_OF(acceleration.pitch),
                                                    MEAN_OF(acceleration.yaw)};
    struct plant_ledger *ledger = &plant->ledger;
    ledger->electrical += h * MEAN_OF(powers.electrical);
    ledger->copper += h * MEAN_OF(powers.copper);
    ledger->friction += h * MEAN_OF(powers.friction);
    ledger->conversion += h * MEAN_OF(powers.conversion);
    ledger->push += h * MEAN_OF(powers.push);
#undef MEAN_OF

    const struct plant_state rates = {.wheel_rate = mean(s1.wheel_rate, s2.wheel_rate, s3.wheel_rate, s4.wheel_rate),
                                      .pitch_rate = mean(s1.pitch_rate, s2.pitch_rate, s3.pitch_rate, s4.pitch_rate),
                                      .yaw_rate = mean(s1.yaw_rate, s2.yaw_rate, s3.yaw_rate, s4.yaw_rate)};
    plant->state = advance(&s1, &rates, &acceleration, h);
    move(plant, &s1);
}

void plant_step(struct plant *plant, const struct plant_input *input, double seconds)
{
    const double motor =
        input->driven ? (square(input->voltage_left) + square(input->voltage_right)) / plant->constants.resistance
                      : 0.0;
    plant->ledger.motor += seconds * motor;
    if (plant->held || plant->fallen) {
        plant->ledger.electrical += seconds * motor;
        plant->ledger.copper += seconds * motor;
        return;
    }
    integrate(plant, input, seconds);
    if (fabs(plant->state.pitch) > PLANT_FALL_PITCH) {
        stop(plant, copysign(PLANT_FALL_PITCH, plant->state.pitch));
        plant->fallen = true;
    }
}

void plant_hold(struct plant *plant, double pitch)
{
    stop(plant, pitch);
    plant->held = true;
    plant->fallen = false;
}

void plant_release(struct plant *plant)
{
    plant->held = false;
}

struct plant_acceleration plant_acceleration(const struct plant *plant, const struct plant_input *input)
{
    if (plant->held || plant->fallen) {
        return (struct plant_acceleration){0};
    }
    return derivative(&plant->constants, &plant->state, input).acceleration;
}

double plant_motor_rate_left(const struct plant *plant)
{
    const struct plant_state *s = &plant->state;
    return s->wheel_rate - plant->constants.half_track * s->yaw_rate - s->pitch_rate;
}

double plant_motor_rate_right(const struct plant *plant)
{
    const struct plant_state *s = &plant->state;
    return s->wheel_rate + plant->constants.half_track * s->yaw_rate - s->pitch_rate;
}

double plant_current_left(const struct plant *plant, const struct plant_input *input)
{
    return current(&plant->constants, input, input->voltage_left, plant_motor_rate_left(plant));
}

double plant_current_right(const struct plant *plant, const struct plant_input *input)
{
    return current(&plant->constants, input, input->voltage_right, plant_motor_rate_right(plant));
}

double plant_mechanical_energy(const struct plant *plant)
{
    const struct plant_constants *c = &plant->constants;
    const struct plant_state *s = &plant->state;
    const struct strict_turn turn = strict_sin_cos(s->pitch);
    const double yaw_inertia = c->yaw_inertia + c->swing_inertia * square(turn.sine);
    const double kinetic = (c->wheel_inertia * square(s->wheel_rate) + c->pitch_inertia * square(s->pitch_rate) +
                            yaw_inertia * square(s->yaw_rate)) /
                               2.0 +
                           (c->coupling * turn.cosine - c->rotor_coupling) * s->wheel_rate * s->pitch_rate;
    return kinetic + c->weight_moment * turn.cosine;
}

double plant_damping_rate(const struct plant_constants *c)
{
    const double beta = c->torque_per_ampere * c->volts_per_rate / c->resistance + c->motor_friction;
    const double coupling = c->coupling - c->rotor_coupling;
    const double determinant = c->wheel_inertia * c->pitch_inertia - square(coupling);
    /* Trace of the inverse mass matrix times the damping matrix: at least its greater eigenvalue. */
    const double travel =
        (2.0 * (beta + c->ground_friction) * c->pitch_inertia + 4.0 * beta * coupling + 2.0 * beta * c->wheel_inertia) /
        determinant;
    const double yaw = 2.0 * square(c->half_track) * (beta + c->ground_friction) / c->yaw_inertia;
    return fmax(travel, yaw);
}
