/** A plain particle filter on the map (Thrun, Burgard, Fox: Probabilistic Robotics, 2005: odometry motion model,
 *  likelihood field, low-variance resampling), in double: what the localiser is measured against. */
#ifndef JOULEPATH_TESTS_BENCH_PARTICLE_FILTER_H
#define JOULEPATH_TESTS_BENCH_PARTICLE_FILTER_H

#include <math.h>

#include "src/local/wall_field.h"
#include "tests/support/localiser_drive.h"

enum { PARTICLES = 500, PARTICLE_BEAMS = 60 };

struct particle_filter {
    const struct jp_wall_field *field;
    struct random random;
    struct planar_pose poses[PARTICLES];
    struct planar_pose spare[PARTICLES];
    double weights[PARTICLES];
    struct planar_pose wheels;
    struct planar_pose pose; /* mean */
};

static inline void particle_mean(struct particle_filter *filter)
{
    double x = 0;
    double y = 0;
    double c = 0;
    double s = 0;

    for (int i = 0; i < PARTICLES; i++) {
        x += filter->weights[i] * filter->poses[i].x;
        y += filter->weights[i] * filter->poses[i].y;
        c += filter->weights[i] * cos(filter->poses[i].heading);
        s += filter->weights[i] * sin(filter->poses[i].heading);
    }
    filter->pose = (struct planar_pose){x, y, atan2(s, c)};
}

static inline void particle_begin(struct particle_filter *filter, const struct jp_wall_field *field,
                                  const struct planar_pose *pose, const struct planar_pose *wheels, uint64_t seed)
{
    filter->field = field;
    filter->wheels = *wheels;
    random_init(&filter->random, seed);
    for (int i = 0; i < PARTICLES; i++) {
        filter->poses[i] = (struct planar_pose){pose->x + random_gaussian(&filter->random, 0.1),
                                                pose->y + random_gaussian(&filter->random, 0.1),
                                                pose->heading + random_gaussian(&filter->random, 0.05)};
        filter->weights[i] = 1.0 / PARTICLES;
    }
    particle_mean(filter);
}

static inline void particle_move(struct particle_filter *filter, const struct planar_pose *wheels)
{
    const struct planar_pose motion = planar_between(&filter->wheels, wheels);
    const double way = hypot(motion.x, motion.y);
    const double turn = fabs(motion.heading);

    filter->wheels = *wheels;
    for (int i = 0; i < PARTICLES; i++) {
        const struct planar_pose moved = {motion.x + random_gaussian(&filter->random, 0.1 * way + 0.002),
                                          motion.y + random_gaussian(&filter->random, 0.1 * way + 0.002),
                                          motion.heading +
                                              random_gaussian(&filter->random, 0.1 * turn + 0.02 * way + 0.002)};

        filter->poses[i] = planar_compose(&filter->poses[i], &moved);
    }
}

/* Log-likelihood by the distances of the beams' ends, tempered since beams are not independent. */
static inline double particle_score(const struct particle_filter *filter, const struct planar_pose *pose,
                                    const struct laser_scan *scan)
{
    double score = 0;

    for (int i = 0; i < scan->beams; i += scan->beams / PARTICLE_BEAMS) {
        const double range = (double)scan->ranges[i];
        const double bearing = pose->heading + scan->first + i * scan->step;
        struct jp_wall_distance wall;

        if (range > 0) {
            const struct jp_plane_point end = {(float)(pose->x + range * cos(bearing)),
                                               (float)(pose->y + range * sin(bearing))};
            const bool is_near = jp_wall_field_find(filter->field, end, &wall);
            const double off = is_near ? (double)wall.distance / 0.05 : 10;

            score += log(0.8 * exp(-0.5 * off * off) + 0.2 * 0.05) / 4;
        }
    }
    return score;
}

static inline void particle_resample(struct particle_filter *filter)
{
    double at = random_uniform(&filter->random, 0, 1.0 / PARTICLES);
    double sum = filter->weights[0];
    int from = 0;

    for (int i = 0; i < PARTICLES; i++) {
        while (sum < at && from < PARTICLES - 1) {
            sum += filter->weights[++from];
        }
        filter->spare[i] = filter->poses[from];
        at += 1.0 / PARTICLES;
    }
    for (int i = 0; i < PARTICLES; i++) {
        filter->poses[i] = filter->spare[i];
        filter->weights[i] = 1.0 / PARTICLES;
    }
}

static inline void particle_correct(struct particle_filter *filter, const struct laser_scan *scan)
{
    double best = -INFINITY;
    double sum = 0;
    double squares = 0;

    for (int i = 0; i < PARTICLES; i++) {
        filter->weights[i] = log(filter->weights[i]) + particle_score(filter, &filter->poses[i], scan);
        best = fmax(best, filter->weights[i]);
    }
    for (int i = 0; i < PARTICLES; i++) {
        filter->weights[i] = exp(filter->weights[i] - best);
        sum += filter->weights[i];
    }
    for (int i = 0; i < PARTICLES; i++) {
        filter->weights[i] /= sum;
        squares += filter->weights[i] * filter->weights[i];
    }
    particle_mean(filter);
    if (1 / squares < 0.5 * PARTICLES) {
        particle_resample(filter);
    }
}

#endif
