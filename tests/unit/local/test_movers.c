/* Discs and walls that a synthetic scanner sees: which of them are tracked, how well, and which shapes get their
 * velocity. Who is known to walk: test_movers_walk.c. */
#include "tests/support/movers_rig.h"

void setUp(void)
{
    movers_rig_start();
}

void tearDown(void)
{
}

/* ---- What is a thing ---- */

static void test_nothing_is_seen_on_an_empty_plane(void)
{
    look();
    TEST_ASSERT_EQUAL_UINT(0, movers.count);
}

static void test_disc_is_a_thing_in_its_place(void)
{
    (void)put_disc(2.0f, 1.0f, RADIUS);
    look();
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_NEAR(PLACE_ERROR, 2.0f, movers.movers[0].centre.x);
    TEST_ASSERT_NEAR(PLACE_ERROR, 1.0f, movers.movers[0].centre.y);
    TEST_ASSERT_NEAR(0.03f, RADIUS, movers.movers[0].radius);
    TEST_ASSERT_EQUAL_UINT(1, movers.movers[0].sightings);
    TEST_ASSERT_EQUAL_UINT(0, movers.movers[0].misses);
}

/* A quarter of a turn from the sensor's right to its front; the disc lies across one end or the other. */
static void test_what_the_end_of_a_scan_cuts_is_seen_in_part(void)
{
    scan.first_angle = -0.5f * JP_PLANE_PI;
    scan.count = BEAMS / 4;

    struct disc *const disc = put_disc(0.0f, -2.0f, RADIUS);

    look();
    TEST_ASSERT_TRUE(ranges[0] > 0.0f);
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_TRUE(movers.movers[0].radius < 0.7f * RADIUS);

    jp_movers_clear(&movers);
    disc->centre = (struct jp_plane_point){2.0f, 0.0f};
    look();
    TEST_ASSERT_TRUE(ranges[scan.count - 1U] > 0.0f);
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_TRUE(movers.movers[0].radius < 0.7f * RADIUS);
}

/* All of a scan of a sixth of a turn lies on the disc. */
static void test_what_is_cut_at_both_ends_is_not_a_thing(void)
{
    scan.first_angle = -JP_PLANE_PI / 12.0f;
    scan.count = BEAMS / 12;
    (void)put_disc(1.2f, 0.0f, 0.44f);
    look();
    TEST_ASSERT_EQUAL_UINT(0, movers.count);
}

/* Beams that drop out beside a disc tell nothing: the next ones do. */
static void test_dropouts_beside_a_thing_are_skipped(void)
{
    (void)put_disc(14.0f, 0.0f, 8.0f); /* nearly a wall, too wide to be a thing */
    (void)put_disc(3.0f, 0.0f, RADIUS);
    take_scan();

    unsigned first = 0;

    while (!(ranges[first] > 0.0f && ranges[first] < 4.0f)) {
        first++;
    }
    ranges[first - 1U] = -1.0f;
    ranges[first - 2U] = -1.0f;
    update();
    TEST_ASSERT_EQUAL_UINT(1, movers.count);

    /* Within it, beside its end. */
    jp_movers_clear(&movers);
    ranges[first + 1U] = -1.0f;
    ranges[first + 2U] = -1.0f;
    update();
    TEST_ASSERT_EQUAL_UINT(1, movers.count);

    /* Dropouts to the end of the scan: on that side it may be hidden. */
    jp_movers_clear(&movers);
    for (unsigned i = 0; i < first; i++) {
        ranges[i] = -1.0f;
    }
    update();
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
}

