/* The route optimiser: arguments and statuses, slices, the paper's four segments, limits to the last bit, the way back
 * to the greedy plan, horizons. */
#include <joulepath/route.h>
#include <joulepath/tables.h>
#include <stddef.h>

#include "src/trajectory/segment_geometry.h"
#include "unity.h"

#define MILLIMETRE JP_Q16(0.001)
#define LEGS       16

/* rad */
#define PI JP_Q24(3.141592653589793)

static const struct jp_segment_limits paper_limits = {JP_Q24(1), JP_Q24(0.35), JP_Q24(1.3962634), JP_Q16(600)};
static const struct jp_point origin;
static const struct jp_point paper_targets[] = {
    {JP_Q16(10), JP_Q16(10)}, {JP_Q16(20), JP_Q16(15)}, {JP_Q16(25), JP_Q16(25)}, {JP_Q16(15), JP_Q16(30)}};
/* Legs of 1 m to 2 m that turn to both sides. */
static const struct jp_point short_targets[] = {
    {JP_Q16(1.2), JP_Q16(0.4)}, {JP_Q16(2.0), JP_Q16(1.6)}, {JP_Q16(3.9), JP_Q16(1.4)}, {JP_Q16(4.4), JP_Q16(2.6)},
    {JP_Q16(3.2), JP_Q16(3.1)}, {JP_Q16(3.6), JP_Q16(4.5)}, {JP_Q16(5.3), JP_Q16(4.6)}, {JP_Q16(6.0), JP_Q16(3.2)}};

static struct jp_energy_model model;
static struct jp_horizon horizon;
static struct jp_segment_limits limits;
static struct jp_route_config config;
static struct jp_route_leg legs[LEGS];
static struct jp_route route;
static struct jp_point start;
static jp_angle heading;
static struct jp_energy_start before;
static unsigned slices;

void setUp(void)
{
    model = jp_energy_model_published;
    horizon = jp_horizon_gao2018;
    limits = paper_limits;
    config = (struct jp_route_config){.model = &model, .limits = &limits, .legs = legs, .leg_count = LEGS};
    start = origin;
    heading = 0;
    before = (struct jp_energy_start){{0, 0}, {{0}, {0}}};
}

void tearDown(void)
{
}

static void use_horizon(void)
{
    model = jp_energy_model_gao2018;
    config.horizon = &horizon;
}

static enum jp_status plan(const struct jp_point *targets, uint16_t count)
{
    const char *field;
    enum jp_status status;

    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_route_init(&route, &config, &field));
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_route_start(&route, &start, heading, &before, targets, count));
    slices = 0;
    do {
        status = jp_route_work(&route);
        slices++;
    } while (status == JP_WORKING);
    return status;
}

static int32_t magnitude(int32_t a)
{
    return a < 0 ? -a : a;
}

static jp_q16 least_duration(void)
{
    const jp_q16 least = config.horizon ? config.horizon->duration_min : model.settling_time;

    return least < JP_SEGMENT_DURATION_MIN ? JP_SEGMENT_DURATION_MIN : least;
}

static void expect_limits_met(const struct jp_segment *segment)
{
    const struct jp_segment_command *command = &segment->command;

    TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, command->motion.speed);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(limits.speed, command->motion.speed);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(limits.turn_rate, magnitude(command->motion.turn_rate));
    TEST_ASSERT_LESS_OR_EQUAL_INT32(limits.turn, magnitude(command->turn));
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(least_duration(), command->duration);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(limits.duration, command->duration);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(JP_ARC_ANGLE_MAX, magnitude(segment->arc));
}

/* What is stored of a segment agrees with itself: v T = L and w T = γ. */
static void expect_consistent(const struct jp_segment *segment)
{
    const struct jp_segment_command *command = &segment->command;
    const int32_t seconds = command->duration >> 16;

    TEST_ASSERT_INT32_WITHIN(4 + seconds, segment->length,
                             jp_multiply_shift(command->motion.speed, command->duration, 24));
    TEST_ASSERT_INT32_WITHIN(400 + seconds, segment->arc,
                             jp_multiply_shift(command->motion.turn_rate, command->duration, 16));
}

