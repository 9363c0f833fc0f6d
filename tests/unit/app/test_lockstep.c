/* The application under the simulator's time: a tick for each SimTime, power, reset, bus-off, another ECU. */
#include <joulepath/tables.h>

#include "hal/app/lockstep.h"

#include <string.h>

#include "hal/can/jp_can.h"
#include "tests/support/ecu_start.h"
#include "tests/support/map_frames.h"
#include "unity.h"

static struct jp_lockstep lockstep;
static struct jp_retained retained;
static unsigned ticks;
static unsigned answers;
static uint32_t answered_tick;
static unsigned motor_commands;
static unsigned frames_at_answer;
static unsigned frames;
static uint8_t sample_counter;

static enum jp_status send(void *context, const struct jp_can_frame *frame)
{
    (void)context;
    frames++;
    if (frame->id == JP_CAN_SIM_DONE_FRAME_ID) {
        struct jp_can_sim_done_t done;

        (void)jp_can_sim_done_unpack(&done, frame->data, frame->length);
        answers++;
        answered_tick = done.tick;
        frames_at_answer = frames;
    }
    motor_commands += frame->id == JP_CAN_MOTOR_COMMAND_FRAME_ID ? 1U : 0U;
    return JP_OK;
}

static enum jp_can_state always_on(void *context)
{
    (void)context;
    return JP_CAN_ON;
}

static void tick(struct jp_ecu *ecu)
{
    ticks++;
    jp_ecu_tick(ecu);
}

/* What a boot does besides: the tests set it. */
static const struct jp_ecu_learning *learning;
static struct jp_navigation *navigator;
static struct jp_navigation_config navigator_config;

static enum jp_status boot(void *context, struct jp_ecu *ecu, const struct jp_can_port *to, const char **field)
{
    enum jp_status status =
        ecu_start(ecu, context, &jp_robot_courier24, &jp_energy_model_courier24, to, &retained, field);

    if (status == JP_OK && learning != NULL) {
        status = jp_ecu_balancer_learn(context, learning, field);
    }
    if (status == JP_OK && navigator != NULL) {
        status = navigation_start(navigator, &navigator_config, &((struct jp_ecu_balancer *)context)->pilot, field);
        jp_ecu_navigate(ecu, navigator);
    }
    return status;
}

static struct jp_ecu_balancer balancer;
static const struct jp_lockstep_config config = {
    .boot = boot, .context = &balancer, .tick = tick, .bus = {NULL, send, always_on}, .retained = &retained};

static void start(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_lockstep_start(&lockstep, &config, &field));
}

static bool give_sample(void);

void setUp(void)
{
    memset(&retained, 0, sizeof retained);
    ticks = 0;
    answers = 0;
    motor_commands = 0;
    frames = 0;
    sample_counter = 0;
    learning = NULL;
    navigator = NULL;
    start();
    /* The first one only begins the sequence. */
    (void)give_sample();
}

void tearDown(void)
{
}

static struct jp_can_frame sim_time(uint32_t number, uint8_t power, uint8_t reset, uint8_t bus_off)
{
    const struct jp_can_sim_time_t signals = {.tick = number, .power = power, .reset = reset, .bus_off = bus_off};
    struct jp_can_frame frame = {.id = JP_CAN_SIM_TIME_FRAME_ID, .length = JP_CAN_SIM_TIME_LENGTH};

    (void)jp_can_sim_time_pack(frame.data, &signals, sizeof frame.data);
    return frame;
}

static void pass(uint32_t number, uint8_t power, uint8_t reset, uint8_t bus_off)
{
    const struct jp_can_frame frame = sim_time(number, power, reset, bus_off);

    TEST_ASSERT_FALSE(jp_lockstep_accept(&lockstep, &frame));
}

static bool give_sample(void)
{
    const struct jp_sensors sensors = {.accel_z = JP_Q24_ONE, .bus_voltage = JP_Q16(24)};
    struct jp_can_frame parts[JP_SAMPLE_PARTS];
    bool complete = false;

    jp_message_from_sensors(parts, &sample_counter, &sensors);
    for (int part = 0; part < JP_SAMPLE_PARTS; part++) {
        complete = jp_lockstep_accept(&lockstep, &parts[part]);
    }
    return complete;
}

static void expect_refused(struct jp_lockstep_config refused)
{
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lockstep_start(&lockstep, &refused, &field));
}

