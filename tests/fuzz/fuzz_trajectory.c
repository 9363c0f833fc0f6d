/**
 * Trajectories by the rule through any points, for any configuration that passes its check, driven set-point by
 * set-point: speeds and angles stay in their formats, and a robot follows it from leg to leg until it stands.
 */
#include <joulepath/energy.h>
#include <joulepath/robot.h>
#include <joulepath/tables.h>
#include <joulepath/trajectory_energy.h>
#include <joulepath/trajectory_rule.h>

#include "tests/fuzz/fuzz_input.h"

#define LEGS       8U
#define SET_POINTS 4000U

static struct jp_trajectory_config config;
static struct jp_point targets[LEGS];
static struct jp_passage passages[LEGS];
static struct jp_trajectory_leg legs[LEGS];

static void draw_task(struct fuzz_input *input, struct jp_trajectory_task *task)
{
    const int32_t most = fuzz_bool(input) ? JP_Q16(8) : fuzz_bool(input) ? JP_Q16(500) : INT32_MAX;

    *task = (struct jp_trajectory_task){
        .config = &config,
        .cruise = fuzz_range(input, JP_Q24(0.01), JP_Q24(2)),
        .heading = fuzz_u32(input),
        .targets = targets,
        .passages = fuzz_bool(input) ? passages : NULL,
        .count = (uint16_t)fuzz_below(input, LEGS + 1U),
        .to_stand = fuzz_bool(input),
    };
    task->start = (struct jp_point){fuzz_range(input, -most, most), fuzz_range(input, -most, most)};
    FUZZ_CHANGE(input, task->motion);
    for (unsigned i = 0; i < LEGS; i++) {
        targets[i] = (struct jp_point){fuzz_range(input, -most, most), fuzz_range(input, -most, most)};
        passages[i] = (struct jp_passage){(uint8_t)fuzz_below(input, 5), fuzz_u32(input),
                                          fuzz_range(input, JP_Q24(0.005), JP_Q24(9))};
    }
}

static void drive(const struct jp_trajectory *trajectory)
{
    struct jp_trajectory_drive drive;
    struct jp_set_point set_point;
    uint16_t leg = 0;

    jp_trajectory_begin(&drive, trajectory);
    for (unsigned left = SET_POINTS; left > 0U && jp_trajectory_advance(&drive, &config, &set_point); left--) {
        fuzz_require(jp_trajectory_leg_now(&drive) >= leg && jp_trajectory_leg_now(&drive) <= trajectory->count,
                     "a leg out of turn");
        leg = jp_trajectory_leg_now(&drive);
    }
}

static bool fits(enum jp_status status)
{
    return status == JP_OK || status == JP_ERR_OVERFLOW;
}

static void look(struct fuzz_input *input, const struct jp_trajectory *trajectory, jp_angle heading)
{
    const struct jp_back_emf back_emf = {fuzz_range(input, 0, JP_Q16(4096)), fuzz_range(input, 0, JP_Q16(4096))};
    jp_q24 modes[JP_TRAVEL_MODES];
    struct jp_leg_energy energy;
    jp_q16 total = 0;
    jp_q16 seconds = 0;

    fuzz_require(fits(jp_trajectory_duration(&config, trajectory, &seconds)) && seconds >= 0, "a duration");
    fuzz_require(fits(jp_trajectory_energy(&config, &jp_energy_model_courier24, trajectory, &total)), "an energy");
    jp_trajectory_modes(trajectory, modes);
    for (unsigned i = 0; i < trajectory->count; i++) {
        const struct jp_leg_extent extent = jp_trajectory_leg_extent(&config, &legs[i], heading);

        fuzz_require(extent.aside >= 0 && extent.beyond >= 0, "an extent below 0");
        fuzz_require(
            fits(jp_trajectory_leg_energy(&config, &jp_energy_model_courier24, &back_emf, &legs[i], modes, &energy)) &&
                energy.duration >= 0 && energy.travel >= 0 && energy.turning >= 0,
            "an energy of a leg");
        heading = legs[i].next.heading;
    }
}

/** Leg by leg, as it is while it is driven. */
static void plan_stepwise(const struct jp_trajectory_task *task)
{
    struct jp_trajectory_plan plan;
    struct jp_trajectory trajectory;
    static struct jp_trajectory_leg few[2];

    if (jp_trajectory_plan_start(&plan, task, few, 2, &trajectory) != JP_OK) {
        return;
    }
    while (jp_trajectory_plan_leg(&plan, &few[plan.planned % 2U]) == JP_OK) {
        fuzz_require(plan.planned <= task->count, "more legs than targets");
    }
    (void)jp_trajectory_plan_redirect(&plan, task);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    struct jp_trajectory_task task;
    struct jp_trajectory trajectory;
    const char *field = NULL;

    config = fuzz_bool(&input) ? jp_robot_courier24.trajectory : jp_robot_gao2018.trajectory;
    FUZZ_CHANGE(&input, config);
    if (jp_trajectory_check(&config, &field) != JP_OK) {
        fuzz_require(field != NULL && field[0] != '\0', "a nameless field");
        return 0;
    }
    for (unsigned left = 8; left > 0U && fuzz_more(&input); left--) {
        draw_task(&input, &task);
        plan_stepwise(&task);
        if (jp_trajectory_by_rule(&task, legs, &trajectory) == JP_OK) {
            look(&input, &trajectory, task.heading);
            drive(&trajectory);
        }
    }
    return 0;
}
