/*
 * sim/four_wheel/patrol_config.h: the tables for firmware are what the simulator drives with, member by member;
 * conversions against an oracle of their own; what the plain method leaves out.
 *
 * prop_patrol_config [--count N] [--seed S]
 * --count is the number of robots by chance.
 */
#include <joulepath/tables.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sim/four_wheel/patrol_config.h"
#include "sim/four_wheel/patrol_members.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "unity.h"

#define ROBOT   "sim/robots/patrol.cfg"
#define SPEEDS  200 /* that are tried */
#define DEGREES (180 / 3.14159265358979323846)

static struct options options = {.count = 2000, .seed = 1};
static struct four_wheel_file robot;

void setUp(void)
{
    begin_random(options.seed, 0);
    TEST_ASSERT_TRUE(four_wheel_file_load(ROBOT, &robot));
}

void tearDown(void)
{
}

/* ---- Tables ---- */

static void check_equal(const void *expected, const void *actual, const struct patrol_member *members,
                        size_t members_count)
{
    for (size_t i = 0; i < members_count; i++) {
        const char *const a = (const char *)expected + members[i].offset;
        const char *const b = (const char *)actual + members[i].offset;

        TEST_ASSERT_EQUAL_INT_MESSAGE(0, memcmp(a, b, members[i].size), members[i].key);
    }
}

static void test_tables_are_what_the_simulator_drives_with(void)
{
    const struct jp_patrol_config patrol = patrol_config(&robot, PATROL_IMPROVED);
    const struct jp_pure_pursuit_config pursuit = patrol_pursuit_config(&robot);

    check_equal(&patrol, &jp_patrol_config_patrol, patrol_members, patrol_member_count);
    check_equal(&pursuit, &jp_pure_pursuit_config_patrol, patrol_pursuit_members, patrol_pursuit_member_count);
}

/* Between the members there is only what their alignment, which is their size, leaves. */
static void check_complete(const struct patrol_member *members, size_t members_count, size_t size)
{
    size_t end = 0;

    for (size_t i = 0; i < members_count; i++) {
        const size_t alignment = members[i].size;

        TEST_ASSERT_EQUAL_UINT_MESSAGE((end + alignment - 1) / alignment * alignment, members[i].offset,
                                       members[i].key);
        end = members[i].offset + members[i].size;
    }
    TEST_ASSERT_EQUAL_UINT((end + sizeof(float) - 1) / sizeof(float) * sizeof(float), size);
}

static void test_no_member_is_left_out(void)
{
    check_complete(patrol_members, patrol_member_count, sizeof(struct jp_patrol_config));
    check_complete(patrol_pursuit_members, patrol_pursuit_member_count, sizeof(struct jp_pure_pursuit_config));
}

/* ---- Conversions ---- */

/** A number of the robot's file and the member that it becomes. */
struct link {
    const char *member;
    const char *field;
    double factor;
};

static const struct link patrol_links[] = {
    {"wheels.wheelbase", "body.wheelbase_m", 1},
    {"wheels.track", "body.track_m", 1},
    {"wheels.steering_limit", "steering.limit_deg", 1.0 / 360},
    {"wheels.steering_step", "steering.rate_rad_s", DEGREES / 360 / FOUR_WHEEL_RATE_HZ},
    {"wheels.speed_max", "drive.speed_m_s", 1},
    {"wheels.speed_step", "drive.acceleration_m_s2", 1.0 / FOUR_WHEEL_RATE_HZ},
    {"teb.reverse_max", "band.reverse_m_s", 1},
    {"teb.turn_rate_max", "band.turn_rate_rad_s", 1},
    {"teb.acceleration", "band.acceleration_m_s2", 1},
    {"teb.turn_acceleration", "band.turn_acceleration_rad_s2", 1},
    {"teb.radius_min", "steering.radius_min_m", 1},
    {"teb.footprint.front", "body.length_m", 0.5},
    {"teb.footprint.rear", "body.length_m", 0.5},
    {"teb.footprint.half_width", "body.width_m", 0.5},
    {"teb.clearance", "band.clearance_m", 1},
    {"teb.interval", "band.interval_s", 1},
    {"teb.hysteresis", "band.hysteresis_s", 1},
    {"teb.rounds", "band.rounds", 1},
    {"teb.steps", "band.steps", 1},
    {"teb.weights.nonholonomic", "weights.nonholonomic_per_m2", 1},
    {"teb.weights.speed", "weights.speed_s2_per_m2", 1},
    {"teb.weights.turn_rate", "weights.turn_rate_s2_per_rad2", 1},
    {"teb.weights.turn_radius", "weights.turn_radius_s2_per_m2", 1},
    {"teb.weights.acceleration", "weights.acceleration_s4_per_m2", 1},
    {"teb.weights.turn_acceleration", "weights.turn_acceleration_s4_per_rad2", 1},
    {"teb.weights.obstacle", "weights.obstacle_per_m2", 1},
    {"teb.weights.path", "weights.path_per_m2", 1},
    {"teb.weights.no_reversing", "weights.no_reversing_s2_per_m2", 1},
    {"teb.weights.wheel_odometry", "weights.wheel_odometry_per_m2", 1},
    {"teb.weights.laser_odometry", "weights.laser_odometry_per_m2", 1},
    {"scan.range_max", "scan.range_m", 1},
    {"scan.gap", "scan.gap_m", 1},
    {"scan.tolerance", "scan.tolerance_m", 1},
    {"scan.beams_min", "scan.beams_min", 1},
    {"movers.extent", "movers.extent_m", 1},
    {"movers.range", "movers.range_m", 1},
    {"movers.speed_min", "movers.speed_min_m_s", 1},
    {"movers.speed_max", "movers.speed_max_m_s", 1},
    {"movers.margin", "movers.margin_m", 1},
    {"people.clearance", "people.clearance_m", 1},
    {"people.braking", "drive.acceleration_m_s2", 1},
    {"people.acceleration", "people.acceleration_m_s2", 1},
    {"people.rest", "people.rest_s", 1},
    {"people.stays", "people.stays_s", 1},
    {"price.worth", "turning.second_w", 1},
    {"glide_clearance", "turning.glide_clearance_m", 1},
    {"turn_first", "turning.from_deg", 1 / DEGREES},
    {"turn_rate", "turning.rate_rad_s", 1},
    {"turn_acceleration", "turning.acceleration_rad_s2", 1},
    {"steering_rate", "steering.rate_rad_s", 1},
    {"turn_clearance", "turning.clearance_m", 1},
    {"step_speed", "turning.step_m_s", 1},
    {"horizon", "patrol.horizon_m", 1},
    {"position_tolerance", "patrol.position_tolerance_m", 1},
    {"heading_tolerance", "patrol.heading_tolerance_deg", 1 / DEGREES},
    {"latency", "patrol.latency_s", 1},
    {"jump", "patrol.jump_m", 1},
    {"waits_max", "patrol.wait_s", PATROL_CYCLE_HZ},
    {"dropouts_max", "patrol.dropouts", 1},
    {"blind_max", "patrol.blind_m", 1},
};

