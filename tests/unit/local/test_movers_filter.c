/* One step of the tracks' filter at a time: against matrices in double, and against what the headers say of rims,
 * radii, places and misses. */
#include "src/local/movers_track.h"

#include "tests/support/movers_rig.h"

#define ACCELERATION 2.0 /* m/s² */
#define WHOLE_ERROR  0.025
#define HIDDEN_ERROR 0.08
#define SHARED       0.05f
#define FAST         10.0f

static struct jp_mover_thing thing;
static struct jp_mover mover;

static struct jp_mover_thing thing_at(float x, float y, float radius)
{
    return (struct jp_mover_thing){.centre = {x, y}, .radius = radius, .across = {0.6f, 0.8f}, .is_free = {true, true}};
}

void setUp(void)
{
    movers_rig_start();
    thing = thing_at(2.0f, 1.0f, 0.2f);
    mover = (struct jp_mover){.centre = {1.95f, 1.1f},
                              .velocity = {0.5f, -0.4f},
                              .radius = 0.2f,
                              .own = 0.2f,
                              .largest = 0.2f,
                              .origin = {1.0f, 0.0f},
                              .place_variance = 0.01f,
                              .covariance = 0.02f,
                              .speed_variance = 0.3f,
                              .sightings = 3,
                              .misses = 2,
                              .alone = 7};
}

void tearDown(void)
{
}

/* ---- In double ---- */

/* Of place and velocity along an axis. */
struct covariance {
    double p[2][2];
};

static struct covariance covariance_of(const struct jp_mover *of)
{
    return (struct covariance){
        {{(double)of->place_variance, (double)of->covariance}, {(double)of->covariance, (double)of->speed_variance}}};
}

static void expect_covariance(const struct covariance *exact, const struct jp_mover *of)
{
    TEST_ASSERT_NEAR(2.0e-6f, (float)exact->p[0][0], of->place_variance);
    TEST_ASSERT_NEAR(2.0e-6f, (float)exact->p[0][1], of->covariance);
    TEST_ASSERT_NEAR(2.0e-6f, (float)exact->p[1][1], of->speed_variance);
}

/* F P Fᵀ + G Gᵀ of a random acceleration, constant in the period. */
static struct covariance foreseen(const struct covariance *before, double period)
{
    const double f[2][2] = {{1.0, period}, {0.0, 1.0}};
    const double g[2] = {0.5 * ACCELERATION * period * period, ACCELERATION * period};
    struct covariance after;

    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) {
            after.p[i][j] = g[i] * g[j];
            for (int k = 0; k < 4; k++) {
                after.p[i][j] += f[i][k / 2] * before->p[k / 2][k % 2] * f[j][k % 2];
            }
        }
    }
    return after;
}

/* ---- Prediction ---- */

static void test_a_prediction_is_that_of_matrices(void)
{
    static const float periods[] = {0.05f, 0.1f, 0.4f};

    for (unsigned i = 0; i < 3U; i++) {
        const struct covariance before = covariance_of(&mover);
        const struct covariance after = foreseen(&before, (double)periods[i]);

        movers.count = 2;
        movers.movers[0] = mover;
        movers.movers[1] = mover;
        movers.movers[2] = mover;
        jp_movers_predict(&movers, periods[i]);
        for (unsigned k = 0; k < 2U; k++) {
            const struct jp_mover *const found = &movers.movers[k];

            expect_covariance(&after, found);
            TEST_ASSERT_NEAR(2.0e-6f, 1.95f + 0.5f * periods[i], found->centre.x);
            TEST_ASSERT_NEAR(2.0e-6f, 1.1f - 0.4f * periods[i], found->centre.y);
            TEST_ASSERT_NEAR(1.0e-6f, periods[i], found->standing);
            TEST_ASSERT_EQUAL_UINT8(3, found->misses);
        }
        TEST_ASSERT_EQUAL_UINT8(2, movers.movers[2].misses);
    }
}

/* ---- Correction ---- */

