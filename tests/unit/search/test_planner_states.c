/* The planner's states and their queue; costs that change. */
#include <stddef.h>

#include "src/search/planner_states.h"
#include "tests/support/planner_rig.h"

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

/* The states and their queue */

static void test_costs_saturate(void)
{
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_cost_add(JP_COST_MAX, JP_COST_MAX));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_cost_add(JP_COST_MAX - 1, 2));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_cost_add(JP_COST_MAX, 0));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX - 1, jp_cost_add(JP_COST_MAX - 2, 1));
}

/* In slices. */
static void clear_states(unsigned slice)
{
    unsigned slots = 0;

    planner.internal.search.clear_slot = 0;
    TEST_ASSERT_FALSE(jp_planner_states_clear(&planner.internal.search, &slots));
    do {
        TEST_ASSERT_EQUAL_UINT32(0, slots);
        slots = slice;
    } while (!jp_planner_states_clear(&planner.internal.search, &slots));
    TEST_ASSERT_EQUAL_UINT32(slice - 1 - (planner.internal.search.slot_count - 1) % slice, slots);
}

/* Ids that differ little, by a factor of the table's size, and by much. */
static void test_table_finds_all_that_it_holds(void)
{
    static const uint32_t strides[] = {1, 16, 4096, 65537};

    for (size_t i = 0; i < sizeof strides / sizeof strides[0]; i++) {
        start_planner(sizeof block);
        clear_states(1000);
        const uint32_t stride = i == 3 ? planner.internal.search.slot_count : strides[i];
        const uint32_t count = planner.internal.search.state_count_max;
        for (uint32_t k = 0; k < count; k++) {
            const uint32_t id = k * stride & 0xFFFFFF;
            TEST_ASSERT_EQUAL_UINT32(NO_SLOT, jp_planner_states_find(&planner.internal.search, id));
            const uint32_t slot = jp_planner_states_add(&planner.internal.search, id);
            TEST_ASSERT_TRUE(slot < planner.internal.search.slot_count);
            TEST_ASSERT_EQUAL_UINT32(slot, jp_planner_states_add(&planner.internal.search, id));
            TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, (uint32_t)planner.internal.search.states[slot].g);
            TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, (uint32_t)planner.internal.search.states[slot].rhs);
        }
        for (uint32_t k = 0; k < count; k++) {
            const uint32_t slot = jp_planner_states_find(&planner.internal.search, k * stride & 0xFFFFFF);
            TEST_ASSERT_TRUE(slot != NO_SLOT);
            TEST_ASSERT_EQUAL_UINT32(k * stride & 0xFFFFFF, (uint32_t)planner.internal.search.states[slot].id);
        }
    }
}

/* Whatever they have in common, states lie everywhere in the table: a look-up takes few probes. */
static void test_states_are_spread_over_the_table(void)
{
    enum { PARTS = 8, STATES = 160 };
    static const uint32_t strides[] = {1, 16, 4096};

    for (size_t i = 0; i < sizeof strides / sizeof strides[0]; i++) {
        unsigned counts[PARTS] = {0};
        start_planner(sizeof block);
        clear_states(1000);
        const uint32_t slots = planner.internal.search.slot_count;
        for (uint32_t k = 0; k < STATES; k++) {
            counts[jp_planner_states_add(&planner.internal.search, k * strides[i]) * PARTS / slots]++;
        }
        for (int part = 0; part < PARTS; part++) {
            TEST_ASSERT_TRUE(counts[part] >= STATES / PARTS / 2 && counts[part] <= STATES / PARTS * 2);
        }
    }
}

/* The lists follow on the slots, and look like free ones: no state is put there. */
static void test_no_state_lies_beyond_the_slots(void)
{
    start_planner(sizeof block);
    clear_states(1000);
    struct jp_planner_search *search = &planner.internal.search;
    memset(search->buckets, 0, search->bucket_count * sizeof *search->buckets);
    for (uint32_t k = 0; k < search->state_count_max; k++) {
        TEST_ASSERT_TRUE(jp_planner_states_add(search, k * 31) < search->slot_count);
    }
    for (uint32_t i = 0; i < search->bucket_count; i++) {
        TEST_ASSERT_EQUAL_UINT32(0, search->buckets[i]);
    }
}

