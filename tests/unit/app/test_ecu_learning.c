/* The application learns: tables, reports, the model of a route, the stored state. */
#include "tests/support/ecu_rig.h"

#define LEARNED        0x12
#define LEARNER_STATUS 0x13

static struct jp_ecu_learning learning;
static struct jp_learned_state state;

static struct jp_can_learner_status_t learner_status(void)
{
    struct jp_can_learner_status_t signals;

    TEST_ASSERT_EQUAL_INT(0, jp_can_learner_status_unpack(&signals, bus.last[LEARNER_STATUS], JP_CAN_LENGTH_MAX));
    return signals;
}

static struct jp_can_learned_t learned(void)
{
    struct jp_can_learned_t signals;

    TEST_ASSERT_EQUAL_INT(0, jp_can_learned_unpack(&signals, bus.last[LEARNED], JP_CAN_LENGTH_MAX));
    return signals;
}

static void learn(enum jp_stored stored)
{
    const char *field = "";

    learning = (struct jp_ecu_learning){.learning = &jp_learning_courier24, .stored = stored, .state = &state};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_ecu_balancer_learn(&balancer, &learning, &field));
}

static void drive_route(uint8_t route)
{
    offer(route, near_route, 2);
    for (int i = 0; i < 100 && (i < 5 || ecu.internal.routes.state == JP_ROUTE_DRIVING); i++) {
        hold(JP_MODE_DRIVE, route, 1);
    }
    expect_route(JP_ROUTE_DONE, JP_REASON_NONE);
}

static void test_tables_out_of_range_are_refused_by_name(void)
{
    const char *field = "";
    struct jp_learning bad_learning = jp_learning_courier24;
    struct jp_ecu_learning bad = {.learning = &bad_learning};

    bad_learning.identity = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_ecu_balancer_learn(&balancer, &bad, &field));
    TEST_ASSERT_EQUAL_STRING("learning.identity", field);
    bad_learning.identity = 1;
    bad.learning = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_balancer_learn(&balancer, &bad, &field));
    TEST_ASSERT_NULL(jp_ecu_learned_state(&ecu));
    bad.learning = &bad_learning;
    bad.stored = JP_STORED_TAKEN;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_balancer_learn(&balancer, &bad, &field));
    bad.stored = JP_STORED_NOTHING;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_balancer_learn(&balancer, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_balancer_learn(NULL, &bad, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_balancer_learn(&balancer, &bad, NULL));
    TEST_ASSERT_EQUAL_PTR(&jp_energy_model_courier24, jp_ecu_balancer_model(&balancer));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_ecu_balancer_learn(&balancer, &bad, &field));
}

static void test_without_tables_nothing_is_learned_or_told(void)
{
    make_balancing();
    drive_route(7);
    TEST_ASSERT_EQUAL_UINT16(0, bus.counts[LEARNED]);
    TEST_ASSERT_EQUAL_UINT16(0, bus.counts[LEARNER_STATUS]);
    TEST_ASSERT_NULL(jp_ecu_learned_state(&ecu));
}

static void test_what_was_learned_is_told_every_second(void)
{
    learn(JP_STORED_NOTHING);
    run(10000);
    TEST_ASSERT_UINT_WITHIN(1, 10, bus.counts[LEARNED]);
    TEST_ASSERT_UINT_WITHIN(1, 10, bus.counts[LEARNER_STATUS]);
    TEST_ASSERT_LESS_OR_EQUAL_UINT(3, bus.most_in_a_tick);
    TEST_ASSERT_EQUAL_UINT16(4096, learned().friction);
    TEST_ASSERT_EQUAL_INT16(0, learned().payload);
    TEST_ASSERT_EQUAL_UINT16(0, learner_status().version);
    TEST_ASSERT_EQUAL_UINT8(JP_STORED_NOTHING, learner_status().stored);
}

/* Its wheels are held: what is learned is nonsense, but learned it is. */
static void test_each_segment_of_a_route_is_taken_and_told(void)
{
    jp_q16 friction;
    jp_q16 payload;

    learn(JP_STORED_NOTHING);
    make_driving();
    for (uint16_t segment = 1; segment <= 2; segment++) {
        while (jp_robot_last_tick(&balancer.robot)->segments_ended < segment) {
            hold(JP_MODE_DRIVE, 7, 1);
        }
        run(5);
        TEST_ASSERT_EQUAL_UINT32(segment, balancer.pilot.legs_learned_from + balancer.pilot.legs_left_out);
        TEST_ASSERT_EQUAL_UINT32(segment, ecu.internal.segments_told);
    }
    TEST_ASSERT_EQUAL_UINT16(balancer.pilot.learner.state.version, learner_status().version);
    TEST_ASSERT_EQUAL_UINT8(balancer.pilot.legs_left_out, learner_status().left_out);
    TEST_ASSERT_EQUAL_UINT8(balancer.pilot.evidence, learner_status().evidence);
    TEST_ASSERT_EQUAL_PTR(&balancer.pilot.learner.state, jp_ecu_learned_state(&ecu));
    jp_learner_causes(&balancer.pilot.learner, &friction, &payload);
    TEST_ASSERT_INT_WITHIN(1, friction >> 4, learned().friction);
}

