/*
 * Power fails at every step of a write and of the recovery after it, at every place of the log: each word that is
 * programmed and each sector that is erased is left in all mixes of old, new and unstable bits.
 */
#define NOR_SLOTS  3U
#define NOR_WORDS  (NOR_SLOTS * 64U)
#define RIG_LENGTH 5U

#include "tests/support/store_rig.h"

#include "unity.h"

static struct rig rig;
static struct rig places[3U * NOR_SLOTS];

/* The flash new, and each sector begun, in the middle and full. */
#define PLACES (sizeof places / sizeof places[0])

void setUp(void)
{
    rig.cuts = 0;
}

void tearDown(void)
{
}

/* As many records written as the number of the place. */
static void test_writes_reach_every_place(void)
{
    rig_start(&rig, 1);
    for (uint32_t place = 0; place < PLACES; place++) {
        places[place] = rig;
        TEST_ASSERT_EQUAL_INT(RIG_DONE, rig_write(&rig, place + 1U));
    }
}

static void go_to(unsigned place)
{
    const unsigned long cuts = rig.cuts;
    const uint64_t random = rig.nor.random;

    rig = places[place];
    rig.cuts = cuts;
    rig.nor.random = random;
}

static unsigned long steps_of_write(unsigned place)
{
    unsigned long before;

    go_to(place);
    before = rig.nor.steps;
    TEST_ASSERT_EQUAL_INT(RIG_DONE, rig_write(&rig, place + 1U));
    return rig.nor.steps - before;
}

static void cut_write(unsigned place, unsigned long step, struct nor_cut cut)
{
    go_to(place);
    rig_cut_in(&rig, step, cut);
    TEST_ASSERT_EQUAL_INT(RIG_CUT, rig_write(&rig, place + 1U));
}

/* The store goes on: what is found stays, and records can be written on to the other sector and back. */
static void check_recovery(void)
{
    const uint32_t found = rig_open(&rig);

    TEST_ASSERT_EQUAL_INT(RIG_DONE, rig_settle(&rig));
    TEST_ASSERT_TRUE(found == 0U || rig.certain == found);
    (void)rig_open(&rig);
    for (uint32_t serial = 100; serial < 102; serial++) {
        TEST_ASSERT_EQUAL_INT(RIG_DONE, rig_write(&rig, serial));
        TEST_ASSERT_EQUAL_UINT32(serial, rig_open(&rig));
    }
    TEST_ASSERT_EQUAL_UINT32(0, rig.violations);
}

static void test_a_write_is_cut_at_every_step(void)
{
    for (unsigned place = 0; place < PLACES; place++) {
        const unsigned long steps = steps_of_write(place);

        for (unsigned long step = 1; step <= steps; step++) {
            for (unsigned mix = 0; mix < 81U; mix++) {
                cut_write(place, step, (struct nor_cut){.done = mix / 9U, .unstable = mix % 9U});
                check_recovery();
            }
        }
    }
    printf("%lu cuts\n", rig.cuts);
    TEST_ASSERT_TRUE(rig.cuts > 5000U);
}

/* Without jp_store_settle(): the next write has to see to it. */
/* False: the second write was over before its step. */
static bool cut_two_writes(unsigned place, unsigned long first, unsigned long second)
{
    enum rig_outcome outcome;

    cut_write(place, first, rig_random_cut(&rig));
    (void)rig_open(&rig);
    rig_cut_in(&rig, second, rig_random_cut(&rig));
    outcome = rig_write(&rig, place + 2U);
    check_recovery();
    return outcome == RIG_CUT;
}

/* Without jp_store_settle(): the next write has to see to it. */
static void test_a_write_is_cut_and_the_next_one_too(void)
{
    for (unsigned place = 0; place < PLACES; place++) {
        for (unsigned long first = 1; first <= steps_of_write(place); first++) {
            for (unsigned round = 0; round < 4U; round++) {
                for (unsigned long second = 1; cut_two_writes(place, first, second); second++) {
                }
            }
        }
    }
    printf("%lu cuts\n", rig.cuts);
    TEST_ASSERT_TRUE(rig.cuts > 8000U);
}

static void test_the_recovery_is_cut_at_every_step(void)
{
    static const struct nor_cut mixes[] = {{0, 8}, {4, 0}, {4, 8}, {7, 8}, {8, 0}};
    enum { MIXES = sizeof mixes / sizeof mixes[0] };

    for (unsigned place = 0; place < PLACES; place++) {
        const unsigned long steps = steps_of_write(place);

        for (unsigned long first = 1; first <= steps; first++) {
            for (unsigned mix = 0; mix < MIXES * MIXES; mix++) {
                unsigned long second = 0;
                enum rig_outcome outcome;

                do {
                    cut_write(place, first, mixes[mix / MIXES]);
                    (void)rig_open(&rig);
                    second++;
                    rig_cut_in(&rig, second, mixes[mix % MIXES]);
                    outcome = rig_settle(&rig);
                    check_recovery();
                } while (outcome == RIG_CUT);
            }
        }
    }
    printf("%lu cuts\n", rig.cuts);
    TEST_ASSERT_TRUE(rig.cuts > 5000U);
}

/* Each recovery is cut in its turn, so often that the slots run out. */
static void test_recoveries_are_cut_again_and_again(void)
{
    for (unsigned long step = 1; step <= 40U; step++) {
        for (unsigned place = 1; place < PLACES; place++) {
            cut_write(place, 1U + (step - 1U) % steps_of_write(place), (struct nor_cut){.done = 4, .unstable = 8});
            for (unsigned i = 0; i < 4U * NOR_SLOTS; i++) {
                (void)rig_open(&rig);
                rig_cut_in(&rig, step, rig_random_cut(&rig));
                (void)rig_settle(&rig);
            }
            check_recovery();
        }
    }
}

/* A brown-out that comes back: a write is tried at each power-on, and each is cut. */
static void test_many_writes_are_cut_in_a_row(void)
{
    for (unsigned long step = 1; step <= 40U; step++) {
        go_to(5);
        for (uint32_t serial = 10; serial < 60; serial++) {
            (void)rig_open(&rig);
            rig_cut_in(&rig, step, rig_random_cut(&rig));
            (void)rig_write(&rig, serial);
        }
        check_recovery();
    }
}

/* Words that do not take their bits while power fails as well. */
static void test_worn_flash_is_cut(void)
{
    for (unsigned round = 0; round < 2000; round++) {
        go_to(round % PLACES);
        rig.nor.refuses = round % 2U != 0U;
        for (unsigned i = 0; i < 1U + round % 5U; i++) {
            const uint32_t word = nor_random(&rig.nor) % NOR_WORDS;

            rig.nor.sectors[i % 2U][word].worn = nor_bits(&rig.nor, 2);
        }
        for (uint32_t serial = 200; serial < 220; serial++) {
            rig_cut_in(&rig, 1U + nor_random(&rig.nor) % 60U, rig_random_cut(&rig));
            if (rig_write(&rig, serial) == RIG_CUT) {
                (void)rig_open(&rig);
                (void)rig_settle(&rig);
            }
        }
        TEST_ASSERT_EQUAL_UINT32(0, rig.violations);
    }
}
