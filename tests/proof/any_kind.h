/** Robots of any kind (ecu_robot.h), whose answers are any: one with sensors and drives of struct jp_hal, and one with
 * its own. */
#ifndef JOULEPATH_TESTS_PROOF_ANY_KIND_H
#define JOULEPATH_TESTS_PROOF_ANY_KIND_H

#include "hal/app/ecu_robot.h"
#include "tests/proof/any.h"

static enum jp_status no_bus(void *context, const struct jp_can_frame *frames, unsigned count)
{
    (void)context;
    (void)frames;
    (void)count;
    return JP_OK;
}

static struct jp_ecu_bus kind_bus = {.command = no_bus};
static struct jp_sensors kind_frame;
static struct jp_learned_state kind_learned;

static void any_frames(struct jp_can_frame *frames, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        ANY(frames[i]);
        frames[i].length = (uint8_t)any_unsigned(JP_CAN_LENGTH_MAX);
    }
}

static bool kind_resumes(void *self, const union jp_retained_snapshot *snapshot, uint32_t *left, uint32_t *right)
{
    (void)self;
    (void)snapshot;
    if (any_bool()) {
        return false;
    }
    *left = any_unsigned(UINT32_MAX);
    *right = any_unsigned(UINT32_MAX);
    return true;
}

static void kind_ticks(void *self, const struct jp_hal *hal, enum jp_status *written)
{
    struct jp_sensors sensors;
    struct jp_actuation actuation;

    (void)self;
    (void)hal->read(hal->context, &sensors);
    ANY(actuation);
    *written = hal->write(hal->context, &actuation);
}

static const struct jp_sensors *kind_shows(const void *self)
{
    (void)self;
    if (any_bool()) {
        return NULL;
    }
    ANY(kind_frame);
    return &kind_frame;
}

static void kind_is_kept(const void *self, union jp_retained_snapshot *snapshot)
{
    (void)self;
    ANY(*snapshot);
}

static void kind_moves(const void *self, struct jp_ecu_motion *motion)
{
    (void)self;
    ANY(*motion);
}

static void kind_progresses(const void *self, struct jp_ecu_progress *progress)
{
    (void)self;
    ANY(*progress);
}

static void kind_spends(const void *self, jp_energy *spent, jp_energy *drawn)
{
    (void)self;
    ANY(*spent);
    ANY(*drawn);
}

static bool kind_has_result(void *self, struct jp_ecu_result *result)
{
    (void)self;
    if (any_bool()) {
        return false;
    }
    ANY(*result);
    return true;
}

static int32_t kind_has_parameter(const void *self, uint8_t index)
{
    (void)self;
    (void)index;
    return any_int();
}

static enum jp_ecu_state kind_does(const void *self)
{
    (void)self;
    return (enum jp_ecu_state)any_between(JP_ECU_IDLE, JP_ECU_FAULT);
}

static enum jp_refusal kind_stands_up(void *self)
{
    (void)self;
    return (enum jp_refusal)any_between(JP_REFUSAL_NONE, JP_REFUSAL_STEEP);
}

static void kind_obeys(void *self)
{
    (void)self;
}

static void kind_sets_out(void *self, bool to_goal)
{
    (void)self;
    (void)to_goal;
}

/** It looks at all targets. */
static enum jp_status kind_follows(void *self, const struct jp_point *targets, uint16_t count)
{
    struct jp_point last = {0};

    (void)self;
    for (unsigned i = 0; i < count; i++) {
        last = targets[i];
    }
    (void)last;
    return any_bool() ? JP_OK : JP_ERR_ZERO_LENGTH;
}

static bool kind_is_so(const void *self)
{
    (void)self;
    return any_bool();
}

static uint16_t kind_counts(const void *self)
{
    (void)self;
    return (uint16_t)any_unsigned(UINT16_MAX);
}

static void kind_plans(const void *self, uint16_t begun, struct jp_ecu_segment *segment)
{
    (void)self;
    (void)begun;
    ANY(*segment);
}

static const struct jp_learned_state *kind_learns(const void *self)
{
    (void)self;
    return any_bool() ? &kind_learned : NULL;
}

static void kind_has_lessons(const void *self, struct jp_ecu_lessons *lessons)
{
    (void)self;
    ANY(*lessons);
}

static bool kind_is_fed(const void *self, struct jp_ecu_supply *supply)
{
    (void)self;
    if (any_bool()) {
        return false;
    }
    ANY(*supply);
    return true;
}

static void kind_lacks(void *self, jp_q16 lacking)
{
    (void)self;
    (void)lacking;
}

static uint8_t kind_tells(const void *self, struct jp_can_frame frames[JP_ECU_LEARNED_FRAMES])
{
    (void)self;
    any_frames(frames, JP_ECU_LEARNED_FRAMES);
    return (uint8_t)any_between(0, (int)JP_ECU_LEARNED_FRAMES);
}

/* Of the one with sensors and drives of its own. */

static void own_is_attached(void *self, const struct jp_ecu_bus *bus)
{
    (void)self;
    kind_bus = *bus;
}

static enum jp_e2e_result own_accepts(void *self, const struct jp_can_frame *frame, bool *is_sample)
{
    (void)self;
    (void)frame;
    *is_sample = any_bool();
    return (enum jp_e2e_result)any_between(JP_E2E_OK, JP_E2E_SEQUENCE);
}

static bool own_tells(const void *self, uint8_t index, struct jp_can_frame *frame)
{
    (void)self;
    (void)index;
    any_frames(frame, 1);
    return any_bool();
}

static void own_ticks(void *self, const struct jp_hal *hal, enum jp_status *written)
{
    struct jp_can_frame frames[2];

    (void)self;
    (void)hal;
    any_frames(frames, 2);
    *written = kind_bus.command(kind_bus.context, frames, 2);
}

#define KIND_OF_ANY                                                                                                    \
    .snapshots = JP_RETAINED_BALANCER, .parameters = 5, .resume = kind_resumes, .good_frame = kind_shows,              \
    .snapshot = kind_is_kept, .motion = kind_moves, .progress = kind_progresses, .energies = kind_spends,              \
    .take_result = kind_has_result, .parameter = kind_has_parameter, .state = kind_does, .enable = kind_stands_up,     \
    .disable = kind_obeys, .set_out = kind_sets_out, .follow = kind_follows, .stop = kind_obeys, .work = kind_obeys,   \
    .note = kind_obeys, .is_resting = kind_is_so, .segments_begun = kind_counts, .segments_planned = kind_counts,      \
    .segment = kind_plans, .learned_state = kind_learns, .lessons = kind_has_lessons, .supply = kind_is_fed,           \
    .lack = kind_lacks, .tell_learned = kind_tells

static const struct jp_ecu_kind any_kind = {KIND_OF_ANY, .tick = kind_ticks};

static const struct jp_ecu_kind any_kind_of_its_own = {
    KIND_OF_ANY,           .tick = own_ticks,         .attach = own_is_attached,
    .accept = own_accepts, .has_started = kind_is_so, .lost_samples = kind_counts,
    .tell_own = own_tells};

#endif
