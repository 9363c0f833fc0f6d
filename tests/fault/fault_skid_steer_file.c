/* Every way that the file of a skid-steered or differential-drive robot can be wrong: one clear line on stderr that
 * names the file and the culprit. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/skid_steer/skid_plant.h"
#include "tests/support/bad_config.h"
#include "unity.h"

#define ZHANG  "sim/robots/zhang2018.cfg"
#define BURGER "sim/robots/burger.cfg"

static struct skid_steer_model model;

void setUp(void)
{
    (void)read_file(ZHANG, sound, sizeof sound);
}

void tearDown(void)
{
}

static bool load_robot(const char *name)
{
    return skid_robot_load(name, &model);
}

/* ---- Both kinds ---- */

/* The two files and what reads them. */
static const struct {
    const char *file;
    const struct config_kind *kind;
} kinds[] = {{ZHANG, &skid_steer_kind}, {BURGER, &differential_drive_kind}};

#define KINDS (sizeof kinds / sizeof kinds[0])

static void insert(const char *after, const char *text)
{
    char *place = strstr(sound, after);
    TEST_ASSERT_NOT_NULL_MESSAGE(place, after);
    place += strlen(after);
    TEST_ASSERT_TRUE(strlen(sound) + strlen(text) < sizeof sound);
    memmove(place + strlen(text), place, strlen(place) + 1);
    memcpy(place, text, strlen(text));
}

/* The file with what it may leave out. */
static void read_sound(size_t kind)
{
    (void)read_file(kinds[kind].file, sound, sizeof sound);
    if (kinds[kind].kind == &skid_steer_kind) {
        insert("\nbody: {\n", "    overall_width_m = 0.8;\n    middle_ahead_m = 0.05;\n");
    }
}

static void write_with_value(const char *key, const char *value)
{
    char line[128];
    (void)snprintf(line, sizeof line, "%s = %s;", strchr(key, '.') + 1, value);
    write_with_line(key, line);
}

static void write_with_head(const char *start_of_line, const char *line)
{
    const char *start = strstr(sound, start_of_line);
    TEST_ASSERT_NOT_NULL_MESSAGE(start, start_of_line);
    write_replaced(sound, start, strchr(start, '\n'), line);
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

static void check_value(double expected, double actual, const char *what)
{
    TEST_ASSERT_TRUE_MESSAGE(fabs(actual - expected) <= 1e-9 * fabs(expected) + 1e-15, what);
}

static void test_shipped_files_load(void)
{
    TEST_ASSERT_TRUE(load(ZHANG));
    TEST_ASSERT_EQUAL_STRING("", errors);
    TEST_ASSERT_EQUAL_STRING("zhang2018", model.name);
    check_value(92, model.body.mass_kg, "mass");
    check_value(0.25, model.body.centre_height_m, "height of the centre of mass");
    TEST_ASSERT_EQUAL_INT(2, model.wheel.axles);
    check_value(0, model.caster.ahead_m, "no caster");
    TEST_ASSERT_TRUE(load(BURGER));
    TEST_ASSERT_EQUAL_STRING("", errors);
    TEST_ASSERT_EQUAL_STRING("burger", model.name);
    TEST_ASSERT_EQUAL_INT(1, model.wheel.axles);
    check_value(0, model.body.wheelbase_m, "no wheelbase");
    check_value(-0.081, model.caster.ahead_m, "caster");
    TEST_ASSERT_EQUAL_INT(4096, model.encoder.counts_per_turn);
}

static void test_each_field_is_loaded(void)
{
    for (size_t kind = 0; kind < KINDS; kind++) {
        read_sound(kind);
        write_with_line("wheel.radius_m", kind == 0 ? "radius_m = 0.136;" : "radius_m = 0.033;");
        TEST_ASSERT_TRUE(load(path));
        for (size_t i = 0; i < kinds[kind].kind->field_count; i++) {
            const struct config_field *field = &kinds[kind].kind->fields[i];
            check_value(written_value(field->key), config_field_value(&model, field, 0), field->key);
        }
    }
}

/* No two keys go to the same place. */
static void test_fields_are_apart(void)
{
    for (size_t kind = 0; kind < KINDS; kind++) {
        const struct config_kind *fields = kinds[kind].kind;
        for (size_t i = 0; i < fields->field_count; i++) {
            for (size_t j = 0; j < i; j++) {
                TEST_ASSERT_TRUE_MESSAGE(fields->fields[i].offset != fields->fields[j].offset, fields->fields[i].key);
                TEST_ASSERT_TRUE_MESSAGE(strcmp(fields->fields[i].key, fields->fields[j].key) != 0,
                                         fields->fields[i].key);
            }
        }
    }
}

static void check_without(const struct config_field *field)
{
    write_with_line(field->key, "");
    if (field->is_optional) {
        TEST_ASSERT_TRUE_MESSAGE(load(path), errors);
    } else {
        check_refused(path, field->key);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(errors, "missing"), errors);
    }
}

