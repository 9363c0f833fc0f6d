#include "sim/four_wheel/four_wheel_plant.h"

#include <string.h>

#include "sim/base/strict_math.h"

/* Below this speed of a tread the rolling resistance fades, m/s. */
#define ROLLING_FADE 0.01

/* The servo's integral acts this many times slower than its proportion. */
#define INTEGRAL_TIMES 8

#define STEPS_PER_TICK ((int)(1 / (FOUR_WHEEL_STEP * FOUR_WHEEL_RATE_HZ) + 0.5))

#define TURN_2_32 4294967296.0

/* All that is integrated; or its derivative. Doubles only. */
struct motion {
    struct four_wheel_state state;
    struct four_wheel_ledger energy;
};

#define MOTION_SIZE (sizeof(struct motion) / sizeof(double))

/* What a step holds constant for a wheel. */
struct wheel_input {
    double angle; /* target, rad */
    double speed; /* target, m/s */
    double stiffness;
    double grip;              /* largest force, N */
    struct planar_point pull; /* acceleration in the map's axes, m/s² */
};

/* Of one contact, in the body's axes, N and m. */
struct contact {
    struct planar_point place;
    struct planar_point force; /* of the ground on the body, slopes included */
};

static double square(double a)
{
    return a * a;
}

static double clamp(double a, double limit)
{
    return fmin(fmax(a, -limit), limit);
}

static struct planar_point place_of(const struct four_wheel_file *robot, int wheel)
{
    const bool front = wheel == JP_FRONT_LEFT || wheel == JP_FRONT_RIGHT;
    const bool left = wheel == JP_FRONT_LEFT || wheel == JP_REAR_LEFT;

    return (struct planar_point){(front ? 0.5 : -0.5) * robot->body.wheelbase_m,
                                 (left ? 0.5 : -0.5) * robot->body.track_m};
}

static double load(const struct four_wheel_file *robot)
{
    return robot->body.mass_kg * FOUR_WHEEL_GRAVITY / JP_WHEELS;
}

/* Of the speed servo, N·m for each m/s of error. */
static double servo_gain(const struct four_wheel_file *robot)
{
    const double spin = robot->wheel.inertia_kg_m2 / square(robot->wheel.radius_m);

    return (robot->body.mass_kg / JP_WHEELS + spin) * robot->wheel.radius_m / robot->drive.time_constant_s;
}

/* Torque of a wheel's motor; the integral stops while the torque is at its limit. */
static double drive_torque(const struct four_wheel_file *robot, const struct four_wheel_contact *wheel, double target,
                           double *integral_rate)
{
    const double gain = servo_gain(robot);
    const double error = target - robot->wheel.radius_m * wheel->rate;
    const double integral_gain = gain / (INTEGRAL_TIMES * robot->drive.time_constant_s);
    const double wanted = gain * error + integral_gain * wheel->integral;
    const double torque = clamp(wanted, robot->drive.torque_nm);

    *integral_rate = wanted == torque || wanted * error < 0 ? error : 0;
    return torque;
}

/* Of the contact that turns while it rolls, N·m. */
static double scrub_torque(const struct four_wheel_file *robot, double turning, double rolling)
{
    const double scrubbing = robot->steering.contact_m * fabs(turning);

    return scrubbing > 0 ? robot->steering.friction_nm * scrubbing / strict_hypot(scrubbing, rolling) : 0;
}

/* What a motor whose gear gives `torque` at `speed` takes, by parts; what braking leaves comes back. */
static void add_motor(double torque, double speed, double efficiency, double constant, double resistance,
                      struct four_wheel_ledger *rate)
{
    const double work = torque * speed;
    const double shaft = work > 0 ? work / efficiency : work * efficiency;
    const double current = torque / constant * (work < 0 ? square(efficiency) : 1);
    const double copper = square(current) * resistance;

    rate->copper += copper;
    rate->gear += shaft - work;
    rate->battery += shaft + copper;
}

/* Rates and powers of one wheel; its contact's force comes back for the body. `ahead`: the heading as a vector. */
static struct contact wheel_derivative(const struct four_wheel_file *robot, const struct four_wheel_state *state,
                                       struct planar_point ahead, int index, const struct wheel_input *input,
                                       struct motion *rate)
{
    const struct four_wheel_contact *wheel = &state->wheels[index];
    struct four_wheel_contact *change = &rate->state.wheels[index];
    const struct planar_point place = place_of(robot, index);
    const double radius = robot->wheel.radius_m;
    const struct strict_turn turn = strict_sin_cos(wheel->angle);
    const double cosine = turn.cosine;
    const double sine = turn.sine;

