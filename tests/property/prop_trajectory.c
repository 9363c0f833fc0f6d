/*
 * Trajectories by rule on random routes of both robots: what the evaluator says, interval by interval, is followed in
 * double precision. It passes every waypoint, as is given where it is, nothing jumps, the voltage is kept, and the
 * energy is the one foretold.
 *
 * prop_trajectory [--count N] [--seed S] [--verbose]
 * --count is the number of routes.
 */
#include <joulepath/trajectory_energy.h>
#include <joulepath/trajectory_rule.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "src/trajectory/trajectory_blend.h"
#include "tests/support/options.h"
#include "tests/support/random_route.h"
#include "unity.h"

#define PI 3.14159265358979323846

#define MISS_M       0.003 /* and what is covered in a set-point's time */
#define ENERGY_SHARE 0.001
#define VOLTAGE_OVER                                                                                                   \
    2 /* turns are counted between the lines of the targets; those of the middles turn a little more                   \
       */

/* Of the routes that begin at rest and do not turn round at once, at most this share is infeasible. */
#define INFEASIBLE 0.01

/* So much of a turn at the start is turning round. The way that the robot rolls meanwhile may want more than half a
 * turn, which the rule does not make. */
#define ROUND 0.45

/* Modes that add less to the voltage have decayed, V. */
#define DECAYED 0.01

/* The largest derivatives of the quintic from 0 to 1. */
#define RISE_1 1.875
#define RISE_2 5.7735026918962576
#define RISE_3 60.0

enum { LEGS = 8 };

struct route {
    const struct route_robot *robot;
    struct jp_trajectory_task task;
    struct jp_point targets[LEGS];
    struct jp_passage passages[LEGS];
    struct jp_trajectory_leg legs[LEGS];
    struct jp_trajectory trajectory;
};

struct pose {
    double x;
    double y;
    double heading; /* turn */
};

/* The most that may change from a set-point to the next. */
struct jumps {
    double wheel_rate;
    double yaw_rate;
    double pitch;
    double pitch_rate;
};

/* The worst of one route, or of all. */
struct result {
    double miss;      /* m, beyond the bar */
    double jump;      /* as a part of what is allowed */
    double energy;    /* relative error */
    double over;      /* voltage above the limit, V; after the transients of the start */
    double transient; /* voltage in these, as a part of the limit */
};

static struct result result;
static struct result worst = {.miss = -1, .over = -1000};

static struct {
    unsigned long moving; /* the first leg is too short for the motion that it begins with */
    unsigned long round;
    unsigned long given; /* its leg is too short for what is given */
    unsigned long other;
} infeasible;

static unsigned long plain; /* routes that are none of them */
static struct options options = {.count = 200, .seed = 1};

void setUp(void)
{
}

void tearDown(void)
{
}

/* ---- Random routes ---- */

/* In turn: any, next to nothing, or next to half a turn. */
static double random_turn(void)
{
    switch (random_word() % 4) {
    case 0:
        return 0.5 + uniform(-0.01, 0.01);
    case 1:
        return uniform(-0.05, 0.05);
    default:
        return uniform(-0.5, 0.5);
    }
}

static struct jp_travel_state random_motion(void)
{
    if (random_word() % 2 == 0) {
        return (struct jp_travel_state){0};
    }
    return (struct jp_travel_state){
        .speed = to_q24(uniform(-0.5, 1)),
        .pitch = to_q24(uniform(-0.02, 0.02)),
        .pitch_rate = to_q24(uniform(-0.1, 0.1)),
        .turn_rate = to_q24(uniform(-0.1, 0.1)),
    };
}

/* Of every other route: a heading about that of the leg, a speed slower or faster than the cruise, or nothing. */
static const struct jp_passage *draw_passages(struct route *route)
{
    if (random_word() % 2 == 0) {
        return NULL;
    }
    for (unsigned i = 0; i < route->task.count; i++) {
        const struct jp_point *from = i == 0 ? &route->task.start : &route->targets[i - 1];
        const double x = route->targets[i].x - from->x;
        const double y = route->targets[i].y - from->y;
        const double heading = atan2(y, x) / (2 * PI) + uniform(-0.25, 0.25);

        route->passages[i] = (struct jp_passage){
            .given = (uint8_t)(random_word() % 4),
            .heading = (jp_angle)(int64_t)(heading * 4294967296.0),
            .speed = to_q24(q24(route->task.cruise) * uniform(0.2, 1.2)),
        };
    }
    return route->passages;
}

