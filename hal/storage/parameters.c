#include "hal/storage/parameters.h"

#include <stddef.h>
#include <string.h>

#include "hal/storage/crc32.h"

#define IDENTITY_OFFSET 4U
#define NUMBERS_OFFSET  8U
#define LEARNED_NUMBERS 23U

/** Less is not worth a write: 0.0001 turn/s in 2⁻⁵⁶ turn/s, counts, and 0.0005 in Q30. */
#define BIAS_STEP  ((int64_t)JP_Q24(0.0001) * ((int64_t)1 << 32))
#define ZERO_STEP  4
#define SCALE_STEP ((int64_t)JP_Q24(0.0005) * 64)

_Static_assert(sizeof(struct jp_learned_state) == LEARNED_NUMBERS * sizeof(uint32_t), "the state is numbers only");
_Static_assert(JP_PARAMETERS_LENGTH <= JP_STORE_LENGTH_MAX, "the record fits the store");

/* ---- The robot they belong to ---- */

/** Where the numbers of a configuration are: all but padding and the name's pointer. */
struct span {
    uint16_t offset;
    uint8_t size;
    uint8_t count;
};

#define NUMBERS(type, first, count)                                                                                    \
    {                                                                                                                  \
        (uint16_t) offsetof(type, first), (uint8_t)sizeof(((type *)NULL)->first), (count)                              \
    }
#define BALANCER(first, count)   NUMBERS(struct jp_robot_config, first, count)
#define SKID(first, count)       NUMBERS(struct jp_skid_robot_config, first, count)
#define FOUR_WHEEL(first, count) NUMBERS(struct jp_four_wheel_robot_config, first, count)

static const struct span balancer_numbers[] = {
    BALANCER(estimator.tick_rate, 1),
    BALANCER(estimator.wheel_per_count, 2),
    BALANCER(estimator.tracking_gain, 4),
    BALANCER(reference.tick_rate, 5),
    BALANCER(lqr.tick_rate, 10),
    BALANCER(monitor.tilt_limit, 13),
    BALANCER(monitor.confirm_ticks, 3),
    BALANCER(meter.tick_rate, 3),
    BALANCER(limits.speed, 4),
    BALANCER(metres_per_turn, 1),
};

static const struct span skid_numbers[] = {
    SKID(odometry.tick_rate, sizeof(struct jp_skid_odometry_config) / sizeof(uint32_t)),
    SKID(control.tick_rate, 1),
    SKID(control.wheel_per_count, 1),
    SKID(control.tracking_gain, 18),
    SKID(monitor.tilt_limit, 13),
    SKID(monitor.confirm_ticks, 3),
    SKID(wheels.upright, 8),
    SKID(wheels.slope_calls, 3),
    SKID(meter.tick_rate, 3),
    SKID(limits.speed, 3),
    SKID(burnt, 1),
    SKID(path.tick_rate, 5),
    SKID(heading_gain, 1),
};

static const struct span four_wheel_numbers[] = {
    FOUR_WHEEL(wheels.wheelbase, sizeof(struct jp_four_wheel_config) / sizeof(uint32_t)),
    FOUR_WHEEL(tick_rate, 1),
    FOUR_WHEEL(count_speed, 1),
    FOUR_WHEEL(piece_ticks, 2),
    FOUR_WHEEL(limits.count_jump, 6),
    FOUR_WHEEL(limits.lag_ticks, 2),
};

/** A number of 2, 4 or 8 bytes in the order of this core. */
static uint64_t number_at(const uint8_t *bytes, unsigned size)
{
    uint16_t number16;
    uint32_t number32;
    uint64_t number64;

    switch (size) {
    case sizeof number16:
        memcpy(&number16, bytes, sizeof number16);
        return number16;
    case sizeof number32:
        memcpy(&number32, bytes, sizeof number32);
        return number32;
    default:
        memcpy(&number64, bytes, sizeof number64);
        return number64;
    }
}

static void put_number(uint8_t *bytes, uint64_t number, unsigned size)
{
    for (unsigned i = 0; i < size; i++) {
        bytes[i] = (uint8_t)(number >> (8U * i));
    }
}

static uint32_t crc_of_span(uint32_t crc, const uint8_t *config, const struct span *span)
{
    const uint8_t *bytes = config + span->offset;
    uint8_t little_endian[sizeof(uint64_t)];

    for (unsigned i = 0; i < span->count; i++) {
        put_number(little_endian, number_at(bytes + (size_t)i * span->size, span->size), span->size);
        crc = jp_crc32(crc, little_endian, span->size);
    }
    return crc;
}

