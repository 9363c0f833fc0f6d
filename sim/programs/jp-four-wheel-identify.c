/* Drives a robot with four steered wheels through designed and random motions, and robots like it over slopes;
 * tools/design/four_wheel_identify.py fits the energy model to what they take. */
#include <math.h>
#include <stdlib.h>

#include "sim/base/command_line.h"
#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/base/progress.h"
#include "sim/base/strict_math.h"
#include "sim/four_wheel/four_wheel_drive.h"
#include "sim/four_wheel/four_wheel_file.h"

#define RISE_MAX     0.1 /* m/m */
#define HOLD_SECONDS 4.0
#define STOP_SECONDS 2.0

#define CHANGES        8
#define CHANGE_SECONDS 1.6

#define LEG_TWISTS 3 /* of a random leg, with a stop at its end */
#define ROBOT_LEGS 30

enum { OPTION_ROBOTS = COMMAND_LINE_OWN };

/* Designed motions, random ones that are not fitted. */
enum { PHASE_DESIGN, PHASE_CHECK };

struct arguments {
    struct command_line common;
    size_t count;
    size_t robots;
};

struct identification {
    const struct arguments *arguments;
    struct four_wheel_file robot;
    size_t design_count;
    double written; /* of the battery's energy, with the pieces until now, J */
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
        command_line_refuse(state, "a robot is needed, such as patrol");
    default:
        return command_line_option(key, argument, state, &arguments->common);
    }
}

/* ---- Driving ---- */

static const char *const header =
    "run,phase,x0_m_s,y0_m_s,w0_rad_s,x1_m_s,y1_m_s,w1_rad_s,grade,bank,travel_rad,seconds,energy_j\n";

static double q24(jp_q24 value)
{
    return (double)value / JP_Q24_ONE;
}

static void write_piece(struct identification *of, const struct jp_four_wheel_piece *piece, size_t run, long phase,
                        double energy)
{
    (void)fprintf(of->stream, "%zu,%ld,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.6f,%.3f,%.9f\n", run, phase,
                  q24(piece->start.x), q24(piece->start.y), q24(piece->start.turn_rate), q24(piece->end.x),
                  q24(piece->end.y), q24(piece->end.turn_rate), q24(piece->grade), q24(piece->bank),
                  (double)piece->travel / JP_Q16_ONE, (double)piece->duration / JP_Q16_ONE, energy);
}

static void hold(struct identification *of, struct four_wheel_drive *drive, const struct four_wheel_twist *twist,
                 double seconds, size_t run, long phase)
{
    for (int tick = 0; tick < (int)(seconds * FOUR_WHEEL_RATE_HZ); tick++) {
        struct jp_four_wheel_piece piece;

        if (four_wheel_drive_tick(drive, twist, &piece)) {
            write_piece(of, &piece, run, phase, drive->plant.ledger.battery - of->written);
            of->written = drive->plant.ledger.battery;
        }
    }
}

/* The first tick begins the first piece. */
static void start(struct identification *of, struct four_wheel_drive *drive, const struct four_wheel_file *robot,
                  double rise, double towards)
{
    struct jp_four_wheel_piece piece;

    four_wheel_drive_start(drive, robot, rise * strict_cos(towards), rise * strict_sin(towards));
    (void)four_wheel_drive_tick(drive, &(struct four_wheel_twist){0, 0, 0}, &piece);
    of->written = drive->plant.ledger.battery;
}

/* ---- Designed motions ---- */

static void drive_design(struct identification *of, const struct four_wheel_twist *twist, double rise, double towards)
{
    struct four_wheel_drive drive;
    const size_t run = of->design_count++;

    start(of, &drive, &of->robot, rise, towards);
    hold(of, &drive, twist, HOLD_SECONDS, run, PHASE_DESIGN);
    hold(of, &drive, &(struct four_wheel_twist){0, 0, 0}, STOP_SECONDS, run, PHASE_DESIGN);
}

static void drive_straights(struct identification *of)
{
    for (int slope = -2; slope <= 2; slope++) {
        for (int step = -2; step <= 4; step++) {
            const struct four_wheel_twist twist = {of->robot.band.speed_m_s * step / 4, 0, 0};
            drive_design(of, &twist, RISE_MAX * slope / 2, 0);
        }
    }
}