/* Limits, landings and energies of the whole plan; `within` metres of each target. */
static void expect_plan(const struct jp_point *targets, jp_q16 within)
{
    struct jp_energy_start motion = before;
    struct jp_point from = start;
    jp_angle direction = heading;
    jp_q16 total = 0;

    for (unsigned k = 0; k < route.length; k++) {
        const struct jp_segment *segment = &legs[k].segment;
        struct jp_point end;
        jp_q16 energy;

        expect_limits_met(segment);
        expect_consistent(segment);
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_segment_end(segment, &from, direction, &end, &direction));
        TEST_ASSERT_INT32_WITHIN(within, targets[k].x, end.x);
        TEST_ASSERT_INT32_WITHIN(within, targets[k].y, end.y);
        TEST_ASSERT_EQUAL_INT32(
            JP_OK, jp_energy_forecast(&model, config.horizon, &motion, &segment->command, &energy, &motion));
        TEST_ASSERT_EQUAL_INT32(energy, segment->energy);
        total = jp_add(total, energy);
        from = targets[k];
    }
    TEST_ASSERT_EQUAL_INT32(total, route.energy);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(route.greedy_energy, route.energy);
}

static void expect_greedy(void)
{
    TEST_ASSERT_EQUAL_INT32(route.greedy_energy, route.energy);
    for (unsigned k = 0; k < route.length; k++) {
        TEST_ASSERT_EQUAL_MEMORY(&legs[k].internal.greedy, &legs[k].segment, sizeof legs[k].segment);
    }
}

/* ---- Arguments and statuses ---- */

/* The configuration is refused for `expected`, or taken when that is null. */
static void expect_config(const char *expected)
{
    const char *field = "none";

    if (expected == NULL) {
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_route_init(&route, &config, &field));
        TEST_ASSERT_NULL(field);
    } else {
        TEST_ASSERT_EQUAL_INT32(JP_ERR_CONFIG, jp_route_init(&route, &config, &field));
        TEST_ASSERT_EQUAL_STRING(expected, field);
    }
}

#define EXPECT_FIELD(member, value, expected)                                                                          \
    do {                                                                                                               \
        const struct jp_route_config good = config;                                                                    \
        config.member = (value);                                                                                       \
        expect_config(expected);                                                                                       \
        config = good;                                                                                                 \
    } while (0)

static void test_configuration_out_of_range(void)
{
    EXPECT_FIELD(model, NULL, "model");
    EXPECT_FIELD(limits, NULL, "limits");
    EXPECT_FIELD(legs, NULL, "legs");
    EXPECT_FIELD(leg_count, 0, "leg_count");
    EXPECT_FIELD(leg_count, JP_ROUTE_LEGS_MAX + 1, "leg_count");
    EXPECT_FIELD(leg_count, JP_ROUTE_LEGS_MAX, NULL);
    EXPECT_FIELD(yaw_bandwidth, JP_Q16(-5), "yaw_bandwidth");
    EXPECT_FIELD(yaw_bandwidth, 1, "yaw_bandwidth");
    EXPECT_FIELD(yaw_bandwidth, JP_Q16(0.1) - 1, "yaw_bandwidth");
    EXPECT_FIELD(yaw_bandwidth, JP_Q16(0.1), NULL);
    EXPECT_FIELD(yaw_bandwidth, JP_Q16(100), NULL);
    EXPECT_FIELD(yaw_bandwidth, JP_Q16(100) + 1, "yaw_bandwidth");
}

