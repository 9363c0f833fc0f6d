/*
 * joulepath/horizon.h in chains of random segments: the tables of the robots against the same formula in double; random
 * robots, from whose modes the test makes a table, against their voltages and currents tick by tick; and any table at
 * all for robustness.
 *
 * prop_horizon [--count N] [--seed S] [--json FILE]
 * --count is the number of chains of each kind; 1000 for the full check.
 */
#include <joulepath/horizon.h>
#include <joulepath/tables.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/decimal.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "unity.h"

#define PI 3.14159265358979323846

/* Stated in joulepath/horizon.h: of the robots here, and of others. */
#define ROBOTS_ERROR_J 0.002
#define ERROR_J        0.01
#define ERROR_SHARE    1e-4

#define DURATION_MIN 0.5
#define STOPS        0.2   /* share of the segments */
#define TICK         0.001 /* s */

enum { SEGMENTS = 40, MODES_MAX = JP_AXIS_MODES + 2, DOUBLINGS = 30 };

extern const struct jp_energy_model jp_energy_model_gao2018, jp_energy_model_courier24;
extern const struct jp_energy_model jp_energy_model_gao2018_battery, jp_energy_model_courier24_battery;
extern const struct jp_horizon jp_horizon_gao2018, jp_horizon_courier24;
extern const struct jp_horizon jp_horizon_gao2018_battery, jp_horizon_courier24_battery;

static const struct robot {
    const char *name;
    const struct jp_energy_model *model;
    const struct jp_horizon *horizon;
} robots[] = {
    {"gao2018", &jp_energy_model_gao2018, &jp_horizon_gao2018},
    {"gao2018, battery", &jp_energy_model_gao2018_battery, &jp_horizon_gao2018_battery},
    {"courier24", &jp_energy_model_courier24, &jp_horizon_courier24},
    {"courier24, battery", &jp_energy_model_courier24_battery, &jp_horizon_courier24_battery},
};

static struct options options = {.count = 100, .seed = 1};
static double worst_error;

void setUp(void)
{
}

void tearDown(void)
{
}

/** Durations are whole ticks as well as they can be. */
static struct jp_segment_command random_segment(void)
{
    const double seconds = round(uniform(DURATION_MIN, 10) / TICK) * TICK;
    return (struct jp_segment_command){
        {to_q24(uniform(-1, 1)), to_q24(uniform(-1, 1))}, to_q24(uniform(-1.4, 1.4)), to_q16(seconds) + 1};
}

/* ---- The settled formula in double ---- */

static double settled(const struct jp_energy_model *model, const struct jp_motion *before,
                      const struct jp_segment_command *segment)
{
    const double v0 = q24(before->speed);
    const double w0 = q24(before->turn_rate);
    const double v = q24(segment->motion.speed);
    const double w = q24(segment->motion.turn_rate);
    const double s = q24(segment->turn);
    const double dv = v - v0;
    const double dw = w - w0;
    const double left = q16(model->voltage_per_speed) * v0 - q16(model->voltage_per_turn_rate) * w0;
    const double right = q16(model->voltage_per_speed) * v0 + q16(model->voltage_per_turn_rate) * w0;
    const double terms[JP_ENERGY_TERMS] = {dv * dv,
                                           dw * dw,
                                           s * s,
                                           dv * dw,
                                           dv * s,
                                           dw * s,
                                           left * dv,
                                           left * dw,
                                           left * s,
                                           right * dv,
                                           right * dw,
                                           right * s,
                                           (left * left + right * right) / q16(model->motor_resistance)};
    const double line = q16(segment->duration) - q16(model->settling_time);
    double energy = (q16(model->b[0]) * v * v + q16(model->b[1]) * w * w) * line +
                    q16(model->electronics_power) * q16(segment->duration);
    for (int i = 0; i < JP_ENERGY_TERMS; i++) {
        energy += q16(model->a[i]) * terms[i];
    }
    return energy;
}

/* ---- A table in double ---- */

