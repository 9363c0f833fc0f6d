/** A navigator on a small map, with a robot that goes straight to where it is told, for its tests. */
#ifndef JOULEPATH_TESTS_SUPPORT_NAVIGATOR_RIG_H
#define JOULEPATH_TESTS_SUPPORT_NAVIGATOR_RIG_H

#include <joulepath/navigator.h>
#include <joulepath/tables.h>
#include <stddef.h>

#include "tests/support/level_map.h"
#include "unity.h"

enum {
    SIDE = 24, /* cells of 0.1 m */
    BLOCK_BYTES = 7 * 1024 - 64,
    LEGS_MAX = 12,
    TARGETS_MAX = 16,
    WORK_MAX = 60000
};

/** m a slice of the robot's. */
#define STRIDE JP_Q16(0.02)

/** A robot that is where it is told to be a little later, and does what the test lets it do. */
struct fake_vehicle {
    struct jp_vehicle_view view;
    struct jp_point targets[TARGETS_MAX];
    uint16_t count;
    uint16_t next;
    jp_angle heading;    /* that it turns to */
    jp_angle turned_by;  /* less than it is told */
    jp_q16 drift;        /* to the left of where it drives, m */
    jp_q16 slide;        /* to the left of where it looks, when it has turned next, m */
    jp_q16 beyond;       /* that it goes beyond its stands, by a tenth less each step that it is slower, m */
    uint8_t slowest;     /* of the runs that it drove */
    jp_q16 aside;        /* that a leg of a run of several leaves its line by, m */
    uint16_t infeasible; /* leg, from 1, of runs of more legs than one; 0: none */
    unsigned turning;    /* slices until it looks there */
    unsigned braking;    /* slices until it stands */
    unsigned stops;
    unsigned turns;
    unsigned follows;
    enum jp_status work_status;
    enum jp_status turn_status;
    enum jp_status follow_status;
    enum jp_status survey_status;
    uint16_t surveyed; /* legs of the run */
    struct jp_vehicle_run run;
    const struct jp_ground *ground;      /* of the run that it drives */
    const struct jp_ground *turn_ground; /* on which it turned last */
    unsigned legs;                       /* of all runs surveyed to their ends */
    jp_q16 takes;                        /* each of its slices, J */
};

static struct jp_terrain_config map;
static struct jp_planner planner;
static uint64_t block[BLOCK_BYTES / sizeof(uint64_t)];
static uint64_t way_block[3 * SIDE * SIDE / 64 + 1];
static struct jp_course_leg legs[LEGS_MAX];
static struct fake_vehicle robot;
static struct jp_vehicle vehicle;
static struct jp_navigator_config config;
static struct jp_navigator navigator;
static struct jp_place origin;

/* ---- The robot ---- */

static inline void fake_look(void *context, struct jp_vehicle_view *view)
{
    const struct fake_vehicle *fake = context;

    *view = fake->view;
}

static inline jp_q16 fake_step(jp_q16 from, jp_q16 to)
{
    return from + jp_clamp32(to - from, -STRIDE, STRIDE);
}

static inline void fake_move(struct fake_vehicle *fake)
{
    struct jp_point *at = &fake->view.position;
    const struct jp_point *to = &fake->targets[fake->next];
    const jp_angle direction = jp_atan2(to->y - at->y, to->x - at->x);
    const int64_t dx = (int64_t)to->x - at->x;
    const int64_t dy = (int64_t)to->y - at->y;
    const int64_t left = (int64_t)jp_square_root((uint64_t)(dx * dx) + (uint64_t)(dy * dy));

    if (left <= STRIDE) {
        *at = *to;
        fake->next++;
    } else {
        fake->view.heading = direction;
        at->x +=
            jp_multiply_shift(STRIDE, jp_cos(direction), 31) - jp_multiply_shift(fake->drift, jp_sin(direction), 31);
        at->y +=
            jp_multiply_shift(STRIDE, jp_sin(direction), 31) + jp_multiply_shift(fake->drift, jp_cos(direction), 31);
    }
    if (fake->next == fake->count) {
        fake->count = 0;
    }
}

static inline void fake_end_turn(struct fake_vehicle *fake)
{
    fake->view.heading = fake->heading;
    fake->view.position.x -= jp_multiply_shift(fake->slide, jp_sin(fake->heading), 31);
    fake->view.position.y += jp_multiply_shift(fake->slide, jp_cos(fake->heading), 31);
    fake->slide = 0;
}

static inline enum jp_status fake_work(void *context)
{
    struct fake_vehicle *fake = context;

    fake->view.spent = (jp_q16)((uint32_t)fake->view.spent + (uint32_t)fake->takes);
    if (fake->view.phase == JP_VEHICLE_OFF) {
        return fake->work_status;
    }
    if (fake->braking > 0) {
        fake->braking--;
        fake->count = 0;
    } else if (fake->next < fake->count) {
        fake_move(fake);
    } else if (fake->turning > 0) {
        fake->turning--;
        if (fake->turning == 0) {
            fake_end_turn(fake);
        }
    } else {
        /* It stands. */
    }
    fake->view.phase =
        fake->braking > 0 || fake->count > 0 || fake->turning > 0 ? JP_VEHICLE_MOVING : JP_VEHICLE_STANDING;
    return fake->work_status;
}

static inline enum jp_status fake_turn(void *context, jp_angle heading, const struct jp_ground *ground)
{
    struct fake_vehicle *fake = context;

    fake->turn_ground = ground;
    fake->turns++;
    if (fake->turn_status == JP_OK) {
        TEST_ASSERT_EQUAL_INT(JP_VEHICLE_STANDING, fake->view.phase);
        fake->heading = heading - fake->turned_by;
        fake->turning = 3;
        fake->view.phase = JP_VEHICLE_MOVING;
    }
    return fake->turn_status;
}