/* A prime number of slots, of which so many states may be used that the rest of the probes stay few. */
static void test_slots_are_as_many_as_fit(void)
{
    struct jp_planner_search search = {0};

    for (uint32_t bytes = 1400; bytes < 6000; bytes += 57) {
        const size_t used = jp_planner_states_init(&search, &terrain.config, block, bytes);
        TEST_ASSERT_TRUE(used <= bytes);
        TEST_ASSERT_EQUAL_UINT32(used, search.slot_count * sizeof *search.states + search.bucket_count * 4);
        for (uint32_t n = 2; n < 40; n++) {
            TEST_ASSERT_TRUE(search.slot_count == n || search.slot_count % n != 0U);
        }
        TEST_ASSERT_TRUE(bytes - used < 16 * sizeof *search.states);
        TEST_ASSERT_EQUAL_UINT32(search.slot_count * 11 / 12, search.state_count_max);
        TEST_ASSERT_EQUAL_UINT32(0, search.bucket_count & (search.bucket_count - 1));
        TEST_ASSERT_TRUE(search.bucket_count >= 64);
    }
    for (uint32_t count = 64; count < 300; count++) {
        const size_t size = jp_planner_states_size(count);
        (void)jp_planner_states_init(&search, &terrain.config, block, size);
        TEST_ASSERT_TRUE(search.state_count_max >= count && search.state_count_max <= count + 16);
    }
}

static void test_table_that_is_full(void)
{
    start_planner(sizeof block);
    clear_states(1000);
    const uint32_t count = planner.internal.search.state_count_max;
    for (uint32_t id = 0; id < count; id++) {
        TEST_ASSERT_TRUE(jp_planner_states_add(&planner.internal.search, id) != NO_SLOT);
        TEST_ASSERT_EQUAL_UINT32(id + 1, planner.internal.search.state_count);
    }
    TEST_ASSERT_EQUAL_UINT32(NO_SLOT, jp_planner_states_add(&planner.internal.search, count));
    TEST_ASSERT_EQUAL_UINT32(NO_SLOT, jp_planner_states_find(&planner.internal.search, count));
    TEST_ASSERT_TRUE(jp_planner_states_add(&planner.internal.search, count - 1) != NO_SLOT);
    clear_states(7);
    TEST_ASSERT_EQUAL_UINT32(0, planner.internal.search.state_count);
    TEST_ASSERT_EQUAL_UINT32(NO_SLOT, jp_planner_states_find(&planner.internal.search, 0));
    TEST_ASSERT_TRUE(jp_planner_states_add(&planner.internal.search, count) != NO_SLOT);
}

static uint32_t key_of(uint32_t i)
{
    return i * 7919 % 1000;
}

static void test_queue_gives_the_lowest_first(void)
{
    enum { COUNT = 100 };
    uint32_t last = 0;

    start_planner(sizeof block);
    clear_states(1000);
    jp_planner_queue_restart(&planner.internal.search, 1000);
    TEST_ASSERT_EQUAL_UINT32(NO_SLOT, jp_planner_queue_top(&planner.internal.search));
    for (uint32_t i = 0; i < COUNT; i++) {
        jp_planner_queue_put(&planner.internal.search, jp_planner_states_add(&planner.internal.search, i), key_of(i));
    }
    for (uint32_t i = 0; i < COUNT; i++) {
        const uint32_t slot = jp_planner_queue_top(&planner.internal.search);
        TEST_ASSERT_TRUE(slot != NO_SLOT);
        const uint32_t key = key_of((uint32_t)planner.internal.search.states[slot].id);
        TEST_ASSERT_TRUE(jp_planner_queue_lowest_key(&planner.internal.search) >= last);
        TEST_ASSERT_TRUE(jp_planner_queue_lowest_key(&planner.internal.search) <= key);
        TEST_ASSERT_TRUE(key >> planner.internal.search.bucket_shift ==
                         jp_planner_queue_lowest_key(&planner.internal.search) >> planner.internal.search.bucket_shift);
        last = jp_planner_queue_lowest_key(&planner.internal.search);
        jp_planner_queue_remove(&planner.internal.search, slot);
        jp_planner_queue_remove(&planner.internal.search, slot); /* of one that is out: nothing */
    }
    TEST_ASSERT_EQUAL_UINT32(NO_SLOT, jp_planner_queue_top(&planner.internal.search));
}

