#include "hal/can/sample_link.h"

#include <joulepath/count.h>

#define ALL_PARTS ((1U << JP_SAMPLE_PARTS) - 1U)

/** A count that is farther from the expected one is not taken as the base of the next: the low bits that a sample
 *  carries would be completed to a count that is a whole wrap off. */
#define BASE_DISTANCE ((int32_t)1 << (JP_SAMPLE_COUNT_BITS - 3U))

void jp_sample_link_start(struct jp_sample_link *link, const struct jp_monitor_config *limits, uint32_t tick_rate)
{
    *link = (struct jp_sample_link){.limits = limits, .hold_ticks = jp_sample_hold_ticks(tick_rate)};
}

void jp_sample_link_resume(struct jp_sample_link *link, uint32_t encoder_left, uint32_t encoder_right)
{
    link->left.base = encoder_left;
    link->right.base = encoder_right;
}

/** In the first two frames the sample's counter stands in the low bits of byte 0, in the last in those of byte 1. */
static uint8_t counter_of(const struct jp_can_frame *frame, enum jp_sample_part part)
{
    return frame->data[part == JP_SAMPLE_CURRENTS ? 1 : 0] & 0x0FU;
}

static bool parts_belong_together(const struct jp_sample_link *link)
{
    const uint8_t counter = counter_of(&link->frames[JP_SAMPLE_CURRENTS], JP_SAMPLE_CURRENTS);

    return link->parts == ALL_PARTS && counter_of(&link->frames[JP_SAMPLE_WHEELS], JP_SAMPLE_WHEELS) == counter &&
           counter_of(&link->frames[JP_SAMPLE_BALANCE], JP_SAMPLE_BALANCE) == counter;
}

static int32_t distance(uint32_t from, uint32_t to)
{
    return (int32_t)(to - from);
}

static bool within(int32_t value, int32_t limit)
{
    return value >= -limit && value <= limit;
}

/** The middle one of the last paces. */
static int32_t pace(const struct jp_sample_encoder *encoder)
{
    for (unsigned i = 0; i < JP_SAMPLE_PACES; i++) {
        unsigned below = 0;
        unsigned equal = 0;

        for (unsigned k = 0; k < JP_SAMPLE_PACES; k++) {
            below += encoder->paces[k] < encoder->paces[i] ? 1U : 0U;
            equal += encoder->paces[k] == encoder->paces[i] ? 1U : 0U;
        }
        if (below <= JP_SAMPLE_PACES / 2U && below + equal > JP_SAMPLE_PACES / 2U) {
            return encoder->paces[i];
        }
    }
    return 0;
}

static uint32_t expected(const struct jp_sample_encoder *encoder, uint16_t ticks)
{
    return encoder->base + (uint32_t)pace(encoder) * ticks;
}

/** After the sample's count has been put on the expected one. */
static void note_count(struct jp_sample_link *link, struct jp_sample_encoder *encoder, uint32_t count, uint16_t ticks)
{
    const uint32_t believed = expected(encoder, ticks);

    if (link->started) {
        encoder->paces[link->newest] = distance(encoder->last, count) / (int32_t)ticks;
    }
    encoder->base = !link->started || within(distance(believed, count), BASE_DISTANCE) ? count : believed;
    encoder->last = count;
}

static enum jp_e2e_result complete(struct jp_sample_link *link)
{
    const uint16_t ticks = (uint16_t)(link->missed + 1U);
    struct jp_sensors sample = link->sample;
    enum jp_e2e_result result;

    sample.encoder_left = expected(&link->left, ticks);
    sample.encoder_right = expected(&link->right, ticks);
    result = jp_message_to_sensors(&link->receiver, link->frames, &sample);
    if (result != JP_E2E_OK) {
        return result;
    }
    note_count(link, &link->left, sample.encoder_left, ticks);
    note_count(link, &link->right, sample.encoder_right, ticks);
    link->newest = (uint8_t)((link->newest + 1U) % JP_SAMPLE_PACES);
    link->sample = sample;
    link->catch_up = link->missed > link->catch_up ? link->missed : link->catch_up;
    link->fresh = true;
    link->started = true;
    return JP_E2E_OK;
}

enum jp_e2e_result jp_sample_link_accept(struct jp_sample_link *link, enum jp_sample_part part,
                                         const struct jp_can_frame *frame)
{
    enum jp_e2e_result result;

    link->frames[part] = *frame;
    link->parts |= (uint8_t)(1U << (unsigned)part);
    if (part != JP_SAMPLE_CURRENTS) {
        return JP_E2E_OK;
    }
    result = parts_belong_together(link) ? complete(link) : JP_E2E_SEQUENCE;
    link->parts = 0;
    return result;
}

/** A step from `good` towards `sample`, of at most half the change that is plausible in a tick. */
static uint32_t approach_count(uint32_t good, uint32_t sample, uint32_t limit)
{
    const int32_t step = (int32_t)(limit / 2U);
    const int32_t left = distance(good, sample);

    return within(left, step) ? sample : good + (uint32_t)(left > 0 ? step : -step);
}

static jp_q24 approach_rate(jp_q24 good, jp_q24 sample, jp_q24 limit)
{
    const jp_q24 step = limit / 2;
    const jp_q24 left = jp_sub(sample, good);

    return within(left, step) ? sample : good + (left > 0 ? step : -step);
}

static void read_fresh(struct jp_sample_link *link, const struct jp_sensors *good, struct jp_sensors *sensors)
{
    const struct jp_monitor_config *limits = link->limits;

    link->fresh = false;
    link->missed = 0;
    *sensors = link->sample;
    if (link->catch_up == 0U) {
        return;
    }
    link->catch_up--;
    sensors->encoder_left = approach_count(good->encoder_left, link->sample.encoder_left, limits->encoder_jump);
    sensors->encoder_right = approach_count(good->encoder_right, link->sample.encoder_right, limits->encoder_jump);
    sensors->pitch_rate = approach_rate(good->pitch_rate, link->sample.pitch_rate, limits->gyro_jump);
    sensors->yaw_rate = approach_rate(good->yaw_rate, link->sample.yaw_rate, limits->gyro_jump);
}

/** False when the gap is too long. */
static bool bridge(struct jp_sample_link *link, const struct jp_sensors *good, struct jp_sensors *sensors)
{
    link->lost = jp_one_more16(link->lost);
    if (link->missed >= link->hold_ticks) {
        return false;
    }
    link->missed++;
    *sensors = *good;
    sensors->encoder_left += (uint32_t)pace(&link->left);
    sensors->encoder_right += (uint32_t)pace(&link->right);
    return true;
}

enum jp_status jp_sample_link_read(struct jp_sample_link *link, const struct jp_sensors *good,
                                   struct jp_sensors *sensors)
{
    if (!link->started) {
        return JP_ERR_HARDWARE;
    }
    if (link->fresh) {
        read_fresh(link, good, sensors);
        return JP_OK;
    }
    return bridge(link, good, sensors) ? JP_HELD : JP_ERR_HARDWARE;
}
