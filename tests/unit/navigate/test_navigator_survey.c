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

/** A run of two legs in a straight line, of which the first is surveyed. */
static enum jp_status survey_first_of_two(void)
{
    const struct jp_place place = {centre(4, 4), 0};

    many[1] = (struct jp_course_leg){.end = centre(16, 4), .is_stop = true};
    navigator.internal.course.internal.start = place.point;
    navigator.internal.course.count = 2;
    jp_survey_start(&navigator);
    TEST_ASSERT_EQUAL_INT(JP_WORKING, jp_survey_work(&navigator, &place));
    return jp_survey_work(&navigator, &place);
}

/** One leg from stand to stand. */
static enum jp_status survey_one(void)
{
    const struct jp_place place = {centre(4, 4), 0};

    many[0].end = centre(10, 4);
    many[0].is_stop = true;
    navigator.internal.course.internal.start = place.point;
    navigator.internal.course.count = 1;
    jp_survey_start(&navigator);
    TEST_ASSERT_EQUAL_INT(JP_WORKING, jp_survey_work(&navigator, &place));
    return jp_survey_work(&navigator, &place);
}

/* 2 mm. */
static void test_room_beside_the_line_is_for_what_leaves_it_by_more_than_little(void)
{
    many[0].end = centre(10, 4);
    robot.aside = JP_Q16(0.002);
    TEST_ASSERT_EQUAL_INT(JP_WORKING, survey_first_of_two());
    TEST_ASSERT_EQUAL_INT32(0, many[0].aside);
    robot.aside++;
    TEST_ASSERT_EQUAL_INT(JP_WORKING, survey_first_of_two());
    TEST_ASSERT_EQUAL_INT32(robot.aside, many[0].aside);
}

/* That the line itself is clear is known. */
static void test_looks_for_room_only_where_the_robot_needs_more(void)
{
    put_column(7, 4, 4, JP_CELL_OCCUPIED);
    many[0].end = centre(10, 4);
    robot.aside = JP_Q16(0.002);
    TEST_ASSERT_EQUAL_INT(JP_WORKING, survey_first_of_two());
    TEST_ASSERT_FALSE(many[0].is_stop);
    TEST_ASSERT_EQUAL_INT(JP_OK, survey_one());
    TEST_ASSERT_EQUAL_UINT8(0, many[0].slower);
    robot.beyond = 1;
    TEST_ASSERT_EQUAL_INT(JP_WORKING, survey_one());
    TEST_ASSERT_EQUAL_UINT8(1, many[0].slower);
}

/** The greatest margin with which the first leg is clear. */
static jp_q16 margin_of_first(void)
{
    const struct jp_point begin = centre(4, 4);
    jp_q16 clear = 0;
    jp_q16 blocked = JP_Q16(0.2);

    while (blocked - clear > 1) {
        many[0].margin = (clear + blocked) / 2;
        *(jp_course_is_clear(&navigator.internal.course, 0, &begin) ? &clear : &blocked) = many[0].margin;
    }
    return clear;
}

/* The room that it has when it comes near the wall head on; how far it went beyond in an earlier course is no matter.
 * The map is looked at by thousandths of a cell: one of these ends is at the edge of one. */
static void test_takes_a_corner_with_just_the_room(void)
{
    put_column(13, 0, SIDE - 1, JP_CELL_OCCUPIED);
    for (jp_q16 step = 0; step <= map.resolution / 1000; step++) {
        many[0] = (struct jp_course_leg){.end = {centre(10, 4).x + step, centre(10, 4).y}, .aside = JP_Q16(0.003)};
        many[0].margin = margin_of_first();
        many[0].beyond = JP_Q16(0.5);
        robot.aside = JP_Q16(0.003);
        TEST_ASSERT_EQUAL_INT(JP_WORKING, survey_first_of_two());
        TEST_ASSERT_FALSE(many[0].is_stop);
        many[0].margin += map.resolution / 1000 + 1;
        TEST_ASSERT_EQUAL_INT(JP_WORKING, survey_first_of_two());
        TEST_ASSERT_TRUE(many[0].is_stop);
        TEST_ASSERT_FALSE(navigator.internal.survey.has_begun);
    }
}

/* At its slowest a robot goes beyond its stand by a fifth of what it does else. */
static void test_a_margin_is_room_for_as_much(void)
{
    static const jp_q16 less[] = {0, 1};

    put_column(12, 0, SIDE - 1, JP_CELL_OCCUPIED);
    robot.beyond = JP_Q16(0.15);
    for (unsigned i = 0; i < 2; i++) {
        navigator.config.margin =
            robot.beyond - jp_q16_multiply(robot.beyond, (jp_q16)JP_VEHICLE_SLOWER_MAX * JP_Q16(0.1)) - less[i];
        many[0].slower = JP_VEHICLE_SLOWER_MAX;
        TEST_ASSERT_EQUAL_INT(less[i] == 0 ? JP_OK : JP_ERR_BLOCKED, survey_one());
        TEST_ASSERT_EQUAL_INT32(0, many[0].beyond);
    }
}
