/* Who walks: each condition on its own, of movers and things that are put there, against what the headers say. */
#include "src/local/movers_walk.h"

#include "tests/support/movers_rig.h"

static struct jp_mover_thing thing;
static struct jp_mover mover;
static struct jp_scan_view view;

/* Somebody who walks along x at 1 m/s, well known, before a wall at x = 6 m. */
void setUp(void)
{
    movers_rig_start();
    put_wall(6.0f, -6.0f, 6.0f, 6.0f);
    take_scan();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_open(&view, &scan_config, &scan, &sensor));
    thing = (struct jp_mover_thing){
        .centre = {3.0f, 0.0f}, .radius = 0.2f, .across = {0.0f, 1.0f}, .is_free = {true, true}};
    mover = (struct jp_mover){.centre = {3.0f, 0.0f},
                              .velocity = {1.0f, 0.0f},
                              .radius = 0.2f,
                              .own = 0.2f,
                              .largest = 0.2f,
                              .origin = {2.0f, 0.0f},
                              .stood = {2.0f, 0.0f},
                              .speed_variance = 0.01f,
                              .standing = 1.5f,
                              .sightings = 4,
                              .alone = 10};
    for (int i = 0; i < JP_MOVER_POINTS; i++) {
        mover.seen[i] = (struct jp_plane_point){1.8f, 0.1f * (float)(i - 1)};
        thing.seen[i] = (struct jp_plane_point){2.8f, 0.1f * (float)(i - 1)};
    }
}

void tearDown(void)
{
}

static bool note(void)
{
    const bool had_stood = mover.standing > 0.0f;

    jp_mover_note_walk(&mover, &config, &thing, &view);
    return had_stood && mover.standing == 0.0f;
}

/* ---- Is it walking ---- */

static void test_it_walks_faster_than_things_and_than_its_error(void)
{
    config.speed_min = 0.3f;
    mover.speed_variance = 0.04f;
    mover.velocity = (struct jp_plane_point){0.31f, 0.41f};
    TEST_ASSERT_TRUE(jp_mover_is_walking(&mover, &config));
    mover.velocity = (struct jp_plane_point){0.29f, -0.39f};
    TEST_ASSERT_FALSE(jp_mover_is_walking(&mover, &config));
    mover.speed_variance = 0.0f;
    TEST_ASSERT_TRUE(jp_mover_is_walking(&mover, &config));
    mover.velocity = (struct jp_plane_point){0.0f, 0.29f};
    TEST_ASSERT_FALSE(jp_mover_is_walking(&mover, &config));
    mover.velocity = (struct jp_plane_point){0.22f, 0.22f};
    TEST_ASSERT_TRUE(jp_mover_is_walking(&mover, &config));
}

/* ---- Who has begun to walk ---- */

static void test_who_left_a_place_that_is_empty_walks(void)
{
    TEST_ASSERT_TRUE(note());
    TEST_ASSERT_NEAR(1.0e-6f, 1.0f, mover.pace);
    TEST_ASSERT_NEAR(1.0e-6f, 1.0f, mover.walk.x);
    TEST_ASSERT_NEAR(1.0e-6f, 0.0f, mover.walk.y);
    TEST_ASSERT_NEAR(1.0e-6f, 3.0f, mover.stood.x);
    TEST_ASSERT_TRUE(jp_mover_has_walked(&mover));
}

static void test_before_so_many_sightings_nothing_is_said(void)
{
    mover.sightings = SIGHTINGS_MIN - 1;
    TEST_ASSERT_FALSE(note());
    mover.sightings = SIGHTINGS_MIN;
    TEST_ASSERT_TRUE(note());
}

static void test_who_was_seen_first_must_be_likely_to_walk(void)
{
    mover.speed_variance = 0.45f;
    TEST_ASSERT_FALSE(note());
    mover.speed_variance = 0.43f;
    TEST_ASSERT_TRUE(note());
}

/* By four fifths of its largest radius and 0.1 m. */
static void test_what_has_not_left_its_place_stands(void)
{
    for (int i = 0; i < 8; i++) {
        const struct jp_plane_point along = jp_plane_direction(0.25f * JP_PLANE_PI * (float)i);

        for (int far = 0; far < 2; far++) {
            const float way = 0.8f * 0.5f + 0.1f + (far == 1 ? 0.01f : -0.01f);

            setUp();
            mover.largest = 0.5f;
            mover.origin = (struct jp_plane_point){3.0f + way * along.x, way * along.y};
            TEST_ASSERT_EQUAL_INT(far == 1, note());
        }
    }
}

