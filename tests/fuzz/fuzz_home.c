/**
 * Home over a small map that changes, with a robot that is told anything at any time, slides, and whose motors, survey
 * and battery fail: what is asked is answered within its ranges, more that is left is never less probable to suffice,
 * and once nothing changes any more it comes to an end: at its goal, at home, or with a reason.
 */
#include "tests/fuzz/fuzz_unity.h"

#define LEVEL_MAP_BYTES 1344 /* 24 × 24 cells with elevation */
#include <joulepath/home.h>

#include "src/learn/normal_quantile.h"
#include "tests/support/navigator_rig.h"

enum { FIELD_BYTES = SIDE * SIDE * (JP_HEADINGS * 3 + 4) + SIDE * 4, CALLS_MAX = 200000, HOME_X = 4, HOME_Y = 4 };

static struct jp_home home;
static uint64_t field_block[FIELD_BYTES / 8];
static struct jp_course_leg home_legs[LEGS_MAX];
static struct jp_forecast battery;
static jp_q16 given;
static bool is_battery_known;
static bool may_be_beside; /* home, where that was blocked */

static bool tell_left(void *context, struct jp_forecast *left)
{
    (void)context;
    *left = battery;
    return is_battery_known;
}

static jp_q16 tell_given(void *context)
{
    (void)context;
    return given;
}

/* ---- What is asked ---- */

static void check_question(jp_cost cost, unsigned drives)
{
    struct jp_forecast way;
    const enum jp_status status = jp_home_expect(&home, cost, drives, &way);

    fuzz_require(status == JP_OK || status == JP_ERR_NO_PLAN, "a status of an expectation");
    fuzz_require(status != JP_OK || (way.energy >= 0 && way.deviation >= 0), "a way that takes less than nothing");
}

static void check_farthest(unsigned drives)
{
    const jp_q31 confidence = JP_PROBABILITY_MIN + (JP_PROBABILITY_MAX - JP_PROBABILITY_MIN) / 2;
    struct jp_forecast way;
    jp_q31 probability = JP_PROBABILITY_MAX;
    jp_cost cost = 0;
    const enum jp_status status = jp_home_farthest(&home, &battery, confidence, drives, &cost);

    if (status == JP_OK && cost > 0U) {
        fuzz_require(jp_home_expect(&home, cost, drives, &way) == JP_OK, "the farthest way is known");
        fuzz_require(jp_forecast_suffices(&battery, &way, &probability) == JP_OK, "what is left is a forecast");
        fuzz_require(probability >= confidence, "the farthest way is less sure than asked");
    }
}

static void check_answer(void)
{
    struct jp_home_answer answer;
    struct jp_home_answer other;
    const struct jp_forecast before = battery;

    if (jp_home_ask(&home, &answer) != JP_OK) {
        return;
    }
    fuzz_require(answer.probability > 0 && answer.probability <= JP_PROBABILITY_MAX, "a probability");
    fuzz_require(answer.way.energy >= 0 && answer.way.deviation >= 0, "a way home that takes less than nothing");
    battery.energy = jp_add(battery.energy, JP_Q16(1));
    fuzz_require(jp_home_ask(&home, &other) == JP_OK && other.probability >= answer.probability,
                 "more that is left suffices less probably");
    battery = before;
}

static void check(struct fuzz_input *input)
{
    check_answer();
    if (fuzz_below(input, 8) == 0U) {
        const unsigned drives = 1U + fuzz_below(input, JP_HOME_DRIVES_MAX);

        check_question(fuzz_u32(input) & JP_COST_MAX, drives);
        check_farthest(drives);
    }
}

/* ---- What happens ---- */

static void draw_map(struct fuzz_input *input)
{
    for (unsigned i = fuzz_below(input, 40); i > 0U; i--) {
        const int32_t x = (int32_t)fuzz_below(input, SIDE);
        const int32_t y = (int32_t)fuzz_below(input, SIDE);

        if (x > HOME_X + 3 || y > HOME_Y + 3) {
            (void)jp_terrain_set_cell(&terrain, x, y, JP_CELL_OCCUPIED);
        }
    }
}

static void draw_battery(struct fuzz_input *input)
{
    const bool is_usual = fuzz_below(input, 4) != 0U;

    battery.energy = is_usual ? (jp_q16)fuzz_below(input, (uint32_t)JP_Q16(60)) : fuzz_hostile(input);
    battery.deviation = is_usual ? (jp_q16)fuzz_below(input, (uint32_t)JP_Q16(2)) : fuzz_hostile(input) & INT32_MAX;
    is_battery_known = fuzz_below(input, 8) != 0U;
}