static const struct link pursuit_links[] = {
    {"speed", "pursuit.speed_m_s", 1},
    {"lookahead_time", "pursuit.lookahead_s", 1},
    {"lookahead_min", "pursuit.lookahead_min_m", 1},
    {"lookahead_max", "pursuit.lookahead_max_m", 1},
    {"lateral_acceleration", "pursuit.lateral_acceleration_m_s2", 1},
    {"acceleration", "pursuit.acceleration_m_s2", 1},
    {"tolerance", "pursuit.tolerance_m", 1},
};

#define LENGTH(array) (sizeof(array) / sizeof(array)[0])

static const struct config_field *find_field(const char *key)
{
    for (size_t i = 0; i < four_wheel_kind.field_count; i++) {
        if (strcmp(four_wheel_kind.fields[i].key, key) == 0) {
            return &four_wheel_kind.fields[i];
        }
    }
    TEST_FAIL_MESSAGE(key);
    return NULL;
}

static const struct patrol_member *find_member(const struct patrol_member *members, size_t members_count,
                                               const char *key)
{
    for (size_t i = 0; i < members_count; i++) {
        if (strcmp(members[i].key, key) == 0) {
            return &members[i];
        }
    }
    TEST_FAIL_MESSAGE(key);
    return NULL;
}

static double number_in_file(const char *key)
{
    const struct config_field *const field = find_field(key);
    const char *const place = (const char *)&robot + field->offset;
    int whole;
    double real;

    if (field->type == CONFIG_FIELD_WHOLE) {
        memcpy(&whole, place, sizeof whole);
        return whole;
    }
    memcpy(&real, place, sizeof real);
    return real;
}

/* Half of what the format can tell apart, in the member's unit. */
static double precision(const struct patrol_member *member, double quantity)
{
    static const double steps[PATROL_FORMATS] = {
        [PATROL_Q24] = 1.0 / 16777216, [PATROL_ANGLE] = 1.0 / 4294967296, [PATROL_WHOLE] = 1, [PATROL_FLAG] = 0};
    const double step = member->format == PATROL_FLOAT ? fabs(quantity) / 8388608 : steps[member->format];

    return step / 2 + 1e-12;
}

static void check_links(const void *config, const struct patrol_member *members, size_t members_count,
                        const struct link *links, size_t links_count)
{
    for (size_t i = 0; i < links_count; i++) {
        const struct patrol_member *const member = find_member(members, members_count, links[i].member);
        const double expected = number_in_file(links[i].field) * links[i].factor;
        const double error = fabs(patrol_member_quantity(config, member) - expected);

        TEST_ASSERT_TRUE_MESSAGE(error <= precision(member, expected), links[i].member);
    }
}

/* Of a metre at a steady speed, by the forces on the wheels and the losses of their gears: J, and the price of time. */
static double metre_cost(double speed)
{
    const double drag = 4 * robot.drive.friction_nm_s_per_rad * speed / (robot.wheel.radius_m * robot.wheel.radius_m);
    const double rolling = robot.tyre.rolling * robot.body.mass_kg * 9.81;

    return (rolling + drag) / robot.drive.efficiency + (robot.electronics.power_w + robot.turning.second_w) / speed;
}

