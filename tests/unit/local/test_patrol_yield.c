/* How fast the patrol goes on among people: who walks, has walked, stands for long, is hidden, and in which cases it
 * brakes or had better drive on. */
#include "src/local/patrol_yield.h"

#include "src/local/patrol_state.h"
#include "src/local/patrol_turn.h"
#include "tests/support/patrol_rig.h"

#define RADIUS 0.2f
#define FAST   0.8f /* the highest speed of the rig's robot, m/s */

/* Of speeds, m/s. */
#define NEAR 1.0e-4f

static struct jp_plane_speed measured;

/* On an empty plane, at the origin, facing east; it is told to go straight on, to far away, and stands. */
void setUp(void)
{
    rig_reset();
    patrol.state = JP_PATROL_STEPPING;
    patrol.internal.step_target = (struct jp_plane_point){30.0f, 0.0f};
    patrol.internal.command = (struct jp_plane_speed){FAST, 0.0f};
    measured = (struct jp_plane_speed){0.0f, 0.0f};
}

void tearDown(void)
{
}

static struct jp_mover *put(float x, float y)
{
    struct jp_mover *const mover = &patrol.movers.movers[patrol.movers.count];

    *mover = (struct jp_mover){
        .centre = {x, y}, .radius = RADIUS, .place_variance = 1.0e-4f, .speed_variance = 1.0e-4f, .sightings = 10};
    patrol.movers.count++;
    return mover;
}

static struct jp_mover *put_walker(float x, float y, float forward, float left)
{
    struct jp_mover *const mover = put(x, y);
    const float speed = jp_plane_length(forward, left);

    mover->velocity = (struct jp_plane_point){forward, left};
    mover->walk = (struct jp_plane_point){forward / speed, left / speed};
    mover->pace = speed;
    return mover;
}

/* Who walked so, and stands now. */
static struct jp_mover *put_stander(float x, float y, float forward, float left)
{
    struct jp_mover *const mover = put_walker(x, y, forward, left);

    mover->velocity = (struct jp_plane_point){0.0f, 0.0f};
    return mover;
}

static float yielded(void)
{
    jp_patrol_yield(&patrol, &measured);
    return patrol.internal.command.forward;
}

static void expect_free(void)
{
    TEST_ASSERT_NEAR(NEAR, FAST, yielded());
    TEST_ASSERT_FALSE(patrol.internal.is_yielding);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.yields);
}

static void expect_stand(void)
{
    TEST_ASSERT_NEAR(NEAR, 0.0f, yielded());
    TEST_ASSERT_TRUE(patrol.internal.is_yielding);
}

/* At most the least of the speeds that are tried. */
static void expect_creep(void)
{
    TEST_ASSERT_TRUE(yielded() <= 0.1501f * FAST);
    TEST_ASSERT_TRUE(patrol.internal.is_yielding);
}

static void expect_slower(void)
{
    const float speed = yielded();

    TEST_ASSERT_TRUE(speed > 0.0f && speed < FAST);
    TEST_ASSERT_TRUE(patrol.internal.is_yielding);
}

/* ---- Who counts ---- */

static void test_nobody_is_there(void)
{
    expect_free();
}

static void test_what_never_walked_is_a_thing(void)
{
    (void)put(0.8f, 0.0f);
    expect_free();
}

static struct jp_mover *put_who_sets_off(void)
{
    struct jp_mover *const mover = put(1.5f, -1.5f);

    mover->velocity.y = 1.0f;
    return mover;
}

/* Before it is sure that somebody walks: what is likely to move as people do, is no larger, and was seen often enough
 * and not long ago. */
static void test_it_waits_for_who_seems_to_set_off(void)
{
    for (unsigned i = 0; i < 4U; i++) {
        struct jp_mover *mover;

        setUp();
        mover = put_who_sets_off();
        mover->sightings = i == 1U ? 4U : mover->sightings;
        mover->misses = i == 2U ? 5U : 0U;
        mover->speed_variance = i == 3U ? 0.2f : mover->speed_variance;
        TEST_ASSERT_TRUE(yielded() <= 0.1501f * FAST);
    }
    setUp();
    (void)put(1.5f, -1.5f);
    expect_free();
    for (unsigned i = 0; i < 5U; i++) {
        struct jp_mover *mover;

        setUp();
        mover = put_who_sets_off();
        mover->radius = i == 0U ? 0.4f : mover->radius;
        mover->sightings = i == 1U ? 3U : mover->sightings;
        mover->misses = i == 2U ? 6U : 0U;
        mover->speed_variance = i == 3U ? 0.3f : mover->speed_variance;
        mover->velocity.y = i == 4U ? 0.9f * config.movers.speed_min : mover->velocity.y;
        expect_free();
    }
}

