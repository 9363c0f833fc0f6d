/** What the residuals of joulepath/teb.h cost, in double and from its formulas alone. */
#ifndef JOULEPATH_TESTS_SUPPORT_TEB_FORMULAS_H
#define JOULEPATH_TESTS_SUPPORT_TEB_FORMULAS_H

#include <joulepath/teb.h>

#define EXACT_PI 3.14159265358979323846

struct exact_pose {
    double x;
    double y;
    double heading;
    double interval; /**< to the next, s */
    double cosine;
    double sine;
};

/** From a pose to the next. */
struct exact_step {
    double length;
    double turn;
    double interval;
    double side; /**< twice the way that a robot which cannot slide would not go */
};

static inline double exact_square(double x)
{
    return x * x;
}

static inline double exact_above(double value, double limit)
{
    return value > limit ? value - limit : 0.0;
}

/** By Newton's method, from above, for targets without a library of mathematics; 0 or more. */
static inline double exact_root(double square)
{
    double root = square > 1.0 ? square : 1.0;

    for (unsigned i = 0; i < 64U; i++) {
        const double next = 0.5 * (root + square / root);

        if (next >= root) {
            break;
        }
        root = next;
    }
    return root;
}

static inline double exact_magnitude(double x)
{
    return x < 0.0 ? -x : x;
}

/** Of angles within ±3π. */
static inline double exact_wrap(double angle)
{
    return angle > EXACT_PI ? angle - 2.0 * EXACT_PI : angle < -EXACT_PI ? angle + 2.0 * EXACT_PI : angle;
}

static inline struct exact_step exact_step(const struct exact_pose *a, const struct exact_pose *b)
{
    const double dx = b->x - a->x;
    const double dy = b->y - a->y;
    const double c = a->cosine + b->cosine;
    const double s = a->sine + b->sine;

    return (struct exact_step){(c * dx + s * dy) / 2.0, exact_wrap(b->heading - a->heading), a->interval,
                               c * dy - s * dx};
}

/** A weighted residual; 0 where its limit is kept. */
struct exact_residual {
    double weight;
    double value;
};

enum { EXACT_RESIDUALS_MAX = 16 * JP_TEB_POSES_MAX };

/** All residuals of a band, whether they act or not, in an order that depends on the number of poses alone. */
struct exact_residuals {
    struct exact_residual all[EXACT_RESIDUALS_MAX];
    unsigned count;
};

static inline void exact_add(struct exact_residuals *residuals, float weight, double value)
{
    residuals->all[residuals->count++] = (struct exact_residual){(double)weight, value};
}

static inline void exact_add_step(struct exact_residuals *residuals, const struct jp_teb_config *config,
                                  const struct exact_step *step)
{
    const struct jp_teb_weights *const weights = &config->weights;
    const double reference = (double)config->interval;
    const double turn = exact_magnitude(step->turn);
    const double limit = (double)config->speed_max * step->interval;

    exact_add(residuals, weights->nonholonomic, step->side);
    exact_add(residuals, weights->speed, exact_above(step->length, limit) / reference);
    exact_add(residuals, weights->speed,
              exact_above(-step->length, (double)config->reverse_max * step->interval) / reference);
    exact_add(residuals, weights->no_reversing, exact_above(-step->length, 0.0) / reference);
    exact_add(residuals, weights->turn_rate,
              exact_above(turn, (double)config->turn_rate_max * step->interval) / reference);
    exact_add(residuals, weights->turn_radius,
              exact_above((double)config->radius_min * turn, exact_magnitude(step->length)) / reference);
    exact_add(residuals, weights->second, exact_root(2.0 * step->interval));
    exact_add(residuals, weights->metre, exact_root(2.0 * exact_root(exact_square(step->length) + 1.0e-4)));
    exact_add(residuals, weights->drag, step->length * exact_root(2.0 / step->interval));
}

static inline void exact_add_change(struct exact_residuals *residuals, const struct jp_teb_config *config,
                                    double forward, double turn, double duration)
{
    exact_add(residuals, config->weights.acceleration,
              exact_above(exact_magnitude(forward) / duration, (double)config->acceleration));
    exact_add(residuals, config->weights.turn_acceleration,
              exact_above(exact_magnitude(turn) / duration, (double)config->turn_acceleration));
}

