/* Whatever its sensors tell the patrol robot from any cycle of a drive on, and whatever its own wheels cannot do: it
 * says so, stands with its wheels held and never oscillates, and drives on where the fault ends. Prints what was
 * measured of each fault. */
#include "tests/support/patrol_faults.h"

/* Times that a robot stops in a drive with hardly enough beams. */
#define WAITS_MAX 12

static void judge_undisturbed(double fault)
{
    check(result.outcome == PATROL_ARRIVED, "outcome", fault, result.outcome);
    check(result.counts.waits == 0, "waits", fault, result.counts.waits);
    check_steady(fault);
}

/* ---- Scans that drop out ---- */

static void arrange_no_more_scans(double fault, const struct jp_plane_pose *pose)
{
    (void)pose;
    task.faults.scan_dropout_from = fault;
    task.faults.scan_dropout_until = NEVER;
}

static void judge_no_more_scans(double fault)
{
    check_gave_up(fault, JP_PATROL_NO_SCAN);
}

static void arrange_gap(double fault, const struct jp_plane_pose *pose)
{
    (void)pose;
    task.faults.scan_dropout_from = fault;
    task.faults.scan_dropout_until = fault + GAP;
}

static void judge_gap(double fault)
{
    judge_pause(fault, fault + GAP, JP_PATROL_NO_SCAN);
    check(result.counts.waits == 1, "waits", fault, result.counts.waits);
}

static void arrange_short_gap(double fault, const struct jp_plane_pose *pose)
{
    (void)pose;
    task.faults.scan_dropout_from = fault;
    task.faults.scan_dropout_until = fault + 3 * PERIOD;
}

static void test_scans_drop_out(void)
{
    static const struct injection injections[] = {
        {"no more scans", arrange_no_more_scans, judge_no_more_scans},
        {"no scans for 2.5 s", arrange_gap, judge_gap},
        {"three scans missing", arrange_short_gap, judge_undisturbed},
    };

    inject_into(PATROL_L_PASSAGE, SEED, injections, sizeof injections / sizeof injections[0]);
}

/* Without most of the beams it cannot drive, and in between it may not know exactly where it is, or take what flickers
 * for people, whom it waits for. */
static bool is_as_seen(double share)
{
    if (share <= 0.5) {
        return result.outcome == PATROL_ARRIVED;
    }
    if (share >= 0.8) {
        return result.outcome == PATROL_GAVE_UP && result.reason == JP_PATROL_NO_SCAN;
    }
    return result.outcome == PATROL_ARRIVED || result.outcome == PATROL_MISSED || result.outcome == PATROL_GAVE_UP ||
           result.outcome == PATROL_LATE;
}

/* From the start and for ever: it drives with what it sees, or says that it cannot. */
static void test_beams_drop_out(void)
{
    static const double shares[] = {0.2, 0.4, 0.6, 0.7, 0.75, 0.8, 0.9, 1};
    static const enum patrol_scene_kind kinds[] = {PATROL_L_PASSAGE, PATROL_DOORWAY, PATROL_BESIDE_OBSTACLE};
    char name[40];

    what = name;
    for (size_t i = 0; i < sizeof shares / sizeof shares[0]; i++) {
        (void)snprintf(name, sizeof name, "%.0f %% of the beams drop out", 100 * shares[i]);
        forget_figures();
        for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
            make(kinds[k], SEED);
            task.faults.beam_dropout = shares[i];
            drive();
            check_steady(0);
            check(result.counts.waits <= WAITS_MAX, "waits", 0, result.counts.waits);
            check(is_as_seen(shares[i]), "outcome", 0, result.outcome);
        }
        report();
    }
}

/* ---- Poses that jump ---- */

#define LARGE_JUMP  0.8 /* m; beyond the largest step that is believed */
#define SMALL_JUMP  0.2
#define WHEELS_JUMP 1.0

static void arrange_jump(double fault, double until, double metres)
{
    task.faults = (struct patrol_faults){.jump_at = fault, .jump_until = until, .jump_m = metres};
}

static void arrange_large_jump(double fault, const struct jp_plane_pose *pose)
{
    (void)pose;
    arrange_jump(fault, 0, LARGE_JUMP);
}

static void judge_large_jump(double fault)
{
    check_gave_up(fault, JP_PATROL_LOST);
}