/* Who comes from where nothing was need not leave a place. */
static void test_who_has_come_walks_at_once(void)
{
    mover.origin = mover.centre;
    TEST_ASSERT_FALSE(note());
    thing.has_come = true;
    TEST_ASSERT_TRUE(note());
}

/* Something stands where it was, and what is seen of it is not before what was seen. */
static void test_what_is_still_where_it_was_has_not_walked(void)
{
    put_wall(1.8f, -0.5f, 1.8f, 0.5f);
    take_scan();
    for (int i = 0; i < JP_MOVER_POINTS; i++) {
        thing.seen[i].x = 1.8f;
    }
    TEST_ASSERT_FALSE(note());
    /* One of the places is empty now. */
    mover.seen[JP_MOVER_POINTS - 1].y = 1.5f;
    TEST_ASSERT_TRUE(note());
}

/* Clearly before the chord of what was seen, and between the beams to its ends. */
static void test_what_is_where_beams_went_through_has_walked(void)
{
    static const struct jp_plane_point places[] = {{1.5f, 0.0f},   {1.5f, 0.05f},  {1.7f, 0.0f},
                                                   {1.5f, 0.095f}, {1.5f, -0.08f}, {1.5f, -0.095f},
                                                   {1.9f, 0.0f},   {0.4f, 0.01f},  {-0.2f, 0.0f}};
    static const bool are_before[] = {true, true, false, false, true, false, false, true, false};

    for (unsigned i = 0; i < sizeof places / sizeof places[0]; i++) {
        for (unsigned k = 0; k < JP_MOVER_POINTS; k++) {
            setUp();
            put_wall(1.8f, -0.5f, 1.8f, 0.5f);
            take_scan();
            for (unsigned j = 0; j < JP_MOVER_POINTS; j++) {
                thing.seen[j] = (struct jp_plane_point){1.8f, 0.0f};
            }
            thing.seen[k] = places[i];
            TEST_ASSERT_EQUAL_INT(are_before[i], note());
        }
    }
}

/* Whose sensor was elsewhere then. */
static void test_the_beams_then_were_from_where_the_sensor_was(void)
{
    put_wall(1.8f, -0.5f, 1.8f, 0.5f);
    take_scan();
    mover.seen_from = (struct jp_plane_point){1.8f, 3.0f};
    mover.seen[0] = (struct jp_plane_point){1.7f, 0.1f};
    mover.seen[1] = (struct jp_plane_point){1.8f, 0.1f};
    mover.seen[2] = (struct jp_plane_point){1.9f, 0.1f};
    for (unsigned j = 0; j < JP_MOVER_POINTS; j++) {
        thing.seen[j] = (struct jp_plane_point){1.8f, 0.0f};
    }
    TEST_ASSERT_FALSE(note());
    thing.seen[1] = (struct jp_plane_point){1.78f, 0.5f};
    TEST_ASSERT_TRUE(note());
}

/* What is larger than a person must be seen whole, and no smaller than before. */
static void test_what_is_large_must_be_steady(void)
{
    for (int i = 0; i < 6; i++) {
        setUp();
        thing.radius = i < 3 ? 0.36f : 0.34f;
        thing.is_free[1] = i % 3 != 0;
        mover.own = i % 3 == 1 ? thing.radius + 0.06f : thing.radius + 0.04f;
        TEST_ASSERT_EQUAL_INT(i >= 2, note());
    }
}

/* ---- Who has walked ---- */

