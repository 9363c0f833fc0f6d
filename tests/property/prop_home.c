/*
 * Home in time, with a robot that does what it is told on a small map: what is refused, what is asked, when it turns
 * back, what it does when the map changes; and on random maps and batteries that a robot which can come home does.
 *
 * prop_home [--count N] [--seed S]
 */
#define LEVEL_MAP_BYTES 1344 /* 24 × 24 cells with elevation */
#include <joulepath/home.h>
#include <joulepath/return_map.h>

#include "src/learn/normal_quantile.h"
#include "tests/support/navigator_rig.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "unity.h"

enum { FIELD_BYTES = SIDE * SIDE * (JP_HEADINGS * 3 + 4) + SIDE * 4, CALLS_MAX = 60000 };

#define CONFIDENCE ((jp_q31)2145336164) /* 0.999 */

static struct options options = {.count = 60, .seed = 2111};
static struct jp_home_config settings;
static struct jp_home home;
static uint64_t field_block[FIELD_BYTES / 8];
static struct jp_course_leg home_legs[LEGS_MAX];

/* In the battery. */
static struct {
    jp_q16 energy;
    jp_q16 deviation;
    jp_q16 given;
    jp_q16 a_call; /* that the robot takes while it is under way */
    bool is_known;
} battery;

static bool tell_left(void *context, struct jp_forecast *left)
{
    TEST_ASSERT_TRUE(context == &battery);
    *left = (struct jp_forecast){battery.energy, battery.deviation};
    return battery.is_known;
}

static jp_q16 tell_given(void *context)
{
    TEST_ASSERT_TRUE(context == &battery);
    return battery.given;
}

static void take(jp_q16 energy)
{
    battery.energy -= energy;
    battery.given = (jp_q16)((uint32_t)battery.given + (uint32_t)energy);
}

void setUp(void)
{
    rig_reset();
    battery.energy = JP_Q16(1000);
    battery.deviation = JP_Q16(1);
    battery.given = INT32_MAX - JP_Q16(1); /* it wraps on the way */
    battery.a_call = 0;
    battery.is_known = true;
    settings = (struct jp_home_config){.navigator = &navigator,
                                       .x = 4,
                                       .y = 4,
                                       .confidence = CONFIDENCE,
                                       .left = tell_left,
                                       .given = tell_given,
                                       .context = &battery,
                                       .legs = home_legs,
                                       .legs_max = LEGS_MAX,
                                       .slice = 200,
                                       .block = field_block,
                                       .size = sizeof field_block};
}

void tearDown(void)
{
}

static void init_home(void)
{
    const char *field = "";

    init();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_init(&home, &settings, &field));
    TEST_ASSERT_NULL(field);
}

static void go_out(int16_t x, int16_t y)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_go(&home, &(struct jp_goal){x, y, JP_ANY_HEADING}));
    TEST_ASSERT_EQUAL_INT(JP_HOME_PREPARING, home.state);
}

static void work_a_call(void)
{
    if (home.state == JP_HOME_OUT || home.state == JP_HOME_RETURNING) {
        take(battery.a_call);
    }
    (void)jp_home_work(&home);
}

/* Until it is in a state; false: it never was. */
static bool work_home_until(enum jp_home_state state)
{
    for (unsigned i = 0; i < CALLS_MAX && home.state != state; i++) {
        work_a_call();
        if (home.state == JP_HOME_FAILED || home.state == JP_HOME_HOME) {
            break;
        }
    }
    return home.state == state;
}

static void work_some(unsigned calls)
{
    for (unsigned i = 0; i < calls; i++) {
        work_a_call();
    }
}

static void expect_refused(const char *name)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_home_init(&home, &settings, &field));
    TEST_ASSERT_EQUAL_STRING(name, field);
}

/* ---- Whether it leaves ---- */

