/*
 * joulepath/four_wheel.h against kinematics in double: random robots and twists there and back, wheels that slide, and
 * random commands in motion, whose ticks must keep every limit, drag no wheel and arrive.
 *
 * prop_four_wheel [--count N] [--seed S] [--json FILE]
 * --count is the number of commands there and back; 1000000 for the full check.
 */
#include <joulepath/four_wheel.h>

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/options.h"
#include "tests/support/random.h"
#include "unity.h"

#define Q24      16777216.0
#define TURN     4294967296.0
#define PI       3.14159265358979323846
#define STEERING (2 * PI / TURN) /* rad */
#define QUANTUM  (1 / Q24)       /* m/s */
#define HOLD     (JP_WHEEL_HOLD_SPEED / Q24)

#define TWIST_BAR        0.001                   /* of the fastest contact */
#define SLIP_BAR         (JP_SLIP_QUANTUM / Q24) /* m/s */
#define SLIDE            0.2                     /* more speed than its contact has */
#define SLIDE_SHARE_MOST 0.0867                  /* 0.2 √¾/2 */
#define SLIDE_SHARE      0.07                    /* of the wheel's speed: 0.2 √½/2, the least of all contacts */

/* What the formats and wheels below HOLD add, m/s. */
#define DRAG_BAR    HOLD
#define DRAGGED_BAR (2 * HOLD)

enum { COMMANDS_PER_DRIVE = 40, TICKS_KEPT = 20, CASES_PER_DRIVE = 500 };

static struct options options = {.count = 20000, .seed = 1};
static struct {
    double twist;    /* worst error there and back */
    double contact;  /* worst error of a contact, m/s */
    double residual; /* largest slip that the formats alone cause, m/s */
    double slip;     /* largest that is reported */
    unsigned long held;
    double held_slip;
    double slide_least;
    double arrival; /* worst part of the stated number of ticks */
    double drag;    /* worst growth of slip in a tick, m/s */
    double dragged; /* largest slip in motion, m/s */
    unsigned long ticks;
} worst;

void setUp(void)
{
    begin_random(options.seed, 0);
}

void tearDown(void)
{
}

static bool chance(double probability)
{
    return uniform(0, 1) < probability;
}

static jp_q24 q24(double x)
{
    return (jp_q24)lround(x * Q24);
}

static int32_t steering(double degrees)
{
    return (int32_t)lround(degrees / 360 * TURN);
}

/* The model in double */

struct vector {
    double x, y;
};

struct velocity {
    double x, y, turn_rate;
};

static struct velocity velocity_of(const struct jp_twist *twist)
{
    return (struct velocity){twist->x / Q24, twist->y / Q24, twist->turn_rate / Q24};
}

static struct vector place(const struct jp_four_wheel_config *config, int wheel)
{
    const bool is_front = wheel == JP_FRONT_LEFT || wheel == JP_FRONT_RIGHT;
    const bool is_left = wheel == JP_FRONT_LEFT || wheel == JP_REAR_LEFT;

    return (struct vector){(is_front ? 0.5 : -0.5) * config->wheelbase / Q24,
                           (is_left ? 0.5 : -0.5) * config->track / Q24};
}

static struct vector contact(const struct jp_four_wheel_config *config, const struct velocity *velocity, int wheel)
{
    const struct vector at = place(config, wheel);

    return (struct vector){velocity->x - velocity->turn_rate * at.y, velocity->y + velocity->turn_rate * at.x};
}

static struct vector rolling(const struct jp_wheels *wheels, int wheel)
{
    const double angle = wheels->angle[wheel] * STEERING;

    return (struct vector){wheels->speed[wheel] / Q24 * cos(angle), wheels->speed[wheel] / Q24 * sin(angle)};
}

static double difference(struct vector a, struct vector b)
{
    return hypot(a.x - b.x, a.y - b.y);
}

/* Gaussian elimination of the normal equations, which knows nothing of their symmetry. */
static struct velocity solve(double a[3][4])
{
    for (int column = 0; column < 3; column++) {
        for (int row = column + 1; row < 3; row++) {
            const double factor = a[row][column] / a[column][column];
            for (int i = column; i < 4; i++) {
                a[row][i] -= factor * a[column][i];
            }
        }
    }
    const double w = a[2][3] / a[2][2];
    const double y = (a[1][3] - a[1][2] * w) / a[1][1];
    return (struct velocity){(a[0][3] - a[0][1] * y - a[0][2] * w) / a[0][0], y, w};
}

