/* Who walks, has walked, or stands, of those whom a synthetic scanner sees. */
#include "tests/support/movers_rig.h"

void setUp(void)
{
    movers_rig_start();
}

void tearDown(void)
{
}

static void test_walker_who_stands_is_remembered(void)
{
    const struct jp_plane_point velocity = {0.6f, 0.8f};
    struct disc *const disc = put_disc(1.0f, -2.0f, RADIUS);

    walk(disc, velocity, SETTLED);
    TEST_ASSERT_TRUE(jp_mover_is_walking(&movers.movers[0], &config));
    TEST_ASSERT_NEAR(SPEED_ERROR, 1.0f, movers.movers[0].pace);
    TEST_ASSERT_NEAR(0.1f, velocity.x, movers.movers[0].walk.x);
    TEST_ASSERT_NEAR(0.1f, velocity.y, movers.movers[0].walk.y);
    TEST_ASSERT_TRUE(movers.movers[0].standing == 0.0f);

    walk(disc, (struct jp_plane_point){0.0f, 0.0f}, SETTLED);
    TEST_ASSERT_FALSE(jp_mover_is_walking(&movers.movers[0], &config));
    TEST_ASSERT_NEAR(0.2f, 1.0f, movers.movers[0].pace);
    TEST_ASSERT_NEAR(0.1f, velocity.x, movers.movers[0].walk.x);
    TEST_ASSERT_NEAR(0.1f, velocity.y, movers.movers[0].walk.y);
    TEST_ASSERT_NEAR(0.6f, SETTLED * PERIOD, movers.movers[0].standing);
}

/* To and fro on a line its direction is the last one. */
static void test_walk_turns_with_the_walker(void)
{
    struct disc *const disc = put_disc(2.0f, -1.0f, RADIUS);

    walk(disc, (struct jp_plane_point){0.0f, 1.0f}, SETTLED);
    TEST_ASSERT_NEAR(0.05f, 1.0f, movers.movers[0].walk.y);
    walk(disc, (struct jp_plane_point){0.0f, -1.0f}, SETTLED);
    TEST_ASSERT_NEAR(0.05f, -1.0f, movers.movers[0].walk.y);
}

/* Who turns round, and comes back not quite as they went, is at no time taken for somebody who walks across. */
static void test_walk_of_who_turns_round_stays_along_their_line(void)
{
    const struct jp_plane_point back = {0.26f, -0.97f};
    struct disc *const disc = put_disc(2.0f, -1.0f, RADIUS);

    walk(disc, (struct jp_plane_point){0.0f, 1.0f}, SETTLED);
    for (unsigned i = 0; i < SETTLED; i++) {
        walk(disc, back, 1);
        TEST_ASSERT_TRUE(jp_plane_magnitude(movers.movers[0].walk.y) > 0.8f);
    }
    TEST_ASSERT_NEAR(0.1f, back.x, movers.movers[0].walk.x);
    TEST_ASSERT_NEAR(0.1f, back.y, movers.movers[0].walk.y);
}

static void test_thing_that_shifts_by_less_than_its_size_has_not_walked(void)
{
    struct disc *const disc = put_disc(2.0f, 0.0f, RADIUS);

    for (unsigned i = 0; i < SETTLED; i++) {
        walk(disc, (struct jp_plane_point){0.0f, i % 4U < 2U ? 1.0f : -1.0f}, 1);
        TEST_ASSERT_FALSE(has_walked(0));
    }
}

/* Towards the sensor, away from it, past it and aslant. */
static void test_walk_in_any_direction_is_noticed(void)
{
    for (int degrees = -180; degrees < 180; degrees += 15) {
        setUp();

        const struct jp_plane_point direction = jp_plane_direction(JP_PLANE_PI / 180.0f * (float)degrees);
        struct disc *const disc = put_disc(3.0f, 0.0f, RADIUS);
        unsigned scans = 0;

        while (scans < SETTLED && !(movers.count > 0U && has_walked(0))) {
            walk(disc, direction, 1);
            scans++;
        }
        TEST_ASSERT_TRUE(scans <= NOTICED);
    }
}