static double stored(const struct jp_axis_modes *axis, const double *modes, double speed)
{
    const int32_t *p = axis->storage;
    double energy = 0;
    for (uint32_t i = 0; i < axis->count; i++) {
        energy += q16(axis->steady[i]) * speed * modes[i];
        for (uint32_t k = i; k < axis->count; k++) {
            energy += *p++ / 268435456.0 * modes[i] * modes[k];
        }
    }
    return energy;
}

/** What an axis spends beside its settled energy; `modes` go on to the segment's end. */
static double drive_table(const struct jp_axis_modes *axis, double *modes, double speed, const double step[2],
                          double seconds)
{
    double energy = stored(axis, modes, speed);
    for (uint32_t i = 0; i < axis->count; i++) {
        energy += (q16(axis->cross[0][i]) * step[0] + q16(axis->cross[1][i]) * step[1]) * modes[i];
    }
    double passed_on = 0;
    for (uint32_t i = 0; i < axis->count; i++) {
        const double begun = modes[i] + q16(axis->step[0][i]) * step[0] + q16(axis->step[1][i]) * step[1];
        const double share = exp2(-q24(axis->mode[i].decay) * seconds);
        modes[i] = share * begun + passed_on;
        if (axis->passed[i] != 0) {
            passed_on += (share - exp2(-q24(axis->mode[i + 1].decay) * seconds)) * begun;
        }
        passed_on *= q16(axis->passed[i]);
    }
    for (uint32_t i = 0; i < axis->count; i++) {
        if (axis->mode[i].frequency != 0) {
            const double angle = 2 * PI * q24(axis->mode[i].frequency) * seconds;
            const double first = modes[i];
            modes[i] = first * cos(angle) - modes[i + 1] * sin(angle);
            modes[i + 1] = first * sin(angle) + modes[i + 1] * cos(angle);
            i++;
        }
    }
    return energy - stored(axis, modes, speed);
}

/** A robot in double. Its modes are never brought back to those of the library. */
struct drive {
    const struct robot *robot;
    struct jp_motion motion;
    double travel[JP_AXIS_MODES];
    double yaw[JP_AXIS_MODES];
    double direction; /**< of the last speed that was not 0 */
    double rested;    /**< s at speed 0 since */
};

/** What a motion takes that is commanded for so long, J. */
static double steady_on(struct drive *drive, const struct jp_segment_command *segment)
{
    const double v = q24(segment->motion.speed);
    const double w = q24(segment->motion.turn_rate);
    const double seconds = q16(segment->duration);
    const double travel_step[2] = {v - q24(drive->motion.speed), 0};
    const double yaw_step[2] = {w - q24(drive->motion.turn_rate), q24(segment->turn)};
    const double energy = settled(drive->robot->model, &drive->motion, segment) +
                          drive_table(&drive->robot->horizon->travel, drive->travel, v, travel_step, seconds) +
                          drive_table(&drive->robot->horizon->yaw, drive->yaw, w, yaw_step, seconds);

    drive->motion = segment->motion;
    drive->rested = v != 0 ? 0 : drive->rested + seconds;
    drive->direction = v != 0 ? v : drive->direction;
    return energy;
}

/** The other direction waits until the robot has rested long enough. */
static double take(struct drive *drive, struct jp_segment_command segment)
{
    const double missing = q16(drive->robot->horizon->reversal_rest) - drive->rested;
    double energy = 0;

    if (q24(segment.motion.speed) * drive->direction < 0 && missing > 0) {
        struct jp_segment_command resting = segment;

        resting.motion.speed = 0;
        resting.duration = to_q16(fmin(missing, q16(segment.duration)));
        energy = steady_on(drive, &resting);
        segment.turn = 0;
        segment.duration -= resting.duration;
    }
    return segment.duration > 0 ? energy + steady_on(drive, &segment) : energy;
}

