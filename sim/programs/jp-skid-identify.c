/* Drives a skid-steered or differential-drive robot through designed and random motions, and robots like it over hills;
 * tools/design/skid_identify.py fits the energy model to what they take. */
#include <math.h>
#include <stdlib.h>

#include "sim/base/command_line.h"
#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/base/parallel.h"
#include "sim/skid_steer/skid_drive.h"
#include "sim/skid_steer/skid_hills.h"

#define HOLD_SECONDS   5.0
#define SETTLE_SECONDS 5.0 /* with the ramp */
#define CHECK_SECONDS  2.0
#define BACK_SECONDS   6.0 /* for the way back from where a turn on the spot has slid to */

#define CORNER_SECONDS 2.0 /* of the lines before and after an arc */

/* Of a robot: routes of so many legs, or until it drives on, each from where it is, as a pilot plans them. */
#define ROBOT_ROUTES 3
#define ROUTE_LEGS   10

#define DESIGNED_MAX 128
#define COUNT_MAX    100000

enum { OPTION_ROBOTS = COMMAND_LINE_OWN };

/* Rows of one phase are summed up before they are fitted. Those of a robot are its legs, after so many a route. */
enum { PHASE_UP, PHASE_HOLD, PHASE_DOWN, PHASE_CHECK, PHASES_OF_ROUTE = 100 };

struct arguments {
    struct command_line common;
    size_t count;
    size_t robots;
};

/* A motion on a plane that rises in a direction. */
struct motion {
    double speed;
    double turn_rate;
    double slope_deg;
    double slope_heading;
    double corner; /* what it turns by between two lines, rad, or 0 */
};

struct identification {
    const struct arguments *arguments;
    struct skid_steer_model model;
    struct motion motions[DESIGNED_MAX + COUNT_MAX]; /* first the designed ones */
    size_t designed;
};

/* What becomes of a run. */
struct result {
    char *rows;
    size_t size;
    bool is_sound;
};

/* A run. */
struct run {
    const struct identification *of;
    size_t number;
    struct skid_drive drive;
    struct skid_route route;
    FILE *stream;
};

/* Runs of one kind. */
struct runs {
    const struct identification *of;
    void (*drive)(struct run *run);
    struct result *results;
    size_t count;
};

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case 'n':
        arguments->count = (size_t)command_line_whole(state, "--count", argument, 1, COUNT_MAX);
        return 0;
    case OPTION_ROBOTS:
        arguments->robots = (size_t)command_line_whole(state, "--robots", argument, 1, COUNT_MAX);
        return 0;
    case ARGP_KEY_ARG:
        command_line_take_robot(state, argument, &arguments->common);
        return 0;
    case ARGP_KEY_NO_ARGS:
        command_line_refuse(state, "a robot is needed, such as zhang2018");
    default:
        return command_line_option(key, argument, state, &arguments->common);
    }
}

/* ---- Motions ---- */

/* A bend of a radius in half tracks at a share of what the treads may do, to alternating sides. */
static struct motion bend(const struct identification *of, double radius, double share)
{
    const double half = skid_half_track(&of->model);
    const double rate = share * skid_tread_speed_max(&of->model) / (half * (radius + 1));

    return (struct motion){.speed = rate * radius * half, .turn_rate = of->designed % 2 == 0 ? rate : -rate};
}

static void add(struct identification *of, struct motion motion, double slope_deg, double slope_heading)
{
    motion.slope_deg = slope_deg;
    motion.slope_heading = slope_heading;
    of->motions[of->designed++] = motion;
}

static void add_straights(struct identification *of)
{
    for (int slope = -3; slope <= 3; slope++) {
        for (int step = 1; step <= 4; step++) {
            const struct motion motion = {.speed = skid_tread_speed_max(&of->model) * step / 4};
            add(of, motion, of->model.limits.slope_deg * slope / 3, 0);
        }
    }
}