static void draw(struct route *route)
{
    struct route_end end = {.direction = uniform(-0.5, 0.5)};

    end.at.x = to_q16(uniform(-1000, 1000));
    end.at.y = to_q16(uniform(-1000, 1000));
    route->robot = draw_robot();
    route->task = (struct jp_trajectory_task){
        .config = &route->robot->config->trajectory,
        .cruise = to_q24(log_uniform(0.1, 1)),
        .start = end.at,
        .heading = (jp_angle)(int64_t)(end.direction * 4294967296.0),
        .motion = random_motion(),
        .targets = route->targets,
        .count = (uint16_t)(1 + random_word() % LEGS),
        .to_stand = random_word() % 2 == 0,
    };
    for (unsigned i = 0; i < route->task.count; i++) {
        const double length = log_uniform(0.3, 15);

        route->targets[i] = add_leg(&end, length, random_turn());
    }
    route->task.passages = draw_passages(route);
}

/* ---- The pieces, in double ---- */

static double seconds(const struct route *route, uint32_t set_points)
{
    return (double)JP_TICKS_PER_SET_POINT * set_points / route->task.config->tick_rate;
}

/* What modes change from a set-point to the next. */
static void add_modes(const struct route *route, double time, struct jumps *jumps)
{
    const struct jp_trajectory_config *config = route->task.config;
    const double interval = seconds(route, 1);

    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        const double rate = q16(config->modes.decay[i]) * log(2);
        const double change = fabs(q24(route->trajectory.transient[i]) / 16) * exp(-rate * time) * rate * interval;

        jumps->wheel_rate += q24(config->turns_per_metre) * change;
        jumps->pitch += fabs(q24(config->modes.lean[i])) * change;
        jumps->pitch_rate += fabs(q24(config->modes.lean_rate[i])) * change;
    }
}

/* The voltage of the modes. */
static double modes_voltage(const struct route *route, double time)
{
    const struct jp_trajectory_config *config = route->task.config;
    double volts = 0;

    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        volts += fabs(q16(config->modes.volts[i]) * q24(route->trajectory.transient[i]) / 16) *
                 exp(-q16(config->modes.decay[i]) * log(2) * time);
    }
    return volts;
}

static struct jumps jumps_of_blend(const struct route *route, const struct jp_waypoint_motion *from,
                                   const struct jp_waypoint_motion *to, jp_angle by, uint32_t set_points)
{
    const struct jp_trajectory_config *config = route->task.config;
    const double interval = seconds(route, 1);
    const double time = seconds(route, set_points);
    const double first = fabs(q24(to->speed - from->speed)) * RISE_1 / time * interval;
    const double second = first / RISE_1 * RISE_2 / time;
    const double third = second / RISE_2 * RISE_3 / time;
    const double turned = jp_turn_by(from->heading, by, to->heading) / 2147483648.0;
    const double bend = 6 * turned / time - 3 * (q24(from->turn_rate) + q24(to->turn_rate));

    return (struct jumps){
        .wheel_rate = q24(config->turns_per_metre) * (first + q24(config->lag) * third),
        .yaw_rate = (fabs(q24(to->turn_rate - from->turn_rate)) + fabs(bend)) / time * interval,
        .pitch = fabs(q24(config->lean[0])) * first + fabs(q24(config->lean[1])) * second,
        .pitch_rate = fabs(q24(config->lean[0])) * second + fabs(q24(config->lean[1])) * third,
    };
}

/* ---- Driving ---- */

struct drive {
    const struct route *route;
    struct jp_trajectory_drive evaluator;
    struct jp_set_point before;
    struct pose pose;
    uint32_t set_points;
    double squares; /* V² */
};