static struct velocity fit(const struct jp_four_wheel_config *config, const struct jp_wheels *wheels)
{
    double normal[3][4] = {{0}};

    for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
        const struct vector at = place(config, wheel);
        const struct vector v = rolling(wheels, wheel);
        const double rows[2][4] = {{1, 0, -at.y, v.x}, {0, 1, at.x, v.y}};
        for (int row = 0; row < 2; row++) {
            for (int i = 0; i < 3; i++) {
                for (int j = 0; j < 4; j++) {
                    normal[i][j] += rows[row][i] * rows[row][j];
                }
            }
        }
    }
    return solve(normal);
}

static double slip_of(const struct jp_four_wheel_config *config, const struct jp_wheels *wheels)
{
    const struct velocity best = fit(config, wheels);
    double sum = 0;

    for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
        const double slip = difference(rolling(wheels, wheel), contact(config, &best, wheel));
        sum += slip * slip;
    }
    return sqrt(sum / JP_WHEELS);
}

/* Random robots and commands */

static struct jp_four_wheel_config random_robot(void)
{
    const double wheelbase = log_uniform(0.1, 4);
    const double track = log_uniform(0.1, 4);
    const double least = atan2(wheelbase, track) * 180 / PI;
    const struct jp_four_wheel_config config = {
        .wheelbase = q24(wheelbase),
        .track = q24(track),
        .steering_limit = chance(0.2) ? (int32_t)jp_atan2(q24(wheelbase), q24(track)) : steering(uniform(least, 120)),
        .steering_step = steering(log_uniform(0.05, 30)),
        .speed_max = q24(16),
        .speed_step = q24(log_uniform(0.0003, 0.3)),
    };
    const char *field = "none";
    const enum jp_status status = jp_four_wheel_check(&config, &field);
    TEST_ASSERT_NULL_MESSAGE(field, field);
    TEST_ASSERT_EQUAL_INT(JP_OK, status);
    return config;
}

/* Radii from 0 to infinity, both ways; a part of them to any side. */
static struct jp_twist random_twist(const struct jp_four_wheel_config *config)
{
    const double speed = log_uniform(0.02, 4) * (chance(0.5) ? 1 : -1);
    const double kind = uniform(0, 1);
    struct jp_twist twist = {0, 0, 0};

    if (kind < 0.1) {
        twist.x = q24(speed);
    } else if (kind < 0.2) {
        twist.turn_rate = q24(speed);
    } else if (kind < 0.4) {
        const int32_t angle = steering(uniform(-80, 80));
        if (jp_four_wheel_twist(config, q24(speed), angle, &twist) != JP_OK || abs(twist.turn_rate) > q24(16)) {
            twist.turn_rate = 0;
        }
    } else if (kind < 0.5) { /* about a contact, or close to one */
        const struct vector centre = place(config, (int)uniform(0, JP_WHEELS));
        const double off = chance(0.5) ? 0 : log_uniform(1e-6, 0.1);
        const double turn_rate = fabs(speed);
        twist = (struct jp_twist){q24((centre.y + off) * turn_rate), q24(-centre.x * turn_rate), q24(turn_rate)};
    } else {
        const double radius = log_uniform(0.001, 10000) * (chance(0.5) ? 1 : -1);
        const double direction = kind < 0.75 ? 0 : uniform(-PI, PI);
        const double turn_rate = fabs(speed / radius) > 16 ? 16 : speed / radius;
        twist = (struct jp_twist){q24(speed * cos(direction)), q24(speed * sin(direction)), q24(turn_rate)};
    }
    return twist;
}

static struct jp_wheels random_stand(const struct jp_four_wheel_config *config)
{
    const double limit = config->steering_limit;
    struct jp_wheels wheels;

    for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
        wheels.angle[wheel] = (int32_t)uniform(-limit, limit);
        wheels.speed[wheel] = 0;
    }
    return wheels;
}

/* There and back */

static double fastest(const struct jp_four_wheel_config *config, const struct velocity *velocity)
{
    double most = 0;

    for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
        const struct vector v = contact(config, velocity, wheel);
        most = fmax(most, hypot(v.x, v.y));
    }
    return most;
}

