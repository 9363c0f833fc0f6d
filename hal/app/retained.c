#include "hal/app/retained.h"

#include <stddef.h>
#include <string.h>

#include "hal/storage/memory_check.h"

/** Memory that was never written does not add up to this. */
#define CHECK_START 0x4A503134U

static uint32_t check_of(const struct jp_retained_slot *slot)
{
    return jp_memory_check(CHECK_START, slot, offsetof(struct jp_retained_slot, check));
}

static bool is_whole(const struct jp_retained_slot *slot)
{
    return slot->check == check_of(slot);
}

const struct jp_retained_slot *jp_retained_newest(const struct jp_retained *retained)
{
    const struct jp_retained_slot *a = &retained->slots[0];
    const struct jp_retained_slot *b = &retained->slots[1];

    if (!is_whole(a) || !is_whole(b)) {
        return is_whole(a) ? a : is_whole(b) ? b : NULL;
    }
    return (int32_t)(a->sequence - b->sequence) > 0 ? a : b;
}

void jp_retained_write(struct jp_retained *retained, enum jp_retained_kind kind,
                       const union jp_retained_snapshot *snapshot, uint32_t resets)
{
    const struct jp_retained_slot *newest = jp_retained_newest(retained);
    struct jp_retained_slot *slot = newest == &retained->slots[0] ? &retained->slots[1] : &retained->slots[0];
    const uint32_t sequence = newest == NULL ? 0 : newest->sequence + 1U;

    /* The sum goes over the padding too, so that must be written. */
    memset(slot, 0, sizeof *slot);
    slot->snapshot = *snapshot;
    slot->kind = (uint32_t)kind;
    slot->sequence = sequence;
    slot->resets = resets;
    slot->check = check_of(slot);
}