/* Half hidden all the way, slower than its velocity is certain: by the way that it has gone. */
static void test_slow_walk_of_who_is_half_hidden_is_noticed(void)
{
    const float speed = 0.6f;
    const struct jp_mover *track;

    see_coarsely();
    put_wall(1.5f, -0.5f, 1.5f, 3.0f);

    struct disc *const disc = put_disc(3.0f, -1.0f, RADIUS);

    for (unsigned i = 0; i < SETTLED; i++) {
        look();
        disc->centre.y += PERIOD * speed;
        walls[0].from.y += 0.5f * PERIOD * speed;
    }
    track = track_of(disc, (struct jp_plane_point){0.0f, speed});
    TEST_ASSERT_NOT_NULL(track);
    TEST_ASSERT_FALSE(jp_mover_is_walking(track, &config));
    TEST_ASSERT_TRUE(track->pace > 0.0f);
}

/* Of who is half hidden: somebody else was beside them for a while. */
static void test_what_is_half_hidden_is_as_large_as_was_seen_lately(void)
{
    const struct jp_plane_point still = {0.0f, 0.0f};

    see_coarsely();
    put_wall(1.5f, -3.0f, 1.5f, 0.0f);
    (void)put_disc(3.0f, 0.0f, RADIUS);
    walk(&discs[0], still, 8);
    (void)put_disc(3.0f, 0.4f, RADIUS);
    walk(&discs[0], still, 2);
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_TRUE(movers.movers[0].radius > 1.1f * RADIUS);
    disc_count = 1;
    walk(&discs[0], still, 8);
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_EQUAL_UINT(18, movers.movers[0].sightings);
    TEST_ASSERT_TRUE(movers.movers[0].radius < RADIUS);
}

/* Past what stands: nobody has walked. */
static void drive_past(float speed, float turn_rate, unsigned scans)
{
    for (unsigned i = 0; i < scans; i++) {
        look();
        for (unsigned k = 0; k < movers.count; k++) {
            TEST_ASSERT_FALSE(has_walked(k));
        }
        sensor.x += PERIOD * speed;
        sensor.heading += PERIOD * turn_rate;
    }
}

/* Something wide goes past; or one of its sides goes out of sight while less of another one comes. */
static bool walks_between(float right, float left)
{
    setUp();
    see_coarsely();
    put_wall(2.0f, -1.2f, 2.0f, 0.2f);
    for (unsigned i = 0; i < 11U; i++) {
        look();
        walls[0].from.y += right;
        walls[0].to.y += left;
    }
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    return has_walked(0);
}

static void test_who_is_wide_is_seen_to_walk_by_both_rims(void)
{
    TEST_ASSERT_TRUE(walks_between(0.09f, 0.09f));
    TEST_ASSERT_FALSE(walks_between(0.14f, 0.04f));
}

/* Half hidden, something wide may turn another side to the scanner: within a second it is not known whether that is
 * where nothing was. */
static void test_who_is_wide_and_half_hidden_has_not_walked(void)
{
    see_coarsely();
    put_wall(2.0f, -0.8f, 2.0f, 0.4f);
    put_wall(1.2f, -0.6f, 1.2f, -0.3f);
    for (unsigned n = 0; n < 14U; n++) {
        movers.past[1].count = 0;
        look();
        for (unsigned k = 0; k < 2U; k++) {
            walls[k].from.y += k == 0U ? 0.08f : 0.048f;
            walls[k].to.y += k == 0U ? 0.08f : 0.048f;
        }
    }
    for (unsigned k = 0; k < movers.count; k++) {
        TEST_ASSERT_FALSE(has_walked(k) && movers.movers[k].centre.x > 1.6f);
    }
}

/* Between the end of the scan and where its points lie too far apart, what is seen of a wall goes with the robot. */
static void test_wall_that_is_seen_in_part_stands(void)
{
    for (unsigned i = 2; i <= 8U; i += 2U) {
        setUp();
        see_coarsely();
        put_wall(-10.0f, 0.6f, 10.0f, 0.6f);
        sensor.heading = -0.1f;
        drive_past(0.1f * (float)i, -0.2f, 30);
    }
}

/* Round a corner into a corridor: more and more comes into sight of a wall along which the scanner looks, and its
 * points lie far apart. */
