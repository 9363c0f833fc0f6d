/* Every way that a four-wheel robot file can be wrong: one clear line on stderr that names the file and the culprit. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/four_wheel/patrol_config.h"
#include "tests/support/bad_config.h"
#include "unity.h"

static struct four_wheel_file robot;
static struct jp_patrol patrol;
static struct jp_pure_pursuit pursuit;

void setUp(void)
{
}

void tearDown(void)
{
}

static bool load_robot(const char *name)
{
    return four_wheel_file_load(name, &robot);
}

static void write_with_value(const char *key, const char *value)
{
    char line[128];
    (void)snprintf(line, sizeof line, "%s = %s;", strchr(key, '.') + 1, value);
    write_with_line(key, line);
}

/* The sound file with one of its first lines, `name = "patrol";` or the type, replaced. */
static void write_with_head(const char *start_of_line, const char *line)
{
    const char *start = strstr(sound, start_of_line);
    TEST_ASSERT_NOT_NULL_MESSAGE(start, start_of_line);
    write_replaced(sound, start, strchr(start, '\n'), line);
}

static void check_value(double expected, double actual, const char *what)
{
    TEST_ASSERT_TRUE_MESSAGE(fabs(actual - expected) <= 1e-6 * fabs(expected) + 1e-12, what);
}

static void test_shipped_file_loads(void)
{
    TEST_ASSERT_TRUE(load("sim/robots/patrol.cfg"));
    TEST_ASSERT_EQUAL_STRING("", errors);
    TEST_ASSERT_EQUAL_STRING("patrol", robot.name);
    check_value(0.8, robot.body.length_m, "length");
    check_value(0.6, robot.body.width_m, "width");
    check_value(45, robot.body.mass_kg, "mass");
    check_value(100, robot.steering.limit_deg, "steering limit");
    check_value(360, robot.laser.beams, "beams");
    check_value(8, robot.laser.range_m, "range");
    check_value(51200, robot.encoder.wheel_counts_per_turn, "counts");
}

/* What the file says, by a look at its text. */
static double written_value(const char *key)
{
    char name[64];
    (void)snprintf(name, sizeof name, "\n%.*s: {", (int)(strchr(key, '.') - key), key);
    const char *group = strstr(sound, name);
    TEST_ASSERT_NOT_NULL_MESSAGE(group, key);
    (void)snprintf(name, sizeof name, " %s = ", strchr(key, '.') + 1);
    const char *line = strstr(group, name);
    TEST_ASSERT_NOT_NULL_MESSAGE(line, key);
    return strtod(line + strlen(name), NULL);
}

static void test_robots_of_another_type(void)
{
    check_refused("sim/robots/zhang2018.cfg", "skid_steer robot; needs a four_wheel");
    check_refused("sim/robots/gao2018.cfg", "balancer robot (as without a type); needs a four_wheel");
}

static void test_each_field_is_loaded(void)
{
    TEST_ASSERT_TRUE(load("sim/robots/patrol.cfg"));
    for (size_t i = 0; i < four_wheel_kind.field_count; i++) {
        const struct config_field *field = &four_wheel_kind.fields[i];
        check_value(written_value(field->key), config_field_value(&robot, field, 0), field->key);
    }
}

static void test_configuration_of_the_core(void)
{
    TEST_ASSERT_TRUE(load("sim/robots/patrol.cfg"));
    const struct jp_four_wheel_config config = four_wheel_config(&robot);
    check_value(0.5 * JP_Q24_ONE, config.wheelbase, "wheelbase");
    check_value(0.44 * JP_Q24_ONE, config.track, "track");
    check_value(100.0 / 360 * 4294967296.0, config.steering_limit, "steering limit");
    check_value(0.03 / (2 * M_PI) * 4294967296.0, config.steering_step, "steering step");
    check_value(1.5 * JP_Q24_ONE, config.speed_max, "largest speed");
    check_value(0.01 * JP_Q24_ONE, config.speed_step, "speed step");
    const char *field = NULL;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_check(&config, &field));
}

