#include "hal/can/round_code.h"

/* Of a unit. */
#define METRE  0x1p16f
#define JOULE  0x1p4f
#define SECOND 0x1p8f
#define ONE    0x1p16f

#define RADIAN 6.83565276e8f /* 2³²/2π */
#define TURN   0x1p32f

#define TURNS_PER_RADIAN 0.15915494f

#define WORD 4U

/* Most that 32 bits hold, in single precision. */
#define SIGNED_MAX   2147483520.0f
#define UNSIGNED_MAX 4294967040.0f

/* In. */

static uint32_t word_at(const uint8_t *bytes, uint32_t index)
{
    uint32_t word = 0;

    for (uint32_t i = 0; i < WORD; i++) {
        word |= (uint32_t)bytes[index + i] << (8U * i);
    }
    return word;
}

static float signed_at(const uint8_t *bytes, uint32_t index, float one)
{
    return (float)(int32_t)word_at(bytes, index) / one;
}

static float unsigned_at(const uint8_t *bytes, uint32_t index, float one)
{
    return (float)word_at(bytes, index) / one;
}

static struct jp_plane_pose pose_at(const uint8_t *bytes, uint32_t index)
{
    return (struct jp_plane_pose){signed_at(bytes, index, METRE), signed_at(bytes, index + WORD, METRE),
                                  signed_at(bytes, index + 2U * WORD, RADIAN)};
}

void jp_round_decode(const uint8_t *bytes, uint8_t stops, struct jp_patrol_round_config *config)
{
    *config = (struct jp_patrol_round_config){.stop_count = stops,
                                              .charger = pose_at(bytes, 0),
                                              .full = unsigned_at(bytes, 3U * WORD, JOULE),
                                              .reserve = unsigned_at(bytes, 4U * WORD, JOULE),
                                              .deviations = unsigned_at(bytes, 5U * WORD, ONE)};
    for (uint32_t i = 0; i < stops; i++) {
        const uint32_t at = JP_ROUND_HEAD + i * JP_ROUND_STOP;

        config->stops[i] = (struct jp_patrol_stop){pose_at(bytes, at), unsigned_at(bytes, at + 3U * WORD, SECOND)};
    }
}

/* Out. */

static void put(uint8_t *bytes, uint32_t index, uint32_t word)
{
    for (uint32_t i = 0; i < WORD; i++) {
        bytes[index + i] = (uint8_t)((word >> (8U * i)) & 0xFFU);
    }
}

static void put_signed(uint8_t *bytes, uint32_t index, float value, float one)
{
    const float scaled = value * one;
    const float capped = scaled > SIGNED_MAX ? SIGNED_MAX : (scaled < -SIGNED_MAX ? -SIGNED_MAX : scaled);

    put(bytes, index, (uint32_t)(int32_t)capped);
}

static void put_unsigned(uint8_t *bytes, uint32_t index, float value, float one)
{
    const float scaled = value * one;

    put(bytes, index, scaled > UNSIGNED_MAX ? UINT32_MAX : (uint32_t)scaled);
}

/** Of any number of turns within half a one. */
static void put_heading(uint8_t *bytes, uint32_t index, float heading)
{
    const float turns = heading * TURNS_PER_RADIAN;
    const float rounded_up = turns + (turns < 0.0f ? -0.5f : 0.5f);

    put_signed(bytes, index, turns - (float)(int32_t)rounded_up, TURN);
}

static void put_pose(uint8_t *bytes, uint32_t index, const struct jp_plane_pose *pose)
{
    put_signed(bytes, index, pose->x, METRE);
    put_signed(bytes, index + WORD, pose->y, METRE);
    put_heading(bytes, index + 2U * WORD, pose->heading);
}

void jp_round_encode(const struct jp_patrol_round_config *config, uint8_t *bytes)
{
    put_pose(bytes, 0, &config->charger);
    put_unsigned(bytes, 3U * WORD, config->full, JOULE);
    put_unsigned(bytes, 4U * WORD, config->reserve, JOULE);
    put_unsigned(bytes, 5U * WORD, config->deviations, ONE);
    for (uint32_t i = 0; i < config->stop_count; i++) {
        const uint32_t at = JP_ROUND_HEAD + i * JP_ROUND_STOP;

        put_pose(bytes, at, &config->stops[i].pose);
        put_unsigned(bytes, at + 3U * WORD, config->stops[i].dwell, SECOND);
    }
}