    const double x_rate = state->forward - state->turn_rate * place.y;
    const double y_rate = state->left + state->turn_rate * place.x;
    const double slip_along = cosine * x_rate + sine * y_rate - radius * wheel->rate;
    const double slip_across = cosine * y_rate - sine * x_rate;
    const double slip = sqrt(square(slip_along) + square(slip_across));
    const double stiffness = slip * input->stiffness > input->grip ? input->grip / slip : input->stiffness;
    const double along = -stiffness * slip_along;
    const double across = -stiffness * slip_across;

    const double torque = drive_torque(robot, wheel, input->speed, &change->integral);
    const double rolling =
        robot->tyre.rolling * load(robot) * radius * strict_tanh(radius * wheel->rate / ROLLING_FADE);
    const double friction = robot->drive.friction_nm_s_per_rad * wheel->rate;
    change->angle = clamp((input->angle - wheel->angle) / robot->steering.time_constant_s, robot->steering.rate_rad_s);
    change->roll = wheel->rate;
    change->rate = (torque - radius * along - rolling - friction) / robot->wheel.inertia_kg_m2;

    const double share = robot->body.mass_kg / JP_WHEELS;
    const double pull_x = share * (ahead.x * input->pull.x + ahead.y * input->pull.y);
    const double pull_y = share * (ahead.x * input->pull.y - ahead.y * input->pull.x);

    const double scrub = scrub_torque(robot, change->angle, radius * wheel->rate);

    add_motor(torque, wheel->rate, robot->drive.efficiency, robot->drive.torque_constant_nm_a,
              robot->drive.resistance_ohm, &rate->energy);
    add_motor(scrub, fabs(change->angle), robot->steering.efficiency, robot->steering.torque_constant_nm_a,
              robot->steering.resistance_ohm, &rate->energy);
    rate->energy.drive += torque * wheel->rate;
    rate->energy.pull += pull_x * x_rate + pull_y * y_rate;
    rate->energy.slip += stiffness * square(slip);
    rate->energy.rolling += rolling * wheel->rate;
    rate->energy.friction += friction * wheel->rate;
    rate->energy.steering += scrub * fabs(change->angle);
    return (struct contact){place, {cosine * along - sine * across + pull_x, sine * along + cosine * across + pull_y}};
}

static struct motion derivative(const struct four_wheel_file *robot, const struct four_wheel_state *state,
                                const struct wheel_input inputs[JP_WHEELS])
{
    const struct strict_turn turn = strict_sin_cos(state->pose.heading);
    const struct planar_point ahead = {turn.cosine, turn.sine};
    struct motion rate = {0};
    struct planar_point force = {0, 0};
    double moment = 0;

    for (int i = 0; i < JP_WHEELS; i++) {
        const struct contact contact = wheel_derivative(robot, state, ahead, i, &inputs[i], &rate);
        force.x += contact.force.x;
        force.y += contact.force.y;
        moment += contact.place.x * contact.force.y - contact.place.y * contact.force.x;
    }
    rate.energy.battery += robot->electronics.power_w;
    rate.energy.electronics = robot->electronics.power_w;
    rate.state.pose.x = ahead.x * state->forward - ahead.y * state->left;
    rate.state.pose.y = ahead.y * state->forward + ahead.x * state->left;
    rate.state.pose.heading = state->turn_rate;
    rate.state.forward = force.x / robot->body.mass_kg + state->turn_rate * state->left;
    rate.state.left = force.y / robot->body.mass_kg - state->turn_rate * state->forward;
    rate.state.turn_rate = moment / robot->body.inertia_kg_m2;
    return rate;
}

/* start + h·rate */
static struct motion advance(const struct motion *start, const struct motion *rate, double h)
{
    double values[MOTION_SIZE];
    double rates[MOTION_SIZE];
    struct motion end;

    memcpy(values, start, sizeof values);
    memcpy(rates, rate, sizeof rates);
    for (size_t i = 0; i < MOTION_SIZE; i++) {
        values[i] += h * rates[i];
    }
    memcpy(&end, values, sizeof end);
    return end;
}

