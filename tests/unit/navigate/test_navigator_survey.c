/* Where the robot is made to stand: where a run is longer than the memory for it, and at the sharper corner of a leg.
 */
#include "src/navigate/navigator_survey.h"
#include "tests/support/navigator_rig.h"

static struct jp_course_leg many[JP_NAVIGATOR_RUN_MAX + 4U];

void setUp(void)
{
    rig_reset();
    for (unsigned i = 0; i < sizeof many / sizeof many[0]; i++) {
        many[i] = (struct jp_course_leg){.end = centre(5 + (int32_t)i, 4)};
    }
    config.legs = many;
    config.legs_max = sizeof many / sizeof many[0];
    init();
}

void tearDown(void)
{
}

static void test_a_run_ends_at_its_stand(void)
{
    many[2].is_stop = true;
    TEST_ASSERT_EQUAL_UINT32(3, jp_survey_write_run(&navigator, 0));
    TEST_ASSERT_EQUAL_UINT32(1, jp_survey_write_run(&navigator, 2));
    TEST_ASSERT_INT32_WITHIN(2, JP_Q16(0.3), navigator.internal.targets[0].x);
    TEST_ASSERT_INT32_WITHIN(2, 0, navigator.internal.targets[0].y);
}

static void test_a_long_run_is_interrupted(void)
{
    TEST_ASSERT_EQUAL_UINT32(JP_NAVIGATOR_RUN_MAX, jp_survey_write_run(&navigator, 0));
    TEST_ASSERT_TRUE(many[JP_NAVIGATOR_RUN_MAX - 1U].is_stop);
    TEST_ASSERT_FALSE(many[JP_NAVIGATOR_RUN_MAX].is_stop);
}

/** Three legs, the middle one of which cannot be driven in motion: where does it stand? */
static void survey(struct jp_point first, struct jp_point second, struct jp_point third)
{
    const struct jp_place place = {centre(4, 4), 0};

    many[0] = (struct jp_course_leg){.end = first};
    many[1] = (struct jp_course_leg){.end = second};
    many[2] = (struct jp_course_leg){.end = third, .is_stop = true};
    navigator.internal.course.internal.start = place.point;
    navigator.internal.course.count = 3;
    robot.infeasible = 2;
    jp_survey_start(&navigator);
    for (unsigned i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_INT(JP_WORKING, jp_survey_work(&navigator, &place));
    }
}

static void test_stands_at_the_begin_of_a_leg_where_the_corner_is_sharper(void)
{
    survey(centre(10, 4), centre(10, 10), centre(12, 16));
    TEST_ASSERT_TRUE(many[0].is_stop);
    TEST_ASSERT_FALSE(many[1].is_stop);
}

static void test_stands_at_the_end_of_a_leg_where_the_corner_is_sharper(void)
{
    survey(centre(10, 4), centre(16, 6), centre(16, 12));
    TEST_ASSERT_FALSE(many[0].is_stop);
    TEST_ASSERT_TRUE(many[1].is_stop);
}
