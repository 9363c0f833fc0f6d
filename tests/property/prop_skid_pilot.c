/*
 * Robots that their sides steer drive random routes by their pilots, in closed loop with noise: what was planned
 * against what their meters say, where they arrive, what they learn, and the books of energy. Each third route is
 * replaced by another one on its way.
 *
 * prop_skid_pilot [--count N] [--seed S]
 * --count is the number of routes of each robot.
 */
#include <math.h>

#include "sim/base/random.h"
#include "sim/missions/navigation_skid.h"
#include "tests/support/options.h"

/* Of a single route's energy, forecast before the start; the first ones with hardly anything learned. */
#define FORECAST_BAR 0.15

/* Arrival: what a path is left by (prop_skid_follow.c), m; share of the way; and what turns that a gyro tells by its
 * scale error too large lead astray on the way after them. */
#define TRACKING_BAR 0.05
#define DRIFT_BAR    0.01

/* Of the energy, by the plant's ledger. */
#define BALANCE_BAR 1e-3

#define TARGETS_MAX 6

/* A line takes so long, s, and turns from the one before it by so much at most. */
#define LINE_SECONDS_MIN 4.0
#define LINE_SECONDS_MAX 12.0
#define TURN_MAX         2.6

/* Each fourth line goes on almost straight: by this share of a turn. */
#define SLIGHT 0.001

#define Q16     65536.0
#define JOULE   4294967296.0
#define RADIANS (2 * M_PI / 4294967296.0)

static const struct options defaults = {.count = 6, .seed = 3};
static struct options options;
static struct random noise;

static const char *const names[] = {"zhang2018", "burger"};
enum { ROBOTS = sizeof names / sizeof names[0] };

static struct robot {
    struct navigation_skid skid;
    struct navigation_robot shown;
    struct skid_steer_model model;
} robot;

static struct route {
    struct jp_point targets[TARGETS_MAX];
    uint16_t count;
    double length; /* m */
    double turned; /* rad, over the m that come after, summed up */
} route;

/* Worst of the routes. */
struct errors {
    double forecast; /* over what was driven */
    double arrival;  /* over what it may be */
};

void setUp(void)
{
    random_init(&noise, options.seed);
}

void tearDown(void)
{
}

static unsigned random_below(unsigned bound)
{
    return (unsigned)random_uniform(&noise, 0, bound);
}

static struct jp_skid_pilot *pilot(void)
{
    return &robot.skid.pilot;
}

static void begin(int index)
{
    const struct jp_terrain level = {.config = {.has_elevation = false}};
    const struct clearance_pose origin = {0, 0, 0};
    char path[64];

    (void)snprintf(path, sizeof path, "sim/robots/%s.cfg", names[index]);
    TEST_ASSERT_TRUE(skid_robot_load(path, &robot.model));
    TEST_ASSERT_TRUE(navigation_skid_init(&robot.skid, skid_robot_find(names[index]), &robot.model, &level, NULL,
                                          &origin, options.seed, &robot.shown));
}

/* ---- Routes ---- */

/* From where odometry sees the robot. */
static void draw_route(void)
{
    struct jp_vehicle_view view;

    robot.shown.vehicle.look(robot.shown.vehicle.context, &view);
    double x = view.position.x / Q16;
    double y = view.position.y / Q16;
    double heading = (int32_t)view.heading * RADIANS;

    route.count = (uint16_t)(2 + random_below(TARGETS_MAX - 1));
    route.length = 0;
    route.turned = 0;
    double turned = 0;

    for (uint16_t i = 0; i < route.count; i++) {
        const double length =
            robot.model.lattice.speed_m_s * random_uniform(&noise, LINE_SECONDS_MIN, LINE_SECONDS_MAX);

        const double bend = random_uniform(&noise, -TURN_MAX, TURN_MAX);
        const double turn = random_below(4) == 0 ? SLIGHT * bend : bend;

        heading += turn;
        turned += fabs(turn);
        route.turned += turned * length;
        x += length * cos(heading);
        y += length * sin(heading);
        route.length += length;
        route.targets[i] = (struct jp_point){(jp_q16)lround(x * Q16), (jp_q16)lround(y * Q16)};
    }
}

/* Every other route rounds its corners, within half of the robot's track. */
static void follow(unsigned number)
{
    const struct jp_skid_pilot_route followed = {
        .targets = route.targets, .count = route.count, .slower = (uint8_t)random_below(3)};

    pilot()->config.corner = number % 2 == 0 ? pilot()->config.limits.width / 2 : 0;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_follow(pilot(), &followed));
}

/* ---- Drives ---- */

/* What the legs of a route took, by the pilot and by the meter from when the first one began. */
struct books {
    jp_energy legs;
    jp_energy before;
};

static jp_energy metered(void)
{
    return jp_skid_robot_meter(&robot.skid.controller)->battery;
}