static void test_wall_along_which_the_scanner_looks_stands(void)
{
    for (unsigned turn = 0; turn < 5U; turn++) {
        setUp();
        see_coarsely();
        scan_config.gap = 0.35f;
        put_wall(-6.0f, 0.0f, 0.0f, 0.0f);
        put_wall(0.0f, 0.0f, 0.0f, -6.0f);
        put_wall(-6.0f, 1.4f, 6.0f, 1.4f);
        sensor = (struct jp_plane_pose){0.55f, -0.6f, 1.6f};
        for (unsigned i = 0; i < 30U; i++) {
            drive_past(0.0f, 0.0f, 1);
            sensor.heading = jp_plane_smaller(sensor.heading + 0.07f + 0.02f * (float)turn, JP_PLANE_PI);
            sensor.x += 0.08f * jp_plane_cosine(sensor.heading);
            sensor.y += 0.08f * jp_plane_sine(sensor.heading);
        }
    }
}

/* One side comes into sight while another one goes. */
static void test_boxes_that_are_passed_stand(void)
{
    for (unsigned i = 0; i < 4U; i++) {
        const float side = 0.6f + 0.2f * (float)i;

        setUp();
        see_coarsely();
        put_box(-0.5f * side, 0.3f, 0.5f * side, 0.3f + side);
        sensor.x = -2.0f;
        drive_past(1.0f, -0.2f, 50);
    }
}

/* Whether a disc that goes past is known to walk, by no scan of a while ago, when all that was first seen of it lay at
 * one place, and a beam has another range. */
static bool walks_from(struct jp_plane_point place, unsigned beam, float range)
{
    struct disc *const disc = put_disc(2.0f, -1.0f, RADIUS);

    for (unsigned i = 0; i < SETTLED; i++) {
        take_scan();
        ranges[beam] = range;
        movers.past[1].count = 0;
        update();
        disc->centre.y += 0.8f * PERIOD;
        for (unsigned k = 0; k < JP_MOVER_POINTS; k++) {
            movers.movers[0].seen[k] = place;
        }
    }
    return has_walked(0);
}

/* Between two beams to the left: empty where both end clearly behind it. */
static void test_place_that_beams_pass_is_empty(void)
{
    const struct jp_plane_point direction = jp_plane_direction(0.5f * JP_PLANE_PI + 0.5f * scan.angle_step);
    const struct jp_plane_point place = {3.0f * direction.x, 3.0f * direction.y};
    const unsigned right = 3 * BEAMS / 4;
    volatile float large = FLT_MAX; /* the compiler must not see that it overflows */

    const struct {
        unsigned beam;
        float range;
        bool passes;
    } cases[] = {
        {right, 0.0f, true},          {right, 3.2f, true},      {right, 3.1f, false},      {right, -1.0f, false},
        {right, large * 2.0f, false}, {right + 1U, 3.2f, true}, {right + 1U, 3.1f, false},
    };

    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        setUp();
        TEST_ASSERT_EQUAL_INT(cases[i].passes, walks_from(place, cases[i].beam, cases[i].range));
    }
}

/* Beams that see nothing end there. */
static void test_place_at_the_end_of_the_range_may_be_taken(void)
{
    const struct jp_plane_point place = {0.0f, 3.0f};

    config.range = 3.1f;
    TEST_ASSERT_FALSE(walks_from(place, 0, 0.0f));
    setUp();
    config.range = 3.2f;
    TEST_ASSERT_TRUE(walks_from(place, 0, 0.0f));
}

static void test_place_beside_the_scan_may_be_taken(void)
{
    const struct jp_plane_point place = {0.0f, 3.0f};

    scan.count = 3 * BEAMS / 4 - 2;
    TEST_ASSERT_FALSE(walks_from(place, 0, 0.0f));
}

