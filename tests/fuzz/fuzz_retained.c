/**
 * Memory that outlives a reset, with any content: the record of the last crash and the two slots of the snapshot. What
 * is taken from them was written whole, and what is written is found, also when the writing is broken off anywhere.
 */
#include "hal/app/retained.h"
#include "hal/storage/post_mortem.h"
#include "tests/fuzz/fuzz_input.h"

static struct jp_post_mortem record;
static struct jp_retained retained;
static bool is_made_up; /* the snapshots hold what was not written */

static void open_record(struct fuzz_input *input)
{
    struct jp_reset_report report;
    const enum jp_reset_cause cause = (enum jp_reset_cause)fuzz_below(input, JP_RESET_STACK + 1U);

    jp_post_mortem_open(&record, cause, &report);
    fuzz_require(report.crashes <= 255U, "more crashes than are counted");
    fuzz_require(report.cause <= JP_RESET_STACK, "no cause of a reset");
    fuzz_require(!report.may_go_on || report.crashes < JP_CRASHES_MAX, "it may go on after too many crashes");
}

static void use_record(struct fuzz_input *input)
{
    struct jp_crash crash;

    switch (fuzz_below(input, 4)) {
    case 0:
        FUZZ_CHANGE(input, record);
        break;
    case 1:
        jp_post_mortem_forgive(&record);
        break;
    default:
        fuzz_fill(input, &crash, sizeof crash);
        crash.cause = fuzz_bool(input) ? JP_RESET_FAULT : JP_RESET_STACK;
        jp_post_mortem_write(&record, &crash);
        break;
    }
    open_record(input);
}

static bool same(const struct jp_retained_slot *slot, const struct jp_retained_slot *other)
{
    return memcmp(slot, other, sizeof *slot) == 0;
}

/** A reset comes after so many bytes of it: the new record, or the one before. */
static void write_snapshot(struct fuzz_input *input)
{
    static union jp_retained_snapshot snapshot;
    const struct jp_retained before = retained;
    const struct jp_retained_slot *old = jp_retained_newest(&before);
    const uint32_t resets = fuzz_u32(input);

    fuzz_fill(input, &snapshot, sizeof snapshot);
    jp_retained_write(&retained, JP_RETAINED_SKID, &snapshot, resets);

    const struct jp_retained_slot *new = jp_retained_newest(&retained);

    fuzz_require(new != NULL &&new->resets == resets &&new->kind ==
                     JP_RETAINED_SKID &&memcmp(&new->snapshot, &snapshot, sizeof snapshot) == 0,
                 "another snapshot");
    if (old != NULL && !is_made_up && fuzz_bool(input)) {
        const struct jp_retained after = retained;
        const size_t slot = (size_t)(new - retained.slots);
        const size_t cut = fuzz_below(input, sizeof after.slots[0] + 1U);

        retained = before;
        memcpy(&retained.slots[slot], &after.slots[slot], cut);

        const struct jp_retained_slot *found = jp_retained_newest(&retained);

        fuzz_require(found != NULL && (same(found, old) || same(found, &after.slots[slot])), "a mix of two records");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};

    fuzz_fill(&input, &record, sizeof record);
    memset(&retained, 0, sizeof retained);
    is_made_up = fuzz_bool(&input);
    if (is_made_up) {
        fuzz_fill(&input, &retained, sizeof retained);
    }
    open_record(&input);
    (void)jp_retained_newest(&retained);
    for (unsigned left = 32; left > 0U && fuzz_more(&input); left--) {
        use_record(&input);
        write_snapshot(&input);
        if (fuzz_below(&input, 4) == 0U) {
            FUZZ_CHANGE(&input, retained);
            is_made_up = true;
            (void)jp_retained_newest(&retained);
        }
    }
    return 0;
}