static void advance_pose(struct drive *drive, const struct jp_set_point *now)
{
    const double interval = seconds(drive->route, 1);
    const double turned = (q24(drive->before.yaw_rate) + q24(now->yaw_rate)) / 2 * interval;
    const double way = (q24(drive->before.wheel_rate) + q24(now->wheel_rate)) / 2 * interval /
                       q24(drive->route->task.config->turns_per_metre);
    const double mean = 2 * PI * (drive->pose.heading + turned / 2);

    drive->pose.heading += turned;
    drive->pose.x += way * cos(mean);
    drive->pose.y += way * sin(mean);
}

static void check_jump(double change, double allowed)
{
    const double slack = 40.0 / 16777216; /* roundings of both set_points */
    const double part = fabs(change) / (1.01 * allowed + slack);

    result.jump = fmax(result.jump, part);
}

static void check_jumps(const struct drive *drive, const struct jp_set_point *now, const struct jumps *piece)
{
    struct jumps allowed = *piece;

    add_modes(drive->route, seconds(drive->route, drive->set_points - 1), &allowed);
    check_jump(q24(now->wheel_rate - drive->before.wheel_rate), allowed.wheel_rate);
    check_jump(q24(now->yaw_rate - drive->before.yaw_rate), allowed.yaw_rate);
    check_jump(q24(now->pitch - drive->before.pitch), allowed.pitch);
    check_jump(q24(now->pitch_rate - drive->before.pitch_rate), allowed.pitch_rate);
}

static void check_voltage(const struct drive *drive, const struct jp_set_point *now)
{
    const struct route *route = drive->route;
    const double volts = fabs(q16(now->common)) + fabs(q16(now->difference));
    const double limit = q16(route->task.config->voltage);
    const bool turned_at_start =
        route->task.motion.turn_rate != 0 && drive->set_points < route->legs[0].begin.set_points;

    if (turned_at_start || modes_voltage(route, seconds(route, drive->set_points)) > DECAYED) {
        result.transient = fmax(result.transient, volts / limit);
        return;
    }
    result.over = fmax(result.over, volts - limit);
}

static double square_of(const struct jp_set_point *at)
{
    return q16(at->common) * q16(at->common) + q16(at->difference) * q16(at->difference);
}

/* The energy is that of voltages that change all the time, so the integral is the trapezoidal rule's, piece by piece.
 */
static void drive_piece(struct drive *drive, const struct jumps *jumps, uint32_t set_points)
{
    double slope = 0;

    for (uint32_t i = 0; i < set_points; i++) {
        struct jp_set_point now;

        TEST_ASSERT_TRUE(jp_trajectory_advance(&drive->evaluator, drive->route->task.config, &now));
        if (drive->set_points > 0) {
            advance_pose(drive, &now);
            check_jumps(drive, &now, jumps);
        }
        check_voltage(drive, &now);
        if (i == 0) {
            drive->squares -= square_of(&now) / 2;
        } else {
            slope = square_of(&now) - square_of(&drive->before);
        }
        drive->squares += square_of(&now);
        drive->before = now;
        drive->set_points++;
    }
    drive->squares += (square_of(&drive->before) + slope) / 2;
}

static struct jumps larger(struct jumps a, struct jumps b)
{
    return (struct jumps){fmax(a.wheel_rate, b.wheel_rate), fmax(a.yaw_rate, b.yaw_rate), fmax(a.pitch, b.pitch),
                          fmax(a.pitch_rate, b.pitch_rate)};
}

/* Where the leg ends, an interval after its last set-point. */
static void check_arrival(const struct drive *drive, unsigned leg)
{
    const struct route *route = drive->route;
    const struct jp_waypoint_motion *motion = &route->legs[leg].next;
    const double turns_per_metre = q24(route->task.config->turns_per_metre);
    struct drive there = *drive;
    struct jp_set_point end = {.yaw_rate = motion->turn_rate};
    double speed = q24(motion->speed);

    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        speed += q24(route->trajectory.transient[i]) / 16 *
                 exp(-q16(route->task.config->modes.decay[i]) * log(2) * seconds(route, drive->set_points));
    }
    end.wheel_rate = to_q24(speed * turns_per_metre);
    advance_pose(&there, &end);

    const double miss = hypot(there.pose.x - q16(route->targets[leg].x), there.pose.y - q16(route->targets[leg].y));

    result.miss = fmax(result.miss, miss - MISS_M - q24(route->task.cruise) * seconds(route, 1));
}