/* The front one hides the right or the left of the one behind it: the middle of the rest is not its own. */
static void test_what_is_half_hidden_is_a_thing_less_exactly(void)
{
    const float beside[] = {-0.25f, 0.25f};

    for (unsigned i = 0; i < 2U; i++) {
        setUp();
        (void)put_disc(4.0f, 0.0f, 0.4f);
        for (unsigned k = 0; k < SETTLED; k++) {
            look();
        }
        TEST_ASSERT_EQUAL_UINT(1, movers.count);
        TEST_ASSERT_NEAR(0.2f, 4.0f, movers.movers[0].centre.x);
        TEST_ASSERT_NEAR(0.02f, 0.0f, movers.movers[0].centre.y);

        (void)put_disc(2.0f, beside[i], RADIUS);
        look();
        TEST_ASSERT_EQUAL_UINT(2, movers.count);
        TEST_ASSERT_EQUAL_UINT(0, movers.movers[0].misses);
        TEST_ASSERT_TRUE(jp_plane_magnitude(movers.movers[0].centre.y) < 0.35f);
    }
}

static void test_thing_stands_in_front_of_what_is_behind_it(void)
{
    (void)put_disc(14.0f, 0.0f, 8.0f); /* nearly a wall, too wide to be a thing */
    look();
    TEST_ASSERT_EQUAL_UINT(0, movers.count);
    (void)put_disc(3.0f, 0.0f, RADIUS);
    look();
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_NEAR(PLACE_ERROR, 3.0f, movers.movers[0].centre.x);
}

static void test_width_of_a_thing_is_limited(void)
{
    (void)put_disc(3.0f, 0.0f, 0.44f);
    look();
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    jp_movers_clear(&movers);
    config.extent = 0.6f;
    look();
    TEST_ASSERT_EQUAL_UINT(0, movers.count);
}

static void test_few_points_are_noise(void)
{
    (void)put_disc(4.0f, 0.0f, 0.05f);
    scan_config.beams_min = 4;
    look();
    TEST_ASSERT_EQUAL_UINT(0, movers.count);
    scan_config.beams_min = 2;
    look();
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
}

/* It does not tell how its surface goes on. */
static void test_a_single_point_is_no_thing(void)
{
    (void)put_disc(4.0f, 0.0f, 0.05f);
    scan_config.beams_min = 1;
    take_scan();
    for (unsigned i = 0; i < BEAMS; i++) {
        ranges[i] = i == BEAMS / 2 ? 4.0f : 0.0f;
    }
    update();
    TEST_ASSERT_EQUAL_UINT(0, movers.count);
}

/* ---- Tracks ---- */

/* It passes in front of the sensor, from 4 m on one side to 4 m on the other. */
static void test_walking_disc_is_tracked_with_its_velocity(void)
{
    const struct jp_plane_point velocity = {0.4f, -1.2f};
    struct disc *const disc = put_disc(1.0f, 3.6f, RADIUS);

    for (unsigned i = 0; i < 60U; i++) {
        walk(disc, velocity, 1);
        TEST_ASSERT_EQUAL_UINT(1, movers.count);
        if (i >= SETTLED) {
            TEST_ASSERT_NEAR(SPEED_ERROR, velocity.x, movers.movers[0].velocity.x);
            TEST_ASSERT_NEAR(SPEED_ERROR, velocity.y, movers.movers[0].velocity.y);
            TEST_ASSERT_NEAR(PLACE_ERROR, disc->centre.x - PERIOD * velocity.x, movers.movers[0].centre.x);
            TEST_ASSERT_NEAR(PLACE_ERROR, disc->centre.y - PERIOD * velocity.y, movers.movers[0].centre.y);
        }
    }
}

/* The sensor drives and turns; in the frame that stands the disc walks as before. */
static void test_velocity_is_that_over_the_ground(void)
{
    const struct jp_plane_point velocity = {-0.9f, 0.5f};
    struct disc *const disc = put_disc(3.0f, -1.0f, RADIUS);

    for (unsigned i = 0; i < SETTLED; i++) {
        walk(disc, velocity, 1);
        sensor.x -= PERIOD * 0.8f;
        sensor.heading += PERIOD * 0.7f;
    }
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_NEAR(SPEED_ERROR, velocity.x, movers.movers[0].velocity.x);
    TEST_ASSERT_NEAR(SPEED_ERROR, velocity.y, movers.movers[0].velocity.y);
}

