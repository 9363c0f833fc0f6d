/* Random bands: feet, neighbours and numbers of poses against brute force and against what no change may change. */
#include "src/local/teb_band.h"

#include "src/local/obstacle_distance.h"
#include "tests/support/teb_rig.h"

#define REACH 0.3f

static struct jp_plane_point corners[8];

void setUp(void)
{
    rig_reset();
    teb.internal.obstacles = &obstacles;
}

void tearDown(void)
{
}

static float random_from(float low, float high)
{
    return low + 0.5f * (high - low) + rig_random(0.5f * (high - low));
}

/* Bends of up to half a right angle, chords of about a metre. */
static void bend_path(float turn)
{
    float heading = turn;
    struct jp_plane_point at = {rig_random(3.0f), rig_random(3.0f)};

    for (unsigned i = 0; i < 8U; i++) {
        const struct jp_plane_point along = jp_plane_direction(heading);
        const float length = random_from(0.6f, 1.4f);

        corners[i] = at;
        at.x += length * along.x;
        at.y += length * along.y;
        heading += rig_random(0.7f);
    }
    rig_path(corners, 8);
    teb.internal.task = task;
}

/* ---- Feet ---- */

static float to_chord(unsigned k, const struct jp_plane_pose *pose, struct jp_plane_point *foot)
{
    const float dx = corners[k + 1U].x - corners[k].x;
    const float dy = corners[k + 1U].y - corners[k].y;
    const float share = jp_plane_clamp(
        ((pose->x - corners[k].x) * dx + (pose->y - corners[k].y) * dy) / (dx * dx + dy * dy), 0.0f, 1.0f);

    *foot = (struct jp_plane_point){corners[k].x + share * dx, corners[k].y + share * dy};
    return jp_plane_length(foot->x - pose->x, foot->y - pose->y);
}

/* Poses along the path, a little beside it: each foot is the nearest place, and its normal is to the left of the path.
 */
static void test_feet_are_the_nearest_places(void)
{
    for (unsigned run = 0; run < 12U; run++) {
        setUp();
        random_state = run + 5U;
        bend_path(0.9f * (float)run);
        teb.count = 7;
        for (unsigned i = 0; i < 7U; i++) {
            const float x = 0.5f * (corners[i].x + corners[i + 1U].x) + rig_random(0.15f);
            const float y = 0.5f * (corners[i].y + corners[i + 1U].y) + rig_random(0.15f);

            jp_teb_set_pose(&teb.poses[i], &(struct jp_plane_pose){x, y, 0.0f});
        }
        jp_teb_find_feet(&teb);
        for (unsigned i = 0; i < 7U; i++) {
            struct jp_plane_point nearest = corners[0];
            float least = 1.0e9f;
            unsigned chord = 0;

            for (unsigned k = 0; k < 7U; k++) {
                struct jp_plane_point foot;
                const float distance = to_chord(k, &teb.poses[i].pose, &foot);

                if (distance < least - 1.0e-5f) {
                    least = distance;
                    nearest = foot;
                    chord = k;
                }
            }
            const struct jp_plane_point along = jp_plane_direction(
                jp_plane_bearing(corners[chord + 1U].x - corners[chord].x, corners[chord + 1U].y - corners[chord].y));

            TEST_ASSERT_NEAR(1.0e-4f, nearest.x, teb.internal.feet[i].point.x);
            TEST_ASSERT_NEAR(1.0e-4f, nearest.y, teb.internal.feet[i].point.y);
            TEST_ASSERT_NEAR(1.0e-3f, -along.y, teb.internal.feet[i].normal.x);
            TEST_ASSERT_NEAR(1.0e-3f, along.x, teb.internal.feet[i].normal.y);
        }
    }
}

/* ---- Neighbours ---- */

static float distance_of(unsigned i, unsigned shape, float time)
{
    const struct jp_obstacle *const obstacle = &obstacles.shapes[shape];
    const struct jp_plane_pose *const pose = &teb.poses[i].pose;
    const struct jp_plane_pose meeting = {pose->x - time * obstacle->velocity.x, pose->y - time * obstacle->velocity.y,
                                          pose->heading};

    return jp_obstacle_distance(&teb.config.footprint, &meeting, obstacle, NULL) -
           obstacle->margin * jp_plane_smaller(time, 1.0f);
}

/* How many shapes are nearer than a distance, by so much clearly. */
static unsigned nearer_than(unsigned i, float time, float distance)
{
    unsigned count = 0;

    for (unsigned shape = 0; shape < obstacles.count; shape++) {
        count += distance_of(i, shape, time) < distance ? 1U : 0U;
    }
    return count;
}