/* At home nothing is needed, and one step out it must turn round. */
static void test_does_not_leave_with_less_than_a_short_way_out_and_back(void)
{
    init_home();
    battery.energy = JP_Q16(0.5);
    battery.deviation = 1;
    battery.a_call = 100;
    const struct jp_home_learned before = home.learned;
    const struct jp_place place = jp_navigator_place(&navigator);

    go_out(19, 19);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_HOME));
    const struct jp_place after = jp_navigator_place(&navigator);

    TEST_ASSERT_TRUE(home.has_turned_back);
    TEST_ASSERT_EQUAL_INT(JP_OK, home.status);
    TEST_ASSERT_EQUAL_MEMORY(&place, &after, sizeof place);
    TEST_ASSERT_EQUAL_MEMORY(&before, &home.learned, sizeof before);
}

static void test_leaves_whatever_is_left_where_it_never_turns_back(void)
{
    settings.confidence = 0;
    init_home();
    battery.energy = JP_Q16(0.5);
    go_out(19, 19);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
}

static void test_leaves_when_nobody_knows_what_is_left(void)
{
    init_home();
    battery.is_known = false;
    go_out(19, 19);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
}

/* Ten steps towards a goal that is nearer are the goal; what takes it there and back is needed to leave. */
static void test_leaves_for_a_near_goal_with_what_the_way_there_and_back_takes(void)
{
    struct jp_home_answer answer;

    init_home();
    go_out(8, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
    work_some(3000);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_ask(&home, &answer));
    const jp_q16 way = answer.way.energy;

    setUp();
    init_home();
    battery.energy = 8 * way;
    go_out(8, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
    setUp();
    init_home();
    battery.energy = way;
    go_out(8, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_HOME));
    TEST_ASSERT_TRUE(home.has_turned_back);
}

/* It leaves round what stands before its goal, and needs as much. */
static void test_does_not_leave_with_too_little_where_the_direct_way_is_blocked(void)
{
    init_home();
    put_column(14, 0, 16, JP_CELL_OCCUPIED);
    battery.energy = JP_Q16(0.5);
    battery.deviation = 1;
    go_out(19, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_HOME));
    TEST_ASSERT_TRUE(home.has_turned_back);
    TEST_ASSERT_TRUE(home.internal.outside_tries > 0U);
}

/* ---- What is refused ---- */

static void test_refuses_configurations(void)
{
    const struct jp_home_config good = settings;
    const char *field = "";

    init();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_init(NULL, &settings, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_init(&home, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_init(&home, &settings, NULL));
    settings.navigator = NULL;
    expect_refused("navigator");
    settings = good;
    settings.confidence = JP_PROBABILITY_MIN - 1;
    expect_refused("confidence");
    settings.confidence = JP_PROBABILITY_MAX + 1;
    expect_refused("confidence");
    settings = good;
    settings.left = NULL;
    expect_refused("left");
    settings = good;
    settings.given = NULL;
    expect_refused("given");
    settings = good;
    settings.legs = NULL;
    expect_refused("legs");
    settings = good;
    settings.legs_max = 0;
    expect_refused("legs_max");
    settings = good;
    settings.slice = 0;
    expect_refused("slice");
}

static void test_refuses_places_and_blocks(void)
{
    const struct jp_home_config good = settings;
    const char *field = "";

    init();
    settings.x = -1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_home_init(&home, &settings, &field));
    settings.x = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_BLOCKED, jp_home_init(&home, &settings, &field));
    settings = good;
    settings.size--;
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, jp_home_init(&home, &settings, &field));
    TEST_ASSERT_EQUAL_UINT32(sizeof field_block, jp_home_size(&map));
}

