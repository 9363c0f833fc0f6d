/* Newton's step: its equations hold, whatever is coupled; what has no derivatives keeps. */
#include "src/trajectory/trajectory_newton.h"

#include "tests/support/near.h"
#include "unity.h"

enum { PLACES = 5, VARIABLES = 2 * PLACES };

static struct jp_optimiser_place places[PLACES];
static float matrix[VARIABLES][VARIABLES];
static float slope[VARIABLES];
static uint32_t state;

void setUp(void)
{
    state = 1;
}

void tearDown(void)
{
}

/* -1…1. */
static float any(void)
{
    state = state * 1664525U + 1013904223U;
    return (float)(int32_t)state * 0x1p-31f;
}

/* A symmetrical matrix in which neighbours are coupled, with curvatures of `least` and more. */
static void make(unsigned count, float least)
{
    for (unsigned i = 0; i < count; i++) {
        struct jp_optimiser_place *const place = &places[i];

        *place = (struct jp_optimiser_place){
            .slope = {any(), any()},
            .curve = {least + 0.3f * any(), 0.4f * any(), least + 0.3f * any()},
            .coupling = {{0.5f * any(), 0.5f * any()}, {0.5f * any(), 0.5f * any()}},
        };
    }
}

/* Keeps the equations: the step takes their place. */
static void note(unsigned count)
{
    for (unsigned i = 0; i < 2U * count; i++) {
        for (unsigned j = 0; j < 2U * count; j++) {
            matrix[i][j] = 0.0f;
        }
    }
    for (unsigned k = 0; k < count; k++) {
        for (unsigned i = 0; i < 2U; i++) {
            slope[2U * k + i] = places[k].slope[i];
            for (unsigned j = 0; j < 2U; j++) {
                matrix[2U * k + i][2U * k + j] = places[k].curve[i + j];
                if (k + 1U < count) {
                    matrix[2U * k + i][2U * k + 2U + j] = places[k].coupling[i][j];
                    matrix[2U * k + 2U + j][2U * k + i] = places[k].coupling[i][j];
                }
            }
        }
    }
}

static float step_of(unsigned variable)
{
    return places[variable / 2U].step[variable % 2U];
}

/* H step = −slope; and half of what the slope promises is what the whole step saves. */
static void expect_solved(unsigned count)
{
    float promised = 0.0f;

    note(count);
    const float saved = jp_newton_step(places, (uint16_t)count);

    for (unsigned i = 0; i < 2U * count; i++) {
        float sum = 0.0f;

        for (unsigned j = 0; j < 2U * count; j++) {
            sum += matrix[i][j] * step_of(j);
        }
        TEST_ASSERT_NEAR(1.0e-4f, -slope[i], sum);
        promised -= slope[i] * step_of(i);
    }
    TEST_ASSERT_NEAR(1.0e-4f, 0.5f * promised, saved);
}

static void test_the_equations_hold(void)
{
    for (unsigned count = 1; count <= (unsigned)PLACES; count++) {
        for (int i = 0; i < 8; i++) {
            make(count, 2.0f);
            expect_solved(count);
        }
    }
}

/* What is given has neither slope nor curvature nor coupling: it keeps, the others are as without it. */
static void test_what_is_given_keeps(void)
{
    make(PLACES, 2.0f);
    for (unsigned k = 1; k < 4U; k++) {
        const unsigned given = k % 2U;

        places[k].slope[given] = 0.0f;
        places[k].curve[1] = 0.0f;
        places[k].curve[2U * given] = 0.0f;
        for (unsigned j = 0; j < 2U; j++) {
            places[k].coupling[given][j] = 0.0f;
            places[k - 1U].coupling[j][given] = 0.0f;
        }
    }
    expect_solved(PLACES);
    for (unsigned k = 1; k < 4U; k++) {
        TEST_ASSERT_NEAR(0.0f, 0.0f, places[k].step[k % 2U]);
    }
}

/* Against the slope even where the curve is that of a maximum. */
static void test_a_step_leads_downhill_from_anywhere(void)
{
    for (int i = 0; i < 20; i++) {
        float promised = 0.0f;

        make(1, 0.0f);
        places[0].curve[0] -= 1.0f;
        places[0].curve[1] *= 0.25f;
        places[0].curve[2] += i % 2 == 0 ? 1.0f : -1.0f;
        note(1);
        TEST_ASSERT_TRUE(jp_newton_step(places, 1) > 0.0f);
        for (unsigned k = 0; k < 2U; k++) {
            promised -= slope[k] * step_of(k);
        }
        TEST_ASSERT_TRUE(promised > 0.0f);
    }
}
