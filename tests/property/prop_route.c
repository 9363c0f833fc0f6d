/*
 * The route optimiser against a search in double precision: no feasible change of a plan, small or large, alone or of
 * all legs, spends clearly less. Random routes, limits, robots and horizons; and any model at all for robustness.
 *
 * prop_route [--count N] [--seed S]
 * --count is the number of random routes of each kind.
 */
#include <joulepath/tables.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/options.h"
#include "tests/support/route_oracle.h"
#include "unity.h"

/* Of the search that tries to spend less. */
#define TRIES     1500
#define STEP_MAX  0.5
#define STEP_MIN  1e-4
#define TOLERANCE 1e-6 /* of σ, rad */

static const struct robot {
    const struct jp_energy_model *model;
    const struct jp_horizon *horizon;
} robots[] = {{&jp_energy_model_gao2018, &jp_horizon_gao2018},
              {&jp_energy_model_courier24, &jp_horizon_courier24},
              {&jp_energy_model_courier24_battery, &jp_horizon_courier24_battery}};

struct kind {
    const char *name;
    bool random_limits;
    bool random_robot;
    bool has_horizon;
    double near;       /* plans within this factor of what the search finds count as optima */
    double near_share; /* of the plans at least */
    unsigned long planned;
    unsigned long optimal;
    unsigned long greedy; /* plans that are the greedy ones */
    double worst_ratio;
    double worst_landing; /* as a part of its tolerance */
};

static uint64_t seed = 1;
static uint64_t random_state;
static unsigned long count = 400;
static struct kind kinds[] = {
    {.name = "paper's limits", .near = 1.0005, .near_share = 0.98},
    {.name = "random limits", .random_limits = true, .near = 1.0005, .near_share = 0.85},
    {.name = "random robots", .random_limits = true, .random_robot = true, .near = 1.0005, .near_share = 0.85},
    {.name = "with horizon", .has_horizon = true, .near = 1.005, .near_share = 0.85},
};

void setUp(void)
{
}

void tearDown(void)
{
}

/* ---- Random numbers ---- */

static uint64_t random_bits(void)
{
    random_state ^= random_state << 13;
    random_state ^= random_state >> 7;
    random_state ^= random_state << 17;
    return random_state * UINT64_C(2685821657736338717);
}

static double uniform(double low, double high)
{
    return low + (high - low) * (double)(random_bits() >> 11) * 0x1p-53;
}

static double log_uniform(double low, double high)
{
    return exp(uniform(log(low), log(high)));
}

static bool coin(void)
{
    return (random_bits() & 1) != 0;
}

/* ---- The search ---- */

static double arc_length(double chord, double arc)
{
    const double half = arc / 2;

    return fabs(half) < 1e-6 ? chord * (1 + half * half / 6) : chord * half / sin(half);
}

/* The energy of a way whose segments take longer where a limit demands it; INFINITY: it is not feasible. */
static double price(const struct problem *p, const struct way *way)
{
    struct motion motions[LEGS_MAX];
    double arc_before = 0;

    for (unsigned k = 0; k < p->task->count; k++) {
        const double arc = way->arc[k];
        const double length = arc_length(p->chord[k], arc);
        const double turn = p->turn[k] - (arc_before + arc) / 2;
        const double time = fmax(fmax(way->time[k], p->shortest), fmax(length / p->speed, fabs(arc) / p->turn_rate));

        if (fabs(turn) > p->turn_max + TOLERANCE || time > p->longest || fabs(arc) > ARC_MAX) {
            return INFINITY;
        }
        motions[k] = (struct motion){length / time, arc / time, turn, time};
        arc_before = arc;
    }
    return energy_of(p->task, motions);
}

/* Another way, of one leg, of two neighbours or of all. */
static struct way change(const struct way *way, unsigned legs, double step)
{
    struct way other = *way;
    const unsigned first = (unsigned)(random_bits() % legs);
    const unsigned width = coin() ? 1 + (unsigned)(random_bits() & 1) : legs;

    for (unsigned k = 0; k < legs; k++) {
        if (width == legs || (k >= first && k < first + width)) {
            other.arc[k] += step * uniform(-1, 1);
            other.time[k] *= exp(step * uniform(-1, 1));
        }
    }
    return other;
}

/* The least energy that random changes reach, which keep what spends less. */
static double search(const struct problem *p, const struct way *start)
{
    struct way best = *start;
    double least = price(p, start);

    for (int i = 0; i < TRIES; i++) {
        const struct way other = change(&best, p->task->count, log_uniform(STEP_MIN, STEP_MAX));
        const double found = price(p, &other);
        if (found < least) {
            least = found;
            best = other;
        }
    }
    return least;
}