/** The worst segment of a chain, J. */
static double worst_of_chain(const struct robot *robot)
{
    struct jp_energy_start start = {.motion = {0, 0}};
    struct drive drive = {.robot = robot};
    double worst = 0;

    for (int i = 0; i < SEGMENTS; i++) {
        struct jp_segment_command segment = random_segment();
        jp_q16 energy;

        segment.motion.speed = uniform(0, 1) < STOPS ? 0 : segment.motion.speed;
        TEST_ASSERT_EQUAL_INT32(JP_OK,
                                jp_energy_forecast(robot->model, robot->horizon, &start, &segment, &energy, &start));
        worst = fmax(worst, fabs(q16(energy) - take(&drive, segment)));
    }
    return worst;
}

static void test_forecasts_are_the_formula(void)
{
    begin_random(options.seed, 0);
    for (size_t i = 0; i < sizeof robots / sizeof robots[0]; i++) {
        double worst = 0;
        for (unsigned long k = 0; k < options.count; k++) {
            worst = fmax(worst, worst_of_chain(&robots[i]));
        }
        printf("%-20s worst error %.2e J\n", robots[i].name, worst);
        worst_error = fmax(worst_error, worst);
    }
    TEST_ASSERT_TRUE(worst_error <= ROBOTS_ERROR_J);
}

/* ---- Random robots, tick by tick ---- */

/* One axis of a linear robot: voltage per + Σ of the modes' first components, current likewise. Modes beyond `lasting`
 * are gone within DURATION_MIN and not in the table. */
struct linear_axis {
    int modes;
    int lasting;
    double decay[MODES_MAX]; /* 1/s */
    double frequency[MODES_MAX];
    double voltage[MODES_MAX]; /* 1, or 0 for the second of a pair */
    double current[MODES_MAX]; /* A/V */
    double step[2][MODES_MAX];
    bool passed[MODES_MAX]; /* on to the next, in the table */
    double unit[MODES_MAX]; /* of the table, V */
    double volts;           /* of steady motion, a unit of speed */
    double amperes;
    double form[MODES_MAX][MODES_MAX]; /* P */
    double linear[MODES_MAX];          /* h */
};

static double mode_of_tick(const struct linear_axis *axis, int row, int column)
{
    const double left = exp(-axis->decay[row] * TICK);
    if (row == column) {
        return left * cos(axis->frequency[row] * TICK);
    }
    const bool paired = axis->frequency[row] != 0 && axis->frequency[row] == axis->frequency[column];
    return paired ? (row > column ? 1 : -1) * left * sin(axis->frequency[row] * TICK) : 0;
}

static void multiply(int n, double product[MODES_MAX][MODES_MAX], double a[MODES_MAX][MODES_MAX],
                     double b[MODES_MAX][MODES_MAX])
{
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < n; k++) {
            product[i][k] = 0;
            for (int l = 0; l < n; l++) {
                product[i][k] += a[i][l] * b[l][k];
            }
        }
    }
}

/* Sums over ticks by doubling: of n and of 2 n. */
static void store(struct linear_axis *axis)
{
    double power[MODES_MAX][MODES_MAX];
    double next[MODES_MAX][MODES_MAX];
    const int n = axis->modes;
    for (int i = 0; i < n; i++) {
        axis->linear[i] = 2 * TICK * (axis->voltage[i] * axis->amperes + axis->current[i] * axis->volts);
        for (int k = 0; k < n; k++) {
            power[i][k] = mode_of_tick(axis, i, k);
            axis->form[i][k] = TICK * (axis->voltage[i] * axis->current[k] + axis->voltage[k] * axis->current[i]);
        }
    }
    for (int doubling = 0; doubling < DOUBLINGS; doubling++) {
        double later[MODES_MAX] = {0};
        for (int i = 0; i < n; i++) {
            for (int k = 0; k < n; k++) {
                later[i] += axis->linear[k] * power[k][i];
            }
        }
        for (int i = 0; i < n; i++) {
            axis->linear[i] += later[i];
        }
        multiply(n, next, axis->form, power);
        for (int i = 0; i < n; i++) {
            for (int k = 0; k < n; k++) {
                for (int l = 0; l < n; l++) {
                    axis->form[i][k] += power[l][i] * next[l][k];
                }
            }
        }
        multiply(n, next, power, power);
        memcpy(power, next, sizeof power);
    }
}