static void test_refuses_requests(void)
{
    struct jp_home_answer answer;
    struct jp_forecast way;
    jp_cost cost = 7;

    init_home();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_go(NULL, &(struct jp_goal){9, 9, 1}));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_go(&home, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_return(NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_ask(NULL, &answer));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_ask(&home, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_home_ask(&home, &answer));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_expect(NULL, 100, 1, &way));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_expect(&home, 100, 1, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_expect(&home, 100, JP_HOME_DRIVES_MAX + 1, &way));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_expect(&home, 100, 0, &way));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_farthest(&home, &way, CONFIDENCE, 0, &cost));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_farthest(&home, &way, CONFIDENCE, JP_HOME_DRIVES_MAX + 1, &cost));
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_home_expect(&home, 100, 1, &way));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_farthest(NULL, &way, CONFIDENCE, 1, &cost));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_farthest(&home, NULL, CONFIDENCE, 1, &cost));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_farthest(&home, &way, CONFIDENCE, 1, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_farthest(&home, &way, 0, 1, &cost));
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_home_farthest(&home, &way, CONFIDENCE, 1, &cost));
    robot.view.phase = JP_VEHICLE_OFF;
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_home_return(&home));
    TEST_ASSERT_EQUAL_INT(JP_HOME_IDLE, jp_home_work(&home));
}

static void test_a_course_along_a_field_refuses(void)
{
    const struct jp_lattice_pose from = {9, 9, 0};
    const struct jp_lattice_pose blocked = {0, 0, 0};
    const struct jp_point start = centre(9, 9);
    struct jp_course *course = &home.internal.survey.internal.course;
    const struct jp_pose_field *field = &home.internal.field;

    init_home();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_course_start_on_field(NULL, field, &from, &start));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_course_start_on_field(course, NULL, &from, &start));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_course_start_on_field(course, field, NULL, &start));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_course_start_on_field(course, field, &from, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_course_start_on_field(course, field, &from, &start));
    work_some(200);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_course_start_on_field(course, field, &from, &start));
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_course_start_on_field(course, field, &blocked, &start));
}

/* ---- Out and home ---- */

static void test_goes_out_and_comes_home_while_enough_is_left(void)
{
    init_home();
    go_out(18, 15);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
    expect_at(18, 15);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_return(&home));
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_HOME));
    expect_at(4, 4);
    TEST_ASSERT_FALSE(home.has_turned_back);
    TEST_ASSERT_GREATER_THAN_UINT32(2, home.ways);
}

/* It leaves only when it knows the way home. */
static void test_does_not_leave_before_the_way_home_is_known(void)
{
    init_home();
    go_out(18, 15);
    work_some(5);
    TEST_ASSERT_EQUAL_INT(JP_HOME_PREPARING, home.state);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_IDLE, navigator.state);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_OUT));
    TEST_ASSERT_TRUE(home.internal.price.is_known);
}

/* Two joules a leg, by a new robot's factor, and beside it as much as ten steps of the about 22 that it costs; at home
 * nothing.
 */
static void test_says_what_the_way_home_takes(void)
{
    struct jp_home_answer answer;

    init_home();
    go_out(18, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_OUT));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_ask(&home, &answer));
    TEST_ASSERT_EQUAL_INT32(0, answer.way.energy);
    TEST_ASSERT_EQUAL_INT32(JP_PROBABILITY_MAX, answer.probability);
    TEST_ASSERT_EQUAL_INT32(battery.energy, answer.left.energy);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
    work_some(50);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_ask(&home, &answer));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.4), JP_Q16(2.1) + JP_Q16(2) * 10 / 22, answer.way.energy);
    TEST_ASSERT_TRUE(answer.way.deviation > JP_Q16(0.25));
    battery.energy = answer.way.energy;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_ask(&home, &answer));
    TEST_ASSERT_INT32_WITHIN(1000, 1 << 30, answer.probability);
    battery.is_known = false;
    TEST_ASSERT_EQUAL_INT(JP_ERR_EMPTY, jp_home_ask(&home, &answer));
}

static void test_turns_back_when_it_must(void)
{
    battery.energy = JP_Q16(6);
    battery.deviation = JP_Q16(0.1);
    battery.a_call = JP_Q16(0.05);
    init_home();
    go_out(19, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_RETURNING));
    TEST_ASSERT_TRUE(home.has_turned_back);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_HOME));
    expect_at(4, 4);
}

