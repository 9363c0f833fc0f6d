/* People in the simulation: how they walk, stop, turn round and are blocked, and whose doing a touch is, against
 * closed formulas for a robot that drives straight on or stands and somebody who walks straight on. */
#include <math.h>

#include "sim/base/random.h"
#include "sim/base/strict_math.h"
#include "sim/scenes/patrol_world.h"
#include "tests/support/check.h"
#include "tests/support/office_map.h"
#include "tests/support/options.h"
#include "unity.h"

#define TICK        0.01 /* s */
#define HALF_LENGTH 0.4  /* m */
#define HALF_WIDTH  0.3
#define RADIUS      0.25
#define BRAKING     1.0 /* m/s² */
#define BEFORE      4.0 /* of a history, s */

/* Verdicts within this of a limit may be either, m. */
#define SLOT 0.01

static struct options options = {.count = 400, .seed = 60};
static struct random noise;

void setUp(void)
{
    random_init(&noise, options.seed);
}

void tearDown(void)
{
}

/* ---- Walks ---- */

static struct walker random_walker(void)
{
    struct walker walker = {.from = {random_uniform(&noise, 0, 9), random_uniform(&noise, 0, 9)},
                            .radius = RADIUS,
                            .speed = random_uniform(&noise, 0.5, 1.6),
                            .starts = random_uniform(&noise, 0, 2),
                            .stays = random_uniform(&noise, 0, 1) < 0.3,
                            .act_count = (size_t)random_uniform(&noise, 0, WALKER_ACTS_MAX + 1)};
    const double angle = random_uniform(&noise, -M_PI, M_PI);
    const double length = random_uniform(&noise, 1, 8);
    double time = walker.starts;

    walker.to = (struct planar_point){walker.from.x + length * cos(angle), walker.from.y + length * sin(angle)};
    for (size_t i = 0; i < walker.act_count; i++) {
        time += random_uniform(&noise, 0.5, 4);
        walker.acts[i] = (struct walker_act){time, random_uniform(&noise, 0, 2), random_uniform(&noise, 0, 1) < 0.5};
        time += walker.acts[i].rest;
    }
    return walker;
}

/* On the line, not faster than the walker is, no change of speed faster than people change it, and the velocity is
 * what the place changes by. */
static void test_walks_are_as_people_walk(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const struct walker walker = random_walker();
        const double length = strict_hypot(walker.to.x - walker.from.x, walker.to.y - walker.from.y);
        struct walker_state state;

        walker_begin(&walker, &state);
        for (int tick = 0; tick < 3000; tick++) {
            const struct walker_state next = walker_next(&walker, &state, TICK);
            const struct planar_point here = walker_place(&walker, &state);
            const struct planar_point there = walker_place(&walker, &next);
            const struct planar_point velocity = walker_velocity(&walker, &next);
            const double way = hypot(there.x - here.x, there.y - here.y);

            TEST_ASSERT_TRUE(next.along >= 0 && next.along <= length);
            TEST_ASSERT_TRUE(fabs(next.speed) <= walker.speed + 1e-9);
            TEST_ASSERT_TRUE(fabs(next.speed - state.speed) <= WALKER_ACCELERATION * TICK + 1e-9);
            check_near(fabs(next.speed), hypot(velocity.x, velocity.y), 1e-9, "speed, m/s");
            check_near(fabs(next.speed + state.speed) / 2 * TICK, way, 0.01, "way in a tick, m");
            TEST_ASSERT_TRUE(next.since <= next.time && next.since >= state.since);
            if (tick * TICK < walker.starts - TICK) {
                TEST_ASSERT_TRUE(next.along == 0);
            }
            state = next;
        }
    }
}

static void walk_for(const struct walker *walker, struct walker_state *state, double seconds)
{
    for (int i = 0; i < (int)lround(seconds / TICK); i++) {
        *state = walker_next(walker, state, TICK);
    }
}