/* What has come to where nothing was is heeded as soon as it is known how it moves. */
static void test_it_waits_for_who_has_come_into_sight(void)
{
    for (unsigned i = 0; i < 2U; i++) {
        struct jp_mover *mover;

        setUp();
        mover = put_who_sets_off();
        mover->has_come = true;
        mover->sightings = 2U - (uint8_t)i;
        if (i == 0U) {
            TEST_ASSERT_TRUE(yielded() <= 0.1501f * FAST);
        } else {
            expect_free();
        }
    }
}

static void test_who_stands_for_long_stays(void)
{
    struct jp_mover *const person = put_stander(1.2f, 0.9f, 0.0f, 1.0f);

    person->standing = config.people.stays + 0.1f;
    expect_free();
    person->standing = config.people.stays - 0.1f;
    expect_stand();
}

static void test_who_is_far_does_not_matter(void)
{
    (void)put_walker(30.0f, 0.0f, 0.0f, 1.0f);
    (void)put_stander(0.0f, -30.0f, 1.0f, 0.0f);
    expect_free();
}

/* ---- In time ---- */

static void test_it_waits_for_who_crosses(void)
{
    (void)put_walker(1.5f, -1.5f, 0.0f, 1.0f);
    expect_creep();
}

static void test_it_comes_slowly_to_where_somebody_will_have_passed(void)
{
    (void)put_walker(2.3f, -1.5f, 0.0f, 1.0f);
    measured.forward = FAST;
    expect_slower();
}

static void test_it_waits_for_who_comes_along_its_way(void)
{
    (void)put_walker(3.5f, 0.1f, -1.0f, 0.0f);
    expect_stand();
}

static void test_it_passes_who_comes_beside_its_way(void)
{
    (void)put_walker(3.5f, 1.5f, -1.0f, 0.0f);
    expect_free();
}

/* Who has crossed may turn round: until they are far enough it waits. */
static void test_it_expects_who_has_passed_to_turn_round(void)
{
    struct jp_mover *const person = put_walker(1.2f, 1.0f, 0.0f, 1.0f);

    expect_creep();
    person->centre.y = 4.0f;
    patrol.internal.command.forward = FAST;
    TEST_ASSERT_NEAR(NEAR, FAST, yielded());
    TEST_ASSERT_FALSE(patrol.internal.is_yielding);
}

/* On the same line, in either direction. */
static void test_it_expects_who_stands_to_walk_on_or_back(void)
{
    const float directions[] = {-1.0f, 1.0f};

    for (unsigned i = 0; i < 2U; i++) {
        setUp();
        (void)put_stander(1.2f, -1.2f, 0.0f, directions[i]);
        expect_stand();
    }
}

static void test_it_passes_who_stands_beside_their_line(void)
{
    (void)put_stander(1.2f, -1.2f, 1.0f, 0.0f);
    expect_free();
}

/* The slower somebody is known to walk the nearer they may be passed. */
static void test_pace_says_how_far_somebody_comes(void)
{
    (void)put_stander(1.2f, -1.8f, 0.0f, 0.31f);
    expect_free();
}

/* Somebody who has just turned round, or sets off, is soon as fast as they were. */
static void test_it_expects_who_is_slow_to_walk_as_fast_as_before(void)
{
    struct jp_mover *const person = put_walker(1.2f, -2.8f, 0.0f, 0.4f);

    expect_free();
    person->pace = 1.2f;
    patrol.internal.command.forward = FAST;
    TEST_ASSERT_TRUE(yielded() < FAST);
    TEST_ASSERT_TRUE(patrol.internal.is_yielding);
}