static bool has_held_wheel(const struct jp_four_wheel_config *config, const struct velocity *velocity)
{
    bool held = false;

    for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
        const struct vector v = contact(config, velocity, wheel);
        held = held || hypot(v.x, v.y) < HOLD + QUANTUM;
    }
    return held;
}

/* The angle that is nearest to `from` among those within the limit and along v, or as far off as any. */
static double nearest_turn(double limit, struct vector v, double from)
{
    double least = INFINITY;

    for (int half = -2; half <= 2; half++) {
        const double angle = atan2(v.y, v.x) + half * PI;
        if (fabs(angle) <= limit) {
            least = fmin(least, fabs(angle - from));
        }
    }
    return least;
}

/* A limited wheel is off by what the formats tell at most, and the oracle then finds none or the other way. */
static void check_wheel(const struct jp_four_wheel_config *config, const struct jp_wheels *before,
                        const struct jp_wheels *after, int wheel, struct vector wanted)
{
    const double limit = config->steering_limit * STEERING;
    const double turn = fabs(after->angle[wheel] * STEERING - before->angle[wheel] * STEERING);
    const double slack = 4 * QUANTUM / hypot(wanted.x, wanted.y);

    TEST_ASSERT_TRUE(abs(after->angle[wheel]) <= config->steering_limit);
    if (fabs(after->angle[wheel] * STEERING) < limit - slack) {
        TEST_ASSERT_TRUE(turn <= nearest_turn(limit, wanted, before->angle[wheel] * STEERING) + slack);
    }
}

/* Whether the oracle finds a way for all wheels, with a margin to either side of the decision. */
static bool is_feasible(const struct jp_four_wheel_config *config, const struct velocity *velocity, double margin)
{
    for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
        const struct vector v = contact(config, velocity, wheel);
        const double size = hypot(v.x, v.y);
        const double limit = config->steering_limit * STEERING + margin * 8 * QUANTUM / size;
        if (size > config->speed_max / Q24 + margin * QUANTUM || (size >= HOLD && nearest_turn(limit, v, 0) > 2 * PI)) {
            return false;
        }
    }
    return true;
}

/* False: a wheel holds, and so slides. */
static bool check_back(const struct jp_four_wheel_config *config, const struct velocity *velocity,
                       const struct jp_wheels *wheels)
{
    struct jp_twist back;
    jp_q24 slip = 0;

    jp_four_wheel_forward(config, wheels, &back, &slip);
    const struct velocity got = velocity_of(&back);
    const struct velocity error = {got.x - velocity->x, got.y - velocity->y, got.turn_rate - velocity->turn_rate};
    if (has_held_wheel(config, velocity)) {
        worst.held++;
        worst.held_slip = fmax(worst.held_slip, slip / Q24);
        return false;
    }
    worst.twist = fmax(worst.twist, fastest(config, &error) / fastest(config, velocity));
    worst.residual = fmax(worst.residual, slip_of(config, wheels));
    worst.slip = fmax(worst.slip, slip / Q24);
    return true;
}

/* False: the core refuses the twist, as the oracle does, or a wheel holds. */
static bool there_and_back(void)
{
    const struct jp_four_wheel_config config = random_robot();
    const struct jp_twist twist = random_twist(&config);
    const struct velocity velocity = velocity_of(&twist);
    const struct jp_wheels before = random_stand(&config);
    struct jp_wheels wheels = before;

    if (jp_four_wheel_inverse(&config, &twist, &wheels) != JP_OK) {
        TEST_ASSERT_FALSE(is_feasible(&config, &velocity, -1));
        TEST_ASSERT_EQUAL_MEMORY(&before, &wheels, sizeof wheels);
        return false;
    }
    TEST_ASSERT_TRUE(is_feasible(&config, &velocity, 1));
    for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
        const struct vector wanted = contact(&config, &velocity, wheel);
        if (hypot(wanted.x, wanted.y) >= HOLD + QUANTUM) {
            worst.contact = fmax(worst.contact, difference(rolling(&wheels, wheel), wanted));
            check_wheel(&config, &before, &wheels, wheel, wanted);
        }
    }
    return check_back(&config, &velocity, &wheels);
}