/* By a place of a standard deviation. */
static void expect_update(struct jp_plane_point measured, double error)
{
    const struct covariance p = covariance_of(&mover);
    const double sum = p.p[0][0] + error * error;
    const double gain[2] = {p.p[0][0] / sum, p.p[1][0] / sum};
    const struct jp_mover before = mover;
    const float x = measured.x - before.centre.x;
    const float y = measured.y - before.centre.y;
    struct covariance after;

    for (int i = 0; i < 4; i++) {
        after.p[i / 2][i % 2] = p.p[i / 2][i % 2] - gain[i / 2] * p.p[0][i % 2];
    }
    jp_mover_correct(&mover, &thing, FAST);
    TEST_ASSERT_NEAR(3.0e-6f, before.centre.x + (float)gain[0] * x, mover.centre.x);
    TEST_ASSERT_NEAR(3.0e-6f, before.centre.y + (float)gain[0] * y, mover.centre.y);
    TEST_ASSERT_NEAR(5.0e-6f, before.velocity.x + (float)gain[1] * x, mover.velocity.x);
    TEST_ASSERT_NEAR(5.0e-6f, before.velocity.y + (float)gain[1] * y, mover.velocity.y);
    expect_covariance(&after, &mover);
    TEST_ASSERT_EQUAL_UINT8(before.sightings + 1, mover.sightings);
    TEST_ASSERT_EQUAL_UINT8(0, mover.misses);
    TEST_ASSERT_NEAR(1.0e-6f, before.origin.x, mover.origin.x);
    TEST_ASSERT_NEAR(1.0e-6f, before.origin.y, mover.origin.y);
}

static struct jp_plane_point along_thing(float along)
{
    return (struct jp_plane_point){thing.centre.x + along * 0.6f, thing.centre.y + along * 0.8f};
}

static void test_a_whole_thing_is_where_its_middle_is(void)
{
    expect_update(thing.centre, WHOLE_ERROR);
    TEST_ASSERT_NEAR(1.0e-6f, 0.2f, mover.own);
    TEST_ASSERT_EQUAL_UINT8(8, mover.alone);
}

/* Of a hidden one the middle is its radius from the free rim, less exactly. */
static void test_a_thing_with_one_free_rim_is_its_radius_from_there(void)
{
    for (int side = 0; side < 2; side++) {
        const float away = side == 0 ? 1.0f : -1.0f;

        setUp();
        thing.is_free[1 - side] = false;
        thing.radius = 0.14f;
        expect_update(along_thing(away * 0.06f), HIDDEN_ERROR);
        setUp();
        thing.is_free[1 - side] = false;
        thing.radius = 0.23f;
        expect_update(along_thing(away * -0.03f), HIDDEN_ERROR);
    }
}

/* So much is taken off the way to where it is. */
static struct jp_plane_point less(struct jp_plane_point place, float slack)
{
    const float x = place.x - mover.centre.x;
    const float y = place.y - mover.centre.y;
    const float length = jp_plane_length(x, y);
    const float share = length > slack ? 1.0f - slack / length : 0.0f;

    return (struct jp_plane_point){mover.centre.x + share * x, mover.centre.y + share * y};
}

/* Of somebody among others no more is known than that it is among them. */
static void test_one_among_others_is_anywhere_among_them(void)
{
    static const float foreseen_along[] = {-0.5f, -0.31f, -0.1f, 0.0f, 0.2f, 0.29f, 0.6f};

    for (unsigned i = 0; i < 7U * 3U; i++) {
        const float along = foreseen_along[i % 7U];

        setUp();
        thing.radius = 0.5f;
        thing.is_free[0] = i / 7U != 1U;
        thing.is_free[1] = i / 7U != 2U;
        mover.centre = along_thing(along);
        mover.centre.x += 0.08f;
        mover.centre.y -= 0.06f;
        expect_update(less(along_thing(jp_plane_clamp(along, -0.3f, 0.3f)), SHARED),
                      i / 7U == 0U ? WHOLE_ERROR : HIDDEN_ERROR);
        TEST_ASSERT_EQUAL_UINT8(0, mover.alone);
    }
}

/* What is as near as the slack is not moved. */
static void test_one_that_is_foreseen_among_them_stays(void)
{
    thing.radius = 0.5f;
    mover.centre = (struct jp_plane_point){2.03f, 1.02f};
    expect_update(mover.centre, WHOLE_ERROR);
}