/* The longer the period the slower is the same way from scan to scan. */
static void test_velocity_is_by_the_period(void)
{
    struct disc *const disc = put_disc(2.0f, -1.0f, RADIUS);

    for (unsigned i = 0; i < SETTLED; i++) {
        take_scan();
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_movers_update(&movers, &config, &scan_config, &scan, &sensor, 0.2f));
        disc->centre.y += 0.1f;
    }
    TEST_ASSERT_NEAR(SPEED_ERROR, 0.0f, movers.movers[0].velocity.x);
    TEST_ASSERT_NEAR(SPEED_ERROR, 0.5f, movers.movers[0].velocity.y);
}

static void test_two_that_meet_keep_their_velocities(void)
{
    struct disc *const one = put_disc(3.0f, -1.0f, 0.2f);
    struct disc *const other = put_disc(2.3f, 1.0f, 0.2f);

    for (unsigned i = 0; i < 20U; i++) {
        look();
        one->centre.y += 0.1f;
        other->centre.y -= 0.1f;
    }
    /* The front one hides the other on the way; after that both are seen again. */
    TEST_ASSERT_EQUAL_UINT(2, movers.count);
    for (unsigned i = 0; i < 2U; i++) {
        const float sign = movers.movers[i].centre.x > 2.65f ? 1.0f : -1.0f;

        TEST_ASSERT_NEAR(2.0f * SPEED_ERROR, sign, movers.movers[i].velocity.y);
        TEST_ASSERT_NEAR(0.1f, 0.9f * sign, movers.movers[i].centre.y);
    }
}

/* One overtakes another behind them: for the scanner they are one for a while, one is hidden, and they part. Each keeps
 * its velocity all the time. */
static void test_two_who_cross_aslant_keep_their_velocities(void)
{
    const struct jp_plane_point velocities[] = {{-0.6f, -0.95f}, {-1.35f, -0.6f}};

    see_coarsely();
    (void)put_disc(2.2f, 3.19f, RADIUS);
    (void)put_disc(3.75f, 2.5f, RADIUS);
    for (unsigned i = 0; i < 25U; i++) {
        look();
        for (unsigned k = 0; k < 2U && i >= 10U; k++) {
            const struct jp_mover *const track = track_of(&discs[k], velocities[k]);

            TEST_ASSERT_NOT_NULL(track);
            TEST_ASSERT_TRUE(jp_plane_square_between(track->velocity, velocities[k]) < 0.65f * 0.65f);
        }
        for (unsigned k = 0; k < 2U; k++) {
            discs[k].centre.x += PERIOD * velocities[k].x;
            discs[k].centre.y += PERIOD * velocities[k].y;
        }
        sensor.x -= 0.5f * PERIOD;
    }
}

/* Out from behind a wall, to either side: by the rim that is seen, long before all of somebody is. */
static void test_who_comes_out_is_known_by_the_free_rim(void)
{
    const float sides[] = {-1.0f, 1.0f};

    for (unsigned i = 0; i < 2U; i++) {
        const struct jp_plane_point velocity = {0.0f, sides[i]};

        setUp();
        put_wall(1.9f, -sides[i] * 3.0f, 1.9f, 0.0f);

        struct disc *const disc = put_disc(3.0f, 0.0f, RADIUS);

        disc->centre.y = -0.2f * sides[i];
        walk(disc, velocity, 6);
        TEST_ASSERT_NOT_NULL(track_of(disc, velocity));
        TEST_ASSERT_NEAR(0.35f, velocity.y, track_of(disc, velocity)->velocity.y);
    }
}

/* A post that a wall hides to the half, and that the sensor passes: it stands, as its free rim does. */
static void test_what_is_half_hidden_stands_by_its_free_rim(void)
{
    const float sides[] = {-1.0f, 1.0f};

    for (unsigned i = 0; i < 2U; i++) {
        setUp();
        put_wall(1.5f, -sides[i] * 3.0f, 1.5f, 0.0f);
        (void)put_disc(3.0f, 0.0f, RADIUS);
        sensor.y = sides[i];
        for (unsigned k = 0; k < 20U; k++) {
            look();
            sensor.y -= sides[i] * 0.8f * PERIOD;
            for (unsigned m = 0; m < movers.count; m++) {
                TEST_ASSERT_FALSE(jp_mover_is_walking(&movers.movers[m], &config));
            }
        }
    }
}