static void test_there_and_back(void)
{
    for (unsigned long done = 0; done < options.count;) {
        done += there_and_back() ? 1 : 0;
    }
    printf("%lu commands: twist back to %.2g of the fastest contact; contacts within %.2g m/s; slip of the formats "
           "%.3g m/s (%.2f 2^-24), reported %.3g; %lu more with a wheel that holds, slip up to %.3g m/s\n",
           options.count, worst.twist, worst.contact, worst.residual, worst.residual * Q24, worst.slip, worst.held,
           worst.held_slip);
    TEST_ASSERT_TRUE(worst.twist <= TWIST_BAR);
    TEST_ASSERT_TRUE(worst.residual <= SLIP_BAR);
    TEST_ASSERT_TRUE(worst.slip <= 0);
    TEST_ASSERT_TRUE(worst.contact <= SLIP_BAR + 2 * QUANTUM);
    TEST_ASSERT_TRUE(worst.held_slip <= HOLD / 2);
}

/* Twist and slip of wheels that have nothing in common. */
static void test_forward_of_any_wheels(void)
{
    for (unsigned long i = 0; i < options.count; i++) {
        const struct jp_four_wheel_config config = random_robot();
        struct jp_wheels wheels;
        struct jp_twist twist;
        jp_q24 slip = 0;

        for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
            wheels.angle[wheel] = (int32_t)uniform(-TURN / 2, TURN / 2);
            wheels.speed[wheel] = q24(uniform(-4, 4));
        }
        jp_four_wheel_forward(&config, &wheels, &twist, &slip);
        const struct velocity exact = fit(&config, &wheels);
        const struct velocity got = velocity_of(&twist);
        const double scale = 1 + fabs(exact.turn_rate);
        TEST_ASSERT_TRUE(fabs(got.x - exact.x) <= QUANTUM);
        TEST_ASSERT_TRUE(fabs(got.y - exact.y) <= QUANTUM);
        TEST_ASSERT_TRUE(fabs(exact.turn_rate) > 127 || fabs(got.turn_rate - exact.turn_rate) <= 8 * QUANTUM * scale);
        TEST_ASSERT_TRUE(fabs(slip / Q24 - slip_of(&config, &wheels)) <= SLIP_BAR);
    }
}

static void test_least_radius_is_feasible_and_least(void)
{
    for (unsigned long i = 0; i < options.count; i++) {
        const struct jp_four_wheel_config config = random_robot();
        const double radius = jp_four_wheel_radius_min(&config) / Q24;
        const double side = chance(0.5) ? 1 : -1;
        const double larger = radius * (1 + (chance(0.5) ? log_uniform(1e-3, 1e3) : 1e-3)) + 0.01;
        const double most = 15 / (larger + 3); /* rad/s that no wheel is too fast for */
        const double speed = fmin(log_uniform(0.02, 4), most * larger);
        const struct jp_twist twist = {q24(speed), 0, q24(side * speed / larger)};
        const struct jp_twist tight = {q24(speed), 0, q24(side * speed / (0.999 * radius - 1e-6))};
        struct jp_wheels wheels = {{0}, {0}};

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_inverse(&config, &twist, &wheels));
        if (config.steering_limit < steering(89) && abs(tight.turn_rate) < q24(16) && speed > 0.1) {
            TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, jp_four_wheel_inverse(&config, &tight, &wheels));
        }
    }
}

/* One wheel rolls SLIDE faster than its contact moves. */
static void test_a_sliding_wheel_is_told(void)
{
    worst.slide_least = INFINITY;
    for (unsigned long i = 0; i < options.count; i++) {
        const struct jp_four_wheel_config config = random_robot();
        const struct jp_twist twist = random_twist(&config);
        struct jp_wheels wheels = random_stand(&config);
        const int wheel = (int)uniform(0, JP_WHEELS);
        struct jp_twist back;
        jp_q24 slip = 0;

        const bool is_feasible = jp_four_wheel_inverse(&config, &twist, &wheels) == JP_OK;
        const double speed = fabs(wheels.speed[wheel] / Q24);
        if (is_feasible && speed > 0.01 && speed < 16 / (1 + SLIDE)) {
            wheels.speed[wheel] += (jp_q24)(SLIDE * wheels.speed[wheel]);
            jp_four_wheel_forward(&config, &wheels, &back, &slip);
            worst.slide_least = fmin(worst.slide_least, slip / Q24 / speed);
            TEST_ASSERT_TRUE(slip / Q24 >= SLIDE_SHARE * speed);
            TEST_ASSERT_TRUE(slip / Q24 <= SLIDE_SHARE_MOST * speed + HOLD);
        }
    }
    printf("a wheel %.0f %% too fast gives a slip of at least %.4f of its speed\n", 100 * SLIDE, worst.slide_least);
}