/* By a search of all speeds that the band may have. The band's weights are those of the same metre. */
static void check_speed(const struct jp_patrol_config *patrol)
{
    const struct jp_teb_weights *const weights = &patrol->teb.weights;
    const double speed = (double)patrol->teb.speed_max;
    const double cost = metre_cost(speed);
    const double by_weights = (double)weights->second / speed + (double)weights->metre + (double)weights->drag * speed;

    TEST_ASSERT_TRUE(speed <= robot.band.speed_m_s * (1 + 1e-6));
    for (int i = 1; i <= SPEEDS; i++) {
        TEST_ASSERT_TRUE(cost <= metre_cost(robot.band.speed_m_s * i / SPEEDS) * (1 + 1e-5));
    }
    TEST_ASSERT_TRUE(fabs(by_weights - robot.weights.energy_per_j * cost) <= 1e-5 * by_weights);
}

/* Any number within its range: the conversion of each does not depend on others. */
static void change_robot(void)
{
    for (size_t i = 0; i < four_wheel_kind.field_count; i++) {
        const struct config_field *const field = &four_wheel_kind.fields[i];
        const double value = uniform(field->min, field->max);
        const int whole = (int)value;
        char *const place = (char *)&robot + field->offset;

        if (field->type == CONFIG_FIELD_WHOLE) {
            memcpy(place, &whole, sizeof whole);
        } else {
            memcpy(place, &value, sizeof value);
        }
    }
}

static void test_each_number_arrives_to_the_last_bit_of_its_format(void)
{
    for (unsigned long i = 0; i < options.count; i++) {
        change_robot();

        const struct jp_patrol_config patrol = patrol_config(&robot, PATROL_IMPROVED);
        const struct jp_pure_pursuit_config pursuit = patrol_pursuit_config(&robot);
        const double curvature = (double)pursuit.curvature_max / JP_Q24_ONE;

        check_links(&patrol, patrol_members, patrol_member_count, patrol_links, LENGTH(patrol_links));
        check_links(&pursuit, patrol_pursuit_members, patrol_pursuit_member_count, pursuit_links,
                    LENGTH(pursuit_links));
        check_speed(&patrol);
        TEST_ASSERT_TRUE(fabs(curvature - 1 / robot.steering.radius_min_m) < 1e-7);
        TEST_ASSERT_TRUE(patrol.turns_in_place && patrol.period == 1.0f / PATROL_CYCLE_HZ);
    }
}

/* What is left is turns_in_place, the strategy, three prices and as many weights of them, the speed, period and the
 * curvature. */
static void test_every_member_comes_from_somewhere(void)
{
    TEST_ASSERT_EQUAL_UINT(patrol_member_count, LENGTH(patrol_links) + 10);
    TEST_ASSERT_EQUAL_UINT(patrol_pursuit_member_count, LENGTH(pursuit_links) + 1);
}

/* ---- Methods ---- */

/* Of the shipped robot: 25 W and 10 W; wheels 0.333 m off the centre; 1 N·m of scrub through a gear of 0.5 and 1 Ω. */
static void test_prices_are_what_the_file_says(void)
{
    const struct jp_patrol_price price = patrol_config(&robot, PATROL_IMPROVED).price;

    TEST_ASSERT_TRUE(fabs((double)price.second - 35) < 1e-5);
    TEST_ASSERT_TRUE(fabs((double)price.turning - 0.015 * 45 * 9.81 * 0.33302 / 0.8) < 1e-3);
    TEST_ASSERT_TRUE(fabs((double)price.steering - 4 * (2 + 1.0 / 3)) < 1e-3);
}

static void test_the_plain_method_leaves_out_four_things(void)
{
    const struct jp_patrol_config plain = patrol_config(&robot, PATROL_PLAIN);
    struct jp_patrol_config expected = patrol_config(&robot, PATROL_IMPROVED);

    TEST_ASSERT_TRUE(expected.teb.weights.no_reversing > 0 && expected.teb.weights.wheel_odometry > 0 &&
                     expected.teb.weights.laser_odometry > 0);
    expected.turns_in_place = false;
    expected.strategy = (uint8_t)JP_PATROL_FIXED_ANGLE;
    expected.teb.weights.no_reversing = 0;
    expected.teb.weights.wheel_odometry = 0;
    expected.teb.weights.laser_odometry = 0;
    check_equal(&expected, &plain, patrol_members, patrol_member_count);
}

static void test_pure_pursuit_comes_with_the_improved_method(void)
{
    struct jp_patrol_config improved = patrol_config(&robot, PATROL_IMPROVED);
    const struct jp_patrol_config pursuit = patrol_config(&robot, PATROL_PURSUIT);

    improved.strategy = (uint8_t)JP_PATROL_FIXED_ANGLE;
    check_equal(&improved, &pursuit, patrol_members, patrol_member_count);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
