#include "sim/skid_steer/skid_plant.h"
#include "sim/base/strict_math.h"

/* Of the relaxation of a tread that rolls, over the length of its contact: steady slip, uniform load. */
#define RELAXATION 1.2

/* Dry friction that is being strained settles so fast, s. */
#define DRAG_DAMPING 0.02

/* The plane in which the body lies, in its own axes: x along the heading, y to its left, both on the map. */
struct lie {
    double ahead;  /* rise over run */
    double across; /* the same to the left */
    double along;  /* length of the plane's x axis over its run */
    double normal; /* length of the normal over its height */
};

/* The ground under the centre of mass: the elevation of its contacts, by what they carry on level ground. */
struct footing {
    struct lie lie;
    double elevation;
    double slope_ahead; /* its derivatives on the map */
    double slope_left;
    double slope_turn;
};

/* Sums over the contacts, on the body. */
struct wrench {
    double ahead; /* N */
    double left;
    double turn;                  /* N·m */
    double braking[SKID_SIDES];   /* N, of the ground on the treads of a side */
    double resisting[SKID_SIDES]; /* its load, by the resistance of the ground */
};

/* What the motor of a side does. */
struct drive {
    double current; /* A */
    double power;   /* out of the bus, W */
};

/* What the battery gives. */
struct supply {
    double current;
    double voltage;
};

static double square(double a)
{
    return a * a;
}

/* As hypot(), of what is far from the ends of its format. */
static double length(double a, double b)
{
    return sqrt(a * a + b * b);
}

/* ---- Geometry ---- */

static double axle_place(const struct skid_steer_model *model, int axle)
{
    const int gaps = model->wheel.axles - 1;

    return gaps == 0 ? 0 : model->body.wheelbase_m * ((double)axle / gaps - 0.5);
}

static struct skid_contact wheel_contact(const struct skid_steer_model *model, int axle, int side)
{
    const double half = model->body.width_m / 2;

    return (struct skid_contact){
        .place = {axle_place(model, axle) - model->body.centre_ahead_m, side == SKID_LEFT ? half : -half},
        .side = side,
        .friction = model->ground.friction,
        .resistance = 1,
        .stiffness = model->tyre.stiffness_per_m,
        .damping = model->tyre.damping_s_per_m,
        .relaxation = RELAXATION / model->tyre.contact_length_m,
    };
}

/* It rolls whichever way it is moved, against a dry friction that holds within the deflection of a tyre's. */
static struct skid_contact caster_contact(const struct skid_steer_model *model)
{
    return (struct skid_contact){
        .place = {model->caster.ahead_m - model->body.centre_ahead_m, 0},
        .side = SKID_SIDES,
        .friction = model->caster.rolling,
        .resistance = 1,
        .stiffness = model->tyre.stiffness_per_m * model->caster.rolling / model->ground.friction,
    };
}

static void place_contacts(struct skid_plant *plant)
{
    const struct skid_steer_model *model = &plant->model;

    for (int axle = 0; axle < model->wheel.axles; axle++) {
        for (int side = SKID_LEFT; side < SKID_SIDES; side++) {
            plant->contacts[plant->contact_count++] = wheel_contact(model, axle, side);
        }
    }
    if (model->caster.ahead_m != 0) {
        plant->contacts[plant->contact_count++] = caster_contact(model);
    }
}

/* The plane a + b x + c y over the contacts' places that comes closest to values whose moments are given. */
static void fit_plane(const struct skid_plant *plant, const double moments[3], double plane[3])
{
    for (int i = 0; i < 3; i++) {
        plane[i] = 0;
        for (int j = 0; j < 3; j++) {
            plane[i] += plant->loads[i][j] * moments[j];
        }
    }
}

static void invert(double m[3][3], double inverse[3][3])
{
    const double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                               m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);

    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const int r = (j + 1) % 3;
            const int s = (j + 2) % 3;
            const int c = (i + 1) % 3;
            const int d = (i + 2) % 3;
            inverse[i][j] = (m[r][c] * m[s][d] - m[r][d] * m[s][c]) / determinant;
        }
    }
}