static void check_given(const struct route *route, unsigned leg)
{
    const struct jp_passage *passage = &route->task.passages[leg];
    const struct jp_waypoint_motion *motion = &route->legs[leg].next;
    const bool stands = route->task.to_stand && leg + 1U == route->task.count;

    if ((passage->given & JP_GIVEN_HEADING) != 0) {
        TEST_ASSERT_EQUAL_HEX32(passage->heading, motion->heading);
    }
    if ((passage->given & JP_GIVEN_SPEED) != 0) {
        TEST_ASSERT_EQUAL_INT32(stands ? 0 : passage->speed, motion->speed);
    }
}

static void check_energy(const struct drive *drive)
{
    const struct jp_trajectory_config *config = drive->route->task.config;
    const struct jp_energy_model *built_in = drive->route->robot->model;
    const double interval = seconds(drive->route, 1);
    const double conductance = 2 / q16(built_in->motor_resistance);
    const double exact =
        conductance * drive->squares * interval + q16(built_in->electronics_power) * drive->set_points * interval;
    /* That takes in a steady motion what its voltages do. */
    struct jp_energy_model model = *built_in;
    jp_q16 energy = 0;

    model.b[0] = (jp_q16)lround(conductance * pow(q16(config->volts[0]), 2) * JP_Q16_ONE);
    model.b[1] = (jp_q16)lround(conductance * pow(q16(config->turning[0]) / (2 * M_PI), 2) * JP_Q16_ONE);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_energy(config, &model, &drive->route->trajectory, &energy));

    const double error = fabs(q16(energy) - exact) / exact;

    result.energy = fmax(result.energy, error);
}

static void drive_all(const struct route *route)
{
    const struct jp_waypoint_motion *at = &route->trajectory.start;
    struct drive drive = {
        .route = route,
        .pose = {q16(route->task.start.x), q16(route->task.start.y), route->task.heading / 4294967296.0},
    };
    struct jumps before = {0, 0, 0, 0};
    struct jp_set_point none;

    jp_trajectory_begin(&drive.evaluator, &route->trajectory);
    for (unsigned i = 0; i < route->trajectory.count; i++) {
        const struct jp_trajectory_leg *leg = &route->legs[i];
        const struct jp_waypoint_motion middle = {leg->heading, 0, leg->speed};
        const struct jumps begin = jumps_of_blend(route, at, &middle, leg->chord, leg->begin.set_points);
        const struct jumps end = jumps_of_blend(route, &middle, &leg->next, leg->chord, leg->end.set_points);
        const struct jumps first = larger(before, begin);

        TEST_ASSERT_EQUAL_UINT16(i, jp_trajectory_leg_now(&drive.evaluator));
        drive_piece(&drive, &first, leg->begin.set_points);
        drive_piece(&drive, &begin, leg->middle.set_points);
        drive_piece(&drive, &end, leg->end.set_points);
        check_arrival(&drive, i);
        if (route->task.passages != NULL) {
            check_given(route, i);
        }
        before = end;
        at = &leg->next;
    }
    TEST_ASSERT_FALSE(jp_trajectory_advance(&drive.evaluator, route->task.config, &none));
    check_energy(&drive);
}

/* ---- Cases ---- */