static void test_start_refuses_null(void)
{
    struct jp_lockstep_config refused = config;
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lockstep_start(NULL, &config, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lockstep_start(&lockstep, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lockstep_start(&lockstep, &config, NULL));
    refused.boot = NULL;
    expect_refused(refused);
    refused = config;
    refused.tick = NULL;
    expect_refused(refused);
    refused = config;
    refused.retained = NULL;
    expect_refused(refused);
    refused = config;
    refused.context = NULL;
    expect_refused(refused); /* by the boot */
}

static void test_each_time_runs_one_tick_and_is_answered_after_it(void)
{
    for (uint32_t number = 5; number < 25; number++) {
        pass(number, 1, 0, 0);
        TEST_ASSERT_EQUAL_UINT32(number, answered_tick);
        TEST_ASSERT_EQUAL_UINT(frames, frames_at_answer);
    }
    TEST_ASSERT_EQUAL_UINT(20, ticks);
    TEST_ASSERT_EQUAL_UINT(20, answers);
}

static void test_a_time_that_comes_again_is_only_answered_again(void)
{
    pass(7, 1, 0, 0);
    pass(7, 1, 0, 0);
    TEST_ASSERT_EQUAL_UINT(1, ticks);
    TEST_ASSERT_EQUAL_UINT(2, answers);
    TEST_ASSERT_EQUAL_UINT32(7, answered_tick);
}

static void test_a_time_of_another_length_is_no_time(void)
{
    struct jp_can_frame frame = sim_time(1, 1, 0, 0);

    frame.length--;
    TEST_ASSERT_FALSE(jp_lockstep_accept(&lockstep, &frame));
    TEST_ASSERT_EQUAL_UINT(0, ticks);
    TEST_ASSERT_EQUAL_UINT(0, answers);
}

static void test_a_sample_is_told_and_used_in_the_next_tick(void)
{
    pass(1, 1, 0, 0);
    TEST_ASSERT_EQUAL_UINT(0, motor_commands);
    TEST_ASSERT_TRUE(give_sample());
    pass(2, 1, 0, 0);
    TEST_ASSERT_EQUAL_UINT(1, motor_commands);
}

static void test_reset_holds_the_application_and_counts(void)
{
    (void)give_sample();
    pass(1, 1, 0, 0);
    pass(2, 1, 1, 0);
    pass(3, 1, 1, 0);
    TEST_ASSERT_EQUAL_UINT(1, ticks);
    TEST_ASSERT_EQUAL_UINT(3, answers);
    TEST_ASSERT_FALSE(give_sample());
    pass(4, 1, 0, 0);
    TEST_ASSERT_EQUAL_UINT(2, ticks);
    TEST_ASSERT_EQUAL_UINT32(1, lockstep.ecu.resets);
}

static void test_without_power_the_record_is_lost(void)
{
    (void)give_sample();
    pass(1, 1, 0, 0);
    TEST_ASSERT_NOT_NULL(jp_retained_newest(&retained));
    pass(2, 0, 0, 0);
    TEST_ASSERT_NULL(jp_retained_newest(&retained));
    pass(3, 1, 0, 0);
    TEST_ASSERT_EQUAL_UINT32(0, lockstep.ecu.resets);
}

/* What was learned and not stored is lost with the power. */
static void test_after_each_boot_it_learns_on_from_what_is_stored(void)
{
    struct jp_learned_state state;
    const struct jp_ecu_learning stored = {
        .learning = &jp_learning_courier24, .stored = JP_STORED_TAKEN, .state = &state};

    jp_learned_state_start(&state, jp_learning_courier24.identity);
    state.version = 5;
    learning = &stored;
    start();
    balancer.pilot.learner.state.version = 8;
    state.version = 7;
    pass(1, 0, 0, 0);
    pass(2, 1, 0, 0);
    TEST_ASSERT_EQUAL_UINT32(7, jp_ecu_learned_state(&lockstep.ecu)->version);
    TEST_ASSERT_NOT_EQUAL(&jp_energy_model_courier24, jp_ecu_balancer_model(&balancer));
}

static void test_what_the_boot_refuses_is_named(void)
{
    struct jp_learning bad = jp_learning_courier24;
    const struct jp_ecu_learning refused = {.learning = &bad};
    const char *field = "";

    bad.memory = 0;
    learning = &refused;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_lockstep_start(&lockstep, &config, &field));
    TEST_ASSERT_EQUAL_STRING("learning.memory", field);
}

static void test_off_the_bus_nothing_arrives_and_nothing_leaves_but_the_answer(void)
{
    (void)give_sample();
    pass(1, 1, 0, 1);
    TEST_ASSERT_EQUAL_UINT(0, motor_commands);
    TEST_ASSERT_EQUAL_UINT(1, answers);
    TEST_ASSERT_EQUAL_UINT8(1, lockstep.ecu.bus_offs);
    TEST_ASSERT_FALSE(give_sample());
    pass(2, 1, 0, 0);
    TEST_ASSERT_TRUE(give_sample());
}

