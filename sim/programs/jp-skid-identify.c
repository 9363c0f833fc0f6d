/* Drives a skid-steered or differential-drive robot through designed and random motions, and robots like it over hills;
 * tools/design/skid_identify.py fits the energy model to what they take. */
#include <math.h>
#include <stdlib.h>

#include "sim/base/command_line.h"
#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/base/progress.h"
#include "sim/skid_steer/skid_drive.h"
#include "sim/skid_steer/skid_hills.h"

#define HOLD_SECONDS   5.0
#define SETTLE_SECONDS 5.0 /* with the ramp */
#define CHECK_SECONDS  2.0

#define ROBOT_LEGS 30
#define DRIVES_MAX 128

enum { OPTION_ROBOTS = COMMAND_LINE_OWN };

/* Rows of one phase are summed up before they are fitted. */
enum { PHASE_UP, PHASE_HOLD, PHASE_DOWN, PHASE_CHECK };

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
};

struct identification {
    const struct arguments *arguments;
    struct skid_steer_model model;
    struct motion drives[DRIVES_MAX];
    size_t drive_count;
    FILE *stream;
};

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case 'n':
        arguments->count = (size_t)command_line_whole(state, "--count", argument, 1, 100000);
        return 0;
    case OPTION_ROBOTS:
        arguments->robots = (size_t)command_line_whole(state, "--robots", argument, 1, 100000);
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

    return (struct motion){.speed = rate * radius * half, .turn_rate = of->drive_count % 2 == 0 ? rate : -rate};
}