static void print_route(unsigned long index, const struct route *route, enum jp_status status)
{
    const struct jp_trajectory_task *task = &route->task;

    printf("case %lu: %s, status %d, cruise %.3f, start %.3f m/s %.4f turn %.3f turn/s, turning %.3f turn/s%s\n", index,
           route->robot->name, (int)status, q24(task->cruise), q24(task->motion.speed), q24(task->motion.pitch),
           q24(task->motion.pitch_rate), q24(task->motion.turn_rate), task->to_stand ? ", to a stand" : "");
    printf("  heading %.4f:", (int32_t)task->heading / 4294967296.0);
    for (unsigned i = 0; i < task->count; i++) {
        const struct jp_point *from = i == 0 ? &task->start : &task->targets[i - 1];
        const double x = q16(task->targets[i].x - from->x);
        const double y = q16(task->targets[i].y - from->y);

        printf(" %.3f m at %.4f", hypot(x, y), atan2(y, x) / (2 * PI));
        if (task->passages != NULL && (task->passages[i].given & JP_GIVEN_HEADING) != 0) {
            printf(" heading %.4f", (int32_t)task->passages[i].heading / 4294967296.0);
        }
        if (task->passages != NULL && (task->passages[i].given & JP_GIVEN_SPEED) != 0) {
            printf(" %.3f m/s", q24(task->passages[i].speed));
        }
        printf(";");
    }
    printf("\n");
}

static bool is_good(void)
{
    return result.miss <= 0 && result.jump <= 1 && result.energy <= ENERGY_SHARE && result.over <= VOLTAGE_OVER;
}

static void add_to_worst(void)
{
    worst.miss = fmax(worst.miss, result.miss);
    worst.jump = fmax(worst.jump, result.jump);
    worst.energy = fmax(worst.energy, result.energy);
    worst.over = fmax(worst.over, result.over);
    worst.transient = fmax(worst.transient, result.transient);
}

static void print_result(const struct result *of)
{
    printf("miss %.3f mm from the bar, energy %.4f %%, jump %.3f of the allowed; voltage %.2f V above the limit, %.2f "
           "of it at the start\n",
           1000 * of->miss, 100 * of->energy, of->jump, of->over, of->transient);
}

static void count_infeasible(const struct route *route, enum jp_status status)
{
    const struct jp_travel_state *motion = &route->task.motion;
    const bool moves = motion->speed != 0 || motion->turn_rate != 0;
    const double x = q16(route->targets[0].x - route->task.start.x);
    const double y = q16(route->targets[0].y - route->task.start.y);
    const double turn = remainder(atan2(y, x) / (2 * PI) - route->task.heading / 4294967296.0, 1);
    const bool is_round = fabs(turn) > ROUND;
    const unsigned long one = status == JP_ERR_INFEASIBLE ? 1 : 0;

    if (is_round) {
        infeasible.round += one;
    } else if (moves) {
        infeasible.moving += one;
    } else if (route->task.passages != NULL) {
        infeasible.given += one;
    } else {
        infeasible.other += one;
        plain++;
    }
}

/* Whether it is as it should be, or infeasible. */
static bool try_route(unsigned long index)
{
    static struct route route;

    draw(&route);

    const enum jp_status status = jp_trajectory_by_rule(&route.task, route.legs, &route.trajectory);

    result = (struct result){.miss = -1, .over = -1000};
    if (status == JP_OK) {
        drive_all(&route);
        add_to_worst();
    }
    count_infeasible(&route, status);

    const bool good = status == JP_ERR_INFEASIBLE || (status == JP_OK && is_good());

    if (options.verbose || !good) {
        print_route(index, &route, status);
        print_result(&result);
    }
    return good;
}

static void test_random_routes(void)
{
    unsigned long bad = 0;

    random_state = options.seed;
    for (unsigned long k = 0; k < options.count; k++) {
        bad += try_route(k) ? 0 : 1;
    }
    printf("%lu routes, %lu bad; infeasible: %lu that turn round at the start, %lu that begin too fast, %lu too short "
           "for what is given, %lu others of %lu\nworst: ",
           options.count, bad, infeasible.round, infeasible.moving, infeasible.given, infeasible.other, plain);
    print_result(&worst);
    TEST_ASSERT_EQUAL_UINT32(0, bad);
    TEST_ASSERT_TRUE((double)infeasible.other <= INFEASIBLE * (double)plain);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