static uint32_t crc_of(const char *name, const uint8_t *config, const struct span *spans, size_t count)
{
    uint32_t crc = 0;

    for (const char *letter = name; letter != NULL && *letter != '\0'; letter++) {
        crc = jp_crc32(crc, (const uint8_t *)letter, 1);
    }
    for (size_t i = 0; i < count; i++) {
        crc = crc_of_span(crc, config, &spans[i]);
    }
    return crc;
}

uint32_t jp_robot_identity(const struct jp_robot_config *config)
{
    return crc_of(config->name, (const uint8_t *)config, balancer_numbers,
                  sizeof balancer_numbers / sizeof balancer_numbers[0]);
}

uint32_t jp_skid_robot_identity(const struct jp_skid_robot_config *config)
{
    return crc_of(config->name, (const uint8_t *)config, skid_numbers, sizeof skid_numbers / sizeof skid_numbers[0]);
}

uint32_t jp_four_wheel_robot_identity(const struct jp_four_wheel_robot_config *config)
{
    return crc_of(NULL, (const uint8_t *)config, four_wheel_numbers,
                  sizeof four_wheel_numbers / sizeof four_wheel_numbers[0]);
}

/* ---- Fields ---- */

void jp_parameters_default(struct jp_parameters *parameters)
{
    *parameters = (struct jp_parameters){.gyro_bias = 0};
    jp_learned_state_start(&parameters->energy, 0);
}

static enum jp_status check_scale(const struct jp_gyro_scale *scale, const char **field)
{
    if (scale->error < -JP_GYRO_SCALE_MAX || scale->error > JP_GYRO_SCALE_MAX) {
        *field = "gyro_scale.error";
        return JP_ERR_CONFIG;
    }
    if (scale->deviation < 0 || scale->deviation > JP_GYRO_SCALE_DEVIATION_MAX) {
        *field = "gyro_scale.deviation";
        return JP_ERR_CONFIG;
    }
    return JP_OK;
}

enum jp_status jp_parameters_check(const struct jp_parameters *parameters, const char **field)
{
    enum jp_status status;

    if (parameters == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    status = jp_learned_state_check(&parameters->energy, field);
    if (status != JP_OK) {
        return status;
    }
    if (parameters->gyro_bias < -JP_PARAMETERS_GYRO_BIAS_MAX || parameters->gyro_bias > JP_PARAMETERS_GYRO_BIAS_MAX) {
        *field = "gyro_bias";
        return JP_ERR_CONFIG;
    }
    return check_scale(&parameters->gyro_scale, field);
}

/* ---- The record ---- */

static uint8_t *append(uint8_t *end, uint64_t number, unsigned size)
{
    put_number(end, number, size);
    return end + size;
}

static uint64_t take(const uint8_t **bytes, unsigned size)
{
    uint64_t number = 0;

    for (unsigned i = 0; i < size; i++) {
        number |= (uint64_t)(*bytes)[i] << (8U * i);
    }
    *bytes += size;
    return number;
}

static int32_t take_int32(const uint8_t **bytes)
{
    return (int32_t)(uint32_t)take(bytes, 4);
}

static bool is_same(const void *a, const void *b, size_t size)
{
    size_t i = 0;

    while (i < size && ((const uint8_t *)a)[i] == ((const uint8_t *)b)[i]) {
        i++;
    }
    return i == size;
}

static bool is_far(int64_t a, int64_t b, int64_t limit)
{
    return a - b > limit || b - a > limit;
}

bool jp_parameters_differ(const struct jp_parameters *a, const struct jp_parameters *b)
{
    return !is_same(&a->energy, &b->energy, sizeof a->energy) || is_far(a->gyro_bias, b->gyro_bias, BIAS_STEP) ||
           is_far(a->current_zero_left, b->current_zero_left, ZERO_STEP) ||
           is_far(a->current_zero_right, b->current_zero_right, ZERO_STEP) ||
           is_far(a->gyro_scale.error, b->gyro_scale.error, SCALE_STEP) ||
           is_far(a->gyro_scale.deviation, b->gyro_scale.deviation, SCALE_STEP);
}

void jp_parameters_encode(const struct jp_parameters *parameters, uint32_t identity,
                          uint8_t record[JP_PARAMETERS_LENGTH])
{
    const struct jp_learned_state *learned = &parameters->energy;
    uint8_t *end = record;

    end = append(end, JP_PARAMETERS_VERSION, 4);
    end = append(end, identity, 4);
    for (unsigned i = 0; i < JP_LEARNING_DIRECTIONS; i++) {
        end = append(end, (uint32_t)learned->x[i], 4);
    }
    for (unsigned i = 0; i < JP_LEARNING_DIRECTIONS; i++) {
        for (unsigned j = 0; j < JP_LEARNING_DIRECTIONS; j++) {
            end = append(end, (uint32_t)learned->s[i][j], 4);
        }
    }
    end = append(end, (uint32_t)learned->noise_scale, 4);
    end = append(end, learned->version, 4);
    end = append(end, learned->identity, 4);
    end = append(end, (uint64_t)parameters->gyro_bias, 8);
    end = append(end, parameters->current_zero_left, 2);
    end = append(end, parameters->current_zero_right, 2);
    end = append(end, (uint32_t)parameters->gyro_scale.error, 4);
    (void)append(end, (uint32_t)parameters->gyro_scale.deviation, 4);
}

static void decode_numbers(struct jp_parameters *parameters, const uint8_t *bytes)
{
    struct jp_learned_state *learned = &parameters->energy;

    for (unsigned i = 0; i < JP_LEARNING_DIRECTIONS; i++) {
        learned->x[i] = take_int32(&bytes);
    }
    for (unsigned i = 0; i < JP_LEARNING_DIRECTIONS; i++) {
        for (unsigned j = 0; j < JP_LEARNING_DIRECTIONS; j++) {
            learned->s[i][j] = take_int32(&bytes);
        }
    }
    learned->noise_scale = take_int32(&bytes);
    learned->version = (uint32_t)take(&bytes, 4);
    learned->identity = (uint32_t)take(&bytes, 4);
    parameters->gyro_bias = (int64_t)take(&bytes, 8);
    parameters->current_zero_left = (uint16_t)take(&bytes, 2);
    parameters->current_zero_right = (uint16_t)take(&bytes, 2);
    parameters->gyro_scale.error = take_int32(&bytes);
    parameters->gyro_scale.deviation = take_int32(&bytes);
}

/** Whether the record's frame fits. The version comes first: another one has another length. */
static enum jp_stored frame_of(uint32_t identity, const uint8_t *record, uint16_t length)
{
    const uint8_t *owner = record + IDENTITY_OFFSET;