static void expect_neighbours(unsigned i, float time)
{
    const struct jp_teb_neighbours *const near = &teb.internal.near[i];
    const float reach = teb.config.clearance + REACH;

    TEST_ASSERT_NEAR(1.0e-5f, time, near->time);
    TEST_ASSERT_NEAR(1.0e-5f, teb.poses[i].pose.x, near->pose.x);
    for (unsigned k = 0; k < near->count; k++) {
        const float distance = distance_of(i, near->shape[k], time);

        TEST_ASSERT_NEAR(1.0e-4f, distance, near->distance[k]);
        TEST_ASSERT_TRUE(distance < reach + 1.0e-4f);
        TEST_ASSERT_TRUE(k == 0U || near->distance[k] >= near->distance[k - 1U]);
        TEST_ASSERT_LESS_OR_EQUAL_UINT(k, nearer_than(i, time, distance - 1.0e-4f));
    }
    if (near->count < JP_TEB_NEAR_MAX) {
        TEST_ASSERT_LESS_OR_EQUAL_UINT(near->count, nearer_than(i, time, reach - 1.0e-4f));
    }
}

static void test_neighbours_are_the_nearest_of_all(void)
{
    for (unsigned run = 0; run < 12U; run++) {
        float time = 0.0f;

        setUp();
        random_state = run + 77U;
        bend_path(0.5f * (float)run);
        teb.count = 12;
        for (unsigned i = 0; i < 12U; i++) {
            const struct jp_plane_pose pose = {corners[i / 2U].x + rig_random(0.4f),
                                               corners[i / 2U].y + rig_random(0.4f), rig_random(3.0f)};

            jp_teb_set_pose(&teb.poses[i], &pose);
            teb.poses[i].interval = random_from(0.1f, 0.5f);
        }
        for (unsigned k = 0; k < 14U; k++) {
            const unsigned at = k % 7U;

            rig_disc(corners[at].x + rig_random(1.2f), corners[at].y + rig_random(1.2f), 0.05f);
            if (obstacles.count > 0U) {
                obstacles.shapes[obstacles.count - 1U].velocity =
                    (struct jp_plane_point){rig_random(0.6f), rig_random(0.6f)};
                obstacles.shapes[obstacles.count - 1U].margin = k % 3U == 0U ? 0.2f : 0.0f;
            }
        }
        teb.internal.work = 0;
        jp_teb_find_obstacles(&teb);
        for (unsigned i = 0; i < teb.count; i++) {
            expect_neighbours(i, time);
            time += teb.poses[i].interval;
        }
    }
}

/* ---- Numbers of poses ---- */

/* Poses on a straight line, driven over at the speeds of their intervals: a split or a join leaves the way, its ends
 * and the time it takes, and afterwards no interval but the last is too short, and none is too long. */
static void test_a_change_of_poses_keeps_the_ends_and_the_time(void)
{
    for (unsigned run = 0; run < 40U; run++) {
        float before = 0.0f;
        float after = 0.0f;
        float x = 0.0f;

        setUp();
        random_state = run + 1U;
        teb.count = (uint8_t)(JP_TEB_POSES_MIN + run % 8U);
        for (unsigned i = 0; i < teb.count; i++) {
            jp_teb_set_pose(&teb.poses[i], &(struct jp_plane_pose){x, 2.0f * x, 0.1f * x});
            teb.poses[i].interval = i + 1U < teb.count ? random_from(0.02f, 0.9f) : 0.0f;
            before += teb.poses[i].interval;
            x += random_from(0.1f, 0.5f);
        }

        const struct jp_plane_pose first = teb.poses[0].pose;
        const struct jp_plane_pose last = teb.poses[teb.count - 1U].pose;

        jp_teb_resize(&teb);
        for (unsigned i = 0; i + 1U < teb.count; i++) {
            const float interval = teb.poses[i].interval;

            after += interval;
            TEST_ASSERT_TRUE(interval <= 0.35f + 1.0e-5f || teb.count == JP_TEB_POSES_MAX);
            TEST_ASSERT_TRUE(interval >= 0.15f - 1.0e-5f || i + 2U >= teb.count || teb.count == JP_TEB_POSES_MIN);
            TEST_ASSERT_TRUE(teb.poses[i].pose.x < teb.poses[i + 1U].pose.x);
            TEST_ASSERT_NEAR(1.0e-5f, 2.0f * teb.poses[i].pose.x, teb.poses[i].pose.y);
            TEST_ASSERT_NEAR(1.0e-5f, 0.1f * teb.poses[i].pose.x, teb.poses[i].pose.heading);
        }
        TEST_ASSERT_NEAR(1.0e-5f, before, after);
        TEST_ASSERT_NEAR(0.0f, first.x, teb.poses[0].pose.x);
        TEST_ASSERT_NEAR(0.0f, last.x, teb.poses[teb.count - 1U].pose.x);
    }
}