static void add_mode(struct linear_axis *axis, double decay, double frequency, bool first)
{
    const int i = axis->modes++;
    axis->decay[i] = decay;
    axis->frequency[i] = frequency;
    axis->voltage[i] = first ? 1 : 0;
    axis->current[i] = uniform(-0.3, 0.3);
    axis->step[0][i] = uniform(-12, 12);
    axis->step[1][i] = uniform(-12, 12);
    axis->unit[i] = 1;
}

static void add_random(struct linear_axis *axis, double slowest, double fastest, int modes)
{
    while (modes > 0) {
        const double decay = exp(uniform(log(slowest), log(fastest)));
        /* Apart from every other frequency, so that each pair is one. */
        const double frequency = modes > 1 && (random_word() & 1) != 0 ? uniform(0.1, 5) : 0;
        add_mode(axis, decay, frequency, true);
        if (frequency != 0) {
            add_mode(axis, decay, frequency, false);
        }
        modes -= frequency != 0 ? 2 : 1;
    }
}

/* Some real modes of the table in sums, and in other units. */
static void sum_some(struct linear_axis *axis)
{
    for (int i = 0; i < axis->lasting; i++) {
        axis->unit[i] = axis->frequency[i] == 0 ? exp2(-(double)(random_word() % 3U)) : 1;
        axis->passed[i] =
            i + 1 < axis->lasting && axis->frequency[i] == 0 && axis->frequency[i + 1] == 0 && random_word() % 4U != 0;
    }
}

static struct linear_axis random_axis(void)
{
    struct linear_axis axis = {.volts = uniform(1, 8), .amperes = uniform(0.1, 1)};
    add_random(&axis, 0.3, 8, (int)(random_word() % (JP_AXIS_MODES + 1)));
    axis.lasting = axis.modes;
    sum_some(&axis);
    add_random(&axis, 40, 150, MODES_MAX - JP_AXIS_MODES);
    store(&axis);
    return axis;
}

/* What a mode of the table adds to a number that the modes add up to: a mode that is passed on takes the next one's
 * away. */
static double of_sum(const struct linear_axis *axis, const double *of_mode, int i)
{
    return axis->unit[i] * (of_mode[i] - (axis->passed[i] ? of_mode[i + 1] : 0));
}

static double form_of_sums(const struct linear_axis *axis, int i, int k)
{
    double row[MODES_MAX] = {0};
    for (int l = 0; l < axis->lasting; l++) {
        row[l] = of_sum(axis, axis->form[l], k);
    }
    return of_sum(axis, row, i);
}

static void make_table(const struct linear_axis *axis, struct jp_axis_modes *table)
{
    int32_t *storage = table->storage;
    *table = (struct jp_axis_modes){.count = (uint32_t)axis->lasting};
    for (int s = 0; s < 2; s++) {
        double cross[MODES_MAX] = {0};
        double step = 0;
        for (int i = 0; i < axis->lasting; i++) {
            for (int k = 0; k < axis->modes; k++) {
                cross[i] += 2 * axis->form[i][k] * axis->step[s][k];
            }
        }
        for (int i = 0; i < axis->lasting; i++) {
            step = axis->step[s][i] + (i > 0 && axis->passed[i - 1] ? step : 0);
            table->step[s][i] = to_q16(step / axis->unit[i]);
            table->cross[s][i] = to_q16(of_sum(axis, cross, i));
        }
    }
    for (int i = 0; i < axis->lasting; i++) {
        table->mode[i].decay = to_q24(axis->decay[i] / log(2));
        table->mode[i].frequency = to_q24(axis->frequency[i] / (2 * PI));
        table->passed[i] = axis->passed[i] ? to_q16(axis->unit[i] / axis->unit[i + 1]) : 0;
        table->steady[i] = to_q16(of_sum(axis, axis->linear, i));
        for (int k = i; k < axis->lasting; k++) {
            *storage++ = (int32_t)lround((k > i ? 2 : 1) * form_of_sums(axis, i, k) * 268435456.0);
        }
    }
}

