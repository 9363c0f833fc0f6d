/** A simulated skid-steered or differential-drive robot under the library's controller, and what can go wrong with it.
 */
#ifndef JOULEPATH_TESTS_SUPPORT_SKID_DRIVE_H
#define JOULEPATH_TESTS_SUPPORT_SKID_DRIVE_H

#include <math.h>

#include "sim/skid_steer/skid_hal_sim.h"
#include <joulepath/tables.h>

#include "unity.h"

#define Q16_OF(x) ((jp_q16)lround((x)*65536.0))
#define Q24_OF(x) ((jp_q24)lround((x)*16777216.0))

/** What the HAL does to a tick. */
struct skid_disturbance {
    void (*sensors)(struct jp_sensors *sensors); /**< changes what was read; or NULL */
    enum jp_status read;
    enum jp_status write;
};

struct skid_drive {
    struct skid_world world;
    struct jp_hal simulated;
    struct jp_hal hal; /**< disturbs the simulated one */
    struct jp_skid_robot robot;
    enum jp_status written;
    struct skid_disturbance disturbance;
    double greatest_current; /**< of a side while the robot was controlled, A */
};

static inline enum jp_status skid_drive_read(void *context, struct jp_sensors *sensors)
{
    struct skid_drive *drive = context;

    (void)drive->simulated.read(drive->simulated.context, sensors);
    if (drive->disturbance.sensors != NULL) {
        drive->disturbance.sensors(sensors);
    }
    return drive->disturbance.read;
}

static inline enum jp_status skid_drive_write(void *context, const struct jp_actuation *actuation)
{
    struct skid_drive *drive = context;
    const struct jp_actuation off = {.enabled = 0};

    (void)drive->simulated.write(drive->simulated.context, drive->disturbance.write == JP_OK ? actuation : &off);
    return drive->disturbance.write;
}

/** At rest, idle; the first frame is not read yet. */
static inline void skid_drive_start(struct skid_drive *drive, const struct skid_steer_model *model,
                                    const struct jp_skid_robot_config *config, const struct skid_ground *ground,
                                    const struct planar_pose *pose, uint64_t seed)
{
    const char *field = "";

    *drive = (struct skid_drive){.written = JP_OK, .disturbance = {NULL, JP_OK, JP_OK}};
    skid_world_init(&drive->world, model, ground, pose, seed);
    drive->simulated = skid_hal_sim(&drive->world);
    drive->hal = (struct jp_hal){.context = drive, .read = skid_drive_read, .write = skid_drive_write};

    const enum jp_status status = jp_skid_robot_init(&drive->robot, config, &field);
    TEST_ASSERT_EQUAL_INT_MESSAGE(JP_OK, status, field);
}

static inline bool skid_drive_is_controlled(const struct skid_drive *drive)
{
    return drive->robot.internal.controlled;
}

static inline void skid_drive_tick(struct skid_drive *drive)
{
    jp_hal_skid_tick(&drive->hal, &drive->robot, &drive->written);
    skid_world_step(&drive->world);
    if (skid_drive_is_controlled(drive)) {
        const double *current = drive->world.plant.attitude.current;
        drive->greatest_current = fmax(drive->greatest_current, fmax(fabs(current[0]), fabs(current[1])));
    }
}

static inline int skid_drive_ticks(const struct skid_drive *drive, double seconds)
{
    return (int)(seconds / skid_world_tick_seconds(&drive->world) + 0.5);
}

static inline void skid_drive_for(struct skid_drive *drive, double seconds)
{
    for (int i = skid_drive_ticks(drive, seconds); i > 0; i--) {
        skid_drive_tick(drive);
    }
}

static inline enum jp_skid_robot_state skid_drive_state(const struct skid_drive *drive)
{
    return jp_skid_robot_state_now(&drive->robot);
}

static inline struct jp_skid_telemetry skid_drive_telemetry(const struct skid_drive *drive)
{
    struct jp_skid_telemetry telemetry;

    TEST_ASSERT_TRUE(jp_skid_robot_telemetry(&drive->robot, &telemetry));
    return telemetry;
}

/** From the start to a stand. */
static inline void skid_drive_enable(struct skid_drive *drive)
{
    skid_drive_for(drive, 0.5);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_enable(&drive->robot));
    skid_drive_for(drive, 0.5);
    TEST_ASSERT_EQUAL_INT(JP_SKID_ROBOT_STANDING, skid_drive_state(drive));
}

static inline enum jp_status skid_drive_command(struct skid_drive *drive, double speed, double turn_rate,
                                                double seconds)
{
    const struct jp_skid_command command = {.motion = {Q24_OF(speed), Q24_OF(turn_rate)}, .duration = Q16_OF(seconds)};

    return jp_skid_robot_drive(&drive->robot, &command);
}

/** Along the ground, m/s. */
static inline double skid_drive_speed(const struct skid_drive *drive)
{
    return drive->world.plant.state.forward;
}

/** Way on the map from one pose to another, m. */
static inline double skid_drive_way(const struct planar_pose *from, const struct planar_pose *to)
{
    return hypot(to->x - from->x, to->y - from->y);
}

#endif
