/* Variations of a robot and chains of segments, against what the robot and the plant count themselves. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sim/balancer/variation.h"
#include "tests/support/chain.h"
#include "tests/support/check.h"
#include "unity.h"

#define SEED     20180401u
#define SEGMENTS 12
#define PACES    80

/** rig_release() before a chain, and the tick after it that meters the last one. */
#define TICKS_AROUND 12u

static const struct chain_ranges ranges = {
    .speed_share = 1, .turn_rate_share = 1, .turn_share = 1, .shortest = 0.1, .longest = 3};

static const char *const names[] = {"gao2018", "courier24"};
static struct robot_file files[2];
static struct random noise;
static struct chain_record records[SEGMENTS];
static struct chain_record others[SEGMENTS];

void setUp(void)
{
    TEST_ASSERT_TRUE(robot_file_load("sim/robots/gao2018.cfg", &files[0]));
    TEST_ASSERT_TRUE(robot_file_load("sim/robots/courier24.cfg", &files[1]));
    random_init(&noise, SEED);
}

void tearDown(void)
{
}

static void start(struct rig *rig, int robot, const struct robot_file *varied)
{
    const struct robot_entry *entry = rig_find_robot(names[robot]);
    TEST_ASSERT_TRUE(entry != NULL && rig_init(rig, entry, varied, SEED));
}

static double joules(jp_energy energy)
{
    return (double)energy / 4294967296.0;
}

/* ---- Variations ---- */

static void test_no_variation_is_the_file(void)
{
    struct robot_file varied;
    variation_apply(&variation_none, &files[1], &varied);
    TEST_ASSERT_EQUAL_MEMORY(&files[1], &varied, sizeof varied);
}

static void test_variation_acts_on_its_fields_alone(void)
{
    const struct variation variation = {1.5, 0.7, 1.1, 0.9, 0.8};
    struct robot_file varied;
    variation_apply(&variation, &files[1], &varied);
    check_near(1.5 * files[1].ground.friction, varied.ground.friction, 1e-15, "ground friction");
    check_near(files[1].body.mass_kg + 0.7, varied.body.mass_kg, 1e-15, "mass");
    check_near(1.1 * files[1].motor.resistance_ohm, varied.motor.resistance_ohm, 1e-15, "resistance");
    check_near(0.9 * files[1].motor.friction, varied.motor.friction, 1e-15, "motor friction");
    check_near(0.8 * files[1].supply.capacity_wh, varied.supply.capacity_wh, 1e-13, "capacity");

    varied.ground.friction = files[1].ground.friction;
    varied.body.mass_kg = files[1].body.mass_kg;
    varied.motor.resistance_ohm = files[1].motor.resistance_ohm;
    varied.motor.friction = files[1].motor.friction;
    varied.supply.capacity_wh = files[1].supply.capacity_wh;
    TEST_ASSERT_EQUAL_MEMORY(&files[1], &varied, sizeof varied);
}

/* Every robot that can be drawn passes the checks of a robot file. */
static void test_draws_fill_their_ranges(void)
{
    enum { COUNT = 4000 };
    static const double expected[][2] = {{0.6, 1.6}, {-0.3, 1.2}, {0.92, 1.12}, {0.8, 1.25}, {0.7, 1.0}};
    double low[5] = {INFINITY, INFINITY, INFINITY, INFINITY, INFINITY};
    double high[5] = {-INFINITY, -INFINITY, -INFINITY, -INFINITY, -INFINITY};
    double sum[5] = {0};
    TEST_ASSERT_EQUAL_INT(5, (int)variation_member_count);
    for (int run = 0; run < COUNT; run++) {
        struct variation variation;
        struct robot_file varied;
        variation_draw(&noise, &files[run % 2], &variation);
        variation_apply(&variation, &files[run % 2], &varied);
        TEST_ASSERT_TRUE(robot_file_check("drawn", &varied));
        for (size_t i = 0; i < 5; i++) {
            const double value = variation_value(&variation, &variation_members[i]);
            low[i] = fmin(low[i], value);
            high[i] = fmax(high[i], value);
            sum[i] += value;
        }
    }
    for (size_t i = 0; i < 5; i++) {
        const double width = expected[i][1] - expected[i][0];
        TEST_ASSERT_TRUE(low[i] >= expected[i][0] && high[i] < expected[i][1]);
        check_near(expected[i][0], low[i], 0.01 * width, variation_members[i].name);
        check_near(expected[i][1], high[i], 0.01 * width, variation_members[i].name);
        check_near((expected[i][0] + expected[i][1]) / 2, sum[i] / COUNT, 0.03 * width, variation_members[i].name);
    }
}

