/** Drives of the patrol robot into which a fault comes at any cycle, and what is asked of it then. */
#ifndef JOULEPATH_TESTS_SUPPORT_PATROL_FAULTS_H
#define JOULEPATH_TESTS_SUPPORT_PATROL_FAULTS_H

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

/* Longest step to a goal that it has driven past, m. */
#define STEP_REACH 0.4

#define GOAL_TOLERANCE 0.15 /* m */

/* A fault that passes lasts so long, s. */
#define GAP 2.5

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

static inline void forget_figures(void)
{
    memset(&figures, 0, sizeof figures);
    figures.clearance = PATROL_DISTANCE_MAX;
}

void setUp(void)
{
    TEST_ASSERT_TRUE(four_wheel_file_load("sim/robots/patrol.cfg", &robot));
    forget_figures();
}

void tearDown(void)
{
    patrol_scene_free(&scene);
}

/* ---- A drive ---- */

static inline void record(void *context, const struct patrol_view *view)
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

static inline void make(enum patrol_scene_kind kind, uint64_t seed)
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

static inline void drive(void)
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

static inline void check(bool holds, const char *bar, double time, double value)
{
    if (!holds) {
        char message[200];

        (void)snprintf(message, sizeof message, "%s, %s from %.1f s: %s: %g (%s, %s)", scene.name, what, time, bar,
                       value, patrol_outcome_names[result.outcome], patrol_reason_names[result.reason]);
        TEST_FAIL_MESSAGE(message);
    }
}

static inline int sign_of(double value, double least)
{
    return value > least ? 1 : value < -least ? -1 : 0;
}

/* The sign of the commanded turn rate, or of that before where it is about 0. */
static inline int turn_sign_of(const struct sample *sample, int before)
{
    const int sign = sign_of((double)sample->command.turn_rate, TURN_RATE_SIGN);

    return sign != 0 ? sign : before;
}

/* The most changes of the sign of the commanded turn rate in a time of WINDOW after a time. */
static inline unsigned turn_changes(double from)
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

/* No oscillation from a time on: not to and fro, and backwards only in a step: slowly, straight to a place near by that
 * it has chosen, 0.4 m at most in all. */
static inline void check_steady(double from)
{
    const unsigned changes = turn_changes(from);

    figures.turn_changes = changes > figures.turn_changes ? changes : figures.turn_changes;
    check(changes <= TURN_CHANGES_MAX, "changes of turning in 2 s", from, changes);
    check(result.reversed <= STEP_REACH, "driven backwards, m", from, result.reversed);
    for (size_t i = 0; i < sample_count; i++) {
        check(samples[i].time < from || sign_of((double)samples[i].command.forward, SPEED_SIGN) >= 0 ||
                  samples[i].state == JP_PATROL_STEPPING,
              "backwards, m/s", from, (double)samples[i].command.forward);
    }
}

static inline bool is_standing(const struct sample *sample)
{
    return fabs(sample->forward) < STAND_SPEED && fabs(sample->turn_rate) < STAND_TURN_RATE;
}

static inline bool are_wheels_as(const struct sample *a, const struct sample *b)
{
    bool are_same = true;

    for (size_t i = 0; i < JP_WHEELS; i++) {
        are_same = are_same && fabs(a->angles[i] - b->angles[i]) <= ANGLE_NOISE;
    }
    return are_same;
}

/* When the robot began to stand with its wheels held as it does at a cycle. */
static inline double stands_since(size_t cycle)
{
    size_t first = cycle + 1;

    while (first > 0 && is_standing(&samples[first - 1]) && are_wheels_as(&samples[first - 1], &samples[cycle])) {
        first--;
    }
    return first > cycle ? INFINITY : samples[first].time;
}

/* In the end. */
static inline void check_stands(double fault)
{
    const double time = samples[sample_count - 1].time - stands_since(sample_count - 1);

    check(time >= STAND_TIME, "time that it stands, s", fault, time);
}

/* Begun from a time on. */
static inline unsigned waits_from(double time)
{
    unsigned waits = 0;

    for (size_t i = 0; i < sample_count; i++) {
        const bool has_begun =
            samples[i].state == JP_PATROL_WAITING && (i == 0 || samples[i - 1].state != JP_PATROL_WAITING);

        waits += has_begun && samples[i].time >= time;
    }
    return waits;
}

/* What it waited for before the fault is not its matter. */
static inline void check_stops(double fault)
{
    const double since = stands_since(sample_count - 1) - fault;

    figures.stop_time = fmax(figures.stop_time, since);
    check(since <= STOP_TIME, "time until it stands, s", fault, since);
    check_stands(fault);
    check_steady(fault);
    check(waits_from(fault) <= 1, "waits", fault, waits_from(fault));
}

static inline void check_gave_up(double fault, enum jp_patrol_reason reason)
{
    check(result.outcome == PATROL_GAVE_UP, "outcome", fault, result.outcome);
    check(result.reason == reason, "reason", fault, result.reason);
    check_stops(fault);
}

static inline void check_never_moved(void)
{
    for (size_t i = 0; i < sample_count; i++) {
        check(is_standing(&samples[i]) && are_wheels_as(&samples[i], &samples[0]), "moved at s", 0, samples[i].time);
    }
    check(result.length < 0.01, "driven, m", 0, result.length);
}

static inline void report(void)
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

static inline void drive_calm(enum patrol_scene_kind kind, uint64_t seed)
{
    make(kind, seed);
    drive();
    TEST_ASSERT_EQUAL_INT(PATROL_ARRIVED, result.outcome);
    memcpy(calm, samples, sizeof calm);
    calm_count = sample_count;
    forget_figures();
}

/* Into a drive for each cycle from FIRST on, every STRIDE-th, until the robot is about to arrive. */
static inline void inject(const struct injection *injection)
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

static inline void inject_into(enum patrol_scene_kind kind, uint64_t seed, const struct injection *injections,
                               size_t count)
{
    drive_calm(kind, seed);
    for (size_t i = 0; i < count; i++) {
        forget_figures();
        inject(&injections[i]);
    }
}

/* The sample of the last cycle before a time. */
static inline size_t cycle_before(double time)
{
    size_t cycle = 0;

    while (cycle + 1 < sample_count && samples[cycle + 1].time < time) {
        cycle++;
    }
    return cycle;
}

/* It stood when the fault was over, with that reason, and drove on. */
static inline void judge_pause(double fault, double end, enum jp_patrol_reason reason)
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

#endif
