/** The energy of a route in double precision, written anew from the paper, for property tests of the optimiser. */
#ifndef JOULEPATH_TESTS_SUPPORT_ROUTE_ORACLE_H
#define JOULEPATH_TESTS_SUPPORT_ROUTE_ORACLE_H

#include <joulepath/route.h>
#include <math.h>
#include <stdbool.h>

#define PI      3.14159265358979323846
#define ARC_MAX (1.8 * PI)

#define LEGS_MAX 8

/** One problem in fixed point. */
struct task {
    struct jp_energy_model model;
    struct jp_horizon horizon;
    bool has_horizon;
    jp_q16 yaw_bandwidth;
    struct jp_segment_limits limits;
    struct jp_point start;
    jp_angle heading;
    struct jp_energy_start before;
    uint16_t count;
    struct jp_point targets[LEGS_MAX];
};

/** A plan in double: γ and T of each leg. */
struct way {
    double arc[LEGS_MAX];
    double time[LEGS_MAX];
};

/** The same problem in double. */
struct problem {
    const struct task *task;
    double chord[LEGS_MAX];
    double turn[LEGS_MAX]; /* from chord to chord, with the ways round of the plan */
    double speed, turn_rate, turn_max, shortest, longest;
};

static inline double q16(jp_q16 a)
{
    return a * 0x1p-16;
}

static inline double q24(jp_q24 a)
{
    return a * 0x1p-24;
}

static inline double angle(jp_angle a)
{
    return (int32_t)a * (PI * 0x1p-31);
}

struct motion {
    double v, w, turn, time;
};

/** Eq. 19, for any T. */
static inline double settled_energy(const struct jp_energy_model *m, double v0, double w0, const struct motion *next)
{
    const double step[3] = {next->v - v0, next->w - w0, next->turn};
    const double left = q16(m->voltage_per_speed) * v0 - q16(m->voltage_per_turn_rate) * w0;
    const double right = q16(m->voltage_per_speed) * v0 + q16(m->voltage_per_turn_rate) * w0;
    const double products[JP_ENERGY_TERMS] = {step[0] * step[0],
                                              step[1] * step[1],
                                              step[2] * step[2],
                                              step[0] * step[1],
                                              step[0] * step[2],
                                              step[1] * step[2],
                                              left * step[0],
                                              left * step[1],
                                              left * step[2],
                                              right * step[0],
                                              right * step[1],
                                              right * step[2],
                                              (left * left + right * right) / q16(m->motor_resistance)};
    double sum = q16(m->electronics_power) * next->time;

    for (int i = 0; i < JP_ENERGY_TERMS; i++) {
        sum += q16(m->a[i]) * products[i];
    }
    return sum +
           (q16(m->b[0]) * next->v * next->v + q16(m->b[1]) * next->w * next->w) * (next->time - q16(m->settling_time));
}

/** S(m, v). */
static inline double stored(const struct jp_axis_modes *axis, const double *modes, double speed)
{
    const int32_t *storage = axis->storage;
    double sum = 0;

    for (uint32_t i = 0; i < axis->count; i++) {
        sum += speed * q16(axis->steady[i]) * modes[i];
        for (uint32_t k = i; k < axis->count; k++) {
            sum += *storage++ * 0x1p-28 * modes[i] * modes[k];
        }
    }
    return sum;
}

static inline double crossed(const struct jp_axis_modes *axis, const double *modes, const double step[2])
{
    double sum = 0;

    for (uint32_t i = 0; i < axis->count; i++) {
        sum += (step[0] * q16(axis->cross[0][i]) + step[1] * q16(axis->cross[1][i])) * modes[i];
    }
    return sum;
}

static inline void move_modes(const struct jp_axis_modes *axis, double *modes, const double step[2], double time)
{
    for (uint32_t i = 0; i < axis->count; i++) {
        modes[i] += step[0] * q16(axis->step[0][i]) + step[1] * q16(axis->step[1][i]);
        modes[i] *= exp2(-q24(axis->mode[i].decay) * time);
    }
    for (uint32_t i = 0; i < axis->count; i++) {
        if (axis->mode[i].frequency != 0) {
            const double turned = 2 * PI * q24(axis->mode[i].frequency) * time;
            const double first = modes[i];
            modes[i] = first * cos(turned) - modes[i + 1] * sin(turned);
            modes[i + 1] = first * sin(turned) + modes[i + 1] * cos(turned);
            i++;
        }
    }
}

/** What an axis spends beside the settled energy; moves its modes. */
static inline double unsettled_energy(const struct jp_axis_modes *axis, double *modes, double speed,
                                      const double step[2], double time)
{
    const double before = stored(axis, modes, speed) + crossed(axis, modes, step);

    move_modes(axis, modes, step, time);
    return before - stored(axis, modes, speed);
}

/** Of a row of motions; what the last step costs is counted until it is settled. */
static inline double energy_of(const struct task *task, const struct motion *motions)
{
    double v0 = q24(task->before.motion.speed);
    double w0 = q24(task->before.motion.turn_rate);
    double travel[JP_AXIS_MODES];
    double yaw[JP_AXIS_MODES];
    double sum = 0;

    for (int i = 0; i < JP_AXIS_MODES; i++) {
        travel[i] = q16(task->before.transient.travel[i]);
        yaw[i] = q16(task->before.transient.yaw[i]);
    }
    for (unsigned k = 0; k < task->count; k++) {
        const struct motion *next = &motions[k];

        sum += settled_energy(&task->model, v0, w0, next);
        if (task->has_horizon) {
            const double travel_step[2] = {next->v - v0, 0};
            const double yaw_step[2] = {next->w - w0, next->turn};
            sum += unsettled_energy(&task->horizon.travel, travel, next->v, travel_step, next->time);
            sum += unsettled_energy(&task->horizon.yaw, yaw, next->w, yaw_step, next->time);
        }
        v0 = next->v;
        w0 = next->w;
    }
    if (task->has_horizon) {
        sum += stored(&task->horizon.travel, travel, v0) + stored(&task->horizon.yaw, yaw, w0);
    }
    return sum;
}

#endif