/* A second thing beside the first one, within reach of its track. */
static void test_track_takes_one_thing_of_a_scan(void)
{
    scan_config.gap = 0.1f;
    (void)put_disc(2.0f, 0.0f, 0.1f);
    look();
    (void)put_disc(2.0f, 0.33f, 0.1f);
    look();
    TEST_ASSERT_EQUAL_UINT(2, movers.count);
    look();
    TEST_ASSERT_EQUAL_UINT(2, movers.count);
    TEST_ASSERT_EQUAL_UINT(3, movers.movers[0].sightings);
    TEST_ASSERT_EQUAL_UINT(2, movers.movers[1].sightings);
    TEST_ASSERT_NEAR(0.03f, 0.0f, movers.movers[0].centre.y);
    TEST_ASSERT_NEAR(0.03f, 0.33f, movers.movers[1].centre.y);
}

/* It walks aslant, and neither part of its velocity tells that it is too fast. */
static void test_nothing_is_faster_than_the_limit(void)
{
    struct disc *const disc = put_disc(2.0f, 0.0f, RADIUS);
    float fastest = 0.0f;

    config.speed_max = 0.4f;
    walk(disc, (struct jp_plane_point){0.0f, 0.0f}, 3);
    for (unsigned i = 0; i < SETTLED; i++) {
        walk(disc, (struct jp_plane_point){0.35f, 0.35f}, 1);

        const float speed = jp_plane_length(movers.movers[0].velocity.x, movers.movers[0].velocity.y);

        TEST_ASSERT_TRUE(speed <= config.speed_max * 1.000001f);
        fastest = speed > fastest ? speed : fastest;
    }
    TEST_ASSERT_TRUE(fastest > 0.999f * config.speed_max);
}

static void test_what_jumps_too_far_is_another_thing(void)
{
    struct disc *const disc = put_disc(2.0f, 0.0f, RADIUS);

    look();
    disc->centre.y += 0.30f; /* of 0.15 m and what is walked in a period at the highest speed, 0.2 m */
    look();
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    disc->centre.y += 0.60f;
    look();
    TEST_ASSERT_EQUAL_UINT(2, movers.count);
}

static void test_sightings_saturate(void)
{
    (void)put_disc(2.0f, 0.0f, RADIUS);
    take_scan();
    for (unsigned i = 0; i < 300U; i++) {
        update();
        TEST_ASSERT_EQUAL_UINT(i < UINT8_MAX ? i + 1U : UINT8_MAX, movers.movers[0].sightings);
    }
}

/* ---- Misses ---- */

/* Behind another one, of which it is not known that anybody walks. */
static void test_hidden_thing_is_waited_for(void)
{
    struct disc *const curtain = put_disc(1.0f, 0.0f, 0.0f);

    (void)put_disc(3.0f, 0.0f, RADIUS);
    for (unsigned i = 0; i < SETTLED; i++) {
        look();
    }
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    curtain->radius = 0.4f;
    for (unsigned i = 0; i < MISSES_MAX; i++) {
        look();
    }
    TEST_ASSERT_EQUAL_UINT(2, movers.count);
    TEST_ASSERT_EQUAL_UINT(MISSES_MAX, movers.movers[0].misses);
    TEST_ASSERT_NEAR(PLACE_ERROR, 3.0f, movers.movers[0].centre.x);
    look();
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_NEAR(0.3f, 1.0f, movers.movers[0].centre.x);
}

