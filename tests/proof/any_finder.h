/** A wayfinder (navigation.h) whose answers are any. */
#ifndef JOULEPATH_TESTS_PROOF_ANY_FINDER_H
#define JOULEPATH_TESTS_PROOF_ANY_FINDER_H

#include "hal/app/navigation.h"
#include "tests/proof/any.h"

#define FINDER_LEGS 4U

static struct jp_course_leg finder_legs[FINDER_LEGS];

static void finder_does(void *self)
{
    (void)self;
}

static bool finder_is_so(const void *self)
{
    (void)self;
    return any_bool();
}

static enum jp_status finder_prepares(void *self, struct jp_terrain *map, const struct jp_place *origin)
{
    (void)self;
    (void)map;
    (void)origin;
    return any_bool() ? JP_OK : JP_ERR_MEMORY;
}

static void finder_sees(void *self, int32_t x, int32_t y, enum jp_cell cell)
{
    (void)self;
    (void)x;
    (void)y;
    (void)cell;
}

static bool finder_can_stand(const void *self, const struct jp_map_goal *goal)
{
    (void)self;
    (void)goal;
    return any_bool();
}

static enum jp_status finder_goes(void *self, const struct jp_map_goal *goal)
{
    (void)self;
    (void)goal;
    return any_bool() ? JP_OK : any_bool() ? JP_ERR_STATE : JP_ERR_BLOCKED;
}

static bool finder_works(void *self)
{
    (void)self;
    return any_bool();
}

static void finder_tells(const void *self, struct jp_way_report *way)
{
    (void)self;
    ANY(*way);
    ANY(finder_legs);
    for (unsigned i = 0; i < FINDER_LEGS; i++) {
        finder_legs[i].is_stop = any_bool();
    }
    way->legs = finder_legs;
    way->leg_count = (uint16_t)any_unsigned(FINDER_LEGS);
}

/* Its rounds. */

static enum jp_e2e_result finder_accepts(void *self, const struct jp_can_frame *frame, uint8_t map)
{
    (void)self;
    (void)frame;
    (void)map;
    return (enum jp_e2e_result)any_between(JP_E2E_OK, JP_E2E_SEQUENCE);
}

static uint8_t finder_is_ready(const void *self)
{
    (void)self;
    return (uint8_t)any_unsigned(UINT8_MAX);
}

static enum jp_status finder_begins(void *self)
{
    (void)self;
    return any_bool() ? JP_OK : any_bool() ? JP_ERR_STATE : JP_ERR_BLOCKED;
}

static void finder_tells_round(const void *self, struct jp_can_frame frames[JP_NAVIGATION_ROUND_FRAMES])
{
    (void)self;
    for (unsigned i = 0; i < JP_NAVIGATION_ROUND_FRAMES; i++) {
        ANY(frames[i]);
    }
}

static const struct jp_wayfinder_rounds finder_rounds = {.accept = finder_accepts,
                                                         .ready = finder_is_ready,
                                                         .drop = finder_does,
                                                         .begin = finder_begins,
                                                         .tell = finder_tells_round};

static const struct jp_wayfinder any_finder = {.prepare = finder_prepares,
                                               .forget = finder_does,
                                               .is_under_way = finder_is_so,
                                               .see = finder_sees,
                                               .can_stand = finder_can_stand,
                                               .go = finder_goes,
                                               .stop = finder_does,
                                               .work = finder_works,
                                               .tell = finder_tells,
                                               .rounds = &finder_rounds};

#endif
