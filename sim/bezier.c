#include "bezier.h"

#include <math.h>
#include <nlopt.h>
#include <string.h>

#include "error.h"
#include "plant.h"

/** Samples of a curve for its energy. */
#define SAMPLES 48

/** Start values: a speed near the optimum of the paper's robot, and how far the optimiser may go. */
#define SPEED_FIRST      0.5
#define DURATION_STRETCH 4.0

#define TOLERANCE       1e-7
#define EVALUATIONS_MAX 60000

/** Per J of planned energy and relative excess of a limit. */
#define PENALTY 1e3

struct problem {
    const struct robot_file *robot;
    struct plant_constants constants;
    struct bezier_path path;
};

static double norm(struct bezier_point p)
{
    return hypot(p.x, p.y);
}

static struct bezier_point minus(struct bezier_point a, struct bezier_point b)
{
    return (struct bezier_point){a.x - b.x, a.y - b.y};
}

/** First and second derivative in time of the curve with these ends: Bézier in Hermite's form. */
static void derivatives(const struct bezier_path *path, size_t curve, double seconds, struct bezier_point *first,
                        struct bezier_point *second)
{
    double T = path->duration[curve];
    double s = seconds / T;
    struct bezier_point d = minus(path->waypoint[curve + 1], path->waypoint[curve]);
    struct bezier_point v0 = path->velocity[curve];
    struct bezier_point v1 = path->velocity[curve + 1];
    double chord = 6 * s * (1 - s) / T;
    double start = 1 - 4 * s + 3 * s * s;
    double end = 3 * s * s - 2 * s;

    first->x = chord * d.x + start * v0.x + end * v1.x;
    first->y = chord * d.y + start * v0.y + end * v1.y;
    chord = 6 * (1 - 2 * s) / (T * T);
    start = (6 * s - 4) / T;
    end = (6 * s - 2) / T;
    second->x = chord * d.x + start * v0.x + end * v1.x;
    second->y = chord * d.y + start * v0.y + end * v1.y;
}

struct bezier_motion bezier_motion(const struct bezier_path *path, size_t curve, double seconds)
{
    struct bezier_point first;
    struct bezier_point second;

    derivatives(path, curve, seconds, &first, &second);

    double speed = norm(first);
    double turn_rate = speed > 1e-9 ? (first.x * second.y - first.y * second.x) / (speed * speed) : 0;

    return (struct bezier_motion){speed, turn_rate, atan2(first.y, first.x)};
}

/** Motor and electronics power of a motion with its accelerations, W. */
static double power(const struct problem *problem, double speed, double acceleration, double turn_rate,
                    double turn_acceleration)
{
    const struct plant_constants *c = &problem->constants;
    double alpha = c->torque_per_ampere / c->resistance;
    double drag = alpha * c->volts_per_rate + c->motor_friction + c->ground_friction;
    double common = (drag * speed + 0.5 * c->wheel_inertia * acceleration) / (alpha * c->wheel_radius);
    double difference =
        (0.5 * c->yaw_inertia * turn_acceleration / c->half_track + c->half_track * drag * turn_rate) / alpha;

    return 2 * (common * common + difference * difference) / c->resistance + problem->robot->electronics.power_w;
}

static double excess(double value, double limit)
{
    return fmax(fabs(value) / limit - 1, 0);
}

static double curve_cost(const struct problem *problem, size_t curve)
{
    double duration = problem->path.duration[curve];
    double dt = duration / SAMPLES;
    double sum = 0;
    struct bezier_motion before = bezier_motion(&problem->path, curve, 0);

    for (int k = 1; k <= SAMPLES; k++) {
        struct bezier_motion now = bezier_motion(&problem->path, curve, k * dt);
        double speed = 0.5 * (before.speed + now.speed);
        double turn_rate = 0.5 * (before.turn_rate + now.turn_rate);

        sum += dt * power(problem, speed, (now.speed - before.speed) / dt, turn_rate,
                          (now.turn_rate - before.turn_rate) / dt);
        sum += PENALTY * (excess(speed, problem->robot->limits.speed_m_s) +
                          excess(turn_rate, problem->robot->limits.turn_rate_rad_s));
        before = now;
    }
    return sum;
}