/* ---- Tasks ---- */

static jp_q16 scaled(jp_q16 value, double factor)
{
    return (jp_q16)lround(value * factor * uniform(0.9, 1.1));
}

/* The published robot in other units of speed, turn rate and energy, each parameter 10 % off, with another Ts. */
static void randomise_robot(struct jp_energy_model *model)
{
    static const int powers[JP_ENERGY_TERMS][2] = {{2, 0}, {0, 2}, {0, 0}, {1, 1}, {1, 0}, {0, 1}, {1, 0},
                                                   {0, 1}, {0, 0}, {1, 0}, {0, 1}, {0, 0}, {0, 0}};
    const double speed = log_uniform(0.8, 1.25);
    const double turn_rate = log_uniform(0.8, 1.25);
    const double unit = log_uniform(0.25, 4);

    for (int i = 0; i < JP_ENERGY_TERMS; i++) {
        model->a[i] = scaled(model->a[i], unit * pow(speed, powers[i][0]) * pow(turn_rate, powers[i][1]));
    }
    model->b[0] = scaled(model->b[0], unit * speed * speed);
    model->b[1] = scaled(model->b[1], unit * turn_rate * turn_rate);
    model->electronics_power = scaled(model->electronics_power, unit);
    model->voltage_per_speed = scaled(model->voltage_per_speed, speed);
    model->voltage_per_turn_rate = scaled(model->voltage_per_turn_rate, turn_rate);
    model->settling_time = JP_Q16(uniform(4, 8));
}

static void draw_targets(struct task *t, double shortest, double longest)
{
    double x = q16(t->start.x);
    double y = q16(t->start.y);
    double direction = angle(t->heading);

    t->count = (uint16_t)(1 + random_bits() % LEGS_MAX);
    for (unsigned k = 0; k < t->count; k++) {
        const double length = log_uniform(shortest, longest);
        direction += uniform(-2, 2);
        x += length * cos(direction);
        y += length * sin(direction);
        t->targets[k] = (struct jp_point){JP_Q16(x), JP_Q16(y)};
    }
}

static void draw_start(struct task *t)
{
    t->start = (struct jp_point){JP_Q16(uniform(-9, 9)), JP_Q16(uniform(-9, 9))};
    t->heading = (jp_angle)random_bits();
    if (coin()) {
        t->before.motion = (struct jp_motion){JP_Q24(uniform(0, 1)), JP_Q24(uniform(-0.35, 0.35))};
    }
    for (int i = 0; t->has_horizon && i < JP_AXIS_MODES; i++) {
        t->before.transient.travel[i] = JP_Q16(uniform(-2, 2));
        t->before.transient.yaw[i] = JP_Q16(uniform(-0.5, 0.5));
    }
}

static struct task random_task(const struct kind *kind)
{
    struct task t = {
        .model = jp_energy_model_published,
        .limits = {JP_Q24(1), JP_Q24(0.35), JP_Q24(80 * PI / 180), JP_Q16(600)},
        .has_horizon = kind->has_horizon,
    };

    if (kind->has_horizon) {
        const struct robot *robot = &robots[random_bits() % (sizeof robots / sizeof robots[0])];
        t.model = *robot->model;
        t.horizon = *robot->horizon;
    }
    if (kind->random_limits) {
        t.limits = (struct jp_segment_limits){JP_Q24(log_uniform(0.1, 2)), JP_Q24(log_uniform(0.05, 2)),
                                              JP_Q24(uniform(0.3, PI)), JP_Q16(600)};
    }
    if (kind->random_robot) {
        randomise_robot(&t.model);
    }
    draw_start(&t);
    draw_targets(&t, kind->has_horizon ? 0.5 : 0.7, kind->has_horizon ? 8 : 30);
    return t;
}

static struct problem problem_of(const struct task *t, const struct jp_route_leg *legs)
{
    const jp_q16 least = t->has_horizon ? t->horizon.duration_min : t->model.settling_time;
    struct problem p = {.task = t,
                        .speed = q24(t->limits.speed),
                        .turn_rate = q24(t->limits.turn_rate),
                        .turn_max = q24(t->limits.turn),
                        .shortest = fmax(q16(least), q16(JP_SEGMENT_DURATION_MIN)),
                        .longest = q16(t->limits.duration)};
    const struct jp_point *from = &t->start;
    double direction = angle(t->heading);
    double arc_before = 0;

