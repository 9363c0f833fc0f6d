/**
 * Instructions of jp_lqr_update() and of a tick: the worst over random states and readings, for each thing that a tick
 * can do while the motors run. From the registers of the sensors to those of the PWM it is the STM32F405's drivers on
 * memory in the place of the registers. Built for ARMv6-M it counts a Cortex-M0's, which an M4 executes the same.
 */
#include <joulepath/tables.h>
#include <joulepath/trajectory_rule.h>

#include "hal/stm32f4/devices.h"

#include <stddef.h>

#include "tests/bench/random_registers.h"
#include "tests/support/stm32_fake.h"
#include "tests/target/cycles.h"
#include "tests/target/random.h"
#include "tests/target/target.h"

enum { STATES = 2000, TICK_STATES = 100, SEED = 20180917, TICK_RATE = 1000 };

/* A bar of 0 is none. */
#if defined __ARM_ARCH_6M__
enum { UPDATE_BAR = 0, TICK_BAR = 6000 };
#elif defined __ARM_ARCH_7EM__
enum { UPDATE_BAR = 300, TICK_BAR = 1200 };
#else
enum { UPDATE_BAR = 0, TICK_BAR = 0 };
#endif

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
static struct jp_robot prepared;
static struct jp_robot robot;
static struct jp_sensors sensors;
static enum jp_status read;
static struct jp_actuation actuation;

static struct jp_devices devices;
static struct jp_hal hal;

static void ignore_frame(void *context, const struct jp_can_frame *frame)
{
    (void)context;
    (void)frame;
}

static void restore(void *argument)
{
    (void)argument;
    devices.imu.state = JP_IMU_FRESH;
    robot = prepared;
}

/** As jp_hal_tick() until the bridges have their duties; the robot gets the sample that its state is made for. */
static void restore_and_control(void *argument)
{
    struct jp_sensors decoded;

    restore(argument);
    (void)hal.read(hal.context, &decoded);
    jp_robot_control(&robot, read, &sensors, &actuation);
    (void)hal.write(hal.context, &actuation);
}

static void restore_and_tick(void *argument)
{
    restore_and_control(argument);
    jp_robot_account(&robot);
}

static void tick(void)
{
    jp_robot_tick(&prepared, JP_OK, &sensors, &actuation);
}

/** The first frame of a robot at rest was seen. Every check runs, none is confirmed. */
static bool prepare_idle(void)
{
    const char *field;

    config = jp_robot_courier24;
    config.monitor.confirm_ticks = UINT16_MAX;
    config.monitor.freeze_ticks = UINT16_MAX;
    config.monitor.residual_ticks = UINT16_MAX;
    read = JP_OK;
    sensors = (struct jp_sensors){.encoder_left = random_bits(),
                                  .encoder_right = random_bits(),
                                  .accel_z = JP_Q24_ONE,
                                  .bus_voltage = JP_Q16(24)};
    if (jp_robot_init(&prepared, &config, &field) != JP_OK) {
        return false;
    }
    tick();
    return true;
}

/** Another frame for the tick to come: new encoder counts, rates, currents and voltage. */
static void change_sensors(void)
{
    sensors.encoder_left += (uint32_t)random_within(5);
    sensors.encoder_right += (uint32_t)random_within(5);
    sensors.pitch_rate += random_within(JP_Q24(0.02));
    sensors.yaw_rate += random_within(JP_Q24(0.02));
    sensors.accel_x += random_within(JP_Q24(0.05));
    sensors.accel_z += random_within(JP_Q24(0.05));
    sensors.current_left = random_within(JP_Q16(5));
    sensors.current_right = random_within(JP_Q16(5));
    sensors.bus_voltage = JP_Q16(24) + random_within(JP_Q16(1));
}

/** Balancing at a random state of motion; a quarter of the states are far off, so that every limit acts. */
static bool prepare_standing(void)
{
    if (!prepare_idle() || jp_robot_enable(&prepared) != JP_OK) {
        return false;
    }
    tick();

    const int32_t scale = (random_bits() & 3U) == 0U ? 60 : 1;

    prepared.internal.estimator.pitch = random_phase(JP_Q24(0.06));
    prepared.internal.estimator.wheel.rate = random_within(JP_Q24(2));
    prepared.internal.estimator.yaw.rate = random_within(JP_Q24(0.2));
    prepared.internal.reference.wheel.angle += random_phase(JP_Q24(0.2) * scale);
    prepared.internal.reference.yaw.angle += random_phase(JP_Q24(0.2) * scale);
    prepared.internal.lqr.wheel_integral = (int64_t)random_within(JP_Q24_ONE) * TICK_RATE * scale;
    prepared.internal.lqr.yaw_integral = (int64_t)random_within(JP_Q24_ONE) * TICK_RATE * scale;
    prepared.internal.odometry.x = (int64_t)random_within(JP_Q24(100)) * 256;
    change_sensors();
    return true;
}