static void test_never_turns_back_where_that_is_not_configured(void)
{
    battery.energy = JP_Q16(0.5);
    settings.confidence = 0;
    init_home();
    go_out(19, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
    TEST_ASSERT_FALSE(home.has_turned_back);
}

static void test_goes_on_where_the_battery_says_nothing(void)
{
    battery.is_known = false;
    battery.energy = 0;
    init_home();
    go_out(19, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
}

static void test_a_goal_at_home_is_reached_at_once(void)
{
    init_home();
    go_out(4, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
    TEST_ASSERT_FALSE(home.internal.price.is_known);
}

/* ---- What fails ---- */

static void test_comes_home_from_a_goal_that_cannot_be_reached(void)
{
    init_home();
    go_out(19, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_OUT));
    while (jp_navigator_place(&navigator).point.x < JP_Q16(0.8)) {
        work_some(1);
    }
    put_column(14, 0, SIDE - 1, JP_CELL_OCCUPIED);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_HOME));
    TEST_ASSERT_TRUE(home.has_turned_back);
    expect_at(4, 4);
}

static void test_fails_where_the_way_home_is_blocked_for_good(void)
{
    init_home();
    go_out(19, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
    put_column(10, 0, SIDE - 1, JP_CELL_OCCUPIED);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_return(&home));
    TEST_ASSERT_FALSE(work_home_until(JP_HOME_HOME));
    TEST_ASSERT_EQUAL_INT(JP_HOME_FAILED, home.state);
    TEST_ASSERT_EQUAL_INT(JP_OK, home.status);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_UNREACHABLE, navigator.state);
}

static void test_a_blocked_goal_fails_when_it_leaves(void)
{
    init_home();
    go_out(0, 0);
    TEST_ASSERT_FALSE(work_home_until(JP_HOME_OUT));
    TEST_ASSERT_EQUAL_INT(JP_HOME_FAILED, home.state);
    TEST_ASSERT_EQUAL_INT(JP_ERR_BLOCKED, home.status);
    TEST_ASSERT_EQUAL_INT(JP_HOME_FAILED, jp_home_work(&home));
    /* And another goal is another task. */
    go_out(19, 4);
    TEST_ASSERT_EQUAL_INT(JP_OK, home.status);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_OUT));
}

/* It is there already. */
static void test_a_drive_without_a_course_teaches_nothing(void)
{
    init_home();
    go_out(4, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
    TEST_ASSERT_EQUAL_MEMORY(&jp_home_learned_new, &home.learned, sizeof home.learned);
}

static void test_motors_that_are_off_are_named(void)
{
    init_home();
    robot.view.phase = JP_VEHICLE_OFF;
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_home_go(&home, &(struct jp_goal){19, 4, JP_ANY_HEADING}));
    TEST_ASSERT_EQUAL_INT(JP_HOME_IDLE, home.state);
    /* Before it leaves. */
    robot.view.phase = JP_VEHICLE_STANDING;
    go_out(19, 4);
    robot.view.phase = JP_VEHICLE_OFF;
    TEST_ASSERT_FALSE(work_home_until(JP_HOME_OUT));
    TEST_ASSERT_EQUAL_INT(JP_HOME_FAILED, home.state);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, home.status);
    /* On its way home. */
    robot.view.phase = JP_VEHICLE_STANDING;
    go_out(19, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_return(&home));
    while (navigator.state != JP_NAVIGATOR_DRIVING) {
        work_some(1);
    }
    robot.view.phase = JP_VEHICLE_OFF;
    TEST_ASSERT_FALSE(work_home_until(JP_HOME_HOME));
    TEST_ASSERT_EQUAL_INT(JP_HOME_FAILED, home.state);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, home.status);
}

static void test_stop_ends_it(void)
{
    init_home();
    go_out(19, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_OUT));
    work_some(40);
    jp_home_stop(&home);
    TEST_ASSERT_EQUAL_INT(JP_HOME_IDLE, home.state);
    battery.energy = 0;
    work_some(200);
    TEST_ASSERT_EQUAL_INT(JP_HOME_IDLE, home.state);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_IDLE, navigator.state);
    TEST_ASSERT_FALSE(home.has_turned_back);
}

