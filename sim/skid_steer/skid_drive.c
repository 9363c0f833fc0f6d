#include "sim/skid_steer/skid_drive.h"

#include <math.h>

#include "sim/base/digital.h"
#include "sim/base/strict_math.h"

/* Of the loops, 1/s: wheel speeds and their integral, trim of the turn rate, way back along, heading and across. */
#define WHEEL_RATE    20
#define INTEGRAL_RATE 30
#define TRIM_RATE     3
#define ALONG_RATE    1.5
#define HEADING_RATE  2
#define ACROSS_RATE   0.4

/* The integrator's longest step, s: here no side jams, and nothing is faster than skid_plant_rate(). */
#define STEP 0.0005

/* What the way back may add, as a share of limits.speed_m_s. */
#define BACK_SHARE 0.25

static double clamp(double a, double limit)
{
    return fmin(fmax(a, -limit), limit);
}

void skid_drive_start(struct skid_drive *drive, const struct skid_steer_model *model, const struct skid_ground *ground,
                      const struct planar_pose *pose, uint64_t seed)
{
    *drive = (struct skid_drive){.reference = *pose, .last = *pose};
    skid_world_init(&drive->world, model, ground, pose, seed);
    drive->world.plant.step = fmin(STEP, SKID_STEP_RATE_MAX / skid_plant_rate(model));
}

/* The motion that leads back to the reference. What turns on the spot slides down a slope, and is led back as it drives
 * on. */
static struct skid_steer_motion led_back(const struct skid_drive *drive, double speed, double turn_rate)
{
    const struct skid_steer_model *model = &drive->world.plant.model;
    const struct planar_pose pose = skid_plant_pose(&drive->world.plant);
    const struct planar_pose error = planar_between(&pose, &drive->reference);
    const double most = BACK_SHARE * model->limits.speed_m_s;
    const double per_metre = 2 * ACROSS_RATE / model->limits.speed_m_s; /* rad/m of heading */
    const double across = speed * per_metre * per_metre * error.y;

    return (struct skid_steer_motion){
        .speed = speed == 0 ? 0 : speed * strict_cos(error.heading) + clamp(ALONG_RATE * error.x, most),
        .turn_rate = turn_rate + clamp(HEADING_RATE * error.heading + across, most / skid_half_track(model)),
    };
}

static double measured_turn_rate(const struct skid_drive *drive)
{
    const struct planar_pose pose = skid_plant_pose(&drive->world.plant);

    return planar_wrap(pose.heading - drive->last.heading) / skid_world_tick_seconds(&drive->world);
}

static jp_q31 duty_of(struct skid_drive *drive, int side, double tread)
{
    const struct skid_plant *plant = &drive->world.plant;
    const struct skid_steer_model *model = &plant->model;
    const double constant = model->motor.torque_constant * model->motor.gear_ratio;
    const double gain = plant->side_inertia * model->motor.resistance_ohm / constant * WHEEL_RATE;
    const double target = tread / model->wheel.radius_m;
    const double error = target - plant->state.sides[side].rate;
    const double volts = constant * target + gain * (error + INTEGRAL_RATE * drive->integral[side]);
    const double duty = clamp(volts / plant->attitude.bus_voltage, 1);

    drive->integral[side] += skid_world_tick_seconds(&drive->world) * error;
    return digital_fixed(duty, 2147483648.0);
}

/* One tick towards the motion of the route at its end. */
static void tick(struct skid_drive *drive, double speed, double turn_rate)
{
    const struct skid_steer_model *model = &drive->world.plant.model;
    const double half = skid_half_track(model);
    const double seconds = skid_world_tick_seconds(&drive->world);
    const struct skid_steer_motion motion = led_back(drive, speed, turn_rate);

    drive->trim += TRIM_RATE * seconds * half * (motion.turn_rate - measured_turn_rate(drive));
    drive->trim = clamp(drive->trim, BACK_SHARE * model->limits.speed_m_s);
    drive->last = skid_plant_pose(&drive->world.plant);

    const double across = half * motion.turn_rate + drive->trim;

    drive->world.actuation = (struct jp_actuation){duty_of(drive, SKID_LEFT, motion.speed - across),
                                                   duty_of(drive, SKID_RIGHT, motion.speed + across), 1};
    skid_world_step(&drive->world);
}

struct planar_pose skid_drive_go_on(struct skid_drive *drive)
{
    drive->reference = skid_plant_pose(&drive->world.plant);
    return drive->reference;
}

void skid_drive_piece(struct skid_drive *drive, const struct skid_piece *piece)
{
    const double seconds = skid_world_tick_seconds(&drive->world);
    const long ticks = lround(piece->seconds / seconds);

    for (long i = 0; i < ticks; i++) {
        const double share = ((double)i + 0.5) / (double)ticks;
        const double speed = piece->start.speed + share * (piece->end.speed - piece->start.speed);
        const double turn_rate = piece->start.turn_rate + share * (piece->end.turn_rate - piece->start.turn_rate);
        drive->reference = skid_route_pose(&drive->reference, speed, turn_rate, seconds);
        tick(drive, speed, turn_rate);
    }
}

double skid_drive_energy(const struct skid_drive *drive)
{
    const struct skid_ledger *ledger = &drive->world.plant.state.ledger;

    return ledger->battery - ledger->supply;
}

double skid_drive_distance(const struct skid_drive *drive)
{
    const struct planar_pose pose = skid_plant_pose(&drive->world.plant);

    return strict_hypot(drive->reference.x - pose.x, drive->reference.y - pose.y);
}
