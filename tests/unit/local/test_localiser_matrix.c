/* Inverses of positive definite matrices, and what is none. */
#include "src/local/localiser_matrix.h"

#include "tests/support/near.h"

static float inverse[3][3];

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_a_matrix_times_its_inverse(void)
{
    float matrix[3][3] = {{4.0f, 1.0f, -0.5f}, {1.0f, 3.0f, 0.25f}, {-0.5f, 0.25f, 2.0f}};

    TEST_ASSERT_TRUE(jp_localiser_invert(matrix, inverse));
    for (int i = 0; i < 3; i++) {
        float product[3];

        jp_localiser_multiply(matrix, inverse[i], product);
        for (int j = 0; j < 3; j++) {
            TEST_ASSERT_NEAR(1.0e-5f, i == j ? 1.0f : 0.0f, product[j]);
            TEST_ASSERT_NEAR(1.0e-6f, inverse[i][j], inverse[j][i]);
        }
    }
}

static void test_matrices_that_have_none(void)
{
    float singular[3][3] = {{1.0f, 1.0f, 0.0f}, {1.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}};
    float negative[3][3] = {{-1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}};
    float none[3][3] = {{0.0f}};

    TEST_ASSERT_FALSE(jp_localiser_invert(singular, inverse));
    TEST_ASSERT_FALSE(jp_localiser_invert(negative, inverse));
    TEST_ASSERT_FALSE(jp_localiser_invert(none, inverse));
}