/* Not seen for a second and a half: they may have turned round when they were last seen. */
static void test_it_expects_who_is_hidden_to_have_turned_round(void)
{
    struct jp_mover *const person = put_walker(1.2f, 4.0f, 0.0f, 1.0f);

    person->misses = 15;
    expect_creep();
}

/* ---- Which way ---- */

static void test_it_may_leave_who_is_near(void)
{
    (void)put_walker(-0.8f, 0.0f, -1.0f, 0.0f);
    expect_free();
}

/* Backwards is no better than forward. */
static void test_it_does_not_drive_back_into_somebody(void)
{
    (void)put_walker(-1.5f, 0.0f, 1.0f, 0.0f);
    patrol.internal.command.forward = -0.3f;
    TEST_ASSERT_NEAR(NEAR, 0.0f, yielded());
    TEST_ASSERT_TRUE(patrol.internal.is_yielding);
}

static void test_it_does_not_step_into_somebody(void)
{
    (void)put_walker(0.0f, 1.6f, 0.0f, -0.8f);
    patrol.internal.command.forward = 0.0f;
    patrol.internal.sideways = 0.2f;
    patrol.internal.step_target = (struct jp_plane_point){0.0f, 30.0f};
    jp_patrol_yield(&patrol, &measured);
    TEST_ASSERT_NEAR(NEAR, 0.0f, patrol.internal.sideways);
    TEST_ASSERT_NEAR(NEAR, 0.0f, patrol.internal.sideways_before);
}

/* Somebody will pass behind a robot that steps on, but into one that stops before. */
static void test_a_step_ends_where_it_ends(void)
{
    (void)put_walker(0.0f, -2.9f, 0.0f, 1.0f);
    patrol.internal.step_target.x = 2.0f;
    expect_free();
    setUp();
    (void)put_walker(0.0f, -2.9f, 0.0f, 1.0f);
    patrol.internal.step_target.x = 0.4f;
    TEST_ASSERT_TRUE(yielded() < FAST);
}

/* A quarter of a turn would bring its front to where somebody passes. */
static void test_a_turn_ends_where_it_ends(void)
{
    const float turns[] = {0.05f, 0.5f * JP_PLANE_PI};

    for (unsigned i = 0; i < 2U; i++) {
        setUp();
        (void)put_walker(3.2f, 0.95f, -1.0f, 0.0f);
        patrol.state = JP_PATROL_TURNING;
        patrol.internal.command = (struct jp_plane_speed){0.0f, 1.0f};
        patrol.internal.turn_remaining = turns[i];
        jp_patrol_yield(&patrol, &measured);
        TEST_ASSERT_EQUAL_INT(i == 0U, patrol.internal.command.turn_rate == 1.0f);
    }
}

/* Its wheels lead it to the left, and on along its path, which keeps off somebody's way; its command alone does not. */
static void test_it_looks_along_the_glide(void)
{
    for (unsigned i = 0; i < 2U; i++) {
        setUp();
        rig_straight(0.0f, 0.0f, 0.5f, 0.0f);
        rig_straight(0.5f, 0.0f, i == 0U ? 0.5f : 4.5f, i == 0U ? 4.0f : 0.0f);
        TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(i == 0U ? 0.5f : 4.5f, i == 0U ? 4.0f : 0.0f, 0.0f, true));
        patrol.state = JP_PATROL_GLIDING;
        patrol.internal.command = (struct jp_plane_speed){FAST, 0.0f};
        (void)put_walker(2.3f, -2.5f, 0.0f, 0.7f);
        TEST_ASSERT_EQUAL_INT(i == 0U, yielded() == FAST);
    }
}

/* A corner would come nearer. */
static void test_it_does_not_turn_into_somebody(void)
{
    (void)put_walker(0.5f, 1.4f, 0.0f, -0.5f);
    patrol.internal.command = (struct jp_plane_speed){0.0f, 0.5f};
    jp_patrol_yield(&patrol, &measured);
    TEST_ASSERT_NEAR(NEAR, 0.0f, patrol.internal.command.turn_rate);
}

/* The curve of the command is kept. */
static void test_slower_is_on_the_same_curve(void)
{
    (void)put_walker(2.3f, -1.5f, 0.0f, 1.0f);
    patrol.internal.command.turn_rate = 0.08f;
    measured = patrol.internal.command;
    expect_slower();
    TEST_ASSERT_NEAR(NEAR, 0.1f * patrol.internal.command.forward, patrol.internal.command.turn_rate);
}