static void drive_across(struct identification *of)
{
    for (int part = -2; part <= 2; part++) {
        for (int slope = -1; slope <= 1; slope++) {
            const double course = M_PI / 4 * part;
            const double speed = of->robot.band.speed_m_s / 2;
            const struct four_wheel_twist twist = {speed * strict_cos(course), speed * strict_sin(course), 0};
            drive_design(of, &twist, RISE_MAX * slope, M_PI / 3);
        }
    }
}

static void drive_turns(struct identification *of)
{
    const double rate = of->robot.band.turn_rate_rad_s;

    for (int part = -3; part <= 3; part++) {
        for (int step = 0; step <= 4; step++) {
            const double speed = of->robot.band.speed_m_s * step / 4;
            const double turning = rate * part / 3;
            const bool is_drivable = step == 0 || fabs(turning) <= speed / of->robot.steering.radius_min_m;
            if (part != 0 && is_drivable) {
                drive_design(of, &(struct four_wheel_twist){speed, 0, turning}, 0, 0);
                drive_design(of, &(struct four_wheel_twist){speed, 0, turning}, RISE_MAX, 0);
            }
        }
    }
}

/* From one motion to the next and back: wheels steer as they roll, or at a stand where the motions differ much. */
static void drive_change(struct identification *of, const struct four_wheel_twist *one,
                         const struct four_wheel_twist *other)
{
    struct four_wheel_drive drive;
    const size_t run = of->design_count++;

    start(of, &drive, &of->robot, 0, 0);
    for (int i = 0; i < CHANGES; i++) {
        hold(of, &drive, i % 2 == 0 ? one : other, CHANGE_SECONDS, run, PHASE_DESIGN);
    }
    hold(of, &drive, &(struct four_wheel_twist){0, 0, 0}, STOP_SECONDS, run, PHASE_DESIGN);
}

static void drive_changes(struct identification *of)
{
    for (int step = 1; step <= 3; step++) {
        const double speed = of->robot.band.speed_m_s * step / 3;
        const double rate = fmin(of->robot.band.turn_rate_rad_s, speed / of->robot.steering.radius_min_m) / 2;
        const struct four_wheel_twist left = {speed, 0, rate};
        const struct four_wheel_twist right = {speed, 0, -rate};
        const struct four_wheel_twist across = {speed * strict_cos(M_PI / 8), speed * strict_sin(M_PI / 8), 0};
        const struct four_wheel_twist aside = {0, speed, 0};
        const struct four_wheel_twist spin = {0, 0, rate};

        drive_change(of, &left, &right);
        drive_change(of, &left, &across);
        drive_change(of, &left, &spin);
        drive_change(of, &left, &aside);
        drive_change(of, &spin, &aside);
    }
}

/* ---- Random motions ---- */

static void drive_leg(struct identification *of, struct four_wheel_drive *drive, struct random *random, size_t run,
                      long phase)
{
    for (int i = 0; i < LEG_TWISTS; i++) {
        const struct four_wheel_twist twist = four_wheel_random_twist(&of->robot, random);
        hold(of, drive, &twist, random_uniform(random, 2, 5), run, phase);
    }
    hold(of, drive, &(struct four_wheel_twist){0, 0, 0}, STOP_SECONDS, run, phase);
}

static bool drive_experiments(struct identification *of)
{
    struct random random;

    random_init(&random, of->arguments->common.seed);
    (void)fputs(header, of->stream);
    drive_straights(of);
    drive_across(of);
    drive_turns(of);
    drive_changes(of);
    for (size_t i = 0; i < of->arguments->count; i++) {
        struct four_wheel_drive drive;
        const double rise = random_uniform(&random, 0, RISE_MAX);

        start(of, &drive, &of->robot, rise, random_uniform(&random, -M_PI, M_PI));
        drive_leg(of, &drive, &random, of->design_count + i, PHASE_CHECK);
        progress_show("experiments", i + 1, of->arguments->count);
    }
    progress_end();
    return true;
}