static void add_bends(struct identification *of)
{
    static const double radii[] = {0, 0.5, 1.5, 2.5, 4, 8, 16};
    static const double shares[] = {0.35, 0.7, 1};

    for (size_t i = 0; i < sizeof radii / sizeof radii[0]; i++) {
        for (size_t j = 0; j < sizeof shares / sizeof shares[0]; j++) {
            add(of, bend(of, radii[i], shares[j]), 0, 0);
        }
    }
}

/* Corners as a pilot rounds them: arcs at the most that it may. */
static void add_corners(struct identification *of)
{
    static const double radii[] = {1, 1.5, 2.5, 4}; /* in half tracks */

    for (size_t i = 0; i < sizeof radii / sizeof radii[0]; i++) {
        for (int eighths = 1; eighths <= 2; eighths++) {
            const double radius = radii[i] * skid_half_track(&of->model);
            const double rate = fmin(of->model.lattice.turn_rate_rad_s, of->model.lattice.speed_m_s / radius);
            const struct motion motion = {.speed = rate * radius, .turn_rate = rate, .corner = eighths * M_PI / 4};
            add(of, motion, 0, 0);
        }
    }
}

static void add_bends_on_slopes(struct identification *of)
{
    static const double radii[] = {0, 1.5, 4};

    for (size_t i = 0; i < sizeof radii / sizeof radii[0]; i++) {
        for (int half = 1; half <= 2; half++) {
            for (int quarter = 0; quarter < 4; quarter++) {
                add(of, bend(of, radii[i], 0.6), of->model.limits.slope_deg * half / 2, quarter * M_PI / 2);
            }
        }
    }
}

static void add_random(struct identification *of)
{
    struct random random;

    random_init(&random, of->arguments->common.seed);
    for (size_t i = 0; i < of->arguments->count; i++) {
        const struct skid_leg leg = skid_random_leg(&of->model, &random);
        const double slope = random_uniform(&random, 0, of->model.limits.slope_deg);
        const double heading = random_uniform(&random, -M_PI, M_PI);
        of->motions[of->designed + i] = (struct motion){leg.speed, leg.turn_rate, slope, heading, 0};
    }
}

/* ---- Drives ---- */

static const char *const header = "run,phase,v0_m_s,w0_rad_s,v1_m_s,w1_rad_s,grade,bank,seconds,energy_j\n";

static void start(struct run *run, const struct skid_steer_model *model, const struct skid_ground *ground,
                  const struct planar_pose *pose)
{
    skid_drive_start(&run->drive, model, ground, pose, 1);
    skid_route_start(&run->route, &run->of->model, ground, pose);
}

/* Phase −1: not recorded. */
static void drive_piece(struct run *run, const struct skid_piece *piece, long phase)
{
    const double before = skid_drive_energy(&run->drive);

    skid_drive_piece(&run->drive, piece);
    if (phase >= 0) {
        (void)fprintf(run->stream, "%zu,%ld,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.3f,%.9f\n", run->number, phase,
                      piece->start.speed, piece->start.turn_rate, piece->end.speed, piece->end.turn_rate,
                      piece->start.grade, piece->bank, piece->seconds, skid_drive_energy(&run->drive) - before);
    }
}

static void drive_leg(struct run *run, const struct skid_leg *leg, long phase)
{
    struct skid_piece pieces[SKID_LEG_PIECES_MAX];
    const size_t count = skid_route_add(&run->route, leg, pieces);

    for (size_t i = 0; i < count; i++) {
        drive_piece(run, &pieces[i], phase);
    }
}

static void drive_corner(struct run *run, const struct motion *motion)
{
    const struct skid_leg line = {motion->speed, 0, CORNER_SECONDS};

    drive_leg(run, &line, PHASE_UP);
    drive_leg(run, &(struct skid_leg){motion->speed, motion->turn_rate, motion->corner / motion->turn_rate}, PHASE_UP);
    drive_leg(run, &line, PHASE_UP);
    drive_leg(run, &(struct skid_leg){0, 0, 0}, PHASE_DOWN);
}

