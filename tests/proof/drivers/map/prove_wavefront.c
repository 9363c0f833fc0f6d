// eva: -eva-slevel-function main:20
/** A grid of any size that fits, values of two bytes or three, any cells lowered, touched and handed out, for ever. */
#include <joulepath/wavefront.h>

#include "tests/proof/any.h"

static uint64_t block[256];
static struct jp_wavefront wave;

static int32_t any_x(void)
{
    return any_between(0, wave.width - 1);
}

static int32_t any_y(void)
{
    return any_between(0, wave.height - 1);
}

static void start(void)
{
    jp_wavefront_start(&wave, any_unsigned(UINT16_MAX) + 1U, (uint16_t)any_x(), (uint16_t)any_y());
    while (!jp_wavefront_is_clear(&wave)) {
        jp_wavefront_clear(&wave);
    }
}

static void grow(void)
{
    unsigned cells = any_unsigned(UINT16_MAX);
    int32_t x = 0;
    int32_t y = 0;

    if (jp_wavefront_next(&wave, &cells, &x, &y) == JP_WAVE_CELL) {
        (void)jp_wavefront_value(&wave, x, y);
    }
    (void)jp_wavefront_is_exhausted(&wave);
}

int main(void)
{
    const uint16_t width = (uint16_t)any_between(1, 4096);
    const uint16_t height = (uint16_t)any_between(1, 4096);
    const enum jp_wave_format format = any_bool() ? JP_WAVE_2_BYTES : JP_WAVE_3_BYTES;

    if (jp_wavefront_size(width, height, format) > sizeof block) {
        return 0;
    }
    jp_wavefront_init(&wave, width, height, format, block);
    start();
    ANY_TIMES
    {
        if (any_bool()) {
            start();
        }
        jp_wavefront_lower(&wave, any_x(), any_y(), any_unsigned(jp_wavefront_value_max(&wave)));
        jp_wavefront_touch(&wave, any_x(), any_y());
        if (any_bool()) {
            jp_wavefront_resume(&wave);
        }
        grow();
    }
    ARRIVED();
    return 0;
}
