/* What the patrol reckons its ways to turn at, against the energy model and the wheels' kinematics. */
#include "src/local/patrol_price.h"

#include <joulepath/four_wheel_energy.h>
#include <stddef.h>

#include "tests/support/patrol_rig.h"

#define ANGLES      20U
#define TURN        4294967296.0f /* units of a wheel's angle */
#define TIME_PRICE  10.0f         /* of a second, besides electronics, W */
#define ROLLING     10.0f         /* N */
#define STEER_WHEEL 2.0f          /* J/rad of a wheel */

/* 25 W standing, 10 N of rolling resistance; masses that take no energy. */
static const struct jp_four_wheel_energy_model model = {
    .wheelbase = JP_Q24(0.5),
    .track = JP_Q24(0.44),
    .weight = JP_Q16(1000),
    .rolling = JP_Q24(0.01),
    .driving = JP_Q24_ONE,
    .braking = JP_Q24_ONE,
    .steering = JP_Q16(2),
    .contact = JP_Q24(0.01),
    .electronics_power = JP_Q16(25),
};

static struct jp_four_wheel_drive drive;
static float duration;

void setUp(void)
{
    const float arm = 0.5f * jp_plane_length(0.5f, 0.44f);

    rig_reset();
    config.price = (struct jp_patrol_price){
        .second = 25.0f + TIME_PRICE, .turning = ROLLING * arm, .steering = (float)JP_WHEELS * STEER_WHEEL};
    config.turn_rate = 1.0f;
    config.turn_acceleration = 1.5f;
    config.steering_rate = 3.0f;
    drive = (struct jp_four_wheel_drive){0};
    duration = 0.0f;
}

void tearDown(void)
{
}

/* ---- By the energy model ---- */

static void add(float forward, float turn_rate, float next_turn_rate, float travel, float seconds)
{
    const struct jp_four_wheel_piece piece = {
        .start = {(jp_q24)(forward * (float)JP_Q24_ONE), 0, (jp_q24)(turn_rate * (float)JP_Q24_ONE)},
        .end = {(jp_q24)(forward * (float)JP_Q24_ONE), 0, (jp_q24)(next_turn_rate * (float)JP_Q24_ONE)},
        .travel = (jp_q16)(travel * (float)JP_Q16_ONE),
        .duration = (jp_q16)(seconds * (float)JP_Q16_ONE),
    };

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_energy_add(&model, &drive, &piece));
    duration += seconds;
}

static void expect_price(float price)
{
    const float joules = (float)drive.energy / (float)JP_Q16_ONE + TIME_PRICE * duration;

    TEST_ASSERT_TRUE(jp_plane_magnitude(price - joules) <= 0.01f * joules + 0.05f);
}

/* All wheels as far as they must be for a turn in place, then the turn with its ramps. */
static void add_turn(float angle)
{
    const float in_place = jp_plane_bearing(0.44f, 0.5f);
    const float ramp = config.turn_rate / config.turn_acceleration;
    const float rest = angle - ramp * config.turn_rate;
    const float rate = rest > 0.0f ? config.turn_rate : jp_plane_square_root(angle * config.turn_acceleration);

    add(0.0f, 0.0f, 0.0f, (float)JP_WHEELS * in_place, in_place / config.steering_rate);
    add(0.0f, 0.0f, rate, 0.0f, rate / config.turn_acceleration);
    add(0.0f, rate, 0.0f, 0.0f, rate / config.turn_acceleration);
    if (rest > 0.0f) {
        add(0.0f, rate, rate, 0.0f, rest / rate);
    }
}

static void test_a_turn_costs_what_the_model_says(void)
{
    for (unsigned i = 1; i <= ANGLES; i++) {
        const float angle = JP_PLANE_PI * (float)i / (float)ANGLES;

        setUp();
        add_turn(angle);
        expect_price(jp_patrol_turn_price(&config, angle));
    }
    TEST_ASSERT_TRUE(jp_patrol_turn_price(&config, 0.0f) == 0.0f);
}

static void test_a_step_costs_what_the_model_says_but_its_rolling(void)
{
    add(0.0f, 0.0f, 0.0f, (float)JP_WHEELS * 0.6f, 0.6f / config.steering_rate);
    add(config.step_speed, 0.0f, 0.0f, 0.0f, 0.5f / config.step_speed);
    expect_price(jp_patrol_step_price(&config, 0.6f, 0.5f) + 0.5f * ROLLING);
}