/* A thing that is whole and a little smaller: between its middle and where the other rims are. */
static void test_a_whole_thing_that_is_smaller_may_be_either_end_of_it(void)
{
    mover.own = 0.28f;
    mover.centre = along_thing(0.3f);
    expect_update(less(along_thing(0.08f), SHARED), WHOLE_ERROR);
    setUp();
    mover.own = 0.24f;
    mover.centre = along_thing(0.3f);
    expect_update(thing.centre, WHOLE_ERROR);
}

static void test_no_velocity_is_beyond_the_greatest(void)
{
    mover.centre.x -= 1.0f;
    mover.centre.y -= 2.0f;

    struct jp_mover free_one = mover;

    jp_mover_correct(&free_one, &thing, FAST);
    jp_mover_correct(&mover, &thing, 1.5f);
    TEST_ASSERT_NEAR(1.0e-5f, 1.5f, jp_plane_length(mover.velocity.x, mover.velocity.y));
    TEST_ASSERT_NEAR(1.0e-4f, free_one.velocity.x * mover.velocity.y, free_one.velocity.y * mover.velocity.x);
    TEST_ASSERT_TRUE(mover.velocity.x > 0.0f);
}

/* Who parts from others is what is seen now, and its origin shifts as its middle does. */
static void test_one_that_parts_keeps_most_of_its_velocity(void)
{
    const struct covariance before = covariance_of(&mover);

    mover.own = 0.31f;
    jp_mover_correct(&mover, &thing, FAST);
    TEST_ASSERT_NEAR(1.0e-6f, 2.0f, mover.centre.x);
    TEST_ASSERT_NEAR(1.0e-6f, 1.0f, mover.centre.y);
    TEST_ASSERT_NEAR(1.0e-6f, 1.05f, mover.origin.x);
    TEST_ASSERT_NEAR(1.0e-6f, -0.1f, mover.origin.y);
    TEST_ASSERT_NEAR(1.0e-6f, 0.8f * 0.5f, mover.velocity.x);
    TEST_ASSERT_NEAR(1.0e-6f, 0.8f * -0.4f, mover.velocity.y);
    TEST_ASSERT_NEAR(1.0e-6f, 0.2f, mover.own);
    TEST_ASSERT_NEAR(1.0e-6f, 0.2f, mover.radius);
    TEST_ASSERT_EQUAL_UINT8(0, mover.misses);
    TEST_ASSERT_EQUAL_UINT8(3, mover.sightings);
    expect_covariance(&before, &mover);
}

/* ---- Radii ---- */

static void test_the_radius_alone_follows_what_is_seen(void)
{
    thing.radius = 0.24f;
    jp_mover_correct(&mover, &thing, FAST);
    TEST_ASSERT_NEAR(1.0e-6f, 0.2f + 0.3f * 0.04f, mover.own);
    TEST_ASSERT_NEAR(1.0e-6f, 0.24f, mover.radius);
    TEST_ASSERT_NEAR(1.0e-6f, 0.24f, mover.largest);
    thing.radius = 0.15f;
    jp_mover_correct(&mover, &thing, FAST);
    TEST_ASSERT_NEAR(1.0e-6f, 0.212f - 0.3f * 0.062f, mover.own);
    TEST_ASSERT_NEAR(1.0e-6f, 0.15f, mover.radius);
    TEST_ASSERT_NEAR(1.0e-6f, 0.24f, mover.largest);
    TEST_ASSERT_EQUAL_UINT8(9, mover.alone);
}

/* Of who is seen with others hardly, of a companion not at all. */
static void test_the_radius_alone_hardly_follows_that_of_several(void)
{
    struct jp_mover companion = mover;

    thing.radius = 0.6f;
    companion.is_companion = true;
    jp_mover_correct(&mover, &thing, FAST);
    jp_mover_correct(&companion, &thing, FAST);
    TEST_ASSERT_NEAR(1.0e-6f, 0.2f + 0.05f * 0.4f, mover.own);
    TEST_ASSERT_NEAR(1.0e-6f, 0.2f, companion.own);
    TEST_ASSERT_EQUAL_UINT8(0, mover.alone);
    TEST_ASSERT_NEAR(1.0e-6f, 0.6f, companion.radius);
}