static void drive_motion(struct run *run)
{
    const struct identification *of = run->of;
    const struct motion *motion = &of->motions[run->number];
    const struct skid_slope slope = skid_slope_towards(motion->slope_deg, motion->slope_heading);
    const struct skid_ground ground = skid_ground_slope(&slope);
    const struct planar_pose pose = {0, 0, 0};
    struct skid_leg leg = {motion->speed, motion->turn_rate, 0};

    start(run, &of->model, &ground, &pose);
    if (motion->corner != 0) {
        drive_corner(run, motion);
    } else if (run->number < of->designed && motion->speed == 0 && motion->slope_deg != 0) {
        leg.seconds = HOLD_SECONDS;
        drive_leg(run, &leg, PHASE_UP);
        drive_leg(run, &(struct skid_leg){skid_tread_speed_max(&of->model) / 2, 0, BACK_SECONDS}, PHASE_UP);
        drive_leg(run, &(struct skid_leg){0, 0, 0}, PHASE_DOWN);
    } else if (run->number < of->designed) {
        drive_leg(run, &leg, PHASE_UP);
        leg.seconds = HOLD_SECONDS;
        drive_leg(run, &leg, PHASE_HOLD);
        drive_leg(run, &(struct skid_leg){0, 0, 0}, PHASE_DOWN);
    } else {
        leg.seconds = SETTLE_SECONDS;
        drive_leg(run, &leg, -1);
        leg.seconds = CHECK_SECONDS;
        drive_leg(run, &leg, PHASE_CHECK);
    }
}

static void drive_route(struct run *run, struct random *random, long phase)
{
    bool drives_on = false;

    run->route.pose = skid_drive_go_on(&run->drive);
    for (long number = 0; number < ROUTE_LEGS || !drives_on; number++) {
        const struct skid_leg leg = skid_random_leg(&run->of->model, random);
        drive_leg(run, &leg, phase + number);
        drives_on = leg.speed != 0;
    }
}

/* A robot like it, of a stream of its own. */
static void drive_robot(struct run *run)
{
    const struct identification *of = run->of;
    struct random random;

    random_init(&random, of->arguments->common.seed + 1 + run->number);

    const struct skid_variation variation = skid_random_variation(&random);
    const struct skid_steer_model varied = skid_varied(&of->model, &variation);
    const struct skid_hills hills = skid_random_hills_within(&random, of->model.limits.slope_deg);
    const struct skid_ground ground = skid_ground_hills(&hills);
    const struct planar_pose pose = {0, 0, random_uniform(&random, -M_PI, M_PI)};

    start(run, &varied, &ground, &pose);
    for (long route = 0; route < ROBOT_ROUTES; route++) {
        drive_route(run, &random, route * PHASES_OF_ROUTE);
    }
}

/* ---- Runs on all cores ---- */

static void make_run(void *context, size_t index)
{
    const struct runs *runs = context;
    struct result *result = &runs->results[index];
    struct run run = {.of = runs->of, .number = index, .stream = open_memstream(&result->rows, &result->size)};

    if (run.stream == NULL) {
        return;
    }
    runs->drive(&run);
    if (run.drive.world.plant.tipped) {
        error_line("%s: the robot tipped over in drive %zu; correct limits, or what is in body", run.of->model.name,
                   index);
    }
    result->is_sound = fclose(run.stream) == 0 && !run.drive.world.plant.tipped;
}

/* In the order of the runs. */
static bool write_rows(const struct runs *runs, FILE *stream)
{
    (void)fputs(header, stream);
    for (size_t i = 0; i < runs->count; i++) {
        if (!runs->results[i].is_sound) {
            return false;
        }
        (void)fwrite(runs->results[i].rows, 1, runs->results[i].size, stream);
    }
    return true;
}

