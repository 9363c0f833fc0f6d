/* Where the robot and its legs are: on the map, along a leg, and among the headings of a lattice. */
#include "src/navigate/navigator_frame.h"
#include "tests/support/navigator_rig.h"

#define FAR JP_Q16(32000)

void setUp(void)
{
    rig_reset();
    origin = (struct jp_place){{0, 0}, 0};
    init();
    legs[0] = (struct jp_course_leg){.end = {JP_Q16(1), 0}};
    navigator.internal.course.internal.start = (struct jp_point){0, 0};
    navigator.internal.course.count = 1;
}

void tearDown(void)
{
}

/* An angle of 2⁻³² turn would show. */
static void test_what_is_straight_ahead_is_so_at_any_distance(void)
{
    const struct jp_point ahead = {FAR, 0};

    TEST_ASSERT_EQUAL_INT32(0, jp_frame_in_odometry(&navigator, &ahead).y);
    TEST_ASSERT_EQUAL_INT32(0, jp_frame_along_leg(&navigator, 0, &ahead).y);
}

static void test_of_headings_as_near_the_first_is_taken(void)
{
    const uint16_t ahead_or_back = 1U << 0 | 1U << (JP_HEADINGS / 2);
    const jp_angle quarter = (jp_angle)1 << 30;

    TEST_ASSERT_EQUAL_UINT8(0, jp_frame_nearest_heading(&jp_lattice_courier24, ahead_or_back, quarter));
    TEST_ASSERT_EQUAL_UINT8(0, jp_frame_nearest_heading(&jp_lattice_courier24, ahead_or_back, quarter - 1U));
    TEST_ASSERT_EQUAL_UINT8(JP_HEADINGS / 2,
                            jp_frame_nearest_heading(&jp_lattice_courier24, ahead_or_back, quarter + 1U));
}

/* The least length that there is takes all of what the course takes. */
static void test_a_course_of_any_length_takes_what_it_takes(void)
{
    struct jp_progress progress;

    navigator.state = JP_NAVIGATOR_TURNING;
    navigator.internal.duration = JP_Q16(2);
    for (jp_q16 length = 0; length <= 2; length++) {
        legs[0].end.x = length;
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_progress(&navigator, &progress));
        TEST_ASSERT_EQUAL_INT32(length, progress.length);
        TEST_ASSERT_EQUAL_INT32(length > 0 ? JP_Q16(2) : 0, progress.duration);
    }
}
