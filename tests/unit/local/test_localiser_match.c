/* A scan as ends of beams, and how it agrees with the map. */
#include "src/local/localiser_match.h"

#include "tests/support/localiser_rig.h"

static struct jp_plane_point points[RIG_BEAMS];
static struct jp_localiser_cloud cloud = {.points = points};

void setUp(void)
{
    rig_reset();
    rig_scan();
}

void tearDown(void)
{
}

static void test_every_so_many_th_end_is_taken(void)
{
    const struct jp_plane_pose mount = {0.2f, 0.1f, 0.5f};
    int32_t hits = 0;

    for (int i = 0; i < RIG_BEAMS; i++) {
        hits += ranges[i] > 0.0f ? 1 : 0;
    }
    jp_localiser_collect(&cloud, RIG_BEAMS, &input.scan, &mount, RIG_RANGE);
    TEST_ASSERT_EQUAL_INT32(hits, cloud.count);
    jp_localiser_collect(&cloud, 30, &input.scan, &mount, RIG_RANGE);
    TEST_ASSERT_TRUE(cloud.count <= 30 && cloud.count >= 20);
    TEST_ASSERT_NEAR(1.0e-6f, 0.2f, cloud.sensor.x);
    jp_localiser_collect(&cloud, 30, &input.scan, &mount, 0.01f);
    TEST_ASSERT_EQUAL_INT32(0, cloud.count);
}

static void test_at_the_true_pose_all_is_explained(void)
{
    const struct jp_plane_pose none = {0.0f, 0.0f, 0.0f};
    struct jp_localiser_view view;

    jp_localiser_collect(&cloud, RIG_BEAMS, &input.scan, &none, RIG_RANGE);
    jp_localiser_compare(&localiser.internal.field, &cloud, 1, &robot, 0.04f, &view);
    TEST_ASSERT_EQUAL_UINT16(cloud.count, view.beams);
    TEST_ASSERT_TRUE(view.explained + 3 >= view.beams);
    jp_localiser_compare(&localiser.internal.field, &cloud, 4, &robot, 0.04f, &view);
    TEST_ASSERT_EQUAL_UINT16((cloud.count + 3) / 4, view.beams);
}

/* Dirt on the scanner. */
static void test_beam_without_a_length_passes_through_nothing(void)
{
    struct jp_localiser_view view;

    points[0] = (struct jp_plane_point){0.1f, 0.0f};
    points[1] = (struct jp_plane_point){0.1f, 0x1p-127f};
    cloud = (struct jp_localiser_cloud){.points = points, .count = 2, .sensor = {0.1f, 0.0f}};
    jp_localiser_compare(&localiser.internal.field, &cloud, 1, &robot, 0.04f, &view);
    TEST_ASSERT_EQUAL_UINT16(2, view.beams);
    TEST_ASSERT_EQUAL_UINT16(0, view.explained);
    TEST_ASSERT_EQUAL_UINT16(0, view.behind);
    TEST_ASSERT_EQUAL_UINT16(0, view.beyond);
}

static void test_where_there_is_no_wall_there_is_no_information(void)
{
    const struct jp_plane_pose none = {0.0f, 0.0f, 0.0f};
    const struct jp_localiser_prior prior = {.start = {-100.0f, -100.0f, 0.0f}, .noise = 0.04f};
    struct jp_localiser_fit fit;

    jp_localiser_collect(&cloud, RIG_BEAMS, &input.scan, &none, RIG_RANGE);
    jp_localiser_match(&localiser.internal.field, &cloud, &prior, &fit);
    TEST_ASSERT_NEAR(1.0e-6f, 0.0f, fit.inliers);
}
