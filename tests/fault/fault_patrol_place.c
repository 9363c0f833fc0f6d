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

/* While it stands, or hardly turns yet. */
#define CARRIED_AT (1.5 * PERIOD)

enum { CARRIED_SEEDS = 3 };

static void carry_to(const struct jp_plane_pose *place, double turned)
{
    task.faults.carried_at = CARRIED_AT;
    task.faults.carried_to = *place;
    task.faults.carried_to.heading = (float)planar_wrap((double)place->heading + turned);
}

/* It finds itself and comes to the goal, or gives up by name. */
static void drive_carried(void)
{
    drive();
    check_place(CARRIED_AT);
    check(result.outcome == PATROL_ARRIVED || result.outcome == PATROL_GAVE_UP, "outcome", CARRIED_AT, result.outcome);
}

static void test_a_robot_that_is_carried_away_takes_no_other_place_for_its_goal(void)
{
    static const enum patrol_scene_kind kinds[] = {PATROL_L_PASSAGE, PATROL_DOORWAY};

    what = "carried away";
    for (size_t i = 0; i < CARRIED_SEEDS * sizeof kinds / sizeof kinds[0]; i++) {
        make(kinds[i / CARRIED_SEEDS], SEED + i % CARRIED_SEEDS);
        carry_to(&scene.start, M_PI);
        drive_carried();
        carry_to(&scene.goal, 2);
        drive_carried();
    }
    report();
}

int main(void)
{
    UNITY_BEGIN();
    run_tests();
    return UNITY_END();
}