/* Beams see through the places in which it would be, to the end of their range, or to what is behind. */
static void test_walker_who_is_not_there_walks_on_for_a_while(void)
{
    const struct jp_plane_point velocity = {0.0f, 1.0f};
    const float behind[] = {0.0f, 8.0f};

    for (unsigned k = 0; k < 2U; k++) {
        setUp();

        struct disc *const disc = put_disc(2.0f, -2.0f, RADIUS);

        walk(disc, velocity, SETTLED);
        disc->radius = 0.0f; /* not seen */
        if (behind[k] > 0.0f) {
            (void)put_disc(14.0f, 0.0f, behind[k]);
        }
        for (unsigned i = 1; i <= WALKER_MISSES_MAX / GONE; i++) {
            walk(disc, velocity, 1);
            TEST_ASSERT_EQUAL_UINT(1, movers.count);
            TEST_ASSERT_EQUAL_UINT(i * GONE, movers.movers[0].misses);
        }
        TEST_ASSERT_NEAR(0.2f, disc->centre.y - PERIOD * velocity.y, movers.movers[0].centre.y);
        look();
        TEST_ASSERT_EQUAL_UINT(0, movers.count);
    }
}

/* Out of the field of the scan it is not seen through. */
static void test_walker_beside_the_field_is_kept_longer(void)
{
    const struct jp_plane_point velocity = {0.0f, 1.0f};
    struct disc *const disc = put_disc(2.0f, -2.0f, RADIUS);

    walk(disc, velocity, SETTLED);
    scan.first_angle = 0.5f * JP_PLANE_PI;
    scan.count = BEAMS / 4;
    for (unsigned i = 0; i < WALKER_MISSES_MAX; i++) {
        look();
        TEST_ASSERT_EQUAL_UINT(1, movers.count);
        TEST_ASSERT_EQUAL_UINT(i + 1U, movers.movers[0].misses);
    }
    look();
    TEST_ASSERT_EQUAL_UINT(0, movers.count);
}

static void test_walker_is_found_again(void)
{
    const struct jp_plane_point velocity = {0.0f, 1.0f};
    struct disc *const disc = put_disc(2.0f, -2.0f, RADIUS);

    walk(disc, velocity, SETTLED);
    disc->radius = 0.0f;
    walk(disc, velocity, 4);
    disc->radius = RADIUS;
    look();
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_EQUAL_UINT(0, movers.movers[0].misses);
    TEST_ASSERT_NEAR(2.0f * SPEED_ERROR, velocity.y, movers.movers[0].velocity.y);
}

/* The one that stays moves up in the list. */
static void test_thing_that_is_gone_is_forgotten(void)
{
    struct disc *const gone = put_disc(2.0f, -2.0f, RADIUS);

    (void)put_disc(2.0f, 2.0f, RADIUS);
    look();
    TEST_ASSERT_EQUAL_UINT(2, movers.count);
    gone->radius = 0.0f;
    look();
    TEST_ASSERT_EQUAL_UINT(2, movers.count);
    look();
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_NEAR(PLACE_ERROR, 2.0f, movers.movers[0].centre.y);
    TEST_ASSERT_EQUAL_UINT(3, movers.movers[0].sightings);
}

/* ---- More things than tracks ---- */

static void put_ring(unsigned first, unsigned count, float distance)
{
    for (unsigned i = first; i < first + count; i++) {
        const struct jp_plane_point direction = jp_plane_direction(-3.0f + 6.0f * (float)i / (float)DISCS_MAX);

        (void)put_disc(distance * direction.x, distance * direction.y, 0.2f);
    }
}

static void test_tracks_are_bounded_and_free_again(void)
{
    put_ring(0, JP_MOVERS_MAX, 5.0f);
    put_ring(JP_MOVERS_MAX, 2, 6.0f);
    look();
    TEST_ASSERT_EQUAL_UINT(JP_MOVERS_MAX, movers.count);
    look();
    TEST_ASSERT_EQUAL_UINT(JP_MOVERS_MAX, movers.count);
    for (unsigned i = 0; i < JP_MOVERS_MAX; i++) {
        TEST_ASSERT_EQUAL_UINT(2, movers.movers[i].sightings);
        TEST_ASSERT_EQUAL_UINT(0, movers.movers[i].misses);
    }
    /* Two leave; when they are forgotten the two that were left out are seen. */
    discs[0].radius = 0.0f;
    discs[1].radius = 0.0f;
    for (unsigned i = 0; i < MISSES_MAX + 2U; i++) {
        look();
    }
    TEST_ASSERT_EQUAL_UINT(JP_MOVERS_MAX, movers.count);
    TEST_ASSERT_NEAR(PLACE_ERROR, discs[JP_MOVERS_MAX + 1U].centre.x, movers.movers[JP_MOVERS_MAX - 1U].centre.x);
    TEST_ASSERT_NEAR(PLACE_ERROR, discs[JP_MOVERS_MAX + 1U].centre.y, movers.movers[JP_MOVERS_MAX - 1U].centre.y);
}

