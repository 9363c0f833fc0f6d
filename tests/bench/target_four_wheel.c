/** Instructions of the four wheels' kinematics, of their tick and of a tick of pure pursuit: the worst over random
 * states. */
#include <joulepath/four_wheel.h>
#include <joulepath/pure_pursuit.h>
#include <stddef.h>

#include "tests/target/cycles.h"
#include "tests/target/random.h"
#include "tests/target/target.h"

enum { STATES = 2000, POINTS = 200, SEED = 4 };

/* A patrol robot at 100 ticks a second. */
static const struct jp_four_wheel_config robot = {
    .wheelbase = JP_Q24(0.5),
    .track = JP_Q24(0.44),
    .steering_limit = (int32_t)JP_ANGLE_DEGREES(100),
    .steering_step = (int32_t)JP_ANGLE_DEGREES(1.7),
    .speed_max = JP_Q24(4),
    .speed_step = JP_Q24(0.01),
};

static const struct jp_pure_pursuit_config pursuit = {
    .speed = JP_Q24(1),
    .lookahead_time = JP_Q24(0.5),
    .lookahead_min = JP_Q24(0.25),
    .lookahead_max = JP_Q24(4),
    .curvature_max = JP_Q24(2),
    .lateral_acceleration = JP_Q24(1),
    .acceleration = JP_Q24(1),
    .tolerance = JP_Q24(0.02),
};

static uint32_t random_state = SEED;

static uint32_t random_bits(void)
{
    return target_random(&random_state);
}

static int32_t random_between(int32_t low, int32_t high)
{
    return low + (int32_t)(((uint64_t)random_bits() * (uint32_t)(high - low + 1)) >> 32);
}

struct state {
    struct jp_twist twist;
    struct jp_wheels wheels;
    struct jp_twist fitted;
    jp_q24 slip;
    enum jp_steering steering;
};

static struct state before;
static struct state state;

static struct jp_twist random_twist(int32_t part)
{
    return (struct jp_twist){random_between(-JP_Q24(2), JP_Q24(2)) / part, random_between(-JP_Q24(1), JP_Q24(1)) / part,
                             random_between(-JP_Q24(3), JP_Q24(3)) / part};
}

/** In motion at one twist, and asked for another one: in half of the states for one that is reached without a stop. */
static void prepare_wheels(void)
{
    const struct jp_twist twist = random_twist(1);
    const struct jp_twist change = random_twist(random_bits() & 1U ? 16 : 1);

    before.wheels = (struct jp_wheels){{0}, {0}};
    (void)jp_four_wheel_inverse(&robot, &twist, &before.wheels);
    before.twist = (struct jp_twist){twist.x + change.x, twist.y + change.y, twist.turn_rate + change.turn_rate};
}

static void restore(void *argument)
{
    (void)argument;
    state = before;
}

static void inverse(void *argument)
{
    restore(argument);
    (void)jp_four_wheel_inverse(&robot, &state.twist, &state.wheels);
}

static void forward(void *argument)
{
    restore(argument);
    jp_four_wheel_forward(&robot, &state.wheels, &state.fitted, &state.slip);
}

static void tick(void *argument)
{
    restore(argument);
    (void)jp_four_wheel_tick(&robot, &state.twist, &state.wheels, &state.steering);
}

/* Pure pursuit */

struct chase {
    struct jp_pure_pursuit tracker;
    struct jp_point position;
    jp_angle heading;
    jp_q24 speed;
    struct jp_twist twist;
};

static struct jp_point path[POINTS];
static struct chase chase_before;
static struct chase chase;

/** Points 0.02…0.1 m apart along a random bend; the robot is at one of the first JP_PURSUIT_STRIDE. */
static bool prepare_chase(void)
{
    const int32_t spacing = random_between(JP_Q16(0.02), JP_Q16(0.1));
    const int32_t bend = random_between(-(int32_t)JP_ANGLE_DEGREES(2), (int32_t)JP_ANGLE_DEGREES(2));
    const int32_t at = random_between(0, JP_PURSUIT_STRIDE);
    jp_angle heading = random_bits();
    const char *field;

    for (size_t i = 1; i < POINTS; i++) {
        heading += (jp_angle)bend;
        path[i] = (struct jp_point){path[i - 1].x + jp_multiply_shift(spacing, jp_cos(heading), 31),
                                    path[i - 1].y + jp_multiply_shift(spacing, jp_sin(heading), 31)};
    }
    chase_before.position = (struct jp_point){path[at].x + random_between(-JP_Q16(0.2), JP_Q16(0.2)),
                                              path[at].y + random_between(-JP_Q16(0.2), JP_Q16(0.2))};
    chase_before.heading = heading;
    chase_before.speed = random_between(0, JP_Q24(8));
    return jp_pure_pursuit_init(&chase_before.tracker, &pursuit, &field) == JP_OK &&
           jp_pure_pursuit_follow(&chase_before.tracker, path, POINTS) == JP_OK;
}

static void restore_chase(void *argument)
{
    (void)argument;
    chase = chase_before;
}

static void pursue(void *argument)
{
    restore_chase(argument);
    (void)jp_pure_pursuit_tick(&chase.tracker, &chase.position, chase.heading, chase.speed, JP_Q24(0.01), &chase.twist);
}

static void print_figure(const char *name, uint32_t instructions, const char *end)
{
    target_print("{\"name\": \"" TARGET_CORE ": ");
    target_print(name);
    target_print(", worst of 2 000 states\", \"value\": ");
    target_print_number(instructions);
    target_print(", \"unit\": \"instructions\", \"bound\": null, \"command\": \"make figures\"}");
    target_print(end);
}

int main(void)
{
    const uint32_t restoring = target_count_instructions(restore, NULL);
    const uint32_t restoring_chase = target_count_instructions(restore_chase, NULL);
    uint32_t worst_inverse = restoring, worst_forward = restoring, worst_tick = restoring;
    uint32_t worst_pursuit = restoring_chase;

    for (int i = 0; i < STATES; i++) {
        prepare_wheels();
        worst_inverse = target_count_worst(worst_inverse, inverse, NULL);
        worst_forward = target_count_worst(worst_forward, forward, NULL);
        worst_tick = target_count_worst(worst_tick, tick, NULL);
        if (!prepare_chase()) {
            target_print("no path to follow\n");
            return 1;
        }
        worst_pursuit = target_count_worst(worst_pursuit, pursue, NULL);
    }
    target_print("[\n");
    print_figure("four wheels: inverse kinematics", worst_inverse - restoring, ",\n");
    print_figure("four wheels: forward kinematics and slip", worst_forward - restoring, ",\n");
    print_figure("four wheels: tick", worst_tick - restoring, ",\n");
    print_figure("pure pursuit: tick", worst_pursuit - restoring_chase, "\n]\n");
    return 0;
}