/* It stands where no way home begins. */
static void test_fails_where_no_way_leads_home(void)
{
    put_column(14, 0, SIDE - 1, JP_CELL_OCCUPIED);
    settings.x = 19;
    init_home();
    go_out(8, 8);
    TEST_ASSERT_FALSE(work_home_until(JP_HOME_OUT));
    TEST_ASSERT_EQUAL_INT(JP_HOME_FAILED, home.state);
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, home.status);
    TEST_ASSERT_TRUE(jp_home_is_cut_off(&home));
}

static void test_fails_to_turn_back_when_its_motors_are_off(void)
{
    battery.energy = JP_Q16(100);
    init_home();
    go_out(19, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_OUT));
    while (navigator.state != JP_NAVIGATOR_DRIVING) {
        work_some(1);
    }
    work_some(40);
    /* Home was blocked since it left. */
    put_column(4, 3, 5, JP_CELL_OCCUPIED);
    navigator.internal.map_seen = terrain.version;
    battery.energy = 0;
    work_some(2);
    TEST_ASSERT_EQUAL_INT(JP_HOME_FAILED, home.state);
    TEST_ASSERT_NOT_EQUAL_INT(JP_OK, home.status);
    TEST_ASSERT_TRUE(home.has_turned_back);
}

/* What the vehicle refuses to survey is looked at again. */
static void test_a_way_that_cannot_be_surveyed_is_tried_again(void)
{
    uint32_t ways;

    init_home();
    go_out(19, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
    robot.survey_status = JP_ERR_ZERO_LENGTH;
    work_some(30);
    ways = home.ways;
    work_some(100);
    TEST_ASSERT_EQUAL_UINT32(ways, home.ways);
    robot.survey_status = JP_OK;
    work_some(100);
    TEST_ASSERT_GREATER_THAN_UINT32(ways, home.ways);
}

/* ---- The map changes ---- */

static void drive_to_the_middle(void)
{
    init_home();
    go_out(20, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_OUT));
    while (jp_navigator_place(&navigator).point.x < JP_Q16(1.2)) {
        work_some(1);
    }
}

static void test_what_blocks_the_way_home_is_seen(void)
{
    struct jp_home_answer before;
    struct jp_home_answer after;

    drive_to_the_middle();
    put_column(8, 0, 14, JP_CELL_OCCUPIED);
    for (unsigned i = 0; i < 60 && home.internal.phase != JP_HOME_GROWS; i++) {
        work_some(1);
    }
    TEST_ASSERT_EQUAL_INT(JP_HOME_GROWS, home.internal.phase);

    /* Until then it is the last one and what was spent since. */
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_ask(&home, &before));
    take(JP_Q16(1));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_ask(&home, &after));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), before.way.energy + home.learned.back.mean, after.way.energy);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
    work_some(100);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_ask(&home, &after));
    TEST_ASSERT_TRUE(after.way.energy > JP_Q16(4));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_return(&home));
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_HOME));
    expect_at(4, 4);
}

/* A robot that is moved while it is thought to stand is awaited. */
static void test_leaves_when_it_has_stood_still(void)
{
    config.patience = 400;
    init_home();
    go_out(18, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_return(&home));
    for (unsigned i = 0; i < 200; i++) {
        robot.view.position.x += JP_Q16(0.0001);
        work_some(1);
        TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_PLANNING, navigator.state);
    }
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_HOME));
    expect_at(4, 4);
}

/* The way along the field is cut off, and the field has not grown anew: then it plans. */
static void test_plans_where_the_field_leads_no_more(void)
{
    for (unsigned calls = 0; calls < 2; calls++) {
        setUp();
        init_home();
        go_out(18, 4);
        TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_return(&home));
        for (unsigned i = 0; i < calls; i++) {
            (void)jp_navigator_work(&navigator);
        }
        put_column(8, 0, 14, JP_CELL_OCCUPIED);
        navigator.internal.map_seen = terrain.version;
        TEST_ASSERT_TRUE(work_home_until(JP_HOME_HOME));
        expect_at(4, 4);
    }
}

