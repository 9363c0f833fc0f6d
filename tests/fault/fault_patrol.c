/* Whatever goes wrong at any cycle of the patrol robot's drive: it says so, stands with its wheels held and never
 * oscillates, and drives on where the fault ends. Prints what was measured of each fault. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sim/missions/patrol_mission.h"
#include "unity.h"

#define SEED   1
#define PERIOD (1.0 / PATROL_CYCLE_HZ)
#define LOG    4096 /* cycles */
#define NEVER  1.0e6

/* The fault begins at every so many-th cycle. */
#define STRIDE 14
#define FIRST  2
#define LAST   20 /* cycles before its arrival without the fault */

/* A robot stands below this, m/s and rad/s, while its wheels keep their angles to this, rad: four counts of the
 * encoder. */
#define STAND_SPEED     0.05
#define STAND_TURN_RATE 0.05
#define ANGLE_NOISE     (4 * 2 * M_PI / 16384)

/* From a lasting fault until the robot stands, s: four scans, the latency, 1 m/s at 1 m/s², and the wheels' lag. */
#define STOP_TIME 1.8

/* It then stands for at least this time, s. */
#define STAND_TIME 1.0

/* Commands this far from 0 have a sign, m/s and rad/s. */
#define SPEED_SIGN     0.02
#define TURN_RATE_SIGN 0.15

/* An oscillation changes the sign more often than this in so many cycles. */
#define TURN_CHANGES_MAX 5
#define WINDOW           (2 * PATROL_CYCLE_HZ)

/* Times that a robot stops in a drive with hardly enough beams, and for a way that closes before each plan anew. */
#define WAITS_MAX 12
#define TRIES_MAX 5

#define GOAL_TOLERANCE 0.15 /* m */

struct sample {
    double time;
    struct jp_plane_pose pose; /* true */
    double forward;            /* true */
    double turn_rate;
    double angles[JP_WHEELS]; /* by the encoders, rad */
    struct jp_plane_speed command;
    enum jp_patrol_state state;
    enum jp_patrol_reason reason;
    enum patrol_touch touch;
};

static struct four_wheel_file robot;
static struct patrol_scene scene;
static struct patrol_task task;
static struct patrol_result result;
static struct sample samples[LOG];
static size_t sample_count;

/* Of all runs of a test. */
static struct {
    unsigned runs;
    unsigned outcomes[PATROL_OUTCOMES];
    unsigned waits; /* most in a run */
    unsigned turn_changes;
    double stop_time; /* longest, s */
    double clearance; /* least, m */
} figures;

void setUp(void)
{
    TEST_ASSERT_TRUE(four_wheel_file_load("sim/robots/patrol.cfg", &robot));
    memset(&figures, 0, sizeof figures);
    figures.clearance = PATROL_DISTANCE_MAX;
}

void tearDown(void)
{
    patrol_scene_free(&scene);
}

/* ---- A drive ---- */

static void record(void *context, const struct patrol_view *view)
{
    (void)context;
    TEST_ASSERT_TRUE(sample_count < LOG);

    struct sample *const sample = &samples[sample_count++];

    *sample = (struct sample){.time = view->time,
                              .pose = view->true_pose,
                              .forward = (double)view->true_speed.forward,
                              .turn_rate = (double)view->true_speed.turn_rate,
                              .command = view->patrol->internal.command,
                              .state = view->state,
                              .reason = view->reason,
                              .touch = view->world->touch};
    for (size_t i = 0; i < JP_WHEELS; i++) {
        sample->angles[i] = view->wheels->angle[i] * (2 * M_PI / 4294967296.0);
    }
}

static void make(enum patrol_scene_kind kind, uint64_t seed)
{
    patrol_scene_free(&scene);
    patrol_scene_make(kind, seed, &scene);
    task = (struct patrol_task){.robot = &robot,
                                .scene = &scene,
                                .method = PATROL_IMPROVED,
                                .seed = SEED,
                                .faults = {.jump_at = -1},
                                .observe = record};
}

static void drive(void)
{
    sample_count = 0;
    TEST_ASSERT_TRUE(patrol_mission_run(&task, &result));
    figures.runs++;
    figures.outcomes[result.outcome]++;
    figures.waits = result.counts.waits > figures.waits ? result.counts.waits : figures.waits;
    figures.clearance = fmin(figures.clearance, result.clearance_min);
}

/* ---- What is asked of it ---- */

static const char *what; /* the fault of this run */

static void check(bool holds, const char *bar, double time, double value)
{
    if (!holds) {
        char message[200];

        (void)snprintf(message, sizeof message, "%s, %s from %.1f s: %s: %g (%s, %s)", scene.name, what, time, bar,
                       value, patrol_outcome_names[result.outcome], patrol_reason_names[result.reason]);
        TEST_FAIL_MESSAGE(message);
    }
}