static void test_a_walk_follows_the_velocity(void)
{
    mover.pace = 1.0f;
    mover.walk = (struct jp_plane_point){0.6f, 0.8f};
    mover.velocity = (struct jp_plane_point){1.2f, 0.5f}; /* 1.3 m/s */

    const float x = 0.7f * 0.6f + 0.3f * 1.2f / 1.3f;
    const float y = 0.7f * 0.8f + 0.3f * 0.5f / 1.3f;
    const float length = jp_plane_length(x, y);

    TEST_ASSERT_TRUE(note());
    TEST_ASSERT_NEAR(2.0e-6f, x / length, mover.walk.x);
    TEST_ASSERT_NEAR(2.0e-6f, y / length, mover.walk.y);
    TEST_ASSERT_NEAR(2.0e-6f, 1.0f + 0.3f * 0.3f, mover.pace);
    mover.velocity = (struct jp_plane_point){0.59f, 0.0f};
    (void)note();
    TEST_ASSERT_NEAR(2.0e-6f, 1.09f - 0.02f * 0.5f, mover.pace);
}

/* Who turns round walks the other way at once. */
static void test_who_turns_round_does_so_on_their_line(void)
{
    for (int i = 0; i < 2; i++) {
        const float side = i == 0 ? 1.0f : -1.0f;
        const float x = -0.7f * 0.6f + 0.3f * -0.8f;
        const float y = side * (-0.7f * 0.8f + 0.3f * -0.6f);
        const float length = jp_plane_length(x, y);

        setUp();
        mover.pace = 1.0f;
        mover.walk = (struct jp_plane_point){0.6f, side * 0.8f};
        mover.velocity = (struct jp_plane_point){-0.8f, side * -0.6f};
        TEST_ASSERT_TRUE(note());
        TEST_ASSERT_NEAR(2.0e-6f, x / length, mover.walk.x);
        TEST_ASSERT_NEAR(2.0e-6f, y / length, mover.walk.y);
    }
}

/* What it walks by then is not what was likely at first. */
static void test_who_has_walked_and_is_not_certain_to_stands(void)
{
    mover.pace = 1.0f;
    mover.walk.x = 1.0f;
    mover.speed_variance = 0.17f;
    TEST_ASSERT_FALSE(note());
    TEST_ASSERT_NEAR(1.0e-6f, 1.5f, mover.standing);
    mover.speed_variance = 0.15f;
    TEST_ASSERT_TRUE(note());
}

/* Several who stand together shift in their places. */
static void test_several_walk_on_where_they_have_left_where_they_stood(void)
{
    for (int i = 0; i < 3; i++) {
        setUp();
        mover.pace = 1.0f;
        mover.walk.x = 1.0f;
        mover.radius = i == 2 ? 0.34f : 0.5f;
        mover.stood = (struct jp_plane_point){3.0f, i == 1 ? 0.51f : 0.49f};
        TEST_ASSERT_EQUAL_INT(i > 0, note());
        TEST_ASSERT_NEAR(1.0e-6f, i > 0 ? 0.0f : 0.49f, mover.stood.y);
    }
}

/* ---- Companions ---- */

static void judge(void)
{
    jp_mover_judge_companion(&mover, &config);
}

static void become_companion(void)
{
    setUp();
    mover.is_companion = true;
    mover.pace = 1.0f;
    mover.walk.x = 1.0f;
    mover.origin = mover.centre;
    mover.velocity.x = 0.2f;
}

static void test_a_companion_that_stands_is_none_and_has_not_walked(void)
{
    become_companion();
    judge();
    TEST_ASSERT_FALSE(mover.is_companion);
    TEST_ASSERT_NEAR(1.0e-6f, 0.0f, mover.pace);
    TEST_ASSERT_NEAR(1.0e-6f, 0.0f, mover.walk.x);
    TEST_ASSERT_NEAR(1.0e-6f, 0.0f, mover.walk.y);
}

static void test_a_companion_is_not_judged_before_it_is_seen_alone(void)
{
    become_companion();
    mover.alone = 9;
    judge();
    TEST_ASSERT_TRUE(mover.is_companion);
    TEST_ASSERT_NEAR(1.0e-6f, 1.0f, mover.pace);
    become_companion();
    mover.is_companion = false;
    judge();
    TEST_ASSERT_NEAR(1.0e-6f, 1.0f, mover.pace);
}