/** Unknowns: speed at the start, then for each curve its duration and the velocity at its end. */
static void unpack(struct bezier_path *path, const double *x)
{
    path->velocity[0] = (struct bezier_point){x[0], 0};
    for (size_t i = 0; i < path->curves; i++) {
        path->duration[i] = x[1 + 3 * i];
        path->velocity[i + 1] = (struct bezier_point){x[2 + 3 * i], x[3 + 3 * i]};
    }
}

static double path_cost(unsigned n, const double *x, double *gradient, void *data)
{
    struct problem *problem = data;
    double sum = 0;

    (void)n;
    (void)gradient;
    unpack(&problem->path, x);
    for (size_t i = 0; i < problem->path.curves; i++) {
        sum += curve_cost(problem, i);
    }
    return sum;
}

/** Straight chords at one speed, turning at each waypoint toward the next one but one. */
static void first_guess(const struct problem *problem, double *x, double *low, double *high)
{
    const struct bezier_path *path = &problem->path;
    double top = problem->robot->limits.speed_m_s;
    double speed = fmin(SPEED_FIRST, 0.5 * top);

    x[0] = 0.5 * speed;
    low[0] = 1e-3;
    high[0] = top;
    for (size_t i = 0; i < path->curves; i++) {
        struct bezier_point chord = minus(path->waypoint[i + 1], path->waypoint[i]);
        size_t next = i + 2 <= path->curves ? i + 2 : i + 1;
        struct bezier_point across = minus(path->waypoint[next], path->waypoint[i]);
        double duration = norm(chord) / speed;
        double *p = &x[1 + 3 * i];

        p[0] = duration;
        p[1] = speed * across.x / norm(across);
        p[2] = speed * across.y / norm(across);
        low[1 + 3 * i] = norm(chord) / top;
        high[1 + 3 * i] = DURATION_STRETCH * duration;
        low[2 + 3 * i] = low[3 + 3 * i] = -top;
        high[2 + 3 * i] = high[3 + 3 * i] = top;
    }
}

bool bezier_optimise(struct bezier_path *path, const struct robot_file *robot, const struct bezier_point *waypoints,
                     size_t count)
{
    struct problem problem = {.robot = robot, .path = {.curves = count - 1}};
    double x[1 + 3 * BEZIER_WAYPOINTS_MAX];
    double low[1 + 3 * BEZIER_WAYPOINTS_MAX];
    double high[1 + 3 * BEZIER_WAYPOINTS_MAX];
    struct plant plant;

    plant_init(&plant, robot);
    problem.constants = plant.constants;
    memcpy(problem.path.waypoint, waypoints, count * sizeof *waypoints);
    first_guess(&problem, x, low, high);

    nlopt_opt optimiser = nlopt_create(NLOPT_LN_SBPLX, (unsigned)(1 + 3 * problem.path.curves));

    (void)nlopt_set_min_objective(optimiser, path_cost, &problem);
    (void)nlopt_set_lower_bounds(optimiser, low);
    (void)nlopt_set_upper_bounds(optimiser, high);
    (void)nlopt_set_ftol_rel(optimiser, TOLERANCE);
    (void)nlopt_set_maxeval(optimiser, EVALUATIONS_MAX);

    nlopt_result result = nlopt_optimize(optimiser, x, &problem.path.energy);

    nlopt_destroy(optimiser);
    if (result < 0) {
        error_line("Bézier baseline: the optimiser failed (%d); move the waypoints apart", (int)result);
        return false;
    }
    unpack(&problem.path, x);
    *path = problem.path;
    return true;
}
