/** A pilot of a skid-steered robot whose wheels turn as its controller asks, for the tests of the pilot. */
#ifndef JOULEPATH_TESTS_SUPPORT_SKID_PILOT_RIG_H
#define JOULEPATH_TESTS_SUPPORT_SKID_PILOT_RIG_H

#include <joulepath/skid_pilot.h>

#include "tests/support/skid_robot_rig.h"

#define TARGETS_MAX 4U
#define TICKS_MAX   (120 * RATE)

/* Two corners to the left. */
static const struct jp_point square[] = {{JP_Q16(4), 0}, {JP_Q16(4), JP_Q16(4)}, {0, JP_Q16(4)}};
#define SQUARE (sizeof square / sizeof square[0])

static struct jp_skid_energy_model model;
static struct jp_skid_learning learning;
static struct jp_path_piece pieces[JP_SKID_PILOT_PIECES(TARGETS_MAX)];
static struct jp_skid_pilot_config pilot_config;
static struct jp_skid_pilot pilot;
static struct jp_forecast forecast;

static inline void init_pilot(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_init(&pilot, &pilot_config, &robot, &field));
}

static inline void set_up_pilot(void)
{
    model = jp_skid_energy_zhang2018;
    learning = jp_skid_learning_zhang2018;
    pilot_config = (struct jp_skid_pilot_config){.model = &model,
                                                 .learning = &learning,
                                                 .limits = jp_path_limits_zhang2018,
                                                 .pieces = pieces,
                                                 .places = sizeof pieces / sizeof pieces[0]};
    forecast = (struct jp_forecast){-1, -1};
    init_pilot();
    make_standing();
}

/** With corners that may be passed so far inside, m. */
static inline void set_up_corners(jp_q24 corner)
{
    pilot_config.corner = corner;
    init_pilot();
}

static inline struct jp_skid_pilot_route route_of(const struct jp_point *targets, uint16_t count)
{
    return (struct jp_skid_pilot_route){.targets = targets, .count = count};
}

static inline enum jp_status follow(const struct jp_point *targets, uint16_t count)
{
    const struct jp_skid_pilot_route route = route_of(targets, count);

    return jp_skid_pilot_follow(&pilot, &route);
}

static inline void follow_square(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, follow(square, SQUARE));
}

/** Works without letting time pass until the pilot has planned; the slices that it took. */
static inline unsigned plan(void)
{
    unsigned slices = 0;

    while (pilot.phase == JP_SKID_PILOT_PLANNING && slices < 1000U) {
        (void)jp_skid_pilot_work(&pilot);
        slices++;
    }
    return slices;
}

/** Until so many legs have ended, with a call every so many ticks. */
static inline void drive_legs(uint16_t count, uint32_t ticks_a_call)
{
    uint32_t ticks = 0;

    while (pilot.legs_ended < count && ticks < TICKS_MAX) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_work(&pilot));
        run(ticks_a_call);
        ticks += ticks_a_call;
    }
    TEST_ASSERT_LESS_THAN_UINT32(TICKS_MAX, ticks);
}

static inline void drive_to_rest(void)
{
    uint32_t ticks = 0;

    while (pilot.phase != JP_SKID_PILOT_RESTING && ticks < TICKS_MAX) {
        run(1);
        (void)jp_skid_pilot_work(&pilot);
        ticks++;
    }
    TEST_ASSERT_LESS_THAN_UINT32(TICKS_MAX, ticks);
}

static inline void expect_phase(enum jp_skid_pilot_phase phase, enum jp_status status)
{
    TEST_ASSERT_EQUAL_INT(phase, pilot.phase);
    TEST_ASSERT_EQUAL_INT(status, pilot.status);
}

static inline void expect_near(const struct jp_point *target)
{
    const struct jp_skid_telemetry now = telemetry();

    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.03), target->x, (jp_q16)(now.x >> 16));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.03), target->y, (jp_q16)(now.y >> 16));
}

#endif