static void test_each_field_missing_or_of_another_type(void)
{
    for (size_t i = 0; i < four_wheel_kind.field_count; i++) {
        const char *key = four_wheel_kind.fields[i].key;
        write_with_line(key, "");
        check_refused(path, key);
        write_with_value(key, "\"text\"");
        check_refused(path, key);
        write_with_value(key, "{ a = 1; }");
        check_refused(path, key);
        write_with_value(key, "true");
        check_refused(path, key);
        write_with_value(key, "[1.0, 2.0]");
        check_refused(path, key);
    }
}

static void test_each_field_outside_its_limits(void)
{
    for (size_t i = 0; i < four_wheel_kind.field_count; i++) {
        const struct config_field *field = &four_wheel_kind.fields[i];
        const double outside[] = {field->min - 0.001 * (field->max - field->min) - 1,
                                  field->max + 0.001 * (field->max - field->min) + 1};
        for (int k = 0; k < 2; k++) {
            char value[64];
            (void)snprintf(value, sizeof value, field->type == CONFIG_FIELD_WHOLE ? "%.0f" : "%f", outside[k]);
            write_with_value(field->key, value);
            check_refused(path, field->key);
        }
        write_with_value(field->key, "1e999");
        check_refused(path, field->key);
        write_with_value(field->key, "-1e999");
        check_refused(path, field->key);
        write_with_value(field->key, "nan");
        check_refused(path, "line ");
        if (field->type == CONFIG_FIELD_WHOLE) {
            write_with_value(field->key, "400.5");
            check_refused(path, field->key);
        }
    }
}

/* The loader leaves nothing for the controllers to find. */
static void check_accepted(const char *key)
{
    for (enum patrol_method method = 0; method < PATROL_METHODS; method++) {
        const struct jp_patrol_config config = patrol_config(&robot, method);
        const char *field = key;
        TEST_ASSERT_EQUAL_INT_MESSAGE(JP_OK, jp_patrol_init(&patrol, &config, &field), field);
    }
    const struct jp_pure_pursuit_config config = patrol_pursuit_config(&robot);
    const char *field = key;
    TEST_ASSERT_EQUAL_INT_MESSAGE(JP_OK, jp_pure_pursuit_init(&pursuit, &config, &field), field);
}

static void test_what_loads_is_good_for_the_controllers(void)
{
    unsigned loaded = 0;
    for (size_t i = 0; i < four_wheel_kind.field_count; i++) {
        const struct config_field *field = &four_wheel_kind.fields[i];
        const double ends[] = {field->min, field->max};
        for (int k = 0; k < 2; k++) {
            char value[64];
            (void)snprintf(value, sizeof value, "%.10g", ends[k]);
            write_with_value(field->key, value);
            if (load(path)) {
                check_accepted(field->key);
                loaded++;
            } else {
                check_refused(path, "correct");
            }
        }
    }
    TEST_ASSERT_TRUE(loaded > four_wheel_kind.field_count);
}

static void test_unknown_keys(void)
{
    write_with_line("wheel.radius_m", "radius_m = 0.1; radius = 0.1;");
    check_refused(path, "wheel.radius (line");
    write_with_line("wheel.radius_m", "radius_m = 0.1; }; wheels: { radius_m = 0.1;");
    check_refused(path, "wheels (line");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(errors, "write wheel\n"), errors);
    write_with_head("name = ", "name = \"patrol\"; colour = 3;");
    check_refused(path, "colour (line");
    write_with_line("wheel.radius_m", "radius_m = 0.1; radius_m = 0.1;");
    check_refused(path, "line ");
    write_with_line("wheel.radius_m", "radius_m = ;");
    check_refused(path, "line ");
}

static void test_name_and_type(void)
{
    static const char *const types[] = {"", "type = 4;", "type = \"skid_steer\";", "type = \"\";"};
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        write_with_head("type = ", types[i]);
        check_refused(path, "type");
    }
    static const char *const names[] = {"",
                                        "name = 4;",
                                        "name = \"\";",
                                        "name = \"a b\";",
                                        "name = \"A\";",
                                        "name = \"abcdefghijklmnopqrstuvwxyz_012345\";"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        write_with_head("name = ", names[i]);
        check_refused(path, "name");
    }
    check_refused("sim/robots/gao2018.cfg", "type");
    check_refused("sim/robots/zhang2018.cfg", "type");
}