/* Runge–Kutta, 4th order. */
static void step(struct four_wheel_plant *plant, const struct wheel_input inputs[JP_WHEELS])
{
    const double h = FOUR_WHEEL_STEP;
    const struct motion s1 = {plant->state, plant->ledger};
    const struct motion k1 = derivative(plant->robot, &s1.state, inputs);
    const struct motion s2 = advance(&s1, &k1, h / 2);
    const struct motion k2 = derivative(plant->robot, &s2.state, inputs);
    const struct motion s3 = advance(&s1, &k2, h / 2);
    const struct motion k3 = derivative(plant->robot, &s3.state, inputs);
    const struct motion s4 = advance(&s1, &k3, h);
    const struct motion k4 = derivative(plant->robot, &s4.state, inputs);

    struct motion end = advance(&s1, &k1, h / 6);
    end = advance(&end, &k2, h / 3);
    end = advance(&end, &k3, h / 3);
    end = advance(&end, &k4, h / 6);
    plant->state = end.state;
    plant->ledger = end.energy;
}

static bool holds(const struct four_wheel_patch *patch, struct planar_point point)
{
    return point.x >= patch->low.x && point.x <= patch->high.x && point.y >= patch->low.y && point.y <= patch->high.y;
}

/* The ground under a wheel as it is now. */
static void stand(const struct four_wheel_plant *plant, int wheel, struct wheel_input *input)
{
    const struct four_wheel_file *robot = plant->robot;
    const struct planar_point place = place_of(robot, wheel);
    input->stiffness = robot->tyre.stiffness_n_s_per_m;
    input->grip = robot->tyre.friction * load(robot);
    input->pull = (struct planar_point){0, 0};
    if (plant->patch_count == 0) {
        return;
    }
    const struct planar_point contact = planar_place(&plant->state.pose, place);
    for (size_t i = 0; i < plant->patch_count; i++) {
        const struct four_wheel_patch *patch = &plant->patches[i];
        if (holds(patch, contact)) {
            input->stiffness *= place.y > 0 ? patch->stiffness_left : patch->stiffness_right;
            input->grip *= patch->friction;
            input->pull = patch->pull;
            return;
        }
    }
}

static double slip_of(const struct four_wheel_plant *plant, int wheel)
{
    const struct four_wheel_state *state = &plant->state;
    const struct four_wheel_contact *contact = &state->wheels[wheel];
    const struct planar_point place = place_of(plant->robot, wheel);
    const double tread = plant->robot->wheel.radius_m * contact->rate;
    const struct strict_turn turn = strict_sin_cos(contact->angle);

    return strict_hypot(state->forward - state->turn_rate * place.y - tread * turn.cosine,
                        state->left + state->turn_rate * place.x - tread * turn.sine);
}

static double counts_of(double turns, int counts_per_turn)
{
    return floor(turns * counts_per_turn);
}

/* Encoders, from where the wheel was at the start of the tick. */
static void measure(struct four_wheel_plant *plant, int wheel, double roll_before)
{
    const struct four_wheel_file *robot = plant->robot;
    const struct four_wheel_contact *contact = &plant->state.wheels[wheel];
    const int counts = robot->encoder.wheel_counts_per_turn;
    const double moved = counts_of(contact->roll / (2 * M_PI), counts) - counts_of(roll_before / (2 * M_PI), counts);
    const double speed = moved / counts * 2 * M_PI * robot->wheel.radius_m * FOUR_WHEEL_RATE_HZ;
    const double angle = rint(contact->angle / (2 * M_PI) * robot->encoder.steering_counts_per_turn) /
                         robot->encoder.steering_counts_per_turn;

    plant->measured.angle[wheel] = (int32_t)lround(angle * TURN_2_32);
    plant->measured.speed[wheel] = (jp_q24)lround(speed * JP_Q24_ONE);
}

void four_wheel_plant_init(struct four_wheel_plant *plant, const struct four_wheel_file *robot,
                           const struct planar_pose *pose)
{
    *plant = (struct four_wheel_plant){.robot = robot, .state = {.pose = *pose}};
    plant->bus_voltage = robot->electronics.voltage_v;
}

void four_wheel_plant_feed(struct four_wheel_plant *plant, const struct cell_constants *cell,
                           const struct cell_wiring *wiring, const struct cell_condition *condition)
{
    cell_pack_init(&plant->pack, cell, wiring, condition);
    plant->bus_voltage = cell_pack_source(&plant->pack).open_v;
    plant->has_pack = true;
}