    for (unsigned k = 0; k < t->count; k++) {
        const double dx = q16(t->targets[k].x) - q16(from->x);
        const double dy = q16(t->targets[k].y) - q16(from->y);
        const double halves = (arc_before + q24(legs[k].segment.arc)) / 2;
        const double way_round = q24(legs[k].segment.command.turn) + halves - (atan2(dy, dx) - direction);

        p.chord[k] = hypot(dx, dy);
        p.turn[k] = atan2(dy, dx) - direction + 2 * PI * round(way_round / (2 * PI));
        direction = atan2(dy, dx);
        arc_before = q24(legs[k].segment.arc);
        from = &t->targets[k];
    }
    return p;
}

/* ---- Checks ---- */

static void start_plan(const struct task *t, struct jp_route *route, struct jp_route_leg *legs)
{
    const struct jp_route_config config = {.model = &t->model,
                                           .horizon = t->has_horizon ? &t->horizon : NULL,
                                           .limits = &t->limits,
                                           .yaw_bandwidth = t->yaw_bandwidth,
                                           .legs = legs,
                                           .leg_count = LEGS_MAX};
    const char *field;

    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_route_init(route, &config, &field));
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_route_start(route, &t->start, t->heading, &t->before, t->targets, t->count));
}

static void check_limits(const struct task *t, const struct jp_segment *segment)
{
    const struct jp_segment_command *command = &segment->command;
    const jp_q16 least = t->has_horizon ? t->horizon.duration_min : t->model.settling_time;

    TEST_ASSERT_TRUE(command->motion.speed >= 0 && command->motion.speed <= t->limits.speed);
    TEST_ASSERT_TRUE(abs(command->motion.turn_rate) <= t->limits.turn_rate);
    TEST_ASSERT_TRUE(abs(command->turn) <= t->limits.turn);
    TEST_ASSERT_TRUE(command->duration >= least && command->duration >= JP_SEGMENT_DURATION_MIN);
    TEST_ASSERT_TRUE(command->duration <= t->limits.duration);
    TEST_ASSERT_TRUE(abs(segment->arc) <= JP_ARC_ANGLE_MAX);
}

/* Distances from the targets after driving the stored commands, each from the target before, as a part of what the
 * header promises: the largest. */
static double landing(const struct task *t, const struct jp_route_leg *legs)
{
    const struct jp_point *from = &t->start;
    double heading = angle(t->heading);
    double worst = 0;

    for (unsigned k = 0; k < t->count; k++) {
        const struct jp_segment_command *command = &legs[k].segment.command;
        const double time = q16(command->duration);
        const double half = q24(command->motion.turn_rate) * time / 2;
        const double length = q24(command->motion.speed) * time;
        const double chord = fabs(half) < 1e-9 ? length : length * sin(half) / half;
        const double direction = heading + q24(command->turn) + half;
        const double x = q16(t->targets[k].x) - q16(from->x);
        const double y = q16(t->targets[k].y) - q16(from->y);
        const double distance = hypot(x, y);
        const double miss = hypot(chord * cos(direction) - x, chord * sin(direction) - y);

        worst = fmax(worst, miss / (1e-5 * distance + 1e-5 + time * 0x1p-24 * (1 + distance)));
        heading += q24(command->turn) + q24(legs[k].segment.arc);
        from = &t->targets[k];
    }
    return worst;
}

/* The chain's energies as jp_energy_forecast() gives them. */
static void check_energies(const struct task *t, const struct jp_route *route)
{
    struct jp_energy_start start = t->before;
    jp_q16 total = 0;

    for (unsigned k = 0; k < t->count; k++) {
        const struct jp_segment *segment = &route->config.legs[k].segment;
        jp_q16 energy;

        TEST_ASSERT_TRUE(jp_energy_forecast(&t->model, t->has_horizon ? &t->horizon : NULL, &start, &segment->command,
                                            &energy, &start) != JP_ERR_ARGUMENT);
        TEST_ASSERT_EQUAL_INT32(energy, segment->energy);
        total = jp_add(total, energy);
    }
    TEST_ASSERT_EQUAL_INT32(total, route->energy);
    TEST_ASSERT_TRUE(route->energy <= route->greedy_energy);
}

static bool is_greedy(const struct task *t, const struct jp_route_leg *legs)
{
    for (unsigned k = 0; k < t->count; k++) {
        if (memcmp(&legs[k].segment, &legs[k].internal.greedy, sizeof legs[k].segment) != 0) {
            return false;
        }
    }
    return true;
}

