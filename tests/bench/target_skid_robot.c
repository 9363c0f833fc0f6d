/**
 * Instructions of a tick of the skid-steered robot, sensors to duties and all that follows them: the worst over random
 * states and readings, for each thing that a tick can do.
 */
#include <joulepath/line_path.h>
#include <joulepath/path_corner.h>
#include <joulepath/skid_path_energy.h>
#include <joulepath/skid_robot.h>
#include <joulepath/tables.h>
#include <stddef.h>

#include "tests/target/cycles.h"
#include "tests/target/random.h"
#include "tests/target/target.h"

enum { STATES = 120, SEED = 2018 };

/* A bar of 0 is none. */
#if defined __ARM_ARCH_7EM__
enum { TICK_BAR = 2000 };
#else
enum { TICK_BAR = 0 };
#endif

static uint32_t random_state = SEED;

static struct jp_lattice_path path;

static struct jp_skid_robot_config config;
static struct jp_skid_robot prepared;
static struct jp_skid_robot robot;
static struct jp_sensors sensors;
static enum jp_status read;
static struct jp_actuation actuation;

static uint32_t random_bits(void)
{
    return target_random(&random_state);
}

static int32_t random_within(int32_t limit)
{
    return (int32_t)(((uint64_t)random_bits() * (2U * (uint32_t)limit + 1U)) >> 32) - limit;
}

static void restore(void *argument)
{
    (void)argument;
    robot = prepared;
}

static void restore_and_control(void *argument)
{
    restore(argument);
    jp_skid_robot_control(&robot, read, &sensors, &actuation);
}

static void restore_and_tick(void *argument)
{
    restore_and_control(argument);
    jp_skid_robot_account(&robot);
}

static void change_sensors(void)
{
    sensors.encoder_left += (uint32_t)random_within(150);
    sensors.encoder_right += (uint32_t)random_within(150);
    sensors.pitch_rate += random_within(JP_Q24(0.005));
    sensors.yaw_rate += random_within(JP_Q24(0.005));
    sensors.accel_x = random_within(JP_Q24(0.1));
    sensors.accel_z = JP_Q24_ONE + random_within(JP_Q24(0.05));
    sensors.current_left = random_within(JP_Q16(10));
    sensors.current_right = random_within(JP_Q16(10));
    sensors.bus_voltage = JP_Q16(46) + random_within(JP_Q16(1));
}

static void tick(void)
{
    jp_skid_robot_tick(&prepared, JP_OK, &sensors, &actuation);
    change_sensors();
}

/** No frame was seen yet. */
static bool prepare_begin(void)
{
    const char *field;

    /* Every check runs, none is confirmed. */
    config = jp_skid_robot_zhang2018;
    config.monitor.confirm_ticks = UINT16_MAX;
    config.monitor.freeze_ticks = UINT16_MAX;
    config.monitor.residual_ticks = UINT16_MAX;
    config.wheels.slope_calls = UINT16_MAX;
    config.wheels.stall_calls = UINT16_MAX;
    config.wheels.contradicted_calls = UINT16_MAX;
    read = JP_OK;
    sensors = (struct jp_sensors){.encoder_left = random_bits(), .encoder_right = random_bits()};
    change_sensors();
    return jp_skid_robot_init(&prepared, &config, &field) == JP_OK;
}

/** While it wakes, and after it. */
static bool prepare_idle(void)
{
    const bool is_prepared = prepare_begin();

    for (uint32_t ticks = 1 + random_bits() % (2 * JP_SKID_WAKE_TICKS); ticks > 0; ticks--) {
        tick();
    }
    return is_prepared;
}

static bool prepare_standing(void)
{
    if (!prepare_begin()) {
        return false;
    }
    for (int i = 0; i < JP_SKID_WAKE_TICKS + 2; i++) {
        tick();
    }
    if (jp_skid_robot_enable(&prepared) != JP_OK) {
        return false;
    }
    for (uint32_t ticks = 2 + random_bits() % 16; ticks > 0; ticks--) {
        tick();
    }
    return true;
}

static bool hand_over(void)
{
    const struct jp_skid_command command = {.motion = {random_within(JP_Q24(0.5)), random_within(JP_Q24(0.4))},
                                            .duration = JP_Q16(10)};

    return jp_skid_robot_drive(&prepared, &command) == JP_OK;
}

static bool prepare_command(void)
{
    return prepare_standing() && hand_over();
}

/** At a random part of a speeding-up, and in a quarter of the states far behind, so that every limit acts. */
static bool prepare_driving(void)
{
    if (!prepare_command()) {
        return false;
    }
    for (uint32_t ticks = 2 + random_bits() % 40; ticks > 0; ticks--) {
        tick();
    }
    if ((random_bits() & 3U) == 0U) {
        prepared.internal.control.sides[JP_SKID_LEFT].rate = random_within(JP_Q24(2));
        prepared.internal.control.sides[JP_SKID_RIGHT].behind = JP_PHASE_TURN / 4;
    }
    return true;
}