static int sign_of(double value, double least)
{
    return value > least ? 1 : value < -least ? -1 : 0;
}

/* The sign of the commanded turn rate, or of that before where it is about 0. */
static int turn_sign_of(const struct sample *sample, int before)
{
    const int sign = sign_of((double)sample->command.turn_rate, TURN_RATE_SIGN);

    return sign != 0 ? sign : before;
}

/* The most changes of the sign of the commanded turn rate in a time of WINDOW after a time. */
static unsigned turn_changes(double from)
{
    unsigned changes[WINDOW] = {0};
    unsigned sum = 0;
    unsigned most = 0;
    int sign = 0;

    for (size_t i = 0; i < sample_count; i++) {
        if (samples[i].time >= from) {
            const int before = sign;
            unsigned *const slot = &changes[i % WINDOW];

            sign = turn_sign_of(&samples[i], before);
            sum -= *slot;
            *slot = sign * before < 0;
            sum += *slot;
            most = sum > most ? sum : most;
        }
    }
    return most;
}

/* No oscillation from a time on: never backwards, and not to and fro. */
static void check_steady(double from)
{
    const unsigned changes = turn_changes(from);

    figures.turn_changes = changes > figures.turn_changes ? changes : figures.turn_changes;
    check(changes <= TURN_CHANGES_MAX, "changes of turning in 2 s", from, changes);
    for (size_t i = 0; i < sample_count; i++) {
        check(samples[i].time < from || sign_of((double)samples[i].command.forward, SPEED_SIGN) >= 0, "backwards, m/s",
              from, (double)samples[i].command.forward);
    }
}

static bool is_standing(const struct sample *sample)
{
    return fabs(sample->forward) < STAND_SPEED && fabs(sample->turn_rate) < STAND_TURN_RATE;
}

static bool are_wheels_as(const struct sample *a, const struct sample *b)
{
    bool are_same = true;

    for (size_t i = 0; i < JP_WHEELS; i++) {
        are_same = are_same && fabs(a->angles[i] - b->angles[i]) <= ANGLE_NOISE;
    }
    return are_same;
}

/* When the robot began to stand with its wheels held as it does at a cycle. */
static double stands_since(size_t cycle)
{
    size_t first = cycle + 1;

    while (first > 0 && is_standing(&samples[first - 1]) && are_wheels_as(&samples[first - 1], &samples[cycle])) {
        first--;
    }
    return first > cycle ? INFINITY : samples[first].time;
}

/* In the end. */
static void check_stands(double fault)
{
    const double time = samples[sample_count - 1].time - stands_since(sample_count - 1);

    check(time >= STAND_TIME, "time that it stands, s", fault, time);
}

static void check_stops(double fault)
{
    const double since = stands_since(sample_count - 1) - fault;

    figures.stop_time = fmax(figures.stop_time, since);
    check(since <= STOP_TIME, "time until it stands, s", fault, since);
    check_stands(fault);
    check_steady(fault);
    check(result.counts.waits <= 1, "waits", fault, result.counts.waits);
}

static void check_gave_up(double fault, enum jp_patrol_reason reason)
{
    check(result.outcome == PATROL_GAVE_UP, "outcome", fault, result.outcome);
    check(result.reason == reason, "reason", fault, result.reason);
    check_stops(fault);
}

/* Nobody is touched by a robot that moves. */
static void check_no_touch_in_motion(double fault)
{
    for (size_t i = 0; i < sample_count; i++) {
        check(samples[i].touch == PATROL_TOUCH_NONE || is_standing(&samples[i]), "touch at s", fault, samples[i].time);
    }
}

static void report(void)
{
    (void)printf("%-44s %3u runs:", what, figures.runs);
    for (size_t i = 0; i < PATROL_OUTCOMES; i++) {
        if (figures.outcomes[i] > 0) {
            (void)printf(" %u %s,", figures.outcomes[i], patrol_outcome_names[i]);
        }
    }
    (void)printf(" waits <= %u, changes of turning <= %u in 2 s, stands after %.1f s, clearance %.3f m\n",
                 figures.waits, figures.turn_changes, figures.stop_time, figures.clearance);
}

/* ---- Injection ---- */

#define NO_FAULT ((struct patrol_faults){.jump_at = -1})

/* A fault that begins at a time, when the robot would be at a pose, and what must come of it. */
struct injection {
    const char *name;
    void (*arrange)(double fault, const struct jp_plane_pose *pose);
    void (*judge)(double fault);
};

/* The drive without a fault: which cycles there are, and where the robot is then. */
static struct sample calm[LOG];
static size_t calm_count;