static void test_the_answer_is_left_to_another_ecu_that_drives(void)
{
    const struct jp_can_frame others = {.id = JP_CAN_SIM_DONE_FRAME_ID, .length = JP_CAN_SIM_DONE_LENGTH};

    pass(1, 1, 0, 0);
    TEST_ASSERT_EQUAL_UINT(1, answers);
    (void)jp_lockstep_accept(&lockstep, &others);
    pass(2, 1, 0, 0);
    TEST_ASSERT_EQUAL_UINT(1, answers);
    pass(3, 1, 0, 0);
    TEST_ASSERT_EQUAL_UINT(2, answers);
    lockstep.ecu.internal.owns_bridges = true;
    (void)jp_lockstep_accept(&lockstep, &others);
    pass(4, 1, 0, 0);
    TEST_ASSERT_EQUAL_UINT(3, answers);
}

static bool give_sample_in_real_time(void)
{
    const struct jp_sensors sensors = {.accel_z = JP_Q24_ONE, .bus_voltage = JP_Q16(24)};
    struct jp_can_frame parts[JP_SAMPLE_PARTS];
    bool complete = false;

    jp_message_from_sensors(parts, &sample_counter, &sensors);
    for (int part = 0; part < JP_SAMPLE_PARTS; part++) {
        complete = jp_ecu_accept(&lockstep.ecu, &parts[part]);
    }
    return complete;
}

static void test_in_real_time_the_simulators_time_changes_nothing(void)
{
    const struct jp_can_frame times[] = {sim_time(1, 0, 0, 0), sim_time(2, 1, 1, 0), sim_time(3, 1, 0, 1)};

    for (unsigned i = 0; i < sizeof times / sizeof times[0]; i++) {
        TEST_ASSERT_FALSE(jp_ecu_accept(&lockstep.ecu, &times[i]));
        TEST_ASSERT_TRUE(give_sample_in_real_time());
        jp_ecu_tick(&lockstep.ecu);
        TEST_ASSERT_EQUAL_UINT(i + 1U, motor_commands);
        TEST_ASSERT_EQUAL_UINT16(i + 1U, lockstep.ecu.unknown_frames);
    }
    TEST_ASSERT_EQUAL_UINT(0, answers);
    TEST_ASSERT_EQUAL_UINT8(0, lockstep.ecu.bus_offs);
    TEST_ASSERT_NOT_NULL(jp_retained_newest(&retained));
}

/* The navigator. */

static struct jp_navigation navigation;
static uint64_t memory[3][8];
static uint8_t seen[64];
static struct jp_course_leg legs[2];
static const struct jp_navigation_config sound_navigator = {.lattice = &jp_lattice_courier24,
                                                            .body = &jp_navigation_courier24,
                                                            .map = memory[0],
                                                            .map_size = sizeof memory[0],
                                                            .planner = memory[1],
                                                            .planner_size = sizeof memory[1],
                                                            .way = memory[2],
                                                            .way_size = sizeof memory[2],
                                                            .seen = seen,
                                                            .seen_size = sizeof seen,
                                                            .legs = legs,
                                                            .legs_max = 2};

static void test_it_navigates_again_after_each_boot_and_has_no_map(void)
{
    static const uint8_t stream[30] = {1, 0, 1, 0};
    struct sent_map sent = {.bytes = stream, .length = sizeof stream, .id = 3};
    const struct jp_can_frame offer = map_offer(&sent);

    navigator = &navigation;
    navigator_config = sound_navigator;
    start();
    pass(0, 1, 0, 0);
    (void)jp_lockstep_accept(&lockstep, &offer);
    pass(1, 1, 0, 0);
    TEST_ASSERT_EQUAL_INT(JP_MAP_LINK_RECEIVING, navigation.maps.state);
    pass(2, 1, 1, 0);
    pass(3, 1, 0, 0);
    TEST_ASSERT_EQUAL_PTR(&navigation, lockstep.ecu.internal.navigation);
    TEST_ASSERT_EQUAL_INT(JP_MAP_LINK_NONE, navigation.maps.state);
    (void)jp_lockstep_accept(&lockstep, &offer);
    pass(4, 1, 0, 0);
    TEST_ASSERT_EQUAL_INT(JP_MAP_LINK_RECEIVING, navigation.maps.state);
}