static void test_values_that_contradict(void)
{
    write_with_value("body.wheelbase_m", "0.81");
    check_refused(path, "body.wheelbase_m");
    write_with_value("body.track_m", "0.61");
    check_refused(path, "body.track_m");
    write_with_value("steering.limit_deg", "48.6");
    check_refused(path, "steering.limit_deg");
    write_with_value("steering.limit_deg", "48.7");
    TEST_ASSERT_TRUE(load(path));
    write_with_value("drive.torque_nm", "1.0");
    check_refused(path, "drive.torque_nm");
    write_with_value("laser.rate_hz", "30");
    check_refused(path, "laser.rate_hz");
    write_with_value("laser.rate_hz", "12.5");
    TEST_ASSERT_TRUE(load(path));
    write_with_value("tyre.stiffness_n_s_per_m", "5000");
    check_refused(path, "tyre.stiffness_n_s_per_m");
    write_with_value("wheel.inertia_kg_m2", "0.01");
    check_refused(path, "tyre.stiffness_n_s_per_m");
    write_with_value("band.hysteresis_s", "0.08");
    check_refused(path, "band.hysteresis_s");
    write_with_value("band.hysteresis_s", "0.21");
    check_refused(path, "band.hysteresis_s");
    write_with_value("band.hysteresis_s", "0.2");
    TEST_ASSERT_TRUE(load(path));
}

static void test_radius_that_the_wheels_cannot_steer(void)
{
    char text[BAD_FILE_MAX];
    write_with_value("steering.limit_deg", "48.7");
    (void)read_file(path, text, sizeof text);
    TEST_ASSERT_TRUE(load(path));
    memcpy(sound, text, sizeof text);
    write_with_value("steering.radius_min_m", "0.43");
    check_refused(path, "steering.radius_min_m");
    write_with_value("steering.radius_min_m", "0.44");
    TEST_ASSERT_TRUE(load(path));
    (void)read_file("sim/robots/patrol.cfg", sound, sizeof sound);
}

static void test_values_beyond_others(void)
{
    static const struct {
        const char *key;
        const char *value;
        const char *limit;
    } pairs[] = {
        {"scan.range_m", "8.01", "laser.range_m"},
        {"movers.range_m", "8.01", "laser.range_m"},
        {"movers.speed_min_m_s", "2.01", "movers.speed_max_m_s"},
        {"band.speed_m_s", "1.51", "drive.speed_m_s"},
        {"band.reverse_m_s", "1.51", "drive.speed_m_s"},
        {"band.acceleration_m_s2", "1.01", "drive.acceleration_m_s2"},
        {"turning.step_m_s", "1.51", "drive.speed_m_s"},
        {"patrol.heading_tolerance_deg", "30.1", "turning.from_deg"},
        {"pursuit.speed_m_s", "1.51", "drive.speed_m_s"},
        {"pursuit.acceleration_m_s2", "1.01", "drive.acceleration_m_s2"},
        {"pursuit.lookahead_min_m", "2.01", "pursuit.lookahead_max_m"},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        write_with_value(pairs[i].key, pairs[i].value);
        check_refused(path, pairs[i].key);
        TEST_ASSERT_TRUE_MESSAGE(strstr(errors, pairs[i].limit) != NULL, errors);
    }
}

static void test_files_that_are_none(void)
{
    write_file("", 0);
    check_refused(path, "empty");
    write_file("type\0x", 6);
    check_refused(path, "zero bytes");
    check_refused("/nowhere/patrol.cfg", "No such file");
    check_refused(folder, "directory");
    for (size_t cut = 0; cut < strlen(sound); cut += 97) {
        write_file(sound, cut);
        check_refused(path, "");
    }
}

int main(void)
{
    bad_file_begin("robot.cfg", load_robot);
    (void)read_file("sim/robots/patrol.cfg", sound, sizeof sound);
    UNITY_BEGIN();
    run_tests();
    bad_file_end();
    return UNITY_END();
}