static inline enum jp_status fake_follow(void *context, const struct jp_vehicle_run *run)
{
    struct fake_vehicle *fake = context;

    fake->follows++;
    if (fake->follow_status == JP_OK) {
        TEST_ASSERT_EQUAL_INT(JP_VEHICLE_STANDING, fake->view.phase);
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(TARGETS_MAX, run->count);
        for (uint16_t i = 0; i < run->count; i++) {
            fake->targets[i] = run->targets[i];
        }
        fake->count = run->count;
        fake->ground = run->ground;
        fake->slowest = run->slower > fake->slowest ? run->slower : fake->slowest;
        fake->next = 0;
        fake->view.phase = JP_VEHICLE_MOVING;
    }
    return fake->follow_status;
}

static inline void fake_stop(void *context)
{
    struct fake_vehicle *fake = context;

    fake->stops++;
    fake->turning = 0;
    fake->braking = fake->view.phase == JP_VEHICLE_MOVING ? 5 : 0;
}

static inline enum jp_status fake_survey(void *context, const struct jp_vehicle_run *run, bool anew)
{
    struct fake_vehicle *fake = context;

    if (anew) {
        fake->legs = 0;
    }
    TEST_ASSERT_GREATER_THAN_UINT32(0, run->count);
    fake->run = *run;
    fake->surveyed = 0;
    return fake->survey_status;
}

static inline enum jp_status fake_survey_leg(void *context, struct jp_leg_extent *extent)
{
    struct fake_vehicle *fake = context;

    fake->surveyed++;
    if (fake->surveyed == fake->infeasible && fake->run.count > 1) {
        return JP_ERR_INFEASIBLE;
    }
    *extent = (struct jp_leg_extent){fake->aside,
                                     fake->beyond - jp_q16_multiply(fake->beyond, JP_Q16(0.1) * fake->run.slower)};
    fake->legs += fake->surveyed == fake->run.count ? fake->run.count : 0U;
    return JP_OK;
}

/* A second and two joules a leg. */
static inline void fake_forecast(void *context, jp_q16 *duration, struct jp_forecast *energy)
{
    const struct fake_vehicle *fake = context;

    *duration = (jp_q16)(fake->legs * JP_Q16_ONE);
    *energy = (struct jp_forecast){2 * *duration, *duration / 4};
}

/* ---- The map ---- */

static inline struct jp_point centre(int32_t x, int32_t y)
{
    return (struct jp_point){(2 * x + 1) * map.resolution / 2, (2 * y + 1) * map.resolution / 2};
}

static inline void rig_reset(void)
{
    map = (struct jp_terrain_config){.width = SIDE, .height = SIDE, .resolution = jp_lattice_courier24.resolution};
    make_level_map(&map);
    robot = (struct fake_vehicle){.view = {.phase = JP_VEHICLE_STANDING}};
    vehicle = (struct jp_vehicle){.context = &robot,
                                  .look = fake_look,
                                  .work = fake_work,
                                  .turn = fake_turn,
                                  .follow = fake_follow,
                                  .stop = fake_stop,
                                  .survey = fake_survey,
                                  .survey_leg = fake_survey_leg,
                                  .forecast = fake_forecast};
    config = (struct jp_navigator_config){.planner = &planner,
                                          .vehicle = &vehicle,
                                          .radius = JP_Q16(0.175),
                                          .margin = JP_Q16(0.03),
                                          .legs = legs,
                                          .legs_max = LEGS_MAX,
                                          .slice = 8,
                                          .way_block = way_block,
                                          .way_size = sizeof way_block};
    origin = (struct jp_place){centre(4, 4), 0};
}

/** With so much of the block. */
static inline void make_planner(size_t size)
{
    const struct jp_planner_config greedy = {
        .lattice = &jp_lattice_courier24, .cost = JP_COST_PHYSICAL, .epsilon = {JP_EPSILON(4), JP_EPSILON(1.5)}};
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_init(&planner, &greedy, &terrain, block, size, &field));
}

static inline void init(void)
{
    const char *field = "";

    make_planner(sizeof block);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_init(&navigator, &config, &origin, &field));
    TEST_ASSERT_NULL(field);
}

static inline enum jp_status go_to(int16_t x, int16_t y, uint16_t headings)
{
    return jp_navigator_go(&navigator, &(struct jp_goal){x, y, headings});
}

static inline void begin(int16_t x, int16_t y)
{
    init();
    TEST_ASSERT_EQUAL_INT(JP_OK, go_to(x, y, JP_ANY_HEADING));
}

static inline void occupy(int32_t x, int32_t y)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_set_cell(&navigator, x, y, JP_CELL_OCCUPIED));
}

/** Until it is in a state; false: it never was. */
static inline bool work_until(enum jp_navigator_state state)
{
    for (unsigned i = 0; i < WORK_MAX; i++) {
        if (jp_navigator_work(&navigator) == state) {
            return true;
        }
        if (navigator.state >= JP_NAVIGATOR_ARRIVED || navigator.state == JP_NAVIGATOR_IDLE) {
            return false;
        }
    }
    return false;
}

static inline void expect_at(int32_t x, int32_t y)
{
    const struct jp_place place = jp_navigator_place(&navigator);
    const struct jp_point expected = centre(x, y);

    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.002), expected.x, place.point.x);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.002), expected.y, place.point.y);
}

static inline void expect_failure(enum jp_navigator_reason reason)
{
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_FAILED));
    TEST_ASSERT_EQUAL_INT(reason, navigator.reason);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_FAILED, jp_navigator_work(&navigator));
}

#endif