static void test_bad_arguments(void)
{
    const char *field;

    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_route_init(NULL, &config, &field));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_route_init(&route, NULL, &field));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_route_init(&route, &config, NULL));
    expect_config(NULL);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_route_start(NULL, &start, 0, &before, paper_targets, 4));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_route_start(&route, NULL, 0, &before, paper_targets, 4));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_route_start(&route, &start, 0, NULL, paper_targets, 4));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_route_start(&route, &start, 0, &before, NULL, 4));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_route_start(&route, &start, 0, &before, paper_targets, 0));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, jp_route_work(&route));
}

static void test_zero_length(void)
{
    const struct jp_point targets[] = {{JP_Q16(2), 0}, {JP_Q16(2), 0}, {JP_Q16(4), 0}};

    TEST_ASSERT_EQUAL_INT32(JP_ERR_ZERO_LENGTH, plan(targets, 3));
    TEST_ASSERT_EQUAL_INT32(1, route.planned);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ZERO_LENGTH, jp_route_work(&route));
}

static void test_target_too_far(void)
{
    const struct jp_point targets[] = {{JP_Q16(2), 0}, {JP_Q16(600), 0}};

    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, plan(targets, 2));
    TEST_ASSERT_EQUAL_INT32(1, route.planned);
}

static void test_infeasible_turn(void)
{
    const struct jp_point targets[] = {{JP_Q16(2), 0}, {JP_Q16(4), 0}, {JP_Q16(3), JP_Q16(0.001)}};

    limits.turn = JP_Q24(0.2);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_INFEASIBLE, plan(targets, 3));
    TEST_ASSERT_EQUAL_INT32(2, route.planned);
}

static void test_infeasible_duration(void)
{
    limits.duration = JP_Q16(9);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_INFEASIBLE, plan(paper_targets, 4));
    TEST_ASSERT_EQUAL_INT32(0, route.planned);
}

static void test_unphysical_model(void)
{
    model.a[0] = JP_Q16(-4096);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_MODEL, plan(paper_targets, 4));
}

static void test_energy_beyond_its_format(void)
{
    const struct jp_point targets[] = {{JP_Q16(500), 0}, {JP_Q16(1000), 0}};

    model.b[0] = JP_Q16(4096);
    limits.duration = JP_Q16(1100);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, plan(targets, 2));
}

/* A sum that exceeds its format is saturated: no plan is better. */
static void test_saturated_sum_is_greedy(void)
{
    const struct jp_point targets[] = {{JP_Q16(500), 0}, {JP_Q16(1000), 0}, {JP_Q16(1500), 0}, {JP_Q16(2000), 0}};

    model.b[0] = JP_Q16(100);
    limits.duration = JP_Q16(2000);
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(targets, 4));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, route.energy);
    expect_greedy();
}

static void test_start_out_of_range(void)
{
    before.motion.speed = JP_Q24(8) + 1;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, plan(paper_targets, 4));
    setUp();
    use_horizon();
    before.transient.yaw[0] = JP_Q16(4096) + 1;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, plan(paper_targets, 4));
    TEST_ASSERT_EQUAL_INT32(4, route.planned);
}

/* ---- Slices ---- */

static void test_slices(void)
{
    for (uint16_t count = 1; count <= 8U; count++) {
        TEST_ASSERT_EQUAL_INT32(JP_OK, plan(short_targets, count));
        TEST_ASSERT_EQUAL_INT32(count + JP_ROUTE_ITERATIONS + 1, slices);
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_route_work(&route));
    }
}

static void test_a_plan_can_be_begun_again(void)
{
    struct jp_segment first[4];

    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(paper_targets, 4));
    for (unsigned k = 0; k < 4U; k++) {
        first[k] = legs[k].segment;
    }
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_route_start(&route, &start, heading, &before, short_targets, 8));
    for (unsigned i = 0; i < 12U; i++) {
        TEST_ASSERT_EQUAL_INT32(JP_WORKING, jp_route_work(&route));
    }
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_route_start(&route, &start, heading, &before, paper_targets, 4));
    while (jp_route_work(&route) == JP_WORKING) {
    }
    for (unsigned k = 0; k < 4U; k++) {
        TEST_ASSERT_EQUAL_MEMORY(&first[k], &legs[k].segment, sizeof first[k]);
    }
}