static void judge(struct kind *kind, const struct task *t, const struct jp_route *route)
{
    const struct jp_route_leg *legs = route->config.legs;
    const struct problem problem = problem_of(t, legs);
    struct way way;

    for (unsigned k = 0; k < t->count; k++) {
        check_limits(t, &legs[k].segment);
        way.arc[k] = q24(legs[k].segment.arc);
        way.time[k] = q16(legs[k].segment.command.duration);
    }
    check_energies(t, route);

    const double spent = price(&problem, &way);
    const double ratio = spent / search(&problem, &way);

    TEST_ASSERT_FALSE(isinf(spent));
    kind->planned++;
    kind->optimal += ratio <= kind->near;
    kind->greedy += is_greedy(t, legs);
    kind->worst_ratio = fmax(kind->worst_ratio, ratio);
    kind->worst_landing = fmax(kind->worst_landing, landing(t, legs));
}

static void run_kind(struct kind *kind)
{
    static struct jp_route_leg legs[LEGS_MAX];

    for (unsigned long i = 0; i < count; i++) {
        const struct task t = random_task(kind);
        struct jp_route route;
        enum jp_status status;

        start_plan(&t, &route, legs);
        do {
            status = jp_route_work(&route);
        } while (status == JP_WORKING);
        if (status == JP_OK) {
            judge(kind, &t, &route);
        } else {
            TEST_ASSERT_TRUE(status == JP_ERR_INFEASIBLE || (kind->random_robot && status == JP_ERR_MODEL));
        }
    }
    printf("%-16s %8lu %8lu %8lu %12.6f %10.3f\n", kind->name, kind->planned, kind->optimal, kind->greedy,
           kind->worst_ratio, kind->worst_landing);
    TEST_ASSERT_TRUE((double)kind->optimal >= kind->near_share * (double)kind->planned);
    TEST_ASSERT_TRUE(kind->worst_landing <= 1);
}

static void test_no_change_spends_less(void)
{
    random_state = seed;
    printf("%-16s %8s %8s %8s %12s %10s\n", "kind", "routes", "optimal", "greedy", "worst E/E", "landing");
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        run_kind(&kinds[i]);
    }
}

/* ---- Slices ---- */

/* Two plans whose slices alternate are those that each gives alone. */
static void test_plans_do_not_disturb_each_other(void)
{
    static struct jp_route_leg legs[2][LEGS_MAX];
    static struct jp_route_leg alone[LEGS_MAX];

    random_state = seed + 1;
    for (unsigned long i = 0; i < count; i++) {
        const struct task tasks[2] = {random_task(&kinds[0]), random_task(&kinds[3])};
        struct jp_route routes[2];
        enum jp_status status[2];

        for (int k = 0; k < 2; k++) {
            start_plan(&tasks[k], &routes[k], legs[k]);
        }
        do {
            status[0] = jp_route_work(&routes[0]);
            status[1] = jp_route_work(&routes[1]);
        } while (status[0] == JP_WORKING || status[1] == JP_WORKING);
        for (int k = 0; k < 2; k++) {
            struct jp_route route;

            start_plan(&tasks[k], &route, alone);
            while (jp_route_work(&route) == JP_WORKING) {
            }
            TEST_ASSERT_EQUAL_INT32(route.internal.status, status[k]);
            for (unsigned leg = 0; leg < tasks[k].count && status[k] == JP_OK; leg++) {
                TEST_ASSERT_EQUAL_MEMORY(&alone[leg].segment, &legs[k][leg].segment, sizeof alone[leg].segment);
            }
        }
    }
}

/* ---- Any model ---- */

static jp_q16 any(double size)
{
    return JP_Q16(coin() ? uniform(-size, size) : (coin() ? size : -size) * log_uniform(1e-6, 1));
}

static void draw_axis(struct jp_axis_modes *axis)
{
    axis->count = (uint32_t)(random_bits() % (JP_AXIS_MODES + 1));
    for (uint32_t i = 0; i < axis->count; i++) {
        axis->mode[i] = (struct jp_mode){JP_Q24(log_uniform(1e-6, 127)), 0};
    }
    for (uint32_t i = 0; i + 1 < axis->count; i += 2) {
        if (coin()) {
            axis->mode[i].frequency = JP_Q24(log_uniform(1e-6, 64));
            axis->mode[i + 1] = axis->mode[i];
        }
    }
    for (uint32_t i = 0; i < JP_AXIS_MODES * (JP_AXIS_MODES + 1) / 2; i++) {
        axis->storage[i] = (int32_t)random_bits();
    }
    for (uint32_t i = 0; i < JP_AXIS_MODES; i++) {
        axis->step[0][i] = any(511);
        axis->step[1][i] = any(511);
        axis->cross[0][i] = any(4095);
        axis->cross[1][i] = any(4095);
        axis->steady[i] = any(4095);
    }
}