/* By hand: 1 m/s, which takes 0.5 s and 0.25 m to reach or to lose. */
static void test_acts_come_in_time(void)
{
    const struct walker walker = {.to = {6, 0},
                                  .radius = RADIUS,
                                  .speed = 1,
                                  .stays = true,
                                  .acts = {{2, 1, false}, {5, 0.5, true}},
                                  .act_count = 2};
    struct walker_state state;

    walker_begin(&walker, &state);
    walk_for(&walker, &state, 2);
    check_near(1.75, state.along, 0.02, "before the stop, m");
    walk_for(&walker, &state, 1.4);
    check_near(2, state.along, 0.02, "at the stop, m");
    check_near(0, state.speed, 1e-9, "speed at the stop, m/s");
    walk_for(&walker, &state, 1.5); /* from 3.5 s on again */
    check_near(3.15, state.along, 0.04, "walking on, m");
    walk_for(&walker, &state, 1); /* it turns at 5.5 s and waits until 6 s */
    check_near(3.5, state.along, 0.04, "at the turn, m");
    TEST_ASSERT_EQUAL_INT(-1, state.direction);
    walk_for(&walker, &state, 2);
    TEST_ASSERT_TRUE(state.speed < 0);
    walk_for(&walker, &state, 20);
    check_near(6, state.along, 0.02, "at the end, where it stays, m");
    check_near(0, state.speed, 1e-9, "speed there, m/s");
}

static void test_a_pause_at_each_end(void)
{
    const struct walker walker = {.to = {3, 0}, .radius = RADIUS, .speed = 1, .pause = 2};
    struct walker_state state;

    walker_begin(&walker, &state);
    walk_for(&walker, &state, 3.6); /* there after 3.5 s */
    check_near(3, state.along, 0.02, "at the end, m");
    TEST_ASSERT_EQUAL_INT(-1, state.direction);
    walk_for(&walker, &state, 1.8);
    check_near(3, state.along, 0.02, "before the pause is over, m");
    walk_for(&walker, &state, 3.7); /* back after 9 s */
    check_near(0, state.along, 0.02, "back, m");
    walk_for(&walker, &state, 1.8);
    check_near(0, state.along, 0.02, "in the pause there, m");
    walk_for(&walker, &state, 1.2);
    TEST_ASSERT_TRUE(state.speed > 0);
}

static void test_who_is_blocked_turns_round_after_a_while(void)
{
    const struct walker walker = {.to = {6, 0}, .radius = RADIUS, .speed = 1};
    struct walker_state state;

    walker_begin(&walker, &state);
    walk_for(&walker, &state, 3);
    const double along = state.along;
    for (int i = 0; i < (int)(WALKER_PATIENCE / TICK) - 1; i++) {
        state = walker_blocked(&state, TICK);
        TEST_ASSERT_EQUAL_INT(1, state.direction);
        TEST_ASSERT_TRUE(state.speed == 0 && state.along == along);
    }
    state = walker_blocked(&state, TICK);
    state = walker_blocked(&state, TICK);
    TEST_ASSERT_EQUAL_INT(-1, state.direction);
    walk_for(&walker, &state, 1);
    TEST_ASSERT_TRUE(state.along < along);
}

/* A robot that stands shifts by less than a millimetre now and then: who pushes on is no less impatient. */
static void test_who_is_blocked_but_for_instants_turns_round_too(void)
{
    const struct walker walker = {.to = {6, 0}, .radius = RADIUS, .speed = 1};
    struct walker_state state;

    walker_begin(&walker, &state);
    walk_for(&walker, &state, 3);
    for (int i = 0; i < (int)(WALKER_PATIENCE / TICK); i++) {
        state = walker_blocked(&state, TICK);
        state = i % 20 == 0 ? walker_next(&walker, &state, TICK) : state;
        TEST_ASSERT_EQUAL_INT(1, state.direction);
    }
    state = walker_blocked(&state, TICK);
    state = walker_blocked(&state, TICK);
    TEST_ASSERT_EQUAL_INT(-1, state.direction);
    walk_for(&walker, &state, 1);
    TEST_ASSERT_TRUE(state.blocked == 0);
}

