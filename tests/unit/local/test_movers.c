/* Discs and walls that a synthetic scanner sees: which of them are tracked, how well, and which shapes get their
 * velocity. */
#include <joulepath/movers.h>

#include "src/base/plane.h"

#include "tests/support/near.h"

#define PERIOD 0.1f /* s */
#define RADIUS 0.25f

/* How well a disc within 4 m is tracked. Beams miss its rims, so the middle of what is seen lies in front of its own.
 */
#define PLACE_ERROR 0.12f /* m */
#define SPEED_ERROR 0.25f /* m/s */

enum {
    BEAMS = 720,
    DISCS_MAX = JP_MOVERS_MAX + 2,
    WALLS_MAX = 5,
    SETTLED = 25,
    NOTICED = 5, /* scans in which it is known that somebody walks at 1 m/s */
    SIGHTINGS_MIN = 4,
    MISSES_MAX = 5,
    WALKER_MISSES_MAX = 24
};

/* Misses that one counts as where the beams look through the place. */
#define GONE 3U

struct disc {
    struct jp_plane_point centre;
    float radius;
};

struct wall {
    struct jp_plane_point from;
    struct jp_plane_point to;
};

static const struct jp_plane_pose origin = {0.0f, 0.0f, 0.0f};

static float ranges[BEAMS];
static struct jp_scan scan;
static struct jp_scan_config scan_config;
static struct jp_movers_config config;
static struct jp_movers movers;
static struct jp_obstacles obstacles;
static struct jp_plane_pose sensor;
static struct disc discs[DISCS_MAX];
static unsigned disc_count;
static struct wall walls[WALLS_MAX];
static unsigned wall_count;

/* A whole turn around a sensor on an empty plane; the scan begins and ends behind it. */
void setUp(void)
{
    scan = (struct jp_scan){ranges, BEAMS, -JP_PLANE_PI, 2.0f * JP_PLANE_PI / BEAMS};
    scan_config = (struct jp_scan_config){.range_max = 10.0f, .gap = 0.3f, .tolerance = 0.04f, .beams_min = 3};
    config = (struct jp_movers_config){
        .extent = 0.9f, .range = 10.0f, .speed_min = 0.3f, .speed_max = 2.0f, .margin = 0.35f};
    sensor = origin;
    disc_count = 0;
    wall_count = 0;
    jp_movers_clear(&movers);
}

void tearDown(void)
{
}

/* ---- The scanner ---- */

static struct disc *put_disc(float x, float y, float radius)
{
    discs[disc_count] = (struct disc){{x, y}, radius};
    disc_count++;
    return &discs[disc_count - 1U];
}

static void put_wall(float x1, float y1, float x2, float y2)
{
    walls[wall_count] = (struct wall){{x1, y1}, {x2, y2}};
    wall_count++;
}

static void put_box(float left, float low, float right, float high)
{
    put_wall(left, low, right, low);
    put_wall(right, low, right, high);
    put_wall(right, high, left, high);
    put_wall(left, high, left, low);
}

/* 0: beside it. */
static float range_of_wall(const struct wall *wall, struct jp_plane_point beam)
{
    const struct jp_plane_point from = {wall->from.x - sensor.x, wall->from.y - sensor.y};
    const struct jp_plane_point along = {wall->to.x - wall->from.x, wall->to.y - wall->from.y};
    const float across = beam.x * along.y - beam.y * along.x;
    const float range = (from.x * along.y - from.y * along.x) / across;
    const float share = (from.x * beam.y - from.y * beam.x) / across;

    return range > 0.0f && share >= 0.0f && share <= 1.0f ? range : 0.0f;
}

static float nearer(float range, float other)
{
    return other > 0.0f && !(range > 0.0f && range < other) ? other : range;
}