/* The cells give what a tick took: V I = P, V = V0 − R I. */
static void draw(struct four_wheel_plant *plant, double joules)
{
    const struct cell_source source = cell_pack_source(&plant->pack);
    const double watts = joules * FOUR_WHEEL_RATE_HZ;
    const double root = sqrt(fmax(square(source.open_v) - 4 * source.resistance_ohm * watts, 0));

    plant->bus_voltage = (source.open_v + root) / 2;
    cell_pack_step(&plant->pack, watts / plant->bus_voltage, 1.0 / FOUR_WHEEL_RATE_HZ);
}

bool four_wheel_plant_add_patch(struct four_wheel_plant *plant, const struct four_wheel_patch *patch)
{
    if (plant->patch_count == FOUR_WHEEL_PATCHES_MAX) {
        return false;
    }
    plant->patches[plant->patch_count++] = *patch;
    return true;
}

void four_wheel_plant_tick(struct four_wheel_plant *plant, const struct jp_wheels *targets)
{
    const double limit = plant->robot->steering.limit_deg * M_PI / 180;
    struct wheel_input inputs[JP_WHEELS];
    double roll[JP_WHEELS];
    const double given = plant->ledger.battery;

    for (int i = 0; i < JP_WHEELS; i++) {
        inputs[i].angle = clamp(targets->angle[i] / TURN_2_32 * 2 * M_PI, limit);
        inputs[i].speed = (double)targets->speed[i] / JP_Q24_ONE;
        roll[i] = plant->state.wheels[i].roll;
    }
    for (int n = 0; n < STEPS_PER_TICK; n++) {
        for (int i = 0; i < JP_WHEELS; i++) {
            stand(plant, i, &inputs[i]);
        }
        step(plant, inputs);
    }
    if (plant->has_pack) {
        draw(plant, plant->ledger.battery - given);
    }
    plant->slip_max = 0;
    for (int i = 0; i < JP_WHEELS; i++) {
        measure(plant, i, roll[i]);
        plant->slip_max = fmax(plant->slip_max, slip_of(plant, i));
    }
}

struct four_wheel_patch four_wheel_slope(double rise_x, double rise_y)
{
    const double length = sqrt(1 + square(rise_x) + square(rise_y));

    return (struct four_wheel_patch){
        .low = {-INFINITY, -INFINITY},
        .high = {INFINITY, INFINITY},
        .friction = 1,
        .stiffness_left = 1,
        .stiffness_right = 1,
        .pull = {-FOUR_WHEEL_GRAVITY * rise_x / length, -FOUR_WHEEL_GRAVITY * rise_y / length},
    };
}

double four_wheel_plant_supply_error(const struct four_wheel_plant *plant)
{
    const struct four_wheel_ledger *const l = &plant->ledger;

    return l->battery - (l->electronics + l->copper + l->gear + l->drive + l->steering);
}

double four_wheel_plant_kinetic_energy(const struct four_wheel_plant *plant)
{
    const struct four_wheel_file *robot = plant->robot;
    const struct four_wheel_state *state = &plant->state;
    double spin = 0;

    for (int i = 0; i < JP_WHEELS; i++) {
        spin += robot->wheel.inertia_kg_m2 * square(state->wheels[i].rate);
    }
    return (robot->body.mass_kg * (square(state->forward) + square(state->left)) +
            robot->body.inertia_kg_m2 * square(state->turn_rate) + spin) /
           2;
}

double four_wheel_plant_damping_rate(const struct four_wheel_file *robot)
{
    const double arm = square(robot->body.wheelbase_m / 2) + square(robot->body.track_m / 2);
    const double radius = robot->wheel.radius_m;
    const double slip = robot->tyre.stiffness_n_s_per_m *
                        (square(radius) / robot->wheel.inertia_kg_m2 + JP_WHEELS / robot->body.mass_kg +
                         JP_WHEELS * arm / robot->body.inertia_kg_m2);
    const double spin = (servo_gain(robot) * radius + robot->drive.friction_nm_s_per_rad +
                         robot->tyre.rolling * load(robot) * square(radius) / ROLLING_FADE) /
                        robot->wheel.inertia_kg_m2;

    return fmax(slip + spin, 1 / robot->steering.time_constant_s);
}