static void start(struct fuzz_input *input)
{
    struct jp_home_config settings = {.navigator = &navigator,
                                      .x = HOME_X,
                                      .y = HOME_Y,
                                      .confidence = fuzz_range(input, JP_PROBABILITY_MIN, JP_PROBABILITY_MAX),
                                      .left = tell_left,
                                      .given = tell_given,
                                      .legs = home_legs,
                                      .legs_max = (uint16_t)(1U + fuzz_below(input, LEGS_MAX)),
                                      .slice = (uint16_t)(1U + fuzz_below(input, 1000)),
                                      .block = field_block,
                                      .size = sizeof field_block};
    const char *field = NULL;

    rig_reset();
    may_be_beside = false;
    given = fuzz_hostile(input);
    draw_battery(input);
    draw_map(input);
    init();
    if (fuzz_below(input, 8) == 0U) {
        settings.confidence = 0;
    }
    fuzz_require(jp_home_init(&home, &settings, &field) == JP_OK, "a home");
}

static void tell(struct fuzz_input *input)
{
    const struct jp_goal goal = {(int16_t)fuzz_below(input, SIDE + 1U), (int16_t)fuzz_below(input, SIDE + 1U),
                                 fuzz_bool(input) ? JP_ANY_HEADING : fuzz_u16(input)};

    switch (fuzz_below(input, 4)) {
    case 0:
        (void)jp_home_return(&home);
        break;
    case 1:
        jp_home_stop(&home);
        break;
    default:
        (void)jp_home_go(&home, &goal);
        break;
    }
}

static void change_map(struct fuzz_input *input)
{
    const int32_t x = (int32_t)fuzz_below(input, SIDE + 1U);
    const int32_t y = (int32_t)fuzz_below(input, SIDE + 1U);

    (void)jp_navigator_set_cell(&navigator, x, y, (enum jp_cell)fuzz_below(input, 3));
    may_be_beside |= x <= HOME_X + 3 && y <= HOME_Y + 3;
}

static void switch_motors(void)
{
    const bool are_off = robot.view.phase == JP_VEHICLE_OFF;

    robot.count = 0;
    robot.turning = 0;
    robot.braking = 0;
    robot.view.phase = are_off ? JP_VEHICLE_STANDING : JP_VEHICLE_OFF;
}

static void disturb(struct fuzz_input *input)
{
    switch (fuzz_below(input, 6)) {
    case 0:
        switch_motors();
        break;
    case 1:
        robot.drift = fuzz_range(input, -JP_Q16(0.002), JP_Q16(0.002));
        break;
    case 2:
        robot.slide = fuzz_range(input, -JP_Q16(0.05), JP_Q16(0.05));
        break;
    case 3:
        robot.survey_status = fuzz_bool(input) ? JP_OK : JP_ERR_INFEASIBLE;
        break;
    case 4:
        robot.infeasible = (uint16_t)fuzz_below(input, 4);
        break;
    default:
        robot.takes = (jp_q16)fuzz_below(input, (uint32_t)JP_Q16(0.1));
        break;
    }
}

static void work(unsigned calls)
{
    for (; calls > 0U; calls--) {
        battery.energy = jp_sub(battery.energy, robot.takes / 8);
        given = (jp_q16)((uint32_t)given + (uint32_t)robot.takes / 8U);
        (void)jp_home_work(&home);
    }
}

/* ---- The end ---- */

static bool is_at_work(void)
{
    return home.state == JP_HOME_PREPARING || home.state == JP_HOME_OUT || home.state == JP_HOME_RETURNING;
}

static void come_to_an_end(void)
{
    robot.survey_status = JP_OK;
    robot.infeasible = 0;
    robot.drift = 0;
    robot.slide = 0;
    robot.takes = 0;
    if (robot.view.phase == JP_VEHICLE_OFF) {
        switch_motors();
    }
    for (unsigned calls = CALLS_MAX; calls > 0U && is_at_work(); calls--) {
        (void)jp_home_work(&home);
    }
    fuzz_require(!is_at_work(), "a robot that comes to no end");
    if (home.state == JP_HOME_HOME && !may_be_beside) {
        expect_at(HOME_X, HOME_Y);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};

    start(&input);
    for (unsigned left = 60; left > 0U && fuzz_more(&input); left--) {
        switch (fuzz_below(&input, 8)) {
        case 0:
        case 1:
            tell(&input);
            break;
        case 2:
            change_map(&input);
            break;
        case 3:
            draw_battery(&input);
            break;
        case 4:
            disturb(&input);
            break;
        default:
            work(1U << fuzz_below(&input, 12));
            break;
        }
        check(&input);
    }
    come_to_an_end();
    return 0;
}