static void test_fewer_legs_than_targets(void)
{
    jp_q16 whole;

    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(short_targets, 3));
    whole = route.energy;
    config.leg_count = 3;
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(short_targets, 8));
    TEST_ASSERT_EQUAL_INT32(3, route.length);
    TEST_ASSERT_EQUAL_INT32(whole, route.energy);
    expect_plan(short_targets, MILLIMETRE);
}

/* ---- Energy ---- */

/* Joint optimum 1110.262 J by scipy, from 60 starts. */
static void test_the_papers_four_segments(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(paper_targets, 4));
    expect_plan(paper_targets, MILLIMETRE);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.02), JP_Q16(1114.21), route.greedy_energy);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), JP_Q16(1110.262), route.energy);
}

/* With the steady voltages that its b implies the paper's model has its optimum at 1110.12 J. */
static void test_the_papers_four_segments_with_effective_voltages(void)
{
    model.voltage_per_speed = JP_Q16(8.34723);
    model.voltage_per_turn_rate = JP_Q16(1.76377);
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(paper_targets, 4));
    expect_plan(paper_targets, MILLIMETRE);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), JP_Q16(1110.12), route.energy);
}

/* Of one leg the greedy plan is the optimum. */
static void test_a_single_leg(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(paper_targets, 1));
    expect_plan(paper_targets, MILLIMETRE);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.02), route.greedy_energy, route.energy);
}

static void test_start_in_motion(void)
{
    start = (struct jp_point){JP_Q16(-1), JP_Q16(0.5)};
    heading = JP_ANGLE_DEGREES(40);
    before.motion = (struct jp_motion){JP_Q24(0.6), JP_Q24(-0.2)};
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(paper_targets, 4));
    expect_plan(paper_targets, MILLIMETRE);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(route.greedy_energy - JP_Q16(0.5), route.energy);
}

/* Without a settling time to wait for, the greedy plan's segments of 1 m to 2 m are far too slow. */
static void test_short_segments_with_horizon(void)
{
    use_horizon();
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(short_targets, 8));
    expect_plan(short_targets, MILLIMETRE);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(route.greedy_energy - route.greedy_energy / 8, route.energy);
    TEST_ASSERT_LESS_THAN_INT32(model.settling_time, legs[3].segment.command.duration);
}

static void test_start_in_motion_with_transients(void)
{
    use_horizon();
    before.motion = (struct jp_motion){JP_Q24(0.5), JP_Q24(0.1)};
    before.transient.travel[0] = JP_Q16(-3);
    before.transient.travel[1] = JP_Q16(2);
    before.transient.travel[2] = JP_Q16(1.5);
    before.transient.yaw[0] = JP_Q16(0.7);
    before.transient.yaw[1] = JP_Q16(-0.4);
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(short_targets, 8));
    expect_plan(short_targets, MILLIMETRE);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(route.greedy_energy - route.greedy_energy / 8, route.energy);
}

/* Transients of segments of 20 s are gone: the settled plan is the best. */
static void test_long_segments_with_horizon(void)
{
    jp_q16 settled;

    model = jp_energy_model_gao2018;
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(paper_targets, 4));
    settled = route.energy;
    use_horizon();
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(paper_targets, 4));
    expect_plan(paper_targets, MILLIMETRE);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.5), settled, route.energy);
}

/* ---- Limits ---- */

/* Without turns on the spot the arcs alone lead from target to target: there is one plan. */
static void test_no_turn_allowed(void)
{
    const struct jp_point targets[] = {
        {JP_Q16(3), JP_Q16(1)}, {JP_Q16(6), JP_Q16(3.5)}, {JP_Q16(9), JP_Q16(4)}, {JP_Q16(12), JP_Q16(4.5)}};

    limits.turn = 0;
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(targets, 4));
    expect_plan(targets, 2 * MILLIMETRE);
    for (unsigned k = 0; k < 4U; k++) {
        TEST_ASSERT_EQUAL_INT32(0, legs[k].segment.command.turn);
        TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), legs[k].internal.greedy.arc, legs[k].segment.arc);
    }
}