static void test_parsing_sets_what_is_named(void)
{
    struct variation variation = variation_none;
    TEST_ASSERT_TRUE(variation_parse("--variation", "payload=-0.25,friction=1.5", &variation));
    TEST_ASSERT_TRUE(variation.payload_kg == -0.25 && variation.ground_friction == 1.5);
    TEST_ASSERT_TRUE(variation_parse("--variation", "resistance=1.1,motor-friction=2,capacity=0.5", &variation));
    const struct variation expected = {1.5, -0.25, 1.1, 2.0, 0.5};
    TEST_ASSERT_EQUAL_MEMORY(&expected, &variation, sizeof expected);
}

static void test_garbled_variations_are_refused(void)
{
    static const char *const texts[] = {"",
                                        ",",
                                        "=",
                                        "friction",
                                        "friction=",
                                        "friction=x",
                                        "friction=1x",
                                        "friction=1,",
                                        "friction=1,,payload=1",
                                        "friction 1",
                                        "frictio=1",
                                        "frictions=1",
                                        "Friction=1",
                                        "friction=nan",
                                        "friction=inf",
                                        "friction=0.09",
                                        "friction=10.1",
                                        "friction=-1",
                                        "payload=-10.1",
                                        "payload=101",
                                        "friction=1.5,friction=1",
                                        "payload=1,friction=1,payload=1",
                                        "colour=1"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        struct variation variation = variation_none;
        TEST_ASSERT_FALSE_MESSAGE(variation_parse("--variation", texts[i], &variation), texts[i]);
    }
}

static void test_check_refuses_what_a_file_may_not_hold(void)
{
    struct robot_file varied = files[0];
    TEST_ASSERT_TRUE(robot_file_check("varied", &varied));
    varied.body.mass_kg = 0.04;
    TEST_ASSERT_FALSE(robot_file_check("varied", &varied));
    varied = files[0];
    varied.control.weights[7] = -1;
    TEST_ASSERT_FALSE(robot_file_check("varied", &varied));
    varied = files[0];
    varied.supply.voltage_v = varied.control.voltage_max_v;
    TEST_ASSERT_FALSE(robot_file_check("varied", &varied));
}

/* ---- Chains ---- */

static void test_commands_are_within_their_ranges(void)
{
    const struct chain_ranges narrow = {0, 0.5, 0.25, 0.1, 0.02, 0.04};
    const double turn = 0.1 * files[1].limits.turn_deg * M_PI / 180.0;
    for (int run = 0; run < 100; run++) {
        chain_draw(records, SEGMENTS, &files[1], &narrow, &noise);
        for (size_t i = 0; i < SEGMENTS; i++) {
            const struct experiment_segment *c = &records[i].command;
            TEST_ASSERT_TRUE(c->speed >= 0 && c->speed < 0.5 * files[1].limits.speed_m_s);
            TEST_ASSERT_TRUE(fabs(c->turn_rate) <= 0.25 * files[1].limits.turn_rate_rad_s && fabs(c->turn) <= turn);
            TEST_ASSERT_TRUE(records[i].commanded_ticks >= 20 && records[i].commanded_ticks <= 40);
            TEST_ASSERT_TRUE(records[i].ticks == 0 && records[i].model == 0);
        }
    }
    const struct chain_ranges instants = {0, 0, 0, 0, 0, 1e-4};
    chain_draw(records, 1, &files[1], &instants, &noise);
    TEST_ASSERT_EQUAL_UINT32(2u, records[0].commanded_ticks);
}

/* No tick lies between segments: the ticks of the records are those of the world. */
static void test_segments_are_back_to_back(void)
{
    for (int robot = 0; robot < 2; robot++) {
        for (int run = 0; run < 5; run++) {
            struct rig rig;
            uint64_t ticks = 0;
            start(&rig, robot, &files[robot]);
            chain_draw(records, SEGMENTS, &files[robot], &ranges, &noise);
            TEST_ASSERT_EQUAL_INT(SEGMENTS, (int)chain_run(&rig, records, SEGMENTS, NULL));
            for (size_t i = 0; i < SEGMENTS; i++) {
                TEST_ASSERT_EQUAL_INT(CHAIN_DRIVEN, records[i].end);
                TEST_ASSERT_EQUAL_UINT32(records[i].commanded_ticks, records[i].ticks);
                ticks += records[i].ticks;
            }
            TEST_ASSERT_EQUAL_UINT64(rig.world.tick, ticks + TICKS_AROUND);
            TEST_ASSERT_EQUAL_INT(SEGMENTS, jp_robot_last_tick(&rig.robot)->segments_ended);
            TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, jp_robot_state_now(&rig.robot));
        }
    }
}

