#include "src/navigate/navigator_ledger.h"

#include "src/base/integer.h"
#include "src/base/point.h"
#include "src/navigate/navigator_frame.h"
#include "src/navigate/navigator_state.h"

/** What a stand takes is taken to be no better known than by so many stands and drives: robots and grounds change. */
#define STANDS_MAX 64U
#define DRIVES_MAX 15U

/** A new robot's stands take nothing more, give or take this part of its first course. */
#define FIRST_PART 20

/** m */
struct lengths {
    int64_t whole;
    int64_t left;
};

static struct lengths measure(const struct jp_navigator *navigator)
{
    const struct jp_navigator_internal *internal = &navigator->internal;
    const struct jp_place place = jp_navigator_place(navigator);
    struct lengths lengths = {0, 0};

    for (uint16_t i = 0; i < internal->course.count; i++) {
        const struct jp_point begin = jp_frame_leg_begin(navigator, i);
        const struct jp_point *end = &navigator->config.legs[i].end;

        lengths.whole += jp_distance(&begin, end);
        if (i >= internal->leg) {
            lengths.left += jp_distance(i == internal->leg ? &place.point : &begin, end);
        }
    }
    return lengths;
}

/** Of a quantity of the whole course, what belongs to the length that is left. */
static jp_q16 share(jp_q16 whole, const struct lengths *lengths)
{
    const int64_t left = lengths->left < lengths->whole ? lengths->left : lengths->whole;

    return lengths->whole > 0 ? jp_saturate32((int64_t)whole * left / lengths->whole) : 0;
}

static uint16_t stands_left(const struct jp_navigator *navigator)
{
    uint16_t stands = 0;

    for (uint16_t i = navigator->internal.leg; i < navigator->internal.course.count; i++) {
        if (navigator->config.legs[i].is_stop) {
            stands++;
        }
    }
    return stands;
}

/* What stands take. */

static void believe_first(struct jp_navigator *navigator)
{
    navigator->stand =
        (struct jp_stand_energy){.deviation = navigator->internal.energy.energy / FIRST_PART, .stands = 1, .drives = 1};
}

static jp_q16 root(uint64_t x)
{
    return jp_saturate32((int64_t)jp_square_root(x));
}

static uint64_t square(jp_q16 x)
{
    const int64_t product = (int64_t)x * x;

    return (uint64_t)product;
}

static uint16_t at_most(uint32_t most, uint32_t x)
{
    return (uint16_t)(x < most ? x : most);
}

/** A drive with so many stands took so much more than its first course. */
static void learn(struct jp_stand_energy *stand, jp_q16 more, uint16_t stands)
{
    const jp_q16 innovation = jp_saturate32((int64_t)more - (int64_t)stands * stand->mean);
    const uint32_t known = stand->stands;
    const uint64_t of_one = square(innovation) / ((uint64_t)known + stands) * known / stands;
    const uint64_t before = square(stand->deviation);
    const uint64_t weight = (uint64_t)stand->drives + 1U;

    stand->mean = jp_add(stand->mean, innovation / (int32_t)(known + stands));
    stand->deviation = root(before - before / weight + of_one / weight);
    stand->stands = at_most(STANDS_MAX, known + stands);
    stand->drives = at_most(DRIVES_MAX, (uint32_t)stand->drives + 1U);
}

/** Of so many stands together, whose mean is not known either. */
static jp_q16 deviation_of(const struct jp_stand_energy *stand, uint16_t stands)
{
    const uint64_t of_one = (uint64_t)stands * ((uint64_t)stand->stands + stands) / stand->stands;

    return jp_saturate32(jp_multiply(stand->deviation, root(of_one << 32)) >> 16);
}

/* Drives. */

void jp_ledger_begin(struct jp_navigator *navigator)
{
    navigator->internal.drive = (struct jp_navigator_drive){.stands = 0};
}

void jp_ledger_add_course(struct jp_navigator *navigator)
{
    struct jp_navigator_drive *drive = &navigator->internal.drive;

    if (navigator->stand.stands == 0U) {
        believe_first(navigator);
    }
    if (drive->stands == 0U) {
        *drive = (struct jp_navigator_drive){.forecast = navigator->internal.energy.energy,
                                             .spent = jp_frame_look(navigator).spent,
                                             .stands = stands_left(navigator)};
    }
}

void jp_ledger_end(struct jp_navigator *navigator)
{
    const struct jp_navigator_drive *drive = &navigator->internal.drive;
    const uint32_t counted = (uint32_t)jp_frame_look(navigator).spent - (uint32_t)drive->spent;
    const jp_q16 taken = (jp_q16)counted;

    /* A vehicle that does not count teaches nothing. */
    if (drive->stands > 0U && taken > 0) {
        learn(&navigator->stand, jp_sub(taken, drive->forecast), drive->stands);
    }
}

/* What is left. */

bool jp_ledger_left(const struct jp_navigator *navigator, struct jp_progress *left)
{
    const struct jp_forecast *energy = &navigator->internal.energy;
    const struct lengths lengths = measure(navigator);

    if (!jp_navigator_has_course(navigator)) {
        return false;
    }
    *left = (struct jp_progress){.length = jp_saturate32(lengths.left),
                                 .duration = share(navigator->internal.duration, &lengths),
                                 .energy = {share(energy->energy, &lengths), share(energy->deviation, &lengths)}};
    return true;
}

bool jp_ledger_expected(const struct jp_navigator *navigator, struct jp_progress *left)
{
    const struct jp_stand_energy *stand = &navigator->stand;
    const uint16_t stands = stands_left(navigator);

    if (!jp_ledger_left(navigator, left)) {
        return false;
    }
    if (stands > 0U) {
        const uint64_t variance = square(left->energy.deviation) + square(deviation_of(stand, stands));
        const jp_q16 energy = jp_saturate32((int64_t)left->energy.energy + (int64_t)stands * stand->mean);

        left->energy = (struct jp_forecast){energy > 0 ? energy : 0, root(variance)};
    }
    return true;
}
