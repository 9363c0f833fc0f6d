/* Every way that the file of a cell or of a pack can be wrong: one clear line on stderr that names file and culprit. */
#include <stdio.h>
#include <string.h>

#include "sim/files/cell_file.h"
#include "tests/support/bad_config.h"
#include "unity.h"

static const char cell_path[] = "sim/robots/cells/inr18650_p28a.cfg";
static const char pack_path[] = "sim/robots/packs/courier24.cfg";

static struct cell_constants cell;
static struct cell_wiring wiring;

void setUp(void)
{
}

void tearDown(void)
{
}

static bool load_cell(const char *name)
{
    return cell_file_load(name, &cell);
}

static bool load_pack(const char *name)
{
    return pack_file_load(name, &cell, &wiring);
}

static void test_shipped_files_load(void)
{
    static const char *const robots[] = {"courier24", "burger", "zhang2018", "patrol"};

    TEST_ASSERT_TRUE(load_cell(cell_path));
    TEST_ASSERT_EQUAL_STRING("inr18650_p28a", cell.name);
    for (size_t i = 0; i < sizeof robots / sizeof robots[0]; i++) {
        TEST_ASSERT_TRUE(pack_file_load_robot(robots[i], &cell, &wiring));
        TEST_ASSERT_TRUE(wiring.series > 0 && wiring.parallel > 0);
    }
}

static void test_every_field_of_a_cell_must_be_there_and_in_range(void)
{
    static const struct {
        const char *key;
        const char *bad;
    } cases[] = {
        {"cell.capacity_ah", "capacity_ah = 0.0;"},
        {"cell.capacity_ah", ""},
        {"cell.mass_kg", "mass_kg = -1.0;"},
        {"cell.charge", "charge = [0.0, 1.0];"},
        {"cell.open_circuit_v", "open_circuit_v = 3.7;"},
        {"resistance.ohmic_ohm", "ohmic_ohm = [0.0, 0.015, 0.013, 0.013, 0.014, 0.0235];"},
        {"resistance.ohmic_activation_k", "ohmic_activation_k = -1.0;"},
        {"resistance.polarisation_ohm", "polarisation_ohm = 0.0;"},
        {"resistance.polarisation_s", "polarisation_s = 0.0;"},
        {"resistance.polarisation_activation_k", "polarisation_activation_k = \"warm\";"},
        {"resistance.reference_c", "reference_c = 300.0;"},
        {"ageing.capacity_per_cycle", "capacity_per_cycle = 0.5;"},
        {"ageing.resistance_per_cycle", ""},
        {"heat.capacity_j_per_kg_k", "capacity_j_per_kg_k = 0.0;"},
        {"heat.to_air_w_per_k", "to_air_w_per_k = -0.1;"},
    };

    (void)read_file(cell_path, sound, sizeof sound);
    bad_file_load = load_cell;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_with_line(cases[i].key, cases[i].bad);
        check_refused(path, cases[i].key);
    }
}

static void test_curves_must_rise_over_the_whole_charge(void)
{
    (void)read_file(cell_path, sound, sizeof sound);
    bad_file_load = load_cell;
    write_with_line("resistance.charge", "charge = [0.0, 0.1, 0.4, 0.4, 0.9, 1.0];");
    check_refused(path, "resistance.charge");
    write_with_line("resistance.charge", "charge = [0.1, 0.2, 0.4, 0.6, 0.9, 1.0];");
    check_refused(path, "resistance.charge");
    write_with_line("resistance.charge", "charge = [0.0, 0.1, 0.4, 0.6, 0.8, 0.9];");
    check_refused(path, "resistance.charge");
    write_with_line("cell.charge", "charge = [0.0, 0.01, 0.02, 0.04, 0.06, 0.08, 0.10, 0.15, 0.20, 0.25, 0.30, 0.40, "
                                   "0.50, 0.60, 0.60, 0.80, 0.85, 0.90, 0.95, 0.98, 1.0];");
    check_refused(path, "cell.charge");
    write_with_line("cell.open_circuit_v",
                    "open_circuit_v = [2.7, 2.8, 3.0, 3.1, 3.2, 3.3, 3.35, 3.4, 3.5, 3.55, 3.6, 3.65, "
                    "3.7, 3.8, 3.9, 3.9, 4.0, 4.05, 4.1, 4.15, 4.2];");
    check_refused(path, "cell.open_circuit_v");
}

static void test_packs(void)
{
    static const struct {
        const char *line;
        const char *bad;
        const char *culprit;
    } cases[] = {
        {"cell = \"inr18650_p28a\";", "cell = 3;", "cell"},
        {"series = 6;", "series = 0;", "series"},
        {"series = 6;", "series = 6.5;", "series"},
        {"parallel = 1;", "", "parallel"},
        {"wiring_ohm = 0.04;", "wiring_ohm = -1.0;", "wiring_ohm"},
    };

    (void)read_file(pack_path, sound, sizeof sound);
    bad_file_load = load_pack;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *start = strstr(sound, cases[i].line);
        TEST_ASSERT_NOT_NULL_MESSAGE(start, cases[i].line);
        write_replaced(sound, start, start + strlen(cases[i].line), cases[i].bad);
        check_refused(path, cases[i].culprit);
    }
}

static bool load_of_robot(const char *name)
{
    return pack_file_load_robot(name, &cell, &wiring);
}

static void test_a_cell_or_pack_that_is_not_there(void)
{
    static const char too_long[] = "a_name_that_is_longer_than_any_path_of_a_pack_may_be_and_therefore_refused_before_"
                                   "anything_is_opened_or_read_from_the_disk";
    const char *start;

    (void)read_file(pack_path, sound, sizeof sound);
    bad_file_load = load_pack;
    start = strstr(sound, "inr18650_p28a");
    write_replaced(sound, start, start + strlen("inr18650_p28a"), "nothing");
    TEST_ASSERT_FALSE(load(path));
    TEST_ASSERT_NOT_NULL(strstr(errors, "sim/robots/cells/nothing.cfg"));
    bad_file_load = load_of_robot;
    TEST_ASSERT_FALSE(load("nobody"));
    check_one_line("sim/robots/packs/nobody.cfg");
    TEST_ASSERT_FALSE(load(too_long));
    check_one_line("sim/robots/packs: ");
}

int main(void)
{
    bad_file_begin("pack.cfg", load_pack);

    UNITY_BEGIN();
    run_tests();
    const int failures = UNITY_END();

    bad_file_end();
    return failures;
}