static void tick(struct books *books)
{
    const uint16_t ended = pilot()->legs_ended;
    const uint16_t begun = pilot()->legs_begun;

    robot.shown.tick(robot.shown.self);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_work(pilot()));
    if (begun == 0 && pilot()->legs_begun == 1) {
        books->before = metered();
    }
    if (pilot()->legs_ended > ended) {
        books->legs += pilot()->result.energy;
        TEST_ASSERT_TRUE(books->legs == metered() - books->before);
    }
}

static void drive_to_rest(struct books *books)
{
    while (pilot()->phase != JP_SKID_PILOT_RESTING) {
        tick(books);
    }
}

static double arrival_bar(void)
{
    return TRACKING_BAR + DRIFT_BAR * route.length + robot.model.gyro.scale_error * route.turned;
}

/* The last target, where the robot was at `seen` by odometry and at `truth` in truth. */
static double arrival_error(const struct clearance_pose *truth, const struct jp_vehicle_view *seen)
{
    const struct jp_point *target = &route.targets[route.count - 1U];
    const double dx = (target->x - seen->position.x) / Q16;
    const double dy = (target->y - seen->position.y) / Q16;
    const double turned = truth->heading - (int32_t)seen->heading * RADIANS;
    const struct clearance_pose end = robot.shown.pose(robot.shown.self);

    return hypot(truth->x + dx * cos(turned) - dy * sin(turned) - end.x,
                 truth->y + dx * sin(turned) + dy * cos(turned) - end.y);
}

/* Some way of it, until another one replaces it. */
static void drive_a_part(unsigned number)
{
    struct books books = {0, 0};
    const uint32_t left_out = pilot()->legs_left_out;

    draw_route();
    follow(number);
    for (int i = (int)(random_uniform(&noise, 0.1, 30) * robot.shown.rate_hz); i > 0; i--) {
        tick(&books);
    }
    const bool cut = pilot()->phase == JP_SKID_PILOT_DRIVING && pilot()->legs_begun > pilot()->legs_ended;

    draw_route();
    follow(number);
    TEST_ASSERT_EQUAL_UINT32(left_out + (cut ? 1U : 0U), pilot()->legs_left_out);
    while (pilot()->phase == JP_SKID_PILOT_PLANNING) {
        tick(&books);
    }
    jp_skid_pilot_stop(pilot());
    for (int i = 0; i < (int)(2 * robot.shown.rate_hz); i++) {
        tick(&books);
    }
    TEST_ASSERT_EQUAL_INT(JP_SKID_ROBOT_STANDING, jp_skid_robot_state_now(&robot.skid.controller));
}

static void drive_route(unsigned number, struct errors *errors)
{
    const struct clearance_pose truth = robot.shown.pose(robot.shown.self);
    const uint32_t left_out = pilot()->legs_left_out;
    const uint32_t learned_from = pilot()->legs_learned_from;
    struct books books = {0, 0};
    struct jp_vehicle_view seen;
    struct jp_forecast forecast;

    robot.shown.vehicle.look(robot.shown.vehicle.context, &seen);
    draw_route();
    follow(number);
    drive_to_rest(&books);
    TEST_ASSERT_EQUAL_UINT16(route.count, pilot()->legs_ended);
    TEST_ASSERT_EQUAL_UINT32(left_out, pilot()->legs_left_out);
    TEST_ASSERT_EQUAL_UINT32(learned_from + route.count, pilot()->legs_learned_from);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_answer(pilot(), &forecast));

    const double planned = ldexp(forecast.energy / Q16, robot.shown.unit_exponent);
    const double driven = (double)books.legs / JOULE;
    const double off = arrival_error(&truth, &seen);

    if (options.verbose) {
        printf("%s: %u targets, %.1f m: planned %.1f J, driven %.1f J, arrived %.1f cm off\n", robot.shown.name,
               route.count, route.length, planned, driven, 100 * off);
    }
    errors->forecast = fmax(errors->forecast, fabs(planned / driven - 1));
    errors->arrival = fmax(errors->arrival, off / arrival_bar());
}

static void expect_balance(void)
{
    const struct skid_plant *plant = &robot.skid.world.plant;

    TEST_ASSERT_TRUE(fabs(skid_plant_residual(plant, 0)) <= BALANCE_BAR * plant->state.ledger.battery);
}

static void test_random_routes(void)
{
    for (int index = 0; index < ROBOTS; index++) {
        struct errors errors = {0, 0};

        begin(index);
        for (unsigned number = 0; number < (unsigned)options.count; number++) {
            if (number % 3 == 2) {
                drive_a_part(number);
            }
            drive_route(number, &errors);
        }
        expect_balance();
        printf("%s, %lu routes: planned energy off by %.2f %% at most, arrival by %.2f of its bar\n", robot.shown.name,
               options.count, 100 * errors.forecast, errors.arrival);
        TEST_ASSERT_TRUE(errors.forecast <= FORECAST_BAR);
        TEST_ASSERT_TRUE(errors.arrival <= 1);
    }
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, defaults);
    return RUN_PROPERTY(options, NULL);
}