/* Of one segment nothing is lost while frames of the report before wait. */
static void test_a_report_waits_for_the_one_before(void)
{
    learn(JP_STORED_NOTHING);
    make_balancing();
    for (unsigned i = 0; i < 2; i++) {
        ecu.internal.learned.frames[i] = (struct jp_can_frame){.id = JP_CAN_LEARNED_FRAME_ID, .length = 8};
    }
    ecu.internal.learned.left = 2;
    ecu.internal.told_tick = ecu.tick - 2000U;
    balancer.pilot.learner.state.version = 9;
    jp_ecu_work(&ecu);
    TEST_ASSERT_EQUAL_UINT8(0, ecu.internal.learned.frames[0].data[0]);
    tick();
    tick();
    jp_ecu_work(&ecu);
    TEST_ASSERT_EQUAL_UINT8(9, ecu.internal.learned.frames[0].data[0]);
    TEST_ASSERT_EQUAL_UINT8(2, ecu.internal.learned.left);
}

static void expect_model(const struct jp_energy_model *expected)
{
    TEST_ASSERT_EQUAL_MEMORY(expected, jp_ecu_balancer_model(&balancer), sizeof *expected);
}

static void test_a_route_is_planned_with_what_was_known_when_it_began(void)
{
    struct jp_energy_model then;

    learn(JP_STORED_NOTHING);
    TEST_ASSERT_NOT_EQUAL(&jp_energy_model_courier24, jp_ecu_balancer_model(&balancer));
    expect_model(&jp_energy_model_courier24);
    make_driving();
    then = *jp_ecu_balancer_model(&balancer);
    balancer.pilot.learner.state.x[0] = JP_Q24(1.5);
    hold(JP_MODE_DRIVE, 7, 1);
    expect_model(&then);
    for (int i = 0; i < 100 && ecu.internal.routes.state == JP_ROUTE_DRIVING; i++) {
        hold(JP_MODE_DRIVE, 7, 1);
    }
    expect_model(&then);
    balancer.pilot.learner.state.x[0] = JP_Q24(1.5);
    offer(8, near_route, 2);
    hold(JP_MODE_DRIVE, 8, 4);
    expect_route(JP_ROUTE_DRIVING, JP_REASON_NONE);
    jp_learner_model(&balancer.pilot.learner, &then);
    expect_model(&then);
    TEST_ASSERT_TRUE(memcmp(&jp_energy_model_courier24, &then, sizeof then) != 0);
}

/* The tick may be telling of it at that moment. */
static void test_the_model_in_use_is_not_written_over(void)
{
    const struct jp_energy_model *in_use;
    struct jp_energy_model then;

    learn(JP_STORED_NOTHING);
    make_balancing();
    for (uint8_t route = 7; route < 10U; route++) {
        in_use = jp_ecu_balancer_model(&balancer);
        then = *in_use;
        balancer.pilot.learner.state.x[0] += JP_Q24(0.5);
        offer(route, near_route, 2);
        hold(JP_MODE_DRIVE, route, 4);
        expect_route(JP_ROUTE_DRIVING, JP_REASON_NONE);
        TEST_ASSERT_NOT_EQUAL(in_use, jp_ecu_balancer_model(&balancer));
        TEST_ASSERT_TRUE(memcmp(&then, jp_ecu_balancer_model(&balancer), sizeof then) != 0);
        TEST_ASSERT_EQUAL_MEMORY(&then, in_use, sizeof then);
        hold(JP_MODE_STAND, 0, 1);
    }
}

static void expect_stored(enum jp_stored stored, uint32_t version)
{
    run(1010);
    TEST_ASSERT_EQUAL_INT(stored, balancer.stored);
    TEST_ASSERT_EQUAL_UINT8(stored, learner_status().stored);
    TEST_ASSERT_EQUAL_UINT16(version, learner_status().version);
}

static void test_it_goes_on_from_the_stored_state(void)
{
    struct jp_energy_model expected;

    jp_learned_state_start(&state, jp_learning_courier24.identity);
    state.x[0] = -JP_Q24(1);
    state.version = 31;
    learn(JP_STORED_TAKEN);
    TEST_ASSERT_EQUAL_MEMORY(&state, jp_ecu_learned_state(&ecu), sizeof state);
    jp_learner_model(&balancer.pilot.learner, &expected);
    expect_model(&expected);
    TEST_ASSERT_TRUE(memcmp(&jp_energy_model_courier24, &expected, sizeof expected) != 0);
    expect_stored(JP_STORED_TAKEN, 31);
}

static void expect_built_in(enum jp_stored given, enum jp_stored stored)
{
    start(1000);
    learn(given);
    expect_model(&jp_energy_model_courier24);
    expect_stored(stored, 0);
}

static void test_a_stored_state_that_does_not_fit_is_named(void)
{
    jp_learned_state_start(&state, jp_learning_courier24.identity + 1U);
    state.x[0] = JP_Q24(1);
    state.version = 31;
    expect_built_in(JP_STORED_TAKEN, JP_STORED_OTHER_TABLES);
    expect_built_in(JP_STORED_OTHER_ROBOT, JP_STORED_OTHER_ROBOT);
    expect_built_in(JP_STORED_OTHER_VERSION, JP_STORED_OTHER_VERSION);
    expect_built_in(JP_STORED_DAMAGED, JP_STORED_DAMAGED);
    /* Other parameters were stored before anything was learned. */
    state.identity = 0;
    expect_built_in(JP_STORED_TAKEN, JP_STORED_NOTHING);
}
