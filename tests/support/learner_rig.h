/** A learner in a test, and robots for it that differ from their file in ways that are known. */
#ifndef JOULEPATH_TESTS_SUPPORT_LEARNER_RIG_H
#define JOULEPATH_TESTS_SUPPORT_LEARNER_RIG_H

#include <joulepath/learner.h>
#include <joulepath/tables.h>

#include <string.h>

#include "tests/target/random.h"
#include "unity.h"

#define BUILT_IN jp_energy_model_courier24_battery
#define HORIZON  jp_horizon_courier24_battery
#define LEARNING jp_learning_courier24_battery

#define N JP_LEARNING_DIRECTIONS

static struct jp_learner learner;
static struct jp_learning learning;
static struct jp_learned_state state;
static struct jp_energy_start start;
static uint32_t random_state;
static const char *field;

void setUp(void)
{
    learning = LEARNING;
    jp_learner_start(&learner, &learning, &BUILT_IN, &HORIZON);
    state = learner.state;
    start = (struct jp_energy_start){.motion = {0, 0}};
    random_state = 1;
    field = NULL;
}

void tearDown(void)
{
}

/* Between low and high. */
static int32_t draw(int32_t low, int32_t high)
{
    return low + (int32_t)(((uint64_t)target_random(&random_state) * (uint32_t)(high - low)) >> 32);
}

static inline struct jp_segment_command random_segment(void)
{
    return (struct jp_segment_command){
        {draw(0, JP_Q24_ONE), draw(-JP_Q24(0.35), JP_Q24(0.35))}, draw(-JP_Q24(1), JP_Q24(1)), draw(32768, JP_Q16(10))};
}

/* A robot that is x along the directions; its energy, without noise, as a learner with this x expects it. */
static inline jp_q16 energy_of(const jp_q24 x[N], const struct jp_segment_command *segment)
{
    struct jp_learner robot = learner;
    struct jp_forecast_sum sum = {0, {0}, 0};
    struct jp_energy_start from = start;

    memcpy(robot.state.x, x, sizeof robot.state.x);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_add(&robot, &sum, &from, segment));
    return (jp_q16)sum.energy;
}

static inline enum jp_learned drive(const struct jp_segment_command *segment, jp_q16 measured)
{
    enum jp_learned learned = JP_LEARNED;
    jp_q16 energy;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_learner_update(&learner, &start, segment, measured, &learned));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_energy_forecast(&BUILT_IN, &HORIZON, &start, segment, &energy, &start));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_learned_state_check(&learner.state, &field));
    return learned;
}

static inline unsigned drive_as(const jp_q24 x[N], unsigned segments)
{
    unsigned taken = 0;

    for (unsigned i = 0; i < segments; i++) {
        const struct jp_segment_command segment = random_segment();

        taken += drive(&segment, energy_of(x, &segment)) == JP_LEARNED ? 1U : 0U;
    }
    return taken;
}

#endif
