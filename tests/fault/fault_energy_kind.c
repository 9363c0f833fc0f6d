/* Which energy is meant: names, the models of the robots, a robot without a model of the battery's energy. */
#include <joulepath/tables.h>

#include "sim/missions/mission.h"
#include "tests/support/captured.h"
#include "unity.h"

static const struct robot_entry *courier;

void setUp(void)
{
    courier = rig_find_robot("courier24");
    TEST_ASSERT_NOT_NULL(courier);
}

void tearDown(void)
{
}

/* The model, and what was said on stderr. */
static const struct jp_energy_model *model_of(const struct scenario *scenario, const struct robot_entry *entry)
{
    capture_begin();
    const struct jp_energy_model *model = mission_model(scenario, entry);
    capture_end();
    return model;
}

static void test_names(void)
{
    enum energy_kind kind = ENERGY_MOTOR;

    TEST_ASSERT_TRUE(energy_kind_parse("battery", &kind));
    TEST_ASSERT_EQUAL_INT(ENERGY_BATTERY, kind);
    TEST_ASSERT_EQUAL_STRING("battery", energy_kind_name(kind));
    TEST_ASSERT_TRUE(energy_kind_parse("motor", &kind));
    TEST_ASSERT_EQUAL_INT(ENERGY_MOTOR, kind);
    TEST_ASSERT_EQUAL_STRING("motor", energy_kind_name(kind));
}

static void test_other_names_are_none(void)
{
    static const char *const others[] = {"", "Motor", "motors", "batter", "heat", "battery "};
    enum energy_kind kind = ENERGY_BATTERY;

    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        TEST_ASSERT_FALSE_MESSAGE(energy_kind_parse(others[i], &kind), others[i]);
    }
    TEST_ASSERT_EQUAL_INT(ENERGY_BATTERY, kind);
}

static void test_each_robot_has_both_models(void)
{
    const struct scenario motor = {.energy = ENERGY_MOTOR};
    const struct scenario battery = {.energy = ENERGY_BATTERY};

    TEST_ASSERT_TRUE(robot_count >= 2);
    for (size_t i = 0; i < robot_count; i++) {
        TEST_ASSERT_EQUAL_PTR(robots[i].energy, model_of(&motor, &robots[i]));
        TEST_ASSERT_EQUAL_PTR(robots[i].energy_battery, model_of(&battery, &robots[i]));
        TEST_ASSERT_NOT_NULL(robots[i].energy_battery);
        TEST_ASSERT_TRUE(robots[i].energy_battery != robots[i].energy);
        TEST_ASSERT_EQUAL_STRING("", errors);
    }
    TEST_ASSERT_NULL(robots[robot_count].energy_battery);
}

static void test_models_are_in_range(void)
{
    for (size_t i = 0; i < robot_count; i++) {
        const struct jp_energy_model *model = robots[i].energy_battery;
        const char *field = "";

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_energy_model_check(model, &field));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_segment_limits_check(&robots[i].config->limits, model, &field));
    }
}

/* The steady power of the voltages before a segment is that of the speed before it. */
static void test_effective_voltages_are_those_of_the_steady_power(void)
{
    for (size_t i = 0; i < robot_count; i++) {
        const struct jp_energy_model *model = robots[i].energy_battery;
        const double resistance = model->motor_resistance / 65536.0;
        const double per_speed = model->voltage_per_speed / 65536.0;
        const double per_turn_rate = model->voltage_per_turn_rate / 65536.0;
        const double settling = model->settling_time / 65536.0;

        TEST_ASSERT_DOUBLE_WITHIN(1e-3, model->b[0] / 65536.0, 2 * per_speed * per_speed / resistance);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, model->b[1] / 65536.0, 2 * per_turn_rate * per_turn_rate / resistance);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * settling, settling, model->a[12] / 65536.0);
    }
}

static void test_published_model_is_that_of_the_motors(void)
{
    const struct scenario scenario = {.model = SCENARIO_PUBLISHED};

    TEST_ASSERT_EQUAL_PTR(&jp_energy_model_published, model_of(&scenario, courier));
}

static void test_robot_without_a_model_of_the_battery(void)
{
    const struct robot_entry young = {.name = "young", .energy = courier->energy};
    const struct scenario motor = {.energy = ENERGY_MOTOR};
    const struct scenario battery = {.energy = ENERGY_BATTERY};

    TEST_ASSERT_EQUAL_PTR(courier->energy, model_of(&motor, &young));
    TEST_ASSERT_NULL(model_of(&battery, &young));
    TEST_ASSERT_EQUAL_STRING("young: no model of the battery's energy; run make identify ROBOT=young\n", errors);
}