/* Of what is partly hidden the largest part lately. */
static void test_the_radius_of_what_is_hidden_falls_slowly(void)
{
    thing.is_free[0] = false;
    mover.radius = 0.4f;
    thing.radius = 0.1f;
    jp_mover_correct(&mover, &thing, FAST);
    TEST_ASSERT_NEAR(1.0e-6f, 0.4f - 0.3f * 0.2f, mover.radius);
    TEST_ASSERT_NEAR(1.0e-6f, 0.34f, mover.largest);
    TEST_ASSERT_NEAR(1.0e-6f, 0.2f, mover.own);
    thing.radius = 0.5f;
    jp_mover_correct(&mover, &thing, FAST);
    TEST_ASSERT_NEAR(1.0e-6f, 0.5f, mover.radius);
    TEST_ASSERT_NEAR(1.0e-6f, 0.2f, mover.own);
}

static void test_counts_saturate(void)
{
    mover.alone = 255;
    mover.sightings = 255;
    jp_mover_correct(&mover, &thing, FAST);
    TEST_ASSERT_EQUAL_UINT8(255, mover.alone);
    TEST_ASSERT_EQUAL_UINT8(255, mover.sightings);
}

/* ---- Which track it is ---- */

static void put(float x, float y, uint8_t misses)
{
    movers.movers[movers.count] = mover;
    movers.movers[movers.count].centre = (struct jp_plane_point){x, y};
    movers.movers[movers.count].misses = misses;
    movers.count++;
}

static void expect_match(int index, float gate)
{
    const struct jp_mover *const found = jp_movers_match(&movers, &thing, gate);

    TEST_ASSERT_TRUE(found == (index < 0 ? NULL : &movers.movers[index]));
}

static void test_the_nearest_track_without_an_object_is_taken(void)
{
    expect_match(-1, 1.0f);
    put(2.9f, 1.0f, 1);
    expect_match(0, 1.0f);
    expect_match(-1, 0.89f);
    put(2.0f, 1.5f, 1);
    expect_match(1, 1.0f);
    put(2.0f, 0.9f, 0);
    expect_match(1, 1.0f);
    put(1.6f, 1.0f, 1);
    expect_match(3, 1.0f);
    put(20.0f, 1.0f, 1);
    expect_match(3, 1.0f);
}

/* Who was not seen last time is as if it were farther, but within the gate nevertheless. */
static void test_a_track_that_was_hidden_comes_second(void)
{
    put(2.0f, 1.3f, 2);
    expect_match(0, 0.31f);
    put(2.35f, 1.0f, 1);
    expect_match(1, 1.0f);
    movers.movers[1].centre.x = 2.37f;
    expect_match(0, 1.0f);
}

/* ---- New tracks ---- */

static const struct jp_plane_point from = {0.5f, -0.5f};

static void test_a_new_track_is_what_is_seen(void)
{
    for (int i = 0; i < JP_MOVER_POINTS; i++) {
        thing.seen[i] = (struct jp_plane_point){(float)i, 2.0f * (float)i};
    }
    thing.has_come = true;
    jp_movers_begin(&movers, &thing, from);
    TEST_ASSERT_EQUAL_UINT8(1, movers.count);

    const struct jp_mover *const found = &movers.movers[0];

    TEST_ASSERT_NEAR(1.0e-6f, 2.0f, found->centre.x);
    TEST_ASSERT_NEAR(1.0e-6f, 1.0f, found->centre.y);
    TEST_ASSERT_NEAR(1.0e-6f, 2.0f, found->origin.x);
    TEST_ASSERT_NEAR(1.0e-6f, 1.0f, found->stood.y);
    TEST_ASSERT_NEAR(1.0e-6f, 2.0f, found->stood.x);
    TEST_ASSERT_NEAR(1.0e-6f, 0.5f, found->seen_from.x);
    TEST_ASSERT_NEAR(1.0e-6f, 4.0f, found->seen[2].y);
    TEST_ASSERT_NEAR(1.0e-6f, 0.2f, found->radius);
    TEST_ASSERT_NEAR(1.0e-6f, 0.2f, found->own);
    TEST_ASSERT_NEAR(1.0e-6f, 0.2f, found->largest);
    TEST_ASSERT_NEAR(1.0e-6f, (float)(WHOLE_ERROR * WHOLE_ERROR), found->place_variance);
    TEST_ASSERT_NEAR(1.0e-6f, 0.0f, found->covariance);
    TEST_ASSERT_NEAR(1.0e-6f, 1.0f, found->speed_variance);
    TEST_ASSERT_NEAR(1.0e-6f, 0.0f, found->velocity.x);
    TEST_ASSERT_NEAR(1.0e-6f, 0.0f, found->standing);
    TEST_ASSERT_NEAR(1.0e-6f, 0.0f, found->pace);
    TEST_ASSERT_EQUAL_UINT8(1, found->sightings);
    TEST_ASSERT_EQUAL_UINT8(1, found->alone);
    TEST_ASSERT_EQUAL_UINT8(0, found->misses);
    TEST_ASSERT_TRUE(found->has_come && !found->is_companion);
}

