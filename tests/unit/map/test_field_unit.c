/* The unit in which a field keeps its values, what is owed, and the cells of coarse ones. */
#include "src/map/field_unit.h"

#include <joulepath/tables.h>

#include "tests/target/random.h"
#include "unity.h"

enum { TRIALS = 200, LOOKS = 40 };

static struct jp_lattice lattice;
static struct jp_wavefront wave;
static uint64_t block[8];
static uint32_t state;

void setUp(void)
{
    state = 20261127;
    lattice = jp_lattice_courier24;
    jp_wavefront_init(&wave, 4, 2, JP_WAVE_2_BYTES, block);
}

void tearDown(void)
{
}

static uint32_t below(uint32_t n)
{
    return target_random(&state) % n;
}

/* Other steps and slopes cost more. */
static void make_steps(int32_t level)
{
    for (unsigned move = 0; move < (unsigned)JP_MOVE_KINDS; move++) {
        struct jp_slope_cost *cost = &lattice.move_costs[JP_COST_PHYSICAL][move];

        *cost = (struct jp_slope_cost){
            .climb = {(move == (unsigned)JP_MOVE_AXIS ? level : 2 * level) * JP_Q16_ONE, JP_Q16_ONE, 0},
            .rise_max = 10,
            .floor = 1};
    }
}

static void test_the_level_step_is_of_an_axis_without_a_rise(void)
{
    make_steps(123);
    TEST_ASSERT_EQUAL_UINT32(123, field_level_step(&lattice, JP_COST_PHYSICAL));
}

/* So many level paths across the map fit, and would not with a bit more. */
static void test_the_unit_is_the_finest_that_holds_the_range(void)
{
    const uint32_t most = jp_wavefront_value_max(&wave);

    for (unsigned i = 0; i < TRIALS; i++) {
        const struct jp_terrain_config map = {.width = (uint16_t)(1U + below(300)),
                                              .height = (uint16_t)(1U + below(300))};
        const int32_t level = 1 + (int32_t)below(1000);
        const unsigned paths = 1U + below(6);

        make_steps(level);
        const unsigned shift = field_shift(&wave, &lattice, JP_COST_PHYSICAL, &map, paths);
        const uint32_t range = (map.width + (uint32_t)map.height) * (uint32_t)level * paths;

        TEST_ASSERT_TRUE(range >> shift <= most);
        TEST_ASSERT_TRUE(shift == 0U || range >> (shift - 1U) > most);
    }
}

static void test_values_are_limited(void)
{
    const uint32_t most = jp_wavefront_value_max(&wave);

    TEST_ASSERT_EQUAL_UINT32(0, field_value(&wave, 0));
    TEST_ASSERT_EQUAL_UINT32(most - 1U, field_value(&wave, most - 1U));
    TEST_ASSERT_EQUAL_UINT32(most, field_value(&wave, most));
    TEST_ASSERT_EQUAL_UINT32(most, field_value(&wave, most + 1U));
    TEST_ASSERT_EQUAL_UINT32(most, field_value(&wave, UINT32_MAX));
}

/* Enough of them, and none that is empty. */
static void test_coarse_cells_hold_all(void)
{
    for (uint16_t cells = 1; cells < 70; cells++) {
        for (unsigned scale = 1; scale < 9; scale++) {
            const unsigned coarse = field_coarse(cells, scale);

            TEST_ASSERT_TRUE(coarse * scale >= cells);
            TEST_ASSERT_TRUE((coarse - 1U) * scale < cells);
        }
    }
}

static void test_debts_are_paid_by_looks(void)
{
    for (uint32_t owed = 0; owed <= 2U * LOOKS; owed++) {
        uint32_t debt = owed;
        unsigned looks = LOOKS;

        TEST_ASSERT_EQUAL_INT(owed > 0U, field_pays(&debt, &looks));
        TEST_ASSERT_EQUAL_UINT32(owed > LOOKS ? owed - LOOKS : 0, debt);
        TEST_ASSERT_EQUAL_UINT32(owed < LOOKS ? LOOKS - owed : 0, looks);
    }
}
