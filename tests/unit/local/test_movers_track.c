/* Discs that a synthetic scanner sees: how well they are tracked, and which of them while they are not seen. */
#include "tests/support/movers_rig.h"

void setUp(void)
{
    movers_rig_start();
}

void tearDown(void)
{
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