static void prepare_loads(struct skid_plant *plant)
{
    double moments[3][3] = {{0}};

    for (int i = 0; i < plant->contact_count; i++) {
        const double place[3] = {1, plant->contacts[i].place.x, plant->contacts[i].place.y};
        for (int j = 0; j < 3; j++) {
            for (int k = 0; k < 3; k++) {
                moments[j][k] += place[j] * place[k];
            }
        }
    }
    invert(moments, plant->loads);

    const double level[3] = {1, 0, 0};
    double plane[3];
    fit_plane(plant, level, plane);
    for (int i = 0; i < plant->contact_count; i++) {
        struct skid_contact *contact = &plant->contacts[i];
        contact->static_share = plane[0] + plane[1] * contact->place.x + plane[2] * contact->place.y;
    }
}

/* ---- Ground ---- */

static struct lie lie_of(double ahead, double across)
{
    return (struct lie){ahead, across, sqrt(1 + square(ahead)), sqrt(1 + square(ahead) + square(across))};
}

static struct footing footing_at(const struct skid_plant *plant, const struct skid_state *state)
{
    if (plant->ground.at == NULL) {
        return (struct footing){.lie = {0, 0, 1, 1}};
    }
    const struct strict_turn turn = strict_sin_cos(state->heading);
    struct footing footing = {.elevation = 0};
    double moments[3] = {0};

    for (int i = 0; i < plant->contact_count; i++) {
        const struct skid_contact *contact = &plant->contacts[i];
        const double x = turn.cosine * contact->place.x - turn.sine * contact->place.y;
        const double y = turn.sine * contact->place.x + turn.cosine * contact->place.y;
        const struct skid_ground_point point = plant->ground.at(plant->ground.context, state->x + x, state->y + y);
        footing.elevation += contact->static_share * point.elevation;
        footing.slope_ahead += contact->static_share * (turn.cosine * point.slope_x + turn.sine * point.slope_y);
        footing.slope_left += contact->static_share * (turn.cosine * point.slope_y - turn.sine * point.slope_x);
        footing.slope_turn += contact->static_share * (x * point.slope_y - y * point.slope_x);
        moments[0] += point.elevation;
        moments[1] += contact->place.x * point.elevation;
        moments[2] += contact->place.y * point.elevation;
    }
    double plane[3];
    fit_plane(plant, moments, plane);
    footing.lie = lie_of(plane[1], plane[2]);
    return footing;
}

/* Weight on the plane, N. */
static double weight_on(const struct skid_plant *plant, const struct lie *lie)
{
    return plant->model.body.mass_kg * STANDARD_GRAVITY / lie->normal;
}

/* Where the loads' resultant passes the ground, from the centre of mass. */
static struct planar_point pressure_centre(const struct skid_plant *plant, const struct lie *lie,
                                           const struct skid_state *state)
{
    const double reach = plant->model.body.centre_height_m * lie->normal / STANDARD_GRAVITY;

    return (struct planar_point){-reach * state->pressed_ahead, -reach * state->pressed_across};
}

/* N of each contact: none pulls, and together they carry the weight. */
static void set_loads(const struct skid_plant *plant, const struct lie *lie, const struct skid_state *state,
                      double load[SKID_CONTACTS_MAX])
{
    const double weight = weight_on(plant, lie);
    const struct planar_point centre = pressure_centre(plant, lie, state);
    const double moments[3] = {weight, weight * centre.x, weight * centre.y};
    double plane[3];
    double sum = 0;

    fit_plane(plant, moments, plane);
    for (int i = 0; i < plant->contact_count; i++) {
        const struct planar_point place = plant->contacts[i].place;
        load[i] = plant->contacts[i].lifted ? 0 : fmax(plane[0] + plane[1] * place.x + plane[2] * place.y, 0);
        sum += load[i];
    }
    for (int i = 0; i < plant->contact_count; i++) {
        load[i] *= weight / sum;
    }
}

/* Half of the width that carries at a place along the robot; below 0 beyond its contacts. */
static double support_at(const struct skid_plant *plant, double x)
{
    const double half = plant->model.body.width_m / 2;
    const double rear = plant->contacts[0].place.x;
    const double front = plant->contacts[2 * (plant->model.wheel.axles - 1)].place.x;
    const double caster = plant->contacts[plant->contact_count - 1].place.x;

    if (plant->model.caster.ahead_m == 0) {
        return x < rear || x > front ? -1 : half;
    }
    return caster < rear ? (x > front ? -1 : half * (x - caster) / (rear - caster))
                         : (x < rear ? -1 : half * (caster - x) / (caster - front));
}