/* ---- The band ---- */

static void lay_band(const struct jp_plane_pose *poses, unsigned count)
{
    patrol.state = JP_PATROL_DRIVING;
    patrol.teb.count = (uint8_t)count;
    for (unsigned i = 0; i < count; i++) {
        patrol.teb.poses[i].pose = poses[i];
        patrol.teb.poses[i].interval = 0.1f;
    }
}

/* The command says straight on, the band turns away from the line of somebody; it may end on the spot. */
static void test_it_looks_along_the_band(void)
{
    const struct jp_plane_pose away[] = {
        {0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.5f}, {0.0f, 1.0f, 1.5f}, {0.0f, 3.0f, 1.5f}};
    const struct jp_plane_pose on[] = {{0.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f}, {3.0f, 0.0f, 0.0f}};
    const struct jp_plane_pose nowhere[] = {{0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f}};

    (void)put_walker(1.8f, -2.0f, 0.0f, 0.7f);
    lay_band(on, 3);
    expect_creep();
    lay_band(away, 5);
    patrol.counts.yields = 0;
    patrol.internal.command.forward = FAST;
    expect_free();
    lay_band(nowhere, 2);
    expect_free();
    lay_band(nowhere, 0);
    expect_free();
}

/* Fast, it would have passed before somebody comes; but that is not what the band plans. */
static void test_it_is_no_faster_than_the_band(void)
{
    const struct jp_plane_pose on[] = {{0.0f, 0.0f, 0.0f}, {1.5f, 0.0f, 0.0f}, {3.0f, 0.0f, 0.0f}};

    (void)put_walker(0.2f, -3.9f, 0.0f, 1.0f);
    lay_band(on, 3);
    measured.forward = FAST;
    expect_free();
    patrol.teb.poses[0].interval = 8.0f;
    patrol.teb.poses[1].interval = 8.0f;
    expect_stand();
}

/* At 0 its wheels would keep the angles of the moment, and lead it off the glide while it brakes. */
static void test_who_brakes_in_a_glide_goes_on_steering(void)
{
    (void)put_walker(1.6f, 0.0f, -1.0f, 0.0f);
    rig_straight(0.0f, 0.0f, 3.0f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(3.0f, 0.0f, 0.0f, true));
    patrol.state = JP_PATROL_GLIDING;
    patrol.internal.command = (struct jp_plane_speed){FAST, 0.5f};
    measured = (struct jp_plane_speed){FAST, 0.5f};
    TEST_ASSERT_TRUE(yielded() > 0.0f);
    TEST_ASSERT_TRUE(patrol.internal.command.forward < measured.forward - config.period * config.people.braking);
    /* It stands at once where it hardly moves. */
    measured.forward = 0.02f;
    patrol.internal.command = (struct jp_plane_speed){FAST, 0.5f};
    TEST_ASSERT_NEAR(NEAR, 0.0f, yielded());
}

/* ---- When nothing is free ---- */

/* Somebody comes from the side so late that a robot that brakes is reached before it has stood for a second, and one
 * that drives on is gone. */
static void test_it_drives_on_where_braking_is_worse(void)
{
    (void)put_walker(0.15f, 2.4f, 0.0f, -1.4f);
    measured.forward = FAST;
    TEST_ASSERT_TRUE(yielded() > 0.5f * FAST);
}

/* One that drives on would be touched too, only farther from their middle: at a stand it does less harm. */
static void test_it_brakes_where_it_is_touched_anyway(void)
{
    struct jp_mover *const person = put_walker(0.3f, 1.75f, 0.0f, -1.4f);

    person->speed_variance = 0.04f;
    measured.forward = FAST;
    expect_stand();
}

/* A thing beside them changes nothing. */
static void test_things_do_not_count_beside_people(void)
{
    (void)put(0.8f, 0.0f);
    (void)put_walker(30.0f, 0.0f, 0.0f, 1.0f);
    expect_free();
}

/* Straight in its way: it brakes. */
static void test_it_brakes_where_driving_on_is_worse(void)
{
    (void)put_walker(1.6f, 0.0f, -1.0f, 0.0f);
    measured.forward = FAST;
    expect_stand();
}