static void add(struct identification *of, struct motion motion, double slope_deg, double slope_heading)
{
    motion.slope_deg = slope_deg;
    motion.slope_heading = slope_heading;
    of->drives[of->drive_count++] = motion;
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

static struct motion random_motion(const struct identification *of, struct random *random)
{
    const struct skid_leg leg = skid_random_leg(&of->model, random);
    const double slope = random_uniform(random, 0, of->model.limits.slope_deg);

    return (struct motion){leg.speed, leg.turn_rate, slope, random_uniform(random, -M_PI, M_PI)};
}

/* ---- Drives ---- */

static const char *const header = "run,phase,v0_m_s,w0_rad_s,v1_m_s,w1_rad_s,grade,bank,seconds,energy_j\n";

static bool drive_pieces(struct identification *of, struct skid_drive *drive, const struct skid_piece *pieces,
                         size_t count, size_t run, long phase)
{
    for (size_t i = 0; i < count; i++) {
        const struct skid_piece *piece = &pieces[i];
        const double before = skid_drive_energy(drive);

        skid_drive_piece(drive, piece);
        if (phase >= 0) {
            (void)fprintf(of->stream, "%zu,%ld,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.3f,%.9f\n", run, phase,
                          piece->start.speed, piece->start.turn_rate, piece->end.speed, piece->end.turn_rate,
                          piece->start.grade, piece->bank, piece->seconds, skid_drive_energy(drive) - before);
        }
    }
    if (drive->world.plant.tipped) {
        error_line("%s: the robot tipped over in drive %zu; correct limits, or what is in body", of->model.name, run);
        return false;
    }
    return true;
}

/* One leg; phase −1: not recorded. */
static bool drive_leg(struct identification *of, struct skid_drive *drive, struct skid_route *route,
                      const struct skid_leg *leg, size_t run, long phase)
{
    struct skid_piece pieces[SKID_LEG_PIECES_MAX];
    const size_t count = skid_route_add(route, leg, pieces);

    return drive_pieces(of, drive, pieces, count, run, phase);
}

static bool drive_design(struct identification *of, size_t run)
{
    const struct motion *motion = &of->drives[run];
    const struct skid_slope slope = skid_slope_towards(motion->slope_deg, motion->slope_heading);
    const struct skid_ground ground = skid_ground_slope(&slope);
    const struct planar_pose pose = {0, 0, 0};
    const struct skid_leg ramp = {motion->speed, motion->turn_rate, 0};
    const struct skid_leg hold = {motion->speed, motion->turn_rate, HOLD_SECONDS};
    const struct skid_leg stop = {0, 0, 0};
    struct skid_drive drive;
    struct skid_route route;

    skid_drive_start(&drive, &of->model, &ground, &pose, 1);
    skid_route_start(&route, &of->model, &ground, &pose);
    return drive_leg(of, &drive, &route, &ramp, run, PHASE_UP) &&
           drive_leg(of, &drive, &route, &hold, run, PHASE_HOLD) &&
           drive_leg(of, &drive, &route, &stop, run, PHASE_DOWN);
}

static bool drive_check(struct identification *of, struct random *random, size_t run)
{
    const struct motion motion = random_motion(of, random);
    const struct skid_slope slope = skid_slope_towards(motion.slope_deg, motion.slope_heading);
    const struct skid_ground ground = skid_ground_slope(&slope);
    const struct planar_pose pose = {0, 0, 0};
    const struct skid_leg settle = {motion.speed, motion.turn_rate, SETTLE_SECONDS};
    const struct skid_leg hold = {motion.speed, motion.turn_rate, CHECK_SECONDS};
    struct skid_drive drive;
    struct skid_route route;

    skid_drive_start(&drive, &of->model, &ground, &pose, 1);
    skid_route_start(&route, &of->model, &ground, &pose);
    return drive_leg(of, &drive, &route, &settle, run, -1) && drive_leg(of, &drive, &route, &hold, run, PHASE_CHECK);
}

static bool drive_experiments(struct identification *of)
{
    const size_t all = of->drive_count + of->arguments->count;
    struct random random;

    random_init(&random, of->arguments->common.seed);
    (void)fputs(header, of->stream);
    for (size_t run = 0; run < all; run++) {
        if (!(run < of->drive_count ? drive_design(of, run) : drive_check(of, &random, run))) {
            return false;
        }
        progress_show("experiments", run + 1, all);
    }
    progress_end();
    return true;
}

/* ---- Robots like it ---- */

static bool drive_robot(struct identification *of, struct random *random, size_t run)
{
    const struct skid_variation variation = skid_random_variation(random);
    const struct skid_steer_model varied = skid_varied(&of->model, &variation);
    const struct skid_hills hills = skid_random_hills_within(random, of->model.limits.slope_deg);
    const struct skid_ground ground = skid_ground_hills(&hills);
    const struct planar_pose pose = {0, 0, random_uniform(random, -M_PI, M_PI)};
    struct skid_drive drive;
    struct skid_route route;

    skid_drive_start(&drive, &varied, &ground, &pose, 1);
    skid_route_start(&route, &of->model, &ground, &pose);
    for (long number = 0; number < ROBOT_LEGS; number++) {
        const struct skid_leg leg = skid_random_leg(&of->model, random);
        if (!drive_leg(of, &drive, &route, &leg, run, number)) {
            return false;
        }
    }
    return true;
}

static bool drive_robots(struct identification *of)
{
    struct random random;

    random_init(&random, of->arguments->common.seed + 1);
    (void)fputs(header, of->stream);
    for (size_t run = 0; run < of->arguments->robots; run++) {
        if (!drive_robot(of, &random, run)) {
            return false;
        }
        progress_show("robots", run + 1, of->arguments->robots);
    }
    progress_end();
    return true;
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
    const double per_ampere = model->motor.torque_constant * model->motor.gear_ratio * model->motor.efficiency;
    const struct skid_ground level = {NULL, NULL};
    const struct planar_pose pose = {0, 0, 0};
    struct skid_plant plant;

    skid_plant_init(&plant, model, &level, &pose);
    return json_pack("{s:s, s:I, s:I, s:I, s:I, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "robot", model->name,
                     "seed", (json_int_t)of->arguments->common.seed, "design", (json_int_t)of->drive_count, "check",
                     (json_int_t)of->arguments->count, "robots", (json_int_t)of->arguments->robots, "width_m",
                     model->body.width_m, "half_track_m", skid_half_track(model), "weight_n",
                     model->body.mass_kg * STANDARD_GRAVITY, "friction", model->ground.friction, "felt_mass_kg",
                     felt_mass(&plant), "felt_inertia_kg_m2", felt_inertia(&plant), "electronics_w",
                     model->electronics.power_w, "efficiency", model->motor.efficiency, "ohm_per_newton_squared",
                     model->motor.resistance_ohm * pow(model->wheel.radius_m / per_ampere, 2));
}

static bool write_table(struct identification *of, const char *name, bool (*drive)(struct identification *))
{
    of->stream = output_open(of->arguments->common.output, name);
    return of->stream != NULL && drive(of);
}

static bool identify(const struct arguments *arguments)
{
    struct identification of = {.arguments = arguments};

    if (!skid_robot_load(arguments->common.robot, &of.model) || !output_directory(arguments->common.output)) {
        return false;
    }
    add_straights(&of);
    add_bends(&of);
    add_bends_on_slopes(&of);
    if (!write_table(&of, "experiments.csv", drive_experiments) || !write_table(&of, "robots.csv", drive_robots) ||
        !output_json(arguments->common.output, "experiments.json", about(&of))) {
        output_discard();
        return false;
    }
    (void)printf("%zu designed drives, %zu random ones, %zu robots of %d legs\n", of.drive_count, arguments->count,
                 arguments->robots, ROBOT_LEGS);
    return output_commit();
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        OPTION_OUTPUT("build/skid-identify"),
        {"count", 'n', "N", 0, "random motions (200)", 0},
        {"robots", OPTION_ROBOTS, "N", 0, "robots with other grounds, payloads and motors (60)", 0},
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
    struct arguments arguments = {.common = {.output = "build/skid-identify", .seed = 1}, .count = 200, .robots = 60};

    command_line_parse(&argp, argc, argv, &arguments);
    return identify(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