static bool hand_over_segment(void)
{
    const struct jp_segment_command segment = {
        {random_within(JP_Q24(1)), random_within(JP_Q24(0.35))}, random_within(JP_Q24(1.4)), JP_Q16(100)};

    return jp_robot_drive(&prepared, &segment) == JP_OK;
}

static bool prepare_driving(void)
{
    if (!prepare_standing() || !hand_over_segment()) {
        return false;
    }
    tick();
    change_sensors();
    return prepared.internal.telemetry.state == JP_ROBOT_DRIVING;
}

/** Currents and rates contradict each other and every channel repeats itself: all counters count. */
static bool prepare_suspicion(void)
{
    bool driving = prepare_driving();

    tick();
    prepared.internal.monitor.good.encoder_left--;
    sensors.current_left = JP_Q16(15);
    sensors.current_right = JP_Q16(-15);
    return driving;
}

static bool prepare_implausible(void)
{
    bool driving = prepare_driving();

    sensors.pitch_rate = INT32_MIN;
    sensors.yaw_rate = INT32_MAX;
    sensors.accel_z = INT32_MIN;
    sensors.encoder_right += INT32_MAX;
    sensors.current_right = INT32_MIN;
    sensors.bus_voltage = INT32_MIN;
    return driving;
}

static bool prepare_silence(void)
{
    read = JP_ERR_HARDWARE;
    return prepare_driving();
}

static bool prepare_start(void)
{
    return prepare_standing() && hand_over_segment();
}

static bool prepare_next(void)
{
    bool driving = prepare_driving() && hand_over_segment();

    prepared.internal.telemetry.segment_ticks_left = 0;
    return driving;
}

static bool prepare_end(void)
{
    bool driving = prepare_driving();

    prepared.internal.telemetry.segment_ticks_left = 0;
    return driving;
}

static bool prepare_stop(void)
{
    bool driving = prepare_driving();

    jp_robot_stop(&prepared);
    return driving;
}

/** A curve out of the stand. */
static bool hand_over_trajectory(void)
{
    static const struct jp_point targets[] = {{JP_Q16(2), JP_Q16(1)}, {JP_Q16(1), JP_Q16(3)}};
    static struct jp_trajectory_leg legs[2];
    static struct jp_trajectory trajectory;
    const struct jp_trajectory_task task = {
        .config = &config.trajectory, .cruise = JP_Q24(0.5), .targets = targets, .count = 2, .to_stand = true};

    return jp_trajectory_by_rule(&task, legs, &trajectory) == JP_OK &&
           jp_robot_drive_trajectory(&prepared, &trajectory) == JP_OK;
}

static bool prepare_trajectory(void)
{
    return prepare_standing() && hand_over_trajectory();
}

/** Somewhere in the first blend. */
static bool prepare_along(void)
{
    const bool handed = prepare_trajectory();

    tick();
    prepared.internal.trajectory_drive.internal.share = random_bits();
    change_sensors();
    return handed && prepared.internal.telemetry.state == JP_ROBOT_DRIVING;
}

/** In the next tick the other blend begins. */
static bool prepare_blend(void)
{
    const bool along = prepare_along();

    prepared.internal.trajectory_drive.internal.piece = JP_MIDDLE;
    prepared.internal.trajectory_drive.internal.set_points_left = 1;
    return along;
}

static bool prepare_enable(void)
{
    bool idle = prepare_idle();

    change_sensors();
    return idle && jp_robot_enable(&prepared) == JP_OK;
}

/** The controller was reset while it drove. */
static bool prepare_resume(void)
{
    struct jp_snapshot snapshot;
    const char *field;

    if (!prepare_driving()) {
        return false;
    }
    jp_robot_snapshot(&prepared, &snapshot);
    if (jp_robot_init(&prepared, &config, &field) != JP_OK) {
        return false;
    }
    jp_robot_resume(&prepared, &snapshot);
    return true;
}

static bool prepare_fall(void)
{
    bool driving = prepare_driving();

    prepared.internal.estimator.pitch = (jp_phase)JP_Q24(0.2) << 32;
    return driving;
}