/* In motion */

struct drive {
    struct jp_four_wheel_config config;
    struct jp_wheels wheels;
    double slip;
};

static void tick(struct drive *drive, const struct jp_twist *twist, enum jp_status expected, enum jp_steering *steering)
{
    const struct jp_wheels before = drive->wheels;

    TEST_ASSERT_EQUAL_INT(expected, jp_four_wheel_tick(&drive->config, twist, &drive->wheels, steering));
    for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
        const int64_t turn = (int64_t)drive->wheels.angle[wheel] - before.angle[wheel];
        const int64_t change = (int64_t)drive->wheels.speed[wheel] - before.speed[wheel];
        TEST_ASSERT_TRUE(llabs(turn) <= drive->config.steering_step);
        TEST_ASSERT_TRUE(llabs(change) <= drive->config.speed_step);
        TEST_ASSERT_TRUE(abs(drive->wheels.angle[wheel]) <= drive->config.steering_limit);
    }
    const double slip = slip_of(&drive->config, &drive->wheels);
    worst.drag = fmax(worst.drag, slip - drive->slip);
    drive->slip = slip;
    worst.ticks++;
}

static unsigned long ticks_stated(const struct jp_four_wheel_config *config)
{
    return (unsigned long)(420.0 / 360 * TURN / config->steering_step + 10.0 * config->speed_max / config->speed_step +
                           16);
}

static bool equal(const struct jp_wheels *a, const struct jp_wheels *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

/* A feasible twist is reached, and then nothing changes any more; each wheel turns one way only. */
static void arrive(struct drive *drive, const struct jp_twist *twist)
{
    const unsigned long limit = ticks_stated(&drive->config);
    enum jp_steering steering = JP_STEERING_LIMITED;
    unsigned long ticks = 0;
    int way[JP_WHEELS] = {0};

    while (steering != JP_STEERING_ALIGNED) {
        const struct jp_wheels before = drive->wheels;
        tick(drive, twist, JP_OK, &steering);
        for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
            const int32_t turn = drive->wheels.angle[wheel] - before.angle[wheel];
            const int now = (turn > 0) - (turn < 0);
            const double size = fabs(drive->wheels.speed[wheel] / Q24);
            const bool is_noise = fabs(turn * STEERING) * size < 4 * QUANTUM; /* of the formats */
            TEST_ASSERT_TRUE(is_noise || now * way[wheel] >= 0);
            way[wheel] = is_noise ? way[wheel] : now;
        }
        ticks++;
        TEST_ASSERT_TRUE(ticks <= limit);
    }
    worst.arrival = fmax(worst.arrival, (double)ticks / (double)limit);

    const struct jp_wheels reached = drive->wheels;
    for (int i = 0; i < TICKS_KEPT; i++) {
        tick(drive, twist, JP_OK, &steering);
        TEST_ASSERT_EQUAL_INT(JP_STEERING_ALIGNED, steering);
        TEST_ASSERT_TRUE(equal(&reached, &drive->wheels));
    }
}

static struct jp_twist feasible_twist(const struct jp_four_wheel_config *config)
{
    struct jp_twist twist;
    struct jp_wheels wheels;

    do {
        twist = random_twist(config);
        wheels = random_stand(config);
    } while (jp_four_wheel_inverse(config, &twist, &wheels) != JP_OK);
    return twist;
}

static void halt(struct drive *drive, const struct jp_twist *twist, enum jp_status expected)
{
    const long limit = drive->config.speed_max / drive->config.speed_step + 1;
    const struct jp_wheels before = drive->wheels;
    enum jp_steering steering;

    for (long i = 0; i < limit; i++) {
        tick(drive, twist, expected, &steering);
    }
    for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
        TEST_ASSERT_EQUAL_INT32(0, drive->wheels.speed[wheel]);
        TEST_ASSERT_EQUAL_INT32(before.angle[wheel], drive->wheels.angle[wheel]);
    }
    TEST_ASSERT_EQUAL_INT(expected == JP_OK ? JP_STEERING_ALIGNED : JP_STEERING_STANDSTILL, steering);
}

/* Rates that make a drive of some thousand ticks. */
static struct drive random_drive(void)
{
    struct drive drive = {.config = random_robot()};