static bool write_runs(const struct identification *of, const char *name, void (*drive)(struct run *run), size_t count)
{
    FILE *stream = output_open(of->arguments->common.output, name);
    struct runs runs = {of, drive, calloc(count, sizeof *runs.results), count};

    if (stream == NULL || runs.results == NULL) {
        free(runs.results);
        return false;
    }
    in_parallel(name, make_run, &runs, count);

    const bool is_written = write_rows(&runs, stream);

    for (size_t i = 0; i < count; i++) {
        free(runs.results[i].rows);
    }
    free(runs.results);
    return is_written;
}

/* ---- Files ---- */

/* Mass that the treads feel, of the body and of what turns with them. */
static double felt_mass(const struct skid_plant *plant)
{
    const double radius = plant->model.wheel.radius_m;

    return plant->model.body.mass_kg + 2 * plant->side_inertia / (radius * radius);
}

/* Moment of inertia that turning feels, the same way. */
static double felt_inertia(const struct skid_plant *plant)
{
    const double arm = skid_half_track(&plant->model) / plant->model.wheel.radius_m;

    return plant->model.body.yaw_inertia_kg_m2 + 2 * plant->side_inertia * arm * arm;
}

static json_t *about(const struct identification *of)
{
    const struct skid_steer_model *model = &of->model;
    const double amperes_per_newton =
        model->wheel.radius_m / (model->motor.torque_constant * model->motor.gear_ratio * model->motor.efficiency);
    const struct skid_ground level = {NULL, NULL};
    const struct planar_pose pose = {0, 0, 0};
    struct skid_plant plant;

    skid_plant_init(&plant, model, &level, &pose);
    return json_pack("{s:s, s:I, s:I, s:I, s:I, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "robot", model->name,
                     "seed", (json_int_t)of->arguments->common.seed, "design", (json_int_t)of->designed, "check",
                     (json_int_t)of->arguments->count, "robots", (json_int_t)of->arguments->robots, "width_m",
                     model->body.width_m, "half_track_m", skid_half_track(model), "weight_n",
                     model->body.mass_kg * STANDARD_GRAVITY, "friction", model->ground.friction, "felt_mass_kg",
                     felt_mass(&plant), "felt_inertia_kg_m2", felt_inertia(&plant), "electronics_w",
                     model->electronics.power_w, "efficiency", model->motor.efficiency, "ohm_per_newton_squared",
                     model->motor.resistance_ohm * amperes_per_newton * amperes_per_newton);
}

static bool identify(const struct arguments *arguments)
{
    static struct identification of;

    of.arguments = arguments;
    if (!skid_robot_load(arguments->common.robot, &of.model) || !output_directory(arguments->common.output)) {
        return false;
    }
    add_straights(&of);
    add_bends(&of);
    add_corners(&of);
    add_bends_on_slopes(&of);
    add_random(&of);
    if (!write_runs(&of, "experiments.csv", drive_motion, of.designed + arguments->count) ||
        !write_runs(&of, "robots.csv", drive_robot, arguments->robots) ||
        !output_json(arguments->common.output, "experiments.json", about(&of))) {
        output_discard();
        return false;
    }
    (void)printf("%zu designed drives, %zu random ones, %zu robots of %d routes\n", of.designed, arguments->count,
                 arguments->robots, ROBOT_ROUTES);
    return output_commit();
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        OPTION_OUTPUT("build/skid-identify"),
        {"count", 'n', "N", 0, "random motions (100)", 0},
        {"robots", OPTION_ROBOTS, "N", 0, "robots with other grounds, payloads and motors (120)", 0},
        OPTION_SEED("of all that is random"),
        {0},
    };
    static const struct argp argp = {options,
                                     parse_option,
                                     "ROBOT",
                                     "Drives a simulated skid-steered or differential-drive robot through designed and "
                                     "random motions, and robots like it over hills, and records their energies.",
                                     NULL,
                                     NULL,
                                     NULL};
    struct arguments arguments = {.common = {.output = "build/skid-identify", .seed = 1}, .count = 100, .robots = 120};

    command_line_parse(&argp, argc, argv, &arguments);
    return identify(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