/* All but those who have walked give way to what is nearer. */
static void test_near_things_take_the_place_of_far_ones(void)
{
    put_ring(0, JP_MOVERS_MAX, 5.0f);
    discs[JP_MOVERS_MAX - 1U].centre.x *= 1.2f;
    discs[JP_MOVERS_MAX - 1U].centre.y *= 1.2f;
    look();
    TEST_ASSERT_EQUAL_UINT(JP_MOVERS_MAX, movers.count);
    put_ring(JP_MOVERS_MAX + 1U, 1, 3.0f);
    look();
    TEST_ASSERT_EQUAL_UINT(JP_MOVERS_MAX, movers.count);
    TEST_ASSERT_EQUAL_UINT(1, movers.movers[JP_MOVERS_MAX - 1U].sightings);
    TEST_ASSERT_NEAR(PLACE_ERROR, discs[JP_MOVERS_MAX].centre.x, movers.movers[JP_MOVERS_MAX - 1U].centre.x);

    for (unsigned i = 0; i < JP_MOVERS_MAX; i++) {
        movers.movers[i].pace = 1.0f;
    }
    put_ring(JP_MOVERS_MAX, 1, 2.0f);
    look();
    TEST_ASSERT_NEAR(PLACE_ERROR, discs[JP_MOVERS_MAX].centre.x, movers.movers[JP_MOVERS_MAX - 1U].centre.x);
}

/* ---- Shapes ---- */

static void test_shapes_of_a_walker_get_its_velocity(void)
{
    const struct jp_plane_point velocity = {0.5f, 1.0f};
    struct disc *const walker = put_disc(1.0f, -1.5f, RADIUS);

    (void)put_disc(-2.0f, 0.0f, RADIUS);
    walk(walker, velocity, SETTLED);
    see_shapes();
    TEST_ASSERT_TRUE(obstacles.count >= 2);
    for (unsigned i = 0; i < obstacles.count; i++) {
        const struct jp_obstacle *const shape = &obstacles.shapes[i];

        if (shape->vertices[0].x > 0.0f) {
            TEST_ASSERT_NEAR(SPEED_ERROR, velocity.x, shape->velocity.x);
            TEST_ASSERT_NEAR(SPEED_ERROR, velocity.y, shape->velocity.y);
            TEST_ASSERT_TRUE(shape->margin == config.margin);
        } else {
            TEST_ASSERT_FALSE(is_marked(shape));
        }
    }
}

static void test_velocity_is_believed_after_some_sightings(void)
{
    struct disc *const walker = put_disc(2.0f, -1.0f, 0.1f);

    for (unsigned i = 1; i <= SIGHTINGS_MIN; i++) {
        walk(walker, (struct jp_plane_point){0.0f, 1.5f}, 1);
        TEST_ASSERT_TRUE(movers.movers[0].velocity.y > config.speed_min || i < 3U);
        see_shapes();
        TEST_ASSERT_EQUAL_UINT(i < SIGHTINGS_MIN ? 0 : obstacles.count, marked());
    }
    TEST_ASSERT_TRUE(obstacles.count > 0);
}