/* ---- Whose doing a touch is ---- */

/* A robot at the origin at the time 0, which drives along x; somebody is at a place then, and walks straight on. Both
 * begin `BEFORE` before that, or the robot stops some time before. */
struct meeting {
    double speed; /* of the robot, until it stops */
    double stops; /* before the touch, s; 0: it does not */
    struct planar_point place;
    struct planar_point velocity;
    double since; /* s; at most 0 */
};

static double robot_at(const struct meeting *meeting, double time)
{
    return meeting->speed * fmin(time + meeting->stops, 0);
}

static struct planar_point person_at(const struct meeting *meeting, double time)
{
    const double walked = fmax(time, meeting->since);

    return (struct planar_point){meeting->place.x + walked * meeting->velocity.x,
                                 meeting->place.y + walked * meeting->velocity.y};
}

static double gap(double x, const struct planar_point *person)
{
    return hypot(fmax(fabs(person->x - x) - HALF_LENGTH, 0), fmax(fabs(person->y) - HALF_WIDTH, 0)) - RADIUS;
}

/* Towards the person when they touch. */
static double normal_x(const struct meeting *meeting)
{
    const double beyond_x = fmax(fabs(meeting->place.x) - HALF_LENGTH, 0);
    const double beyond_y = fmax(fabs(meeting->place.y) - HALF_WIDTH, 0);

    return copysign(beyond_x, meeting->place.x) / hypot(beyond_x, beyond_y);
}

static double way_within_a_second(const struct meeting *meeting)
{
    return robot_at(meeting, 0) - robot_at(meeting, -1);
}

/* The least gap from an instant of braking on until the robot has stood for a second. */
static double gap_if_braked(const struct meeting *meeting, double from)
{
    const double speed = from < -meeting->stops ? meeting->speed : 0;
    const double stop = speed / BRAKING;
    double least = INFINITY;

    for (double since = 0.005; since <= stop + 1; since += 0.005) {
        const double braked = fmin(since, stop);
        const double way = fmin(speed * braked - BRAKING * braked * braked / 2,
                                robot_at(meeting, fmin(from + since, 0)) - robot_at(meeting, from));
        const struct planar_point person = person_at(meeting, from + since);

        least = fmin(least, gap(robot_at(meeting, from) + way, &person));
    }
    return least;
}

static double best_gap(const struct meeting *meeting)
{
    double best = -INFINITY;

    for (double from = fmax(meeting->since, -CONTACT_HISTORY); from < -1e-9; from += 0.1) {
        best = fmax(best, gap_if_braked(meeting, from));
    }
    return best;
}

static struct contact_verdict verdict_of(const struct meeting *meeting)
{
    static struct contact_history history;
    const struct contact_robot robot = {HALF_LENGTH, HALF_WIDTH, BRAKING};
    const struct contact_person person = {1, RADIUS, meeting->velocity, meeting->since};

    history.count = 0;
    history.next = (size_t)random_uniform(&noise, 0, CONTACT_MOMENTS);
    for (int i = (int)lround(-BEFORE / TICK); i <= 0; i++) {
        const struct contact_moment moment = {.time = i * TICK,
                                              .robot = {robot_at(meeting, i * TICK), 0, 0},
                                              .people = {{50, 50}, person_at(meeting, i * TICK)}};

        contact_keep(&history, &moment);
    }
    return contact_judge(&history, &robot, &person);
}

/* They touch at the time 0, all around the robot. */
static struct meeting random_meeting(void)
{
    const double angle = random_uniform(&noise, -M_PI, M_PI);
    const double walk = random_uniform(&noise, -M_PI, M_PI);
    const double pace = random_uniform(&noise, 0, 1.5);
    struct meeting meeting = {.speed = random_uniform(&noise, 0, 1),
                              .stops = random_uniform(&noise, 0, 1) < 0.5 ? 0 : random_uniform(&noise, 0, 2),
                              .velocity = {pace * cos(walk), pace * sin(walk)},
                              .since = random_uniform(&noise, -BEFORE, 0)};
    double low = 0;
    double high = 2;