static void test_half_a_turn_allowed(void)
{
    const struct jp_point targets[] = {{JP_Q16(-4), JP_Q16(0.5)}, {JP_Q16(2), JP_Q16(1)}, {JP_Q16(-5), JP_Q16(-1)}};

    limits.turn = PI;
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(targets, 3));
    expect_plan(targets, MILLIMETRE);
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(JP_Q24(1.4), magnitude(legs[0].segment.command.turn));
}

static void test_each_limit_binds(void)
{
    limits.speed = JP_Q24(0.1);
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(short_targets, 8));
    expect_plan(short_targets, MILLIMETRE);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), limits.speed, legs[2].segment.command.motion.speed);

    limits = paper_limits;
    limits.turn_rate = JP_Q24(0.02);
    limits.turn = JP_Q24(0.7);
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(paper_targets, 4));
    expect_plan(paper_targets, MILLIMETRE);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), limits.turn_rate, magnitude(legs[3].segment.command.motion.turn_rate));
}

/* Segments of the paper's model last at least Ts, however short their way. */
static void test_shortest_duration_binds(void)
{
    const struct jp_point targets[] = {{JP_Q16(0.3), 0}, {JP_Q16(0.6), JP_Q16(0.1)}, {JP_Q16(1), 0}};

    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(targets, 3));
    expect_plan(targets, MILLIMETRE);
    for (unsigned k = 0; k < 3U; k++) {
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), model.settling_time, legs[k].segment.command.duration);
    }
}

/* At the longest duration the greedy plan stays. */
static void test_longest_duration_binds(void)
{
    limits.duration = JP_Q16(16);
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(paper_targets, 4));
    expect_plan(paper_targets, MILLIMETRE);
    expect_greedy();
    TEST_ASSERT_EQUAL_INT32(limits.duration, legs[0].segment.command.duration);
}

static void test_shortest_and_longest_legs(void)
{
    const struct jp_point targets[] = {{JP_SEGMENT_LENGTH_MAX, 0},
                                       {JP_SEGMENT_LENGTH_MAX, JP_SEGMENT_LENGTH_MIN},
                                       {JP_SEGMENT_LENGTH_MAX, JP_SEGMENT_LENGTH_MAX},
                                       {JP_SEGMENT_LENGTH_MAX - 80, JP_SEGMENT_LENGTH_MAX}};

    limits.duration = JP_Q16(16384);
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(targets, 4));
    expect_plan(targets, 8 * MILLIMETRE);
}

/* Targets behind that small turns reach only by the longest arcs: where the joint plan would need a longer one, the
 * greedy plan stays. */