    if (length < NUMBERS_OFFSET) {
        return JP_STORED_DAMAGED;
    }
    if (take(&record, 4) != JP_PARAMETERS_VERSION) {
        return JP_STORED_OTHER_VERSION;
    }
    if (length != JP_PARAMETERS_LENGTH) {
        return JP_STORED_DAMAGED;
    }
    return take(&owner, 4) != identity ? JP_STORED_OTHER_ROBOT : JP_STORED_TAKEN;
}

/** What about it does not fit; NULL: nothing. */
static const char *misfit(enum jp_stored frame)
{
    switch (frame) {
    case JP_STORED_OTHER_VERSION:
        return "version";
    case JP_STORED_OTHER_ROBOT:
        return "robot";
    case JP_STORED_DAMAGED:
        return "length";
    default:
        return NULL;
    }
}

enum jp_status jp_parameters_decode(struct jp_parameters *parameters, uint32_t identity, const uint8_t *record,
                                    uint16_t length, const char **field)
{
    struct jp_parameters found;
    enum jp_status status;

    if (parameters == NULL || record == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *field = misfit(frame_of(identity, record, length));
    if (*field != NULL) {
        return JP_ERR_CONFIG;
    }
    decode_numbers(&found, record + NUMBERS_OFFSET);
    status = jp_parameters_check(&found, field);
    if (status == JP_OK) {
        *parameters = found;
    }
    return status;
}

enum jp_stored jp_parameters_start(struct jp_parameters *parameters, uint32_t identity, const uint8_t *record,
                                   uint16_t length)
{
    const char *field;
    enum jp_stored frame;

    jp_parameters_default(parameters);
    if (length == 0U) {
        return JP_STORED_NOTHING;
    }
    frame = frame_of(identity, record, length);
    if (jp_parameters_decode(parameters, identity, record, length, &field) == JP_OK) {
        return JP_STORED_TAKEN;
    }
    return frame == JP_STORED_TAKEN ? JP_STORED_DAMAGED : frame;
}

enum jp_status jp_parameters_load(struct jp_parameters *parameters, uint32_t identity, const struct jp_store *store,
                                  const char **field)
{
    const uint8_t *record = NULL;
    uint16_t length = 0;
    enum jp_status status = jp_store_read(store, &record, &length);

    return status == JP_OK ? jp_parameters_decode(parameters, identity, record, length, field) : status;
}

enum jp_status jp_parameters_save(const struct jp_parameters *parameters, uint32_t identity, struct jp_store *store,
                                  const char **field)
{
    uint8_t record[JP_PARAMETERS_LENGTH];
    enum jp_status status = jp_parameters_check(parameters, field);

    if (status != JP_OK) {
        return status;
    }
    jp_parameters_encode(parameters, identity, record);
    return jp_store_write(store, record, sizeof record);
}