static void forget_figures(void)
{
    memset(&figures, 0, sizeof figures);
    figures.clearance = PATROL_DISTANCE_MAX;
}

static void drive_calm(enum patrol_scene_kind kind, uint64_t seed)
{
    make(kind, seed);
    drive();
    TEST_ASSERT_EQUAL_INT(PATROL_ARRIVED, result.outcome);
    memcpy(calm, samples, sizeof calm);
    calm_count = sample_count;
    forget_figures();
}

/* Into a drive for each cycle from FIRST on, every STRIDE-th, until the robot is about to arrive. */
static void inject(const struct injection *injection)
{
    const size_t mover_count = scene.mover_count;

    what = injection->name;
    for (size_t cycle = FIRST; cycle + LAST < calm_count; cycle += STRIDE) {
        /* A fault lasts whole cycles: it begins and ends between two of them. */
        const double fault = calm[cycle].time - PERIOD / 2;

        task.faults = NO_FAULT;
        task.survives_touches = false;
        scene.mover_count = mover_count;
        injection->arrange(fault, &calm[cycle].pose);
        drive();
        injection->judge(fault);
    }
    scene.mover_count = mover_count;
    report();
}

static void inject_into(enum patrol_scene_kind kind, uint64_t seed, const struct injection *injections, size_t count)
{
    drive_calm(kind, seed);
    for (size_t i = 0; i < count; i++) {
        forget_figures();
        inject(&injections[i]);
    }
}

/* The cycle without the fault that follows a time. */
static size_t cycle_at(double time)
{
    return (size_t)lround(time / PERIOD + 0.5);
}

/* The sample of the last cycle before a time. */
static size_t cycle_before(double time)
{
    size_t cycle = 0;

    while (cycle + 1 < sample_count && samples[cycle + 1].time < time) {
        cycle++;
    }
    return cycle;
}

static void judge_undisturbed(double fault)
{
    check(result.outcome == PATROL_ARRIVED, "outcome", fault, result.outcome);
    check(result.counts.waits == 0, "waits", fault, result.counts.waits);
    check_steady(fault);
}

/* It stood when the fault was over, with that reason, and drove on. */
static void judge_pause(double fault, double end, enum jp_patrol_reason reason)
{
    const size_t last = cycle_before(end);
    const double since = stands_since(last) - fault;

    figures.stop_time = fmax(figures.stop_time, since);
    check(since <= STOP_TIME, "time until it stands, s", fault, since);
    check(samples[last].reason == reason, "reason", fault, samples[last].reason);
    check(samples[sample_count - 1].state == JP_PATROL_ARRIVED && result.position_error < GOAL_TOLERANCE,
          "distance from the goal, m", fault, result.position_error);
    check_steady(fault);
}

/* ---- Scans that drop out ---- */

#define GAP 2.5 /* s */

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

/* Without most of the beams it cannot drive, and in between it may not know exactly where it is. */
static bool is_as_seen(double share)
{
    if (share <= 0.5) {
        return result.outcome == PATROL_ARRIVED;
    }
    if (share >= 0.8) {
        return result.outcome == PATROL_GAVE_UP && result.reason == JP_PATROL_NO_SCAN;
    }
    return result.outcome == PATROL_ARRIVED || result.outcome == PATROL_MISSED || result.outcome == PATROL_GAVE_UP;
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

static void judge_wheels_jump(double fault)
{
    check(result.outcome == PATROL_GAVE_UP, "outcome", fault, result.outcome);
    check_steady(fault);
    check_stands(fault);
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

static void test_more_things_than_fit(void)
{
    what = "more obstacles than fit";
    drive_calm(PATROL_PEDESTRIAN, SEED);
    scene.mover_count = 0;
    for (size_t cycle = 0; cycle < calm_count && scene.mover_count + 2 <= PATROL_OBSTACLES_MAX; cycle += 8) {
        put(&calm[cycle].pose, 0, 1.1, 0.06, 0, NEVER);
        put(&calm[cycle].pose, 0, -1.1, 0.06, 0, NEVER);
    }
    drive();
    check(result.outcome == PATROL_ARRIVED, "outcome", 0, result.outcome);
    check(result.counts.shapes_dropped > 0, "dropped", 0, result.counts.shapes_dropped);
    check_steady(0);
    report();
}

/* ---- Before the first motion ---- */

static void check_never_moved(void)
{
    for (size_t i = 0; i < sample_count; i++) {
        check(is_standing(&samples[i]) && are_wheels_as(&samples[i], &samples[0]), "moved at s", 0, samples[i].time);
    }
    check(result.length < 0.01, "driven, m", 0, result.length);
}

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