static void test_queue_moves_a_state_to_its_new_key(void)
{
    start_planner(sizeof block);
    clear_states(1000);
    jp_planner_queue_restart(&planner.internal.search, 60);
    const uint32_t a = jp_planner_states_add(&planner.internal.search, 1);
    const uint32_t b = jp_planner_states_add(&planner.internal.search, 2);
    const uint32_t c = jp_planner_states_add(&planner.internal.search, 3);
    jp_planner_queue_put(&planner.internal.search, a, 30);
    jp_planner_queue_put(&planner.internal.search, b, 30);
    jp_planner_queue_put(&planner.internal.search, c, 30);
    jp_planner_queue_put(&planner.internal.search, b, 30);
    jp_planner_queue_put(&planner.internal.search, b, 10); /* out of the middle of a list */
    TEST_ASSERT_EQUAL_UINT32(b, jp_planner_queue_top(&planner.internal.search));
    TEST_ASSERT_EQUAL_UINT32(10, jp_planner_queue_lowest_key(&planner.internal.search));
    jp_planner_queue_put(&planner.internal.search, b, 50);
    jp_planner_queue_remove(&planner.internal.search, a);
    TEST_ASSERT_EQUAL_UINT32(c, jp_planner_queue_top(&planner.internal.search));
    jp_planner_queue_remove(&planner.internal.search, c);
    TEST_ASSERT_EQUAL_UINT32(b, jp_planner_queue_top(&planner.internal.search));
    jp_planner_queue_put(&planner.internal.search, a, 0);
    TEST_ASSERT_EQUAL_UINT32(a, jp_planner_queue_top(&planner.internal.search));
}

static void test_queue_tells_when_its_range_ends(void)
{
    start_planner(sizeof block);
    clear_states(1000);
    jp_planner_queue_restart(&planner.internal.search, 1000);
    const uint32_t near = jp_planner_states_add(&planner.internal.search, 1);
    const uint32_t far = jp_planner_states_add(&planner.internal.search, 2);
    jp_planner_queue_put(&planner.internal.search, far, UINT32_MAX);
    jp_planner_queue_put(&planner.internal.search, near, 1000);
    TEST_ASSERT_EQUAL_UINT32(near, jp_planner_queue_top(&planner.internal.search));
    TEST_ASSERT_FALSE(jp_planner_queue_is_beyond_range(&planner.internal.search));
    jp_planner_queue_remove(&planner.internal.search, near);
    TEST_ASSERT_EQUAL_UINT32(far, jp_planner_queue_top(&planner.internal.search));
    TEST_ASSERT_TRUE(jp_planner_queue_is_beyond_range(&planner.internal.search));
    jp_planner_queue_restart(&planner.internal.search, 2 * JP_COST_MAX);
    TEST_ASSERT_TRUE(2 * JP_COST_MAX >> planner.internal.search.bucket_shift <
                     planner.internal.search.bucket_count - 1);
    TEST_ASSERT_TRUE(2 * JP_COST_MAX >> (planner.internal.search.bucket_shift - 1) >=
                     planner.internal.search.bucket_count - 1);
}

/* With the wall all states are searched, whose keys go far beyond what was expected: the range is widened. */
static void test_range_widens_during_a_search(void)
{
    begin();
    expect_optimal();
    const uint8_t shift = planner.internal.search.bucket_shift;
    planner.internal.effort.fresh_cost = 0; /* or the repair would give up for a new search */
    wall(true);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_UNREACHABLE, finish());
    TEST_ASSERT_TRUE(planner.internal.search.bucket_shift > shift);
    wall(false);
    expect_optimal();
}

static void test_other_costs_of_the_lattice(void)
{
    const struct jp_lattice dearer = dearer_driving();
    const struct jp_goal north = {12, 4, 1U << 4};
    const struct jp_plan *plan = jp_planner_plan(&planner);

    start_planner(sizeof block);
    clear_states(1000);
    go(&west, &north);
    expect_optimal();
    const jp_cost before = plan->cost;
    TEST_ASSERT_EQUAL_UINT32(0, plan->parameter_version);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_lattice(&planner, &dearer));
    TEST_ASSERT_EQUAL_UINT32(before, plan->cost); /* the plan stands, and says what it was made of */
    TEST_ASSERT_EQUAL_UINT32(0, plan->parameter_version);
    TEST_ASSERT_FALSE(jp_planner_is_idle(&planner));
    const uint32_t earlier = jp_planner_statistics(&planner)->expansions;
    (void)finish();
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, plan->answer);
    TEST_ASSERT_EQUAL_UINT32(3, plan->parameter_version);
    const uint32_t expansions = jp_planner_statistics(&planner)->expansions - earlier;
    const jp_cost after = plan->cost;
    TEST_ASSERT_TRUE(after > before);

    config.lattice = &dearer;
    start_planner(sizeof block);
    clear_states(1000);
    go(&west, &north);
    (void)finish();
    TEST_ASSERT_EQUAL_UINT32(after, plan->cost);
    TEST_ASSERT_EQUAL_UINT32(3, plan->parameter_version);
    TEST_ASSERT_EQUAL_UINT32(expansions, jp_planner_statistics(&planner)->expansions);
}