/* Of a part of somebody the rest is behind what hides it. */
static void test_a_new_track_of_a_part_is_as_large_as_a_person(void)
{
    thing.radius = 0.1f;
    thing.is_free[1] = false;
    jp_movers_begin(&movers, &thing, from);
    TEST_ASSERT_NEAR(1.0e-6f, 0.2f, movers.movers[0].own);
    TEST_ASSERT_NEAR(1.0e-6f, 0.1f, movers.movers[0].radius);
    TEST_ASSERT_NEAR(1.0e-5f, along_thing(0.1f).x, movers.movers[0].centre.x);
    TEST_ASSERT_NEAR(1.0e-5f, along_thing(0.1f).y, movers.movers[0].centre.y);
    thing.radius = 0.3f;
    jp_movers_begin(&movers, &thing, from);
    TEST_ASSERT_NEAR(1.0e-6f, 0.3f, movers.movers[1].own);
}

/* Who appears beside somebody who walks goes with them, until it is known better. */
static void test_a_new_track_beside_a_walker_walks_as_it_does(void)
{
    mover.pace = 1.2f;
    mover.walk = (struct jp_plane_point){1.0f, 0.0f};
    mover.standing = 3.0f;
    put(2.0f, 1.85f, 4);
    jp_movers_begin(&movers, &thing, from);
    TEST_ASSERT_EQUAL_UINT8(0, movers.movers[1].misses);
    TEST_ASSERT_NEAR(1.0e-6f, 0.0f, movers.movers[1].standing);
    TEST_ASSERT_TRUE(movers.movers[1].is_companion);
    TEST_ASSERT_NEAR(1.0e-6f, 1.2f, movers.movers[1].pace);
    TEST_ASSERT_NEAR(1.0e-6f, 0.5f, movers.movers[1].velocity.x);
    TEST_ASSERT_NEAR(1.0e-6f, 0.3f, movers.movers[1].speed_variance);
    TEST_ASSERT_NEAR(1.0e-6f, 0.0f, movers.movers[1].covariance);
    TEST_ASSERT_NEAR(1.0e-6f, 1.0f, movers.movers[1].centre.y);
    movers.movers[0].centre.y = 1.95f;
    movers.count = 1;
    jp_movers_begin(&movers, &thing, from);
    TEST_ASSERT_FALSE(movers.movers[1].is_companion);
    TEST_ASSERT_NEAR(1.0e-6f, 0.0f, movers.movers[1].pace);
}