    for (int i = 0; i < 50; i++) {
        const double middle = (low + high) / 2;
        const struct planar_point there = {middle * cos(angle), middle * sin(angle)};

        *(gap(0, &there) < 0 ? &low : &high) = middle;
    }
    meeting.place = (struct planar_point){low * cos(angle), low * sin(angle)};
    return meeting;
}

static void test_verdicts_are_those_of_formulas(void)
{
    unsigned moved = 0;
    unsigned into = 0;
    unsigned avoidable = 0;
    unsigned unavoidable = 0;

    for (unsigned long run = 0; run < 5 * options.count; run++) {
        const struct meeting meeting = random_meeting();
        const struct contact_verdict verdict = verdict_of(&meeting);
        const double way = way_within_a_second(&meeting);
        const double towards = way * normal_x(&meeting);
        const double best = best_gap(&meeting);

        if (fabs(way - CONTACT_MOVED) > SLOT / 2) {
            TEST_ASSERT_TRUE_MESSAGE(verdict.has_moved == (way > CONTACT_MOVED), "has moved");
            moved += verdict.has_moved;
        }
        if (fabs(towards - CONTACT_MOVED) > SLOT / 2) {
            TEST_ASSERT_TRUE_MESSAGE(verdict.moved_into == (towards > CONTACT_MOVED), "moved into");
            into += verdict.moved_into;
        }
        if (fabs(best - CONTACT_NEAR) > 4 * SLOT) {
            TEST_ASSERT_TRUE_MESSAGE(verdict.avoidable == (best > CONTACT_NEAR), "avoidable");
            avoidable += verdict.avoidable;
            unavoidable += !verdict.avoidable;
        }
    }
    TEST_ASSERT_TRUE(moved > options.count && into > options.count / 2);
    TEST_ASSERT_TRUE(avoidable > options.count / 4 && unavoidable > options.count / 4);
}

static void test_a_robot_that_stood_for_a_second_has_done_nothing(void)
{
    const struct meeting meeting = {
        .speed = 1, .stops = 1.1, .place = {HALF_LENGTH + RADIUS, 0}, .velocity = {-1, 0}, .since = -BEFORE};
    const struct meeting too_late = {
        .speed = 1, .stops = 0.9, .place = {HALF_LENGTH + RADIUS, 0}, .velocity = {-1, 0}, .since = -BEFORE};
    const struct contact_verdict verdict = verdict_of(&meeting);
    const struct contact_verdict other = verdict_of(&too_late);

    TEST_ASSERT_FALSE(contact_is_collision(&verdict));
    TEST_ASSERT_TRUE(contact_is_collision(&other));
}

/* Somebody who has just set off walks into its back as it drives away: braking would not have helped. */
static void test_a_robot_that_is_overtaken_from_behind(void)
{
    const struct meeting meeting = {
        .speed = 0.5, .place = {-HALF_LENGTH - RADIUS, 0}, .velocity = {1.5, 0}, .since = -0.5};
    const struct contact_verdict verdict = verdict_of(&meeting);

    TEST_ASSERT_TRUE(verdict.has_moved);
    TEST_ASSERT_FALSE(verdict.moved_into);
    TEST_ASSERT_FALSE(verdict.avoidable);
}

/* ---- In the world ---- */

static struct office office;
static struct patrol_world world;

static void open_world(const struct planar_pose *pose)
{
    TEST_ASSERT_TRUE(office_make(&office, &noise));
    TEST_ASSERT_TRUE(patrol_world_init(&world, &office.terrain, 2 * HALF_LENGTH, 2 * HALF_WIDTH, pose));
}

static void step(const struct planar_pose *pose, double seconds)
{
    for (int i = 0; i < (int)lround(seconds / TICK); i++) {
        patrol_world_step(&world, pose, TICK);
    }
}