static void test_plans_where_the_field_has_not_come_to(void)
{
    const struct jp_goal goal = {18, 4, JP_ANY_HEADING};

    init_home();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_go_along(&navigator, &goal, &home.internal.field));
    for (unsigned i = 0; i < CALLS_MAX && navigator.state != JP_NAVIGATOR_ARRIVED; i++) {
        (void)jp_navigator_work(&navigator);
    }
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_ARRIVED, navigator.state);
    expect_at(18, 4);
}

static void test_what_is_elsewhere_does_not_matter(void)
{
    drive_to_the_middle();
    put_column(8, 20, 21, JP_CELL_OCCUPIED);
    work_some(1);
    TEST_ASSERT_TRUE(home.internal.phase != JP_HOME_GROWS);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
}

/* A lattice with other prices: the field grows anew. */
static void test_takes_other_prices(void)
{
    drive_to_the_middle();
    jp_home_set_lattice(&home, &jp_lattice_courier24);
    TEST_ASSERT_EQUAL_INT(JP_HOME_GROWS, home.internal.phase);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
    work_some(200);
    TEST_ASSERT_TRUE(home.internal.phase != JP_HOME_GROWS);
}

/* The robot is off the lattice's cells, nearer to a wall than it may stand. */
static void test_begins_beside_a_cell_that_is_too_near_to_a_wall(void)
{
    struct jp_home_answer answer;

    init_home();
    go_out(18, 15);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
    put_column(16, 12, 18, JP_CELL_OCCUPIED);
    jp_home_set_lattice(&home, &jp_lattice_courier24);
    work_some(400);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_ask(&home, &answer));
}

/* ---- How far ---- */

static void test_expects_of_a_way_what_its_cost_says(void)
{
    struct jp_forecast ways[3];
    struct jp_forecast out_and_home;

    init_home();
    go_out(18, 15);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_OUT));
    for (unsigned i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_expect(&home, 300 * (i + 1), 1, &ways[i]));
        TEST_ASSERT_TRUE(ways[i].energy > 0 && ways[i].deviation > 0);
    }
    /* Each step takes as much; what is not known of it becomes a smaller share. */
    TEST_ASSERT_INT32_WITHIN(4, ways[1].energy - ways[0].energy, ways[2].energy - ways[1].energy);
    TEST_ASSERT_TRUE((int64_t)ways[1].deviation * ways[0].energy < (int64_t)ways[0].deviation * ways[1].energy);
    TEST_ASSERT_TRUE((int64_t)ways[2].deviation * ways[1].energy < (int64_t)ways[1].deviation * ways[2].energy);
    /* Two drives begin twice, and the way out is dearer and less sure. */
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_expect(&home, 600, 2, &out_and_home));
    TEST_ASSERT_TRUE(out_and_home.energy > ways[1].energy);
    TEST_ASSERT_TRUE(out_and_home.deviation > ways[1].deviation);
}

/* A way that costs so much suffices with the confidence; one that costs more does not. */
static void test_the_farthest_way_is_as_sure_as_was_asked(void)
{
    init_home();
    go_out(18, 15);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_OUT));
    for (jp_q16 energy = JP_Q16(8); energy < JP_Q16(60); energy += JP_Q16(7)) {
        const struct jp_forecast left = {energy, energy / 50};
        struct jp_forecast way;
        jp_cost cost = 0;
        jp_q31 probability = 0;

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_farthest(&home, &left, CONFIDENCE, 1, &cost));
        TEST_ASSERT_TRUE(cost > 0 && cost < JP_COST_MAX);
        (void)jp_home_expect(&home, cost, 1, &way);
        (void)jp_forecast_suffices(&left, &way, &probability);
        TEST_ASSERT_TRUE(probability >= CONFIDENCE);
        (void)jp_home_expect(&home, cost + 1U, 1, &way);
        (void)jp_forecast_suffices(&left, &way, &probability);
        TEST_ASSERT_TRUE(probability < CONFIDENCE);
    }
}