static void arrange_large_jump_for_a_while(double fault, const struct jp_plane_pose *pose)
{
    (void)pose;
    arrange_jump(fault, fault + GAP, LARGE_JUMP);
}

static void judge_large_jump_for_a_while(double fault)
{
    judge_pause(fault, fault + GAP, JP_PATROL_LOST);
    check(result.counts.waits == 1, "waits", fault, result.counts.waits);
}

static void arrange_large_jump_once(double fault, const struct jp_plane_pose *pose)
{
    (void)pose;
    arrange_jump(fault, fault + PERIOD, LARGE_JUMP);
}

static void arrange_small_jump_once(double fault, const struct jp_plane_pose *pose)
{
    (void)pose;
    arrange_jump(fault, fault + PERIOD, SMALL_JUMP);
}

static void judge_small_jump_once(double fault)
{
    check(result.outcome == PATROL_ARRIVED, "outcome", fault, result.outcome);
    check(result.counts.waits <= 1, "waits", fault, result.counts.waits);
    check_steady(fault);
}

/* Nothing tells it from the truth but that the goal may then lie within a wall. */
static void arrange_small_jump(double fault, const struct jp_plane_pose *pose)
{
    (void)pose;
    arrange_jump(fault, 0, SMALL_JUMP);
}

static void judge_small_jump(double fault)
{
    const bool gave_up = result.outcome == PATROL_GAVE_UP &&
                         (result.reason == JP_PATROL_BLOCKED || result.reason == JP_PATROL_IN_COLLISION);

    check(gave_up || result.outcome == PATROL_MISSED || result.outcome == PATROL_ARRIVED, "outcome", fault,
          result.outcome);
    check(result.odometry_error < SMALL_JUMP + 0.05, "error of the pose, m", fault, result.odometry_error);
    check_steady(fault);
    if (gave_up) {
        check_stands(fault);
    }
}

static void arrange_wheels_jump(double fault, const struct jp_plane_pose *pose)
{
    (void)pose;
    arrange_jump(fault, 0, 0);
    task.faults.wheels_jump_m = WHEELS_JUMP;
}

/* The localiser does not believe it: the robot truly arrives, or stops. */
static void judge_wheels_jump(double fault)
{
    check(result.outcome == PATROL_ARRIVED || result.outcome == PATROL_GAVE_UP, "outcome", fault, result.outcome);
    check_steady(fault);
}

static void test_poses_jump(void)
{
    static const struct injection injections[] = {
        {"the laser's pose jumps by 0.8 m", arrange_large_jump, judge_large_jump},
        {"it is off by 0.8 m for 2.5 s", arrange_large_jump_for_a_while, judge_large_jump_for_a_while},
        {"it is off by 0.8 m once", arrange_large_jump_once, judge_undisturbed},
        {"it is off by 0.2 m once", arrange_small_jump_once, judge_small_jump_once},
        {"the laser's pose jumps by 0.2 m", arrange_small_jump, judge_small_jump},
        {"the wheels' pose jumps by 1 m", arrange_wheels_jump, judge_wheels_jump},
    };

    inject_into(PATROL_L_PASSAGE, SEED, injections, sizeof injections / sizeof injections[0]);
}

/* ---- Limits ---- */

static void test_steering_that_cannot_turn_in_place(void)
{
    what = "steering limit of 30 degrees";
    make(PATROL_DOORWAY, SEED);
    robot.steering.limit_deg = 30;
    drive();
    TEST_ASSERT_EQUAL_INT(PATROL_GAVE_UP, result.outcome);
    TEST_ASSERT_EQUAL_INT(JP_PATROL_INFEASIBLE, result.reason);
    check_never_moved();
    report();
}

static void test_wheels_slower_than_the_band(void)
{
    what = "wheels slower than the band";
    for (enum patrol_scene_kind kind = 0; kind < PATROL_SCENES; kind++) {
        make(kind, SEED);
        robot.drive.speed_m_s = 0.6;
        drive();

        size_t stop = 0;
        while (stop < sample_count && samples[stop].state != JP_PATROL_STOPPED) {
            stop++;
        }
        TEST_ASSERT_TRUE(stop < sample_count);
        check_gave_up(samples[stop].time, JP_PATROL_INFEASIBLE);
    }
    report();
}