/* The robot keeps the energy of the last segment that ended: each is the last of a chain that is cut there. */
static void test_energies_are_those_that_the_robot_tells(void)
{
    chain_draw(records, SEGMENTS, &files[1], &ranges, &noise);
    struct rig whole;
    start(&whole, 1, &files[1]);
    TEST_ASSERT_EQUAL_INT(SEGMENTS, (int)chain_run(&whole, records, SEGMENTS, NULL));
    for (size_t count = 1; count <= SEGMENTS; count++) {
        struct rig rig;
        for (size_t i = 0; i < count; i++) {
            others[i] =
                (struct chain_record){.command = records[i].command, .commanded_ticks = records[i].commanded_ticks};
        }
        start(&rig, 1, &files[1]);
        TEST_ASSERT_EQUAL_INT((int)count, (int)chain_run(&rig, others, count, NULL));
        const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&rig.robot);
        check_near(joules(telemetry->segment_energy_model), records[count - 1].model, 0, "model");
        check_near(joules(telemetry->segment_energy_battery), records[count - 1].battery, 0, "battery");
        TEST_ASSERT_EQUAL_MEMORY(&records[count - 1], &others[count - 1], sizeof others[0]);
    }
}

static void test_energies_agree_with_the_plant(void)
{
    /* The courier's PWM, sagging supply and current sensing are not ideal. */
    static const double bounds[] = {1e-5, 1e-3};
    static const double battery_bounds[] = {1e-3, 3e-3};
    for (int robot = 0; robot < 2; robot++) {
        double model = 0;
        double motor = 0;
        double battery = 0;
        double drawn = 0;
        struct rig rig;
        start(&rig, robot, &files[robot]);
        chain_draw(records, SEGMENTS, &files[robot], &ranges, &noise);
        (void)chain_run(&rig, records, SEGMENTS, NULL);
        for (size_t i = 0; i < SEGMENTS; i++) {
            const double electronics = files[robot].electronics.power_w * records[i].ticks * 1e-3;
            model += records[i].model;
            motor += records[i].motor + electronics;
            battery += records[i].battery;
            drawn += records[i].electrical + electronics;
            check_near((records[i].electrical + electronics) / records[i].bus_voltage, records[i].charge,
                       2e-2 * records[i].charge, "charge");
        }
        check_near(motor, model, bounds[robot] * motor, "paper's energy");
        check_near(drawn, battery, battery_bounds[robot] * drawn, "battery");
        TEST_ASSERT_TRUE(motor > 2 * drawn / 3);
        /* The plant spends more only in the ticks before and after the chain. */
        const double all = rig.world.plant.ledger.motor +
                           files[robot].electronics.power_w * 1e-3 * (double)(rig.world.tick - TICKS_AROUND);
        check_near(all, motor, 2e-3 * motor, "all of the plant's");
    }
}

static void test_state_is_that_of_the_plant(void)
{
    struct rig rig;
    chain_draw(records, SEGMENTS, &files[0], &ranges, &noise);
    records[SEGMENTS - 1].commanded_ticks = 20000;
    start(&rig, 0, &files[0]);
    (void)chain_run(&rig, records, SEGMENTS, NULL);
    const struct chain_state *s = &records[SEGMENTS - 1].state;
    const struct experiment_segment *c = &records[SEGMENTS - 1].command;
    /* Settled: the ideal robot does what it is told, and turns as much as it was told in all. */
    double yaw = 0;
    for (size_t i = 0; i < SEGMENTS; i++) {
        yaw += records[i].command.turn + records[i].command.turn_rate * records[i].ticks * 1e-3;
    }
    check_near(c->speed / files[0].wheel.radius_m, s->wheel_rate, 1e-3, "wheel rate");
    check_near(c->turn_rate, s->yaw_rate, 1e-3, "yaw rate");
    check_near(s->wheel_rate, s->reference_wheel_rate, 1e-3, "reference of the wheels");
    check_near(c->turn_rate, s->reference_yaw_rate, 1e-6, "reference of the yaw");
    check_near(yaw, s->yaw, 5e-3, "yaw");
    check_near(0, s->pitch_rate, 1e-3, "pitch rate");
    check_near(0, s->yaw_error, 5e-3, "yaw error");
    check_near(0, s->wheel_error, 5e-2, "wheel error");
    check_near(0, s->wheel_lag, 1e-6, "no shaping, no lag");
    check_near(0, s->yaw_lag, 1e-6, "no shaping, no lag");
    TEST_ASSERT_TRUE(fabs(s->wheel_integral) > 1e-3);
    TEST_ASSERT_TRUE(s->voltage_left > 0 && s->voltage_right > 0);
    check_near(rig.world.plant.x, s->x, 0.01, "x");
    check_near(rig.world.plant.y, s->y, 0.01, "y");
}