static bool prepare_fault(void)
{
    bool driving = prepare_suspicion();

    config.monitor.residual_ticks = 1;
    config.monitor.freeze_ticks = 1;
    return driving;
}

static bool prepare_disable(void)
{
    bool driving = prepare_driving();

    jp_robot_disable(&prepared);
    return driving;
}

struct tick_case {
    const char *name;
    bool (*prepare)(void);
    enum jp_robot_state after;
};

enum { DRIVING = 1, ALONG = 9 };

static const struct tick_case tick_cases[] = {
    {"while balancing", prepare_standing, JP_ROBOT_BALANCING},
    {"while driving", prepare_driving, JP_ROBOT_DRIVING},
    {"while every check suspects", prepare_suspicion, JP_ROBOT_DRIVING},
    {"with an implausible frame", prepare_implausible, JP_ROBOT_DRIVING},
    {"without a frame", prepare_silence, JP_ROBOT_DRIVING},
    {"that begins the first segment", prepare_start, JP_ROBOT_DRIVING},
    {"that begins the next segment", prepare_next, JP_ROBOT_DRIVING},
    {"that ends the last segment", prepare_end, JP_ROBOT_BALANCING},
    {"that begins a trajectory", prepare_trajectory, JP_ROBOT_DRIVING},
    {"along a trajectory", prepare_along, JP_ROBOT_DRIVING},
    {"that begins a blend", prepare_blend, JP_ROBOT_DRIVING},
    {"that stops", prepare_stop, JP_ROBOT_BALANCING},
    {"that switches on", prepare_enable, JP_ROBOT_BALANCING},
    {"that goes on after a reset", prepare_resume, JP_ROBOT_BALANCING},
    {"that finds a fall", prepare_fall, JP_ROBOT_FALLEN},
    {"that finds a fault", prepare_fault, JP_ROBOT_FAULT},
    {"that switches off", prepare_disable, JP_ROBOT_IDLE},
};

#define CASES (sizeof tick_cases / sizeof tick_cases[0])

struct worst {
    uint32_t control; /**< sensor decode to PWM */
    uint32_t tick;    /**< all of it */
};

/** False: a state could not be prepared, or the tick led elsewhere. */
static bool measure(const struct tick_case *tick_case, struct worst *worst)
{
    const uint32_t restoring = target_count_instructions(restore, NULL);

    *worst = (struct worst){0, 0};
    for (int i = 0; i < TICK_STATES; i++) {
        if (!tick_case->prepare()) {
            return false;
        }
        randomise_registers(&devices, &random_state);
        worst->control = target_count_worst(worst->control + restoring, restore_and_control, NULL) - restoring;
        worst->tick = target_count_worst(worst->tick + restoring, restore_and_tick, NULL) - restoring;
        if (jp_robot_state_now(&robot) != tick_case->after) {
            return false;
        }
    }
    return true;
}

static void print_figure(const char *name, const char *detail, uint32_t instructions, uint32_t bar)
{
    target_print("{\"name\": \"" TARGET_CORE ": ");
    target_print(name);
    target_print(detail);
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
    struct worst worst[CASES];
    uint32_t decode_to_pwm = 0;
    uint32_t longest = 0;

    stm32_fake_reset();
    jp_devices_start(&devices, 1000, ignore_frame, NULL);
    hal = jp_devices_hal(&devices);
    for (size_t i = 0; i < CASES; i++) {
        if (!measure(&tick_cases[i], &worst[i])) {
            target_print("a robot left its state\n");
            return 1;
        }
        decode_to_pwm = worst[i].control > decode_to_pwm ? worst[i].control : decode_to_pwm;
        longest = worst[i].tick > longest ? worst[i].tick : longest;
    }
    target_print("[\n");
    print_figure("controller tick (errors, integrators, gain product, limits), worst of 2 000 states", "",
                 worst_update(), UPDATE_BAR);
    target_print(",\n");
    print_figure("sensor decode to PWM, worst of 17 kinds of tick", "", decode_to_pwm, TICK_BAR);
    target_print(",\n");
    print_figure("sensor decode to PWM ", tick_cases[DRIVING].name, worst[DRIVING].control, 0);
    target_print(",\n");
    print_figure("sensor decode to PWM ", tick_cases[ALONG].name, worst[ALONG].control, 0);
    target_print(",\n");
    print_figure("whole tick, odometry, energy and motor checks after the PWM included, worst", "", longest, 0);
    target_print("\n]\n");
    return 0;
}