static void test_a_step_back_is_steered_as_one_ahead(void)
{
    const float ahead = jp_patrol_step_price(&config, 0.4f, 0.3f);

    TEST_ASSERT_NEAR(1e-3f, ahead, jp_patrol_step_price(&config, JP_PLANE_PI - 0.4f, 0.3f));
    TEST_ASSERT_TRUE(jp_patrol_step_price(&config, 1.5f, 0.3f) > ahead);
}

/* From stand to stand: at 1 m/s and 0.5 m/s², 3 m take 5 s, 0.5 m 2 s. */
static void test_a_straight_way_takes_its_time(void)
{
    config.teb.speed_max = 1.0f;
    config.teb.acceleration = 0.5f;
    TEST_ASSERT_NEAR(1e-2f, 5.0f * config.price.second, jp_patrol_straight_price(&config, 0.0f, 3.0f));
    TEST_ASSERT_NEAR(1e-2f, 2.0f * config.price.second, jp_patrol_straight_price(&config, 0.0f, 0.5f));
    TEST_ASSERT_NEAR(1e-2f,
                     2.0f * config.price.second + jp_patrol_turn_price(&config, 1.0f) +
                         jp_patrol_steering_price(&config, 0.0f, true),
                     jp_patrol_straight_price(&config, 1.0f, 0.5f));
}

/* ---- By the kinematics ---- */

static void steer(struct jp_wheels *wheels, float forward, float left, float turn_rate)
{
    const struct jp_twist wanted = {(jp_q24)(forward * (float)JP_Q24_ONE), (jp_q24)(left * (float)JP_Q24_ONE),
                                    (jp_q24)(turn_rate * (float)JP_Q24_ONE)};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_inverse(&config.wheels, &wanted, wheels));
}

/* What the wheels are steered by, from one position to another, rad. */
static void expect_steering(const struct jp_wheels *from, const struct jp_wheels *to, float price)
{
    float sum = 0.0f;
    float farthest = 0.0f;

    for (unsigned i = 0; i < (unsigned)JP_WHEELS; i++) {
        const float angle =
            jp_plane_magnitude(((float)to->angle[i] - (float)from->angle[i]) / TURN * 2.0f * JP_PLANE_PI);

        sum += angle;
        farthest = jp_plane_larger(angle, farthest);
    }
    TEST_ASSERT_NEAR(0.2f, STEER_WHEEL * sum + farthest / config.steering_rate * config.price.second, price);
}

/* Across, to a goal at its side that wants its heading; straight ahead it drives. */
static void test_the_cheapest_way_to_a_near_goal(void)
{
    const struct jp_patrol_near_goal beside = {.away = 0.3f, .first = 1.57f, .then = 1.57f, .error = 0.0f};
    const struct jp_patrol_near_goal ahead = {.away = 3.0f, .first = 0.6f, .then = 0.0f, .error = 0.6f};
    const struct jp_patrol_near_goal far_off = {.away = 10.0f, .first = 1.57f, .then = 1.57f, .error = 0.0f};

    TEST_ASSERT_TRUE(jp_patrol_is_step_cheapest(&config, &beside));
    TEST_ASSERT_FALSE(jp_patrol_is_step_cheapest(&config, &ahead));
    TEST_ASSERT_FALSE(jp_patrol_is_step_cheapest(&config, &far_off));
}

static void test_steering_costs_what_the_wheels_have_to_go(void)
{
    for (unsigned i = 0; i <= ANGLES; i++) {
        const float askew = 1.3f * (float)i / (float)ANGLES;
        const float c = 0.5f * jp_plane_cosine(askew);
        const float s = 0.5f * jp_plane_sine(askew);
        struct jp_wheels straight = {{0}, {0}};
        struct jp_wheels in_place = {{0}, {0}};

        steer(&in_place, 0.0f, 0.0f, 0.5f);

        struct jp_wheels from_straight = straight;
        struct jp_wheels from_turn = in_place;

        steer(&from_straight, c, s, 0.0f);
        steer(&from_turn, c, s, 0.0f);
        expect_steering(&straight, &from_straight, jp_patrol_steering_price(&config, askew, false));
        expect_steering(&in_place, &from_turn, jp_patrol_steering_price(&config, askew, true));
    }
}