/* aᵀ P b */
static double product(const struct linear_axis *axis, const double *a, const double *b)
{
    double sum = 0;
    for (int i = 0; i < axis->modes; i++) {
        for (int k = 0; k < axis->modes; k++) {
            sum += a[i] * axis->form[i][k] * b[k];
        }
    }
    return sum;
}

static double linear(const struct linear_axis *axis, const double *a)
{
    double sum = 0;
    for (int i = 0; i < axis->modes; i++) {
        sum += axis->linear[i] * a[i];
    }
    return sum;
}

/* Energy of steps from settled motion. With cv² = b1, cw² = b2 and Rm = 2 it is P₋ = b1 v₋² + b2 w₋², and what the
 * friction in v² = (v₋ + Δv)² has before Ts goes to a1, a7, a10 and a13; likewise for w. */
static struct jp_energy_model make_model(const struct linear_axis *travel, const struct linear_axis *yaw)
{
    const double b1 = 2 * travel->volts * travel->amperes;
    const double b2 = 2 * yaw->volts * yaw->amperes;
    const double ts = 3;
    /* Of v₋ Δv, w₋ Δw and w₋ σ each motor has a half. */
    const double speed = (linear(travel, travel->step[0]) + 2 * b1 * ts) / 2 / sqrt(b1);
    const double turn_rate = (linear(yaw, yaw->step[0]) + 2 * b2 * ts) / 2 / sqrt(b2);
    const double turn = linear(yaw, yaw->step[1]) / 2 / sqrt(b2);
    const double a[JP_ENERGY_TERMS] = {
        product(travel, travel->step[0], travel->step[0]) + linear(travel, travel->step[0]) + b1 * ts,
        product(yaw, yaw->step[0], yaw->step[0]) + linear(yaw, yaw->step[0]) + b2 * ts,
        product(yaw, yaw->step[1], yaw->step[1]),
        0,
        0,
        2 * product(yaw, yaw->step[0], yaw->step[1]) + linear(yaw, yaw->step[1]),
        speed,
        -turn_rate,
        -turn,
        speed,
        turn_rate,
        turn,
        ts,
    };
    struct jp_energy_model model = {.b = {to_q16(b1), to_q16(b2)},
                                    .electronics_power = JP_Q16(5),
                                    .settling_time = to_q16(ts),
                                    .voltage_per_speed = to_q16(sqrt(b1)),
                                    .voltage_per_turn_rate = to_q16(sqrt(b2)),
                                    .motor_resistance = JP_Q16(2)};
    for (int i = 0; i < JP_ENERGY_TERMS; i++) {
        model.a[i] = to_q16(a[i]);
    }
    return model;
}

/** The axis' energy in these ticks, one after the other; both motors. */
static double drive_ticks(const struct linear_axis *axis, double *modes, double speed, long ticks)
{
    double energy = 0;
    for (long tick = 0; tick < ticks; tick++) {
        double volts = axis->volts * speed;
        double amperes = axis->amperes * speed;
        double next[MODES_MAX];
        for (int i = 0; i < axis->modes; i++) {
            volts += axis->voltage[i] * modes[i];
            amperes += axis->current[i] * modes[i];
        }
        for (int i = 0; i < axis->modes; i++) {
            next[i] = mode_of_tick(axis, i, i) * modes[i];
            if (axis->frequency[i] != 0) {
                const int other = axis->voltage[i] != 0 ? i + 1 : i - 1;
                next[i] += mode_of_tick(axis, i, other) * modes[other];
            }
        }
        memcpy(modes, next, sizeof next);
        energy += 2 * TICK * volts * amperes;
    }
    return energy;
}

static void step(const struct linear_axis *axis, double *modes, double first, double second)
{
    for (int i = 0; i < axis->modes; i++) {
        modes[i] += axis->step[0][i] * first + axis->step[1][i] * second;
    }
}

