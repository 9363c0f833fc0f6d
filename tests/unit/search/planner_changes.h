/** A planner whose map and robot change at random while it works: whatever it answers, at any time, is true. */
#ifndef JOULEPATH_TESTS_UNIT_SEARCH_PLANNER_CHANGES_H
#define JOULEPATH_TESTS_UNIT_SEARCH_PLANNER_CHANGES_H

#include "tests/unit/search/planner_optimum.h"

enum { ROUNDS = 30, SLICES = 40 };

static uint32_t seed;

static inline uint32_t pick(uint32_t bound)
{
    seed = seed * UINT32_C(1664525) + UINT32_C(1013904223);
    return (uint32_t)(((uint64_t)(seed >> 8) * bound) >> 24);
}

static inline void change_cell(void)
{
    const int32_t x = (int32_t)pick(map.width);
    const int32_t y = (int32_t)pick(map.height);
    const bool near_robot = x < 8;

    switch (pick(4)) {
    case 0:
        if (near_robot || y < 3) {
            occupy(x, near_robot ? 0 : y);
        }
        break;
    case 1:
        for (int32_t i = 0; i < map.height; i++) {
            release(x, i);
        }
        break;
    default:
        raise(x, y, (jp_elevation)((int)pick(60) - 20));
        break;
    }
}

static inline void move_robot(void)
{
    const struct jp_plan *plan = jp_planner_plan(&planner);
    struct jp_lattice_pose pose = planner.internal.start;

    if (pick(2) == 0 && plan->step_count > 0) {
        pose = plan->start;
        for (unsigned i = 0; i <= pick(2) && i < plan->step_count; i++) {
            (void)jp_planner_step(&planner, i, &pose);
        }
    } else {
        pose.y = (int16_t)(pose.y + (int16_t)pick(3) - 1);
        pose.heading = (uint8_t)pick(JP_HEADINGS);
    }
    (void)jp_planner_set_start(&planner, &pose); /* where it does not fit it stays */
}

static inline void look_at_states(void)
{
    if (is_search_at_rest()) {
        expect_sound_states();
    }
}

static inline void end_search(void)
{
    expect_true_answer(finish());
    look_at_states();
}

static inline void work_a_while(void)
{
    for (uint32_t i = pick(SLICES); i > 0; i--) {
        (void)jp_planner_work(&planner, 1 + pick(3));
    }
    look_at_states();
    const enum jp_answer answer = jp_planner_work(&planner, 0);
    if (answer != JP_ANSWER_OUT_OF_BUDGET) {
        expect_true_answer(answer);
    }
}

/** From the rig's planner on, which has been started. */
static inline void plan_on_a_changing_map(void)
{
    go(&west, &east);
    for (int i = 0; i < ROUNDS; i++) {
        for (uint32_t changes = pick(4); changes > 0; changes--) {
            change_cell();
        }
        if (pick(3) == 0) {
            move_robot();
        }
        work_a_while();
        if (pick(2) == 0) {
            end_search();
        }
    }
    end_search();
}

#endif
