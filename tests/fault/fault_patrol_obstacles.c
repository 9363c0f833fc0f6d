/* Whatever gets in the patrol robot's way, at any cycle of a drive or before its first: it says so, stands with its
 * wheels held and never oscillates, and drives on where the way is free again. Prints what was measured of each. */
#include "tests/support/patrol_faults.h"

/* Times that it tries a way that closes before each plan anew. */
#define TRIES_MAX 5

/* Nobody is touched by a robot that moves. */
static void check_no_touch_in_motion(double fault)
{
    for (size_t i = 0; i < sample_count; i++) {
        check(samples[i].touch == PATROL_TOUCH_NONE || is_standing(&samples[i]), "touch at s", fault, samples[i].time);
    }
}

/* The cycle without the fault that follows a time. */
static size_t cycle_at(double time)
{
    return (size_t)lround(time / PERIOD + 0.5);
}

/* ---- Things that appear ---- */

/* A disc in the frame of a pose, from a time on until another. */
static void put(const struct jp_plane_pose *pose, double x, double y, double radius, double from, double until)
{
    const struct planar_pose frame = {(double)pose->x, (double)pose->y, (double)pose->heading};
    const struct planar_point at = planar_place(&frame, (struct planar_point){x, y});

    TEST_ASSERT_TRUE(scene.mover_count < PATROL_OBSTACLES_MAX);
    /* Away within a tick. */
    scene.movers[scene.mover_count++] = (struct patrol_obstacle){.shape = {.kind = PLANAR_DISC, .radius = radius},
                                                                 .waypoints = {at, {-100, -100}},
                                                                 .waypoint_count = 2,
                                                                 .speed = 1e6,
                                                                 .appears = from,
                                                                 .starts = until};
}

#define INSIDE_RADIUS 0.08 /* m */
#define CLOSED_AHEAD  1.7  /* m */
#define CLOSED_RADIUS 0.45

static void arrange_inside(double fault, const struct jp_plane_pose *pose)
{
    put(pose, 0.34, 0.2, INSIDE_RADIUS, fault, NEVER);
    task.survives_touches = true;
}

static void judge_inside(double fault)
{
    check(result.reason == JP_PATROL_IN_COLLISION, "reason", fault, result.reason);
    check(samples[sample_count - 1].state == JP_PATROL_STOPPED, "state", fault, samples[sample_count - 1].state);
    check_stops(fault);
}

static void arrange_inside_for_a_while(double fault, const struct jp_plane_pose *pose)
{
    put(pose, 0.34, -0.2, INSIDE_RADIUS, fault, fault + GAP);
    task.survives_touches = true;
}

static void judge_inside_for_a_while(double fault)
{
    judge_pause(fault, fault + GAP, JP_PATROL_IN_COLLISION);
}

/* Behind: it may drive away from it. */
static void arrange_inside_behind(double fault, const struct jp_plane_pose *pose)
{
    put(pose, -0.34, 0, INSIDE_RADIUS, fault, fault + GAP);
    task.survives_touches = true;
}

static void judge_inside_behind(double fault)
{
    check(samples[sample_count - 1].state == JP_PATROL_ARRIVED, "state", fault, samples[sample_count - 1].state);
    check_steady(fault);
}

static void arrange_ahead(double fault, const struct jp_plane_pose *pose)
{
    put(pose, 1.5, 0, 0.2, fault, fault + GAP);
    task.survives_touches = true;
}

static void judge_ahead(double fault)
{
    check_no_touch_in_motion(fault);
    check(samples[sample_count - 1].state == JP_PATROL_ARRIVED, "state", fault, samples[sample_count - 1].state);
    check_steady(fault);
}

/* Across the passage, where the robot would be when it is so far from where it is now; nowhere if it never is. */
static void arrange_closed(double fault, const struct jp_plane_pose *pose)
{
    size_t there = cycle_at(fault);

    while (there < calm_count &&
           hypot((double)(calm[there].pose.x - pose->x), (double)(calm[there].pose.y - pose->y)) < CLOSED_AHEAD) {
        there++;
    }
    if (there < calm_count) {
        put(&calm[there].pose, 0, 0, CLOSED_RADIUS, fault, NEVER);
    }
}