/* Somebody will have reached its place, but not before it has stood there: to drive on, farther from them, is worse. */
static void test_it_brakes_where_it_will_be_at_rest(void)
{
    (void)put_walker(-1.9f, 0.3f, 0.9f, 0.0f);
    measured.forward = 0.3f;
    patrol.internal.command.forward = 0.3f;
    expect_stand();
}

/* However long it has waited: in a turn its corners are fast, and it takes long to be at rest. */
static void test_it_looks_as_far_as_it_takes_to_be_at_rest(void)
{
    config.people.rest = 3.0f;
    rig_init();
    patrol.state = JP_PATROL_STEPPING;
    patrol.internal.step_target = (struct jp_plane_point){30.0f, 0.0f};
    patrol.internal.command = (struct jp_plane_speed){FAST, 0.0f};
    patrol.internal.yielded = 40.0f;
    measured.forward = FAST;
    (void)put_walker(3.1f, -3.9f, 0.0f, 1.0f);
    expect_slower();
}

/* One that stands is not asked to get out of the way. */
static void test_who_walks_into_a_robot_that_stands_finds_it_standing(void)
{
    (void)put_walker(0.3f, 1.2f, 0.0f, -1.4f);
    expect_stand();
}

/* ---- Counts ---- */

static void test_yields_are_counted_once(void)
{
    (void)put_walker(1.5f, -1.5f, 0.0f, 1.0f);
    expect_creep();
    patrol.internal.command.forward = FAST;
    expect_creep();
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.yields);
    patrol.movers.count = 0;
    patrol.internal.command.forward = FAST;
    TEST_ASSERT_NEAR(NEAR, FAST, yielded());
    (void)put_walker(1.5f, -1.5f, 0.0f, 1.0f);
    expect_creep();
    TEST_ASSERT_EQUAL_UINT32(2, patrol.counts.yields);
}

/* As it thinks over what to do, until it moves or nobody is there. */
static void test_who_stands_having_yielded_still_yields(void)
{
    (void)put_walker(1.5f, -1.5f, 0.0f, 1.0f);
    patrol.internal.command.forward = 0.0f;
    (void)yielded();
    TEST_ASSERT_FALSE(patrol.internal.is_yielding);
    patrol.internal.is_yielding = true;
    (void)yielded();
    TEST_ASSERT_TRUE(patrol.internal.is_yielding);
    patrol.movers.count = 0;
    (void)yielded();
    TEST_ASSERT_FALSE(patrol.internal.is_yielding);
}

static void test_who_waits_among_people_yields(void)
{
    patrol.state = JP_PATROL_WAITING;
    patrol.internal.command.forward = 0.0f;
    jp_patrol_yield(&patrol, &measured);
    TEST_ASSERT_FALSE(patrol.internal.is_yielding);
    (void)put_walker(3.0f, 0.0f, 0.0f, 1.0f);
    jp_patrol_yield(&patrol, &measured);
    TEST_ASSERT_TRUE(patrol.internal.is_yielding);
}

/* Its patience is not used up meanwhile. */
static void test_patience_is_kept_for_people(void)
{
    config.waits_max = 5;
    rig_init();
    rig_wall_ahead();
    rig_go(5.0f, 0.0f);
    (void)rig_until(JP_PATROL_WAITING, RIG_LONG);
    for (unsigned i = 0; i < 20U; i++) {
        patrol.movers.count = 0;
        (void)put_walker(-4.0f, 0.0f, -1.0f, 0.0f);
        rig_cycle();
        TEST_ASSERT_EQUAL_INT(JP_PATROL_WAITING, patrol.state);
    }
    patrol.movers.count = 0;
    jp_movers_clear(&patrol.movers);
    (void)rig_until(JP_PATROL_STOPPED, 10);
}