static bool tips(const struct skid_plant *plant, const struct lie *lie)
{
    const struct planar_point centre = pressure_centre(plant, lie, &plant->state);

    return fabs(centre.y) > support_at(plant, centre.x);
}

/* ---- Contacts ---- */

static void add_contact(const struct skid_plant *plant, const struct skid_state *state, int index, double load,
                        struct skid_state *rate, struct wrench *sum)
{
    const struct skid_contact *contact = &plant->contacts[index];
    const struct skid_tread *tread = &state->treads[index];
    const bool is_driven = contact->side < SKID_SIDES;
    const double tread_speed = is_driven ? plant->model.wheel.radius_m * state->sides[contact->side].rate : 0;
    const double along = state->forward - state->turn_rate * contact->place.y - tread_speed;
    const double across = state->left + state->turn_rate * contact->place.x;
    const double slip = length(along, across);
    const double fading =
        contact->stiffness * slip / contact->friction + contact->relaxation * fabs(tread_speed); /* 1/s */
    const double damping = contact->damping / (1 + contact->damping * fading / (2 * contact->stiffness));

    rate->treads[index] = (struct skid_tread){along - fading * tread->along, across - fading * tread->across};
    double x = -load * (contact->stiffness * tread->along + damping * rate->treads[index].along);
    double y = -load * (contact->stiffness * tread->across + damping * rate->treads[index].across);
    const double excess = length(x, y) / (contact->friction * load + 1e-12);
    if (excess > 1) {
        x /= excess;
        y /= excess;
    }

    sum->ahead += x;
    sum->left += y;
    sum->turn += contact->place.x * y - contact->place.y * x;
    if (is_driven) {
        sum->braking[contact->side] += x;
        sum->resisting[contact->side] += load * contact->resistance;
        rate->ledger.slip_along -= x * along;
        rate->ledger.slip_across -= y * across;
    } else {
        rate->ledger.caster -= x * along + y * across;
    }
}

/* ---- Motors ---- */

static double clamp(double a, double limit)
{
    return fmin(fmax(a, -limit), limit);
}

/* The bridge returns the share of what the motor generates behind the gear, and never gives while it brakes. */
static double bus_power(const struct skid_plant *plant, double voltage, double back_emf, double current)
{
    const double power = voltage * current;
    const double generated = fmax(-back_emf * current, 0);
    const double burnt = (1 - plant->model.motor.recuperation) * generated;

    return fmin(power + burnt, fmax(power, 0));
}

/* Dry friction of a side's wheels, −1…1 of the most that it can be; its rate goes to *rate. */
static double drag_of(const struct skid_plant *plant, const struct skid_side *wheels, struct skid_side *rate)
{
    const double fading = fabs(wheels->rate) / plant->presliding;
    const double damping = DRAG_DAMPING / (1 + DRAG_DAMPING * fading / 2);

    rate->drag = wheels->rate / plant->presliding - fading * wheels->drag;
    return clamp(wheels->drag + damping * rate->drag, 1);
}

static struct drive drive_side(const struct skid_plant *plant, const struct skid_state *state, int side,
                               const struct skid_input *input, const struct wrench *sum, struct skid_state *rate)
{
    const struct skid_steer_model *model = &plant->model;
    const struct skid_side *wheels = &state->sides[side];
    const double constant = model->motor.torque_constant * model->motor.gear_ratio;
    const double back_emf = constant * wheels->rate;
    const double wanted = (input->duty[side] * plant->attitude.bus_voltage - back_emf) / model->motor.resistance_ohm;
    const double current = input->driven ? clamp(wanted, model->motor.current_limit_a) : 0;
    const double voltage = back_emf + current * model->motor.resistance_ohm;
    const double torque = constant * current;

    const double radius = model->wheel.radius_m;
    const double rolling = model->ground.rolling * sum->resisting[side] * radius;
    const double efficiency = model->motor.efficiency;
    const double drag = drag_of(plant, wheels, &rate->sides[side]);
    const double meshing = fabs(torque) * (torque * drag > 0 ? 1 - efficiency : 1 / efficiency - 1);
    const double gear = meshing + model->motor.friction_nm + plant->jam[side];
    const double power = bus_power(plant, voltage, back_emf, current);

    rate->sides[side].angle = wheels->rate;
    rate->sides[side].rate = (torque - (gear + rolling) * drag - radius * sum->braking[side]) / plant->side_inertia;
    rate->ledger.bridge += power - voltage * current;
    rate->ledger.copper += square(current) * model->motor.resistance_ohm;
    rate->ledger.gear += gear * drag * wheels->rate;
    rate->ledger.rolling += rolling * drag * wheels->rate;
    return (struct drive){.current = current, .power = power};
}