/* ---- Changes and falls ---- */

static void test_change_comes_before_its_segment(void)
{
    enum { AT = 5 };
    const struct variation variation = {2.0, 1.0, 1.0, 1.0, 1.0};
    struct robot_file varied;
    struct rig rig;
    variation_apply(&variation, &files[1], &varied);
    const struct chain_change change = {.at = AT, .robot = &varied};
    chain_draw(records, SEGMENTS, &files[1], &ranges, &noise);
    memcpy(others, records, sizeof records);
    start(&rig, 1, &files[1]);
    TEST_ASSERT_EQUAL_INT(SEGMENTS, (int)chain_run(&rig, records, SEGMENTS, NULL));
    TEST_ASSERT_TRUE(rig.world.plant.ledger.change == 0);
    start(&rig, 1, &files[1]);
    TEST_ASSERT_EQUAL_INT(SEGMENTS, (int)chain_run(&rig, others, SEGMENTS, &change));
    TEST_ASSERT_TRUE(rig.world.plant.ledger.change > 1);
    TEST_ASSERT_TRUE(rig.world.robot.body.mass_kg == varied.body.mass_kg);

    double more = 0;
    for (size_t i = 0; i < SEGMENTS; i++) {
        if (i + 1 < AT) {
            TEST_ASSERT_EQUAL_MEMORY(&records[i], &others[i], sizeof records[0]);
        } else if (i >= AT) {
            more += others[i].model - records[i].model;
            TEST_ASSERT_TRUE(others[i].motor != records[i].motor);
        }
    }
    TEST_ASSERT_TRUE_MESSAGE(more > 0, "friction costs");
    TEST_ASSERT_TRUE(records[AT - 1].motor == others[AT - 1].motor);
}

static void test_fall_ends_the_chain(void)
{
    /* More than the motors can hold up. */
    struct robot_file heavy = files[1];
    heavy.body.mass_kg += 20;
    const struct chain_change change = {.at = 2, .robot = &heavy};
    struct rig rig;
    chain_draw(records, SEGMENTS, &files[1], &ranges, &noise);
    start(&rig, 1, &files[1]);
    const size_t count = chain_run(&rig, records, SEGMENTS, &change);
    TEST_ASSERT_TRUE(count >= 3 && count < SEGMENTS);
    TEST_ASSERT_TRUE(records[count - 1].end != CHAIN_DRIVEN);
    TEST_ASSERT_TRUE(records[count - 1].ticks <= records[count - 1].commanded_ticks);
    TEST_ASSERT_TRUE(records[count - 1].model > 0 && records[count - 1].saturated_ticks > 0);
    TEST_ASSERT_TRUE((records[count - 1].end == CHAIN_FAULT) == (records[count - 1].faults != 0));
    for (size_t i = 0; i + 1 < count; i++) {
        TEST_ASSERT_EQUAL_INT(CHAIN_DRIVEN, records[i].end);
    }
    TEST_ASSERT_TRUE(records[count].ticks == 0 && records[count].model == 0);
}

