// eva: -eva-slevel-function main:30,jp_four_wheel_robot_init:40
/** Any configuration that passes, any frames and statuses, any twists, at any time, for ever; a reset at any time, with
 * any bytes retained. */
#include <joulepath/four_wheel_robot.h>

#define ROBOT jp_four_wheel_robot
#define ORDER jp_twist
#include "tests/proof/any_robot.h"

static enum jp_status wheels_read(void *context, struct jp_four_wheel_sensors *sensors)
{
    (void)context;
    ANY(*sensors);
    return any_reading();
}

static enum jp_status wheels_write(void *context, const struct jp_four_wheel_actuation *actuation)
{
    (void)context;
    (void)actuation;
    return any_bool() ? JP_OK : JP_ERR_HARDWARE;
}

static void tick(struct jp_four_wheel_robot *robot)
{
    static const struct jp_four_wheel_hal board = {.read = wheels_read, .write = wheels_write};
    enum jp_status written = any_bool() ? JP_OK : JP_ERR_HARDWARE;

    jp_hal_four_wheel_tick(&board, robot, &written);
}

static void look(struct jp_four_wheel_robot *robot)
{
    struct jp_four_wheel_telemetry telemetry;
    struct jp_four_wheel_stretch stretch;

    (void)jp_four_wheel_robot_telemetry(robot, &telemetry);
    (void)jp_four_wheel_robot_state_now(robot);
    (void)jp_four_wheel_robot_take_stretch(robot, &stretch);
    (void)jp_four_wheel_robot_stretches_lost(robot);
    (void)jp_four_wheel_robot_good_frame(robot);
}

static void reset(struct jp_four_wheel_robot *robot, const struct jp_four_wheel_robot_config *config)
{
    struct jp_four_wheel_snapshot snapshot;
    const char *field;

    jp_four_wheel_robot_snapshot(robot, &snapshot);
    if (any_bool()) {
        ANY(snapshot);
    }
    while (jp_four_wheel_robot_init(robot, config, &field) != JP_OK) {
        /* It passed before. */
    }
    (void)jp_four_wheel_robot_resume(robot, &snapshot);
}

int main(void)
{
    static struct jp_four_wheel_robot_config config;
    static struct jp_four_wheel_robot robot;
    const char *field;

    ANY(config);
    if (jp_four_wheel_robot_init(&robot, &config, &field) != JP_OK) {
        return 0;
    }
    ANY_TIMES
    {
        command(&robot);
        tick(&robot);
        look(&robot);
        if (any_bool()) {
            reset(&robot, &config);
        }
    }
    ARRIVED();
    return 0;
}