static struct task any_task(void)
{
    struct task t = {.heading = (jp_angle)random_bits(), .has_horizon = coin()};
    const char *field = "";

    for (int k = 0; k < JP_ENERGY_TERMS; k++) {
        t.model.a[k] = coin() ? any(4095) : JP_Q16(log_uniform(0x1p-16, 4096));
    }
    t.model.b[0] = coin() ? JP_Q16(4096) : JP_Q16(log_uniform(0x1p-16, 4096));
    t.model.b[1] = JP_Q16(log_uniform(0x1p-16, 4096));
    t.model.electronics_power = JP_Q16(log_uniform(0x1p-16, 256));
    t.model.settling_time = coin() ? JP_Q16(uniform(0, 60)) : 0;
    t.model.voltage_per_speed = JP_Q16(log_uniform(0x1p-16, 256));
    t.model.voltage_per_turn_rate = JP_Q16(log_uniform(0x1p-16, 256));
    t.model.motor_resistance = JP_Q16(log_uniform(0x1p-16, 256));
    t.limits =
        (struct jp_segment_limits){JP_Q24(log_uniform(0x1p-20, 8)), JP_Q24(log_uniform(0x1p-20, 8)),
                                   coin() ? JP_Q24(uniform(0, PI)) : JP_Q24(PI), JP_Q16(log_uniform(60.1, 16384))};
    t.yaw_bandwidth = coin() ? JP_Q16(log_uniform(0.1, 100)) : 0;
    t.horizon.duration_min = JP_Q16(log_uniform(0x1p-16, 60));
    draw_axis(&t.horizon.travel);
    draw_axis(&t.horizon.yaw);
    t.before.motion = (struct jp_motion){JP_Q24(uniform(-8, 8)), JP_Q24(uniform(-8, 8))};
    for (int i = 0; i < JP_AXIS_MODES; i++) {
        t.before.transient.travel[i] = any(4095);
        t.before.transient.yaw[i] = any(4095);
    }
    draw_targets(&t, 0.001, coin() ? 500 : 5);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_model_check(&t.model, &field));
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_horizon_check(&t.horizon, &field));
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_segment_limits_check(&t.limits, &t.model, &field));
    return t;
}

static void check_numbers(const struct jp_route_leg *leg)
{
    TEST_ASSERT_TRUE(isfinite(leg->internal.arc) && isfinite(leg->internal.pace));
    TEST_ASSERT_TRUE(isfinite(leg->internal.v) && isfinite(leg->internal.w) && isfinite(leg->internal.sigma));
}

/* Any model, horizon and limits within their ranges: no undefined behaviour, a defined status, numbers that are
 * numbers, every limit met. */
static void test_any_model_is_safe(void)
{
    static struct jp_route_leg legs[LEGS_MAX];
    unsigned long planned = 0;

    random_state = seed + 2;
    for (unsigned long i = 0; i < 40 * count; i++) {
        const struct task t = any_task();
        struct jp_route route;
        enum jp_status status;

        start_plan(&t, &route, legs);
        do {
            status = jp_route_work(&route);
            for (unsigned k = 0; k < t.count && route.internal.iterations > 0; k++) {
                check_numbers(&legs[k]);
            }
        } while (status == JP_WORKING);
        if (status != JP_OK) {
            TEST_ASSERT_TRUE(status == JP_ERR_INFEASIBLE || status == JP_ERR_MODEL || status == JP_ERR_ZERO_LENGTH ||
                             status == JP_ERR_ARGUMENT || status == JP_ERR_OVERFLOW);
            continue;
        }
        planned++;
        for (unsigned k = 0; k < t.count; k++) {
            check_limits(&t, &legs[k].segment);
        }
        check_energies(&t, &route);
    }
    printf("any model: %lu of %lu routes planned\n", planned, 40 * count);
    TEST_ASSERT_TRUE(planned > count);
}

int main(int argc, char **argv)
{
    const struct options options = parse_options(argc, argv, (struct options){.count = count, .seed = 1});

    count = options.count;
    seed = options.seed;
    printf("seed %llu\n", (unsigned long long)seed);
    UNITY_BEGIN();
    run_tests();
    return UNITY_END();
}