/** The worst segment of a chain, as a share of the bar. */
static double worst_of_ticks(const struct linear_axis *travel, const struct linear_axis *yaw)
{
    const struct jp_energy_model model = make_model(travel, yaw);
    struct jp_horizon horizon = {.duration_min = JP_Q16(DURATION_MIN)};
    struct jp_energy_start start = {.motion = {0, 0}};
    double travel_modes[MODES_MAX] = {0};
    double yaw_modes[MODES_MAX] = {0};
    const char *field = "";
    double worst = 0;
    make_table(travel, &horizon.travel);
    make_table(yaw, &horizon.yaw);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_horizon_check(&horizon, &field));
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_model_check(&model, &field));
    for (int i = 0; i < SEGMENTS / 4; i++) {
        const struct jp_motion before = start.motion;
        const struct jp_segment_command segment = random_segment();
        const double v = q24(segment.motion.speed);
        const double w = q24(segment.motion.turn_rate);
        const long ticks = lround(q16(segment.duration) / TICK);
        step(travel, travel_modes, v - q24(before.speed), 0);
        step(yaw, yaw_modes, w - q24(before.turn_rate), q24(segment.turn));
        const double exact = drive_ticks(travel, travel_modes, v, ticks) + drive_ticks(yaw, yaw_modes, w, ticks) +
                             5 * TICK * (double)ticks;
        jp_q16 energy;
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_forecast(&model, &horizon, &start, &segment, &energy, &start));
        worst = fmax(worst, fabs(q16(energy) - exact) / (ERROR_J + ERROR_SHARE * fabs(exact)));
    }
    return worst;
}

static void test_forecasts_are_the_energy_of_all_ticks(void)
{
    double worst = 0;
    begin_random(options.seed, 1);
    for (unsigned long k = 0; k < options.count; k++) {
        const struct linear_axis travel = random_axis();
        const struct linear_axis yaw = random_axis();
        worst = fmax(worst, worst_of_ticks(&travel, &yaw));
    }
    printf("%-20s worst error %.4f of the bar\n", "random robots", worst);
    TEST_ASSERT_TRUE(worst <= 1);
}

/* ---- Regressors ---- */

static void test_weighted_regressors_are_the_forecast(void)
{
    begin_random(options.seed, 2);
    for (unsigned long k = 0; k < 10 * options.count; k++) {
        const struct robot *robot = &robots[k % (sizeof robots / sizeof robots[0])];
        struct jp_energy_start start = {.motion = {0, 0}};
        for (int i = 0; i < 4; i++) {
            const struct jp_segment_command segment = random_segment();
            jp_q16 regressor[JP_ENERGY_PARAMETERS];
            jp_q16 rest;
            jp_q16 energy;
            TEST_ASSERT_EQUAL_INT32(
                JP_OK, jp_energy_regressors(robot->model, robot->horizon, &start, &segment, regressor, &rest));
            TEST_ASSERT_EQUAL_INT32(
                JP_OK, jp_energy_forecast(robot->model, robot->horizon, &start, &segment, &energy, &start));
            double sum = q16(rest);
            double bar = 0.001;
            for (int p = 0; p < JP_ENERGY_TERMS; p++) {
                sum += q16(robot->model->a[p]) * q16(regressor[p]);
                bar += fabs(q16(robot->model->a[p])) / 131072;
            }
            for (int p = 0; p < 2; p++) {
                sum += q16(robot->model->b[p]) * q16(regressor[JP_ENERGY_TERMS + p]);
                bar += fabs(q16(robot->model->b[p])) / 131072;
            }
            TEST_ASSERT_TRUE(fabs(sum - q16(energy)) <= bar);
        }
    }
}

/* ---- Any table ---- */

static int32_t any(int32_t limit)
{
    switch (random_word() % 4) {
    case 0:
        return limit;
    case 1:
        return -limit;
    case 2:
        return 0;
    default:
        return (int32_t)((((int64_t)random_word() * limit) >> 31) - limit);
    }
}

