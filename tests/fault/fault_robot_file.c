/* Every way that a robot file can be wrong: one clear line on stderr that names the file and the culprit, no crash. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "sim/balancer/robot_file.h"
#include "tests/support/bad_config.h"
#include "unity.h"

/* courier24 has none; so it stands before its file. */
static const char specification[] = "\nspecification: {\n    settling_s = 2.0;\n    lean_deg = 5.0;\n"
                                    "    voltage_reserve = 0.2;\n    sensor_delay_s = 0.001;\n};\n";

static struct robot_file robot;

void setUp(void)
{
}

void tearDown(void)
{
}

static bool load_robot(const char *name)
{
    return robot_file_load(name, &robot);
}

static void write_with_value(const struct config_field *field, const char *value)
{
    char line[128];
    const char *name = strchr(field->key, '.') + 1;
    if (field->count == 1) {
        (void)snprintf(line, sizeof line, "%s = %s;", name, value);
    } else {
        const char *others = field->count == 2 ? "" : "1, 2, 3, 4, 5, 6, ";
        (void)snprintf(line, sizeof line, "%s = (%s0, %s);", name, others, value);
    }
    write_with_line(field->key, line);
}

static void test_shipped_files_load(void)
{
    TEST_ASSERT_TRUE(load("sim/robots/gao2018.cfg"));
    TEST_ASSERT_EQUAL_STRING("gao2018", robot.name);
    TEST_ASSERT_TRUE(robot.motor.resistance_ohm == 6.69 && robot.encoder.counts_per_turn == 4194304);
    TEST_ASSERT_TRUE(load("sim/robots/courier24.cfg"));
    TEST_ASSERT_EQUAL_STRING("courier24", robot.name);
    TEST_ASSERT_EQUAL_STRING("", errors);
}

/* A setting that is left out is marked so, the payload follows from the mass; all else must be there. */
static void check_without(const struct config_field *field)
{
    write_with_line(field->key, "");
    if (field->is_optional) {
        TEST_ASSERT_TRUE_MESSAGE(load(path), field->key);
        const bool follows = strcmp(field->key, "limits.payload_kg") == 0;
        for (size_t i = 0; i < field->count; i++) {
            TEST_ASSERT_TRUE_MESSAGE(config_field_is_left_out(&robot, field, i) != follows, field->key);
        }
        TEST_ASSERT_TRUE(robot_file_check(path, &robot));
    } else {
        check_refused(path, field->key);
    }
}

static void test_each_field_missing_or_of_another_type(void)
{
    for (size_t i = 0; i < robot_kind.field_count; i++) {
        const char *key = robot_kind.fields[i].key;
        check_without(&robot_kind.fields[i]);
        write_with_value(&robot_kind.fields[i], "\"text\"");
        check_refused(path, key);
        write_with_value(&robot_kind.fields[i], "{ a = 1; }");
        check_refused(path, key);
        write_with_value(&robot_kind.fields[i], "true");
        check_refused(path, key);
    }
}

static void test_a_payload_is_a_range_that_leaves_a_mass(void)
{
    write_with_line("limits.payload_kg", "");
    TEST_ASSERT_TRUE(load(path));
    TEST_ASSERT_TRUE(robot.limits.payload_kg[0] == -0.075 * 4 && robot.limits.payload_kg[1] == 0.3 * 4);
    write_with_line("limits.payload_kg", "payload_kg = [1.0, 0.5];");
    check_refused(path, "limits.payload_kg");
    write_with_line("limits.payload_kg", "payload_kg = [-3.5, 0.5];");
    check_refused(path, "limits.payload_kg");
    write_with_line("limits.payload_kg", "payload_kg = [-3.4, -3.4];");
    TEST_ASSERT_TRUE(load(path));
}

static void test_each_field_outside_its_limits(void)
{
    for (size_t i = 0; i < robot_kind.field_count; i++) {
        const struct config_field *field = &robot_kind.fields[i];
        const double outside[] = {field->min - 0.001 * (field->max - field->min) - 1.0,
                                  field->max + 0.001 * (field->max - field->min) + 1.0};
        for (int k = 0; k < 2; k++) {
            char value[64];
            (void)snprintf(value, sizeof value, field->type == CONFIG_FIELD_WHOLE ? "%.0f" : "%f", outside[k]);
            write_with_value(field, value);
            check_refused(path, field->key);
        }
        static const char *const unreal[] = {"1e999", "-1e999", "4294967297000000000000.0"};
        for (size_t k = 0; k < sizeof unreal / sizeof unreal[0]; k++) {
            write_with_value(field, unreal[k]);
            check_refused(path, field->key);
        }
        write_with_value(field, "nan");
        check_refused(path, "line ");
        if (field->type == CONFIG_FIELD_WHOLE) {
            write_with_value(field, "12.5");
            check_refused(path, field->key);
        }
    }
}

/* Integers that would wrap into the limits. */
static void test_huge_integers_do_not_wrap(void)
{
    static const char *const huge[] = {"4294986496",           "4294986496L",
                                       "18446744073709570816", "18446744073709570816L",
                                       "0x100004B00",          "99999999999999999999999999999999"};
    for (size_t i = 0; i < sizeof huge / sizeof huge[0]; i++) {
        char line[96];
        (void)snprintf(line, sizeof line, "counts_per_turn = %s;", huge[i]);
        write_with_line("encoder.counts_per_turn", line);
        check_refused(path, "32 bits");
    }
}