/* The battery gives what the bus takes: V I = P, V = V0 − R I. The robot file's check leaves room for both motors;
 * cells that have not that much give what they can at half their voltage. */
static struct supply supply_of(const struct cell_source *source, double power)
{
    const double open = source->open_v;
    const double resistance = source->resistance_ohm;
    const double voltage = (open + sqrt(fmax(square(open) - 4 * resistance * power, 0))) / 2;

    return (struct supply){power / voltage, voltage};
}

/* ---- Motion ---- */

static void set_pose_rates(const struct lie *lie, const struct skid_state *state, struct skid_state *rate)
{
    const struct strict_turn turn = strict_sin_cos(state->heading);

    const double ahead = (state->forward - state->left * lie->ahead * lie->across / lie->normal) / lie->along;
    const double left = state->left * lie->along / lie->normal;
    rate->x = turn.cosine * ahead - turn.sine * left;
    rate->y = turn.sine * ahead + turn.cosine * left;
    rate->heading = state->turn_rate * square(lie->along) / lie->normal;
}

/* Gravity works on each coordinate as the elevation changes with it. */
static void set_body_rates(const struct skid_plant *plant, const struct footing *footing,
                           const struct skid_state *state, const struct wrench *sum, struct skid_state *rate)
{
    const struct skid_steer_model *model = &plant->model;
    const struct lie *lie = &footing->lie;
    const double mass = model->body.mass_kg;
    const double rise_forward = footing->slope_ahead / lie->along;
    const double rise_left =
        (footing->slope_left * square(lie->along) - footing->slope_ahead * lie->ahead * lie->across) /
        (lie->along * lie->normal);
    const double rise_turn = footing->slope_turn * square(lie->along) / lie->normal;

    rate->forward = sum->ahead / mass - STANDARD_GRAVITY * rise_forward + state->turn_rate * state->left;
    rate->left = sum->left / mass - STANDARD_GRAVITY * rise_left - state->turn_rate * state->forward;
    rate->turn_rate = (sum->turn - mass * STANDARD_GRAVITY * rise_turn) / model->body.yaw_inertia_kg_m2;
    rate->pressed_ahead = (sum->ahead / mass - state->pressed_ahead) / SKID_SUSPENSION_TIME;
    rate->pressed_across = (sum->left / mass - state->pressed_across) / SKID_SUSPENSION_TIME;
}

/* The rates of the state; what can be seen of it goes to *attitude. */
static void derivative(const struct skid_plant *plant, const struct skid_state *state, const struct footing *footing,
                       const struct skid_input *input, struct skid_state *rate, struct skid_attitude *attitude)
{
    struct wrench sum = {.ahead = 0};

    rate->ledger = (struct skid_ledger){.electronics = plant->model.electronics.power_w};
    set_loads(plant, &footing->lie, state, attitude->load);
    for (int i = 0; i < plant->contact_count; i++) {
        add_contact(plant, state, i, attitude->load[i], rate, &sum);
    }
    double power = plant->model.electronics.power_w;
    for (int side = 0; side < SKID_SIDES; side++) {
        const struct drive drive = drive_side(plant, state, side, input, &sum, rate);
        attitude->current[side] = drive.current;
        power += drive.power;
    }
    const struct supply supply = supply_of(&plant->source, power);
    rate->ledger.battery = plant->source.open_v * supply.current;
    rate->ledger.supply = square(supply.current) * plant->source.resistance_ohm;
    set_pose_rates(&footing->lie, state, rate);
    set_body_rates(plant, footing, state, &sum, rate);
    attitude->rise_ahead = footing->lie.ahead;
    attitude->rise_across = footing->lie.across;
    attitude->force_ahead = sum.ahead / plant->model.body.mass_kg;
    attitude->force_left = sum.left / plant->model.body.mass_kg;
    attitude->bus_voltage = supply.voltage;
}

/* ---- Integration ---- */