/* Two who go side by side become one thing for the scanner, and two again. */
static void test_those_who_part_have_walked_both(void)
{
    const struct jp_plane_point velocity = {0.0f, 1.0f};

    (void)put_disc(2.0f, -1.8f, 0.2f);
    (void)put_disc(2.0f, -1.3f, 0.2f);
    config.extent = 1.2f;
    for (unsigned i = 0; i < 14U; i++) {
        look();
        discs[0].centre.y += PERIOD * velocity.y;
        discs[1].centre.y += PERIOD * velocity.y;
    }
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_TRUE(has_walked(0));
    TEST_ASSERT_NEAR(0.1f, 0.45f, movers.movers[0].radius);

    const float before = movers.movers[0].velocity.y;

    discs[1].centre.y += 0.4f;
    look();
    TEST_ASSERT_EQUAL_UINT(2, movers.count);
    TEST_ASSERT_TRUE(has_walked(0));
    TEST_ASSERT_TRUE(has_walked(1));
    TEST_ASSERT_TRUE(movers.movers[0].velocity.y < before);
    TEST_ASSERT_TRUE(movers.movers[0].velocity.y > 0.5f * before);
    TEST_ASSERT_TRUE(movers.movers[1].velocity.y > 0.5f * before);
    TEST_ASSERT_TRUE(movers.movers[1].standing == 0.0f);

    /* The companion is seen to walk. */
    for (unsigned i = 0; i < 12U; i++) {
        discs[0].centre.y += PERIOD * velocity.y;
        discs[1].centre.y += PERIOD * velocity.y;
        look();
    }
    TEST_ASSERT_TRUE(has_walked(0));
    TEST_ASSERT_TRUE(has_walked(1));
}

/* Somebody has passed a post that comes into sight beside them: for a while it may be somebody who goes along. */
static void test_what_stands_beside_a_walker_is_no_companion(void)
{
    struct disc *const walker = put_disc(3.0f, -2.0f, RADIUS);
    unsigned taken = 0;

    walk(walker, (struct jp_plane_point){0.0f, 1.0f}, 18);

    const struct disc *const post = put_disc(3.0f, walker->centre.y - 0.75f, 0.2f);

    for (unsigned i = 0; i < 14U; i++) {
        walk(walker, (struct jp_plane_point){0.0f, 1.0f}, 1);
        for (unsigned k = 0; k < movers.count; k++) {
            const bool is_post = jp_plane_square_between(movers.movers[k].centre, post->centre) < 0.3f * 0.3f;

            taken += is_post && has_walked(k) ? 1U : 0U;
            TEST_ASSERT_FALSE(is_post && has_walked(k) && i >= 12U);
            TEST_ASSERT_FALSE(!is_post && movers.movers[k].misses == 0U && !has_walked(k));
        }
    }
    TEST_ASSERT_TRUE(taken >= 5U);
}

/* Beside a walker, who appears while they pass, and stands for some scans, walks for some, and stands again. */
static void walk_beside(unsigned stands, unsigned walks, float speed)
{
    setUp();

    struct disc *const walker = put_disc(3.0f, -2.0f, RADIUS);

    walk(walker, (struct jp_plane_point){0.0f, 1.0f}, 18);

    struct disc *const other = put_disc(3.0f, walker->centre.y - 0.75f, 0.2f);

    for (unsigned i = 0; i < SETTLED; i++) {
        walk(walker, (struct jp_plane_point){0.0f, 1.0f}, 1);
        other->centre.y -= i >= stands && i < stands + walks ? PERIOD * speed : 0.0f;
        for (unsigned k = 0; k < movers.count; k++) {
            TEST_ASSERT_TRUE(has_walked(k));
        }
    }
}

/* No post: it is too fast for that when it is judged, or it has left its place before. */
static void test_companion_who_is_slow_or_stops_walks(void)
{
    walk_beside(6, SETTLED, 0.45f);
    walk_beside(0, 6, 0.8f);
}

static const struct jp_mover *track_at(const struct disc *disc)
{
    for (unsigned i = 0; i < movers.count; i++) {
        if (jp_plane_square_between(movers.movers[i].centre, disc->centre) < 0.3f * 0.3f) {
            return &movers.movers[i];
        }
    }
    return NULL;
}

/* Two come from both sides to somebody who never walked, and all are one thing for the scanner for long. Who walks out
 * of it then, on whatever side, is known to walk at once; who stays alone is known to stand after a while. */