    drive.config.steering_step = steering(log_uniform(0.2, 20));
    drive.config.speed_step = q24(log_uniform(0.003, 0.3));
    drive.config.speed_max = q24(6);
    drive.wheels = random_stand(&drive.config);
    return drive;
}

static void test_constant_twists_are_reached(void)
{
    const struct jp_twist zero = {0, 0, 0};
    const struct jp_twist refused = {q24(16) + 1, 0, 0};
    const struct jp_twist too_fast = {q24(6) + 1, 0, 0};

    for (unsigned long i = 0; i < options.count / CASES_PER_DRIVE + 1; i++) {
        struct drive drive = random_drive();
        for (int command = 0; command < COMMANDS_PER_DRIVE; command++) {
            const struct jp_twist twist = feasible_twist(&drive.config);
            const double stop = uniform(0, 1);
            arrive(&drive, &twist);
            if (stop < 0.1) {
                halt(&drive, &zero, JP_OK);
            } else if (stop < 0.2) {
                halt(&drive, &refused, JP_ERR_ARGUMENT);
            } else if (stop < 0.3) {
                halt(&drive, &too_fast, JP_ERR_INFEASIBLE);
            }
        }
    }
    printf("constant twists: reached within %.2f of the stated ticks at worst\n", worst.arrival);
}

/* Wheels that roll at speeds and angles of no one twist: the limits hold, the twist is reached. */
static void test_any_wheels_come_to_order(void)
{
    for (unsigned long i = 0; i < options.count / 20 + 1; i++) {
        struct drive drive = random_drive();
        const struct jp_twist twist = feasible_twist(&drive.config);
        for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
            drive.wheels.speed[wheel] = chance(0.2) ? 0 : q24(uniform(-6, 6));
        }
        drive.slip = INFINITY;
        arrive(&drive, &twist);
    }
}

/* Commands that change before they are reached, at random and little by little. */
static void test_commands_in_motion_drag_no_wheel(void)
{
    worst.drag = 0;
    for (unsigned long i = 0; i < options.count / CASES_PER_DRIVE + 1; i++) {
        struct drive drive = random_drive();
        for (int command = 0; command < COMMANDS_PER_DRIVE; command++) {
            struct jp_twist twist = feasible_twist(&drive.config);
            const int ticks = (int)log_uniform(1, 200);
            const jp_q24 drift = q24(uniform(-0.01, 0.01));
            for (int t = 0; t < ticks; t++) {
                struct jp_wheels wheels = drive.wheels;
                enum jp_steering steering;
                twist.turn_rate = jp_clamp32(twist.turn_rate + drift, -q24(16), q24(16));
                tick(&drive, &twist, jp_four_wheel_inverse(&drive.config, &twist, &wheels), &steering);
                worst.dragged = fmax(worst.dragged, drive.slip);
            }
        }
    }
    printf("%lu ticks: slip grows by %.3g m/s in a tick at most, and is never above %.3g m/s\n", worst.ticks,
           worst.drag, worst.dragged);
    TEST_ASSERT_TRUE(worst.drag <= DRAG_BAR);
    TEST_ASSERT_TRUE(worst.dragged <= DRAGGED_BAR);
}

static void add_figures(json_t *figures)
{
    const char *command = "make figures";

    figures_add(figures, command, 100 * worst.twist, "%", at_most(100 * TWIST_BAR),
                "four wheels: inverse then forward, worst error of %lu twists, of the fastest contact", options.count);
    figures_add(figures, command, worst.slip, "m/s", at_most(0), "four wheels: largest slip told without slip");
    figures_add(figures, command, worst.residual, "m/s", at_most(SLIP_BAR),
                "four wheels: largest slip that the formats cause, before it counts as 0");
    figures_add(figures, command, worst.held_slip, "m/s", at_most(HOLD / 2),
                "four wheels: largest slip of a wheel too slow to steer, which keeps its angle");
    figures_add(figures, command, 100 * worst.slide_least, "%", at_least(100 * SLIDE_SHARE),
                "four wheels: least slip told of a wheel 20 %% too fast, of its speed");
    figures_add(figures, command, 100 * worst.arrival, "%", at_most(100),
                "four wheels: ticks until a twist is reached, worst part of the stated bound");
    figures_add(figures, command, worst.dragged, "m/s", at_most(DRAGGED_BAR),
                "four wheels: largest slip that commands in motion cause");
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, add_figures);
}
