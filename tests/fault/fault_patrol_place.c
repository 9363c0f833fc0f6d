/* What makes the patrol robot err about its place: slippery ground on any way, and somebody who carries it elsewhere at
 * any cycle of a drive. It truly comes to its goal, or stands and says that it is lost; it never takes another place
 * for its goal, and touches nothing. */
#include "tests/support/patrol_faults.h"

enum { SEEDS = 6 };

/* Of the goal, as sim/robots/patrol.cfg says, and what the localiser adds, m and rad. */
#define ARRIVED_M   0.06
#define ARRIVED_RAD (3 * M_PI / 180)

static void check_place(double fault)
{
    check(result.outcome != PATROL_MISSED, "outcome", fault, result.outcome);
    check(result.outcome != PATROL_COLLIDED, "outcome", fault, result.outcome);
    if (result.outcome == PATROL_ARRIVED) {
        check(result.position_error <= ARRIVED_M, "from the goal, m", fault, result.position_error);
        check(result.heading_error <= ARRIVED_RAD, "from the goal's heading, rad", fault, result.heading_error);
    }
}

static void test_on_slippery_ground_it_arrives(void)
{
    static const enum patrol_scene_kind kinds[] = {PATROL_L_PASSAGE, PATROL_DOORWAY, PATROL_CORRIDOR};

    what = "slippery ground";
    for (size_t i = 0; i < SEEDS * sizeof kinds / sizeof kinds[0]; i++) {
        make(kinds[i / SEEDS], SEED + i % SEEDS);
        task.faults.slip = true;
        drive();
        check(result.outcome == PATROL_ARRIVED, "outcome", 0, result.outcome);
        check_place(0);
    }
    report();
}

/* ---- Carried away ---- */

/* Back to where the drive began, turned round. */
static void arrange_back_to_start(double fault, const struct jp_plane_pose *pose)
{
    (void)pose;
    task.faults.carried_at = fault;
    task.faults.carried_to = scene.start;
    task.faults.carried_to.heading = (float)planar_wrap((double)scene.start.heading + M_PI);
}

/* Straight to the goal, turned away from it. */
static void arrange_to_goal(double fault, const struct jp_plane_pose *pose)
{
    (void)pose;
    task.faults.carried_at = fault;
    task.faults.carried_to = scene.goal;
    task.faults.carried_to.heading = (float)planar_wrap((double)scene.goal.heading + 2);
}

static bool is_lost_at(double from)
{
    for (size_t i = 0; i < sample_count; i++) {
        if (samples[i].time >= from && samples[i].reason == JP_PATROL_LOST) {
            return true;
        }
    }
    return false;
}

/* It says that it is lost, and is found again or stays so by name. */
static void judge_carried(double fault)
{
    check_place(fault);
    check(is_lost_at(fault), "was lost", fault, 0);
    check(result.outcome == PATROL_ARRIVED || (result.outcome == PATROL_GAVE_UP && result.reason == JP_PATROL_LOST),
          "outcome", fault, result.outcome);
}

static void test_a_robot_that_is_carried_away_finds_itself_or_is_lost_by_name(void)
{
    static const struct injection injections[] = {
        {"carried back to the start", arrange_back_to_start, judge_carried},
        {"carried to the goal", arrange_to_goal, judge_carried},
    };

    inject_into(PATROL_DOORWAY, SEED, injections, sizeof injections / sizeof injections[0]);
    inject_into(PATROL_L_PASSAGE, SEED + 1, injections, sizeof injections / sizeof injections[0]);
}

int main(void)
{
    UNITY_BEGIN();
    run_tests();
    return UNITY_END();
}