static void test_who_was_seen_as_one_with_a_stander_is_remembered(void)
{
    const unsigned scans = 5U * SETTLED;

    for (unsigned first = 1; first <= 2U; first++) {
        setUp();
        see_coarsely();
        (void)put_disc(2.5f, 0.0f, RADIUS);
        (void)put_disc(2.5f, -2.5f, RADIUS);
        (void)put_disc(2.5f, 2.5f, RADIUS);
        for (unsigned i = 0; i < scans; i++) {
            look();
            discs[1].centre.y += i < 19U ? PERIOD : 0.0f;
            discs[2].centre.y -= i < 19U ? PERIOD : 0.0f;
        }
        TEST_ASSERT_EQUAL_UINT(1, movers.count);
        TEST_ASSERT_TRUE(has_walked(0));

        for (unsigned i = 0; i < 2U; i++) {
            struct disc *const leaver = &discs[i == 0U ? first : 3U - first];
            const float side = leaver->centre.y < 0.0f ? -1.0f : 1.0f;

            leaver->centre.y += 0.25f * side;
            look();
            TEST_ASSERT_NOT_NULL(track_at(leaver));
            TEST_ASSERT_TRUE(track_at(leaver)->pace > 0.0f);
            walk(leaver, (struct jp_plane_point){0.0f, side}, SETTLED);
            TEST_ASSERT_TRUE(track_at(leaver) == NULL || track_at(leaver)->pace > 0.0f);
        }
        TEST_ASSERT_NOT_NULL(track_at(&discs[0]));
        TEST_ASSERT_TRUE(track_at(&discs[0])->pace == 0.0f);
    }
}

/* A walker stops at what is larger than a person, and is seen as one with it. */
static void test_shelf_remembers_nobody(void)
{
    see_coarsely();
    put_box(2.5f, -0.5f, 3.0f, 0.5f);

    struct disc *const walker = put_disc(2.75f, -2.75f, RADIUS);

    walk(walker, (struct jp_plane_point){0.0f, 1.0f}, 19);
    walk(walker, (struct jp_plane_point){0.0f, 0.0f}, 3);
    TEST_ASSERT_EQUAL_UINT(2, movers.count);
    for (unsigned k = 0; k < movers.count; k++) {
        TEST_ASSERT_EQUAL_INT(movers.movers[k].misses > 0U, has_walked(k));
    }
}

/* Somebody who walked elsewhere goes out of sight as something is put beside a post. */
static void test_who_is_elsewhere_is_not_remembered(void)
{
    see_coarsely();
    (void)put_disc(2.5f, 0.0f, RADIUS);

    struct disc *const walker = put_disc(-1.2f, -2.5f, RADIUS);

    walk(walker, (struct jp_plane_point){1.0f, 0.0f}, SETTLED);
    *walker = (struct disc){{2.5f, 0.3f}, RADIUS};
    look();
    TEST_ASSERT_EQUAL_UINT(2, movers.count);
    for (unsigned k = 0; k < movers.count; k++) {
        TEST_ASSERT_EQUAL_INT(movers.movers[k].centre.y < -1.0f, has_walked(k));
    }
}

/* Two who came side by side, are one for the scanner, and shift from foot to foot in their places. */
static void test_those_who_shift_in_their_places_stand(void)
{
    struct disc *const one = put_disc(2.0f, -2.0f, RADIUS);
    struct disc *const other = put_disc(2.0f, -1.5f, RADIUS);
    const struct jp_plane_point velocity = {0.0f, 0.8f};

    config.extent = 2.0f;
    for (unsigned i = 0; i < SETTLED; i++) {
        look();
        one->centre.y += PERIOD * velocity.y;
        other->centre.y += PERIOD * velocity.y;
    }
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_TRUE(has_walked(0));
    TEST_ASSERT_NEAR(0.5f, 0.0f, movers.movers[0].standing);
    for (unsigned i = 0; i < 60; i++) {
        const float shift = (i / 4U) % 2U == 0U ? 0.06f : -0.06f; /* 0.24 m to and fro, at 0.6 m/s */

        look();
        one->centre.y += shift;
        other->centre.y += shift;
    }
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_TRUE(movers.movers[0].standing > 4.0f);

    /* When they go on, they walk again. */
    for (unsigned i = 0; i < 12; i++) {
        look();
        one->centre.y += PERIOD * velocity.y;
        other->centre.y += PERIOD * velocity.y;
    }
    TEST_ASSERT_TRUE(movers.movers[0].standing < 0.9f);
}