/* Nor do people make it mistrust its path. */
static void test_tries_are_not_counted_among_people(void)
{
    rig_init();
    rig_go(5.0f, 0.0f);
    jp_patrol_enter(&patrol, JP_PATROL_WAITING, JP_PATROL_BLOCKED);
    for (unsigned i = 0; i < 5U; i++) {
        patrol.movers.count = 0;
        (void)put_walker(-6.0f, 0.0f, -1.0f, 0.0f);
        rig_cycle();
    }
    TEST_ASSERT_EQUAL_INT(JP_PATROL_DRIVING, patrol.state);
    TEST_ASSERT_EQUAL_UINT(0, patrol.internal.tries);
    patrol.movers.count = 0;
    patrol.internal.is_yielding = false;
    jp_patrol_enter(&patrol, JP_PATROL_WAITING, JP_PATROL_BLOCKED);
    patrol.internal.free_cycles = 10;
    TEST_ASSERT_TRUE(jp_patrol_trust_path(&patrol));
    TEST_ASSERT_EQUAL_UINT(1, patrol.internal.tries);
}

/* ---- Clearance ---- */

static float speed_before(const struct jp_obstacle *wall, float forward)
{
    const struct jp_plane_point here = {0.0f, 0.0f};

    jp_obstacles_clear(&patrol.obstacles, &here);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add(&patrol.obstacles, wall));
    patrol.internal.command = (struct jp_plane_speed){forward, 0.0f};
    return yielded();
}

/* Across the way, or along it. */
static float speed_towards(float clearance)
{
    const float x = config.teb.footprint.front + clearance;
    const struct jp_obstacle wall = {.vertices = {{x, -3.0f}, {x, 3.0f}}, .vertex_count = 2, .radius = 0.0f};

    return speed_before(&wall, FAST);
}

static float speed_beside(float clearance)
{
    const float y = config.teb.footprint.half_width + clearance;
    const struct jp_obstacle wall = {.vertices = {{-3.0f, y}, {3.0f, y}}, .vertex_count = 2, .radius = 0.0f};

    return speed_before(&wall, FAST);
}

/* In which it stops from a speed: v t + v²/(2 a), without a latency, half a period later. */
static float way_from(float speed)
{
    return speed * 0.5f * RIG_PERIOD + 0.5f * speed * speed / config.people.braking;
}

/* It could stop 0.1 m before it; nearer it creeps, and could stop before 0.03 m. */
static void test_the_nearer_the_slower(void)
{
    float last = 0.0f;

    for (unsigned i = 1; i <= 25U; i++) {
        const float clearance = 0.02f * (float)i;
        const float seen = clearance + 0.5f * config.scan.tolerance;
        const float speed = speed_towards(clearance);

        TEST_ASSERT_TRUE(speed >= last);
        TEST_ASSERT_TRUE(way_from(speed) <= seen - 0.1f + 1.0e-3f || speed <= 0.1001f);
        TEST_ASSERT_TRUE(way_from(speed) <= seen - 0.03f + 1.0e-3f);
        TEST_ASSERT_TRUE(speed == FAST || way_from(speed) > seen - 0.101f);
        last = speed;
    }
    TEST_ASSERT_TRUE(last == FAST);
    TEST_ASSERT_TRUE(speed_towards(0.1f) < 0.3f * FAST);
}

static void test_what_it_passes_or_leaves_does_not_slow_it(void)
{
    const float x = -config.teb.footprint.rear - 0.1f;
    const struct jp_obstacle behind = {.vertices = {{x, -3.0f}, {x, 3.0f}}, .vertex_count = 2, .radius = 0.0f};

    TEST_ASSERT_TRUE(speed_beside(0.1f) == FAST);
    TEST_ASSERT_TRUE(speed_before(&behind, FAST) == FAST);
}

static void test_at_a_touch_it_stands(void)
{
    TEST_ASSERT_TRUE(speed_towards(0.0f) == 0.0f);
    TEST_ASSERT_TRUE(speed_towards(0.04f) > 0.02f);
}

/* ---- Who stays ---- */

static struct jp_mover *put_stander_who_stays(float x, float y)
{
    struct jp_mover *const person = put_stander(x, y, 0.0f, 1.0f);

    person->standing = config.people.stays + 1.0f;
    return person;
}

/* So near to the way that a fast robot would come nearer than its clearance from people; nobody makes way then. */
static void test_it_passes_slowly_who_stays(void)
{
    const float beside = config.teb.footprint.half_width + RADIUS;

    (void)put_stander_who_stays(1.2f, beside + 0.1f);
    measured.forward = FAST;

    const float speed = yielded();

    TEST_ASSERT_TRUE(speed > 0.0f && speed < FAST);
    TEST_ASSERT_FALSE(patrol.internal.is_yielding);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.yields);
}