static void test_lattices_that_are_not_taken(void)
{
    struct jp_lattice other = *lattice;

    begin();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_planner_set_lattice(NULL, lattice));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_planner_set_lattice(&planner, NULL));
    other.moves++;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_planner_set_lattice(&planner, &other));
    expect_optimal();
}

/* A state whose key stays in its bucket keeps its place there; one that moves comes first in its new one. */
static void test_a_state_that_is_put_again_keeps_its_place(void)
{
    struct jp_planner_search *search = &planner.internal.search;

    start_planner(sizeof block);
    clear_states(1000);
    jp_planner_queue_restart(search, 1000);
    const uint32_t first = jp_planner_states_add(search, 5);
    const uint32_t second = jp_planner_states_add(search, 6);
    jp_planner_queue_put(search, first, 100);
    jp_planner_queue_put(search, second, 100);
    TEST_ASSERT_EQUAL_UINT32(second, jp_planner_queue_top(search));
    jp_planner_queue_put(search, first, 100);
    TEST_ASSERT_EQUAL_UINT32(second, jp_planner_queue_top(search));
    jp_planner_queue_put(search, first, 900);
    jp_planner_queue_put(search, first, 100);
    TEST_ASSERT_EQUAL_UINT32(first, jp_planner_queue_top(search));
    jp_planner_queue_remove(search, first);
    TEST_ASSERT_EQUAL_UINT32(second, jp_planner_queue_top(search));
    jp_planner_queue_remove(search, second);
    jp_planner_queue_remove(search, second);
    TEST_ASSERT_EQUAL_UINT32(NO_SLOT, jp_planner_queue_top(search));
}

/* In an empty table a state lies where its own bits say: two seldom in the same slot, whatever they have in common. */
static void test_states_begin_to_look_at_places_of_their_own(void)
{
    static const uint32_t strides[] = {1, 16, 4096};
    struct jp_planner_search *search = &planner.internal.search;

    for (size_t i = 0; i < sizeof strides / sizeof strides[0]; i++) {
        uint8_t parts[16] = {0};
        unsigned most = 0;

        start_planner(sizeof block);
        for (uint32_t k = 0; k < 160U; k++) {
            clear_states(1000);
            const uint32_t part = jp_planner_states_add(search, k * strides[i]) * 16U / search->slot_count;

            parts[part]++;
            most = parts[part] > most ? parts[part] : most;
        }
        TEST_ASSERT_LESS_THAN_UINT32(25, most); /* of 10 each */
    }
}

/* A list for every 16 slots, as a power of two from 64 to 1024. */
static void test_lists_for_tables_of_any_size(void)
{
    const struct jp_terrain_config large = {.width = 1000, .height = 1000, .resolution = lattice->resolution};
    struct jp_planner_search search = {0};

    for (size_t bytes = 4096; bytes < 1000000; bytes += bytes / 3) {
        const size_t used = jp_planner_states_init(&search, &large, block, bytes);
        const uint32_t count = search.bucket_count;

        TEST_ASSERT_TRUE(used <= bytes && used + 1000U + 16U * 40U > bytes);
        TEST_ASSERT_EQUAL_UINT32(0, count & (count - 1U));
        TEST_ASSERT_TRUE(count >= 64U && count <= 1024U);
        TEST_ASSERT_TRUE(count == 1024U || count * 16U >= search.slot_count);
        TEST_ASSERT_TRUE(count == 64U || count * 8U < search.slot_count + 16U * 40U);
    }
    TEST_ASSERT_EQUAL_UINT32(1024, search.bucket_count);
}