static bool drive_robots(struct identification *of)
{
    struct random random;

    random_init(&random, of->arguments->common.seed + 1);
    (void)fputs(header, of->stream);
    for (size_t run = 0; run < of->arguments->robots; run++) {
        const struct four_wheel_variation variation = four_wheel_random_variation(&random);
        const struct four_wheel_file varied = four_wheel_varied(&of->robot, &variation);
        struct four_wheel_drive drive;

        start(of, &drive, &varied, random_uniform(&random, 0, RISE_MAX / 2), 0);
        for (long number = 0; number < ROBOT_LEGS; number++) {
            drive_leg(of, &drive, &random, run, number);
        }
        progress_show("robots", run + 1, of->arguments->robots);
    }
    progress_end();
    return true;
}

/* ---- Files ---- */

/* Moments of inertia of the wheels, as masses at their treads. */
static double spin_mass(const struct four_wheel_file *robot)
{
    return JP_WHEELS * robot->wheel.inertia_kg_m2 / (robot->wheel.radius_m * robot->wheel.radius_m);
}

static json_t *about(const struct identification *of)
{
    const struct four_wheel_file *robot = &of->robot;
    const double weight = robot->body.mass_kg * FOUR_WHEEL_GRAVITY;
    const double arm = strict_hypot(robot->body.wheelbase_m, robot->body.track_m) / 2;
    const double amperes = weight * robot->wheel.radius_m / robot->drive.torque_constant_nm_a;
    const double scrub = robot->steering.friction_nm / robot->steering.torque_constant_nm_a;

    return json_pack("{s:s, s:I, s:I, s:I, s:I, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f}",
                     "robot", robot->name, "seed", (json_int_t)of->arguments->common.seed, "design",
                     (json_int_t)of->design_count, "check", (json_int_t)of->arguments->count, "robots",
                     (json_int_t)of->arguments->robots, "wheelbase_m", robot->body.wheelbase_m, "track_m",
                     robot->body.track_m, "weight_n", weight, "rolling", robot->tyre.rolling, "drag_s_m",
                     robot->drive.friction_nm_s_per_rad / (robot->wheel.radius_m * robot->wheel.radius_m) / weight,
                     "felt_mass_kg", robot->body.mass_kg + spin_mass(robot), "felt_inertia_kg_m2",
                     robot->body.inertia_kg_m2 + spin_mass(robot) * arm * arm, "efficiency", robot->drive.efficiency,
                     "copper_w", amperes * amperes * robot->drive.resistance_ohm, "stiffness_n_s_m",
                     robot->tyre.stiffness_n_s_per_m, "steering_j_rad",
                     robot->steering.friction_nm / robot->steering.efficiency +
                         scrub * scrub * robot->steering.resistance_ohm / robot->steering.rate_rad_s,
                     "contact_m", robot->steering.contact_m, "electronics_w", robot->electronics.power_w);
}

static bool write_table(struct identification *of, const char *name, bool (*drive)(struct identification *))
{
    of->stream = output_open(of->arguments->common.output, name);
    return of->stream != NULL && drive(of);
}

static bool identify(const struct arguments *arguments)
{
    static struct identification of;

    of = (struct identification){.arguments = arguments};
    if (!four_wheel_file_load(arguments->common.robot, &of.robot) || !output_directory(arguments->common.output)) {
        return false;
    }
    if (!write_table(&of, "experiments.csv", drive_experiments) || !write_table(&of, "robots.csv", drive_robots) ||
        !output_json(arguments->common.output, "experiments.json", about(&of))) {
        output_discard();
        return false;
    }
    (void)printf("%zu designed drives, %zu random ones, %zu robots of %d legs\n", of.design_count, arguments->count,
                 arguments->robots, ROBOT_LEGS);
    return output_commit();
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        OPTION_OUTPUT("build/four-wheel-identify"),
        {"count", 'n', "N", 0, "random drives (40)", 0},
        {"robots", OPTION_ROBOTS, "N", 0, "robots with other grounds, payloads and electronics (12)", 0},
        OPTION_SEED("of all that is random"),
        {0},
    };
    static const struct argp argp = {options,
                                     parse_option,
                                     "ROBOT",
                                     "Drives a simulated robot with four steered wheels through designed and random "
                                     "motions, and robots like it over slopes, and records their energies.",
                                     NULL,
                                     NULL,
                                     NULL};
    struct arguments arguments = {
        .common = {.output = "build/four-wheel-identify", .seed = 1}, .count = 40, .robots = 12};

    command_line_parse(&argp, argc, argv, &arguments);
    return identify(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