static float range_of_disc(const struct disc *disc, struct jp_plane_point beam)
{
    const struct jp_plane_point way = {disc->centre.x - sensor.x, disc->centre.y - sensor.y};
    const float along = way.x * beam.x + way.y * beam.y;
    const float across = way.x * beam.y - way.y * beam.x;
    const float square = disc->radius * disc->radius - across * across;

    return along > 0.0f && square > 0.0f ? along - jp_plane_square_root(square) : 0.0f;
}

static void take_scan(void)
{
    for (unsigned i = 0; i < scan.count; i++) {
        const struct jp_plane_point beam =
            jp_plane_direction(sensor.heading + scan.first_angle + (float)i * scan.angle_step);

        ranges[i] = 0.0f;
        for (unsigned k = 0; k < disc_count; k++) {
            ranges[i] = nearer(ranges[i], range_of_disc(&discs[k], beam));
        }
        for (unsigned k = 0; k < wall_count; k++) {
            ranges[i] = nearer(ranges[i], range_of_wall(&walls[k], beam));
        }
    }
}

static void update(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_movers_update(&movers, &config, &scan_config, &scan, &sensor, PERIOD));
}

static void look(void)
{
    take_scan();
    update();
}

/* Scans of a disc that walks. */
static void walk(struct disc *disc, struct jp_plane_point velocity, unsigned scans)
{
    for (unsigned i = 0; i < scans; i++) {
        look();
        disc->centre.x += PERIOD * velocity.x;
        disc->centre.y += PERIOD * velocity.y;
    }
}

static void see_shapes(void)
{
    const struct jp_plane_point here = {sensor.x, sensor.y};

    jp_obstacles_clear(&obstacles, &here);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add_scan(&obstacles, &scan_config, &scan, &sensor));
    jp_movers_mark(&movers, &config, &obstacles);
}

static bool is_marked(const struct jp_obstacle *shape)
{
    return jp_plane_length(shape->velocity.x, shape->velocity.y) > 0.0f || shape->margin > 0.0f;
}

static unsigned marked(void)
{
    unsigned count = 0;

    for (unsigned i = 0; i < obstacles.count; i++) {
        count += is_marked(&obstacles.shapes[i]) ? 1U : 0U;
    }
    return count;
}

/* A beam a degree, as the patrol robot's laser has. */
static void see_coarsely(void)
{
    config.extent = 2.0f;
    scan.count = BEAMS / 2;
    scan.angle_step = 4.0f * JP_PLANE_PI / BEAMS;
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

/* The track whose velocity is nearest to one, of those near a place; null: there is none. */
static const struct jp_mover *track_of(const struct disc *disc, struct jp_plane_point velocity)
{
    const struct jp_mover *nearest = NULL;

    for (unsigned i = 0; i < movers.count; i++) {
        const struct jp_mover *const mover = &movers.movers[i];

        if (jp_plane_square_between(mover->centre, disc->centre) < 0.4f * 0.4f &&
            (nearest == NULL || jp_plane_square_between(mover->velocity, velocity) <
                                    jp_plane_square_between(nearest->velocity, velocity))) {
            nearest = mover;
        }
    }
    return nearest;
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

/* ---- Who has walked ---- */

static bool has_walked(unsigned i)
{
    return movers.movers[i].pace > 0.0f;
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

/* Half hidden, something wide may turn another side to the scanner. */
static void test_who_is_wide_and_half_hidden_has_not_walked(void)
{
    see_coarsely();
    put_wall(2.0f, -0.8f, 2.0f, 0.4f);
    put_wall(1.2f, -0.6f, 1.2f, -0.3f);
    for (unsigned n = 0; n < 14U; n++) {
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

/* Whether a disc that goes past is known to walk when all that was first seen of it lay at one place, and a beam has
 * another range. */
static bool walks_from(struct jp_plane_point place, unsigned beam, float range)
{
    struct disc *const disc = put_disc(2.0f, -1.0f, RADIUS);

    for (unsigned i = 0; i < SETTLED; i++) {
        take_scan();
        ranges[beam] = range;
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
