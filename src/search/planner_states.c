#include "src/search/planner_states.h"

#include <string.h>

enum {
    BUCKETS_MIN = 64,
    BUCKETS_MAX = 4096,
    STATES_PER_BUCKET = 16,
    LOAD_NUMERATOR = 7, /* largest load factor: above it a look-up of an absent state takes too many probes */
    LOAD_DENOMINATOR = 8,
};

static bool is_prime(uint32_t n)
{
    for (uint32_t divisor = 2; divisor <= n / divisor; divisor++) {
        if (n % divisor == 0U) {
            return false;
        }
    }
    return n > 1U;
}

static uint32_t bucket_count_for(uint32_t slots)
{
    uint32_t count = BUCKETS_MIN;

    while (count < BUCKETS_MAX && count * STATES_PER_BUCKET < slots) {
        count *= 2;
    }
    return count;
}

size_t jp_planner_states_size(uint32_t count)
{
    uint32_t slots = count * LOAD_DENOMINATOR / LOAD_NUMERATOR + 1;

    while (!is_prime(slots)) {
        slots++;
    }
    return slots * sizeof(struct jp_planner_state) + bucket_count_for(slots) * sizeof(uint32_t);
}

void jp_planner_states_init(struct jp_planner_internal *planner, void *block, size_t size)
{
    const size_t most = (size_t)JP_PLANNER_STATES_MAX * LOAD_DENOMINATOR / LOAD_NUMERATOR;
    size_t slots = size / sizeof(struct jp_planner_state);

    if (slots > most) {
        slots = most;
    }
    planner->bucket_count = bucket_count_for((uint32_t)slots);
    const size_t bucket_bytes = planner->bucket_count * sizeof(uint32_t);
    if (slots * sizeof(struct jp_planner_state) + bucket_bytes > size) {
        slots = (size - bucket_bytes) / sizeof(struct jp_planner_state);
    }
    planner->states = block;
    planner->slot_count = (uint32_t)slots;
    while (!is_prime(planner->slot_count)) {
        planner->slot_count--;
    }
    planner->buckets = (uint32_t *)(void *)&planner->states[planner->slot_count];
    planner->statistics.states_max = planner->slot_count * LOAD_NUMERATOR / LOAD_DENOMINATOR;
    planner->statistics.search_bytes = (uint32_t)(planner->slot_count * sizeof(struct jp_planner_state) + bucket_bytes);
}

void jp_planner_states_clear(struct jp_planner_internal *planner)
{
    (void)memset(planner->states, 0, planner->slot_count * sizeof *planner->states);
    planner->statistics.states = 0;
}

/** Hash that spreads all bits of the id over 32 bits. */
static uint32_t hash(uint32_t id)
{
    uint32_t bits = id * 0x9E3779B1U;

    bits ^= bits >> 15;
    return bits * 0x85EBCA77U;
}

/** Slot of the state or the free slot where it belongs. */
static uint32_t probe(const struct jp_planner_internal *planner, uint32_t id)
{
    const uint32_t bits = hash(id);
    const uint32_t count = planner->slot_count;
    const uint32_t step = 1U + (bits & 0x3FFU) % (count - 1U);
    uint32_t slot = (uint32_t)(((uint64_t)bits * count) >> 32);

    while (planner->states[slot].used && planner->states[slot].id != id) {
        slot += step;
        if (slot >= count) {
            slot -= count;
        }
    }
    return slot;
}

uint32_t jp_planner_states_find(const struct jp_planner_internal *planner, uint32_t id)
{
    const uint32_t slot = probe(planner, id);

    return planner->states[slot].used ? slot : NO_SLOT;
}

uint32_t jp_planner_states_add(struct jp_planner_internal *planner, uint32_t id)
{
    const uint32_t slot = probe(planner, id);
    struct jp_planner_state *state = &planner->states[slot];

    if (state->used) {
        return slot;
    }
    if (planner->statistics.states == planner->statistics.states_max) {
        return NO_SLOT;
    }
    planner->statistics.states++;
    state->used = 1;
    state->id = id & 0xFFFFFFU;
    state->g = JP_COST_MAX;
    state->rhs = JP_COST_MAX;
    return slot;
}

void jp_planner_queue_restart(struct jp_planner_internal *planner, uint32_t range)
{
    for (uint32_t i = 0; i < planner->bucket_count; i++) {
        planner->buckets[i] = NO_SLOT;
    }
    planner->lowest_bucket = planner->bucket_count;
    planner->bucket_shift = 0;
    while (range >> planner->bucket_shift >= planner->bucket_count - 1U) {
        planner->bucket_shift++;
    }
}

static void take_out(struct jp_planner_internal *planner, struct jp_planner_state *state)
{
    if (state->previous == NO_SLOT) {
        planner->buckets[state->bucket] = (uint32_t)state->next;
    } else {
        planner->states[state->previous].next = state->next;
    }
    if (state->next != NO_SLOT) {
        planner->states[state->next].previous = state->previous;
    }
    state->queued = 0;
}

void jp_planner_queue_remove(struct jp_planner_internal *planner, uint32_t slot)
{
    if (planner->states[slot].queued) {
        take_out(planner, &planner->states[slot]);
    }
}

void jp_planner_queue_put(struct jp_planner_internal *planner, uint32_t slot, uint32_t key)
{
    struct jp_planner_state *state = &planner->states[slot];
    const uint32_t last = planner->bucket_count - 1U;
    uint32_t bucket = key >> planner->bucket_shift;

    if (bucket > last) {
        bucket = last;
    }
    if (state->queued) {
        if (state->bucket == bucket) {
            return;
        }
        take_out(planner, state);
    }
    const uint32_t head = planner->buckets[bucket];
    state->queued = 1;
    state->bucket = bucket & (BUCKETS_MAX - 1);
    state->previous = NO_SLOT;
    state->next = head & NO_SLOT;
    if (head != NO_SLOT) {
        planner->states[head].previous = slot & NO_SLOT;
    }
    planner->buckets[bucket] = slot;
    if (bucket < planner->lowest_bucket) {
        planner->lowest_bucket = bucket;
    }
}

uint32_t jp_planner_queue_top(struct jp_planner_internal *planner)
{
    while (planner->lowest_bucket < planner->bucket_count && planner->buckets[planner->lowest_bucket] == NO_SLOT) {
        planner->lowest_bucket++;
    }
    return planner->lowest_bucket < planner->bucket_count ? planner->buckets[planner->lowest_bucket] : NO_SLOT;
}

uint32_t jp_planner_queue_lowest_key(const struct jp_planner_internal *planner)
{
    return planner->lowest_bucket << planner->bucket_shift;
}

bool jp_planner_queue_is_beyond_range(const struct jp_planner_internal *planner)
{
    return planner->lowest_bucket == planner->bucket_count - 1U;
}
