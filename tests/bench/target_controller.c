/** Instructions of jp_lqr_update() and of a whole jp_robot_tick() on Cortex-M4: the worst over random states. */
#include <joulepath/robot.h>

#include <stddef.h>

#include "cycles.h"
#include "random.h"
#include "target.h"

enum { STATES = 2000, TICK_STATES = 300, SEED = 20180917, UPDATE_BAR = 300, TICK_RATE = 1000 };

extern const struct jp_robot_config jp_robot_courier24;
extern const struct jp_energy_model jp_energy_model_courier24;

static uint32_t random_state = SEED;

static uint32_t random_bits(void)
{
    return target_random(&random_state);
}

static int32_t random_within(int32_t limit)
{
    return (int32_t)(((uint64_t)random_bits() * (2U * (uint32_t)limit + 1U)) >> 32) - limit;
}

static jp_phase random_phase(jp_q24 limit)
{
    return (jp_phase)(int64_t)random_within(limit) << 32;
}

/* The controller */

struct update {
    struct jp_lqr lqr;
    struct jp_reference reference;
    struct jp_motion_state state;
    jp_q16 limit;
    struct jp_voltages voltages;
};

/** The driving range, and in a quarter of the states far beyond it, so that every limit acts. */
static struct update random_update(void)
{
    const bool far = (random_bits() & 3U) == 0U;
    const int32_t scale = far ? 60 : 1;
    struct update update = {.limit = random_bits() & 1U ? JP_Q16(24) : INT32_MAX};

    jp_lqr_start(&update.lqr, &jp_robot_courier24.lqr);
    update.lqr.wheel_integral = (int64_t)random_within(JP_Q24_ONE) * TICK_RATE * scale;
    update.lqr.yaw_integral = (int64_t)random_within(JP_Q24_ONE) * TICK_RATE * scale;
    update.state.wheel = random_phase(JP_Q24(120));
    update.state.yaw = random_phase(JP_Q24(120));
    update.reference.wheel.angle = update.state.wheel + random_phase(JP_Q24(1) * scale);
    update.reference.yaw.angle = update.state.yaw + random_phase(JP_Q24(0.25) * scale);
    update.reference.wheel.rate = random_within(JP_Q24(2) * scale);
    update.reference.yaw.rate = random_within(JP_Q24(0.5) * scale);
    update.state.pitch = random_within(JP_Q24(0.06));
    update.state.pitch_rate = random_within(JP_Q24(1) * scale);
    return update;
}

static void run_update(void *argument)
{
    struct update *update = argument;

    jp_lqr_update(&update->lqr, &jp_robot_courier24.lqr, &update->reference, &update->state, update->limit,
                  &update->voltages);
}

static uint32_t worst_update(void)
{
    uint32_t worst = 0;

    for (int i = 0; i < STATES; i++) {
        struct update update = random_update();
        uint32_t instructions = target_count_instructions(run_update, &update);

        worst = instructions > worst ? instructions : worst;
    }
    return worst;
}

/* The whole tick */

static struct jp_robot_config config;
static struct jp_robot robot;
static struct jp_sensors sensors;
static struct jp_actuation actuation;

static void run_tick(void *argument)
{
    (void)argument;
    jp_robot_tick(&robot, JP_OK, &sensors, &actuation);
}

/** The segment ends and the next one begins. */
static void run_change(void *argument)
{
    robot.telemetry.segment_ticks_left = 0;
    robot.next_full = 1;
    run_tick(argument);
}

/** Driving at a random state; the sensors' values stay, so that every tick does the same. */
static bool prepare_tick(void)
{
    const struct jp_segment_command segment = {
        {random_within(JP_Q24(1)), random_within(JP_Q24(0.35))}, random_within(JP_Q24(1.4)), JP_Q16(100)};
    const char *field;

    config = jp_robot_courier24;
    config.monitor.freeze_ticks = UINT16_MAX;
    config.monitor.current_residual = JP_Q16(1000);
    sensors = (struct jp_sensors){.encoder_left = random_bits(),
                                  .encoder_right = random_bits(),
                                  .accel_z = JP_Q24_ONE,
                                  .bus_voltage = JP_Q16(24)};
    if (jp_robot_init(&robot, &config, &jp_energy_model_courier24, &field) != JP_OK) {
        return false;
    }
    run_tick(NULL);
    if (jp_robot_enable(&robot) != JP_OK) {
        return false;
    }
    run_tick(NULL);
    if (jp_robot_drive(&robot, &segment) != JP_OK) {
        return false;
    }
    run_tick(NULL);
    robot.estimator.pitch = random_phase(JP_Q24(0.06));
    robot.estimator.wheel.rate = random_within(JP_Q24(2));
    robot.estimator.yaw.rate = random_within(JP_Q24(0.2));
    robot.odometry.x = (int64_t)random_within(JP_Q24(100)) * 256;
    sensors.current_left = random_within(JP_Q16(5));
    sensors.current_right = random_within(JP_Q16(5));
    return robot.telemetry.state == JP_ROBOT_DRIVING;
}

/** 0 when a state could not be prepared or was left. */
static uint32_t worst_tick(void (*run)(void *))
{
    uint32_t worst = 0;

    for (int i = 0; i < TICK_STATES; i++) {
        if (!prepare_tick()) {
            return 0;
        }

        uint32_t instructions = target_count_instructions(run, NULL);

        if (robot.telemetry.state != JP_ROBOT_DRIVING) {
            return 0;
        }
        worst = instructions > worst ? instructions : worst;
    }
    return worst;
}

static void print_figure(const char *name, uint32_t instructions, uint32_t bar)
{
    target_print("{\"name\": \"Cortex-M4: ");
    target_print(name);
    target_print("\", \"value\": ");
    target_print_number(instructions);
    target_print(", \"unit\": \"instructions\", \"bound\": ");
    if (bar == 0) {
        target_print("null");
    } else {
        target_print("{\"op\": \"<=\", \"value\": ");
        target_print_number(bar);
        target_print("}");
    }
    target_print(", \"command\": \"make figures\"}");
}

int main(void)
{
    uint32_t tick = worst_tick(run_tick);
    uint32_t change = worst_tick(run_change);

    if (tick == 0 || change == 0) {
        target_print("a robot left its state\n");
        return 1;
    }
    target_print("[\n");
    print_figure("controller tick (errors, integrators, gain product, limits), worst of 2 000 states", worst_update(),
                 UPDATE_BAR);
    target_print(",\n");
    print_figure("jp_robot_tick() while driving, worst of 300 states", tick, 0);
    target_print(",\n");
    print_figure("jp_robot_tick() that begins a segment, worst of 300 states", change, 0);
    target_print("\n]\n");
    return 0;
}