static void test_an_outline_that_is_left_out(void)
{
    TEST_ASSERT_TRUE(load(ZHANG));
    check_value(0.7, model.body.overall_width_m, "the tracks'");
    check_value(0, model.body.middle_ahead_m, "the axles'");
}

static void test_navigation_that_is_left_out(void)
{
    char *group = strstr(sound, "\nnavigation: {");
    TEST_ASSERT_NOT_NULL(group);
    write_replaced(sound, group, strstr(group, "};") + 2, "\n");
    TEST_ASSERT_TRUE_MESSAGE(load(path), errors);
    TEST_ASSERT_TRUE(isnan(model.navigation.cell_m) && isnan(model.navigation.margin_m));
}

static void test_each_field_missing_or_of_another_type(void)
{
    static const char *const values[] = {"\"text\"", "{ a = 1; }", "true", "[1.0, 2.0]"};

    for (size_t kind = 0; kind < KINDS; kind++) {
        read_sound(kind);
        for (size_t i = 0; i < kinds[kind].kind->field_count; i++) {
            const char *key = kinds[kind].kind->fields[i].key;
            check_without(&kinds[kind].kind->fields[i]);
            for (size_t k = 0; k < sizeof values / sizeof values[0]; k++) {
                write_with_value(key, values[k]);
                check_refused(path, key);
            }
        }
    }
}

static void check_outside(const struct config_field *field, double outside)
{
    char value[64];
    (void)snprintf(value, sizeof value, field->type == CONFIG_FIELD_WHOLE ? "%.0f" : "%f", outside);
    write_with_value(field->key, value);
    check_refused(path, field->key);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(errors, "correct"), errors);
}

static void test_each_field_outside_its_limits(void)
{
    for (size_t kind = 0; kind < KINDS; kind++) {
        read_sound(kind);
        for (size_t i = 0; i < kinds[kind].kind->field_count; i++) {
            const struct config_field *field = &kinds[kind].kind->fields[i];
            const double range = field->max - field->min;
            check_outside(field, field->min - 0.001 * range - 1);
            check_outside(field, field->max + 0.001 * range + 1);
            write_with_value(field->key, "1e999");
            check_refused(path, field->key);
            write_with_value(field->key, "-1e999");
            check_refused(path, field->key);
            write_with_value(field->key, "nan");
            check_refused(path, "line ");
            if (field->type == CONFIG_FIELD_WHOLE) {
                write_with_value(field->key, "10.5");
                check_refused(path, field->key);
            }
        }
    }
}

/* What loads can be simulated: nothing becomes infinite in a second of driving. */
static void check_drives(const char *key)
{
    const struct planar_pose origin = {0, 0, 0};
    const struct skid_ground level = {NULL, NULL};
    const struct skid_input input = {.duty = {0.6, -0.3}, .driven = true};
    struct skid_plant plant;

    skid_plant_init(&plant, &model, &level, &origin);
    TEST_ASSERT_FALSE_MESSAGE(plant.tipped, key);
    for (int tick = 0; tick < 50; tick++) {
        skid_plant_step(&plant, &input, 0.002);
    }
    TEST_ASSERT_TRUE_MESSAGE(isfinite(plant.state.x) && isfinite(plant.state.ledger.battery), key);
    TEST_ASSERT_TRUE_MESSAGE(isfinite(plant.state.sides[SKID_LEFT].rate), key);
    TEST_ASSERT_TRUE_MESSAGE(fabs(plant.state.sides[SKID_LEFT].drag) < 2, key);
}

static void test_what_loads_can_be_simulated(void)
{
    unsigned loaded = 0;

    for (size_t kind = 0; kind < KINDS; kind++) {
        read_sound(kind);
        for (size_t i = 0; i < kinds[kind].kind->field_count; i++) {
            const struct config_field *field = &kinds[kind].kind->fields[i];
            const double ends[] = {field->min, field->max};
            for (int k = 0; k < 2; k++) {
                char value[64];
                (void)snprintf(value, sizeof value, "%.10g", ends[k]);
                write_with_value(field->key, value);
                if (load(path)) {
                    check_drives(field->key);
                    loaded++;
                } else {
                    check_refused(path, "correct");
                }
            }
        }
    }
    TEST_ASSERT_TRUE(loaded > skid_steer_kind.field_count);
}

