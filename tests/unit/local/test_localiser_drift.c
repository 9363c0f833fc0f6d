/* How uncertain the wheels make the pose, against the same in double precision, and what it is told at the start. */
#include "tests/support/localiser_rig.h"

/* Of x, y and the heading. */
struct spread {
    double p[3][3];
};

static struct spread known;

static double root_of(double square)
{
    return (double)jp_plane_square_root((float)square);
}

static void know(float distance, float turn)
{
    known = (struct spread){{{0.0}}};
    known.p[0][0] = (double)(distance * distance);
    known.p[1][1] = (double)(distance * distance);
    known.p[2][2] = (double)(turn * turn);
}

void setUp(void)
{
    rig_reset();
    input.scan.ranges = NULL;
    config.start_distance = 0.15f;
    config.start_turn = 0.2f;
    config.lost_distance = 9.0f;
    config.lost_turn = 1.0f;
    config.wheels = (struct jp_localiser_drift){0.07f, 0.11f, 0.03f};
    rig_init();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, &robot));
    know(0.15f, 0.2f);
    rig_update();
}

void tearDown(void)
{
}

/* F P Fᵀ: the error of the heading moves the place across the way. */
static void turn_about(double dx, double dy)
{
    const double f[3][3] = {{1.0, 0.0, -dy}, {0.0, 1.0, dx}, {0.0, 0.0, 1.0}};
    struct spread after = {{{0.0}}};

    for (int m = 0; m < 81; m++) {
        after.p[m % 3][m / 3 % 3] += f[m % 3][m / 9 % 3] * known.p[m / 9 % 3][m / 27] * f[m / 3 % 3][m / 27];
    }
    known = after;
}

/* Along each of the axes of the ellipse the deviation grows by as much. */
static void widen(double more)
{
    const double xx = known.p[0][0];
    const double xy = known.p[0][1];
    const double yy = known.p[1][1];
    const double middle = 0.5 * (xx + yy);
    const double half = root_of(0.25 * (xx - yy) * (xx - yy) + xy * xy);
    const double large = root_of(middle + half) + more;
    const double small = root_of(middle - half > 0.0 ? middle - half : 0.0) + more;
    const double mean = 0.5 * (large * large + small * small);
    const double off = half > 1.0e-9 ? 0.5 * (large * large - small * small) / half : 0.0;

    known.p[0][0] = mean + off * 0.5 * (xx - yy);
    known.p[1][1] = mean - off * 0.5 * (xx - yy);
    known.p[0][1] = off * xy;
    known.p[1][0] = off * xy;
}

static void grow_turn(double more)
{
    const double deviation = root_of(known.p[2][2]) + more;

    known.p[2][2] = deviation * deviation;
}

static void never_better(void)
{
    for (int i = 0; i < 3; i++) {
        known.p[i][i] += 1.0e-6;
    }
}

static void expect_known(void)
{
    for (int m = 0; m < 9; m++) {
        TEST_ASSERT_NEAR(2.0e-5f, (float)known.p[m / 3][m % 3], localiser.covariance[m / 3][m % 3]);
    }

    const double middle = 0.5 * (known.p[0][0] + known.p[1][1]);
    const double half = 0.5 * (known.p[0][0] - known.p[1][1]);

    TEST_ASSERT_NEAR(1.0e-4f, (float)root_of(middle + root_of(half * half + known.p[0][1] * known.p[0][1])),
                     localiser.position_deviation);
    TEST_ASSERT_NEAR(1.0e-4f, (float)root_of(known.p[2][2]), localiser.heading_deviation);
}

/* ---- Ways ---- */

static void drive(float forward, float left, float turn)
{
    const struct jp_plane_pose motion = {forward, left, turn};
    const struct jp_plane_pose before = localiser.pose;
    const struct jp_plane_pose after = jp_plane_compose(&before, &motion);
    const double way = (double)jp_plane_length(forward, left);

    input.wheels = jp_plane_compose(&input.wheels, &motion);
    rig_update();
    turn_about((double)(after.x - before.x), (double)(after.y - before.y));
    widen(0.07 * way);
    grow_turn(0.11 * (double)jp_plane_magnitude(turn) + 0.03 * way);
    never_better();
    TEST_ASSERT_NEAR(1.0e-5f, after.x, localiser.pose.x);
    TEST_ASSERT_NEAR(1.0e-5f, after.y, localiser.pose.y);
    TEST_ASSERT_NEAR(1.0e-5f, after.heading, localiser.pose.heading);
}

static void test_a_start_is_as_uncertain_as_it_is_told(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, &robot));
    expect_known();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, NULL));
    TEST_ASSERT_NEAR(0.0f, 0.0f, localiser.pose.x);
    TEST_ASSERT_NEAR(0.0f, 0.0f, localiser.pose.y);
    TEST_ASSERT_NEAR(0.0f, 0.0f, localiser.pose.heading);
    expect_known();
}

/* Along each way, turning to either side, backwards and sideways. */
static void test_uncertainty_grows_along_the_way(void)
{
    static const float ways[][3] = {{0.3f, 0.0f, 0.0f},   {0.2f, 0.0f, 0.3f},   {0.4f, 0.1f, -0.4f},
                                    {-0.2f, 0.0f, 0.25f}, {0.1f, -0.3f, 0.45f}, {0.0f, 0.0f, -0.3f},
                                    {0.45f, 0.0f, 0.1f},  {0.2f, 0.2f, 0.2f}};

    for (unsigned i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        drive(ways[i][0], ways[i][1], ways[i][2]);
        expect_known();
    }
}

/* Wheels that jump say no way, but how far off it may be, in any direction. */
static void test_a_jump_of_the_wheels_is_no_way(void)
{
    for (int i = 0; i < 2; i++) {
        const struct jp_plane_pose jump = {i == 0 ? 0.6f : 0.0f, i == 0 ? 0.8f : 0.3f, i == 0 ? 0.2f : -0.7f};
        struct jp_plane_pose before;

        setUp();
        drive(0.3f, 0.1f, 0.3f);
        before = localiser.pose;
        input.wheels = jp_plane_compose(&input.wheels, &jump);
        rig_update();
        widen(i == 0 ? 1.0 : 0.3);
        grow_turn(i == 0 ? 0.2 : 0.7);
        TEST_ASSERT_NEAR(0.0f, before.x, localiser.pose.x);
        TEST_ASSERT_NEAR(0.0f, before.y, localiser.pose.y);
        TEST_ASSERT_NEAR(0.0f, before.heading, localiser.pose.heading);
        expect_known();
    }
}