static void test_who_stays_far_enough_aside_does_not_slow_it(void)
{
    (void)put_stander_who_stays(1.2f, config.teb.footprint.half_width + RADIUS + config.people.clearance + 0.05f);
    expect_free();
}

/* A turn in place beside somebody. */
static void test_it_turns_slowly_towards_who_stays(void)
{
    (void)put_stander_who_stays(0.0f, config.teb.footprint.half_width + RADIUS + 0.1f);
    patrol.internal.command = (struct jp_plane_speed){0.0f, 1.0f};
    (void)yielded();
    TEST_ASSERT_TRUE(patrol.internal.command.turn_rate > 0.0f && patrol.internal.command.turn_rate < 0.5f);
}

static void test_who_stays_and_is_out_of_sight_is_a_thing(void)
{
    put_stander_who_stays(1.2f, config.teb.footprint.half_width + RADIUS + 0.1f)->misses = 1;
    expect_free();
}

/* ---- Patience ---- */

static void wait_for(float seconds)
{
    const float period = config.period;

    for (float waited = 0.0f; waited < seconds; waited += period) {
        patrol.internal.command = (struct jp_plane_speed){FAST, 0.0f};
        (void)yielded();
    }
}

static void test_standing_for_people_is_counted(void)
{
    (void)put_walker(1.5f, -0.5f, 0.0f, 0.5f);
    wait_for(2.0f);
    TEST_ASSERT_NEAR(0.15f, 2.0f, patrol.internal.yielded);
    measured.forward = 0.5f;
    wait_for(2.0f);
    TEST_ASSERT_NEAR(0.25f, 1.0f, patrol.internal.yielded);
    wait_for(4.0f);
    TEST_ASSERT_TRUE(patrol.internal.yielded == 0.0f);
}

static void test_standing_without_people_is_not(void)
{
    wait_for(2.0f);
    TEST_ASSERT_TRUE(patrol.internal.yielded == 0.0f);
}

/* For who stays it does not wait. */
static void test_a_stop_among_people_who_may_walk_on_is_for_them(void)
{
    (void)put_walker(3.0f, -2.0f, 0.0f, 0.5f);
    patrol.state = JP_PATROL_WAITING;
    patrol.internal.command = (struct jp_plane_speed){0.0f, 0.0f};
    (void)yielded();
    TEST_ASSERT_TRUE(patrol.internal.is_yielding);
    patrol.movers.movers[0].standing = config.people.stays + 1.0f;
    (void)yielded();
    TEST_ASSERT_FALSE(patrol.internal.is_yielding);
}

/* Who has waited long enough takes a gap that does not last for all of what is foreseen. */
static void test_who_has_waited_for_long_takes_a_shorter_gap(void)
{
    (void)put_walker(3.1f, -3.9f, 0.0f, 1.0f);
    measured.forward = FAST;
    expect_slower();
    patrol.internal.command = (struct jp_plane_speed){FAST, 0.0f};
    patrol.internal.yielded = 40.0f;
    TEST_ASSERT_NEAR(NEAR, FAST, yielded());
}

/* Nearer than it would like to, but no nearer than to a thing. */
static void test_who_has_waited_for_long_passes_nearer_to_where_somebody_walks(void)
{
    const float waited[] = {0.0f, 40.0f, 40.0f};
    const float aside[] = {0.78f, 0.78f, 0.65f};

    for (unsigned i = 0; i < 3U; i++) {
        setUp();
        patrol.internal.yielded = waited[i];
        (void)put_walker(2.0f, aside[i], 0.5f, 0.0f);
        if (i == 1U) {
            TEST_ASSERT_NEAR(NEAR, FAST, yielded());
        } else {
            expect_slower();
        }
    }
}

/* A robot whose file asks for less of people than of things keeps that. */
static void test_who_keeps_little_keeps_it_however_long_it_has_waited(void)
{
    patrol.config.people.clearance = 0.05f;
    patrol.internal.yielded = 40.0f;
    (void)put_walker(2.0f, 0.7f, 0.5f, 0.0f);
    TEST_ASSERT_NEAR(NEAR, FAST, yielded());
}