static inline void exact_add_steps(struct exact_residuals *residuals, const struct jp_teb *teb,
                                   const struct exact_pose *poses)
{
    const struct jp_teb_config *const config = &teb->config;
    const struct jp_teb_task *const task = &teb->internal.task;
    struct exact_step last = exact_step(&poses[0], &poses[1]);

    exact_add_step(residuals, config, &last);
    exact_add_change(residuals, config, last.length / last.interval - (double)task->speed.forward,
                     last.turn / last.interval - (double)task->speed.turn_rate, last.interval);
    for (unsigned i = 1; i + 1U < teb->count; i++) {
        const struct exact_step step = exact_step(&poses[i], &poses[i + 1U]);

        exact_add_step(residuals, config, &step);
        exact_add_change(residuals, config, step.length / step.interval - last.length / last.interval,
                         step.turn / step.interval - last.turn / last.interval, (last.interval + step.interval) / 2.0);
        last = step;
    }
    exact_add_change(residuals, config, (double)task->goal_speed - last.length / last.interval, 0.0, last.interval);
}

/** Of the pose i alone; obstacles by their distance in single precision. */
static inline void exact_add_pose(struct exact_residuals *residuals, const struct jp_teb *teb, unsigned i,
                                  const struct exact_pose *exact)
{
    const struct jp_teb_config *const config = &teb->config;
    const struct jp_teb_foot *const foot = &teb->internal.feet[i];

    exact_add(residuals, config->weights.path,
              (exact->x - (double)foot->point.x) * (double)foot->normal.x +
                  (exact->y - (double)foot->point.y) * (double)foot->normal.y);
    for (unsigned k = 0; k < teb->internal.near[i].count; k++) {
        const struct jp_obstacle *const shape = &teb->internal.obstacles->shapes[teb->internal.near[i].shape[k]];
        const double time = (double)teb->internal.near[i].time;
        /* Nearer by its way is as if the robot had gone the other way. */
        const struct jp_plane_pose pose = {(float)(exact->x - time * (double)shape->velocity.x),
                                           (float)(exact->y - time * (double)shape->velocity.y), (float)exact->heading};
        const float distance = jp_obstacle_distance(&config->footprint, &pose, shape, NULL);

        exact_add(residuals, config->weights.obstacle, exact_above((double)config->clearance, (double)distance));
    }
}

static inline void exact_add_sighting(struct exact_residuals *residuals, float weight, const struct exact_pose *pose,
                                      const struct jp_plane_pose *seen)
{
    exact_add(residuals, weight, pose->x - (double)seen->x);
    exact_add(residuals, weight, pose->y - (double)seen->y);
    exact_add(residuals, weight, exact_wrap(pose->heading - (double)seen->heading));
}

/** Of a band with as many poses as the TEB's, with its task, feet and neighbours. */
static inline void exact_residuals(const struct jp_teb *teb, const struct exact_pose *poses,
                                   struct exact_residuals *residuals)
{
    const struct jp_teb_weights *const weights = &teb->config.weights;

    residuals->count = 0;
    exact_add_steps(residuals, teb, poses);
    for (unsigned i = 1; i + 1U < teb->count; i++) {
        exact_add_pose(residuals, teb, i, &poses[i]);
    }
    if (weights->laser_odometry > 0.0f && teb->internal.task.is_measured) {
        exact_add_sighting(residuals, weights->wheel_odometry, &poses[0], &teb->internal.task.start);
        exact_add_sighting(residuals, weights->laser_odometry, &poses[0], &teb->internal.task.measured);
    }
}

static inline double exact_cost(const struct jp_teb *teb, const struct exact_pose *poses)
{
    static struct exact_residuals residuals;
    double cost = 0.0;

    exact_residuals(teb, poses, &residuals);
    for (unsigned i = 0; i < residuals.count; i++) {
        cost += residuals.all[i].weight * exact_square(residuals.all[i].value) / 2.0;
    }
    return cost;
}

#endif