static void test_slow_things_stand(void)
{
    struct disc *const walker = put_disc(2.0f, -0.5f, RADIUS);

    walk(walker, (struct jp_plane_point){0.0f, 0.15f}, SETTLED);
    see_shapes();
    TEST_ASSERT_EQUAL_UINT(0, marked());
    TEST_ASSERT_FALSE(has_walked(0));
    walk(walker, (struct jp_plane_point){0.0f, 1.0f}, SETTLED);
    see_shapes();
    TEST_ASSERT_EQUAL_UINT(obstacles.count, marked());
    config.speed_min = 1.5f;
    see_shapes();
    TEST_ASSERT_EQUAL_UINT(0, marked());
}

/* Driving past it at 1 m/s, 1.2 m beside it, and turning: what is seen of it changes all the time. */
static void test_standing_pillar_seen_on_the_way_is_not_marked(void)
{
    (void)put_disc(0.0f, 1.2f, 0.3f);
    sensor = (struct jp_plane_pose){-3.0f, 0.0f, 0.0f};
    for (unsigned i = 0; i < 60U; i++) {
        look();
        TEST_ASSERT_EQUAL_UINT(1, movers.count);
        TEST_ASSERT_EQUAL_UINT(i + 1U, movers.movers[0].sightings);
        see_shapes();
        TEST_ASSERT_TRUE(obstacles.count > 0);
        TEST_ASSERT_EQUAL_UINT(0, marked());
        sensor.x += PERIOD;
        sensor.heading += 0.5f * PERIOD;
    }
}

/* A walker at a place, to be put beside shapes that no scan made. */
static void put_walker(void)
{
    movers.movers[0] = (struct jp_mover){.centre = {2.0f, 1.0f},
                                         .velocity = {0.0f, 1.0f},
                                         .radius = 0.2f,
                                         .speed_variance = 0.01f,
                                         .walk = {0.0f, 1.0f},
                                         .pace = 1.0f,
                                         .sightings = SIGHTINGS_MIN};
    movers.count = 1;
}

static bool is_marked_between(struct jp_plane_point a, struct jp_plane_point b, uint8_t vertices)
{
    const struct jp_obstacle shape = {.vertices = {a, b}, .vertex_count = vertices, .radius = 0.01f};

    jp_obstacles_clear(&obstacles, &a);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add(&obstacles, &shape));
    jp_movers_mark(&movers, &config, &obstacles);
    return is_marked(&obstacles.shapes[0]);
}

static void test_shapes_beside_a_walker_stand(void)
{
    const struct jp_plane_point within = {2.3f, 1.0f};
    const struct jp_plane_point beyond = {2.4f, 1.0f};

    put_walker();
    TEST_ASSERT_TRUE(is_marked_between(within, within, 1));
    TEST_ASSERT_FALSE(is_marked_between(beyond, beyond, 1));
    TEST_ASSERT_TRUE(is_marked_between((struct jp_plane_point){2.3f, 0.8f}, (struct jp_plane_point){2.3f, 1.2f}, 2));
    TEST_ASSERT_FALSE(is_marked_between((struct jp_plane_point){2.4f, 0.8f}, (struct jp_plane_point){2.4f, 1.2f}, 2));
}

static void test_wall_that_a_walker_passes_stands(void)
{
    put_walker();
    TEST_ASSERT_TRUE(is_marked_between((struct jp_plane_point){2.1f, 0.7f}, (struct jp_plane_point){2.1f, 1.3f}, 2));
    TEST_ASSERT_FALSE(is_marked_between((struct jp_plane_point){2.1f, 0.6f}, (struct jp_plane_point){2.1f, 1.4f}, 2));
    TEST_ASSERT_FALSE(is_marked_between((struct jp_plane_point){2.1f, -3.0f}, (struct jp_plane_point){2.1f, 5.0f}, 2));
}

/* ---- What is refused ---- */