/* In each tick of a segment, its first and its last among them, and of the one after it. */
static void test_fault_in_any_tick_is_in_the_segment_that_it_ends(void)
{
    static const struct chain_record chain[2] = {{.command = {0.1, 0, 0}, .commanded_ticks = 6},
                                                 {.command = {0.2, 0, 0}, .commanded_ticks = 6}};
    for (uint64_t tick = 10; tick < 28; tick++) {
        const struct world_fault stuck = {.channel = WORLD_HAL_READ, .kind = WORLD_STUCK, .from = tick};
        struct rig rig;
        memcpy(records, chain, sizeof chain);
        start(&rig, 1, &files[1]);
        TEST_ASSERT_TRUE(world_add_fault(&rig.world, &stuck));
        const size_t count = chain_run(&rig, records, 2, NULL);
        uint32_t ticks = records[0].ticks + (count == 2 ? records[1].ticks : 0);
        TEST_ASSERT_TRUE(count >= 1 && count <= 2 && ticks <= 12);
        if (records[count - 1].end != CHAIN_DRIVEN) {
            TEST_ASSERT_EQUAL_INT(CHAIN_FAULT, records[count - 1].end);
            TEST_ASSERT_TRUE((records[count - 1].faults & JP_FAULT_HARDWARE) != 0);
            TEST_ASSERT_EQUAL_INT(JP_ROBOT_FAULT, jp_robot_state_now(&rig.robot));
            TEST_ASSERT_EQUAL_INT((int)(ticks > 6) + 1, (int)count);
        } else {
            TEST_ASSERT_EQUAL_UINT32(12u, ticks);
        }
    }
}

/* ---- Forward and back ---- */

static double random_speed(double limit)
{
    static const double ends[] = {-1, 0, 1};
    const bool full = random_uniform(&noise, 0, 2) < 1;

    return limit * (full ? ends[(int)random_uniform(&noise, 0, 3)] : random_uniform(&noise, -1, 1));
}

/* Until it can take the next segment; false: the motors are off. */
static bool drive_to_the_end(struct rig *rig)
{
    do {
        rig_tick(rig);
        if (!rig->robot.internal.motors_ran) {
            return false;
        }
    } while (rig->robot.internal.next_full != 0U || jp_robot_last_tick(&rig->robot)->segment_ticks_left > 1U);
    return true;
}

static void check_driven(struct rig *rig, const struct robot_file *file, double speed, double seconds)
{
    const double turn_rate = file->limits.turn_rate_rad_s;
    const double turn = file->limits.turn_deg / 180 * M_PI;
    const struct experiment_segment segment = {
        .speed = speed,
        .turn_rate = random_uniform(&noise, -turn_rate, turn_rate),
        .turn = random_uniform(&noise, -turn, turn),
    };
    const struct jp_segment_command command = experiment_command(&segment, seconds);

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&rig->robot, &command));
    TEST_ASSERT_TRUE_MESSAGE(drive_to_the_end(rig), "a command that was accepted switched the motors off");
}

static void test_no_step_within_the_limits_switches_off(void)
{
    for (int run = 0; run < 50; run++) {
        const struct robot_file *file = &files[run % 2];
        struct rig rig;

        start(&rig, run % 2, file);
        rig_release(&rig, 0);
        for (int i = 0; i < 20; i++) {
            check_driven(&rig, file, random_speed(file->limits.speed_m_s), random_uniform(&noise, 0.05, 5));
        }
    }
}

/* From 0.2 s to 6.5 s in steps of less than a tenth for each robot: among them are the periods at which the closed loop
 * swings of itself. */
static double pace(int run)
{
    return 0.2 * pow(1.045, run);
}

static void test_full_speed_forward_and_back_at_any_pace(void)
{
    for (int run = 0; run < PACES; run++) {
        const struct robot_file *file = &files[run % 2];
        const double speed = file->limits.speed_m_s;
        const double seconds = pace(run);
        struct rig rig;

        start(&rig, run % 2, file);
        rig_release(&rig, 0);
        for (int i = 0; i < 12; i++) {
            check_driven(&rig, file, i % 2 == 0 ? speed : -speed, seconds);
        }
    }
}

/* The same between a stand and full speed. */
static void test_start_and_stop_at_any_pace(void)
{
    for (int run = 0; run < PACES; run++) {
        const struct robot_file *file = &files[run % 2];
        const double seconds = pace(run);
        struct rig rig;

        start(&rig, run % 2, file);
        rig_release(&rig, 0);
        for (int i = 0; i < 12; i++) {
            check_driven(&rig, file, i % 2 == 0 ? file->limits.speed_m_s : 0, seconds);
        }
    }
}

int main(void)
{
    (void)printf("seed %u\n", SEED);
    UNITY_BEGIN();
    run_tests();
    return UNITY_END();
}