/* By its speed or its way it is one who walks for itself. */
static void test_a_companion_that_walks_has_walked(void)
{
    become_companion();
    mover.velocity.x = 0.5f;
    judge();
    TEST_ASSERT_FALSE(mover.is_companion);
    TEST_ASSERT_NEAR(1.0e-6f, 1.0f, mover.pace);
    become_companion();
    mover.origin.y = 0.27f;
    judge();
    TEST_ASSERT_FALSE(mover.is_companion);
    TEST_ASSERT_NEAR(1.0e-6f, 1.0f, mover.pace);
    /* Neither is clear. */
    become_companion();
    mover.velocity.x = 0.31f;
    mover.speed_variance = 0.1f;
    judge();
    TEST_ASSERT_TRUE(mover.is_companion);
    TEST_ASSERT_NEAR(1.0e-6f, 1.0f, mover.pace);
}

static void put(const struct jp_mover *track)
{
    movers.movers[movers.count] = *track;
    movers.count++;
}

static void test_who_walks_beside_a_thing_is_its_companion(void)
{
    put(&mover);
    mover.pace = 1.0f;
    mover.radius = 0.3f;
    mover.centre.y = 1.01f;
    put(&mover);
    mover.centre = (struct jp_plane_point){3.0f + 0.6f, -0.8f + 0.012f};
    put(&mover);
    put(&mover);
    TEST_ASSERT_TRUE(jp_movers_companion(&movers, &thing) == &movers.movers[2]);
    movers.movers[2].centre.y -= 0.03f;
    movers.movers[3].pace = 0.0f;
    TEST_ASSERT_NULL(jp_movers_companion(&movers, &thing));
    movers.movers[1].centre.y = 0.99f;
    TEST_ASSERT_TRUE(jp_movers_companion(&movers, &thing) == &movers.movers[1]);
    movers.count = 1;
    TEST_ASSERT_NULL(jp_movers_companion(&movers, &thing));
}

/* ---- Walkers who are seen as one with somebody who stands ---- */

/* The walker is 0, the stander 1, in either order. */
static void put_both(bool is_walker_first)
{
    struct jp_mover walker;
    struct jp_mover stander;

    setUp();
    walker = mover;
    stander = mover;
    walker.pace = 1.2f;
    walker.walk = (struct jp_plane_point){0.6f, 0.8f};
    walker.misses = 1;
    walker.centre = (struct jp_plane_point){3.3f, 0.3f};
    stander.alone = 0;
    stander.radius = 0.3f;
    stander.centre = (struct jp_plane_point){3.0f, 0.0f};
    put(is_walker_first ? &walker : &stander);
    put(is_walker_first ? &stander : &walker);
}

static bool has_joined(bool is_walker_first)
{
    const struct jp_mover *const stander = &movers.movers[is_walker_first ? 1 : 0];

    movers.movers[2] = *stander;
    movers.movers[3] = movers.movers[is_walker_first ? 0 : 1];
    jp_movers_join(&movers);
    TEST_ASSERT_NEAR(1.0e-6f, 0.0f, movers.movers[2].pace);
    if (stander->is_companion) {
        TEST_ASSERT_NEAR(1.0e-6f, 1.2f, stander->pace);
        TEST_ASSERT_NEAR(1.0e-6f, 0.6f, stander->walk.x);
        TEST_ASSERT_NEAR(1.0e-6f, 0.8f, stander->walk.y);
        TEST_ASSERT_NEAR(1.0e-6f, 0.0f, stander->standing);
    } else {
        TEST_ASSERT_NEAR(1.0e-6f, 1.5f, stander->standing);
    }
    return stander->is_companion;
}

static void test_what_is_seen_of_both_remembers_the_walk(void)
{
    for (int i = 0; i < 2; i++) {
        put_both(i == 0);
        TEST_ASSERT_TRUE(has_joined(i == 0));
    }
}

/* Of all that must be so none may fail. */
static void test_who_is_not_seen_as_one_with_a_walker_does_not_walk(void)
{
    for (int i = 0; i < 7; i++) {
        put_both(true);

        struct jp_mover *const walker = &movers.movers[0];
        struct jp_mover *const stander = &movers.movers[1];

        walker->misses = (uint8_t)(i != 0);
        walker->pace = i == 1 ? 0.0f : 1.2f;
        stander->misses = (uint8_t)(i == 2);
        stander->alone = (uint8_t)(i == 3);
        stander->own = i == 4 ? 0.36f : 0.34f;
        walker->centre.x += i == 5 ? 0.12f : 0.09f;
        TEST_ASSERT_EQUAL_INT(i == 6, has_joined(true));
    }
}