static void test_unknown_keys(void)
{
    write_with_line("wheel.radius_m", "radius_m = 0.136; radius = 0.1;");
    check_refused(path, "wheel.radius (line");
    write_with_line("wheel.radius_m", "radius_m = 0.136; }; wheels: { radius_m = 0.1;");
    check_refused(path, "wheels (line");
    write_with_head("name = ", "name = \"zhang2018\"; colour = 3;");
    check_refused(path, "colour (line");
    write_with_line("wheel.radius_m", "radius_m = 0.1; radius_m = 0.1;");
    check_refused(path, "line ");
    write_with_line("wheel.radius_m", "radius_m = ;");
    check_refused(path, "line ");
}

/* What one kind has is unknown to the other. */
static void test_keys_of_the_other_kind(void)
{
    write_with_line("wheel.radius_m", "radius_m = 0.136; }; caster: { ahead_m = 0.1; rolling = 0.1; }; more: {");
    check_refused(path, "caster");
    (void)read_file(BURGER, sound, sizeof sound);
    write_with_line("wheel.radius_m", "radius_m = 0.033; axles = 2;");
    check_refused(path, "wheel.axles");
    write_with_line("body.length_m", "length_m = 0.138; wheelbase_m = 0.1;");
    check_refused(path, "body.wheelbase_m");
}

static void test_name_and_type(void)
{
    static const char *const types[] = {"", "type = 4;", "type = \"four_wheel\";", "type = \"\";"};
    static const char *const names[] = {"", "name = 4;", "name = \"\";", "name = \"a b\";", "name = \"A\";"};

    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        write_with_head("type = ", types[i]);
        check_refused(path, "type");
    }
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        write_with_head("name = ", names[i]);
        check_refused(path, "name");
    }
    write_with_head("type = ", "type = \"differential_drive\";");
    check_refused(path, "body.wheelbase_m");
}

static void test_robots_of_another_type(void)
{
    check_refused("sim/robots/patrol.cfg", "four_wheel robot; needs a skid_steer or a differential_drive");
    check_refused("sim/robots/gao2018.cfg", "balancer robot");
    check_refused("no_such_file.cfg", "No such file");
    capture_begin();
    const bool loaded = skid_steer_load(BURGER, &model) || differential_drive_load(ZHANG, &model);
    capture_end();
    TEST_ASSERT_FALSE(loaded);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(errors, "needs a skid_steer"), errors);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(errors, "needs a differential_drive"), errors);
}

/* ---- What no single field shows ---- */

static void check_limit(const char *key, const char *good, const char *bad, const char *culprit)
{
    write_with_value(key, bad);
    check_refused(path, culprit);
    write_with_value(key, good);
    TEST_ASSERT_TRUE_MESSAGE(load(path), errors);
}

static void test_motors_that_are_too_weak(void)
{
    check_limit("motor.gear_ratio", "244.3", "245", "supply.voltage_v");
    check_limit("motor.power_w", "230", "180", "motor.power_w");
    check_limit("lattice.speed_m_s", "1.0", "1.01", "limits.speed_m_s");
}

static void test_batteries_that_cannot_feed_both_motors(void)
{
    check_limit("supply.resistance_ohm", "0.38", "0.39", "supply.resistance_ohm");
    check_limit("motor.current_limit_a", "115", "116", "supply.resistance_ohm");
}

/* 0.25 m between the middle and an axle. */
static void test_robots_that_tip(void)
{
    check_limit("body.centre_height_m", "0.93", "0.94", "limits.slope_deg it tips over");
    check_limit("body.centre_ahead_m", "0.18", "0.26", "level ground it tips over");
    check_limit("body.centre_ahead_m", "-0.18", "-0.26", "level ground it tips over");
    check_limit("body.centre_ahead_m", "0.18", "0.19", "limits.slope_deg it tips over");
    check_limit("body.centre_ahead_m", "-0.18", "-0.19", "limits.slope_deg it tips over");
}

static void test_casters_that_do_not_carry(void)
{
    (void)read_file(BURGER, sound, sizeof sound);
    check_limit("caster.ahead_m", "-0.05", "0", "caster.ahead_m");
    check_limit("caster.ahead_m", "-0.05", "-0.02", "tips over");
    check_limit("caster.ahead_m", "-0.05", "0.05", "tips over");
    check_limit("body.centre_ahead_m", "-0.03", "0.01", "tips over");
}

static void test_robots_that_are_too_fast_to_simulate(void)
{
    check_limit("motor.friction_nm", "1000", "10000", "cannot be simulated");
    check_limit("tyre.damping_s_per_m", "10", "1000", "cannot be simulated");
    write_with_value("body.yaw_inertia_kg_m2", "1e-9");
    check_refused(path, "cannot be simulated");
}

int main(void)
{
    bad_file_begin("robot.cfg", load_robot);

    UNITY_BEGIN();
    run_tests();
    const int failures = UNITY_END();

    bad_file_end();
    return failures;
}