static void test_wrong_keys_and_structure(void)
{
    write_with_line("wheel.radius_m", "radius_m = 0.09; radius = 0.09;");
    check_refused(path, "wheel.radius (line");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(errors, "wheel.radius_m"), errors);
    write_with_line("wheel.radius_m", "radius_m = 0.09; radius_m = 0.1;");
    check_refused(path, "line ");
    write_with_line("wheel.radius_m", "radius_m = ;");
    check_refused(path, "line ");
    write_with_line("control.weights", "weights = [1, 2, 3, 4, 5, 6, 7];");
    check_refused(path, "control.weights");
    write_with_line("control.weights", "weights = [1, 2, 3, 4, 5, 6, 7, 8, 9];");
    check_refused(path, "control.weights");
    write_with_line("control.weights", "weights = 3.0;");
    check_refused(path, "control.weights");
    write_with_line("pwm.bits", "bits = 12; }; pwm2: { bits = 12;");
    check_refused(path, "pwm2");

    static const char *const texts[] = {
        "name = \"a b\";", "name = \"\";", "name = 3;", "wheel = 3;", "wheel = \"x\";", "}", "{", "name"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        write_file(texts[i], strlen(texts[i]));
        check_refused(path, "");
    }
    const char *include = "name = \"x\";\n  @include \"/tmp\"\n";
    write_file(include, strlen(include));
    check_refused(path, "line 2");
}

static void test_whole_and_real_numbers_may_be_mixed(void)
{
    write_with_line("control.weights", "weights = [1, 2.5, 3, 4, 5, 6, 7, 8]; // [9]");
    TEST_ASSERT_TRUE_MESSAGE(load(path), errors);
    TEST_ASSERT_TRUE(robot.control.weights[0] == 1 && robot.control.weights[1] == 2.5);
}

static void test_robots_of_another_type(void)
{
    check_refused("sim/robots/zhang2018.cfg", "skid_steer robot; needs a balancer");
    check_refused("sim/robots/patrol.cfg", "four_wheel robot; needs a balancer");
    write_with_line("pwm.bits", "bits = 12; }; type = \"balancer\"; encoder_: {");
    check_refused(path, "encoder_");
    write_with_line("pwm.bits", "bits = 12; }; type = 3; ground_: {");
    check_refused(path, "type");
}

static void test_values_that_contradict(void)
{
    write_with_line("supply.voltage_v", "voltage_v = 12.0;");
    check_refused(path, "supply.voltage_v");
    write_with_line("motor.rotor_inertia_kg_m2", "rotor_inertia_kg_m2 = 0.0;");
    TEST_ASSERT_TRUE(load(path));
    write_with_line("motor.friction_nm_s_per_rad", "friction_nm_s_per_rad = 10.0;");
    check_refused(path, "control.rate_hz");
}

static void test_files_that_are_no_text(void)
{
    write_file("", 0);
    check_refused(path, "empty");
    write_file("name\0x", 6);
    check_refused(path, "zero bytes");
    char binary[256];
    for (int i = 0; i < 256; i++) {
        binary[i] = (char)(255 - i % 255);
    }
    write_file(binary, sizeof binary);
    check_refused(path, "line ");
    static char large[70000];
    memset(large, '\n', sizeof large);
    write_file(large, sizeof large);
    check_refused(path, "65536");
    check_refused(folder, "directory");
    check_refused("/tmp/no/such/robot.cfg", "No such file");
}

static void test_unreadable_file(void)
{
    const uid_t user = geteuid();
    write_file(sound, strlen(sound));
    TEST_ASSERT_TRUE(chmod(folder, 0777) == 0 && chmod(path, 0) == 0);
    if (user == 0) {
        TEST_ASSERT_TRUE(seteuid(65534) == 0); /* root may read everything, nobody may not */
    }
    const bool loaded = load(path);
    TEST_ASSERT_TRUE(seteuid(user) == 0);
    TEST_ASSERT_FALSE(loaded);
    check_one_line(path);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(errors, "Permission denied"), errors);
}

static void test_truncation_at_every_byte(void)
{
    const size_t size = strlen(sound);
    size_t needed = 0;
    for (size_t length = 0; length < size; length++) {
        write_file(sound, length);
        if (load(path)) {
            TEST_ASSERT_EQUAL_STRING("", errors);
            needed = needed == 0 ? length : needed;
        } else {
            check_one_line(path);
            TEST_ASSERT_TRUE_MESSAGE(needed == 0, "a longer part of the file must load too");
        }
    }
    TEST_ASSERT_TRUE_MESSAGE(needed > size - 8, "only the end may be left out");
}

/* Random bytes anywhere: accepted or refused in one line, never a crash. */
static void test_random_damage(void)
{
    static char text[BAD_FILE_MAX];
    const size_t size = strlen(sound);
    unsigned short state[3] = {1, 2, 3};
    for (int run = 0; run < 3000; run++) {
        memcpy(text, sound, size);
        for (int k = 0; k <= run % 4; k++) {
            text[(size_t)nrand48(state) % size] = (char)nrand48(state);
        }
        write_file(text, size);
        if (!load(path)) {
            check_one_line(path);
        }
    }
}

int main(void)
{
    bad_file_begin("robot.cfg", load_robot);
    UNITY_BEGIN();
    const size_t before = strlen(specification);
    memcpy(sound, specification, before);
    (void)read_file("sim/robots/courier24.cfg", sound + before, sizeof sound - before);
    (void)printf("random damage: seed {1, 2, 3}\n");
    run_tests();
    bad_file_end();
    return UNITY_END();
}