static void draw_any_axis(struct jp_axis_modes *axis)
{
    *axis = (struct jp_axis_modes){.count = random_word() % (JP_AXIS_MODES + 1)};
    for (uint32_t i = 0; i < JP_AXIS_MODES; i++) {
        axis->mode[i] = (struct jp_mode){1 + (int32_t)(random_word() >> (1 + random_word() % 30)), 0};
        axis->steady[i] = any(JP_Q16(4096));
        for (int s = 0; s < 2; s++) {
            axis->step[s][i] = any(JP_Q16(512));
            axis->cross[s][i] = any(JP_Q16(4096));
        }
    }
    for (uint32_t i = 0; i + 1 < axis->count; i++) {
        if ((random_word() & 1) != 0) {
            axis->mode[i].frequency = 1 + (int32_t)(random_word() >> (2 + random_word() % 30));
            axis->mode[i + 1] = axis->mode[i];
            i++;
        } else if (i > 0 && axis->mode[i - 1].frequency == 0) {
            axis->passed[i - 1] = any(JP_Q16(2048)) + JP_Q16(2048);
        }
    }
    for (int i = 0; i < JP_AXIS_MODES * (JP_AXIS_MODES + 1) / 2; i++) {
        axis->storage[i] = any(INT32_MAX);
    }
}

static bool within(const jp_q16 *modes)
{
    for (int i = 0; i < JP_AXIS_MODES; i++) {
        if (modes[i] < -JP_Q16(4096) || modes[i] > JP_Q16(4096)) {
            return false;
        }
    }
    return true;
}

/* No undefined behaviour, a defined status, and an end that the next segment can begin with. */
static void test_any_table_is_safe(void)
{
    begin_random(options.seed, 3);
    for (unsigned long k = 0; k < 200 * options.count; k++) {
        struct jp_horizon horizon = {.duration_min = 1 + (int32_t)(random_word() % (uint32_t)JP_Q16(60)),
                                     .reversal_rest = (int32_t)(random_word() % (uint32_t)JP_Q16(1000))};
        struct jp_energy_start start = {.motion = {any(JP_Q24(8)), any(JP_Q24(8))},
                                        .reversal_rest = (int32_t)(random_word() % (uint32_t)JP_Q16(1000)),
                                        .is_forward = random_word() % 2U == 0};
        const char *field = "";
        draw_any_axis(&horizon.travel);
        draw_any_axis(&horizon.yaw);
        for (int i = 0; i < JP_AXIS_MODES; i++) {
            start.transient.travel[i] = any(JP_Q16(4096));
            start.transient.yaw[i] = any(JP_Q16(4096));
        }
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_horizon_check(&horizon, &field));
        for (int i = 0; i < 3; i++) {
            const struct jp_segment_command segment = {
                {any(JP_Q24(8)), any(JP_Q24(8))}, any(JP_Q24(6.283)), JP_Q16(60) + (int32_t)(random_word() >> 3)};
            jp_q16 regressor[JP_ENERGY_PARAMETERS];
            jp_q16 rest;
            jp_q16 energy;
            enum jp_status status =
                jp_energy_regressors(&jp_energy_model_gao2018, &horizon, &start, &segment, regressor, &rest);
            TEST_ASSERT_TRUE(status == JP_OK || status == JP_ERR_OVERFLOW);
            status = jp_energy_forecast(&jp_energy_model_gao2018, &horizon, &start, &segment, &energy, &start);
            TEST_ASSERT_TRUE(status == JP_OK || status == JP_ERR_OVERFLOW);
            TEST_ASSERT_TRUE(within(start.transient.travel) && within(start.transient.yaw));
            TEST_ASSERT_TRUE(start.reversal_rest >= 0 && start.reversal_rest <= JP_Q16(1000));
        }
    }
}

static void add_figures(json_t *figures)
{
    figures_add(figures, "make figures", worst_error, "J", at_most(ROBOTS_ERROR_J),
                "jp_energy_forecast() against double, worst error of %lu segments", 4 * SEGMENTS * options.count);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, add_figures);
}
