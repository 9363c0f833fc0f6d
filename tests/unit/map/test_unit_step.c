/* Which primitive of a heading is the step of one cell. */
#include <joulepath/tables.h>

#include "src/map/unit_step.h"
#include "unity.h"

void setUp(void)
{
}

void tearDown(void)
{
}

/* Wherever it stands among the primitives of its heading. */
static void test_the_unit_step_is_found_at_any_place(void)
{
    static struct jp_primitive primitives[JP_PRIMITIVES_PER_HEADING_MAX];
    static struct jp_lattice turned;
    const struct jp_lattice *lattice = &jp_lattice_courier24;

    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        const struct jp_primitive *step = jp_unit_step(lattice, heading);
        const unsigned first = lattice->first_from[heading];
        const unsigned count = lattice->first_from[heading + 1U] - first;

        TEST_ASSERT_NOT_NULL(step);
        for (unsigned place = 0; place < count; place++) {
            for (unsigned i = 0; i < count; i++) {
                primitives[i] = lattice->primitives[first + i];
            }
            primitives[step - &lattice->primitives[first]] = primitives[place];
            primitives[place] = *step;
            turned = (struct jp_lattice){.primitives = primitives, .moves = lattice->moves};
            for (unsigned i = heading + 1U; i <= JP_HEADINGS; i++) {
                turned.first_from[i] = (uint16_t)count;
            }
            TEST_ASSERT_EQUAL_PTR(&primitives[place], jp_unit_step(&turned, heading));
        }
    }
}

/* What begins at the next heading is none of its own, whatever it looks like. */
static void test_a_heading_without_steps_has_none(void)
{
    static const uint8_t moves[] = {3};
    static const struct jp_primitive other = {.start = 4, .end = 3, .move_count = 1};
    static struct jp_lattice lattice;

    lattice = (struct jp_lattice){.primitives = &other, .moves = moves};
    for (unsigned i = 5; i <= JP_HEADINGS; i++) {
        lattice.first_from[i] = 1;
    }
    TEST_ASSERT_NULL(jp_unit_step(&lattice, 3));
}