/* With a track that any update would change. */
static void expect(enum jp_status status, float period)
{
    put_walker();
    movers.movers[0].misses = WALKER_MISSES_MAX;
    TEST_ASSERT_EQUAL_INT(status, jp_movers_update(&movers, &config, &scan_config, &scan, &sensor, period));
    TEST_ASSERT_EQUAL_UINT(status == JP_OK ? 0 : 1, movers.count);
    TEST_ASSERT_EQUAL_UINT(SIGHTINGS_MIN, movers.movers[0].sightings);
    if (status != JP_OK) {
        TEST_ASSERT_EQUAL_UINT(WALKER_MISSES_MAX, movers.movers[0].misses);
        TEST_ASSERT_TRUE(movers.movers[0].centre.y == 1.0f);
    }
}

static void test_null_pointers_are_refused(void)
{
    take_scan();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_movers_update(NULL, &config, &scan_config, &scan, &sensor, PERIOD));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_movers_update(&movers, NULL, &scan_config, &scan, &sensor, PERIOD));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_movers_update(&movers, &config, NULL, &scan, &sensor, PERIOD));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_movers_update(&movers, &config, &scan_config, NULL, &sensor, PERIOD));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_movers_update(&movers, &config, &scan_config, &scan, NULL, PERIOD));
}

static void test_bad_configurations_are_refused(void)
{
    volatile float large = FLT_MAX; /* the compiler must not see that it overflows */
    const float infinity = large * 2.0f;
    const float not_a_number = infinity - infinity;
    const struct jp_movers_config bad[] = {
        {0.0f, 9.0f, 0.3f, 2.0f, 0.3f},         {not_a_number, 9.0f, 0.3f, 2.0f, 0.3f},
        {0.9f, 0.0f, 0.3f, 2.0f, 0.3f},         {0.9f, not_a_number, 0.3f, 2.0f, 0.3f},
        {0.9f, 1000.1f, 0.3f, 2.0f, 0.3f},      {0.9f, 9.0f, 0.0f, 2.0f, 0.3f},
        {0.9f, 9.0f, not_a_number, 2.0f, 0.3f}, {0.9f, 9.0f, 0.3f, 0.29f, 0.3f},
        {0.9f, 9.0f, 0.3f, not_a_number, 0.3f}, {0.9f, 9.0f, 0.3f, infinity, 0.3f},
        {0.9f, 9.0f, 0.3f, 2.0f, -0.1f},        {0.9f, 9.0f, 0.3f, 2.0f, not_a_number},
        {0.9f, 9.0f, 0.3f, 2.0f, infinity},     {0.9f, 9.0f, 0.3f, 1000.1f, 0.3f},
        {0.9f, 9.0f, 0.3f, 2.0f, 1000.1f},
    };

    take_scan();
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        config = bad[i];
        expect(JP_ERR_ARGUMENT, PERIOD);
    }
    config =
        (struct jp_movers_config){.extent = 0.9f, .range = 9.0f, .speed_min = 0.3f, .speed_max = 0.3f, .margin = 0.0f};
    expect(JP_OK, PERIOD);
}

static void test_bad_periods_are_refused(void)
{
    take_scan();
    expect(JP_ERR_ARGUMENT, 0.0f);
    expect(JP_ERR_ARGUMENT, -PERIOD);
    expect(JP_ERR_ARGUMENT, 0.0009f);
    expect(JP_ERR_ARGUMENT, 10.1f);
    expect(JP_OK, 0.001f);
    expect(JP_OK, 10.0f);
}

static void test_after_a_long_period_nobody_is_known(void)
{
    (void)put_disc(2.0f, 0.0f, RADIUS);
    look();
    take_scan();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_movers_update(&movers, &config, &scan_config, &scan, &sensor, 0.5f));
    TEST_ASSERT_EQUAL_UINT(2, movers.movers[0].sightings);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_movers_update(&movers, &config, &scan_config, &scan, &sensor, 0.51f));
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_EQUAL_UINT(1, movers.movers[0].sightings);
}

static void test_scan_of_dropouts_is_not_trusted(void)
{
    for (unsigned i = 0; i < BEAMS; i++) {
        ranges[i] = -1.0f;
    }
    expect(JP_ERR_UNRELIABLE, PERIOD);
    scan.count = 1;
    expect(JP_ERR_ARGUMENT, PERIOD);
}
