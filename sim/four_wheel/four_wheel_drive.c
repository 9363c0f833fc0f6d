#include "sim/four_wheel/four_wheel_drive.h"

#include <math.h>

#include "sim/base/strict_math.h"
#include "sim/four_wheel/four_wheel_file.h"

void four_wheel_drive_start(struct four_wheel_drive *drive, const struct four_wheel_file *robot, double rise_x,
                            double rise_y)
{
    const struct four_wheel_patch slope = four_wheel_slope(rise_x, rise_y);
    const struct planar_pose origin = {0, 0, 0};
    const char *field;

    *drive = (struct four_wheel_drive){.config = four_wheel_config(robot), .rise_x = rise_x, .rise_y = rise_y};
    four_wheel_plant_init(&drive->plant, robot, &origin);
    (void)four_wheel_plant_add_patch(&drive->plant, &slope);
    (void)jp_four_wheel_trip_init(
        &drive->trip, &(struct jp_four_wheel_trip_config){drive->config, FOUR_WHEEL_RATE_HZ, FOUR_WHEEL_PIECE_TICKS},
        &field);
}

static jp_q24 to_q24(double value)
{
    return (jp_q24)lround(value * JP_Q24_ONE);
}

bool four_wheel_drive_tick(struct four_wheel_drive *drive, const struct four_wheel_twist *twist,
                           struct jp_four_wheel_piece *piece)
{
    const struct jp_twist goal = {to_q24(twist->forward), to_q24(twist->left), to_q24(twist->turn_rate)};
    const double heading = drive->plant.state.pose.heading;
    const double grade = drive->rise_x * strict_cos(heading) + drive->rise_y * strict_sin(heading);
    const double bank = drive->rise_y * strict_cos(heading) - drive->rise_x * strict_sin(heading);
    enum jp_steering steering;

    (void)jp_four_wheel_tick(&drive->config, &goal, &drive->wheels, &steering);
    four_wheel_plant_tick(&drive->plant, &drive->wheels);
    return jp_four_wheel_trip_tick(&drive->trip, &drive->plant.measured, to_q24(grade), to_q24(bank), piece);
}

struct four_wheel_variation four_wheel_random_variation(struct random *random)
{
    struct four_wheel_variation variation;

    variation.rolling = random_uniform(random, 0.7, 1.5);
    variation.mass = random_uniform(random, 0.9, 1.3);
    variation.steering = random_uniform(random, 0.6, 1.4);
    variation.electronics = random_uniform(random, 0.8, 1.2);
    return variation;
}

struct four_wheel_file four_wheel_varied(const struct four_wheel_file *robot,
                                         const struct four_wheel_variation *variation)
{
    struct four_wheel_file varied = *robot;

    varied.tyre.rolling *= variation->rolling;
    varied.body.mass_kg *= variation->mass;
    varied.body.inertia_kg_m2 *= variation->mass;
    varied.steering.friction_nm *= variation->steering;
    varied.electronics.power_w *= variation->electronics;
    return varied;
}

struct four_wheel_twist four_wheel_random_twist(const struct four_wheel_file *robot, struct random *random)
{
    const double speed = robot->band.speed_m_s * random_uniform(random, 0.2, 1);
    const double rate = robot->band.turn_rate_rad_s * random_uniform(random, -1, 1);
    const double course = random_uniform(random, -M_PI / 2, M_PI / 2);
    const double kind = random_uniform(random, 0, 6);

    if (kind < 1) {
        return (struct four_wheel_twist){speed, 0, 0};
    }
    if (kind < 2) {
        return (struct four_wheel_twist){-speed / 2, 0, 0};
    }
    if (kind < 3) {
        return (struct four_wheel_twist){speed * strict_cos(course), speed * strict_sin(course), 0};
    }
    if (kind < 4) {
        return (struct four_wheel_twist){
            speed, 0, fmin(fmax(rate, -speed / robot->steering.radius_min_m), speed / robot->steering.radius_min_m)};
    }
    if (kind < 5) {
        return (struct four_wheel_twist){0, 0, rate};
    }
    return (struct four_wheel_twist){speed * strict_cos(course), speed * strict_sin(course), rate / 2};
}