/* The farthest thing that never walked gives its place to a nearer one. */
static void test_where_there_is_no_place_the_farthest_thing_goes(void)
{
    for (int i = 0; i < JP_MOVERS_MAX; i++) {
        put(10.0f + (float)(i * 7 % JP_MOVERS_MAX), 20.0f, 1);
    }

    unsigned farthest = 0;

    for (unsigned i = 1; i < JP_MOVERS_MAX; i++) {
        farthest = movers.movers[i].centre.x > movers.movers[farthest].centre.x ? i : farthest;
    }
    for (unsigned i = 0; i < JP_MOVERS_MAX; i++) {
        movers.movers[i].pace = movers.movers[i].centre.x > 30.0f && i != farthest ? 1.0f : 0.0f;
    }
    movers.movers[farthest].pace = 1.0f;
    jp_movers_begin(&movers, &thing, from);
    TEST_ASSERT_EQUAL_UINT8(JP_MOVERS_MAX, movers.count);
    for (unsigned i = 0; i < JP_MOVERS_MAX; i++) {
        const bool is_new = movers.movers[i].sightings == 1U;
        const bool was_thirtieth = 10 + (int)(i * 7U % JP_MOVERS_MAX) == 30;

        TEST_ASSERT_EQUAL_INT(was_thirtieth, is_new);
    }
    thing.centre = (struct jp_plane_point){-40.0f, 20.0f};
    jp_movers_begin(&movers, &thing, from);
    for (unsigned i = 0; i < JP_MOVERS_MAX; i++) {
        TEST_ASSERT_TRUE(movers.movers[i].centre.x > 0.0f);
    }
}

/* ---- Misses ---- */

/* A beam that sees past a place says more than one that is stopped before it. */
static void test_one_whose_place_is_seen_through_is_missed_more(void)
{
    struct jp_scan_view view;

    put_wall(-1.0f, 5.0f, 9.0f, 5.0f);
    put_wall(-1.0f, -3.0f, 9.0f, -3.0f);
    take_scan();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_open(&view, &scan_config, &scan, &sensor));
    put(2.0f, 4.0f, 1);
    put(2.0f, 4.0f, 0);
    put(2.0f, 5.5f, 1);
    put(2.0f, 4.9f, 1);
    put(2.0f, -2.0f, 2);
    put(2.0f, -2.9f, 2);
    jp_movers_miss(&movers, &view);
    TEST_ASSERT_EQUAL_UINT8(1 + GONE - 1U, movers.movers[0].misses);
    TEST_ASSERT_EQUAL_UINT8(0, movers.movers[1].misses);
    TEST_ASSERT_EQUAL_UINT8(1, movers.movers[2].misses);
    TEST_ASSERT_EQUAL_UINT8(1, movers.movers[3].misses);
    TEST_ASSERT_EQUAL_UINT8(2 + GONE - 1U, movers.movers[4].misses);
    TEST_ASSERT_EQUAL_UINT8(2, movers.movers[5].misses);
}

/* The scan is taken from elsewhere. */
static void test_what_is_seen_through_is_so_from_where_the_sensor_is(void)
{
    struct jp_scan_view view;

    sensor = (struct jp_plane_pose){3.0f, 2.0f, 0.7f};
    put_wall(-1.0f, 5.0f, 9.0f, 5.0f);
    take_scan();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_open(&view, &scan_config, &scan, &sensor));
    put(3.0f, 4.6f, 1);
    put(3.0f, 4.85f, 1);
    put(1.0f, 4.4f, 1);
    movers.movers[3].misses = 1;
    movers.movers[3].centre = (struct jp_plane_point){3.0f, 3.0f};
    jp_movers_miss(&movers, &view);
    TEST_ASSERT_EQUAL_UINT8(3, movers.movers[0].misses);
    TEST_ASSERT_EQUAL_UINT8(1, movers.movers[1].misses);
    TEST_ASSERT_EQUAL_UINT8(3, movers.movers[2].misses);
    TEST_ASSERT_EQUAL_UINT8(1, movers.movers[3].misses);
}

static void test_walkers_are_remembered_for_longer_than_things(void)
{
    for (uint8_t i = 0; i < 8U; i++) {
        mover.pace = i % 2U == 0U ? 0.0f : 1.0f;
        put((float)i, 0.0f, (uint8_t)(i < 4U ? MISSES_MAX + i / 2U : WALKER_MISSES_MAX + i / 2U - 2U));
    }
    jp_movers_forget(&movers);
    TEST_ASSERT_EQUAL_UINT8(4, movers.count);
    TEST_ASSERT_NEAR(0.0f, 0.0f, movers.movers[0].centre.x);
    TEST_ASSERT_NEAR(0.0f, 1.0f, movers.movers[1].centre.x);
    TEST_ASSERT_NEAR(0.0f, 3.0f, movers.movers[2].centre.x);
    TEST_ASSERT_NEAR(0.0f, 5.0f, movers.movers[3].centre.x);
}