static void test_drives_teach_by_which_factor_they_take_more(void)
{
    battery.a_call = JP_Q16(0.05);
    init_home();
    for (unsigned i = 0; i < 6; i++) {
        battery.energy = JP_Q16(1000);
        go_out(18, 4);
        TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_return(&home));
        TEST_ASSERT_TRUE(work_home_until(JP_HOME_HOME));
    }
    TEST_ASSERT_TRUE(home.learned.out.mean > JP_Q16(1.2));
}

/* Out and home on a battery of which so much less than thought turns out to be left on the way. */
static struct jp_home_learned learned_after(jp_q16 less)
{
    rig_reset();
    battery.energy = JP_Q16(1000);
    battery.a_call = JP_Q16(0.05);
    init_home();
    go_out(18, 4);
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_OUT));
    work_some(40);
    battery.energy -= less;
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_AT_GOAL));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_return(&home));
    TEST_ASSERT_TRUE(work_home_until(JP_HOME_HOME));
    return home.learned;
}

static void test_what_becomes_known_of_the_battery_teaches_nothing_of_drives(void)
{
    const struct jp_home_learned usual = learned_after(0);
    const struct jp_home_learned corrected = learned_after(JP_Q16(500));

    TEST_ASSERT_TRUE(usual.out.mean != jp_home_learned_new.out.mean);
    TEST_ASSERT_TRUE(usual.back.mean != jp_home_learned_new.back.mean);
    TEST_ASSERT_EQUAL_INT32(usual.out.mean, corrected.out.mean);
    TEST_ASSERT_EQUAL_INT32(usual.back.mean, corrected.back.mean);
    TEST_ASSERT_EQUAL_INT32(usual.back.noise, corrected.back.noise);
}

/* ---- Any map, any battery ---- */

static void make_random_map(void)
{
    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        const bool is_home = i % SIDE < 8 && i / SIDE < 8;

        if (!is_home && below(100) < 4) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, i % SIDE, i / SIDE, JP_CELL_OCCUPIED));
        }
    }
}

/* Where the robot may stand. */
static void go_anywhere(void)
{
    int16_t x;
    int16_t y;

    do {
        x = (int16_t)below(SIDE);
        y = (int16_t)below(SIDE);
    } while (!jp_lattice_is_open(&jp_lattice_courier24, &terrain, x, y));
    go_out(x, y);
}

/* Whatever the goal and however little is left: it arrives and comes home, or comes home, or says why not. And where it
 * turned back, what the way home was said to take was there. */
static void test_comes_home_on_any_map(void)
{
    unsigned turned = 0;
    unsigned arrived = 0;

    for (uint64_t i = 0; i < options.count; i++) {
        setUp();
        begin_random(options.seed, i);
        make_random_map();
        battery.energy = JP_Q16(2) + (jp_q16)below((uint32_t)JP_Q16(40)); /* ten steps are half of the map */
        battery.deviation = (jp_q16)below((uint32_t)JP_Q16(0.5));
        battery.a_call = (jp_q16)below((uint32_t)JP_Q16(0.06));
        init_home();
        go_anywhere();
        if (work_home_until(JP_HOME_AT_GOAL)) {
            arrived++;
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_return(&home));
        }
        if (home.has_turned_back) {
            turned++;
        }
        if (home.state != JP_HOME_FAILED) {
            TEST_ASSERT_TRUE(work_home_until(JP_HOME_HOME));
            expect_at(4, 4);
        }
    }
    (void)printf("%lu maps from seed %llu: %u arrived, %u turned back\n", options.count,
                 (unsigned long long)options.seed, arrived, turned);
    TEST_ASSERT_TRUE(arrived > options.count / 8 && turned > options.count / 16);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    UNITY_BEGIN();
    run_tests();
    return UNITY_END();
}
