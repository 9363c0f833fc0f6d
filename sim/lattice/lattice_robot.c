#include "sim/lattice/lattice_robot.h"

#include <math.h>
#include <string.h>

#include "sim/balancer/energy_unit.h"
#include "sim/balancer/rig.h"
#include "sim/base/strict_math.h"

#define RADIANS_PER_DEGREE (3.14159265358979323846 / 180)
#define Q16                65536.0

/* The turn rates of the paper's samples (section 2.2), rad/s; a balancer may allow less. */
#define TURN_RATE_MAX (3.14159265358979323846 / 8)

/* Ground and slopes of the paper, which the balancer shares. */
#define GROUND_FRICTION 0.69
#define SLOPE_MAX_DEG   15.0

/* Cells of the paper's lattice (section 2.2), m. */
#define CELL 0.2

/* Speeds and rates are tried in this many steps up to their limit. */
#define TRIED 1000

static double skid_steer_motion_energy(const struct lattice_robot *robot, enum jp_cost_kind kind,
                                       const struct lattice_motion *motion)
{
    const double distance = fabs(motion->speed) * motion->duration;
    const struct skid_steer_motion steady = {motion->speed, motion->turn_rate,
                                             distance > 0 ? motion->rise / distance : 0};

    return skid_steer_unlimited_energy(&robot->skid_steer, kind, &steady, motion->duration);
}

/* One that finds its own way turns wherever it is, and leaves its path by a margin. */
static void describe_navigation(struct lattice_robot *robot, double cell_m, double margin_m)
{
    if (!isnan(cell_m)) {
        robot->cell_m = cell_m;
    }
    if (!isnan(margin_m)) {
        robot->margin_m = margin_m;
        robot->turning_radius_m = strict_hypot(robot->length_m, robot->width_m) / 2 + margin_m;
    }
}

static void describe_skid_steer(struct lattice_robot *robot)
{
    const struct skid_steer_model *model = &robot->skid_steer;

    robot->name = model->name;
    robot->length_m = model->body.length_m + 2 * fabs(model->body.middle_ahead_m);
    robot->width_m = model->body.overall_width_m;
    robot->track_m = model->body.width_m;
    robot->speed_max = model->lattice.speed_m_s;
    robot->turn_rate_max = model->lattice.turn_rate_rad_s;
    robot->pivot_duration = 0;
    robot->grade_max = strict_tan(model->limits.slope_deg * RADIANS_PER_DEGREE);
    robot->grade_bend = -model->ground.rolling;
    robot->electronics_power = model->electronics.power_w;
    describe_navigation(robot, model->navigation.cell_m, model->navigation.margin_m);
    /* Several axles make it long: a plan that is not its own leads through where its rectangle fits. */
    robot->radius_m = model->wheel.axles > 1 ? 0 : robot->turning_radius_m;
    robot->energy = skid_steer_motion_energy;
}

static double balancer_weight(const struct robot_file *file)
{
    return (file->body.mass_kg + 2 * file->wheel.mass_kg) * STANDARD_GRAVITY;
}

/* W of both motors driving settled. The model's power is u²/Rm a side, which on level ground is b1 v² + b2 w²; a slope
 * adds to each voltage what holds half the weight's share along it. */
static double balancer_motor_power(const struct lattice_robot *robot, double speed, double turn_rate, double grade)
{
    const struct jp_energy_model *model = robot->balancer.model;
    const struct robot_file *file = &robot->balancer.file;
    const double torque = grade * balancer_weight(file) * file->wheel.radius_m / 2;
    const double slope_voltage =
        torque / (file->motor.torque_constant * file->motor.gear_ratio) * file->motor.resistance_ohm;
    const double level_voltage = speed * sqrt(energy_unit_joules(model, model->b[0]) * file->motor.resistance_ohm / 2);
    const double voltage = level_voltage + slope_voltage;

    return 2 * voltage * voltage / file->motor.resistance_ohm +
           energy_unit_joules(model, model->b[1]) * turn_rate * turn_rate;
}

/* J of the motors: settled driving, or on the spot a step σ of the heading (a3 σ²). */
static double balancer_motor_energy(const struct lattice_robot *robot, const struct lattice_motion *motion)
{
    if (motion->speed == 0) {
        const double turn = motion->turn_rate * motion->duration;
        return energy_unit_joules(robot->balancer.model, robot->balancer.model->a[2]) * turn * turn;
    }
    const double grade = motion->rise / (motion->speed * motion->duration);
    return balancer_motor_power(robot, motion->speed, motion->turn_rate, grade) * motion->duration;
}

/* W per m/s of level driving at the lattice's speed, all in: α of eq. 14. */
static double balancer_distance_energy(const struct lattice_robot *robot)
{
    return (robot->electronics_power + balancer_motor_power(robot, robot->speed_max, 0, 0)) / robot->speed_max;
}

