/**
 * A robot with four steered wheels with any configuration that it accepts, any sensors and any twists, for a thousand
 * ticks: the drives are off unless it was enabled, and follow angles and speeds within their limits.
 */
#include <joulepath/four_wheel_robot.h>
#include <joulepath/tables.h>

#include "tests/fuzz/fuzz_config.h"
#include "tests/fuzz/fuzz_input.h"

#define TICKS 1000U

static struct jp_four_wheel_robot robot;
static struct jp_four_wheel_robot_config config;
static struct jp_four_wheel_sensors frame;
static int32_t steps[JP_WHEELS];
static enum jp_status read_status;

static void check_tick(const struct jp_four_wheel_actuation *actuation, bool may_run)
{
    struct jp_four_wheel_telemetry telemetry;
    struct jp_four_wheel_stretch stretch;

    fuzz_require(actuation->enabled <= 1U, "whether the drives are on");
    fuzz_require(actuation->enabled == 0U || may_run, "drives that nobody enabled");
    for (unsigned i = 0; i < JP_WHEELS; i++) {
        fuzz_require(actuation->wheels.angle[i] <= config.wheels.steering_limit &&
                         actuation->wheels.angle[i] >= -config.wheels.steering_limit,
                     "an angle beyond the steering's limit");
        fuzz_require(actuation->enabled != 0U || actuation->wheels.speed[i] == 0, "a speed of drives that are off");
        fuzz_require(actuation->wheels.speed[i] <= config.wheels.speed_max &&
                         actuation->wheels.speed[i] >= -config.wheels.speed_max,
                     "a wheel too fast");
    }
    fuzz_require(jp_four_wheel_robot_telemetry(&robot, &telemetry) && telemetry.state <= JP_FOUR_WHEEL_ROBOT_FAULT,
                 "telemetry");
    (void)jp_four_wheel_robot_take_stretch(&robot, &stretch);
}

static void change_sensors(struct fuzz_input *input)
{
    const unsigned wheel = fuzz_below(input, JP_WHEELS);

    switch (fuzz_below(input, 6)) {
    case 0:
        fuzz_fill(input, &frame, sizeof frame);
        break;
    case 1:
        FUZZ_CHANGE(input, frame);
        break;
    case 2:
        steps[wheel] = fuzz_hostile(input);
        break;
    case 3:
        read_status = fuzz_bool(input) ? JP_ERR_HARDWARE : JP_OK;
        break;
    case 4:
        for (unsigned i = 0; i < JP_WHEELS; i++) {
            steps[i] = (int8_t)fuzz_u8(input);
        }
        break;
    default:
        frame = (struct jp_four_wheel_sensors){.bus_voltage =
                                                   config.limits.voltage_min / 2 + config.limits.voltage_max / 2};
        memset(steps, 0, sizeof steps);
        read_status = JP_OK;
        break;
    }
}

static bool command(struct fuzz_input *input, bool may_run)
{
    struct jp_twist twist = {.x = 0};

    switch (fuzz_below(input, 5)) {
    case 0:
        return jp_four_wheel_robot_enable(&robot) == JP_OK || may_run;
    case 1:
        jp_four_wheel_robot_disable(&robot);
        return may_run;
    default:
        twist.x = fuzz_range(input, -JP_Q24(2), JP_Q24(2));
        twist.y = fuzz_range(input, -JP_Q24(2), JP_Q24(2));
        twist.turn_rate = fuzz_range(input, -JP_Q24(2), JP_Q24(2));
        FUZZ_CHANGE(input, twist);
        (void)jp_four_wheel_robot_drive(&robot, &twist);
        return may_run;
    }
}

/** The drives follow, more or less. */
static void move(struct fuzz_input *input, const struct jp_four_wheel_actuation *actuation, bool follows)
{
    (void)input;
    for (unsigned i = 0; i < JP_WHEELS; i++) {
        frame.count[i] += (uint32_t)steps[i];
        if (follows) {
            frame.angle[i] = actuation->wheels.angle[i];
        }
    }
}

static bool start(struct fuzz_input *input, const struct jp_four_wheel_snapshot *retained, bool *ran)
{
    const char *field = NULL;
    const enum jp_status status = jp_four_wheel_robot_init(&robot, &config, &field);

    (void)fuzz_accepted(status, field);
    if (status == JP_OK && retained != NULL) {
        struct jp_four_wheel_snapshot changed = *retained;

        FUZZ_CHANGE(input, changed);
        *ran = jp_four_wheel_robot_resume(&robot, &changed);
    }
    return status == JP_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    struct jp_four_wheel_snapshot retained;
    struct jp_four_wheel_actuation actuation = {.enabled = 0};
    bool may_run = false;

    config = jp_four_wheel_robot_patrol;
    FUZZ_CHANGE(&input, config);
    if (!start(&input, NULL, &may_run)) {
        return 0;
    }
    frame =
        (struct jp_four_wheel_sensors){.bus_voltage = config.limits.voltage_min / 2 + config.limits.voltage_max / 2};
    memset(steps, 0, sizeof steps);
    read_status = JP_OK;
    for (unsigned tick = 0; tick < TICKS; tick++) {
        if (tick % 4U == 0U && fuzz_bool(&input)) {
            change_sensors(&input);
            may_run = command(&input, may_run);
        }
        if (tick % 64U == 63U && fuzz_below(&input, 8) == 1U) {
            jp_four_wheel_robot_snapshot(&robot, &retained);
            (void)start(&input, &retained, &may_run);
        }
        move(&input, &actuation, fuzz_more(&input));
        jp_four_wheel_robot_control(&robot, read_status, &frame, &actuation);
        jp_four_wheel_robot_account(&robot);
        check_tick(&actuation, may_run);
    }
    return 0;
}
