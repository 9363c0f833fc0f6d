#include "sim/missions/bezier.h"

#include <math.h>
#include <nlopt.h>
#include <string.h>

#include "sim/balancer/plant.h"
#include "sim/base/strict_math.h"

/** Samples of a curve for its energy. */
#define SAMPLES 48

/** Start values: a speed near the optimum of the paper's robot, and how far the optimiser may go. */
#define SPEED_FIRST      0.5
#define DURATION_STRETCH 4.0
#define SPEED_MIN        1e-3

/** rad/s: any that the robot takes, as for the turn at the start of a segment. Half of it, as samples miss peaks. */
#define TURN_RATE_MAX 4.0

/** Slower than this, m/s, is at rest: the direction is that of the acceleration. */
#define SPEED_REST 1e-9

/* Waypoints nearer than this are one, m. */
#define SAME_PLACE 1e-6

#define TOLERANCE       1e-7
#define EVALUATIONS_MAX 60000

/** Per J of planned energy and relative excess of a limit. */
#define PENALTY 1e3

/** Which curves are optimised together. */
struct problem {
    const struct robot_file *robot;
    struct plant_constants constants;
    enum energy_kind energy;
    struct bezier_path path;
    size_t first;
    size_t count;
    bool free_start; /**< the first curve may start at any speed along heading 0; else from rest */
};

static double norm(struct bezier_point p)
{
    return strict_hypot(p.x, p.y);
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

    if (speed < SPEED_REST) {
        return (struct bezier_motion){0, 0, strict_atan2(second.y, second.x)};
    }
    return (struct bezier_motion){speed, (first.x * second.y - first.y * second.x) / (speed * speed),
                                  strict_atan2(first.y, first.x)};
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
    /* The motors' energy in the paper is that of motors at rest. */
    double back_emf = problem->energy == ENERGY_BATTERY ? c->volts_per_rate : 0;
    double common_drop = common - back_emf * speed / c->wheel_radius;
    double difference_drop = difference - back_emf * c->half_track * turn_rate;

    return 2 * (common * common_drop + difference * difference_drop) / c->resistance +
           problem->robot->electronics.power_w;
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
        sum += PENALTY * (excess(speed, problem->robot->limits.speed_m_s) + excess(turn_rate, TURN_RATE_MAX));
        before = now;
    }
    return sum;
}

/** Unknowns: for each curve its duration and the velocity at its end; last, the speed at the start if it is free. */
static size_t unknowns(const struct problem *problem)
{
    return 3 * problem->count + (problem->free_start ? 1 : 0);
}

static void unpack(struct problem *problem, const double *x)
{
    struct bezier_path *path = &problem->path;

    for (size_t i = 0; i < problem->count; i++) {
        path->duration[problem->first + i] = x[3 * i];
        path->velocity[problem->first + i + 1] = (struct bezier_point){x[3 * i + 1], x[3 * i + 2]};
    }
    if (problem->free_start) {
        path->velocity[0] = (struct bezier_point){x[3 * problem->count], 0};
    }
}

static double path_cost(unsigned n, const double *x, double *gradient, void *data)
{
    struct problem *problem = data;
    double sum = 0;

    (void)n;
    (void)gradient;
    unpack(problem, x);
    for (size_t i = 0; i < problem->count; i++) {
        sum += curve_cost(problem, problem->first + i);
    }
    return sum;
}

/** From the waypoint before to the one after; there and back the robot turns across. */
static struct bezier_point direction(const struct bezier_point *waypoint, size_t after)
{
    const struct bezier_point across = minus(waypoint[after], waypoint[0]);
    const struct bezier_point chord = minus(waypoint[1], waypoint[0]);

    return norm(across) > SAME_PLACE ? across : (struct bezier_point){-chord.y, chord.x};
}

/** One speed, and at each waypoint the direction from the one before it to the one after it, as far as it is known. */
static void first_guess(const struct problem *problem, double *x, double *low, double *high)
{
    const struct bezier_point *waypoint = &problem->path.waypoint[problem->first];
    double top = problem->robot->limits.speed_m_s;
    double speed = fmin(SPEED_FIRST, 0.5 * top);

    for (size_t i = 0; i < problem->count; i++) {
        double chord = norm(minus(waypoint[i + 1], waypoint[i]));
        struct bezier_point across = direction(&waypoint[i], i + 1 < problem->count ? 2 : 1);
        size_t k = 3 * i;

        x[k] = chord / speed;
        x[k + 1] = speed * across.x / norm(across);
        x[k + 2] = speed * across.y / norm(across);
        low[k] = chord / top;
        high[k] = DURATION_STRETCH * x[k];
        low[k + 1] = low[k + 2] = -top;
        high[k + 1] = high[k + 2] = top;
    }
    if (problem->free_start) {
        size_t k = 3 * problem->count;

        x[k] = 0.5 * speed;
        low[k] = SPEED_MIN;
        high[k] = top;
    }
}

static bool optimise(struct problem *problem)
{
    double x[1 + 3 * BEZIER_WAYPOINTS_MAX];
    double low[1 + 3 * BEZIER_WAYPOINTS_MAX];
    double high[1 + 3 * BEZIER_WAYPOINTS_MAX];
    double energy;
    nlopt_opt optimiser = nlopt_create(NLOPT_LN_SBPLX, (unsigned)unknowns(problem));

    first_guess(problem, x, low, high);
    (void)nlopt_set_min_objective(optimiser, path_cost, problem);
    (void)nlopt_set_lower_bounds(optimiser, low);
    (void)nlopt_set_upper_bounds(optimiser, high);
    (void)nlopt_set_ftol_rel(optimiser, TOLERANCE);
    (void)nlopt_set_maxeval(optimiser, EVALUATIONS_MAX);

    nlopt_result result = nlopt_optimize(optimiser, x, &energy);

    nlopt_destroy(optimiser);
    if (result < 0 || !isfinite(energy)) {
        return false;
    }
    unpack(problem, x);
    return true;
}

bool bezier_optimise(struct bezier_path *path, const struct robot_file *robot, enum energy_kind energy,
                     const struct bezier_point *waypoints, size_t count, enum bezier_scope scope)
{
    struct problem problem = {.robot = robot, .energy = energy, .path = {.curves = count - 1}};
    size_t together = scope == BEZIER_ROUTE ? problem.path.curves : 1;
    struct plant plant;

    plant_init(&plant, robot);
    problem.constants = plant.constants;
    problem.count = together;
    problem.free_start = scope == BEZIER_ROUTE;
    memcpy(problem.path.waypoint, waypoints, count * sizeof *waypoints);
    for (problem.first = 0; problem.first < problem.path.curves; problem.first += together) {
        if (!optimise(&problem)) {
            return false;
        }
    }
    *path = problem.path;
    return true;
}