/** Turns on the spot, lines, and an arc. */
static bool plan_path(void)
{
    static const struct jp_point targets[] = {{JP_Q16(0.3), JP_Q16(0.1)}, {JP_Q16(0.5), JP_Q16(0.4)}};
    static struct jp_path_piece pieces[JP_LINE_PATH_PIECES(2)];
    const struct jp_line_route route = {.targets = targets, .count = 2};
    const struct jp_motion_price price = jp_skid_motion_price(&jp_skid_energy_zhang2018, 0);
    struct jp_path_cost cost;

    if (jp_line_path(&path, pieces, (uint16_t)JP_LINE_PATH_PIECES(2), &route) != JP_OK) {
        return false;
    }
    if ((random_bits() & 1U) != 0U) {
        const struct jp_corner_room room = {JP_Q24(0.1), 0};

        (void)jp_path_round_corner(&path, 2, &room, &jp_path_limits_zhang2018, &price);
    }
    return jp_path_plan_speeds(&path, &jp_path_limits_zhang2018, &price, &cost) == JP_OK;
}

/** At a random place of it, which odometry has left by some centimetres. */
static bool prepare_following(void)
{
    const bool is_standing = prepare_standing();

    /* Its wheels turned as it was switched on. */
    prepared.internal.reference = (struct jp_motion){0, 0};
    prepared.internal.state = JP_SKID_ROBOT_STANDING;
    if (!is_standing || !plan_path() || jp_skid_robot_follow(&prepared, &path) != JP_OK) {
        return false;
    }
    for (uint32_t ticks = 2 + random_bits() % 3000; ticks > 0; ticks--) {
        tick();
    }
    prepared.internal.odometry.x += random_within(JP_Q24(1)) * (int64_t)16;
    return true;
}

static bool prepare_stop(void)
{
    const bool driving = prepare_driving();

    jp_skid_robot_stop(&prepared);
    return driving;
}

static bool prepare_fault(void)
{
    const bool driving = prepare_driving();

    config.monitor.confirm_ticks = 1;
    read = JP_ERR_HARDWARE;
    return driving;
}

static bool prepare_stall(void)
{
    const bool driving = prepare_driving();

    prepared.internal.found = JP_FAULT_STALLED_LEFT;
    return driving;
}

static bool prepare_disable(void)
{
    const bool driving = prepare_driving();

    jp_skid_robot_disable(&prepared);
    return driving;
}

struct tick_case {
    const char *name;
    bool (*prepare)(void);
};

static const struct tick_case tick_cases[] = {
    {"of the first frame", prepare_begin},  {"of an idle robot", prepare_idle},
    {"while standing", prepare_standing},   {"that takes a command", prepare_command},
    {"while driving", prepare_driving},     {"that stops", prepare_stop},
    {"that finds a fault", prepare_fault},  {"that finds a stalled side", prepare_stall},
    {"that switches off", prepare_disable}, {"on a path", prepare_following},
};

#define CASES (sizeof tick_cases / sizeof tick_cases[0])

struct worst {
    uint32_t control; /**< sensors to duties */
    uint32_t tick;    /**< all of it */
};

static bool measure(const struct tick_case *tick_case, struct worst *worst)
{
    const uint32_t restoring = target_count_instructions(restore, NULL);

    *worst = (struct worst){0, 0};
    for (int i = 0; i < STATES; i++) {
        if (!tick_case->prepare()) {
            return false;
        }
        worst->control = target_count_worst(worst->control + restoring, restore_and_control, NULL) - restoring;
        worst->tick = target_count_worst(worst->tick + restoring, restore_and_tick, NULL) - restoring;
    }
    return true;
}

static void print_figure(const char *name, const char *detail, uint32_t instructions, uint32_t bar)
{
    target_print("{\"name\": \"" TARGET_CORE ": tick of the skid-steered robot");
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
    struct worst longest = {0, 0};

    target_print("[\n");
    for (size_t i = 0; i < CASES; i++) {
        struct worst worst;

        if (!measure(&tick_cases[i], &worst)) {
            target_print("a state could not be prepared\n");
            return 1;
        }
        longest.control = worst.control > longest.control ? worst.control : longest.control;
        longest.tick = worst.tick > longest.tick ? worst.tick : longest.tick;
        print_figure(" ", tick_cases[i].name, worst.tick, 0);
        target_print(",\n");
    }
    print_figure(", sensors to duties, worst", "", longest.control, 0);
    target_print(",\n");
    print_figure(", worst of 10 kinds", "", longest.tick, TICK_BAR);
    target_print("\n]\n");
    return 0;
}