/* One step away from it whoever stands nearest. */
static void test_nobody_walks_through_the_robot(void)
{
    const struct planar_pose pose = {12, 7, 0};
    const struct walker person = {.from = {14, 7.1}, .to = {10, 7.1}, .radius = RADIUS, .speed = 1.2};

    open_world(&pose);
    TEST_ASSERT_TRUE(patrol_world_add_person(&world, &person));
    for (int i = 0; i < 600; i++) {
        step(&pose, TICK);
        TEST_ASSERT_TRUE(world.shapes[0].pose.x >= 12 + HALF_LENGTH + RADIUS - 1e-6);
    }
    TEST_ASSERT_EQUAL_UINT(1, world.contacts.touches);
    TEST_ASSERT_EQUAL_UINT(0, world.contacts.collisions);
    TEST_ASSERT_EQUAL_INT(PATROL_TOUCH_NONE, world.first_touch);
    TEST_ASSERT_TRUE(world.shapes[0].pose.x > 13); /* gone back */
    TEST_ASSERT_TRUE(world.person_distance_min == PATROL_DISTANCE_MAX);
    patrol_world_free(&world);
}

static void test_the_robot_drives_into_somebody(void)
{
    struct planar_pose pose = {12, 7, 0};
    const struct walker person = {.from = {13.2, 7}, .to = {16, 7}, .radius = RADIUS, .speed = 1, .starts = 100};

    open_world(&pose);
    TEST_ASSERT_TRUE(patrol_world_add_person(&world, &person));
    while (world.contacts.touches == 0) {
        pose.x += 0.5 * TICK;
        step(&pose, TICK);
        TEST_ASSERT_TRUE(pose.x < 13);
    }
    TEST_ASSERT_EQUAL_UINT(1, world.contacts.collisions);
    TEST_ASSERT_EQUAL_UINT(1, world.contacts.moved_into);
    TEST_ASSERT_EQUAL_UINT(1, world.contacts.avoidable);
    TEST_ASSERT_EQUAL_INT(PATROL_TOUCH_PERSON, world.first_touch);
    check_near(0, world.person_distance_min, 0.01, "distance from people, m");
    TEST_ASSERT_TRUE(world.distance_min > 0);
    patrol_world_free(&world);
}

/* Somebody pushes on against a robot that stands; then it sets off into them. */
static void test_a_robot_that_sets_off_against_who_pushes(void)
{
    struct planar_pose pose = {12, 7, 0};
    const struct walker person = {.from = {13.5, 7}, .to = {10, 7}, .radius = RADIUS, .speed = 1};

    open_world(&pose);
    TEST_ASSERT_TRUE(patrol_world_add_person(&world, &person));
    step(&pose, 2.5);
    TEST_ASSERT_EQUAL_UINT(1, world.contacts.touches);
    TEST_ASSERT_EQUAL_UINT(0, world.contacts.collisions);
    for (int i = 0; i < 50; i++) {
        pose.x += 0.3 * TICK;
        step(&pose, TICK);
    }
    TEST_ASSERT_EQUAL_UINT(1, world.contacts.touches);
    TEST_ASSERT_EQUAL_UINT(1, world.contacts.collisions);
    patrol_world_free(&world);
}

static void test_people_are_bounded(void)
{
    const struct planar_pose pose = {12, 7, 0};
    const struct walker person = {.from = {3, 7}, .to = {4, 7}, .radius = RADIUS, .speed = 1};

    open_world(&pose);
    for (int i = 0; i < PATROL_PEOPLE_MAX; i++) {
        TEST_ASSERT_TRUE(patrol_world_add_person(&world, &person));
    }
    TEST_ASSERT_FALSE(patrol_world_add_person(&world, &person));
    TEST_ASSERT_EQUAL_INT(PATROL_PEOPLE_MAX, (int)(world.shape_count - world.thing_count));
    patrol_world_free(&world);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
