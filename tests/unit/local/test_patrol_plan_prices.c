/* Prices of a path's metres for the patrol: what it drives, how fast beside things, and the band's price of clearance.
 */
#include "src/local/patrol_plan_prices.h"

#include "src/local/patrol_yield.h"
#include "tests/support/patrol_rig.h"

#define J(price) ((float)(price) / (float)JP_Q16_ONE)

/* Of 40 J a metre at 1 m/s: 25 J electronics, 15 J rolling. */
static const struct jp_four_wheel_energy_model model = {.wheelbase = JP_Q24(0.5),
                                                        .track = JP_Q24(0.44),
                                                        .weight = JP_Q16(500),
                                                        .rolling = JP_Q24(0.02),
                                                        .driving = JP_Q24(1.5),
                                                        .electronics_power = JP_Q16(25)};

static struct jp_grid_prices prices;

void setUp(void)
{
    rig_reset();
    config = rig_config();
    config.teb.speed_max = 1.0f;
    config.teb.clearance = 0.2f;
    config.teb.interval = 0.25f;
    config.teb.weights.obstacle = 1000.0f;
    config.teb.weights.second = 1.0f;
    config.price = (struct jp_patrol_price){.second = 40.0f, .worth = 10.0f};
}

void tearDown(void)
{
}

static void set_prices(float clearance, float cell)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_plan_prices(&config, &model, clearance, cell, &prices));
}

static void test_a_metre_with_nothing_near(void)
{
    set_prices(0.1f, 0.05f);
    TEST_ASSERT_NEAR(0.05f, 50.0f, J(prices.metre));
    config.teb.speed_max = 0.5f;
    set_prices(0.1f, 0.05f);
    TEST_ASSERT_NEAR(0.05f, 85.0f, J(prices.metre));
}

/* Half of 1000/m² times the square of what is missing four times a second, a joule being a 40th of a second's weight;
 * in the middle of each ring. */
static void test_clearance(void)
{
    set_prices(0.1f, 0.05f);
    TEST_ASSERT_NEAR(0.001f, 0.05f, J(prices.ring));
    TEST_ASSERT_NEAR(1.0f, 0.5f * 1000.0f * 0.075f * 0.075f * 4.0f * 40.0f, J(prices.near[0]));
    TEST_ASSERT_NEAR(1.0f, 0.5f * 1000.0f * 0.025f * 0.025f * 4.0f * 40.0f, J(prices.near[1]));
    for (unsigned i = 2; i < JP_GRID_RINGS; i++) {
        TEST_ASSERT_NEAR(0.01f, 0.0f, J(prices.near[i]));
    }
}

/* Nearer than it keeps from things it creeps at 0.1 m/s: a metre takes ten seconds, in each of which clearance is paid.
 */
static void test_creeping(void)
{
    config.teb.weights.obstacle = 1.0f;
    set_prices(0.0f, 0.05f);
    TEST_ASSERT_NEAR(1.0f, 265.0f + 100.0f - 50.0f + 0.5f * 0.175f * 0.175f * 4.0f * 40.0f * 10.0f, J(prices.near[0]));
    TEST_ASSERT_NEAR(1.0f, 0.5f * 0.075f * 0.075f * 4.0f * 40.0f, J(prices.near[2]));
    TEST_ASSERT_NEAR(0.001f, 0.1f, jp_patrol_speed_beside(&config, 0.09f));
    TEST_ASSERT_NEAR(0.001f, 1.0f, jp_patrol_speed_beside(&config, 0.11f));
    config.teb.speed_max = 0.05f;
    TEST_ASSERT_NEAR(0.001f, 0.05f, jp_patrol_speed_beside(&config, 0.09f));
}

/* The last ring is where nothing costs more, however small the cells are. */
static void test_rings_reach_what_costs(void)
{
    set_prices(0.02f, 0.01f);
    TEST_ASSERT_NEAR(0.001f, 0.18f / 7.0f, J(prices.ring));
    TEST_ASSERT_TRUE(J(prices.near[JP_GRID_RINGS - 1U]) < 15.0f);
    TEST_ASSERT_TRUE(J(prices.near[JP_GRID_RINGS - 1U]) > 0.0f);
    config.teb.clearance = 0.05f;
    set_prices(0.02f, 0.01f);
    TEST_ASSERT_NEAR(0.001f, 0.08f / 7.0f, J(prices.ring));
}

/* A band that weighs no energy has no price of clearance. */
static void test_a_band_without_energy(void)
{
    config.teb.weights.second = 0.0f;
    set_prices(0.1f, 0.05f);
    TEST_ASSERT_NEAR(0.01f, 0.0f, J(prices.near[0]));
}

static void test_what_has_no_price(void)
{
    config.teb.speed_max = 16.0f;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_plan_prices(&config, &model, 0.1f, 0.05f, &prices));
    config.teb.speed_max = 0.004f;
    config.price.worth = 64.0f;
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_patrol_plan_prices(&config, &model, 0.1f, 0.05f, &prices));
}