/* A state as the numbers that it consists of. */
union numbers {
    struct skid_state state;
    double values[sizeof(struct skid_state) / sizeof(double)];
};

/* *end = *start + h·*rate, as far as the contacts go. */
static void advance(const struct skid_plant *plant, const union numbers *start, const union numbers *rate, double h,
                    union numbers *end)
{
    const size_t size = offsetof(struct skid_state, treads) + (size_t)plant->contact_count * sizeof(struct skid_tread);

    for (size_t i = 0; i < size / sizeof(double); i++) {
        end->values[i] = start->values[i] + h * rate->values[i];
    }
}

static void set_normal(struct strict_turn turn, struct skid_attitude *seen)
{
    const struct lie lie = lie_of(seen->rise_ahead, seen->rise_across);

    seen->normal[0] = -(turn.cosine * lie.ahead - turn.sine * lie.across) / lie.normal;
    seen->normal[1] = -(turn.sine * lie.ahead + turn.cosine * lie.across) / lie.normal;
    seen->normal[2] = 1 / lie.normal;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The body turns with its normal: n × ṅ, about its axes along the heading and to the left of it. */
static void set_tilt_rates(const struct skid_attitude *before, struct strict_turn turn, double h,
                           struct skid_attitude *seen)
{
    const struct lie lie = lie_of(seen->rise_ahead, seen->rise_across);
    const double *n = seen->normal;
    const double ahead[3] = {turn.cosine / lie.along, turn.sine / lie.along, lie.ahead / lie.along};
    const double left[3] = {n[1] * ahead[2] - n[2] * ahead[1], n[2] * ahead[0] - n[0] * ahead[2],
                            n[0] * ahead[1] - n[1] * ahead[0]};
    const double change[3] = {(n[0] - before->normal[0]) / h, (n[1] - before->normal[1]) / h,
                              (n[2] - before->normal[2]) / h};

    seen->roll_rate = -dot(change, left);
    seen->pitch_rate = dot(change, ahead);
}

/* What each contact is on. */
static void touch_surface(struct skid_plant *plant)
{
    const struct skid_steer_model *model = &plant->model;
    const struct planar_pose centre = {plant->state.x, plant->state.y, plant->state.heading};

    for (int i = 0; i < plant->contact_count; i++) {
        struct skid_contact *contact = &plant->contacts[i];
        const struct planar_point place = planar_place(&centre, contact->place);
        const struct skid_grip grip = plant->surface.at(plant->surface.context, place.x, place.y);

        contact->resistance = grip.rolling;
        contact->friction =
            contact->side < SKID_SIDES ? model->ground.friction * grip.friction : model->caster.rolling * grip.rolling;
    }
}

/* The two states in the middle of a step are on the same ground but for the square of its length. */
static void integrate(struct skid_plant *plant, const struct skid_input *input, double h)
{
    const union numbers start = {.state = plant->state};
    struct skid_attitude seen = plant->attitude;
    struct footing footing = footing_at(plant, &start.state);
    union numbers at = start;
    union numbers k1;
    union numbers k2;
    union numbers k3;
    union numbers k4;

    derivative(plant, &start.state, &footing, input, &k1.state, &seen);
    advance(plant, &start, &k1, h / 2, &at);
    footing = footing_at(plant, &at.state);
    derivative(plant, &at.state, &footing, input, &k2.state, &seen);
    advance(plant, &start, &k2, h / 2, &at);
    derivative(plant, &at.state, &footing, input, &k3.state, &seen);
    advance(plant, &start, &k3, h, &at);
    footing = footing_at(plant, &at.state);
    derivative(plant, &at.state, &footing, input, &k4.state, &seen);

    advance(plant, &start, &k1, h / 6, &at);
    advance(plant, &at, &k2, h / 3, &at);
    advance(plant, &at, &k3, h / 3, &at);
    advance(plant, &at, &k4, h / 6, &at);
    plant->state = at.state;
    const struct strict_turn turn = strict_sin_cos(plant->state.heading);
    set_normal(turn, &seen);
    set_tilt_rates(&plant->attitude, turn, h, &seen);
    plant->attitude = seen;
}

static void stop_tipped(struct skid_plant *plant)
{
    plant->state.ledger.impact += skid_plant_kinetic_energy(plant);
    plant->state.forward = 0;
    plant->state.left = 0;
    plant->state.turn_rate = 0;
    for (int side = 0; side < SKID_SIDES; side++) {
        plant->state.sides[side].rate = 0;
    }
    plant->tipped = true;
}

/* The motors of a robot that lies are off; its electronics go on. */
static void lie_still(struct skid_plant *plant, double seconds)
{
    const double power = plant->model.electronics.power_w;
    const struct supply supply = supply_of(&plant->source, power);

    plant->state.ledger.battery += seconds * plant->source.open_v * supply.current;
    plant->state.ledger.supply += seconds * square(supply.current) * plant->source.resistance_ohm;
    plant->state.ledger.electronics += seconds * power;
    plant->attitude.bus_voltage = supply.voltage;
    plant->attitude.current[SKID_LEFT] = 0;
    plant->attitude.current[SKID_RIGHT] = 0;
    plant->attitude.pitch_rate = 0;
    plant->attitude.roll_rate = 0;
}

/* One step of the integrator. */
static void step(struct skid_plant *plant, const struct skid_input *input, double h)
{
    if (plant->tipped) {
        lie_still(plant, h);
        return;
    }
    if (plant->surface.at != NULL) {
        touch_surface(plant);
    }
    integrate(plant, input, h);
    const struct lie lie = lie_of(plant->attitude.rise_ahead, plant->attitude.rise_across);
    if (tips(plant, &lie)) {
        stop_tipped(plant);
    }
}

/* The cells give what a step took. */
static void draw(struct skid_plant *plant, double taken, double seconds)
{
    cell_pack_step(&plant->pack, taken / plant->source.open_v / seconds, seconds);
    plant->source = cell_pack_source(&plant->pack);
}

void skid_plant_feed(struct skid_plant *plant, const struct cell_constants *cell, const struct cell_wiring *wiring,
                     const struct cell_condition *condition)
{
    cell_pack_init(&plant->pack, cell, wiring, condition);
    plant->source = cell_pack_source(&plant->pack);
    plant->attitude.bus_voltage = supply_of(&plant->source, plant->model.electronics.power_w).voltage;
    plant->has_pack = true;
}

void skid_plant_step(struct skid_plant *plant, const struct skid_input *input, double seconds)
{
    const int steps = (int)ceil(seconds / plant->step - 1e-9);
    const double h = seconds / steps;

    for (int i = 0; i < steps; i++) {
        const double given = plant->state.ledger.battery;

        step(plant, input, h);
        if (plant->has_pack) {
            draw(plant, plant->state.ledger.battery - given, h);
        }
    }
}

/* ---- Start and end ---- */

static double side_inertia(const struct skid_steer_model *model)
{
    return model->wheel.axles * model->wheel.inertia_kg_m2 +
           square(model->motor.gear_ratio) * model->motor.rotor_inertia_kg_m2;
}

/* rad */
static double presliding(const struct skid_steer_model *model)
{
    return model->limits.speed_m_s / model->wheel.radius_m * SKID_PRESLIDING_TIME;
}

/* Of the body on its treads, 1/s. */
static double tread_rate(const struct skid_steer_model *model)
{
    const double weight = model->body.mass_kg * STANDARD_GRAVITY;
    const double reach = square(model->body.length_m + model->body.width_m) / 2;
    /* The lightest that a tread pushes: the wheels, or the body at its ends. */
    const double mobility = square(model->wheel.radius_m) / side_inertia(model) + 1 / model->body.mass_kg +
                            reach / model->body.yaw_inertia_kg_m2;

    return sqrt(model->tyre.stiffness_per_m * weight * mobility) + model->tyre.damping_s_per_m * weight * mobility;
}

/* Of a side on its dry friction. */
static double drag_rate(const struct skid_steer_model *model)
{
    const double constant = model->motor.torque_constant * model->motor.gear_ratio;
    const double meshing = constant * model->motor.current_limit_a * (1 / model->motor.efficiency - 1);
    const double rolling = model->ground.rolling * model->body.mass_kg * STANDARD_GRAVITY * model->wheel.radius_m;
    const double stiffness = (meshing + rolling + model->motor.friction_nm) / presliding(model) / side_inertia(model);

    return sqrt(stiffness) + DRAG_DAMPING * stiffness;
}

double skid_plant_rate(const struct skid_steer_model *model)
{
    const double arm = fmax(fabs(model->caster.ahead_m), model->body.wheelbase_m / 2);
    const double speed = 2 * model->limits.speed_m_s * (1 + arm / (model->body.width_m / 2));
    const double sliding =
        speed * (model->tyre.stiffness_per_m / model->ground.friction + RELAXATION / model->tyre.contact_length_m);
    const double motor = square(model->motor.torque_constant * model->motor.gear_ratio) /
                         (model->motor.resistance_ohm * side_inertia(model) * model->motor.efficiency);
    const double turning = 2 / SKID_PRESLIDING_TIME;

    return fmax(fmax(sliding, turning), fmax(tread_rate(model), fmax(drag_rate(model), motor)));
}

void skid_plant_lay(struct skid_plant *plant, const struct skid_surface *surface)
{
    struct skid_steer_model hardest = plant->model;

    hardest.ground.rolling *= surface->most.rolling;
    hardest.ground.friction *= surface->most.friction;
    plant->surface = *surface;
    plant->step = fmin(plant->step, SKID_STEP_RATE_MAX / skid_plant_rate(&hardest));
    touch_surface(plant);
}

void skid_plant_init(struct skid_plant *plant, const struct skid_steer_model *model, const struct skid_ground *ground,
                     const struct planar_pose *pose)
{
    *plant = (struct skid_plant){.model = *model, .ground = *ground};
    const struct planar_point centre = planar_place(pose, (struct planar_point){model->body.centre_ahead_m, 0});

    place_contacts(plant);
    prepare_loads(plant);
    plant->side_inertia = side_inertia(model);
    plant->presliding = presliding(model);
    plant->step = fmin(SKID_STEP, SKID_STEP_RATE_MAX / skid_plant_rate(model));
    plant->state.x = centre.x;
    plant->state.y = centre.y;
    plant->state.heading = pose->heading;

    const struct footing footing = footing_at(plant, &plant->state);
    plant->start_elevation = footing.elevation;
    plant->state.pressed_ahead = STANDARD_GRAVITY * footing.slope_ahead / footing.lie.along;
    plant->state.pressed_across = STANDARD_GRAVITY * footing.slope_left * footing.lie.along / footing.lie.normal;
    plant->attitude.rise_ahead = footing.lie.ahead;
    plant->attitude.rise_across = footing.lie.across;
    set_normal(strict_sin_cos(plant->state.heading), &plant->attitude);
    plant->source = (struct cell_source){model->supply.voltage_v, model->supply.resistance_ohm};
    plant->attitude.bus_voltage = supply_of(&plant->source, model->electronics.power_w).voltage;
    plant->attitude.force_ahead = plant->state.pressed_ahead;
    plant->attitude.force_left = plant->state.pressed_across;
    plant->tipped = tips(plant, &footing.lie);
}

struct planar_pose skid_plant_pose(const struct skid_plant *plant)
{
    const struct planar_pose centre = {plant->state.x, plant->state.y, plant->state.heading};
    const struct planar_point middle =
        planar_place(&centre, (struct planar_point){-plant->model.body.centre_ahead_m, 0});

    return (struct planar_pose){middle.x, middle.y, centre.heading};
}

double skid_plant_kinetic_energy(const struct skid_plant *plant)
{
    const struct skid_state *state = &plant->state;
    const struct skid_steer_model *model = &plant->model;

    return (model->body.mass_kg * (square(state->forward) + square(state->left)) +
            model->body.yaw_inertia_kg_m2 * square(state->turn_rate) +
            plant->side_inertia * (square(state->sides[SKID_LEFT].rate) + square(state->sides[SKID_RIGHT].rate))) /
           2;
}

double skid_plant_potential_energy(const struct skid_plant *plant)
{
    const struct footing footing = footing_at(plant, &plant->state);

    return plant->model.body.mass_kg * STANDARD_GRAVITY * (footing.elevation - plant->start_elevation);
}

double skid_plant_residual(const struct skid_plant *plant, double start)
{
    const struct skid_ledger *l = &plant->state.ledger;
    const double stored = skid_plant_kinetic_energy(plant) - start + skid_plant_potential_energy(plant);
    const double lost = l->supply + l->electronics + l->bridge + l->copper + l->gear + l->slip_along + l->slip_across +
                        l->rolling + l->caster + l->impact;

    return l->battery - lost - stored;
}
