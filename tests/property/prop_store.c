/*
 * Random lives of a store: writes, settling, cuts in both, worn words, a generation that wraps. At the end of each the
 * power fails at every byte of a write, each time from the same flash: the store has the old record or the new one, and
 * what it has it keeps.
 */
#define NOR_SLOTS  4U
#define NOR_WORDS  (NOR_SLOTS * 64U)
#define RIG_LENGTH 100U

#include "tests/support/store_rig.h"

#include "tests/support/options.h"
#include "unity.h"

enum { BAR = 10000, BYTES_OF_WORD = 4, SESSIONS_MAX = 12, WRITES_MAX = 4, STEPS_AHEAD = 50 };

static struct options options = {.count = 200, .seed = 1};
static struct rig rig;
static struct rig before;

static unsigned long lives;
static unsigned long byte_cuts;
static unsigned long erases;

void setUp(void)
{
}

void tearDown(void)
{
}

static uint32_t draw(uint32_t bound)
{
    return nor_random(&rig.nor) % bound;
}

static void report(const char *what, unsigned long life)
{
    if (rig.violations > 0U) {
        printf("life %lu of seed %llu: %s\n", life, options.seed, what);
    }
    TEST_ASSERT_EQUAL_UINT32(0, rig.violations);
}

/* A generation about to wrap, garbage, or a new part. */
static void begin_flash(unsigned long life)
{
    uint8_t bytes[JP_STORE_LENGTH_MAX];
    const uint32_t serial = 1U + draw(1000);

    rig_start(&rig, (uint64_t)options.seed * 1000003U + life + 1U);
    switch (draw(4)) {
    case 0:
        nor_put_slot(&rig.nor, draw(2), draw(NOR_SLOTS), UINT32_MAX - draw(3), bytes, rig_record(serial, bytes));
        rig_become_certain(&rig, serial);
        break;
    case 1:
        for (size_t i = 0; i < NOR_WORDS; i++) {
            rig.nor.sectors[0][i].value = nor_random(&rig.nor);
            rig.nor.sectors[1][i].value = nor_random(&rig.nor);
        }
        break;
    default:
        break;
    }
}

static void wear_out(void)
{
    for (uint32_t i = draw(8); i > 0U; i--) {
        rig.nor.sectors[draw(2)][draw(NOR_WORDS)].worn = nor_bits(&rig.nor, 1U + draw(3));
    }
    rig.nor.refuses = draw(2) == 0U;
}

static void perhaps_cut(void)
{
    if (draw(2) == 0U) {
        rig_cut_in(&rig, 1U + draw(STEPS_AHEAD), rig_random_cut(&rig));
    }
}

/* From power-on to power-off. */
static void live_session(uint32_t *serial)
{
    enum rig_outcome outcome = RIG_DONE;

    (void)rig_open(&rig);
    perhaps_cut();
    if (draw(4) != 0U) {
        outcome = rig_settle(&rig);
    }
    for (uint32_t writes = draw(WRITES_MAX + 1U); writes > 0U && outcome != RIG_CUT; writes--) {
        (*serial)++;
        outcome = rig_write(&rig, *serial);
    }
}

/* False: the flash is worn out. */
static bool power_up_and_settle(void)
{
    (void)rig_open(&rig);
    return rig_settle(&rig) == RIG_DONE;
}

static void cut_at_every_byte(uint32_t serial)
{
    unsigned long steps;

    before = rig;
    if (rig_write(&rig, serial) != RIG_DONE) {
        return;
    }
    steps = rig.nor.steps - before.nor.steps;
    for (unsigned long byte = 0; byte < steps * BYTES_OF_WORD; byte++) {
        before.nor.random += 2U * byte + 1U;
        rig = before;
        rig_cut_in(&rig, 1U + byte / BYTES_OF_WORD, rig_random_cut(&rig));
        TEST_ASSERT_EQUAL_INT(RIG_CUT, rig_write(&rig, serial));
        (void)rig_open(&rig);
        (void)rig_settle(&rig);
        (void)rig_open(&rig);
        before.violations = rig.violations;
        byte_cuts++;
    }
    rig = before;
}

static void live(unsigned long life)
{
    uint32_t serial = 1000;

    begin_flash(life);
    if (draw(4) == 0U) {
        wear_out();
    }
    for (uint32_t sessions = draw(SESSIONS_MAX + 1U); sessions > 0U; sessions--) {
        live_session(&serial);
    }
    report("in its sessions", life);
    erases += rig.nor.erases;
    if (power_up_and_settle()) {
        cut_at_every_byte(serial + 1U);
    }
    report("at a byte of its last write", life);
}

static void test_lives(void)
{
    for (unsigned long life = 0; life < options.count; life++) {
        live(life);
        lives++;
    }
    printf("%lu lives with %lu cuts, %lu erases; %lu cuts at the bytes of a write\n", lives, rig.cuts, erases,
           byte_cuts);
    TEST_ASSERT_TRUE(byte_cuts / lives > 50U);
}

static void add_figures(json_t *figures)
{
    figures_add(figures, "make figures", (double)lives, "", at_least(BAR),
                "parameter store: power cut at every byte of a write, random sequences");
    figures_add(figures, "make figures", (double)(byte_cuts + rig.cuts), "", no_bar,
                "parameter store: power cuts in them");
    figures_add(figures, "make figures", (double)rig.violations, "", equal_to(0),
                "parameter store: neither old nor new");
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, add_figures);
}