static void judge_closed(double fault)
{
    const bool is_closed = scene.mover_count > 0;

    check(result.outcome == (is_closed ? PATROL_GAVE_UP : PATROL_ARRIVED), "outcome", fault, result.outcome);
    check(result.counts.waits <= TRIES_MAX * (result.replans + 1), "waits", fault, result.counts.waits);
    check_steady(fault);
    if (is_closed) {
        check_stands(fault);
    }
}

static void test_things_appear(void)
{
    static const struct injection injections[] = {
        {"something appears inside the footprint", arrange_inside, judge_inside},
        {"it goes after 2.5 s", arrange_inside_for_a_while, judge_inside_for_a_while},
        {"it is in the rear", arrange_inside_behind, judge_inside_behind},
        {"somebody steps in front for 2.5 s", arrange_ahead, judge_ahead},
        {"the way closes", arrange_closed, judge_closed},
    };

    inject_into(PATROL_L_PASSAGE, SEED, injections, sizeof injections / sizeof injections[0]);
}

/* On both sides of its way, where it drives straight ahead and does not glide. */
static void test_more_things_than_fit(void)
{
    what = "more obstacles than fit";
    drive_calm(PATROL_BESIDE_OBSTACLE, SEED);
    scene.mover_count = 0;
    for (size_t cycle = 0; cycle < calm_count && scene.mover_count + 2 <= PATROL_OBSTACLES_MAX; cycle += 8) {
        if (calm[cycle].state == JP_PATROL_DRIVING) {
            put(&calm[cycle].pose, 0, 1.1, 0.06, 0, NEVER);
            put(&calm[cycle].pose, 0, -1.1, 0.06, 0, NEVER);
        }
    }
    drive();
    check(result.outcome == PATROL_ARRIVED, "outcome", 0, result.outcome);
    check(result.counts.shapes_dropped > 0, "dropped", 0, result.counts.shapes_dropped);
    check_steady(0);
    report();
}

/* ---- Before the first motion ---- */

static void block_map(const struct jp_plane_pose *pose)
{
    const double cell = scene.map.config.resolution / (double)JP_Q16_ONE;
    const int x = (int)((double)pose->x / cell);
    const int y = (int)((double)pose->y / cell);

    for (int i = -4; i <= 4; i++) {
        for (int k = -4; k <= 4; k++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&scene.map, x + i, y + k, JP_CELL_OCCUPIED));
        }
    }
}

static void test_no_path(void)
{
    for (enum patrol_scene_kind kind = 0; kind < PATROL_SCENES; kind++) {
        for (int blocks_start = 0; blocks_start <= 1; blocks_start++) {
            what = blocks_start != 0 ? "start in collision on the map" : "goal in collision on the map";
            make(kind, SEED);
            block_map(blocks_start != 0 ? &scene.start : &scene.goal);
            drive();
            check(result.outcome == PATROL_NO_PATH, "outcome", 0, result.outcome);
            check_never_moved();
        }
    }
    what = "no path";
    report();
}

static void start_in_collision(double until)
{
    make(PATROL_DOORWAY, SEED);
    put(&scene.start, 0.3, 0.1, INSIDE_RADIUS, 0, until);
    task.survives_touches = true;
    drive();
}

static void test_start_in_collision(void)
{
    what = "start in collision";
    start_in_collision(NEVER);
    TEST_ASSERT_EQUAL_INT(JP_PATROL_STOPPED, samples[sample_count - 1].state);
    TEST_ASSERT_EQUAL_INT(JP_PATROL_IN_COLLISION, result.reason);
    check_never_moved();
    start_in_collision(GAP);
    judge_pause(0, GAP, JP_PATROL_IN_COLLISION);
}
