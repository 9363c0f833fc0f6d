/* The record that outlives a reset: the newer slot, writes that were cut off at every byte, memory full of anything. */
#include "hal/app/retained.h"

#include <stddef.h>
#include <string.h>

#include "tests/target/random.h"
#include "unity.h"

/* Without the padding behind the check. */
#define SLOT_BYTES (offsetof(struct jp_retained_slot, check) + sizeof(uint32_t))

static struct jp_retained retained;
static struct jp_retained torn;
static union jp_retained_snapshot snapshot;

void setUp(void)
{
    memset(&retained, 0, sizeof retained);
    memset(&snapshot, 0, sizeof snapshot);
}

void tearDown(void)
{
}

/* A record that is told by its resets; every field of the snapshot differs from that of another one. */
static void write(uint32_t resets)
{
    snapshot.balancer.estimator.encoder_left = resets * 40503U;
    snapshot.balancer.estimator.encoder_right = resets * 2654435761U;
    snapshot.balancer.estimator.wheel_encoder = resets * 0x123456789ABCDU;
    snapshot.balancer.estimator.pitch = ~(jp_phase)resets;
    snapshot.balancer.odometry.x = -(int64_t)resets;
    snapshot.balancer.balancing = (resets & 1U) != 0U;
    jp_retained_write(&retained, JP_RETAINED_BALANCER, &snapshot, resets);
}

static void expect(uint32_t resets)
{
    const struct jp_retained_slot *newest = jp_retained_newest(&retained);

    TEST_ASSERT_NOT_NULL(newest);
    TEST_ASSERT_EQUAL_UINT32(resets, newest->resets);
    TEST_ASSERT_EQUAL_UINT32(resets * 40503U, newest->snapshot.balancer.estimator.encoder_left);
    TEST_ASSERT_EQUAL_UINT64(~(jp_phase)resets, newest->snapshot.balancer.estimator.pitch);
    TEST_ASSERT_EQUAL_INT64(-(int64_t)resets, newest->snapshot.balancer.odometry.x);
    TEST_ASSERT_EQUAL_INT((resets & 1U) != 0U, newest->snapshot.balancer.balancing);
}

static void test_the_last_record_written_is_the_newest(void)
{
    for (uint32_t i = 1; i < 50; i++) {
        write(i);
        expect(i);
    }
}

static void test_records_take_turns(void)
{
    write(1);
    write(2);
    for (uint32_t i = 3; i < 10; i++) {
        const struct jp_retained_slot *before = jp_retained_newest(&retained);

        write(i);
        TEST_ASSERT_TRUE(jp_retained_newest(&retained) != before);
        TEST_ASSERT_EQUAL_UINT32(i - 1U, before->resets); /* and the one before stays */
    }
}

static void test_the_sequence_wraps(void)
{
    write(1);
    write(2);
    for (int i = 0; i < 2; i++) {
        struct jp_retained_slot *slot = &retained.slots[i];
        const uint32_t before = slot->sequence;

        slot->sequence = before + 0xFFFFFFFEU;
        /* What the sum of the last words but one moves by: sequence counts two rotations before the end. */
        slot->check += (slot->sequence - before) << 1;
    }
    for (uint32_t i = 3; i < 10; i++) {
        write(i);
        expect(i);
    }
}

/* Garbage */

static void expect_nothing(void)
{
    TEST_ASSERT_NULL(jp_retained_newest(&retained));
}

static void test_memory_full_of_one_byte_is_refused(void)
{
    for (unsigned byte = 0; byte < 256; byte++) {
        memset(&retained, (int)byte, sizeof retained);
        expect_nothing();
    }
}

static void test_random_memory_is_refused_and_can_be_written(void)
{
    uint32_t random = 2463534242U;

    for (uint32_t round = 0; round < 200; round++) {
        uint8_t *bytes = (uint8_t *)&retained;

        for (size_t i = 0; i < sizeof retained; i++) {
            bytes[i] = (uint8_t)(target_random(&random) >> 24);
        }
        expect_nothing();
        write(round);
        expect(round);
    }
}

static void test_one_flipped_bit_leaves_the_record_before(void)
{
    write(1);
    write(2);
    torn = retained;

    const size_t offset = (size_t)((const uint8_t *)jp_retained_newest(&retained) - (const uint8_t *)&retained);

    for (size_t bit = 0; bit < 8U * SLOT_BYTES; bit++) {
        retained = torn;
        ((uint8_t *)&retained)[offset + bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
        expect(1);
    }
}

static void test_swapped_words_leave_the_record_before(void)
{
    uint32_t words[SLOT_BYTES / sizeof(uint32_t)];
    size_t offset;

    write(1);
    write(2);
    torn = retained;
    offset = (size_t)((const uint8_t *)jp_retained_newest(&retained) - (const uint8_t *)&retained);
    for (size_t i = 0; i + 1U < sizeof words / sizeof words[0]; i++) {
        uint32_t word;

        retained = torn;
        memcpy(words, (const uint8_t *)&retained + offset, sizeof words);
        word = words[i];
        words[i] = words[i + 1U];
        words[i + 1U] = word;
        memcpy((uint8_t *)&retained + offset, words, sizeof words);
        expect(words[i] == words[i + 1U] ? 2 : 1);
    }
}

/* Torn writes */

/* The slot's first bytes are those of the new record, the others those of `rest`. */
static void check_torn_writes(bool forward, bool over_zeros)
{
    for (size_t whole = 0; whole <= sizeof(struct jp_retained_slot); whole++) {
        struct jp_retained after;
        const uint8_t *written;
        uint8_t *cut;
        bool complete = true;

        setUp();
        write(1);
        write(2);
        torn = retained;
        write(3);
        after = retained;
        retained = torn;

        const size_t slot = jp_retained_newest(&after) == &after.slots[0] ? 0 : 1;

        written = (const uint8_t *)&after.slots[slot];
        cut = (uint8_t *)&retained.slots[slot];
        if (over_zeros) {
            memset(cut, 0, sizeof(struct jp_retained_slot));
        }
        if (forward) {
            memcpy(cut, written, whole);
        } else {
            memcpy(cut + sizeof(struct jp_retained_slot) - whole, written + sizeof(struct jp_retained_slot) - whole,
                   whole);
        }
        for (size_t i = 0; i < sizeof(struct jp_retained_slot); i++) {
            complete = complete && cut[i] == written[i];
        }
        expect(complete ? 3 : 2);
        write(4); /* the cut one is written over */
        expect(4);
    }
}

static void test_a_write_cut_off_at_any_byte_leaves_the_record_before(void)
{
    check_torn_writes(true, false);
    check_torn_writes(true, true);
    check_torn_writes(false, false); /* a compiler may store in any order */
    check_torn_writes(false, true);
}

static void test_a_first_write_cut_off_leaves_nothing(void)
{
    struct jp_retained after;

    write(1);
    after = retained;
    for (size_t whole = 0; whole + 1U < offsetof(struct jp_retained_slot, check); whole++) {
        setUp();
        memcpy(&retained, &after, whole);
        expect_nothing();
    }
}
