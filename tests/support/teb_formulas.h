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

static inline double exact_step_cost(const struct jp_teb_config *config, const struct exact_step *step)
{
    const struct jp_teb_weights *const weights = &config->weights;
    const double reference = (double)config->interval;
    const double turn = exact_magnitude(step->turn);
    const double speed = exact_above(step->length, (double)config->speed_max * step->interval) / reference;
    const double reverse = exact_above(-step->length, (double)config->reverse_max * step->interval) / reference;
    const double turn_rate = exact_above(turn, (double)config->turn_rate_max * step->interval) / reference;
    const double slowness =
        exact_above((double)config->speed_max * step->interval, step->length) / (double)config->speed_max;
    const double radius = exact_above((double)config->radius_min * turn, exact_magnitude(step->length)) / reference;

    return (double)weights->nonholonomic * exact_square(step->side) +
           (double)weights->speed * (exact_square(speed) + exact_square(reverse)) +
           (double)weights->turn_rate * exact_square(turn_rate) + (double)weights->turn_radius * exact_square(radius) +
           (double)weights->time * exact_square(step->interval) + (double)weights->slowness * exact_square(slowness) +
           (double)weights->no_reversing * exact_square(exact_above(-step->length, 0.0) / reference);
}

static inline double exact_change_cost(const struct jp_teb_config *config, double forward, double turn, double duration)
{
    return (double)config->weights.acceleration *
               exact_square(exact_above(exact_magnitude(forward) / duration, (double)config->acceleration)) +
           (double)config->weights.turn_acceleration *
               exact_square(exact_above(exact_magnitude(turn) / duration, (double)config->turn_acceleration));
}

static inline double exact_steps_cost(const struct jp_teb *teb, const struct exact_pose *poses)
{
    const struct jp_teb_config *const config = &teb->config;
    const struct jp_teb_task *const task = &teb->internal.task;
    struct exact_step last = exact_step(&poses[0], &poses[1]);
    double cost = exact_step_cost(config, &last) +
                  exact_change_cost(config, last.length / last.interval - (double)task->speed.forward,
                                    last.turn / last.interval - (double)task->speed.turn_rate, last.interval);

    for (unsigned i = 1; i + 1U < teb->count; i++) {
        const struct exact_step step = exact_step(&poses[i], &poses[i + 1U]);

        cost += exact_step_cost(config, &step) +
                exact_change_cost(config, step.length / step.interval - last.length / last.interval,
                                  step.turn / step.interval - last.turn / last.interval,
                                  (last.interval + step.interval) / 2.0);
        last = step;
    }
    return cost + exact_change_cost(config, (double)task->goal_speed - last.length / last.interval, 0.0, last.interval);
}

/** Of the pose i alone; obstacles by their distance in single precision. */
static inline double exact_pose_cost(const struct jp_teb *teb, unsigned i, const struct exact_pose *exact)
{
    const struct jp_teb_config *const config = &teb->config;
    const struct jp_teb_foot *const foot = &teb->internal.feet[i];
    const double aside = (exact->x - (double)foot->point.x) * (double)foot->normal.x +
                         (exact->y - (double)foot->point.y) * (double)foot->normal.y;
    double cost = (double)config->weights.path * exact_square(aside);

    for (unsigned k = 0; k < teb->internal.near[i].count; k++) {
        const struct jp_obstacle *const shape = &teb->internal.obstacles->shapes[teb->internal.near[i].shape[k]];
        const double time = (double)teb->internal.near[i].time;
        /* Nearer by its way is as if the robot had gone the other way. */
        const struct jp_plane_pose pose = {(float)(exact->x - time * (double)shape->velocity.x),
                                           (float)(exact->y - time * (double)shape->velocity.y), (float)exact->heading};
        const float distance = jp_obstacle_distance(&config->footprint, &pose, shape, NULL);

        cost +=
            (double)config->weights.obstacle * exact_square(exact_above((double)config->clearance, (double)distance));
    }
    return cost;
}

static inline double exact_sighting_cost(const struct exact_pose *pose, const struct jp_plane_pose *seen)
{
    return exact_square(pose->x - (double)seen->x) + exact_square(pose->y - (double)seen->y) +
           exact_square(exact_wrap(pose->heading - (double)seen->heading));
}

/** Of a band with as many poses as the TEB's, with its task, feet and neighbours. */
static inline double exact_cost(const struct jp_teb *teb, const struct exact_pose *poses)
{
    const struct jp_teb_weights *const weights = &teb->config.weights;
    double cost = exact_steps_cost(teb, poses);

    for (unsigned i = 1; i + 1U < teb->count; i++) {
        cost += exact_pose_cost(teb, i, &poses[i]);
    }
    if (weights->laser_odometry > 0.0f && teb->internal.task.is_measured) {
        cost += (double)weights->wheel_odometry * exact_sighting_cost(&poses[0], &teb->internal.task.start) +
                (double)weights->laser_odometry * exact_sighting_cost(&poses[0], &teb->internal.task.measured);
    }
    return cost / 2.0;
}

#endif