static void test_longest_arcs(void)
{
    static const struct {
        jp_q24 turn;
        struct jp_point targets[3];
    } examples[] = {
        {JP_Q24(0.42), {{JP_Q16(3.00), JP_Q16(2.31)}, {JP_Q16(-4.92), JP_Q16(-3.00)}, {JP_Q16(-5.26), JP_Q16(-2.72)}}},
        {JP_Q24(0.35), {{JP_Q16(0.57), JP_Q16(0.83)}, {JP_Q16(1.67), JP_Q16(-5.46)}, {JP_Q16(1.38), JP_Q16(-6.08)}}},
        {JP_Q24(0.43), {{JP_Q16(7.83), JP_Q16(4.12)}, {JP_Q16(3.55), JP_Q16(1.20)}, {JP_Q16(3.15), JP_Q16(1.17)}}},
        {JP_Q24(0.35), {{JP_Q16(0.39), JP_Q16(0.64)}, {JP_Q16(-0.20), JP_Q16(-5.51)}, {JP_Q16(-0.56), JP_Q16(-5.75)}}},
        {JP_Q24(0.11), {{JP_Q16(0.65), JP_Q16(1.17)}, {JP_Q16(1.31), JP_Q16(-8.62)}, {JP_Q16(0.54), JP_Q16(-9.57)}}},
        {JP_Q24(0.19), {{JP_Q16(2.86), JP_Q16(-0.71)}, {JP_Q16(-2.22), JP_Q16(-1.36)}, {JP_Q16(-2.42), JP_Q16(-1.69)}}},
        {JP_Q24(0.25), {{JP_Q16(-0.23), JP_Q16(0.22)}, {JP_Q16(0.34), JP_Q16(1.32)}, {JP_Q16(0.64), JP_Q16(1.46)}}},
        {JP_Q24(0.11), {{JP_Q16(0.02), JP_Q16(-0.31)}, {JP_Q16(1.83), JP_Q16(1.60)}, {JP_Q16(1.71), JP_Q16(2.15)}}},
    };

    for (size_t i = 0; i < sizeof examples / sizeof examples[0]; i++) {
        limits.turn = examples[i].turn;
        TEST_ASSERT_EQUAL_INT32(JP_OK, plan(examples[i].targets, 3));
        expect_plan(examples[i].targets, MILLIMETRE);
    }
}

/* A model whose energy falls with the speed has no curvature to go by. */
static void test_model_without_curvature(void)
{
    const struct jp_point targets[] = {{JP_Q16(50), 0}, {JP_Q16(90), JP_Q16(10)}, {JP_Q16(130), 0}};

    model.a[0] = JP_Q16(-20);
    model.b[0] = JP_Q16(1);
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(targets, 3));
    expect_plan(targets, 2 * MILLIMETRE);
}

/* A horizon whose transients give more energy than the segments take, which no robot has. */
static void test_unphysical_horizon(void)
{
    use_horizon();
    before.motion.speed = JP_Q24(0.2);
    before.transient.travel[0] = JP_Q16(40);
    horizon.travel.storage[0] = INT32_MIN;
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(short_targets, 8));
    TEST_ASSERT_LESS_THAN_INT32(0, route.greedy_energy);
    expect_plan(short_targets, MILLIMETRE);
}

/* The greedy plan's segments last Ts; a horizon that asks for more is refused. */
static void test_horizon_longer_than_the_settling_time(void)
{
    use_horizon();
    horizon.duration_min = JP_Q16(30);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, plan(short_targets, 8));
}

/* ---- Turns that lag ---- */

/* Each arc begins where the robot comes out of its turn. */
static void test_turns_lag(void)
{
    jp_angle direction = 0;
    jp_q24 speed = 0;

    config.yaw_bandwidth = JP_Q16(4);
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(paper_targets, 4));
    TEST_ASSERT_LESS_THAN_INT32(route.greedy_energy, route.energy);
    for (unsigned k = 0; k < 4U; k++) {
        const struct jp_segment *segment = &legs[k].segment;
        const struct jp_point *from = k > 0U ? &paper_targets[k - 1U] : &start;
        struct jp_point point =
            jp_segment_turning_point(config.yaw_bandwidth, speed, from, direction, segment->command.turn);

        expect_limits_met(segment);
        expect_consistent(segment);
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_segment_end(segment, &point, direction, &point, &direction));
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.02), paper_targets[k].x, point.x);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.02), paper_targets[k].y, point.y);
        speed = segment->command.motion.speed;
    }
}

static void test_turn_away_from_the_longest_leg(void)
{
    const struct jp_point targets[] = {{JP_Q16(5), 0}, {JP_Q16(5), JP_SEGMENT_LENGTH_MAX}};

    limits.duration = JP_Q16(3000);
    TEST_ASSERT_EQUAL_INT32(JP_OK, plan(targets, 2));
    config.yaw_bandwidth = JP_Q16(0.1);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, plan(targets, 2));
    TEST_ASSERT_EQUAL_INT32(1, route.planned);
}