static double balancer_motion_energy(const struct lattice_robot *robot, enum jp_cost_kind kind,
                                     const struct lattice_motion *motion)
{
    const double motors = balancer_motor_energy(robot, motion);
    if (kind == JP_COST_PHYSICAL) {
        return motors + robot->electronics_power * motion->duration;
    }
    return balancer_distance_energy(robot) * fabs(motion->speed) * motion->duration + motors +
           GROUND_FRICTION * balancer_weight(&robot->balancer.file) * motion->rise;
}

/* The speed with the least settled energy a metre, within the limit: √(Ps/b1). */
static double cruising_speed(const struct lattice_robot *robot)
{
    const struct jp_energy_model *model = robot->balancer.model;
    const double efficient = sqrt((double)model->electronics_power / model->b[0]);

    return fmin(efficient, robot->balancer.file.limits.speed_m_s);
}

static void describe_balancer(struct lattice_robot *robot)
{
    const struct robot_file *file = &robot->balancer.file;

    robot->name = file->name;
    robot->length_m = fmax(2 * file->wheel.radius_m, file->body.depth_m);
    robot->width_m = file->body.width_m;
    robot->track_m = file->body.width_m;
    robot->turn_rate_max = fmin(TURN_RATE_MAX, file->limits.turn_rate_rad_s);
    robot->pivot_duration = robot->balancer.model->settling_time / Q16;
    robot->grade_max = strict_tan(SLOPE_MAX_DEG * RADIANS_PER_DEGREE);
    robot->grade_bend = -robot->grade_max;
    robot->electronics_power = energy_unit_joules(robot->balancer.model, robot->balancer.model->electronics_power);
    robot->speed_max = cruising_speed(robot);
    describe_navigation(robot, file->navigation.cell_m, file->navigation.margin_m);
    robot->radius_m = robot->turning_radius_m;
    robot->energy = balancer_motion_energy;
}

static bool load_skid_steer(const char *path, struct lattice_robot *robot)
{
    if (!skid_robot_load(path, &robot->skid_steer)) {
        return false;
    }
    describe_skid_steer(robot);
    return true;
}

static bool load_balancer(const char *path, struct lattice_robot *robot)
{
    if (!robot_file_load(path, &robot->balancer.file)) {
        return false;
    }
    const struct robot_entry *entry = rig_find_robot(robot->balancer.file.name);
    if (entry == NULL) {
        return false;
    }
    robot->balancer.model = entry->energy;
    describe_balancer(robot);
    return true;
}

bool lattice_robot_load(const char *path, struct lattice_robot *robot)
{
    static const struct {
        const char *type;
        bool (*load)(const char *path, struct lattice_robot *robot);
    } kinds[] = {
        {"skid_steer", load_skid_steer}, {"differential_drive", load_skid_steer}, {CONFIG_BALANCER, load_balancer}};
    char type[CONFIG_NAME_SIZE];

    *robot = (struct lattice_robot){.cell_m = CELL};
    if (!config_fields_type(path, type)) {
        return false;
    }
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (strcmp(type, kinds[i].type) == 0) {
            return kinds[i].load(path, robot);
        }
    }
    config_fields_refuse_type(path, type, "skid_steer, a differential_drive or a " CONFIG_BALANCER);
    return false;
}

bool lattice_robot_turns_anywhere(struct lattice_robot *robot)
{
    robot->radius_m = robot->turning_radius_m;
    return robot->radius_m > 0;
}

double lattice_robot_energy(const struct lattice_robot *robot, const struct lattice_motion *motion)
{
    return fmax(robot->energy(robot, JP_COST_PHYSICAL, motion), robot->electronics_power * motion->duration);
}

double lattice_robot_speed(const struct lattice_robot *robot, double curvature)
{
    const double limit = fabs(curvature) * robot->speed_max > robot->turn_rate_max
                             ? robot->turn_rate_max / fabs(curvature)
                             : robot->speed_max;
    double best = limit;
    double least = INFINITY;

    for (int i = TRIED; i > 0; i--) {
        const double speed = limit * i / TRIED;
        const double energy =
            lattice_robot_energy(robot, &(struct lattice_motion){speed, speed * curvature, 0, 1 / speed});
        if (energy < least) {
            least = energy;
            best = speed;
        }
    }
    return best;
}

double lattice_robot_pivot_rate(const struct lattice_robot *robot, double angle)
{
    const double shortest = fmax(fabs(angle) / robot->turn_rate_max, robot->pivot_duration);
    const double limit = fabs(angle) / shortest;
    double best = limit;
    double least = INFINITY;

    for (int i = TRIED; i > 0; i--) {
        const double rate = limit * i / TRIED;
        const double energy = lattice_robot_energy(robot, &(struct lattice_motion){0, rate, 0, fabs(angle) / rate});
        if (energy < least) {
            least = energy;
            best = rate;
        }
    }
    return copysign(best, angle);
}
