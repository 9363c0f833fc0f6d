/**
 * The optimum of a segment and what it costs, for any energy model, horizon and limits that pass their checks, and any
 * points: what is planned is within the limits, ends at its target, and costs at least the electronics.
 */
#include <joulepath/horizon.h>
#include <joulepath/robot.h>
#include <joulepath/segment.h>
#include <joulepath/tables.h>

#include "tests/fuzz/fuzz_config.h"
#include "tests/fuzz/fuzz_input.h"

static struct jp_energy_model model;
static struct jp_horizon horizon;
static struct jp_segment_limits limits;

static bool start(struct fuzz_input *input)
{
    const char *field = NULL;

    model = fuzz_bool(input) ? jp_energy_model_courier24 : jp_energy_model_gao2018;
    horizon = fuzz_bool(input) ? jp_horizon_courier24 : jp_horizon_gao2018;
    limits = fuzz_bool(input) ? jp_robot_courier24.limits : jp_robot_gao2018.limits;
    FUZZ_CHANGE(input, model);
    FUZZ_CHANGE(input, horizon);
    FUZZ_CHANGE(input, limits);
    return fuzz_accepted(jp_energy_model_check(&model, &field), field) &&
           fuzz_accepted(jp_horizon_check(&horizon, &field), field) &&
           fuzz_accepted(jp_segment_limits_check(&limits, &model, &field), field);
}

static struct jp_point draw_point(struct fuzz_input *input)
{
    const int32_t most = fuzz_bool(input) ? JP_Q16(4) : fuzz_bool(input) ? JP_Q16(500) : INT32_MAX;

    return (struct jp_point){fuzz_range(input, -most, most), fuzz_range(input, -most, most)};
}

static bool is_status(enum jp_status status)
{
    return status == JP_OK || status == JP_ERR_ZERO_LENGTH || status == JP_ERR_ARGUMENT ||
           status == JP_ERR_INFEASIBLE || status == JP_ERR_MODEL || status == JP_ERR_OVERFLOW;
}

static void check_segment(const struct jp_segment *segment)
{
    const struct jp_segment_command *command = &segment->command;

    fuzz_require(command->motion.speed >= 0 && command->motion.speed <= limits.speed, "a speed beyond the limit");
    fuzz_require(command->motion.turn_rate <= limits.turn_rate && command->motion.turn_rate >= -limits.turn_rate,
                 "a turn rate beyond the limit");
    fuzz_require(command->turn <= limits.turn && command->turn >= -limits.turn, "a turn beyond the limit");
    fuzz_require(command->duration <= limits.duration && command->duration > 0, "a duration beyond the limit");
    fuzz_require(segment->arc <= JP_ARC_ANGLE_MAX && segment->arc >= -JP_ARC_ANGLE_MAX, "an arc beyond the limit");
    fuzz_require(segment->length >= 0 && segment->energy >= 0, "a length or an energy below 0");
}

/** What the header promises of where it ends, with its rounding. */
static void check_end(const struct jp_segment *segment, const struct jp_point *start, jp_angle heading,
                      const struct jp_point *target)
{
    struct jp_point end;
    jp_angle end_heading;

    if (jp_segment_end(segment, start, heading, &end, &end_heading) != JP_OK) {
        return;
    }
    const double dx = (double)end.x - target->x;
    const double dy = (double)end.y - target->y;
    const double x = ((double)target->x - start->x) / 65536;
    const double y = ((double)target->y - start->y) / 65536;
    const double distance_squared = x * x + y * y;
    /* (a + b)² <= 2 (a² + b²), and 4 units of Q16 for the points themselves. */
    const double second = segment->command.duration / 65536.0 / 16777216.0;
    const double share = 1e-5 + second;
    const double allowed = 2 * share * share * (distance_squared + 1) * 4294967296.0 + 64;

    fuzz_require(dx * dx + dy * dy <= 2 * allowed, "a segment that ends elsewhere");
}

static void forecast(struct fuzz_input *input, struct jp_energy_start *start, const struct jp_segment_command *command)
{
    jp_q16 regressor[JP_ENERGY_PARAMETERS];
    struct jp_energy_start end;
    jp_q16 energy = 0;
    jp_q16 rest = 0;

    (void)jp_energy_predict(&model, &start->motion, command, &energy);
    (void)jp_energy_regressors(&model, &horizon, start, command, regressor, &rest);
    if (jp_energy_forecast(&model, &horizon, start, command, &energy, &end) == JP_OK) {
        *start = end;
    }
    (void)jp_segment_turning_point(fuzz_range(input, 1, JP_Q16(100)), start->motion.speed, &(struct jp_point){0, 0},
                                   fuzz_u32(input), command->turn);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    struct jp_energy_start motion = {.is_forward = true};
    struct jp_segment segment;

    if (!start(&input)) {
        return 0;
    }
    for (unsigned left = 16; left > 0U && fuzz_more(&input); left--) {
        const struct jp_point from = draw_point(&input);
        const struct jp_point to = draw_point(&input);
        const jp_angle heading = fuzz_u32(&input);

        if (fuzz_below(&input, 4) == 0U) {
            FUZZ_CHANGE(&input, motion.motion);
        }

        const enum jp_status status =
            jp_segment_optimise(&model, &limits, &motion.motion, &from, heading, &to, &segment);

        fuzz_require(is_status(status), "a status of a segment");
        if (status == JP_OK || status == JP_ERR_OVERFLOW) {
            check_segment(&segment);
            check_end(&segment, &from, heading, &to);
        } else {
            fuzz_fill(&input, &segment.command, sizeof segment.command);
        }
        forecast(&input, &motion, &segment.command);
    }
    return 0;
}
